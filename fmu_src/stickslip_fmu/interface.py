"""The interface of the block: units, quantities and variables, declared here alone on this side.

The model descriptions, the record of values, the documentation and the tests are made from TABLE.
A calculated output is one row here and one attribute of `block.Block`.
"""

from typing import Dict, Optional, Tuple

from fmukit.table import ABOVE_ZERO, Item, Quantity, Table, Unit, Variable

from .meter import MOST_SLIPS

_UNITS: Dict[str, Unit] = {
    "kg": Unit({"kg": 1}),
    "m": Unit({"m": 1}, (("mm", 1e3),)),
    "s": Unit({"s": 1}, (("ms", 1e3),)),
    "m/s": Unit({"m": 1, "s": -1}, (("mm/s", 1e3),)),
    "m/s2": Unit({"m": 1, "s": -2}),
    "N": Unit({"kg": 1, "m": 1, "s": -2}, (("kN", 1e-3),)),
    "N/m": Unit({"kg": 1, "s": -2}, (("N/mm", 1e-3),)),
    "N.s/m": Unit({"kg": 1, "s": -1}),
    "J": Unit({"kg": 1, "m": 2, "s": -2}, (("mJ", 1e3),)),
    "Hz": Unit({"s": -1}),
    "1": Unit({}),
}

_QUANTITIES: Tuple[Quantity, ...] = (
    Quantity("Mass", "Real", "Mass", "kg", 1.0),
    Quantity("Acceleration", "Real", "Acceleration", "m/s2", 10.0),
    Quantity("Stiffness", "Real", "TranslationalSpringConstant", "N/m", 1000.0),
    Quantity("Damping", "Real", "TranslationalDampingConstant", "N.s/m", 10.0),
    Quantity("FrictionCoefficient", "Real", "CoefficientOfFriction", "1", 1.0),
    Quantity("Position", "Real", "Length", "m", 0.1, "mm"),
    Quantity("Length", "Real", "Length", "m", 0.01, "mm"),
    Quantity("Velocity", "Real", "Velocity", "m/s", 0.1, "mm/s"),
    Quantity("Force", "Real", "Force", "N", 10.0),
    Quantity("Time", "Real", "Time", "s", 10.0),
    Quantity("Duration", "Real", "Time", "s", 0.1),
    Quantity("Frequency", "Real", "Frequency", "Hz", 1.0),
    Quantity("Energy", "Real", "Energy", "J", 1.0),
    Quantity(
        "SlipDirection",
        "Integer",
        items=(
            Item("SlipsBackward", -1, "The mass slips backward"),
            Item("Sticks", 0, "The mass sticks"),
            Item("SlipsForward", 1, "The mass slips forward"),
        ),
    ),
    Quantity("Count", "Integer"),
    Quantity("Flag", "Boolean"),
)

_BY_NAME: Dict[str, Quantity] = {quantity.name: quantity for quantity in _QUANTITIES}


def _parameter(
    number: int,
    name: str,
    quantity: str,
    variability: str,
    start: float,
    description: str,
    minimum: Optional[float] = None,
) -> Variable:
    return Variable(
        number,
        name,
        _BY_NAME[quantity],
        "parameter",
        variability,
        start,
        description,
        minimum=minimum,
    )


def _input(number: int, name: str, quantity: str, description: str, start: float = 0.0) -> Variable:
    return Variable(number, name, _BY_NAME[quantity], "input", "continuous", start, description)


def _calculated(
    number: int,
    name: str,
    quantity: str,
    description: str,
    depends: Tuple[str, ...],
    minimum: Optional[float] = None,
    maximum: Optional[float] = None,
    variability: str = "continuous",
    held_at: str = "",
    in_proportion: bool = False,
) -> Variable:
    return Variable(
        number,
        name,
        _BY_NAME[quantity],
        "output",
        variability,
        None,
        description,
        held_at,
        minimum,
        maximum,
        depends,
        in_proportion,
    )


def _metered(
    number: int,
    name: str,
    quantity: str,
    description: str,
    minimum: Optional[float] = None,
    maximum: Optional[float] = None,
) -> Variable:
    start = 0.0 if _BY_NAME[quantity].kind == "Real" else 0
    return Variable(
        number,
        name,
        _BY_NAME[quantity],
        "output",
        "discrete",
        start,
        description,
        f"meter.{name}",
        minimum,
        maximum,
    )


def _account(number: int, name: str, description: str, minimum: Optional[float] = None) -> Variable:
    return Variable(
        number,
        name,
        _BY_NAME["Energy"],
        "output",
        "continuous",
        0.0,
        description,
        minimum=minimum,
    )


