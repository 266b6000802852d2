"""SSP files: the components of a system, how they are connected, and the values it gives them.

System Structure and Parameterization 1.0; `SystemStructure.ssd` in a zip archive beside the FMUs.
"""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any, Final, NamedTuple
from xml.etree import ElementTree

from .refusal import SweepError

_STRUCTURE: Final = "SystemStructure.ssd"
_SSP: Final = "http://ssp-standard.org/SSP1/SystemStructure"
_SPACE: Final = {"ssd": f"{_SSP}Description", "ssc": f"{_SSP}Common"}
_OF_FMU: Final = (None, "application/x-fmu-sharedlibrary")


class Change(NamedTuple):
    """What a connection does to a value: ``factor * value + offset``.

    Before, one that `converts` takes it from the unit of the output to that of the input.
    """

    factor: float = 1.0
    offset: float = 0.0
    converts: bool = True

    def after(self, earlier: Change) -> Change:
        """Return both changes in one, where the other comes first."""
        return Change(
            self.factor * earlier.factor,
            self.factor * earlier.offset + self.offset,
            self.converts and earlier.converts,
        )


class Connection(NamedTuple):
    """A connection of an output of a component with an input, by their names."""

    source: str
    target: str
    change: Change


@dataclass(frozen=True)
class System:
    """A system.

    Attributes
    ----------
    components
        Path of the FMU in the archive by name of the component, in order of the file.
    connections
        Between components; connectors of systems on the way are followed.
    values
        Values of variables by name, as component.variable: the number as it is written, and its
        unit, empty where it has none.
    experiment
        Start and stop of the default experiment [s], as a plan calls them.
    """

    components: Mapping[str, str]
    connections: tuple[Connection, ...]
    values: Mapping[str, tuple[str, str]]
    experiment: Mapping[str, float]


_Node = tuple[str, str]
"""A connector: the path of its element, empty for the whole system, and its name."""


def read_system(path: Path) -> System:
    """Read the structure of an SSP file.

    Raises
    ------
    SweepError
        If it is no SSP file, or uses what a sweep does not support.
    """
    from fmpy.ssp.ssd import read_ssd

    if not zipfile.is_zipfile(path):
        raise SweepError(f"{path}: not an SSP file (not a zip archive)")
    with zipfile.ZipFile(path) as archive:
        if _STRUCTURE not in archive.namelist():
            raise SweepError(f"{path}: not an SSP file (no {_STRUCTURE} in it)")
        structure = archive.read(_STRUCTURE)
    try:
        # It leaves the file open where it fails.
        root = read_ssd(BytesIO(path.read_bytes())).system
    except Exception as error:
        raise SweepError(f"{path}: not an SSP file ({' '.join(str(error).split())})") from None
    described = ElementTree.fromstring(structure)
    system = described.find("ssd:System", _SPACE)
    assert system is not None
    components: dict[str, str] = {}
    sources: dict[_Node, tuple[_Node, Change]] = {}
    values: dict[str, tuple[str, str]] = {}
    _collect(path, root, system, "", components, sources, values)
    if not components:
        raise SweepError(f"{path}: has no component")
    connections = [
        connection
        for node in sources
        if node[0] in components and (connection := _traced(path, node, sources, components))
    ]
    return System(components, tuple(connections), values, _experiment(described))


