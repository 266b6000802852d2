"""Manners of calling an FMU: the same motion, asked for as masters really do.

Each drives a case and returns the samples at the communication points that it read. Whatever the
manner, the motion is that of the case.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from random import Random

import numpy as np

from stickslip_verification.drive.fmu.archive import FmuFile, available
from stickslip_verification.drive.fmu.instance import FmuInstance
from stickslip_verification.drive.stepping import NotApplicableError, may_change, setting_of
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.model.run import Run
from stickslip_verification.suite.cases import Case

Manner = Callable[[FmuFile, Case], Run]
"""Drives a case. Raises `FmuError`, or `NotApplicableError` with what the FMU lacks."""

_UNREAD_STEPS = 40
"""Steps that one step of a case is cut into where nothing is read."""

_BUSY_STEPS = 100
_ROUNDING = 2e-15
"""The same where inputs are set before each of them, and by which part these are off."""

_HELD_STATES = 100
"""States that are held at once, once in a run."""

_TINY = 1e-9
"""The shortest part that a step is cut into."""


@dataclass
class _Master:
    """One run of a case under way; a manner overrides what it does in its own way.

    Attributes
    ----------
    fmu, case
        What is driven through what.
    now
        What was changed so far.
    draw
        Decides orders and cuts: the same for the same case.
    """

    fmu: FmuFile
    case: Case
    rows: dict[int, list[float]] = field(default_factory=dict)
    now: dict[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.names = available(self.fmu, OUTPUT_NAMES)
        self.setting = setting_of(self.fmu, self.case)
        self.draw = Random(self.case.id)

    def run(self) -> Run:
        """Drive the case and return what was read."""
        points = self.setting.points
        with self.instance() as instance:
            self.begin(instance)
            for number, step in enumerate(self.setting.steps):
                self.now |= step.changes
                instance = self.set(instance, step.changes, points[number], step.h)
                self.step(instance, points[number], step.h)
                if number in self.read_after():
                    self.rows[number] = self.read(instance)
        taken = sorted(self.rows)
        columns = np.array([self.rows[number] for number in taken])
        return Run(
            times=np.array([points[number + 1] for number in taken]),
            outputs={name: columns[:, i] for i, name in enumerate(self.names)},
            initial={},
        )

    @contextmanager
    def instance(self) -> Iterator[FmuInstance]:
        """Yield an instance that has not begun."""
        with self.fmu.instantiate() as instance:
            yield instance

    def begin(self, instance: FmuInstance) -> None:
        """Set the parameters and initialize."""
        instance.start(self.setting.parameters)

    def set(
        self, instance: FmuInstance, changes: Mapping[str, float], time: float, h: float
    ) -> FmuInstance:
        """Set what changes at `time` [s], before a step of `h` [s]; return what to step."""
        instance.set(changes)
        return instance

    def step(self, instance: FmuInstance, time: float, h: float) -> None:
        """Go on by `h` [s]."""
        instance.step(time, h)

    def read_after(self) -> range:
        """Return the numbers of the steps after which outputs are read."""
        return range(len(self.setting.steps))

    def read(self, instance: FmuInstance) -> list[float]:
        """Read the outputs in their order."""
        return instance.reader(self.names)()

    def pieces(self, h: float, cuts: int) -> list[float]:
        """Cut a step into `cuts` + 1 uneven ones and a tiny one."""
        ends = sorted([_TINY * h, *(h * self.draw.random() for _ in range(cuts)), h])
        return [b - a for a, b in zip([0.0, *ends], ends, strict=False) if b > a]


class _Unread(_Master):
    """Nothing is read before the end, over many small steps."""

    def step(self, instance: FmuInstance, time: float, h: float) -> None:
        for part in self.pieces(h, _UNREAD_STEPS):
            instance.step(time, part)
            time += part

    def read_after(self) -> range:
        last = len(self.setting.steps)
        return range(last - 1, last)


class _Busy(_Unread):
    """The inputs are set before every step, moved by rounding each time."""

    def _may(self, name: str) -> bool:
        return self.fmu.has(name) and may_change(self.fmu, name)

    def step(self, instance: FmuInstance, time: float, h: float) -> None:
        values = {**self.case.start, **self.now}
        inputs = {name: values[name] for name in ("v", "F_ext") if self._may(name)}
        for number, part in enumerate(self.pieces(h, _BUSY_STEPS)):
            off = _ROUNDING if number % 2 else -_ROUNDING
            instance.set({name: value * (1.0 + off) for name, value in inputs.items()})
            instance.step(time, part)
            time += part
        instance.set(inputs)


class _InPieces(_Master):
    """Steps of very different length, read in between."""

    def step(self, instance: FmuInstance, time: float, h: float) -> None:
        for part in self.pieces(h, 3):
            instance.step(time, part)
            time += part
            instance.reader(self.names)()


class _Alone(_Master):
    """Of all outputs one or two are read, and nothing else is ever looked at."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.names = self.draw.sample(self.names, min(len(self.names), self.draw.randint(1, 2)))


