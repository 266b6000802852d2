"""What each call of a sequence must give: the contract of design section 3, apart from the face.

The rules (phases, ranges, who is settable when, a failure that lasts until a reset) stand here a
second time, in their own words. The motion is that of a block driven straight: a state is a deep
copy of it, so nothing here saves or restores as the FMU does.
"""

import copy
import math
import re
import struct
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from fmukit.model import ModelError
from stickslip_fmu.block import Block
from tests.fmu.fuzz.sequences import Call
from tests.fmu.fuzz.variables import VARIABLES, Variables
from tests.fmu.inside import SKIPPED

OK, DISCARD, ERROR, FATAL = 0, 2, 3, 4

WARNING = re.compile("clamped to|is ignored")


class MustRefuseError(Exception):
    """The call must fail; the text says by which rule."""


class BlockFaultError(Exception):
    """The block itself does what it must not; the text says what."""


@dataclass
class Instance:
    """One instance as it should be.

    ``block`` is there from the end of initialization on; before, outputs follow what is set.
    ``moderate`` says whether all that was set lies where nothing may be refused.
    """

    logging: bool
    variables: Variables
    phase: str = "instantiated"
    fault: str | None = None
    start_time: float = 0.0
    settings: dict[str, float] = field(default_factory=dict)
    block: Block | None = None
    moderate: bool = True
    warned: tuple[Any, ...] | None = None
    failed_to_get: bool = False
    last_time: float = math.nan

    def __post_init__(self) -> None:
        self.settings = self.settings or self.variables.spec.table.start_values()

    def fresh(self) -> "Instance":
        """Return what a reset makes of it; the wrapper keeps its log and its clock."""
        return Instance(self.logging, self.variables, last_time=self.last_time)

    def state(self) -> dict[str, Any]:
        """Return a copy of what a state restores."""
        return {
            "phase": self.phase,
            "start_time": self.start_time,
            "settings": dict(self.settings),
            "block": copy.deepcopy(self.block),
            "moderate": self.moderate,
        }

    def take(self, state: dict[str, Any]) -> None:
        """Take up such a copy."""
        for name, value in copy.deepcopy(state).items():
            setattr(self, name, value)


