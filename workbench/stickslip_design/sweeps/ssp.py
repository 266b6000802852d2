"""SSP files: the components of a system, how they are connected, and the values it gives them.

System Structure and Parameterization 1.0; `SystemStructure.ssd` in a zip archive beside the FMUs.
"""

from __future__ import annotations

import zipfile
from collections.abc import Iterator, Mapping
from io import BytesIO
from pathlib import Path
from typing import Final, NamedTuple, NoReturn
from xml.etree.ElementTree import Element, fromstring

from .refusal import SweepError

_STRUCTURE: Final = "SystemStructure.ssd"
_SSP: Final = "http://ssp-standard.org/SSP1/SystemStructure"
_SPACE: Final = {
    "ssd": f"{_SSP}Description", "ssc": f"{_SSP}Common", "ssv": f"{_SSP}ParameterValues"
}  # fmt: skip
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
        offset = self.factor * earlier.offset + self.offset
        return Change(self.factor * earlier.factor, offset, self.converts and earlier.converts)


class System(NamedTuple):
    """A system.

    Attributes
    ----------
    components
        Path of the FMU in the archive by name of the component, in order of the file.
    connections
        By the input of a component the output that drives it, and the change on the way; connectors
        of systems between them are followed.
    values
        Values of variables by name, as component.variable: the number as it is written, and its
        unit, empty where it has none.
    experiment
        Times of the default experiment [s], as a plan calls them.
    """

    components: Mapping[str, str]
    connections: Mapping[str, tuple[str, Change]]
    values: Mapping[str, tuple[str, str]]
    experiment: Mapping[str, float]


_Node = tuple[str, str]
"""A connector: the path of its element, empty for the whole system, and its name."""


def read_system(path: Path) -> System:
    """Read an SSP file; `SweepError` if it is none, or uses what a sweep does not support."""
    from fmpy.ssp.ssd import read_ssd

    if not path.is_file():
        raise SweepError(f"{path}: {'not a file' if path.exists() else 'no such file'}")
    if not zipfile.is_zipfile(path):
        raise SweepError(f"{path}: not an SSP file (not a zip archive)")
    with zipfile.ZipFile(path) as archive:
        if _STRUCTURE not in archive.namelist():
            raise SweepError(f"{path}: not an SSP file (no {_STRUCTURE} in it)")
        try:
            # It checks the schemas; of connections and the experiment it reads not all. Where it
            # fails, it leaves a file open.
            read_ssd(BytesIO(path.read_bytes()))
        except Exception as error:
            raise SweepError(f"{path}: not an SSP file ({' '.join(str(error).split())})") from None
        return _Reader(path, archive).read()


