"""What is swept: a co-simulation FMU, or the FMUs of an SSP file and how they are wired.

An FMU alone is a system of one component without wires. Its variables have their own names, those
of an SSP file are named component.variable. SSP is System Structure and Parameterization 1.0, with
`SystemStructure.ssd` in a zip archive beside the FMUs.
"""

from __future__ import annotations

import math
import tempfile
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from fractions import Fraction
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import Final, NamedTuple
from xml.etree.ElementTree import Element, fromstring

from stickslip_units import (
    BETWEEN,
    Conversion,
    QuantityError,
    Unit,
    between,
    parse_range,
    typed_in,
)  # fmt: skip
from stickslip_verification import FmuError
from stickslip_verification.drive import description as fmu
from stickslip_verification.drive.instance import FLOATING

from ..chunks import StudyError


class SweepError(StudyError):
    """A model, a plan or a table of it cannot be used; one line with file, line, name, reason."""


def nearest(name: str, known: Sequence[str]) -> str:
    """Return the names most like one that is not known, as the end of a refusal."""
    # The last part of a structured name may be all that a person remembers.
    same = [other for other in known if other.rpartition(".")[2] == name.rpartition(".")[2]]
    near = [*dict.fromkeys([*get_close_matches(name, known, _SHOWN, 0.5), *same])] or known
    return f"nearest: {', '.join(near[:_SHOWN])}"


_SHOWN: Final = 5
"""Names that a refusal lists."""
_AT_START: Final = frozenset({"exact", "approx"})


@dataclass(frozen=True)
class Variable(fmu.Variable):
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
    def changes(self) -> bool:
        """Whether it can be set in a run: an input, or a tunable parameter."""
        return self.causality == "input" or self.sort == "tunable parameter"

    @property
    def is_continuous(self) -> bool:
        """Whether a file of inputs is read along straight lines; else each value holds."""
        return self.kind in FLOATING and self.variability == "continuous"


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
    variables: Mapping[str, fmu.Variable] = field(default_factory=dict)
    folder: Path = Path()


class Wire(NamedTuple):
    """A connection: the input gets ``factor * output + offset``, both by their names."""

    output: str
    input: str
    factor: float
    offset: float


@dataclass(frozen=True)
class Model:
    """A model: its file, the FMUs in it, their variables by name, and the connections.

    `bound` are values that the SSP file gives, by variable, `units` those that its FMUs define;
    `experiment` has start, stop and step of its default experiment [s], named as in a plan.
    """

    path: Path
    content: bytes = field(repr=False)
    components: tuple[Component, ...]
    variables: Mapping[str, Variable]
    wires: tuple[Wire, ...]
    bound: Mapping[str, float]
    units: Mapping[str, Unit]
    experiment: Mapping[str, float]

    def variable(self, name: str, *, to_set: bool = False) -> Variable:
        """Return a variable to read, or to set before a run; a `QuantityError` if it is none."""
        variable = self.variables.get(name)
        if variable is None:
            near = nearest(name, [*self.variables])
            raise QuantityError(f"{name} is no variable of {self.path.name}; {near}")
        if variable.obstacle:
            raise QuantityError(f"{name} {variable.obstacle}")
        if to_set and not variable.starts:
            raise QuantityError(f"{name} is a {variable.sort}, and cannot be set")
        return variable

    def numbers(self, written: object, variable: Variable) -> list[float]:
        """Return a value, or those of a range, in the variable's unit; `QuantityError` for none."""
        read = partial(typed_in, known=self.units)
        try:
            if isinstance(written, str):
                if BETWEEN in written:
                    return [*map(float, parse_range(written, variable.unit, read=read).values())]
                return [read(written, variable.unit)]
            if isinstance(written, float | int) and math.isfinite(written):
                return [float(written)]
            raise QuantityError("is no finite number")
        except QuantityError as error:
            raise QuantityError(f"{variable.name} = {written!r} {error}") from None


