"""What is swept: a co-simulation FMU, or the FMUs of an SSP file and how they are wired.

An FMU alone is a system of one component without wires. Its variables have their own names, those
of an SSP file are named component.variable. SSP is System Structure and Parameterization 1.0, with
`SystemStructure.ssd` in a zip archive beside the FMUs.
"""

from __future__ import annotations

import math
import re
import tempfile
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from io import BytesIO
from pathlib import Path
from typing import Final, NamedTuple, NoReturn
from xml.etree.ElementTree import Element, fromstring

from stickslip_units import Conversion, QuantityError, Unit, between, in_unit
from stickslip_verification import FmuError
from stickslip_verification.drive import description as names
from stickslip_verification.drive.description import NUMBERS, Description, check_size, unpack
from stickslip_verification.drive.instance import FLOATING

from ..chunks import StudyError


class SweepError(StudyError):
    """A model, a plan or a table of it cannot be used; one line with file, line, name, reason."""


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


_Node = tuple[str, str]
"""A connector: the path of its element, empty for the whole system, and its name."""


class _System:
    """What an SSP file says, or stands for an FMU alone.

    Attributes
    ----------
    components
        Path of the FMU in the archive by name of the component, in order of the file.
    sources
        By connector the one that drives it, and the change on the way.
    values
        Values of variables by name, as component.variable: the number as it is written, and its
        unit, empty where it has none.
    experiment
        Times of the default experiment [s], as a plan calls them.
    """

    def __init__(self, path: Path, components: Mapping[str, str] | None = None) -> None:
        self._path = path
        self.components: dict[str, str] = {**(components or {})}
        self.sources: dict[_Node, tuple[_Node, Change]] = {}
        self.values: dict[str, tuple[str, str]] = {}
        self.experiment: dict[str, float] = {}

    def read(self) -> None:
        """Read the SSP file; `SweepError` if it is none, or uses what a sweep does not support."""
        from fmpy.ssp.ssd import read_ssd

        if not self._path.is_file():
            self._refuse("not a file" if self._path.exists() else "no such file")
        if not zipfile.is_zipfile(self._path):
            self._refuse("not an SSP file (not a zip archive)")
        with zipfile.ZipFile(self._path) as archive:
            if _STRUCTURE not in archive.namelist():
                self._refuse(f"not an SSP file (no {_STRUCTURE} in it)")
            try:
                # It checks the schemas; of connections and the experiment it reads not all. Where
                # it fails, it leaves a file open.
                read_ssd(BytesIO(self._path.read_bytes()))
            except Exception as error:
                self._refuse(f"not an SSP file ({' '.join(str(error).split())})")
            root = fromstring(archive.read(_STRUCTURE))
            for system in root.iterfind("ssd:System", _SPACE):
                self._collect(archive, system, "")
        if not self.components:
            self._refuse("has no component")
        for stated in root.iterfind("ssd:DefaultExperiment", _SPACE):
            for name, attribute in (("start_time", "startTime"), ("stop_time", "stopTime")):
                if attribute in stated.attrib:
                    self.experiment[name] = float(stated.attrib[attribute])

    def connections(self) -> Iterator[tuple[str, str, Change]]:
        """Yield the output that drives an input of a component, that input, and the change between.

        Connectors of systems between them are followed; nothing where they end at an input of the
        whole system that nothing drives.
        """
        for node in self.sources:
            at, change, seen = node, Change(), {node}
            if node[0] not in self.components:
                continue
            while at in self.sources:
                at, earlier = self.sources[at]
                change = change.after(earlier)
                if at in seen:
                    self._refuse(f"{'.'.join(node)} is driven by itself")
                seen.add(at)
                if at[0] in self.components:
                    yield ".".join(at), ".".join(node), change
                    break

    def _refuse(self, reason: str) -> NoReturn:
        raise SweepError(f"{self._path}: {reason}")

    def _collect(self, archive: zipfile.ZipFile, system: Element, place: str) -> None:
        """Add what is in a system at a place, such as ``inner.``, to what was found."""
        kinds = _connectors("", system)
        for element in system.iterfind("ssd:Elements/*", _SPACE):
            own = element.get("name", "")
            name = f"{place}{own}"
            kinds |= _connectors(own, element)
            if element.tag.endswith("}System"):
                self._collect(archive, element, f"{name}.")
            elif element.tag.endswith("}Component"):
                if element.get("type") not in _OF_FMU:
                    self._refuse(f"the component {name} is no FMU, but {element.get('type')}")
                self.components[name] = element.attrib["source"]
                self._add_values(archive, element, f"{name}.")
            else:
                self._refuse(f"{name} is a signal dictionary, which a sweep does not read")
        for connection in system.iterfind("ssd:Connections/ssd:Connection", _SPACE):
            self._connect(connection, place, kinds)
        # What a system says of the values of its components counts before what they say.
        self._add_values(archive, system, place)

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
        self.sources[_placed(place, target)] = (
            _placed(place, source),
            Change(
                float(linear.get("factor", "1")),
                float(linear.get("offset", "0")),
                connection.get("suppressUnitConversion") not in ("true", "1"),
            ),
        )

    def _add_values(self, archive: zipfile.ZipFile, element: Element, place: str) -> None:
        for binding in element.iterfind("ssd:ParameterBindings/ssd:ParameterBinding", _SPACE):
            if binding.find("ssd:ParameterMapping", _SPACE) is not None:
                self._refuse("maps parameters, which a sweep does not read")
            sets = binding.findall("ssd:ParameterValues/ssv:ParameterSet", _SPACE)
            if source := binding.get("source"):
                sets.insert(0, fromstring(archive.read(source)))
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
                self.values[name] = text, parameter[0].get("unit", "")


