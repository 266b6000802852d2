"""What the variables are quantities of: types with unit, display unit and order of magnitude.

Every face of the block makes its type and unit definitions from these two tables.
"""

from typing import Dict, NamedTuple, Tuple


class Unit(NamedTuple):
    """A unit: its SI exponents, and the units a person may rather read with their factors."""

    base: Dict[str, int]
    displays: Tuple[Tuple[str, float], ...] = ()


UNITS: Dict[str, Unit] = {
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


class Item(NamedTuple):
    """One value of an enumeration."""

    name: str
    value: int
    description: str


class Quantity(NamedTuple):
    """A type of variables.

    Attributes
    ----------
    kind
        Real, Integer or Boolean.
    quantity
        The physical quantity, as the types of the Modelica standard library call it; "" where
        there is none.
    unit
        Unit of a Real, else "".
    nominal
        Order of magnitude of a Real at the default parameters, else 0.
    shown_in
        The display unit of a Real where it is another one than the unit, else "".
    items
        The values that an Integer can take, where they have names.
    """

    kind: str
    quantity: str = ""
    unit: str = ""
    nominal: float = 0.0
    shown_in: str = ""
    items: Tuple[Item, ...] = ()


QUANTITIES: Dict[str, Quantity] = {
    "Mass": Quantity("Real", "Mass", "kg", 1.0),
    "Acceleration": Quantity("Real", "Acceleration", "m/s2", 10.0),
    "Stiffness": Quantity("Real", "TranslationalSpringConstant", "N/m", 1000.0),
    "Damping": Quantity("Real", "TranslationalDampingConstant", "N.s/m", 10.0),
    "FrictionCoefficient": Quantity("Real", "CoefficientOfFriction", "1", 1.0),
    "Position": Quantity("Real", "Length", "m", 0.1, "mm"),
    "Length": Quantity("Real", "Length", "m", 0.01, "mm"),
    "Velocity": Quantity("Real", "Velocity", "m/s", 0.1, "mm/s"),
    "Force": Quantity("Real", "Force", "N", 10.0),
    "Time": Quantity("Real", "Time", "s", 10.0),
    "Duration": Quantity("Real", "Time", "s", 0.1),
    "Frequency": Quantity("Real", "Frequency", "Hz", 1.0),
    "Energy": Quantity("Real", "Energy", "J", 1.0),
    "SlipDirection": Quantity(
        "Integer",
        items=(
            Item("SlipsBackward", -1, "The mass slips backward"),
            Item("Sticks", 0, "The mass sticks"),
            Item("SlipsForward", 1, "The mass slips forward"),
        ),
    ),
    "Count": Quantity("Integer"),
    "Flag": Quantity("Boolean"),
}
