"""The variable table of the FMU: the one place for names, quantities, starts, bounds and texts.

The model descriptions, the documentation and the tests are made from it. `attribute` is where a
`block.Block` holds the value, so an output is one row here and one attribute there.
"""

import math
import sys
from typing import Dict, NamedTuple, Optional, Tuple

from .meter import MOST_SLIPS
from .quantities import QUANTITIES, Quantity

# Ranges are closed; "above zero" starts at the smallest number with all its digits.
_ABOVE_ZERO = sys.float_info.min


class Variable(NamedTuple):
    """One variable of the FMU.

    Attributes
    ----------
    name, quantity
        Its name, and that of its type in `quantities.QUANTITIES`.
    kind, unit
        What that type says: Real, Integer or Boolean, and the unit ("" where there is none).
    causality, variability
        As FMI 2.0 defines them.
    start
        Start value; of a calculated output None.
    description
        What it is, in words.
    attribute
        Where a Block holds it.
    minimum, maximum
        Closed bounds, or None.
    depends
        Parameters and inputs that determine the initial value of a calculated output.
    in_proportion
        Whether the initial value moves in proportion to each of those, by a fixed factor.
    """

    name: str
    quantity: str
    kind: str
    unit: str
    causality: str
    variability: str
    start: Optional[float]
    description: str
    attribute: str
    minimum: Optional[float] = None
    maximum: Optional[float] = None
    depends: Tuple[str, ...] = ()
    in_proportion: bool = False

    @property
    def type(self) -> Quantity:
        """Its type: unit, display unit, order of magnitude."""
        return QUANTITIES[self.quantity]

    @property
    def settable(self) -> bool:
        """Whether a simulator may set it."""
        return self.causality != "output"

    @property
    def range(self) -> str:
        """The range in words."""
        if self.minimum is None:
            return "a finite number"
        return "finite and above 0" if self.minimum > 0.0 else "finite and at least 0"

    def objection(self, value: float) -> Optional[str]:
        """Return why `value` cannot be taken, with name, value and range; None if it can."""
        low = -math.inf if self.minimum is None else self.minimum
        if math.isfinite(value) and value >= low:
            return None
        unit = "" if self.unit == "1" else f" {self.unit}"
        text = f"{self.name} = {value!r}{unit} is out of range: it must be {self.range}"
        # Numbers that close to zero have lost digits.
        return f"{text}, at least {low:.3g}" if 0.0 < value < low else text


def _variable(
    name: str,
    quantity: str,
    causality: str,
    variability: str,
    start: Optional[float],
    description: str,
    attribute: str,
    minimum: Optional[float] = None,
    maximum: Optional[float] = None,
    depends: Tuple[str, ...] = (),
    in_proportion: bool = False,
) -> Variable:
    kind, unit = QUANTITIES[quantity].kind, QUANTITIES[quantity].unit
    return Variable(
        name,
        quantity,
        kind,
        unit,
        causality,
        variability,
        start,
        description,
        attribute,
        minimum,
        maximum,
        depends,
        in_proportion,
    )


def _parameter(
    name: str,
    quantity: str,
    variability: str,
    start: float,
    description: str,
    minimum: Optional[float] = None,
) -> Variable:
    return _variable(
        name, quantity, "parameter", variability, start, description, "wanted." + name, minimum
    )


def _input(name: str, quantity: str, start: float, description: str) -> Variable:
    return _variable(name, quantity, "input", "continuous", start, description, "wanted." + name)


def _motion(
    name: str,
    quantity: str,
    description: str,
    depends: Tuple[str, ...],
    minimum: Optional[float] = None,
    variability: str = "continuous",
    in_proportion: bool = False,
) -> Variable:
    return _variable(
        name,
        quantity,
        "output",
        variability,
        None,
        description,
        name,
        minimum,
        depends=depends,
        in_proportion=in_proportion,
    )


def _state(
    name: str, quantity: str, description: str, bounds: Tuple[Optional[int], Optional[int]]
) -> Variable:
    return _variable(
        name, quantity, "output", "discrete", None, description, name, *bounds, _REST_TEST
    )


def _metered(
    name: str,
    quantity: str,
    description: str,
    minimum: Optional[float] = None,
    maximum: Optional[float] = None,
) -> Variable:
    start = 0.0 if QUANTITIES[quantity].kind == "Real" else 0
    return _variable(
        name,
        quantity,
        "output",
        "discrete",
        start,
        description,
        "meter." + name,
        minimum,
        maximum,
    )


