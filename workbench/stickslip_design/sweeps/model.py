"""What is swept: a co-simulation FMU, or the FMUs of an SSP file and how they are wired.

An FMU alone is a system of one component without wires. Its variables have their own names, those
of an SSP file are named component.variable.
"""

from __future__ import annotations

import math
import re
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import Final, NamedTuple

from stickslip_verification import FmuError, Unit
from stickslip_verification.drive import description as names
from stickslip_verification.drive.description import NUMBERS, Description, check_size, unpack
from stickslip_verification.drive.instance import FLOATING
from stickslip_verification.model.units import Conversion

from ..quantity import QuantityError
from .refusal import SweepError, between, in_unit
from .ssp import System, read_system

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


class Component(NamedTuple):
    """An FMU of the model, in an SSP file at `source`, and what it is instantiated with."""

    name: str
    source: str
    fmi_version: str
    token: str
    identifier: str


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
            description = Description(path)
            experiment = {name: float(text) for name, text in description.experiment.items()}
            return _model(path, System({path.name: ""}, {}, {}, experiment), [description])
        system = read_system(path)
        check_size(path)
        with tempfile.TemporaryDirectory(prefix="stickslip-") as folder:
            unpack(path, Path(folder))
            return _model(path, system, [*_descriptions(path, system, Path(folder))])
    except OSError as error:
        raise SweepError(f"{path}: cannot be read: {error.strerror or error}") from None
    except FmuError as error:
        raise SweepError(str(error)) from None


def _descriptions(path: Path, system: System, folder: Path) -> Iterator[Description]:
    for name, source in system.components.items():
        if not (folder / source).is_file():
            raise SweepError(f"{path}: has no file {source}, the FMU of {name}")
        try:
            yield Description(folder / source)
        except FmuError as error:
            said = str(error).replace(str(folder / source), f"{path}: {source}")
            raise SweepError(said) from None


def _model(path: Path, system: System, descriptions: list[Description]) -> Model:
    components: list[Component] = []
    variables: dict[str, Variable] = {}
    units: dict[str, Unit] = {}
    for (name, source), of in zip(system.components.items(), descriptions, strict=True):
        before = f"{name}." if source else ""
        variables |= {one.name: one for one in _variables(len(components), before, of)}
        components.append(Component(name, source, of.fmi_version, of.token, of.model_identifier))
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
    path: Path, system: System, variables: Mapping[str, Variable], units: Mapping[str, Unit]
) -> Iterator[Wire]:
    for target, (source, change) in system.connections.items():
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
                factor, offset = between(units, unit, of_input)
            except QuantityError as error:
                raise SweepError(f"{path}: what drives {target} {error}") from None
        scale = change.factor
        yield Wire(source, target, scale * float(factor), scale * float(offset) + change.offset)


def _bound(
    path: Path, system: System, variables: Mapping[str, Variable], units: Mapping[str, Unit]
) -> Iterator[tuple[str, float]]:
    for name, (number, unit) in system.values.items():
        variable = variables.get(name)
        if variable is None or variable.hindrance:
            why = variable.hindrance if variable else "is no variable of its FMU"
            raise SweepError(f"{path}: gives a value to {name}, which {why}")
        try:
            value = in_unit(units, number, unit, variable.unit)
            variable.check(value)
        except QuantityError as error:
            raise SweepError(f"{path}: its value of {name} {error}") from None
        yield name, value