class _OneByOne(_Master):
    """Outputs are read again and again, singly and in lists, in another order each time."""

    def set(
        self, instance: FmuInstance, changes: Mapping[str, float], time: float, h: float
    ) -> FmuInstance:
        self.read(instance)
        instance.set(changes)
        self.read(instance)
        return instance

    def read(self, instance: FmuInstance) -> list[float]:
        values: dict[str, float] = {}
        for length in self.draw.sample((1, 2, len(self.names)), 3):
            order = self.draw.sample(self.names, len(self.names))
            for n in range(0, len(order), length):
                some = order[n : n + length]
                values |= zip(some, instance.reader(some)(), strict=True)
        return [values[name] for name in self.names]


class _Apart(_Master):
    """Each value is set by a call of its own, in another order each time.

    Some are set twice, some to something else first: what is set last before a step counts.
    """

    def begin(self, instance: FmuInstance) -> None:
        self._apart(instance, self.setting.parameters)
        instance.start({})

    def set(
        self, instance: FmuInstance, changes: Mapping[str, float], time: float, h: float
    ) -> FmuInstance:
        now = {**self.case.start, **self.now}
        other = _other(self.fmu, self.case, changeable=True)
        there_and_back = self.draw.sample(sorted(other), len(other) // 2)
        instance.set({name: other[name] for name in there_and_back})
        self._apart(instance, {name: now[name] for name in [*there_and_back, *changes]})
        return instance

    def _apart(self, instance: FmuInstance, values: Mapping[str, float]) -> None:
        order = [*sorted(values), *self.draw.sample(sorted(values), len(values) // 2)]
        self.draw.shuffle(order)
        for name in order:
            instance.set({name: values[name]})


class _SetBack(_Master):
    """States are taken before and after a set, the FMU goes on otherwise, and is set back.

    Many are held at once, and they are set in another order than they were taken in.
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        _need(self.fmu.can_get_and_set_state, "get and set its state")
        self.crowded = self.draw.randrange(len(self.setting.steps))

    def set(
        self, instance: FmuInstance, changes: Mapping[str, float], time: float, h: float
    ) -> FmuInstance:
        before = instance.get_state()
        instance.set(changes)
        wanted = instance.get_state()
        instance.set(_other(self.fmu, self.case, changeable=True))
        many = _HELD_STATES if len(self.rows) == self.crowded else 1
        others = [instance.get_state() for _ in range(many)]
        for part in (h / 3.0, h):
            instance.step(time, part)
            time += part
        for state in (others[0], before, wanted):
            instance.set_state(state)
        for state in (before, *others, wanted):
            instance.free_state(state)
        return instance


class _CarriedOver(_Master):
    """The state goes as bytes into another instance, which has run through something else.

    It is written when the instance that it is of has gone on.
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        _need(self.fmu.can_get_and_set_state, "get and set its state")
        _need(self.fmu.can_serialize_state, "serialize its state")
        _need(not self.fmu.once_per_process, "be instantiated twice in a process")

    @contextmanager
    def instance(self) -> Iterator[FmuInstance]:
        with self.fmu.instantiate() as first, self.fmu.instantiate() as second:
            self._spare = second
            second.start(_other(self.fmu, self.case))
            second.step(0.0, 0.1)
            yield first

    def set(
        self, instance: FmuInstance, changes: Mapping[str, float], time: float, h: float
    ) -> FmuInstance:
        instance.set(changes)
        state = instance.get_state()
        instance.set(_other(self.fmu, self.case, changeable=True))
        instance.step(time, h / 3.0)
        written = instance.serialize(state)
        instance.free_state(state)
        there, self._spare = self._spare, instance
        restored = there.deserialize(written)
        there.set_state(restored)
        there.free_state(restored)
        return there


class _TwoAtOnce(_Master):
    """Another instance, with other values throughout, is stepped in between."""

    def __post_init__(self) -> None:
        super().__post_init__()
        _need(not self.fmu.once_per_process, "be instantiated twice in a process")

    @contextmanager
    def instance(self) -> Iterator[FmuInstance]:
        with self.fmu.instantiate() as first, self.fmu.instantiate() as self._beside:
            yield first

    def begin(self, instance: FmuInstance) -> None:
        super().begin(instance)
        self._beside.start(_other(self.fmu, self.case))

    def step(self, instance: FmuInstance, time: float, h: float) -> None:
        self._beside.step(time, h)
        instance.step(time, h)
        self._beside.set(_other(self.fmu, self.case, changeable=True))


class _Reset(_Master):
    """The instance has run through something else, with other fixed parameters, and is reset."""

    def begin(self, instance: FmuInstance) -> None:
        instance.start(_other(self.fmu, self.case))
        instance.step(0.0, 0.1)
        instance.set(_other(self.fmu, self.case, changeable=True))
        instance.reset()
        super().begin(instance)


MANNERS: dict[str, Manner] = {
    "plain": lambda fmu, case: _Master(fmu, case).run(),
    "unread": lambda fmu, case: _Unread(fmu, case).run(),
    "busy": lambda fmu, case: _Busy(fmu, case).run(),
    "in_pieces": lambda fmu, case: _InPieces(fmu, case).run(),
    "one_by_one": lambda fmu, case: _OneByOne(fmu, case).run(),
    "alone": lambda fmu, case: _Alone(fmu, case).run(),
    "apart": lambda fmu, case: _Apart(fmu, case).run(),
    "set_back": lambda fmu, case: _SetBack(fmu, case).run(),
    "carried_over": lambda fmu, case: _CarriedOver(fmu, case).run(),
    "two_at_once": lambda fmu, case: _TwoAtOnce(fmu, case).run(),
    "reset": lambda fmu, case: _Reset(fmu, case).run(),
}
"""What a family of sequences can name as ``manner``."""


def _other(fmu: FmuFile, case: Case, *, changeable: bool = False) -> dict[str, float]:
    """Return values some of which are unlike those of a case; of what may change on the way alone.

    What is left out is as the case has it, so that what is made from several values meets some
    that are the same.
    """
    start, draw = case.start, Random(f"other than {case.id}")
    values = {
        "m": 2.5 * start["m"],
        "g": 1.5 * start["g"],
        "k": 0.7 * start["k"],
        "c": start["c"] + start["m"],
        "mu_s": 1.2 * start["mu_s"] + 0.1,
        "mu_k": 0.5 * start["mu_k"],
        "v": -1.3 * start["v"] - 0.01,
        "load": abs(start["load"]) + 3.0 * start["m"],
        "F_ext": 0.5 * start["F_ext"] - start["mu_s"] * start["m"],
        "x_start": start["x_start"] + 0.1,
        "x_dot_start": start["x_dot_start"] + 0.05,
        "z_start": start["z_start"] - 0.01,
    }
    values = {name: draw.choice((value, start[name])) for name, value in values.items()}
    return {
        name: value
        for name, value in values.items()
        if fmu.has(name) and (not changeable or may_change(fmu, name))
    }


def _need(able: bool, what: str) -> None:
    if not able:
        raise NotApplicableError(f"it cannot {what}, by its description")