def _collect(
    path: Path,
    system: Any,
    described: ElementTree.Element,
    place: str,
    components: dict[str, str],
    sources: dict[_Node, tuple[_Node, Change]],
    values: dict[str, tuple[str, str]],
) -> None:
    """Add what is in a system at a place, such as ``inner.``, to what was found.

    FMPy knows its elements; of its connections it knows not all.
    """
    from fmpy.ssp.ssd import Component, System

    kinds = {("", each.name): each.kind for each in system.connectors}
    for element in system.elements:
        name = f"{place}{element.name}"
        kinds |= {(element.name, each.name): each.kind for each in element.connectors}
        if isinstance(element, System):
            its = next(
                each
                for each in described.iterfind("ssd:Elements/ssd:System", _SPACE)
                if each.get("name") == element.name
            )
            _collect(path, element, its, f"{name}.", components, sources, values)
        elif isinstance(element, Component):
            if element.type not in _OF_FMU:
                raise SweepError(f"{path}: the component {name} is no FMU, but {element.type}")
            components[name] = str(element.source)
            values |= _given(path, element, f"{name}.")
        else:
            raise SweepError(f"{path}: {name} is a signal dictionary, which a sweep does not read")
    for each in described.iterfind("ssd:Connections/ssd:Connection", _SPACE):
        one = (each.get("startElement", ""), each.get("startConnector", ""))
        other = (each.get("endElement", ""), each.get("endConnector", ""))
        for element, connector in (one, other):
            if (element, connector) not in kinds:
                where = f"{place}{element}".rstrip(".") or "the system"
                raise SweepError(f"{path}: {where} has no connector {connector}")
        if not _gives(one, kinds):
            one, other = other, one
        if not _gives(one, kinds) or _gives(other, kinds):
            raise SweepError(
                f"{path}: connects {'.'.join(one)} with {'.'.join(other)}; one has to be an output"
            )
        sources[_placed(place, other)] = _placed(place, one), _change(path, each)
    # What a system says of the values of its components counts before what they say.
    values |= _given(path, system, place)


def _change(path: Path, connection: ElementTree.Element) -> Change:
    for each in connection:
        if each.tag.endswith("MappingTransformation"):
            where = connection.get("endConnector")
            raise SweepError(f"{path}: maps the values of {where}, which a sweep does not read")
    linear = connection.find("ssc:LinearTransformation", _SPACE)
    stated: Mapping[str, str] = {} if linear is None else linear.attrib
    return Change(
        float(stated.get("factor", "1")),
        float(stated.get("offset", "0")),
        connection.get("suppressUnitConversion") not in ("true", "1"),
    )


def _gives(node: _Node, kinds: Mapping[_Node, str]) -> bool:
    """Whether a connector gives a value inside its system: its own input, an element's output."""
    return kinds[node] == ("output" if node[0] else "input")


def _placed(place: str, node: _Node) -> _Node:
    element, connector = node
    return (f"{place}{element}" if element else place.rstrip("."), connector)


def _traced(
    path: Path,
    node: _Node,
    sources: Mapping[_Node, tuple[_Node, Change]],
    components: Mapping[str, str],
) -> Connection | None:
    """Return the connection of a component's input with the output that drives it.

    None where it ends at an input of the whole system that nothing drives.
    """
    at, change = sources[node]
    seen = {node}
    while at[0] not in components:
        if at not in sources:
            return None
        if at in seen:
            raise SweepError(f"{path}: {'.'.join(node)} is driven by itself")
        seen.add(at)
        at, more = sources[at]
        change = change.after(more)
    return Connection(f"{at[0]}.{at[1]}", f"{node[0]}.{node[1]}", change)


def _given(path: Path, element: Any, place: str) -> dict[str, tuple[str, str]]:
    found: dict[str, tuple[str, str]] = {}
    for binding in element.parameterBindings:
        if binding.parameterMapping:
            raise SweepError(f"{path}: maps parameters, which a sweep does not read")
        before = f"{place}{binding.prefix or ''}"
        for each in binding.parameterValues:
            for parameter in each.parameters:
                text = {"true": "1", "false": "0"}.get(parameter.value, parameter.value)
                found[f"{before}{parameter.name}"] = text, parameter.unit or ""
                try:
                    float(text)
                except ValueError:
                    raise SweepError(
                        f"{path}: gives {before}{parameter.name} the value {parameter.value!r}, "
                        "and a sweep sets numbers only"
                    ) from None
    return found


def _experiment(described: ElementTree.Element) -> dict[str, float]:
    stated = described.find("ssd:DefaultExperiment", _SPACE)
    if stated is None:
        return {}
    names = {"start_time": "startTime", "stop_time": "stopTime"}
    return {
        name: float(stated.get(their, ""))
        for name, their in names.items()
        if their in stated.attrib
    }