def read_model(path: Path | str) -> Model:
    """Read an FMU or an SSP file.

    `SweepError` if it is neither, cannot be run here, or uses what a sweep does not support.
    """
    path = Path(path)
    with tempfile.TemporaryDirectory(prefix="stickslip-") as folder:
        try:
            if path.suffix.lower() != ".ssp":
                alone = fmu.Description(path)
                times = {name: float(text) for name, text in alone.experiment.items()}
                return _model(path, _System({path.name: ""}, experiment=times), [alone])
            system = _read_ssp(path)
            fmu.check_size(path)
            fmu.unpack(path, Path(folder))
            files = [Path(folder, source) for source in system.components.values()]
            return _model(path, system, [fmu.Description(file) for file in files])
        except OSError as error:
            raise SweepError(f"{path}: cannot be read: {error.strerror or error}") from None
        except (FmuError, QuantityError) as error:
            said = str(error).replace(f"{folder}/", f"{path}: ")
            raise SweepError(said if str(path) in said else f"{path}: {said}") from None


def unpack_model(model: Model, folder: Path) -> list[Path]:
    """Unpack the FMUs of the components below a folder, and return where each is; `FmuError`."""
    archive = folder / "model"
    archive.write_bytes(model.content)
    places = [folder / str(number) for number in range(len(model.components))]
    if model.components[0].source:
        fmu.unpack(archive, folder / "system")
    for component, place in zip(model.components, places, strict=True):
        fmu.unpack(folder / "system" / component.source if component.source else archive, place)
    return places


_STRUCTURE: Final = "SystemStructure.ssd"
_SSP: Final = "http://ssp-standard.org/SSP1/SystemStructure"
_SPACE: Final = {
    "ssd": f"{_SSP}Description", "ssc": f"{_SSP}Common", "ssv": f"{_SSP}ParameterValues",
    "ssm": f"{_SSP}ParameterMapping",
}  # fmt: skip
_UNREAD: Final = ("SignalDictionaryReference", "MappingTransformation")
"""Ends of the names of elements that a sweep does not read."""
_OF_FMU: Final = (None, "application/x-fmu-sharedlibrary")

_Node = tuple[str, str]
"""A connector: the path of its element, empty for the whole system, and its name."""


_Change = tuple[float, float, bool]
"""What a connection does: ``factor * value + offset``; before, units are converted or not."""


@dataclass
class _System:
    """What an SSP file says, or stands for an FMU alone.

    The path of an FMU in the archive by name of its component; pairs of connectors, in any order,
    and the change from the one that drives to the other; values of variables with their units.
    """

    components: dict[str, str]
    connections: list[tuple[_Node, _Node, _Change]] = field(default_factory=list)
    values: dict[str, str] = field(default_factory=dict)
    experiment: dict[str, float] = field(default_factory=dict)

    def drivers(self, node: _Node) -> Iterator[tuple[_Node, _Change]]:
        """Yield the connectors of components that a connector meets, and the changes from them.

        Connectors of systems between them are followed.
        """
        todo: list[tuple[_Node, _Change]] = [(node, (1.0, 0.0, True))]
        seen = {node}
        while todo:
            at, (factor, offset, converts) = todo.pop()
            for start, end, (by, shift, also) in self.connections:
                other = start if end == at else end
                if at in (start, end) and other not in seen:
                    seen.add(other)
                    change = factor * by, factor * shift + offset, converts and also
                    if other[0] in self.components:
                        yield other, change
                    else:
                        todo.append((other, change))