_WEIGHT = ("m", "g", "load")
_REST_TEST = (*_WEIGHT, "k", "mu_s", "x_dot_start", "z_start", "F_ext")

_ROWS: Tuple[Variable, ...] = (
    _parameter(0, "m", "Mass", "fixed", 1.0, "Mass", ABOVE_ZERO),
    _parameter(1, "g", "Acceleration", "fixed", 9.81, "Gravity", ABOVE_ZERO),
    _parameter(2, "k", "Stiffness", "tunable", 1000.0, "Spring stiffness", ABOVE_ZERO),
    _parameter(3, "c", "Damping", "tunable", 0.0, "Viscous damping between mass and way", 0.0),
    _parameter(
        4, "mu_s", "FrictionCoefficient", "tunable", 0.5, "Static friction coefficient", 0.0
    ),
    _parameter(
        5,
        "mu_k",
        "FrictionCoefficient",
        "tunable",
        0.3,
        "Kinetic friction coefficient; above mu_s it is clamped, see mu_k_used",
        0.0,
    ),
    _parameter(6, "x_start", "Position", "fixed", 0.0, "Initial position of the mass"),
    _parameter(7, "x_dot_start", "Velocity", "fixed", 0.0, "Initial velocity of the mass"),
    _parameter(8, "z_start", "Length", "fixed", 0.0, "Initial spring extension"),
    _input(9, "v", "Velocity", "Velocity of the pulled end, held over a step", 0.02),
    _input(10, "load", "Force", "Normal force on top of m g, at least -m g, held over a step"),
    _input(11, "F_ext", "Force", "External force on the mass along the way, held over a step"),
    _calculated(12, "x", "Position", "Position of the mass", ("x_start",), in_proportion=True),
    _calculated(
        13, "x_dot", "Velocity", "Velocity of the mass", ("x_dot_start",), in_proportion=True
    ),
    _calculated(
        14,
        "x_pull",
        "Position",
        "Position of the pulled end",
        ("x_start", "z_start"),
        in_proportion=True,
    ),
    _calculated(15, "z", "Length", "Spring extension x_pull - x", ("z_start",), in_proportion=True),
    _calculated(16, "F", "Force", "Spring force k z", ("k", "z_start")),
    _calculated(
        17,
        "F_friction",
        "Force",
        "Friction on the mass, with its viscous part",
        (*_REST_TEST, "c", "mu_k"),
    ),
    _calculated(18, "F_s", "Force", "Break-away force mu_s N", (*_WEIGHT, "mu_s"), 0.0),
    _calculated(
        19, "sticking", "Flag", "Whether the mass sticks", _REST_TEST, variability="discrete"
    ),
    _calculated(
        20,
        "mode",
        "SlipDirection",
        "-1 slips backward, 0 sticks, +1 slips forward",
        _REST_TEST,
        -1,
        1,
        variability="discrete",
    ),
    _metered(21, "delta_x", "Length", "Displacement of the mass in the last completed slip"),
    _metered(22, "spring_drop", "Length", "Fall of z over the last completed slip"),
    _metered(23, "t_stick", "Duration", "Length of the last completed stick", 0.0),
    _metered(24, "t_slip", "Duration", "Length of the last completed slip", 0.0),
    _metered(25, "T", "Duration", "Time between the last two break-aways", 0.0),
    _metered(26, "f", "Frequency", "Frequency 1/T of the stick-slip cycle", 0.0),
    _metered(27, "x_dot_peak", "Velocity", "Extreme velocity of the last completed slip"),
    _metered(28, "n_slips", "Count", "Completed slips", 0, MOST_SLIPS),
    # Calculated and not from zero: before the first transition it shows the start time.
    _calculated(
        29,
        "t_event",
        "Time",
        "Time of the last transition",
        (),
        variability="discrete",
        held_at="meter.t_event",
    ),
    _account(30, "W_pull", "Work done by the pulling end"),
    _account(31, "W_k", "Energy put in by changing k"),
    _account(32, "Q_friction", "Heat made by friction and damping", 0.0),
    _calculated(
        33,
        "mu_k_used",
        "FrictionCoefficient",
        "Kinetic friction coefficient after the clamp",
        ("mu_s", "mu_k"),
        0.0,
        variability="discrete",
        held_at="state.friction.mu_k_used",
    ),
)

TABLE = Table(_UNITS, _QUANTITIES, _ROWS)