class Model:
    """The instances and states of one sequence, and what each of its calls must give."""

    def __init__(self, law: str = "coulomb") -> None:
        self.variables = VARIABLES[law]
        self.rows = self.variables.spec.table.rows
        self.model = self.variables.spec.name
        self.instances: dict[int, Instance] = {}
        # None stands for a state that is there and belongs to nothing.
        self.states: dict[int, dict[str, Any] | None] = {}
        self.packed: dict[int, dict[str, Any] | None] = {}
        # Whether the pointer of a slot that was freed leads anywhere.
        self.freed: dict[int, bool] = {}
        # Whether the present call warns of a clamp.
        self.warns = False

    def objection(self, call: Call, outcome: list[Any]) -> str | None:
        """Return what is wrong with what came back from a call; None where nothing is."""
        name, *arguments = call
        status, values, messages, errors = outcome
        instance = self.instances.get(arguments[0]) if arguments else None
        self.warns = False
        try:
            expected, wanted = getattr(self, f"_{name}")(*arguments)
        except MustRefuseError as refusal:
            if status != FATAL:
                return f"status {status}, expected {FATAL}: {refusal}"
            assert instance is not None
            return self._objection_to_words(instance, messages, errors)
        except BlockFaultError as surprise:
            return str(surprise)
        if status != expected:
            return f"status {status}, expected {expected}"
        if wanted is not None and bits(values) != bits(wanted):
            return f"gives {values}, expected {wanted}"
        return self._objection_to_warning(instance, expected, messages, errors)

    def _objection_to_words(
        self, instance: Instance, messages: list[str], errors: list[str]
    ) -> str | None:
        """Return what is wrong with how a call failed: aloud the first time, else as before."""
        said = [line for line in errors if not WARNING.search(line)]
        if instance.fault is None:
            instance.fault = ""
            if len(said) != 1 or not said[0].startswith(f"{self.model}: "):
                return f"fails for the first time with {said} on standard error"
            instance.fault = said[0].removeprefix(f"{self.model}: ")
        elif said:
            return f"fails once more with {said} on standard error"
        if "internal error" in instance.fault:
            return f"fails with {instance.fault!r}"
        if instance.logging and not (messages and instance.fault in messages[-1]):
            return f"fails with {messages} in the log, not {instance.fault!r}"
        return None

    def _objection_to_warning(
        self, instance: Instance | None, status: int, messages: list[str], errors: list[str]
    ) -> str | None:
        """Return what is wrong with what was said while nothing failed."""
        if [bool(WARNING.search(line)) for line in errors] != [True] * self.warns:
            return f"says {errors} where {int(self.warns)} warnings are due"
        heard = instance is not None and instance.logging and status == OK
        if heard and [bool(WARNING.search(line)) for line in messages] != [True] * self.warns:
            return f"logs {messages} where {int(self.warns)} warnings are due"
        return None

    def where(self, i: int) -> str:
        """Return the phase of an instance, and the mode while it steps."""
        instance = self.instances[i]
        if instance.fault is not None or instance.block is None or instance.phase != "stepping":
            return instance.phase if instance.fault is None else "failed"
        damped = "damped " if instance.settings["c"] > 0.0 else ""
        return damped + ("backward slip", "stick", "forward slip")[instance.block.mode + 1]

    def _instantiate(self, i: int, name: str, logging: bool) -> Any:
        self.instances[i] = Instance(logging, self.variables)
        return OK, None

    def _free(self, i: int) -> Any:
        del self.instances[i]
        return OK, None

    def _reset(self, i: int) -> Any:
        self.instances[i] = self.instances[i].fresh()
        return OK, None

    def _set_up(self, i: int, start: float, stop: float | None, tolerance: float | None) -> Any:
        instance = self._sound(i)
        if not math.isfinite(start):
            raise MustRefuseError("start time not finite")
        self._must_be(instance, "instantiated")
        instance.start_time = start
        return OK, None

    def _enter(self, i: int) -> Any:
        instance = self._sound(i)
        self._must_be(instance, "instantiated")
        instance.phase = "initialization"
        return OK, None

    def _exit(self, i: int) -> Any:
        instance = self._sound(i)
        self._must_be(instance, "initialization")
        instance.block = self._block(instance)
        instance.phase = "stepping"
        self._clamp(instance)
        return OK, None

    def _terminate(self, i: int) -> Any:
        # A master that gives up may do so at any time, and twice.
        self._sound(i).phase = "terminated"
        return OK, None

    def _step(self, i: int, time: float, step: float, no_state_prior: bool) -> Any:
        instance = self._sound(i)
        self._must_be(instance, "stepping")
        self._clamp(instance)
        if not (math.isfinite(step) and step > 0.0):
            raise MustRefuseError("step not above zero and finite")
        if not math.isfinite(time):
            raise MustRefuseError("communication point not finite")
        block = instance.block
        assert block is not None
        bent = self._bent(instance.settings)
        self._of_block(instance, step <= 10.0 and not bent, lambda: block.advance(time, step))
        if bent:
            raise MustRefuseError(bent)
        instance.last_time = time + step
        return OK, None

    def _get(self, i: int, kind: str, references: list[int]) -> Any:
        instance = self._sound(i)
        block = instance.block
        if block is None:
            block = self._block(instance)
        for reference in references:
            self._must_be_kind(reference, kind)

        def read() -> list[Any]:
            block.refresh()
            return [self._read(block, reference) for reference in references]

        return OK, self._of_block(instance, True, read)

    def _set(self, i: int, kind: str, references: list[int], values: list[Any]) -> Any:
        instance = self._sound(i)
        for reference, value in zip(references, values, strict=True):
            self._must_be_kind(reference, kind)
            self._set_one(instance, self.variables.names[reference], value)
        if instance.phase == "stepping" and kind == "Real":
            self._must_not_lift(instance)
        return OK, None

    def _get_state(self, i: int, slot: int) -> Any:
        self.states.pop(slot, None)
        self.instances[i].failed_to_get |= self.instances[i].fault is not None
        self.states[slot] = self._sound(i).state()
        return OK, None

    def _set_state(self, i: int, slot: int) -> Any:
        if slot not in self.states:
            return SKIPPED, None
        instance = self._sound(i)
        state = self.states[slot]
        if state is None:
            raise MustRefuseError("a state that this FMU never handed out")
        instance.take(state)
        return OK, None

    def _free_state(self, i: int, slot: int) -> Any:
        self.freed[slot] = slot in self.states
        self.states.pop(slot, None)
        return OK, None

    def _free_again(self, i: int, slot: int) -> Any:
        # As it leaves the pointer where FMI makes it NULL, this must do nothing.
        return (OK if self.freed.pop(slot, None) is not None else SKIPPED), None

    def _set_freed(self, i: int, slot: int) -> Any:
        if not self.freed.get(slot):
            return SKIPPED, None
        self._sound(i)
        raise MustRefuseError("a state that was freed")

    def _set_null(self, i: int) -> Any:
        if not self.instances[i].failed_to_get:
            return SKIPPED, None
        self.instances[i].failed_to_get = False
        # The wrapper refuses that by itself, in its own words.
        return FATAL, None

    def _serialize(self, i: int, slot: int, packed: int) -> Any:
        if slot not in self.states:
            return SKIPPED, None
        self.packed[packed] = self.states[slot]
        return OK, None

    def _deserialize(self, i: int, packed: int, slot: int, damage: str) -> Any:
        if packed not in self.packed:
            return SKIPPED, None
        self.states[slot] = None if damage else self.packed[packed]
        return OK, None

    # The wrapper itself answers what follows; none of it reaches the slave.

    def _status(self, i: int, which: int, kind: int) -> Any:
        if which == 0:
            return ERROR, None
        if which == 1 and kind == 2:
            return OK, [self.instances[i].last_time]
        if which == 3 and kind == 3:
            return OK, [0]
        return DISCARD, None

    def _cancel(self, i: int) -> Any:
        return ERROR, None

    def _derivatives(self, i: int, which: str, reference: int) -> Any:
        return ERROR, None

    def _debug(self, i: int, on: bool, categories: list[str]) -> Any:
        # With categories the wrapper drops failures, which it logs under none.
        self.instances[i].logging = on and not categories
        return OK, None

    def _version(self) -> Any:
        return OK, ["2.0", "default"]

    def _sound(self, i: int) -> Instance:
        """Return an instance on which no call has failed."""
        instance = self.instances[i]
        if instance.fault is not None:
            raise MustRefuseError("a call has failed, and no reset since")
        return instance

    def _clamp(self, instance: Instance) -> None:
        """Note whether values that are warned of act for the first time."""
        warned = self._warning(instance.settings)
        self.warns = self.warns or (warned is not None and warned != instance.warned)
        instance.warned = warned

    def _warning(self, settings: dict[str, float]) -> tuple[Any, ...] | None:
        """Return what a warning tells, None where none is due."""
        if settings.get("shape") != 3:
            pair = settings["mu_s"], settings["mu_k"]
            return pair if pair[1] > pair[0] else None
        starts = self.variables.spec.table.start_values()
        beyond = [
            f"{name}_{i}" for i in range(int(settings["n_points"]) + 1, 13) for name in ("u", "mu")
        ]
        ignored = [
            [(name, settings[name]) for name in names if settings[name] != starts[name]][:1]
            for names in (["mu_k"], beyond)
        ]
        return (settings["n_points"], ignored) if any(ignored) else None

    @staticmethod
    def _must_be(instance: Instance, phase: str) -> None:
        if instance.phase != phase:
            raise MustRefuseError(f"in phase {instance.phase}, not {phase}")

    def _must_be_kind(self, reference: int, kind: str) -> None:
        if reference >= len(self.rows):
            raise MustRefuseError("no such variable")
        if self.rows[reference].kind != kind:
            raise MustRefuseError("a variable of another type")

    def _set_one(self, instance: Instance, name: str, value: Any) -> None:
        if instance.phase == "terminated":
            raise MustRefuseError("terminated")
        variables = self.variables
        if name not in variables.moderate and name not in variables.whole:
            start = self.rows[variables.names.index(name)].start
            if instance.phase == "stepping" or start is None or value != start:
                raise MustRefuseError("an output")
            return
        if instance.phase == "stepping" and name in variables.fixed:
            if value != instance.settings[name]:
                raise MustRefuseError("fixed after initialization")
            return
        whole = variables.whole.get(name)
        if whole is not None and value not in whole:
            raise MustRefuseError(f"{name} out of range")
        if not math.isfinite(value) or value < variables.at_least.get(name, -math.inf):
            raise MustRefuseError(f"{name} out of range")
        instance.settings[name] = value
        low, high = (whole[0], whole[-1]) if whole else variables.moderate[name]
        ordinary = low <= value <= high and (value == 0.0 or abs(value) > 1e-9)
        instance.moderate = instance.moderate and ordinary
        if instance.phase == "stepping":
            assert instance.block is not None
            instance.block.set(name, value)

    @staticmethod
    def _must_not_lift(instance: Instance) -> None:
        if instance.settings["load"] < -instance.settings["m"] * instance.settings["g"]:
            raise MustRefuseError("the load lifts the mass")

    @staticmethod
    def _bent(settings: dict[str, float]) -> str:
        """Return why the points that are set make no curve, "" if they do or there is none."""
        if settings.get("shape") != 3:
            return ""
        if settings["mu_1"] > settings["mu_s"]:
            return "the curve begins above the break-away coefficient"
        speeds = [0.0, *(settings[f"u_{i}"] for i in range(2, int(settings["n_points"]) + 1))]
        rising = all(low < high for low, high in pairwise(speeds))
        return "" if rising else "the speeds of the curve do not rise"

    def _block(self, instance: Instance) -> Block:
        """Return the block that starts from what is set."""
        self._must_not_lift(instance)
        spec, bent = self.variables.spec, self._bent(instance.settings)
        settings = spec.values(instance.settings)
        block = self._of_block(
            instance, not bent, lambda: spec.model(settings, instance.start_time)
        )
        if bent:
            raise MustRefuseError(bent)
        assert isinstance(block, Block)
        return block

    @staticmethod
    def _of_block(instance: Instance, moderate: bool, call: Any) -> Any:
        """Call the block, which may refuse what is not moderate, and only by its own error."""
        try:
            return call()
        except ModelError as error:
            if moderate and instance.moderate:
                raise BlockFaultError(f"refused without a reason: {error}") from None
            raise MustRefuseError(str(error)) from None
        except Exception as error:
            raise BlockFaultError(f"the block fails by {error!r}") from None

    def _read(self, block: Block, reference: int) -> Any:
        value: Any = block
        for part in self.rows[reference].attribute.split("."):
            value = getattr(value, part)
        return value


def bits(values: list[Any] | None) -> list[Any]:
    """Return values so that equal means bit for bit."""
    return [
        struct.pack("<d", value) if isinstance(value, (int, float)) else value
        for value in values or []
    ]
