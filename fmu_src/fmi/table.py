"""The table of a model's variables: units, quantities, rows, and the record of settable values.

The model descriptions, the value references and the record of values are made from the table.
"""

import keyword
import math
import sys
from typing import (
    TYPE_CHECKING,
    Any,
    Callable,
    ClassVar,
    Dict,
    Iterable,
    Mapping,
    NamedTuple,
    Optional,
    Tuple,
    Type,
    TypeVar,
)

ABOVE_ZERO = sys.float_info.min
"""Minimum of a value that must be above 0: the smallest number with all its digits."""

_KINDS = ("Real", "Integer", "Boolean")
_CAUSALITIES = ("parameter", "input", "output")
_VARIABILITIES = ("fixed", "tunable", "discrete", "continuous")

_Record = TypeVar("_Record", bound="Values")


class Unit(NamedTuple):
    """A unit.

    Attributes
    ----------
    base
        Exponents of the SI base units.
    displays
        Units for display, each with its factor: a value in the display unit is factor times the
        value in this unit.
    """

    base: Dict[str, int]
    displays: Tuple[Tuple[str, float], ...] = ()


class Item(NamedTuple):
    """One value of an enumeration."""

    name: str
    value: int
    description: str


class Quantity(NamedTuple):
    """A type of variables.

    Attributes
    ----------
    name
        Name of the type in the model description.
    kind
        Real, Integer or Boolean.
    quantity
        Physical quantity, named as in the types of the Modelica standard library; "" for none.
    unit
        Unit of a Real, else "".
    nominal
        Order of magnitude of a Real at the start values, else 0.
    shown_in
        Display unit of a Real, "" where it is the unit.
    items
        The named values of an Integer, in FMI 3.0 an enumeration.
    """

    name: str
    kind: str
    quantity: str = ""
    unit: str = ""
    nominal: float = 0.0
    shown_in: str = ""
    items: Tuple[Item, ...] = ()

    @property
    def fmi3_type(self) -> str:
        """Type in FMI 3.0."""
        if self.items:
            return "Enumeration"
        return {"Real": "Float64", "Integer": "Int32", "Boolean": "Boolean"}[self.kind]


class Variable(NamedTuple):
    """One variable.

    Attributes
    ----------
    number
        Value reference, and position in the table.
    name
        A Python identifier.
    type
        Quantity.
    causality
        parameter, input or output.
    variability
        As FMI 2.0 defines it.
    start
        Start value in the unit of the type; None for an output that is calculated.
    description
        The meaning of the variable, in words.
    path
        Attribute of the model with the value, such as ``meter.T``; "" for the attribute of
        the variable's own name, which of a settable variable is in ``wanted``.
    minimum, maximum
        Closed bounds in the unit of the type, or None.
    depends
        Names of the parameters and inputs that determine the initial value of a calculated output.
    in_proportion
        Whether that initial value is a linear combination of them with fixed factors.
    """

    number: int
    name: str
    type: Quantity
    causality: str
    variability: str
    start: Optional[float]
    description: str
    path: str = ""
    minimum: Optional[float] = None
    maximum: Optional[float] = None
    depends: Tuple[str, ...] = ()
    in_proportion: bool = False

    @property
    def kind(self) -> str:
        """Real, Integer or Boolean."""
        return self.type.kind

    @property
    def unit(self) -> str:
        """Unit of a Real, else ""."""
        return self.type.unit

    @property
    def settable(self) -> bool:
        """Whether a simulator may set the variable."""
        return self.causality != "output"

    @property
    def attribute(self) -> str:
        """Attribute of the model that holds the value."""
        return self.path or (f"wanted.{self.name}" if self.settable else self.name)

    @property
    def range(self) -> str:
        """The range in words."""
        if self.type.items:
            return "one of " + ", ".join(f"{item.value} ({item.name})" for item in self.type.items)
        words = []
        if self.minimum is not None:
            above_zero = self.minimum == ABOVE_ZERO
            words.append("above 0" if above_zero else f"at least {self.minimum:g}")
        if self.maximum is not None:
            words.append(f"at most {self.maximum:g}")
        return " and ".join(["finite", *words]) if words else "a finite number"

    def objection(self, value: float) -> Optional[str]:
        """Return why `value` cannot be taken, with name, value and range; None if it can."""
        low = -math.inf if self.minimum is None else self.minimum
        high = math.inf if self.maximum is None else self.maximum
        if math.isfinite(value) and low <= value <= high:
            whole = self.kind == "Real" or value == int(value)
            return None if whole else f"{self.name} = {value!r} is no whole number"
        unit = "" if self.unit in ("", "1") else f" {self.unit}"
        text = f"{self.name} = {value!r}{unit} is out of range: it must be {self.range}"
        # Subnormal numbers have lost digits.
        return f"{text}, at least {low:.3g}" if 0.0 < value < low == ABOVE_ZERO else text