def _connectors(element: str, described: Element) -> dict[_Node, str]:
    return {
        (element, connector.get("name", "")): connector.get("kind", "")
        for connector in described.iterfind("ssd:Connectors/ssd:Connector", _SPACE)
    }


def _placed(place: str, node: _Node) -> _Node:
    element, connector = node
    return (f"{place}{element}" if element else place.rstrip("."), connector)


_AT_START: Final = frozenset({"exact", "approx"})


@dataclass(frozen=True)
class Variable(names.Variable):
    """A variable of the model, `name`, with the numbers that the FMU of a component has.

    Texts are empty where it declares nothing. An `obstacle` says why it is no number that can be
    set and read; one that `starts` can be set before a run.
    """

    unit: str
    component: int
    description: str
    obstacle: str
    starts: bool
    start_text: str

    @property
    def sort(self) -> str:
        """Variability and causality, for refusals."""
        return f"{self.variability} {self.causality}"

    @property
    def hindrance(self) -> str:
        """Why it cannot be set before a run; empty if it can."""
        return self.obstacle or ("" if self.starts else f"is a {self.sort}, and cannot be set")

    @property
    def changes(self) -> bool:
        """Whether it can be set in a run: an input, or a tunable parameter."""
        return self.causality == "input" or self.sort == "tunable parameter"

    @property
    def is_continuous(self) -> bool:
        """Whether a file of inputs is read along straight lines; else each value holds."""
        return self.kind in FLOATING and self.variability == "continuous"

    def check(self, number: float) -> None:
        """Refuse a number that its type does not have, by a `QuantityError`."""
        if self.kind == "Boolean" and number not in (0.0, 1.0):
            raise QuantityError(f"has {number:g}, and the variable is true or false")
        if self.kind not in FLOATING and self.kind != "Boolean":
            bits = int(re.sub(r"\D", "", self.kind) or "32")
            low = 0 if self.kind.startswith("U") else -(2 ** (bits - 1))
            # Of what C cannot hold it would take some other number.
            if number != math.floor(number) or not low <= number < low + 2**bits:
                raise QuantityError(f"has {number:g}, and the variable is of type {self.kind}")


@dataclass
class Component:
    """An FMU of the model, in an SSP file at `source`, and what it is instantiated with.

    Its `path` is its name; `folder` is where it is unpacked.
    """

    path: Path
    source: str
    fmi_version: str
    token: str
    model_identifier: str
    variables: Mapping[str, names.Variable] = field(default_factory=dict)
    folder: Path = Path()


class Wire(NamedTuple):
    """A connection: the input gets ``factor * output + offset``, both by their names."""

    output: str
    input: str
    factor: float
    offset: float


@dataclass(frozen=True)
class Model:
    """A model: its components, variables and wires.

    Attributes
    ----------
    path, content, is_system
        The file, its bytes, and whether it is an SSP file.
    components, variables, wires
        Its FMUs, their variables by name, and the connections.
    bound
        Values that the SSP file gives, by name of the variable.
    units
        Units that its FMUs define, by name.
    experiment
        Start, stop and step of its default experiment [s], where it has them, by the names that a
        plan gives them.
    """

    path: Path
    content: bytes = field(repr=False)
    is_system: bool
    components: tuple[Component, ...]
    variables: Mapping[str, Variable]
    wires: tuple[Wire, ...]
    bound: Mapping[str, float]
    units: Mapping[str, Unit]
    experiment: Mapping[str, float]


