"""The rules of phases, of who may be set when and of failures, a second time, apart from the faces.

The motion is that of a block driven straight; a state is a deep copy of it.
"""

import copy
import math
import re
import struct
from dataclasses import dataclass
from typing import Any, NamedTuple

from fmi.model import ModelError
from fmi.table import Variable
from tests.driver import DISCARD, ERROR, FATAL, OK, WARNING, numbers_as_repr
from tests.fmu.blocks import spec_named
from tests.fmu.lives.player import SKIPPED, Call, Outcome

_NO_STATE = "the state to set is none that this FMU handed out"
_TOO_LONG = "it holds more than "
_CURVE = 3
_WARNED = re.compile("clamped to|is ignored")


class MustRefuseError(Exception):
    """The call must be refused; the message must hold the text."""


class Expected(NamedTuple):
    """What a call must give: status, values, text of a refusal, whether it warns."""

    status: int
    values: list[Any] | None = None
    text: str = ""
    warns: bool = False


@dataclass
class Life:
    """One instance as it should be; its block is there from the end of initialization on."""

    settings: dict[str, float]
    phase: str = "instantiated"
    fault: str | None = None
    start_time: float = 0.0
    time: float = 0.0
    block: Any = None
    warned: Any = None

    def state(self) -> dict[str, Any]:
        names = ("settings", "phase", "start_time", "time", "block")
        return {name: copy.deepcopy(getattr(self, name)) for name in names}


