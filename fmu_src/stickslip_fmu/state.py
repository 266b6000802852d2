"""The state of an instance: quick to take and to set again, and as bytes for another process.

A state that was taken is an object of a class of its own, never written to again, so setting it
needs no look inside. What comes as bytes is looked at once, when it is read.
"""

import json
import math
from typing import Any, Dict, Iterable, List, Optional

from .meter import MOST_SLIPS
from .model import Block
from .settings import Settings
from .variables import VARIABLES_BY_NAME, start_values

PHASES = ("instantiated", "initialization", "stepping", "terminated")


class State:
    """Everything that a later call depends on.

    Attributes
    ----------
    block
        What `Block.freeze` gave.
    settings
        What is set.
    time
        The start time, or the time reached by a face that must tell it [s].
    phase
        One of PHASES.
    settled
        Whether the block shows what is set.
    """

    __slots__ = ("_bytes", "block", "phase", "settings", "settled", "time")

    def __init__(
        self, block: Any, settings: Settings, time: float, phase: str, settled: bool
    ) -> None:
        self.block = block
        self.settings = settings
        self.time = time
        self.phase = phase
        self.settled = settled
        self._bytes: Optional[bytes] = None

    def to_bytes(self) -> bytes:
        """Return the state as text in JSON, whose numbers keep all their digits."""
        if self._bytes is None:
            block = _any_block()
            block.thaw(self.block)
            self._bytes = json.dumps(
                {
                    "block": block.save(),
                    "settings": self.settings.as_dict(),
                    "time": self.time,
                    "phase": self.phase,
                    "settled": self.settled,
                }
            ).encode("utf-8")
        return self._bytes


def from_bytes(content: bytes) -> Optional[State]:
    """Return the state that these bytes hold, or None where they hold none."""
    state = json.loads(content.decode("utf-8"))
    block = _any_block()
    if not _is_state(state, block.save()):
        return None
    block.restore(state["block"])
    return State(
        block.freeze(), Settings(state["settings"]), state["time"], state["phase"], state["settled"]
    )


def _any_block() -> Block:
    return Block(Settings(start_values()))


def _is_state(state: Any, block: Dict[str, Any]) -> bool:
    """Whether `state` can be one that was written; `block` is what some block saved."""
    pattern = {
        "block": block,
        "settings": block["settings"],
        "time": 0.0,
        "phase": "",
        "settled": True,
    }
    if not _is_like(state, pattern):
        return False
    block = state["block"]
    mode, force = block["arc"][0], block["arc"][3]
    return (
        state["phase"] in PHASES
        and mode in (-1, 0, 1)
        and (mode == 0 or force is not None)
        and block["elapsed"][0] >= 0.0
        and 0 <= block["meter"]["n_slips"] <= MOST_SLIPS
        and all(map(_is_sum, _sums(block)))
        and all(block["meter"][name] >= 0.0 for name in ("t_slip", "t_stick", "T"))
        and block["Q_friction"][0] >= 0.0
        and all(
            VARIABLES_BY_NAME[name].objection(value) is None
            for values in (state["settings"], block["settings"], block["wanted"])
            for name, value in values.items()
        )
    )


def _sums(block: Dict[str, Any]) -> Iterable[List[float]]:
    """Return all compensated sums in what a block saved."""
    names = ("elapsed", "x", "W_pull", "W_k", "Q_friction")
    return (
        *(block[name] for name in names),
        *(value for value in block["meter"].values() if isinstance(value, list)),
    )


def _is_sum(parts: List[float]) -> bool:
    """Whether the second number is what rounding left of the first, as `compensated.add` has it."""
    high, low = parts
    return high + low == high


def _is_like(value: Any, pattern: Any, key: str = "") -> bool:
    """Whether a value has the structure and the types of another, and finite numbers."""
    if isinstance(pattern, dict):
        return (
            isinstance(value, dict)
            and value.keys() == pattern.keys()
            and all(_is_like(value[each], pattern[each], each) for each in pattern)
        )
    if key == "arc":
        # Its last entry is a force, or None where there is none.
        return _is_like(value, [0, 0.0, 0.0, 0.0]) or _is_like(value, [0, 0.0, 0.0, None])
    if isinstance(pattern, list):
        return (
            isinstance(value, list)
            and len(value) == len(pattern)
            and all(map(_is_like, value, pattern))
        )
    return type(value) is type(pattern) and (type(value) is not float or math.isfinite(value))
