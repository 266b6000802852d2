"""Saved states of a block: whether plain data can be one."""

from typing import Any, Dict, Sequence

from fmi.model import ModelError
from fmi.plain import check

from .meter import MOST_SLIPS


def check_saved(saved: Any, pattern: Dict[str, Any]) -> None:
    """Raise ModelError unless `saved` can be what a block saved; `pattern` is what one saved."""
    mode, z, x_dot, _, age, own = pattern["arc"]
    check(saved, {**pattern, "arc": [mode, z, x_dot, (0.0, None), age, own]})
    mode, _, _, force, age, _ = saved["arc"]
    meter = saved["meter"]
    sums = [saved[name] for name in ("x", "W_pull", "W_k", "Q_friction")]
    sums += [value for value in meter.values() if isinstance(value, list)]
    if not (
        mode in (-1, 0, 1)
        and (mode == 0 or force is not None)
        and age >= 0.0
        and saved["elapsed"] >= 0.0
        and 0 <= meter["n_slips"] <= MOST_SLIPS
        and all(map(_is_sum, [*sums, (saved["elapsed"], saved["elapsed_low"])]))
        and all(meter[name] >= 0.0 for name in ("t_slip", "t_stick", "T"))
        and saved["Q_friction"][0] >= 0.0
    ):
        raise ModelError("the saved state has values that no block reaches")


def _is_sum(parts: Sequence[float]) -> bool:
    """Whether the second number is what rounding left of the first, as `compensated.add` has it."""
    high, low = parts
    return high + low == high