class _Reader:
    """What was found in a valid SSP file, by the names of `System`."""

    def __init__(self, path: Path, archive: zipfile.ZipFile) -> None:
        self._path, self._archive = path, archive
        self._components: dict[str, str] = {}
        self._sources: dict[_Node, tuple[_Node, Change]] = {}
        self._values: dict[str, tuple[str, str]] = {}

    def read(self) -> System:
        root = fromstring(self._archive.read(_STRUCTURE))
        for system in root.iterfind("ssd:System", _SPACE):
            self._collect(system, "")
        if not self._components:
            self._refuse("has no component")
        inputs = [node for node in self._sources if node[0] in self._components]
        experiment = {
            name: float(stated.attrib[attribute])
            for stated in root.iterfind("ssd:DefaultExperiment", _SPACE)
            for name, attribute in (("start_time", "startTime"), ("stop_time", "stopTime"))
            if attribute in stated.attrib
        }
        connections = dict(pair for node in inputs for pair in self._traced(node))
        return System(self._components, connections, self._values, experiment)

    def _refuse(self, reason: str) -> NoReturn:
        raise SweepError(f"{self._path}: {reason}")

    def _collect(self, system: Element, place: str) -> None:
        """Add what is in a system at a place, such as ``inner.``, to what was found."""
        kinds = _connectors("", system)
        for element in system.iterfind("ssd:Elements/*", _SPACE):
            own = element.get("name", "")
            name = f"{place}{own}"
            kinds |= _connectors(own, element)
            if element.tag.endswith("}System"):
                self._collect(element, f"{name}.")
            elif element.tag.endswith("}Component"):
                if element.get("type") not in _OF_FMU:
                    self._refuse(f"the component {name} is no FMU, but {element.get('type')}")
                self._components[name] = element.attrib["source"]
                self._add_values(element, f"{name}.")
            else:
                self._refuse(f"{name} is a signal dictionary, which a sweep does not read")
        for connection in system.iterfind("ssd:Connections/ssd:Connection", _SPACE):
            self._connect(connection, place, kinds)
        # What a system says of the values of its components counts before what they say.
        self._add_values(system, place)

    def _connect(self, connection: Element, place: str, kinds: Mapping[_Node, str]) -> None:
        ends = [
            (connection.get(f"{end}Element", ""), connection.get(f"{end}Connector", ""))
            for end in ("start", "end")
        ]
        for element, connector in ends:
            if (element, connector) not in kinds:
                where = f"{place}{element}".rstrip(".") or "the system"
                self._refuse(f"{where} has no connector {connector}")
        # What gives a value inside a system: its own input, an output of an element.
        gives = [kinds[node] == ("output" if node[0] else "input") for node in ends]
        source, target = ends if gives[0] else reversed(ends)
        if sum(gives) != 1:
            pair = f"{'.'.join(source)} with {'.'.join(target)}"
            self._refuse(f"connects {pair}; one has to be an output")
        linear: Mapping[str, str] = {}
        for transformation in connection:
            if transformation.tag.endswith("MappingTransformation"):
                self._refuse(f"maps the values of {target[1]}, which a sweep does not read")
            if transformation.tag.endswith("LinearTransformation"):
                linear = transformation.attrib
        self._sources[_placed(place, target)] = (
            _placed(place, source),
            Change(
                float(linear.get("factor", "1")),
                float(linear.get("offset", "0")),
                connection.get("suppressUnitConversion") not in ("true", "1"),
            ),
        )

    def _traced(self, node: _Node) -> Iterator[tuple[str, tuple[str, Change]]]:
        """Yield the input of a component with the output that drives it and the change between.

        Nothing where it ends at an input of the whole system that nothing drives.
        """
        at, change = self._sources[node]
        seen = {node}
        while at[0] not in self._components:
            if at not in self._sources:
                return
            if at in seen:
                self._refuse(f"{'.'.join(node)} is driven by itself")
            seen.add(at)
            at, earlier = self._sources[at]
            change = change.after(earlier)
        yield ".".join(node), (".".join(at), change)

    def _add_values(self, element: Element, place: str) -> None:
        for binding in element.iterfind("ssd:ParameterBindings/ssd:ParameterBinding", _SPACE):
            if binding.find("ssd:ParameterMapping", _SPACE) is not None:
                self._refuse("maps parameters, which a sweep does not read")
            sets = binding.findall("ssd:ParameterValues/ssv:ParameterSet", _SPACE)
            if source := binding.get("source"):
                sets.insert(0, fromstring(self._archive.read(source)))
            path = "ssv:Parameters/ssv:Parameter"
            for parameter in (one for values in sets for one in values.iterfind(path, _SPACE)):
                name = f"{place}{binding.get('prefix', '')}{parameter.get('name')}"
                written = parameter[0].get("value", "")
                text = {"true": "1", "false": "0"}.get(written, written)
                try:
                    float(text)
                except ValueError:
                    self._refuse(
                        f"gives {name} the value {written!r}, and a sweep sets numbers only"
                    )
                self._values[name] = text, parameter[0].get("unit", "")


def _connectors(element: str, described: Element) -> dict[_Node, str]:
    return {
        (element, connector.get("name", "")): connector.get("kind", "")
        for connector in described.iterfind("ssd:Connectors/ssd:Connector", _SPACE)
    }


def _placed(place: str, node: _Node) -> _Node:
    element, connector = node
    return (f"{place}{element}" if element else place.rstrip("."), connector)
