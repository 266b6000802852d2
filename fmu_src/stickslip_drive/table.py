"""The variable table of the drive's FMU: units, quantities and variables."""

from __future__ import annotations

from typing import Any

from fmi.table import ABOVE_ZERO, Quantity, Table, Unit, Values, Variable

from .motion import inertia_at_slide

_UNITS: dict[str, Unit] = {
    "kg.m2": Unit({"kg": 1, "m": 2}, (("kg.cm2", 1e4),)),
    "m": Unit({"m": 1}, (("mm", 1e3),)),
    "s": Unit({"s": 1}, (("ms", 1e3),)),
    "m/s": Unit({"m": 1, "s": -1}, (("mm/s", 1e3),)),
    "m/s2": Unit({"m": 1, "s": -2}, (("mm/s2", 1e3),)),
    "1/s": Unit({"s": -1}, (("1/min", 60.0),)),
    "Hz": Unit({"s": -1}, (("kHz", 1e-3),)),
    "N": Unit({"kg": 1, "m": 1, "s": -2}, (("kN", 1e-3),)),
    "N/m": Unit({"kg": 1, "s": -2}, (("N/um", 1e-6),)),
    "N.s/m": Unit({"kg": 1, "s": -1}, (("kN.s/m", 1e-3),)),
    "1": Unit({}, (("%", 100.0),)),
}

_INERTIA = Quantity("Inertia", "Real", "MomentOfInertia", "kg.m2")
_LENGTH = Quantity("Length", "Real", "Length", "m")
_TIME = Quantity("Time", "Real", "Time", "s")
_VELOCITY = Quantity("Velocity", "Real", "Velocity", "m/s")
_ACCELERATION = Quantity("Acceleration", "Real", "Acceleration", "m/s2")
_GAIN = Quantity("Gain", "Real", "", "1/s")
_FREQUENCY = Quantity("Frequency", "Real", "Frequency", "Hz")
_FORCE = Quantity("Force", "Real", "Force", "N")
_STIFFNESS = Quantity("Stiffness", "Real", "TranslationalSpringConstant", "N/m")
_DAMPING = Quantity("Damping", "Real", "TranslationalDampingConstant", "N.s/m")
_PART = Quantity("Part", "Real", "", "1")
_CHOICE = Quantity("Choice", "Integer")

_QUANTITIES = (
    *(_INERTIA, _LENGTH, _TIME, _VELOCITY, _ACCELERATION, _GAIN),
    *(_FORCE, _STIFFNESS, _DAMPING, _PART, _CHOICE, _FREQUENCY),
)


# The start values are those of the example's axis, whose drive has this inertia [kg.m2], this way
# a turn [m] and this bandwidth of the velocity loop [rad/s]; a test compares them.
_J, _PITCH, _OMEGA_V = 6e-3, 0.01, 300.0
_K_P = inertia_at_slide(_J, _PITCH) * _OMEGA_V

_PARAMETERS: tuple[tuple[Any, ...], ...] = (
    ("J", _INERTIA, _J, "Inertia of motor, coupling and screw", ABOVE_ZERO),
    ("pitch", _LENGTH, _PITCH, "Way of the slide per turn of the screw", ABOVE_ZERO),
    ("d", _DAMPING, 1000.0, "Viscous friction of the drive, seen at the slide"),
    ("k", _STIFFNESS, 4e7, "Stiffness of the spring that is driven, to follow its force within a "
     "step; 0: held"),
    ("T_s", _TIME, 250e-6, "Sample time of the controller", ABOVE_ZERO),
    ("K_v", _GAIN, 25.0, "Gain of the position controller"),
    ("K_p", _DAMPING, _K_P, "Gain of the velocity controller, seen at the slide"),
    ("T_n", _TIME, 4.0 / _OMEGA_V, "Integral time of the velocity controller; 0: no integral"),
    ("on_table", _CHOICE, 1, "Position is measured on the table (1) or on the motor (0)", 0, 1),
    ("dead_band", _LENGTH, 0.0, "Position error that is taken as none"),
    ("velocity_feedforward", _PART, 1.0, "Part of the commanded speed that is added"),
    ("friction_feedforward", _FORCE, 0.0, "Force added in the commanded direction"),
    ("F_max", _FORCE, 12e3, "Limit of the motor force", ABOVE_ZERO),
    ("resolution_motor", _LENGTH, 1e-8, "Count of the motor's encoder; 0: exact"),
    ("resolution_table", _LENGTH, 1e-7, "Count of the table's scale; 0: exact"),
    ("feed", _VELOCITY, 5e-4, "Commanded speed", None),
    ("acceleration", _ACCELERATION, 0.1, "Commanded acceleration", ABOVE_ZERO),
    ("distance", _LENGTH, 0.0, "Length of the move, after which it holds; 0: goes on"),
)  # fmt: skip
"""Name, quantity, start, description, least value (0 where none is named), largest."""

