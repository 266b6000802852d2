"""Ranges of a quantity as people write them: `0.1..50 mm/s log 400`, `1e3..1e5 N/m 50`."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .quantity import QuantityError, parts_of, typed

Read: TypeAlias = Callable[[str, str], float]
"""Reads a quantity: text and unit of the result; raises `QuantityError`."""

EXAMPLE: Final = "0.1..50 mm/s log 400"
BETWEEN: Final = ".."
"""What stands between the ends of a range."""

MOST_VALUES: Final = 10_000_000
"""Most values of a range: they are held in memory."""

_SPACED: Final = {"log": True, "lin": False}
_COUNT: Final = re.compile(r"[+-]?\d{1,18}", re.ASCII)


@dataclass(frozen=True)
class Range:
    """Values from `low` to `high`, both among them, in the unit that was asked for."""

    low: float
    high: float
    count: int
    """How many values, at least 2."""
    log: bool
    """Whether each value has the same ratio to the next, in place of the same distance."""
    symbol: str = ""
    """The unit as it was written; "" for none."""

    def values(self) -> NDArray[np.float64]:
        """Return the values, shape (count,), rising; the ends are exact."""
        spaced = np.geomspace if self.log else np.linspace
        return np.asarray(spaced(self.low, self.high, self.count), dtype=np.float64)


def parse_range(text: str, unit: str, *, read: Read = typed, count: int | None = None) -> Range:
    """Read a range: ``LOW..HIGH [UNIT] [log|lin] [COUNT]``.

    A unit of one end counts for both, and each may have its own (``900 um/s..2 mm/s 12``). Without
    ``log`` the distances are equal. `read` reads one end, given text and the `unit` of the result;
    `count` is how many values a range has that does not say it, None: that is refused.

    Raises
    ------
    QuantityError
        If the text is no range, runs backwards, is empty, or is logarithmic and not above 0; or as
        `read` raises it. The message gives the reason alone: it follows a name and the text.
    """
    low_text, between, rest = (part.strip() for part in text.partition(BETWEEN))
    if not between or BETWEEN in rest or rest.startswith("."):
        raise QuantityError(f"is no range; expected such as {EXAMPLE!r}")
    number, tail = parts_of(rest)
    words, spacing, counts = tail.split(), list[str](), list[str]()
    while words and (words[-1] in _SPACED or _COUNT.fullmatch(words[-1])):
        (spacing if words[-1] in _SPACED else counts).append(words.pop())
    for what, said in (("spacing", spacing), ("count", counts)):
        if len(said) > 1:
            raise QuantityError(f"has two words for its {what}")
    if not counts and count is None:
        raise QuantityError(f"does not end with how many values; expected such as {EXAMPLE!r}")
    count = int(counts[0]) if counts else count or 0
    log = spacing == ["log"]
    low_number, low_symbol = parts_of(low_text)
    symbol = " ".join(words) or low_symbol
    low = read(f"{low_number} {low_symbol or symbol}".strip(), unit)
    high = read(f"{number} {symbol}".strip(), unit)
    if not 2 <= count <= MOST_VALUES:
        raise QuantityError(f"has {count} values; 2 to {MOST_VALUES:g} are possible")
    if low == high:
        raise QuantityError("is empty: both ends are the same")
    if low > high:
        raise QuantityError("is reversed: its end must be above its begin")
    if log and low <= 0.0:
        raise QuantityError("is logarithmic and begins at 0 or below; expected both ends above 0")
    return Range(low, high, count, log, symbol)
