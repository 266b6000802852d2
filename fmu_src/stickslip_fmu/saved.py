"""Saved states of a block: whether plain data can be one."""

from typing import Any, Dict, Iterable, List

from fmukit.model import ModelError
from fmukit.plain import check

from .meter import MOST_SLIPS


def check_saved(saved: Any, pattern: Dict[str, Any]) -> None:
    """Raise ModelError unless `saved` can be what a block saved; `pattern` is what one saved."""
    # The last entry of an arc is a force, or None where there is none.
    check(saved, {**pattern, "arc": [0, 0.0, 0.0, (0.0, None)]})
    mode, force = saved["arc"][0], saved["arc"][3]
    meter = saved["meter"]
    if not (
        mode in (-1, 0, 1)
        and (mode == 0 or force is not None)
        and saved["elapsed"][0] >= 0.0
        and 0 <= meter["n_slips"] <= MOST_SLIPS
        and all(map(_is_sum, _sums(saved)))
        and all(meter[name] >= 0.0 for name in ("t_slip", "t_stick", "T"))
        and saved["Q_friction"][0] >= 0.0
    ):
        raise ModelError("the saved state has values that no block reaches")


def _sums(saved: Dict[str, Any]) -> Iterable[List[float]]:
    """Return all compensated sums."""
    names = ("elapsed", "x", "W_pull", "W_k", "Q_friction")
    return (
        *(saved[name] for name in names),
        *(value for value in saved["meter"].values() if isinstance(value, list)),
    )


def _is_sum(parts: List[float]) -> bool:
    """Whether the second number is what rounding left of the first, as `compensated.add` has it."""
    high, low = parts
    return high + low == high