def read_model(path: Path | str) -> Model:
    """Read an FMU or an SSP file.

    `SweepError` if it is neither, cannot be run here, or uses what a sweep does not support.
    """
    path = Path(path)
    try:
        if path.suffix.lower() != ".ssp":
            alone, description = _System(path, {path.name: ""}), Description(path)
            alone.experiment = {name: float(text) for name, text in description.experiment.items()}
            return _model(path, alone, [description])
        system = _System(path)
        system.read()
        check_size(path)
        with tempfile.TemporaryDirectory(prefix="stickslip-") as folder:
            unpack(path, Path(folder))
            return _model(path, system, [*_descriptions(path, system, Path(folder))])
    except OSError as error:
        raise SweepError(f"{path}: cannot be read: {error.strerror or error}") from None
    except FmuError as error:
        raise SweepError(str(error)) from None


def _descriptions(path: Path, system: _System, folder: Path) -> Iterator[Description]:
    for name, source in system.components.items():
        if not (folder / source).is_file():
            raise SweepError(f"{path}: has no file {source}, the FMU of {name}")
        try:
            yield Description(folder / source)
        except FmuError as error:
            said = str(error).replace(str(folder / source), f"{path}: {source}")
            raise SweepError(said) from None


def _model(path: Path, system: _System, descriptions: list[Description]) -> Model:
    components: list[Component] = []
    variables: dict[str, Variable] = {}
    units: dict[str, Unit] = {}
    for (name, source), of in zip(system.components.items(), descriptions, strict=True):
        before = f"{name}." if source else ""
        variables |= {one.name: one for one in _variables(len(components), before, of)}
        of_fmu = of.fmi_version, of.token, of.model_identifier
        components.append(Component(Path(name), source, *of_fmu))
        for unit, meaning in of.units.items():
            if units.setdefault(unit, meaning) != meaning:
                raise SweepError(f"{path}: its FMUs define the unit {unit!r} differently")
    return Model(
        path,
        path.read_bytes(),
        path.suffix.lower() == ".ssp",
        tuple(components),
        variables,
        tuple(_wires(path, system, variables, units)),
        dict(_bound(path, system, variables, units)),
        units,
        system.experiment,
    )


def _variables(component: int, before: str, description: Description) -> Iterator[Variable]:
    for declared in description.declared.values():
        obstacle = "is an array" if declared.dimensions else ""
        if declared.type not in NUMBERS:
            obstacle = f"is of type {declared.type}, and no number"
        yield Variable(
            name=f"{before}{declared.name}",
            their_name=declared.name,
            reference=declared.valueReference,
            kind=declared.type,
            unit=declared.unit or "",
            causality=declared.causality,
            variability=declared.variability,
            start=None,
            conversion=Conversion(),
            component=component,
            description=declared.description,
            obstacle=obstacle,
            # A structural parameter is set in a mode of its own.
            starts=declared.variability != "constant"
            and declared.causality != "structuralParameter"
            and (declared.causality in names.SETTABLE or declared.initial in _AT_START),
            start_text=declared.start or "",
        )


def _wires(
    path: Path, system: _System, variables: Mapping[str, Variable], units: Mapping[str, Unit]
) -> Iterator[Wire]:
    for source, target, change in system.connections():
        for name in (source, target):
            if name not in variables or variables[name].obstacle:
                why = variables[name].obstacle if name in variables else "is no variable of its FMU"
                raise SweepError(f"{path}: the connected {name} {why}")
        if variables[target].causality != "input":
            raise SweepError(f"{path}: {target} is connected and no input of its FMU")
        unit, of_input = variables[source].unit, variables[target].unit
        factor, offset = Fraction(1), Fraction(0)
        if change.converts and unit and of_input not in ("", unit):
            try:
                factor, offset = between(unit, of_input, units)
            except QuantityError as error:
                raise SweepError(f"{path}: what drives {target} {error}") from None
        scale = change.factor
        yield Wire(source, target, scale * float(factor), scale * float(offset) + change.offset)


def _bound(
    path: Path, system: _System, variables: Mapping[str, Variable], units: Mapping[str, Unit]
) -> Iterator[tuple[str, float]]:
    for name, (number, unit) in system.values.items():
        variable = variables.get(name)
        if variable is None or variable.hindrance:
            why = variable.hindrance if variable else "is no variable of its FMU"
            raise SweepError(f"{path}: gives a value to {name}, which {why}")
        try:
            value = in_unit(number, unit, variable.unit, units)
            variable.check(value)
        except QuantityError as error:
            raise SweepError(f"{path}: its value of {name} {error}") from None
        yield name, value
