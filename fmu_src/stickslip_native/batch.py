"""The native block in Python, for many runs in one call: compiled once, then called."""

import ctypes
import math
from array import array
from functools import lru_cache
from typing import Any, Iterator, Mapping, NamedTuple, Optional, Protocol, Union

from fmi.table import Variable
from stickslip_fmu.laws.named import COULOMB_NAME

from .library import load
from .named import HOME, native_law
from .table import table_files

_FILES = ("core/*.[ch]", "face/text.[ch]", "face/export.h", "batch/*.c")
_BESIDE = ("continuous.c", "ramp.c")
"""Sources of the core that first slips do not need."""
_REASON_SIZE = 512


class Numbers(Protocol):
    """A list, tuple or array of numbers."""

    def __len__(self) -> int: ...

    def __iter__(self) -> Iterator[Any]: ...


class FirstSlips(NamedTuple):
    """The first slip of each run.

    Attributes
    ----------
    t_stick
        Length of the stick before it [s]; infinite where the mass never breaks away.
    t_slip
        Length of the slip [s]; infinite where the mass slips for ever.
    delta_x
        Displacement of the mass in it [m].
    spring_drop
        Fall of the spring extension over it [m].
    x_dot_peak
        Velocity of largest magnitude in it [m/s].

    What follows an infinite length is not a number.
    """

    t_stick: "array[float]"
    t_slip: "array[float]"
    delta_x: "array[float]"
    spring_drop: "array[float]"
    x_dot_peak: "array[float]"


def first_slips(values: Mapping[str, Union[float, Numbers]], law: str = COULOMB_NAME) -> FirstSlips:
    """Compute the first slip of many runs, each exactly, on one core.

    A run starts as the block does: at rest at `z_start`, or in motion where `x_dot_start` is not 0.
    A slip ends where the mass comes to rest, also where it then slips the other way.

    Parameters
    ----------
    values
        Parameters and inputs of the block by name [SI units]: a number for all runs, or one for
        each. What is not named has its start value.
    law
        Name of a built-in friction law with a native side.

    Returns
    -------
    FirstSlips
        Arrays of one number a run. Where all values are numbers there is one run.

    Raises
    ------
    CompilerError
        If no C compiler is installed, or it fails.
    ValueError
        If a name is unknown, lists differ in length, or a value is out of range, alone or together
        with the others; the message names the run, from 0 on.
    """
    table = native_law(law).spec.table
    single = {name: value for name, value in values.items() if isinstance(value, (int, float))}
    lists = {
        name: array("d", [single[name]] if name in single else list(value))  # type: ignore[arg-type]
        for name, value in values.items()
    }
    lengths = {name: len(list_) for name, list_ in lists.items() if name not in single}
    if len(set(lengths.values())) > 1:
        texts = (f"{name} has {length}" for name, length in lengths.items())
        raise ValueError("the lists differ in length: " + ", ".join(texts))
    count = max(lengths.values(), default=1)
    for name, list_ in lists.items():
        _check(table.by_name.get(name), name, list_)
    names = [row.name for row in table.rows if row.settable]
    settings = array("d", bytes(8 * count * len(names)))
    start = table.start_values()
    for place, name in enumerate(names):
        list_ = lists.get(name, array("d", [start[name]]))
        settings[place :: len(names)] = list_ if name in lengths else list_ * count
    width = len(FirstSlips._fields)
    slips = array("d", bytes(8 * count * width))
    reason = ctypes.create_string_buffer(_REASON_SIZE)
    computed = _function(law)(_address(settings), count, _address(slips), reason)
    if computed < count:
        raise ValueError(f"run {computed}: {reason.value.decode()}")
    return FirstSlips(*(slips[place::width] for place in range(width)))


def _check(row: Optional[Variable], name: str, values: "array[float]") -> None:
    """Raise ValueError for the first value that the variable cannot take."""
    if row is None or not row.settable:
        raise ValueError(f"{name!r} is no parameter or input of the block")
    # Of many values the extremes tell: only a wrong list is looked through.
    finite = row.kind == "Real" and len(values) > 0 and all(map(math.isfinite, values))
    if finite and not any(map(row.objection, (min(values), max(values)))):
        return
    for number, value in enumerate(values):
        objection = row.objection(value)
        if objection is not None:
            raise ValueError(f"run {number}: {objection}")


def _address(numbers: "array[float]") -> int:
    return numbers.buffer_info()[0]


@lru_cache(maxsize=None)
def _function(law: str) -> Any:
    """Return the function `first_slips` of the core under a friction law, compiled."""
    spec, own, _ = native_law(law)
    sources = {name: text.encode() for name, text in table_files(spec).items()}
    files = [file for pattern in _FILES for file in HOME.glob(pattern)]
    files = [file for file in files if file.name not in _BESIDE]
    sources.update((file.name, file.read_bytes()) for file in (*files, *own))
    function = load("batch", sources).first_slips
    function.restype = ctypes.c_size_t
    function.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p, ctypes.c_char_p]
    return function
