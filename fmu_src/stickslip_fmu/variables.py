"""The variable table of the FMU: the one place for names, units, starts, bounds and texts.

The model description, the documentation and the tests are made from it. `attribute` is where a
`block.Block` holds the value, so an output is one row here and one attribute there.
"""

import math
import sys
from typing import Dict, NamedTuple, Optional, Tuple

# Ranges are closed; "above zero" starts at the smallest number with all its digits.
_ABOVE_ZERO = sys.float_info.min


class Variable(NamedTuple):
    """One variable of the FMU.

    Attributes
    ----------
    name, kind, unit
        Name, FMI type (Real, Integer or Boolean) and unit ("" where there is none).
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
    nominal
        Order of magnitude of a Real, or None.
    depends
        Parameters and inputs that determine the initial value of a calculated output.
    """

    name: str
    kind: str
    unit: str
    causality: str
    variability: str
    start: Optional[float]
    description: str
    attribute: str
    minimum: Optional[float] = None
    maximum: Optional[float] = None
    nominal: Optional[float] = None
    depends: Tuple[str, ...] = ()

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


def _parameter(
    name: str,
    unit: str,
    variability: str,
    start: float,
    description: str,
    minimum: Optional[float] = None,
    nominal: Optional[float] = None,
) -> Variable:
    return Variable(
        name,
        "Real",
        unit,
        "parameter",
        variability,
        start,
        description,
        "wanted." + name,
        minimum=minimum,
        nominal=nominal,
    )


def _input(name: str, unit: str, start: float, description: str) -> Variable:
    return Variable(name, "Real", unit, "input", "continuous", start, description, "wanted." + name)


def _motion(
    name: str,
    unit: str,
    description: str,
    depends: Tuple[str, ...],
    minimum: Optional[float] = None,
    variability: str = "continuous",
) -> Variable:
    return Variable(
        name,
        "Real",
        unit,
        "output",
        variability,
        None,
        description,
        name,
        minimum=minimum,
        depends=depends,
    )


def _state(name: str, kind: str, description: str, bounds: Optional[Tuple[int, int]]) -> Variable:
    low, high = bounds or (None, None)
    return Variable(
        name,
        kind,
        "",
        "output",
        "discrete",
        None,
        description,
        name,
        minimum=low,
        maximum=high,
        depends=_REST_TEST,
    )


def _metered(name: str, unit: str, description: str, minimum: Optional[float] = None) -> Variable:
    return Variable(
        name, "Real", unit, "output", "discrete", 0.0, description, "meter." + name, minimum
    )


def _account(name: str, description: str, minimum: Optional[float] = None) -> Variable:
    return Variable(
        name, "Real", "J", "output", "continuous", 0.0, description, name, minimum=minimum
    )


_WEIGHT = ("m", "g", "load")
_REST_TEST = (*_WEIGHT, "k", "mu_s", "x_dot_start", "z_start", "F_ext")

VARIABLES: Tuple[Variable, ...] = (
    _parameter("m", "kg", "fixed", 1.0, "Mass", _ABOVE_ZERO),
    _parameter("g", "m/s2", "fixed", 9.81, "Gravity", _ABOVE_ZERO),
    _parameter("k", "N/m", "tunable", 1000.0, "Spring stiffness", _ABOVE_ZERO, 1000.0),
    _parameter("c", "N.s/m", "tunable", 0.0, "Viscous damping between mass and way", 0.0),
    _parameter("mu_s", "1", "tunable", 0.5, "Static friction coefficient", 0.0),
    _parameter(
        "mu_k",
        "1",
        "tunable",
        0.3,
        "Kinetic friction coefficient; above mu_s it is clamped, see mu_k_used",
        0.0,
    ),
    _parameter("x_start", "m", "fixed", 0.0, "Initial position of the mass"),
    _parameter("x_dot_start", "m/s", "fixed", 0.0, "Initial velocity of the mass"),
    _parameter("z_start", "m", "fixed", 0.0, "Initial spring extension"),
    _input("v", "m/s", 0.02, "Velocity of the pulled end, held over a step"),
    _input("load", "N", 0.0, "Normal force on top of m g, at least -m g, held over a step"),
    _input("F_ext", "N", 0.0, "External force on the mass along the way, held over a step"),
    _motion("x", "m", "Position of the mass", ("x_start",)),
    _motion("x_dot", "m/s", "Velocity of the mass", ("x_dot_start",)),
    _motion("x_pull", "m", "Position of the pulled end", ("x_start", "z_start")),
    _motion("z", "m", "Spring extension x_pull - x", ("z_start",)),
    _motion("F", "N", "Spring force k z", ("k", "z_start")),
    _motion(
        "F_friction",
        "N",
        "Friction on the mass, with its viscous part",
        (*_REST_TEST, "c", "mu_k"),
    ),
    _motion("F_s", "N", "Break-away force mu_s N", (*_WEIGHT, "mu_s"), 0.0),
    _state("sticking", "Boolean", "Whether the mass sticks", None),
    _state("mode", "Integer", "-1 slips backward, 0 sticks, +1 slips forward", (-1, 1)),
    _metered("delta_x", "m", "Displacement of the mass in the last completed slip"),
    _metered("spring_drop", "m", "Fall of z over the last completed slip"),
    _metered("t_stick", "s", "Length of the last completed stick", 0.0),
    _metered("t_slip", "s", "Length of the last completed slip", 0.0),
    _metered("T", "s", "Time between the last two break-aways", 0.0),
    _metered("f", "Hz", "Frequency 1/T of the stick-slip cycle", 0.0),
    _metered("x_dot_peak", "m/s", "Extreme velocity of the last completed slip"),
    Variable(
        "n_slips",
        "Integer",
        "",
        "output",
        "discrete",
        0,
        "Completed slips",
        "meter.n_slips",
        minimum=0,
    ),
    # Not metered from zero: before the first transition it shows the start time.
    _motion("t_event", "s", "Time of the last transition", (), variability="discrete")._replace(
        attribute="meter.t_event"
    ),
    _account("W_pull", "Work done by the pulling end"),
    _account("W_k", "Energy put in by changing k"),
    _account("Q_friction", "Heat made by friction and damping", 0.0),
    _motion(
        "mu_k_used",
        "1",
        "Kinetic friction coefficient after the clamp",
        ("mu_s", "mu_k"),
        0.0,
        "discrete",
    ),
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