class Contract:
    def __init__(self, kind: str, law: str) -> None:
        self.native, self.face = kind.startswith("native"), int(kind[-1])
        self.spec = spec_named(law)
        self.rows = self.spec.table.rows
        self.lives: dict[int, Life] = {}
        # None stands for a state that the FMU never handed out.
        self.states: dict[int, dict[str, Any] | None] = {}
        self.packed: dict[int, dict[str, Any] | None] = {}
        # The instance that freed the state of a slot.
        self.freed: dict[int, int] = {}
        self._warns = False

    def expected(self, call: Call) -> Expected:
        name, i, *arguments = call
        self._warns = False
        try:
            values = getattr(self, name)(i, *arguments)
        except KeyError:
            return Expected(SKIPPED)
        except MustRefuseError as refusal:
            life = self.lives[i]
            if self.native and life.fault is None and _TOO_LONG in str(refusal):
                return Expected(DISCARD, text=_TOO_LONG)
            if life.fault is None:
                life.fault = str(refusal)
            return Expected(ERROR if self.native else FATAL, text=life.fault)
        return Expected(OK, values, warns=self._warns)

    def type_of(self, reference: int) -> str:
        if reference >= len(self.rows):
            return "Float64"
        quantity = self.rows[reference].type
        if self.face == 2:
            return quantity.kind
        integer = "Int64" if quantity.items else "Int32"
        return {"Real": "Float64", "Integer": integer}.get(quantity.kind, quantity.kind)

    def where(self, i: int) -> str:
        life = self.lives[i]
        if life.fault is not None or life.phase != "stepping":
            return "failed" if life.fault is not None else life.phase
        return ("backward slip", "stick", "forward slip")[life.block.mode + 1]

    def instantiate(self, i: int, name: str) -> None:
        self.lives[i] = Life(self.spec.table.start_values())

    def free(self, i: int) -> None:
        del self.lives[i]
        # The native FMU knows a freed state as long as the instance is there that freed it.
        self.freed = {slot: by for slot, by in self.freed.items() if by != i}

    def reset(self, i: int) -> None:
        self.lives[i] = Life(self.spec.table.start_values())

    def set_up(self, i: int, start: float, stop: float | None) -> None:
        if self.face == 3:
            raise KeyError
        life = self._sound(i)
        if math.isfinite(start):
            self._be(life, "instantiated", "setupExperiment")
        self._date(life, start)

    def enter(self, i: int, start: float) -> None:
        life = self._sound(i)
        self._be(life, "instantiated", "enterInitializationMode")
        if self.face == 3:
            self._date(life, start)
        life.phase = "initialization"

    def exit(self, i: int) -> None:
        life = self._sound(i)
        self._be(life, "initialization", "exitInitializationMode")
        life.block = self._block(life)
        life.phase = "stepping"
        self._warn(life)

    def terminate(self, i: int) -> None:
        self._sound(i).phase = "terminated"

    def step(self, i: int, time: float, step: float) -> None:
        life = self._sound(i)
        self._be(life, "stepping", "doStep")
        self._warn(life)
        # A step that is too long leaves the block as it was.
        block = copy.deepcopy(life.block)
        self._of_block(block.advance, time, step)
        life.block, life.time = block, time + step

    def get(self, i: int, kind: str, references: list[int]) -> list[Any]:
        life = self._sound(i)
        block = life.block or self._block(life)
        for reference in references:
            self._be_of_kind(reference, kind)
        self._of_block(block.refresh)
        return [self._of_block(self._read, life, block, reference) for reference in references]

    def set(self, i: int, kind: str, references: list[int], values: list[Any]) -> None:
        life = self._sound(i)
        if kind == "Float64" and len(self.rows) in references:
            raise MustRefuseError("time is the independent variable: it cannot be set")
        for reference, value in zip(references, values, strict=True):
            self._be_of_kind(reference, kind)
            self._set_one(life, self.rows[reference], value)
        if life.phase == "stepping":
            self._of_block(life.block.check)

    def save(self, i: int, slot: int) -> None:
        self.states.pop(slot, None)
        self.states[slot] = self._sound(i).state()

    def restore(self, i: int, slot: int) -> None:
        state, life = self.states[slot], self.lives[i]
        if state is None:
            raise MustRefuseError(life.fault or _NO_STATE)
        life.fault = None
        for name, value in copy.deepcopy(state).items():
            setattr(life, name, value)

    def forget(self, i: int, slot: int) -> None:
        del self.states[slot]
        self.freed[slot] = i

    def forget_again(self, i: int, slot: int) -> None:
        # The pointer may be left as it was, where FMI makes it NULL: this must do nothing.
        del self.freed[slot]

    def restore_freed(self, i: int, slot: int) -> None:
        if slot not in self.freed:
            raise KeyError
        self._sound(i)
        raise MustRefuseError(_NO_STATE)

    def pack(self, i: int, slot: int, place: int) -> None:
        self.packed[place] = self.states[slot]

    def unpack(self, i: int, place: int, slot: int, damage: str) -> None:
        state = self.packed[place]
        self.states.pop(slot, None)
        if damage and self.native:
            raise MustRefuseError(self.lives[i].fault or "")
        self.states[slot] = None if damage else state

    def _sound(self, i: int) -> Life:
        life = self.lives[i]
        if life.fault is not None:
            raise MustRefuseError(life.fault)
        return life

    @staticmethod
    def _be(life: Life, phase: str, call: str) -> None:
        if life.phase != phase:
            said = f"{call} is not allowed here: the instance is in phase {life.phase}"
            raise MustRefuseError(said)

    @staticmethod
    def _date(life: Life, start: float) -> None:
        if not math.isfinite(start):
            raise MustRefuseError(f"start time = {start!r} s is out of range: a finite number")
        life.start_time = life.time = start

    def _be_of_kind(self, reference: int, kind: str) -> None:
        if reference > len(self.rows) - (self.face == 2):
            raise MustRefuseError("there is no variable with value reference ")
        if self.type_of(reference) != kind:
            raise MustRefuseError(f", not {kind}" if reference < len(self.rows) else "")

    def _set_one(self, life: Life, row: Variable, value: Any) -> None:
        name, running = row.name, life.phase == "stepping"
        if life.phase == "terminated":
            raise MustRefuseError(f"{name} cannot be set: the simulation is terminated")
        if row.causality == "output":
            if running or row.start is None or value != row.start:
                raise MustRefuseError(f"{name} is an output: it cannot be set")
            return
        if running and row.variability == "fixed":
            if value != life.settings[name]:
                raise MustRefuseError(f"{name} is fixed: it cannot change after initialization")
            return
        low = -math.inf if row.minimum is None else row.minimum
        high = math.inf if row.maximum is None else row.maximum
        if not (math.isfinite(value) and low <= value <= high):
            raise MustRefuseError(f"{name} = {value!r} ")
        life.settings[name] = value
        if running:
            life.block.set(name, value)

    def _warn(self, life: Life) -> None:
        settings = life.settings
        due: tuple[Any, ...] | None = None
        if settings.get("shape") == _CURVE:
            starts = self.spec.table.start_values()
            beyond = range(int(settings["n_points"]) + 1, 13)
            points = [f"{name}_{n}" for n in beyond for name in ("u", "mu")]
            # The first of each group is named.
            ignored = [
                [(name, settings[name]) for name in group if settings[name] != starts[name]][:1]
                for group in (["mu_k"], points)
            ]
            due = (settings["n_points"], ignored) if any(ignored) else None
        elif settings["mu_k"] > settings["mu_s"]:
            due = settings["mu_s"], settings["mu_k"]
        self._warns = self._warns or (due is not None and due != life.warned)
        life.warned = due

    def _block(self, life: Life) -> Any:
        settings = self.spec.values(life.settings)
        return self._of_block(self.spec.model, settings, life.start_time)

    @staticmethod
    def _of_block(call: Any, *arguments: Any) -> Any:
        try:
            return call(*arguments)
        except ModelError as error:
            raise MustRefuseError(str(error)) from None

    def _read(self, life: Life, block: Any, reference: int) -> Any:
        if reference == len(self.rows):
            return life.time
        value = block
        for part in self.rows[reference].attribute.split("."):
            value = getattr(value, part)
        return value


def objection(expected: Expected, outcome: Outcome) -> str:
    status, values, messages = outcome
    if status != expected.status:
        return f"status {status}, expected {expected.status}: {expected.text or messages}"
    if _bits(values) != _bits(expected.values):
        return f"gives {values}, expected {expected.values}"
    if status == SKIPPED:
        return ""
    if status == OK:
        warned = [state == WARNING and bool(_WARNED.search(text)) for state, text in messages]
        due = [True] * expected.warns
        return "" if warned == due else f"logs {messages}, {len(due)} warnings are due"
    text = messages[-1][1].replace("%%", "%") if messages else "nothing"
    if numbers_as_repr(expected.text) not in numbers_as_repr(text) or "internal error" in text:
        return f"logs {text!r}, expected {expected.text!r}"
    return ""


def _bits(values: list[Any] | None) -> list[bytes]:
    return [struct.pack("<d", value) for value in values or []]