class Table:
    """All variables of a model with their quantities and units.

    Parameters
    ----------
    units
        Units by name.
    quantities
        Types, in the order of the model description; as an attribute, by name.
    rows
        Variables in any order; as an attribute, in the order of their numbers.

    Attributes
    ----------
    by_name
        Variables by name.

    Raises
    ------
    ValueError
        If a name or number is given twice, the numbers are not 0 to n - 1, a name is no
        identifier, a type, unit or dependency is not in the table, or a start value is missing or
        out of its range.
    """

    def __init__(
        self, units: Mapping[str, Unit], quantities: Iterable[Quantity], rows: Iterable[Variable]
    ) -> None:
        quantities = tuple(quantities)
        self.units = dict(units)
        self.quantities = {quantity.name: quantity for quantity in quantities}
        self.rows = tuple(sorted(map(_with_floats, rows), key=lambda row: row.number))
        self.by_name = {row.name: row for row in self.rows}
        if len(self.quantities) < len(quantities):
            raise ValueError("two quantities have one name")
        for quantity in quantities:
            if quantity.kind not in _KINDS:
                raise ValueError(f"{quantity.name}: {quantity.kind} is none of {', '.join(_KINDS)}")
            if quantity.unit and quantity.unit not in self.units:
                raise ValueError(f"{quantity.name}: the unit {quantity.unit} is not in the table")
        for position, row in enumerate(self.rows):
            objection = self._objection(row, position)
            if objection is not None:
                raise ValueError(f"{row.name}: {objection}")

    @property
    def time_reference(self) -> int:
        """Value reference of the time, which FMI 3.0 lists as a variable."""
        return len(self.rows)

    def start_values(self) -> Dict[str, float]:
        """Return the start value of every parameter and input, by name."""
        return {row.name: row.start for row in self.rows if row.settable and row.start is not None}

    def _objection(self, row: Variable, position: int) -> Optional[str]:
        """Return the error of the row at `position`, or None."""
        if row.number != position:
            return f"number {row.number} where {position} is due; numbers are 0 to n - 1, each once"
        if self.by_name[row.name] is not row:
            return "the name is given twice"
        if not row.name.isidentifier() or keyword.iskeyword(row.name):
            return "the name is no Python identifier"
        if row.causality not in _CAUSALITIES:
            return f"the causality {row.causality} is none of {', '.join(_CAUSALITIES)}"
        if row.variability not in _VARIABILITIES:
            return f"the variability {row.variability} is none of {', '.join(_VARIABILITIES)}"
        if row.minimum is not None and row.maximum is not None and row.minimum > row.maximum:
            return f"the minimum {row.minimum} is above the maximum {row.maximum}"
        if row.name == "time":
            return "the name is that of the independent variable"
        if self.quantities.get(row.type.name) != row.type:
            return f"the quantity {row.type.name} is not in the table"
        unknown = [name for name in row.depends if name not in self.by_name]
        if unknown:
            return f"depends on {unknown[0]}, which is not in the table"
        if row.start is None:
            return "a parameter or input needs a start value" if row.settable else None
        if row.kind == "Integer" and not isinstance(row.start, int):
            return f"the start value {row.start!r} of an Integer is no whole number"
        return row.objection(row.start)


def _with_floats(row: Variable) -> Variable:
    """Return a row whose start value is a float if the variable is a Real: 1 is given for 1.0."""
    if row.kind == "Real" and row.start is not None:
        return row._replace(start=float(row.start))
    return row


def copier(kind: type, names: Iterable[str]) -> Callable[[Any], Any]:
    """Return a function that copies an object of a class, one statement a field.

    A simulator may set an input and take a state at every step: a loop over the names takes three
    times as long.
    """
    lines = ["def copy(self):", "    twin = new(kind)"]
    lines += [f"    twin.{name} = self.{name}" for name in names]
    scope: Dict[str, Any] = {"new": object.__new__, "kind": kind}
    exec("\n".join([*lines, "    return twin"]), scope)
    copy: Callable[[Any], Any] = scope["copy"]
    return copy


class Values:
    """The values of all parameters and inputs, each an attribute of the variable's name.

    Values never change once made, so models and states may share them: see `changed`. The record
    of a model is a subclass that names the table, ``class Settings(Values, table=TABLE)``, and may
    add methods.

    Parameters
    ----------
    values
        The value of every name of `names`, in the unit of its row. A whole number of an Integer may
        be given as a float.

    Attributes
    ----------
    table
        The table.
    names
        Names of the settable variables.
    """

    table: ClassVar[Table]
    names: ClassVar[Tuple[str, ...]] = ()
    _copy: ClassVar[Callable[[Any], Any]]

    def __init_subclass__(cls, table: Optional[Table] = None) -> None:
        if table is not None:
            taken = set(dir(cls)) - set(cls.names)
            cls.table = table
            cls.names = tuple(row.name for row in table.rows if row.settable)
            for name in cls.names:
                if name in taken:
                    raise ValueError(f"{name}: {cls.__name__} has another attribute of this name")
        # Every class copies into its own kind.
        cls._copy = copier(cls, cls.names)

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> float:
            """Return the value of a variable."""
            raise NotImplementedError

    def __init__(self, values: Mapping[str, float]) -> None:
        for name in self.names:
            value = values[name]
            if isinstance(value, float) and self.table.by_name[name].kind == "Integer":
                value = int(value) if value.is_integer() else value
            setattr(self, name, value)

    def changed(self: _Record, name: str, value: float) -> _Record:
        """Return these values, but for one."""
        twin: _Record = self._copy()
        setattr(twin, name, value)
        return twin

    @classmethod
    def at_start(cls: Type[_Record]) -> _Record:
        """Return the start values of the table."""
        return cls(cls.table.start_values())

    def as_dict(self) -> Dict[str, float]:
        """Return the values by name."""
        return {name: getattr(self, name) for name in self.names}
