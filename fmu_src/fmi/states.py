"""States of an instance, and the handles by which a simulator holds them.

The wrapper gives the simulator the address of a Python object for a state, releases one reference
when the state is freed, and leaves the address with the simulator. So that a second use of the
address finds the handle and no other object, a handle that was freed is kept for a while, without
its state and with references that may be released again.
"""

import atexit
import json
import sys
from collections import deque
from typing import Any, Callable, Deque, NamedTuple, Optional, Tuple, Type

from .lifetime import give_reference
from .model import Model, ModelError, Spec
from .plain import check, values
from .table import Values

PHASES = ("instantiated", "initialization", "stepping", "terminated")

# Most freed handles that are not let go, and references to each.
_MOST_FREED = 512
_REFERENCES = 8


class State(NamedTuple):
    """Everything that a later call depends on.

    Attributes
    ----------
    kind
        Class of the model.
    model
        The state that `Model.freeze` returned.
    values
        The values as last set.
    time
        The start time, or the time reached where the FMI version tells it [s].
    phase
        One of PHASES.
    settled
        Whether the outputs follow the values that are set.
    """

    kind: Type[Model]
    model: Any
    values: Values
    time: float
    phase: str
    settled: bool

    def to_bytes(self) -> bytes:
        """Return the state as JSON, whose numbers keep all their digits."""
        model = self.kind(type(self.values).at_start())
        model.thaw(self.model)
        fields = {**self._asdict(), "model": model.save(), "values": self.values.as_dict()}
        del fields["kind"]
        return json.dumps(fields).encode("utf-8")


def from_bytes(spec: Spec, content: bytes) -> State:
    """Return the state that `State.to_bytes` wrote for this model; raises ValueError for others."""
    state = json.loads(content.decode("utf-8"))
    if not isinstance(state, dict) or state.get("phase") not in PHASES:
        raise ModelError("the bytes hold no state")
    model = spec.start()
    # The two members without a pattern here are checked as they are read.
    saved, plain = state.pop("model", None), state.pop("values", None)
    check(state, {"time": 0.0, "phase": "", "settled": True})
    model.restore(saved)
    return State(spec.model, model.freeze(), values(spec.values, plain), **state)


def _count(handles: Tuple[Any, ...]) -> int:
    """Return the reference count of the object in a tuple, those of this call included."""
    return sys.getrefcount(handles[0])


# The count while no reference was released.
_WHOLE = _count((object(),) * _REFERENCES)


def _make_whole(handles: Tuple[Any, ...]) -> None:
    """Give back the references that were released, so that the tuple can be let go."""
    for _ in range(_WHOLE - _count(handles)):
        give_reference(handles[0])


_freed: Deque[Tuple["Handle", ...]] = deque()


@atexit.register
def _make_all_whole() -> None:
    """Give back all references before the end of the process lets all tuples go."""
    while _freed:
        _make_whole(_freed.popleft())


class Handle:
    """State handle of a simulator.

    Attributes
    ----------
    state
        The state; None once the handle was freed, or where the bytes held none.
    """

    __slots__ = ("_bytes", "state")

    def __init__(self, state: Optional[State]) -> None:
        self.state = state
        self._bytes: Optional[bytes] = None

    def to_bytes(self) -> bytes:
        """Return the state as JSON, made once: the simulator asks for its size first."""
        if self._bytes is None:
            self._bytes = b"null" if self.state is None else self.state.to_bytes()
        return self._bytes

    # The defaults hold what the method needs: at the end of the process the module goes first.
    def __del__(
        self,
        freed: Deque[Tuple["Handle", ...]] = _freed,
        most: int = _MOST_FREED,
        references: int = _REFERENCES,
        make_whole: Callable[[Tuple["Handle", ...]], None] = _make_whole,
    ) -> None:
        """Drop the state and keep the handle; Python calls this at the first release only."""
        self.state = self._bytes = None
        freed.append((self,) * references)
        if len(freed) > most:
            make_whole(freed.popleft())
