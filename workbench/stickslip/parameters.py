"""Parameters of the block as people give them: numbers in SI, or texts with a unit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from fmi.model import ModelError
from stickslip_fmu.interface import FIRST_OWN, table_of
from stickslip_fmu.laws.named import COULOMB_NAME, friction_law
from stickslip_fmu.laws.native_only import NativeOnly
from stickslip_fmu.spec import TABLE, spec_of
from stickslip_units import QuantityError, typed

if TYPE_CHECKING:
    from fmi.table import Table, Variable

CURVE_LAW: Final = "stribeck"
"""The friction law that a measured curve is given to."""


class ParameterError(ValueError):
    """A parameter cannot be taken; the message begins with its name."""

    def __init__(self, name: str, reason: str) -> None:
        super().__init__(name + reason)
        self.name, self.reason = name, reason


def read(variable: Variable, given: float | str) -> float:
    """Return the value of a variable [SI], given as a number or as a text with a unit.

    Of an enumeration the name of an item is taken too.

    Raises
    ------
    ParameterError
        If it is no quantity of the variable's dimension, or out of its range.
    """
    items = {item.name.lower(): item.value for item in variable.type.items}
    if isinstance(given, str) and given.strip().lower() in items:
        return items[given.strip().lower()]
    unit = "1" if items else variable.unit or "1"
    value = quantity(given, unit, variable.name, f"({variable.range})")
    if (objection := variable.objection(value)) is not None:
        raise ParameterError(variable.name, f" {given!r}: {objection}")
    return value


def quantity(given: float | str, unit: str, name: str, within: str = "") -> float:
    """Return what is given for `name`, a number or a text with a unit, in an SI unit.

    Raises
    ------
    ParameterError
        If a text is no quantity of the dimension of `unit`; `within` is the range in words.
    """
    try:
        return typed(given, unit, within) if isinstance(given, str) else float(given)
    except QuantityError as error:
        raise ParameterError(name, f" {given!r} {error}") from None


def above_zero(given: float | str, unit: str, name: str) -> float:
    """Return such a quantity; raises ParameterError if it is not above 0 too."""
    value = quantity(given, unit, name, "above 0")
    if not value > 0.0:
        least = "0" if unit == "1" else f"0 {unit}"
        raise ParameterError(name, f" {given!r} is out of range: it must be above {least}")
    return value


class _Start(float):
    """A value that nobody gave."""


class Quantity:
    """A field for a variable of the block, set with a number [SI] or a text with a unit."""

    def __set_name__(self, owner: type, name: str) -> None:
        self.variable = TABLE.by_name[name]

    def __get__(self, parameters: Parameters | None, owner: type | None = None) -> float:
        if parameters is None:
            return _Start(self.variable.start or 0.0)
        value: float = vars(parameters)[self.variable.name]
        return value

    def __set__(self, parameters: Parameters, given: float | str) -> None:
        vars(parameters)[self.variable.name] = (
            given if isinstance(given, _Start) else read(self.variable, given)
        )


@dataclass(frozen=True, kw_only=True, repr=False)
class Parameters:
    """Parameters, inputs and start values of the block under a friction law, in SI.

    Each number may be given as a text with a unit, ``"20 mm/s"``; what is not given has the start
    value of the FMU. Meaning, unit and range of each are those of docs/interface.md.

    Attributes
    ----------
    m, g, k, c, mu_s, mu_k, tau_s, B, t_0, age_start, x_start, x_dot_start, z_start, v, load, F_ext
        Mass [kg], gravity [m/s2], stiffness [N/m], damping [N.s/m], friction coefficients [1],
        growth of static friction at rest [s, 1, s], age of the first stick [s], state at the start
        [m, m/s, m], pulling velocity [m/s], load and force along the way [N].
    law
        Name of the friction law: ``"coulomb"``, ``"stribeck"``, or ``"module:NAME"``; "" is that of
        a curve, else Coulomb's.
    own
        Parameters of the friction law itself, by name.
    curve
        File of a measured friction curve, for the law ``"stribeck"``; it sets `mu_s` too where that
        is not given.
    normal_force
        Normal force [N] under which the forces of `curve` were measured.

    Raises
    ------
    ParameterError
        If a value is no quantity of its dimension, out of range, or does not go with the others.
    """

    m: Quantity = Quantity()
    g: Quantity = Quantity()
    k: Quantity = Quantity()
    c: Quantity = Quantity()
    mu_s: Quantity = Quantity()
    mu_k: Quantity = Quantity()
    tau_s: Quantity = Quantity()
    B: Quantity = Quantity()
    t_0: Quantity = Quantity()
    age_start: Quantity = Quantity()
    x_start: Quantity = Quantity()
    x_dot_start: Quantity = Quantity()
    z_start: Quantity = Quantity()
    v: Quantity = Quantity()
    load: Quantity = Quantity()
    F_ext: Quantity = Quantity()
    law: str = ""
    own: Mapping[str, float | str] = field(default_factory=dict, hash=False)
    curve: Path | None = None
    normal_force: float | str | None = None

    def __post_init__(self) -> None:
        fields = vars(self)
        if self.curve is not None and self.law not in ("", CURVE_LAW):
            raise ParameterError("curve", f" goes with law {CURVE_LAW}, not with law {self.law}")
        fields["law"] = self.law or (COULOMB_NAME if self.curve is None else CURVE_LAW)
        try:
            law = friction_law(self.law).law
            spec = spec_of(law)
        except ValueError as error:
            raise ParameterError("law", f": {error}") from error
        fields["given"] = given = {
            name: fields[name] for name in _QUANTITIES if not isinstance(fields[name], _Start)
        }
        lacking = [name for name in given if name not in spec.table.by_name]
        if lacking:
            raise ParameterError(lacking[0], f": the friction law {self.law} has no {lacking[0]}")
        own = self._own(spec.table)
        if self.curve is not None and "mu_s" not in given:
            own["mu_s"] = fields["mu_s"] = _Start(own["mu_1"])
        fields["values"] = values = {**spec.table.start_values(), **given, **own}
        try:
            if not isinstance(law, NativeOnly):
                spec.model(spec.values(values))
        except ModelError as error:
            # What does not go together.
            name, _, reason = str(error).partition(" ")
            raise ParameterError(name, f" {reason}") from None

    given: Mapping[str, float] = field(init=False, compare=False)
    values: Mapping[str, float] = field(init=False, compare=False)

    @property
    def table(self) -> Table:
        """The variable table of the block under the friction law."""
        return table_of(friction_law(self.law).law.interface)

    @property
    def sticks(self) -> bool:
        """Whether the friction law has a stick; else `sticking` and `mode` are for display."""
        return not isinstance(friction_law(self.law).law, NativeOnly)

    def __repr__(self) -> str:
        shown = [f"{name}={self._shown(name, value)}" for name, value in self.given.items()]
        shown += [f"{name}={value!r}" for name, value in self.own.items()]
        shown += [f"law={self.law!r}"] if self.law != COULOMB_NAME else []
        shown += [f"curve={str(self.curve)!r}"] if self.curve is not None else []
        return f"Parameters({', '.join(shown)})"

    def _shown(self, name: str, value: float) -> str:
        unit = TABLE.by_name[name].unit
        return repr(value) if unit in ("", "1") else repr(f"{value:g} {unit}")

    def _own(self, table: Table) -> dict[str, Any]:
        """Return the parameters of the friction law itself [SI], those of a curve among them."""
        its = (
            row for row in table.rows if row.number >= FIRST_OWN or row.name not in TABLE.by_name
        )
        rows = {row.name: row for row in its if row.settable}
        for name in self.own:
            if name not in rows:
                known = f"it has {', '.join(rows)}" if rows else "it has none"
                raise ParameterError(name, f": the friction law has no such parameter; {known}")
        own = {name: read(rows[name], value) for name, value in self.own.items()}
        if self.curve is None:
            if self.normal_force is not None:
                raise ParameterError("normal_force", " goes with a curve")
            return own
        from stickslip_design.axis.curve_file import CurveError, read_curve

        force = self.normal_force
        if force is not None:
            force = above_zero(force, "N", "normal_force")
        try:
            curve = read_curve(Path(self.curve), force)
        except CurveError as error:
            raise ParameterError("curve", f" {error}") from None
        if force is not None and not curve.of_forces:
            raise ParameterError(
                "normal_force", f": the curve {self.curve} has coefficients, not forces"
            )
        twice = sorted(own.keys() & curve.parameters.keys())
        if twice:
            raise ParameterError(twice[0], f": the curve {self.curve} sets it")
        return own | curve.parameters


_QUANTITIES: Final = tuple(
    name for name, each in vars(Parameters).items() if isinstance(each, Quantity)
)