def _account(name: str, description: str, minimum: Optional[float] = None) -> Variable:
    return _variable(name, "Energy", "output", "continuous", 0.0, description, name, minimum)


_WEIGHT = ("m", "g", "load")
_REST_TEST = (*_WEIGHT, "k", "mu_s", "x_dot_start", "z_start", "F_ext")

VARIABLES: Tuple[Variable, ...] = (
    _parameter("m", "Mass", "fixed", 1.0, "Mass", _ABOVE_ZERO),
    _parameter("g", "Acceleration", "fixed", 9.81, "Gravity", _ABOVE_ZERO),
    _parameter("k", "Stiffness", "tunable", 1000.0, "Spring stiffness", _ABOVE_ZERO),
    _parameter("c", "Damping", "tunable", 0.0, "Viscous damping between mass and way", 0.0),
    _parameter("mu_s", "FrictionCoefficient", "tunable", 0.5, "Static friction coefficient", 0.0),
    _parameter(
        "mu_k",
        "FrictionCoefficient",
        "tunable",
        0.3,
        "Kinetic friction coefficient; above mu_s it is clamped, see mu_k_used",
        0.0,
    ),
    _parameter("x_start", "Position", "fixed", 0.0, "Initial position of the mass"),
    _parameter("x_dot_start", "Velocity", "fixed", 0.0, "Initial velocity of the mass"),
    _parameter("z_start", "Length", "fixed", 0.0, "Initial spring extension"),
    _input("v", "Velocity", 0.02, "Velocity of the pulled end, held over a step"),
    _input("load", "Force", 0.0, "Normal force on top of m g, at least -m g, held over a step"),
    _input("F_ext", "Force", 0.0, "External force on the mass along the way, held over a step"),
    _motion("x", "Position", "Position of the mass", ("x_start",), in_proportion=True),
    _motion("x_dot", "Velocity", "Velocity of the mass", ("x_dot_start",), in_proportion=True),
    _motion(
        "x_pull",
        "Position",
        "Position of the pulled end",
        ("x_start", "z_start"),
        in_proportion=True,
    ),
    _motion("z", "Length", "Spring extension x_pull - x", ("z_start",), in_proportion=True),
    _motion("F", "Force", "Spring force k z", ("k", "z_start")),
    _motion(
        "F_friction",
        "Force",
        "Friction on the mass, with its viscous part",
        (*_REST_TEST, "c", "mu_k"),
    ),
    _motion("F_s", "Force", "Break-away force mu_s N", (*_WEIGHT, "mu_s"), 0.0),
    _state("sticking", "Flag", "Whether the mass sticks", (None, None)),
    _state("mode", "SlipDirection", "-1 slips backward, 0 sticks, +1 slips forward", (-1, 1)),
    _metered("delta_x", "Length", "Displacement of the mass in the last completed slip"),
    _metered("spring_drop", "Length", "Fall of z over the last completed slip"),
    _metered("t_stick", "Duration", "Length of the last completed stick", 0.0),
    _metered("t_slip", "Duration", "Length of the last completed slip", 0.0),
    _metered("T", "Duration", "Time between the last two break-aways", 0.0),
    _metered("f", "Frequency", "Frequency 1/T of the stick-slip cycle", 0.0),
    _metered("x_dot_peak", "Velocity", "Extreme velocity of the last completed slip"),
    _metered("n_slips", "Count", "Completed slips", 0, MOST_SLIPS),
    # Not metered from zero: before the first transition it shows the start time.
    _motion("t_event", "Time", "Time of the last transition", (), variability="discrete")._replace(
        attribute="meter.t_event"
    ),
    _account("W_pull", "Work done by the pulling end"),
    _account("W_k", "Energy put in by changing k"),
    _account("Q_friction", "Heat made by friction and damping", 0.0),
    _motion(
        "mu_k_used",
        "FrictionCoefficient",
        "Kinetic friction coefficient after the clamp",
        ("mu_s", "mu_k"),
        0.0,
        "discrete",
    )._replace(attribute="state.friction.mu_k_used"),
)

VARIABLES_BY_NAME: Dict[str, Variable] = {variable.name: variable for variable in VARIABLES}

# A value reference is the position in the table.
VALUE_REFERENCES: Dict[str, int] = {
    variable.name: reference for reference, variable in enumerate(VARIABLES)
}


def start_values() -> Dict[str, float]:
    """Return the start value of every parameter and input, by name."""
    return {
        variable.name: variable.start
        for variable in VARIABLES
        if variable.settable and variable.start is not None
    }
