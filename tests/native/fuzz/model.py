"""What each call of a sequence must give on the native FMU: where it differs from the Python FMU.

A refused call is an error and not fatal, nothing goes to standard error, a damaged state is refused
where it is read, and a freed state is known as long as the instance lives that freed it.
"""

import re
from typing import Any

from tests.fmu.fuzz.model import (
    DISCARD,
    ERROR,
    OK,
    WARNING,
    BlockFaultError,
    Instance,
    Model,
    MustRefuseError,
    bits,
)
from tests.fmu.fuzz.sequences import Call
from tests.fmu.inside import SKIPPED

# Of calls that the FMU does not offer: they change nothing.
_UNSUPPORTED = "FMI function not supported: "


class BlockRefusalError(MustRefuseError):
    """The block refuses; the text is that of the message."""


class RangeError(MustRefuseError):
    """A value is out of range; the text is how the message begins."""


class NativeModel(Model):
    """The instances and states of one sequence, and what each of its calls must give."""

    def __init__(self, law: str = "coulomb") -> None:
        super().__init__(law)
        self._logged: dict[int, tuple[bool, bool]] = {}
        # Time of the last step or start, of instances and of states.
        self._times: dict[int, float] = {}
        self._freed_by: dict[int, int] = {}

    def objection(self, call: Call, outcome: list[Any]) -> str | None:
        """Return what is wrong with what came back from a call; None where nothing is."""
        name, *arguments = call
        status, values, messages = outcome
        self.warns = False
        refused: MustRefuseError | None = None
        try:
            expected, wanted = getattr(self, f"_{name}")(*arguments)
        except MustRefuseError as error:
            refused, expected, wanted = error, ERROR, None
        except BlockFaultError as surprise:
            return str(surprise)
        if status != expected:
            return f"status {status}, expected {expected}: {refused}"
        if wanted is not None and bits(values) != bits(wanted):
            return f"gives {values}, expected {wanted}"
        if name in ("free", "version"):
            return f"logs {messages}" if messages else None
        instance = self.instances[arguments[0]]
        warnings, errors = self._logged[arguments[0]]
        if refused is not None:
            return self._objection_to_words(instance, errors, messages, refused)
        if name in ("cancel", "derivatives"):
            due = [_UNSUPPORTED] if errors else []
        else:
            due = [WARNING.pattern] if self.warns and warnings else []
        if len(messages) != len(due) or not all(map(re.search, due, messages)):
            return f"logs {messages}, expected {due}"
        return None

    @staticmethod
    def _objection_to_words(  # type: ignore[override]
        instance: Instance, heard: bool, messages: list[str], refused: MustRefuseError
    ) -> str | None:
        """Return what is wrong with how a call was refused: in the words of the first time."""
        texts = [text for text in messages if not WARNING.search(text)]
        first = instance.fault is None
        if len(texts) != int(heard):
            return f"refuses with {messages} in the log"
        if first:
            instance.fault = texts[0] if texts else ""
        if texts and instance.fault and texts[0] != instance.fault:
            return f"refuses with {texts[0]!r}, before with {instance.fault!r}"
        if texts and first:
            whole = isinstance(refused, BlockRefusalError) and texts[0] != str(refused)
            beginning = isinstance(refused, RangeError) and not texts[0].startswith(str(refused))
            if whole or beginning:
                return f"refuses with {texts[0]!r}, expected {str(refused)!r}"
        return None

    @staticmethod
    def _of_block(instance: Instance, moderate: bool, call: Any) -> Any:
        try:
            return Model._of_block(instance, moderate, call)
        except MustRefuseError as error:
            raise BlockRefusalError(*error.args) from None

    def _set_one(self, instance: Instance, name: str, value: Any) -> None:
        try:
            super()._set_one(instance, name, value)
        except MustRefuseError as error:
            if "out of range" in str(error):
                raise RangeError(f"{name} = {value!r} ") from None
            raise

    def _instantiate(self, i: int, name: str, logging: bool) -> Any:
        self._logged[i] = True, True
        self._times[i] = 0.0
        return super()._instantiate(i, name, logging)

    def _free(self, i: int) -> Any:
        self.freed = {slot: it for slot, it in self.freed.items() if self._freed_by[slot] != i}
        return super()._free(i)

    def _reset(self, i: int) -> Any:
        self._times[i] = 0.0
        return super()._reset(i)

    def _set_up(self, i: int, start: float, stop: float | None, tolerance: float | None) -> Any:
        given = super()._set_up(i, start, stop, tolerance)
        self._times[i] = start
        return given

    def _step(self, i: int, time: float, step: float, no_state_prior: bool) -> Any:
        given = super()._step(i, time, step, no_state_prior)
        self._times[i] = time + step
        return given

    def _get_state(self, i: int, slot: int) -> Any:
        given = super()._get_state(i, slot)
        state = self.states[slot]
        assert state is not None
        state["time"] = self._times[i]
        return given

    def _set_state(self, i: int, slot: int) -> Any:
        given = super()._set_state(i, slot)
        if given[0] == OK:
            state = self.states[slot]
            assert state is not None
            self._times[i] = state["time"]
        return given

    def _free_state(self, i: int, slot: int) -> Any:
        self._freed_by[slot] = i
        return super()._free_state(i, slot)

    def _set_null(self, i: int) -> Any:
        self._sound(i)
        raise MustRefuseError("no state")

    def _deserialize(self, i: int, packed: int, slot: int, damage: str) -> Any:
        if packed not in self.packed:
            return SKIPPED, None
        self.states.pop(slot, None)
        if damage:
            raise MustRefuseError("bytes that hold no state")
        self.states[slot] = self.packed[packed]
        return OK, None

    def _status(self, i: int, which: int, kind: int) -> Any:
        if which == 1 and kind == 2:
            return OK, [self._times[i]]
        if which == 3 and kind == 3:
            return OK, [0]
        return DISCARD, None

    def _debug(self, i: int, on: bool, categories: list[str]) -> Any:
        every = on and (not categories or "logAll" in categories)
        self._logged[i] = every or (on and "logStatusWarning" in categories), every
        return OK, None
