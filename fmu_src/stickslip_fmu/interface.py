"""The interface of the block: units, quantities and variables, declared here alone on this side.

A friction law adds its own rows (`Own`). The model descriptions, the record of values, the
documentation and the tests are made from the table of both. A calculated output is one row here
and one attribute of `block.Block`.
"""

from typing import Any, Dict, Mapping, NamedTuple, Optional, Tuple, Union

from fmi.model import Annotation
from fmi.table import ABOVE_ZERO, Item, Quantity, Table, Unit, Variable

from .meter import MOST_SLIPS

CONTRACT = Annotation(
    "org.stickslip.contract", "Contract", {"name": "stickslip-exact", "version": "1"}
)
"""The promise that the FMU keeps to this interface and is exact to rounding, whatever the law."""

FIRST_OWN = 34
"""The first number whose row differs from friction law to friction law."""

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

_TYPES: Tuple[Quantity, ...] = (
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

QUANTITIES: Dict[str, Quantity] = {quantity.name: quantity for quantity in _TYPES}


class Own(NamedTuple):
    """What a friction law adds to the interface.

    Attributes
    ----------
    model
        Name and identifier of the model: a Python identifier, StickSlip for Coulomb's law alone.
    description
        What the model is.
    rows
        The law's parameters and outputs. Their numbers are 4, 5, 33, 34, 35 and so on, each once:
        Coulomb's law has the first seven, and a law with its rows goes on with 38. An output of
        the law is held at ``state.friction.<name>`` where it stays along an arc.
    at_rest
        Names of the parameters that the break-away force depends on at the start.
    in_slip
        Names of the parameters that the friction of a slip depends on too.
    break_away
        Description of the break-away force `F_s`.
    ages
        Whether the break-away force depends on how long the mass has been at rest.
    units
        Units that the interface has not.
    """

    model: str
    description: str
    rows: Tuple[Variable, ...]
    at_rest: Tuple[str, ...]
    in_slip: Tuple[str, ...]
    break_away: str = "Break-away force mu_s N"
    ages: bool = False
    units: Mapping[str, Unit] = {}


def parameter(
    number: int,
    name: str,
    quantity: Union[str, Quantity],
    variability: str,
    start: float,
    description: str,
    minimum: Optional[float] = None,
    maximum: Optional[float] = None,
) -> Variable:
    """Return the row of a parameter; `quantity` is a name in QUANTITIES or a law's own quantity."""
    row = _row(number, name, quantity, "parameter", variability, start, description)
    return row._replace(minimum=minimum, maximum=maximum)


def calculated(
    number: int,
    name: str,
    quantity: Union[str, Quantity],
    description: str,
    depends: Tuple[str, ...],
    variability: str = "continuous",
    **other: Any,
) -> Variable:
    """Return the row of an output that follows from the state; see `Variable`."""
    row = _row(number, name, quantity, "output", variability, None, description)
    return row._replace(depends=depends, **other)


def _row(number: int, name: str, quantity: Union[str, Quantity], *other: Any) -> Variable:
    kind = QUANTITIES[quantity] if isinstance(quantity, str) else quantity
    return Variable(number, name, kind, *other)


def _input(number: int, name: str, quantity: str, description: str, start: float = 0.0) -> Variable:
    return _row(number, name, quantity, "input", "continuous", start, description)


def _motion(number: int, name: str, quantity: str, description: str, *starts: str) -> Variable:
    """Return the row of an output that is the sum of these at the start."""
    return calculated(number, name, quantity, description, starts, in_proportion=True)


def _metered(number: int, name: str, quantity: str, description: str, *range_: float) -> Variable:
    place = f"meter.{name}"
    return _row(number, name, quantity, "output", "discrete", 0, description, place, *range_)


def _account(number: int, name: str, description: str, *range_: float) -> Variable:
    return _row(number, name, "Energy", "output", "continuous", 0, description, "", *range_)


def table_of(own: Own) -> Table:
    """Return the table of the block under a friction law with these rows of its own."""
    weight = ("m", "g", "load")
    rest_test = (*weight, "k", *own.at_rest, "x_dot_start", "z_start", "F_ext")
    slip = (*rest_test, "c", *own.in_slip)
    break_away = rest_test if own.ages else (*weight, *own.at_rest)
    direction = "-1 slips backward, 0 sticks, +1 slips forward"
    rows = (
        parameter(0, "m", "Mass", "fixed", 1.0, "Mass", ABOVE_ZERO),
        parameter(1, "g", "Acceleration", "fixed", 9.81, "Gravity", ABOVE_ZERO),
        parameter(2, "k", "Stiffness", "tunable", 1000.0, "Spring stiffness", ABOVE_ZERO),
        parameter(3, "c", "Damping", "tunable", 0.0, "Viscous damping between mass and way", 0.0),
        parameter(6, "x_start", "Position", "fixed", 0.0, "Initial position of the mass"),
        parameter(7, "x_dot_start", "Velocity", "fixed", 0.0, "Initial velocity of the mass"),
        parameter(8, "z_start", "Length", "fixed", 0.0, "Initial spring extension"),
        _input(9, "v", "Velocity", "Velocity of the pulled end, held over a step", 0.02),
        _input(10, "load", "Force", "Normal force on top of m g, at least -m g, held over a step"),
        _input(11, "F_ext", "Force", "External force on the mass along the way, held over a step"),
        _motion(12, "x", "Position", "Position of the mass", "x_start"),
        _motion(13, "x_dot", "Velocity", "Velocity of the mass", "x_dot_start"),
        _motion(14, "x_pull", "Position", "Position of the pulled end", "x_start", "z_start"),
        _motion(15, "z", "Length", "Spring extension x_pull - x", "z_start"),
        calculated(16, "F", "Force", "Spring force k z", ("k", "z_start")),
        calculated(17, "F_friction", "Force", "Friction on the mass, with its viscous part", slip),
        calculated(18, "F_s", "Force", own.break_away, break_away, minimum=0.0),
        calculated(19, "sticking", "Flag", "Whether the mass sticks", rest_test, "discrete"),
        calculated(
            20, "mode", "SlipDirection", direction, rest_test, "discrete", minimum=-1, maximum=1
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
        _metered(29, "t_event", "Time", "Time of the last transition")._replace(start=None),
        _account(30, "W_pull", "Work done by the pulling end"),
        _account(31, "W_k", "Energy put in by changing k"),
        _account(32, "Q_friction", "Heat made by friction and damping", 0.0),
        *own.rows,
    )
    types = dict.fromkeys((*_TYPES, *(row.type for row in own.rows)))
    return Table({**_UNITS, **own.units}, types, rows)