def _read_ssp(path: Path) -> _System:
    """Read an SSP file; `QuantityError` if it is none, or uses what a sweep does not support."""
    from fmpy.ssp.ssd import read_ssd

    content, found = path.read_bytes(), _System({})
    try:
        # It checks the schemas; of connections and the experiment it reads not all.
        read_ssd(BytesIO(content))
        archive = zipfile.ZipFile(BytesIO(content))
        root = fromstring(archive.read(_STRUCTURE))
    except Exception as error:
        raise QuantityError(f"not an SSP file ({fmu.one_line(error)})") from None

    def add(system: Element, place: str) -> None:
        for element in system.iterfind("ssd:Elements/*", _SPACE):
            name = f"{place}{element.get('name')}"
            if element.tag.endswith("}System"):
                add(element, f"{name}.")
            else:
                found.components[name] = element.attrib["source"]
                add_values(element, f"{name}.")
        for connection in system.iterfind("ssd:Connections/ssd:Connection", _SPACE):
            one = connection.get
            start, end = (
                (f"{place}{one(f'{which}Element', '')}".rstrip("."), one(f"{which}Connector", ""))
                for which in ("start", "end")
            )
            linear = connection.find("ssc:LinearTransformation", _SPACE)
            of = {} if linear is None else linear.attrib
            converts = one("suppressUnitConversion") not in ("true", "1")
            change = float(of.get("factor", 1)), float(of.get("offset", 0)), converts
            found.connections.append((start, end, change))
        # What a system says of the values of its components counts before what they say.
        add_values(system, place)

    def add_values(element: Element, place: str) -> None:
        for binding in element.iterfind("ssd:ParameterBindings/ssd:ParameterBinding", _SPACE):
            sets = binding.findall("ssd:ParameterValues/ssv:ParameterSet", _SPACE)
            if source := binding.get("source"):
                sets.insert(0, fromstring(archive.read(source)))
            mapped = mapping(binding)
            for parameter in (
                one for s in sets for one in s.iterfind("ssv:Parameters/ssv:Parameter", _SPACE)
            ):
                written = parameter[0].get("value", "")
                number = {"true": "1", "false": "0"}.get(written, written)
                own = str(parameter.get("name"))
                for name in [own] if mapped is None else mapped.get(own, []):
                    name = f"{place}{binding.get('prefix', '')}{name}"
                    found.values[name] = f"{number} {parameter[0].get('unit', '')}".rstrip()

    def mapping(binding: Element) -> dict[str, list[str]] | None:
        """Return the names of what a name of the parameters stands for; None: for itself."""
        at = binding.find("ssd:ParameterMapping", _SPACE)
        if at is None:
            return None
        names: dict[str, list[str]] = {}
        tree = fromstring(archive.read(at.attrib["source"])) if "source" in at.attrib else at
        for entry in tree.iterfind(".//ssm:MappingEntry", _SPACE):
            source = entry.attrib["source"]
            if any(child.tag.endswith("Transformation") for child in entry):
                raise QuantityError(f"changes the parameter {source}, which a sweep does not")
            names.setdefault(source, []).append(entry.attrib["target"])
        return names

    for element in root.iter():
        kind = element.tag.rpartition("}")[2]
        if kind.endswith(_UNREAD) or (kind == "Component" and element.get("type") not in _OF_FMU):
            named = " ".join(filter(None, (kind, element.get("name"), element.get("type"))))
            raise QuantityError(f"has the {named}, which a sweep does not read")
        if kind == "DefaultExperiment":
            times = ("start_time", "startTime"), ("stop_time", "stopTime")
            found.experiment = {
                n: float(element.attrib[of]) for n, of in times if of in element.attrib
            }
    for each in root.iterfind("ssd:System", _SPACE):
        add(each, "")
    return found


def _model(path: Path, system: _System, descriptions: list[fmu.Description]) -> Model:
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
                raise QuantityError(f"its FMUs define the unit {unit!r} differently")
    bound: dict[str, float] = {}
    model = Model(
        path, path.read_bytes(), tuple(components), variables, (), bound, units, system.experiment
    )
    for name, text in system.values.items():
        (bound[name],) = model.numbers(text, model.variable(name, to_set=True))
    return replace(model, wires=tuple(_wires(model, system)))


def _wires(model: Model, system: _System) -> Iterator[Wire]:
    for node in dict.fromkeys(node for each in system.connections for node in each[:2]):
        if node[0] not in system.components:
            continue
        target = model.variable(".".join(node))
        met = [(model.variable(".".join(node)), change) for node, change in system.drivers(node)]
        sources = [(source, of) for source, of in met if source.causality != "input"]
        if target.causality != "input":
            if met and len(sources) == len(met):
                raise QuantityError(f"connects {target.name} with {met[0][0].name}, no input")
            continue
        for source, (factor, offset, converts) in sources:
            scale, shift = Fraction(1), Fraction(0)
            if converts and source.unit and target.unit not in ("", source.unit):
                try:
                    scale, shift = between(source.unit, target.unit, model.units)
                except QuantityError as error:
                    raise QuantityError(f"what drives {target.name} {error}") from None
            change = factor * float(scale), factor * float(shift) + offset
            yield Wire(source.name, target.name, *change)


def _variables(component: int, before: str, description: fmu.Description) -> Iterator[Variable]:
    for declared in description.declared.values():
        obstacle = "is an array" if declared.dimensions else ""
        if declared.type not in fmu.NUMBERS:
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
            and (declared.causality in fmu.SETTABLE or declared.initial in _AT_START),
            start_text=declared.start or "",
        )
