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
from typing import Final

from stickslip_verification import FmuError, Unit
from stickslip_verification.drive.fmu.description import (
    NUMBERS,
    Description,
    check_size,
    read_description,
    unpack,
)
from stickslip_verification.model.units import Conversion

from ..quantity import QuantityError
from .job import FLOATING, Component, Variable, Wire
from .refusal import SweepError
from .ssp import System, read_system
from .units import between, in_unit

_SETTABLE: Final = frozenset({"parameter", "input"})
_AS_IT_IS: Final = Conversion()
_AT_START: Final = frozenset({"exact", "approx"})


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

    Raises
    ------
    SweepError
        If it is neither, cannot be run here, or uses what a sweep does not support.
    """
    path = Path(path)
    try:
        content = path.read_bytes() if path.is_file() else b""
        with tempfile.TemporaryDirectory(prefix="stickslip-") as folder:
            return _read(path, content, Path(folder))
    except OSError as error:
        raise SweepError(f"{path}: cannot be read: {error.strerror or error}") from None
    except FmuError as error:
        raise SweepError(str(error)) from None


def _read(path: Path, content: bytes, folder: Path) -> Model:
    is_system = path.suffix.lower() == ".ssp"
    if is_system and not path.is_file():
        raise SweepError(f"{path}: {'not a file' if path.exists() else 'no such file'}")
    system = System({path.name: ""}, (), {}, {})
    if is_system:
        system = read_system(path)
        check_size(path)
        unpack(path, folder)
    experiment = dict(system.experiment)
    components: list[Component] = []
    variables: dict[str, Variable] = {}
    units: dict[str, Unit] = {}
    for index, (name, source) in enumerate(system.components.items()):
        fmu = folder / source if is_system else path
        if is_system and not fmu.is_file():
            raise SweepError(f"{path}: has no file {source}, the FMU of {name}")
        try:
            description = read_description(fmu)
        except FmuError as error:
            raise SweepError(
                str(error).replace(str(fmu), f"{path}: {source}".rstrip(": "))
            ) from None
        identifier = description.model_identifier
        components.append(
            Component(name, source, description.fmi_version, description.token, identifier)
        )
        before = f"{name}." if is_system else ""
        variables |= {each.name: each for each in _variables(index, before, description)}
        for unit, meaning in description.units.items():
            if units.setdefault(unit, meaning) != meaning:
                raise SweepError(f"{path}: its FMUs define the unit {unit!r} differently")
        if not is_system:
            experiment = {key: float(text) for key, text in description.experiment.items()}
    return Model(
        path,
        content,
        is_system,
        tuple(components),
        variables,
        tuple(_wires(path, system, variables, units)),
        _bound(path, system, variables, units),
        units,
        experiment,
    )


def _variables(component: int, before: str, description: Description) -> Iterator[Variable]:
    for each in description.declared.values():
        obstacle = ""
        if each.type not in NUMBERS:
            obstacle = f"is of type {each.type}, and no number"
        elif each.dimensions:
            obstacle = "is an array"
        yield Variable(
            name=f"{before}{each.name}",
            their_name=each.name,
            reference=each.valueReference,
            kind=each.type,
            unit=each.unit or "",
            causality=each.causality,
            variability=each.variability,
            start=None,
            conversion=_AS_IT_IS,
            component=component,
            description=each.description,
            obstacle=obstacle,
            # A structural parameter is set in a mode of its own.
            starts=each.variability != "constant"
            and each.causality != "structuralParameter"
            and (each.causality in _SETTABLE or each.initial in _AT_START),
            start_text=each.start or "",
        )


def _wires(
    path: Path,
    system: System,
    variables: Mapping[str, Variable],
    units: Mapping[str, Unit],
) -> Iterator[Wire]:
    for connection in system.connections:
        for name in (connection.source, connection.target):
            if name not in variables or variables[name].obstacle:
                why = variables[name].obstacle if name in variables else "is no variable of its FMU"
                raise SweepError(f"{path}: the connected {name} {why}")
        source, target = variables[connection.source], variables[connection.target]
        if target.causality != "input":
            raise SweepError(f"{path}: {target.name} is connected and no input of its FMU")
        change = connection.change
        factor, offset = Fraction(1), Fraction(0)
        if change.converts and source.unit and target.unit not in ("", source.unit):
            try:
                factor, offset = between(units, source.unit, target.unit)
            except QuantityError as error:
                raise SweepError(f"{path}: what drives {target.name} {error}") from None
        yield Wire(
            source.name,
            target.name,
            change.factor * float(factor),
            change.factor * float(offset) + change.offset,
        )


def _bound(
    path: Path, system: System, variables: Mapping[str, Variable], units: Mapping[str, Unit]
) -> dict[str, float]:
    found: dict[str, float] = {}
    for name, (number, unit) in system.values.items():
        if name not in variables:
            raise SweepError(f"{path}: gives a value to {name}, which is no variable of its FMU")
        variable = variables[name]
        obstacle = variable.obstacle
        if not obstacle and not variable.starts:
            obstacle = f"is a {variable.variability} {variable.causality}, and cannot be set"
        if obstacle:
            raise SweepError(f"{path}: gives a value to {name}, which {obstacle}")
        try:
            found[name] = in_unit(units, number, unit, variable.unit)
            check_type(variable, found[name])
        except QuantityError as error:
            raise SweepError(f"{path}: its value of {name} {error}") from None
    return found


def check_type(variable: Variable, number: float) -> None:
    """Refuse a number that is no value of the variable's type.

    Raises
    ------
    QuantityError
        If the type does not have it.
    """
    if variable.kind == "Boolean" and number not in (0.0, 1.0):
        raise QuantityError(f"has {number:g}, and the variable is true or false")
    if variable.kind not in FLOATING and variable.kind != "Boolean":
        bits = int(re.sub(r"\D", "", variable.kind) or "32")
        low = 0 if variable.kind.startswith("U") else -(2 ** (bits - 1))
        # Of what C cannot hold it would take some other number.
        if number != math.floor(number) or not low <= number < low + 2**bits:
            raise QuantityError(f"has {number:g}, and the variable is of type {variable.kind}")