_SIGNALS: tuple[tuple[Any, ...], ...] = (
    ("F", _FORCE, "input", "Spring force that pulls the drive back"),
    ("x", _LENGTH, "input", "Position of the table"),
    ("v", _VELOCITY, "output", "Speed of the pulled end: the mean over the step to come",
     "drive.output"),
    ("x_motor", _LENGTH, "output", "Position of the motor, at the slide", "drive.x"),
    ("x_command", _LENGTH, "output", "Commanded position", "x_command"),
    ("following_error", _LENGTH, "output", "Commanded less measured position, at the last sample",
     "controller.error"),
    ("F_motor", _FORCE, "output", "Force of the motor, at the slide", "drive.F_motor"),
    ("F_integral", _FORCE, "output", "Integral part of the motor force", "controller.integral"),
)  # fmt: skip
"""Name, quantity, causality, description, where an output is found."""

_FILTERS: tuple[tuple[Any, ...], ...] = (
    ("lag", _TIME, 0.0, "Time constant of the current loop; 0: none"),
    ("dead_time", _TIME, 0.0, "Time from a sample to when its force command acts"),
    ("low_pass", _FREQUENCY, 0.0, "Low pass of the force command; 0: none"),
    ("low_pass_damping", _PART, 0.0, "Damping ratio of the low pass; 0: of first order"),
    ("notch", _FREQUENCY, 0.0, "Notch of the force command; 0: none"),
    ("notch_damping", _PART, 0.0, "Damping ratio of the notch's poles"),
    ("notch_depth", _PART, 0.0, "What the notch leaves at its frequency", 0.0, 1.0),
    ("dry", _FORCE, 0.0, "Dry friction of motor and nut, seen at the slide"),
)


def _parameter(
    number: int,
    name: str,
    quantity: Quantity,
    start: float,
    description: str,
    minimum: float | None = 0.0,
    maximum: float | None = None,
) -> Variable:
    row = number, name, quantity, "parameter", "fixed", start, description
    return Variable(*row, minimum=minimum, maximum=maximum)


def _signal(
    number: int, name: str, quantity: Quantity, causality: str, description: str, path: str = ""
) -> Variable:
    # The controller's own change at its samples alone.
    variability = "discrete" if path.startswith("controller") else "continuous"
    row = number, name, quantity, causality, variability, 0.0, description
    return Variable(*row, path) if path else Variable(*row)


_FIRST, _LAST = len(_PARAMETERS), len(_PARAMETERS) + len(_SIGNALS)
_ROWS = (
    *(_parameter(number, *row) for number, row in enumerate(_PARAMETERS)),
    *(_signal(number, *row) for number, row in enumerate(_SIGNALS, _FIRST)),
    *(_parameter(number, *row) for number, row in enumerate(_FILTERS, _LAST)),
)

_SECOND = _signal(len(_ROWS), "F_2", _FORCE, "input", "Spring force of a second table")
TABLE = Table(_UNITS, _QUANTITIES, (*_ROWS, _SECOND))


class Settings(Values, table=TABLE):
    """Parameters and inputs of the drive, SI."""
