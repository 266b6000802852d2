"""The variable table of the drive's FMU: names, units, starts, bounds and descriptions."""

from __future__ import annotations

from typing import NamedTuple

from .drive import inertia_at_slide


class Variable(NamedTuple):
    """One variable: as FMI 2.0 defines it, SI.

    Attributes
    ----------
    name, unit, causality, start, description
        Their meaning in FMI 2.0; the start of an output is its value before the first step.
    kind
        Real or Integer.
    minimum, maximum
        Closed bounds of a parameter, or None; `above` says that the minimum itself is excluded.
    """

    name: str
    unit: str
    causality: str
    start: float
    description: str
    kind: str = "Real"
    minimum: float | None = None
    maximum: float | None = None
    above: bool = False

    @property
    def variability(self) -> str:
        """As FMI 2.0 defines it: no parameter changes in a running simulation."""
        if self.causality == "parameter":
            return "fixed"
        return (
            "discrete"
            if self.name in ("following_error", "F_motor", "F_integral")
            else ("continuous")
        )

    def objection(self, value: float) -> str | None:
        """Return why `value` cannot be taken, with name, value and range; None if it can."""
        low = float("-inf") if self.minimum is None else self.minimum
        high = float("inf") if self.maximum is None else self.maximum
        fits = low < value if self.above else low <= value
        if abs(value) < float("inf") and fits and value <= high:
            return None
        words = ["finite"]
        if self.minimum is not None:
            words.append(f"above {low:g}" if self.above else f"at least {low:g}")
        if self.maximum is not None:
            words.append(f"at most {high:g}")
        unit = "" if self.unit in ("", "1") else f" {self.unit}"
        return f"{self.name} = {value!r}{unit} is out of range: it must be {', '.join(words)}"


def _positive(name: str, unit: str, start: float, description: str) -> Variable:
    return Variable(name, unit, "parameter", start, description, minimum=0.0, above=True)


def _not_negative(name: str, unit: str, start: float, description: str) -> Variable:
    return Variable(name, unit, "parameter", start, description, minimum=0.0)


def _output(name: str, unit: str, description: str) -> Variable:
    return Variable(name, unit, "output", 0.0, description)


# The start values are those of the example's axis, whose drive has this inertia [kg.m2], this way
# a turn [m] and this bandwidth of the velocity loop [rad/s]; a test compares them.
_J, _PITCH, _OMEGA_V = 6e-3, 0.01, 300.0

VARIABLES: tuple[Variable, ...] = (
    _positive("J", "kg.m2", _J, "Inertia of motor, coupling and screw"),
    _positive("pitch", "m", _PITCH, "Way of the slide per turn of the screw"),
    _not_negative("d", "N.s/m", 1000.0, "Viscous friction of the drive, seen at the slide"),
    _not_negative(
        "k",
        "N/m",
        4e7,
        "Stiffness of the spring that is driven, to follow its force within a step; 0: held",
    ),
    _positive("T_s", "s", 250e-6, "Sample time of the controller"),
    _not_negative("K_v", "1/s", 25.0, "Gain of the position controller"),
    _not_negative(
        "K_p",
        "N.s/m",
        inertia_at_slide(_J, _PITCH) * _OMEGA_V,
        "Gain of the velocity controller, seen at the slide",
    ),
    _not_negative(
        "T_n", "s", 4.0 / _OMEGA_V, "Integral time of the velocity controller; 0: no integral"
    ),
    Variable(
        "on_table",
        "",
        "parameter",
        1,
        "Position is measured on the table (1) or on the motor (0)",
        kind="Integer",
        minimum=0,
        maximum=1,
    ),
    _not_negative("dead_band", "m", 0.0, "Position error that is taken as none"),
    _not_negative("velocity_feedforward", "1", 1.0, "Part of the commanded speed that is added"),
    _not_negative("friction_feedforward", "N", 0.0, "Force added in the commanded direction"),
    _positive("F_max", "N", 12e3, "Limit of the motor force"),
    _not_negative("resolution_motor", "m", 1e-8, "Count of the motor's encoder; 0: exact"),
    _not_negative("resolution_table", "m", 1e-7, "Count of the table's scale; 0: exact"),
    Variable("feed", "m/s", "parameter", 5e-4, "Commanded speed"),
    _positive("acceleration", "m/s2", 0.1, "Commanded acceleration"),
    _not_negative("distance", "m", 0.0, "Length of the move, after which it holds; 0: goes on"),
    Variable("F", "N", "input", 0.0, "Spring force that pulls the drive back"),
    Variable("x", "m", "input", 0.0, "Position of the table"),
    _output("v", "m/s", "Speed of the pulled end: the mean over the step to come"),
    _output("x_motor", "m", "Position of the motor, at the slide"),
    _output("x_command", "m", "Commanded position"),
    _output("following_error", "m", "Commanded less measured position, at the last sample"),
    _output("F_motor", "N", "Force of the motor, at the slide"),
    _output("F_integral", "N", "Integral part of the motor force"),
)

# A value reference is the position in the table.
VALUE_REFERENCES: dict[str, int] = {
    variable.name: reference for reference, variable in enumerate(VARIABLES)
}
