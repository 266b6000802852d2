"""Masters: the ways of calling an FMU through a case, all of which must give the case's motion.

`Master` calls plainly; a `Way` is what differs. A run of `RUNS` is compared with the plain one, see
docs/theory.md (18), a run of `MANNERS` with the exact motion.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import cached_property, partial
from random import Random
from typing import TYPE_CHECKING

import numpy as np

from ..model.quantities import OUTPUT_NAMES
from ..model.verdict import CommunicationStep as CommunicationStep
from ..model.verdict import Run, points
from ..truth.course import BUILT_IN, COULOMB_NAME
from ..truth.parameters import START_VALUES, Parameter, changeable
from .description import FmuError
from .instance import FmuFile, FmuInstance, available
from .processes import NotApplicableError as NotApplicableError

if TYPE_CHECKING:
    from ..suite.cases import Case


@dataclass(frozen=True)
class Setting:
    """What an FMU is driven through: values set before the start (SI), steps, start time [s]."""

    parameters: Mapping[str, float]
    steps: Sequence[CommunicationStep]
    start_time: float = 0.0

    @cached_property
    def points(self) -> tuple[float, ...]:
        """Communication points after the start [s], from 0: the correctly rounded sums of steps."""
        return (0.0, *points(step.h for step in self.steps))


def setting_of(fmu: FmuFile, case: Case) -> Setting:
    """Return the setting of a case for this FMU.

    Where the FMU's own start values are tried (`FmuFile.own_starts`), only what the case names is
    set. `NotApplicableError` if it lacks a variable that the case gives another value than our
    default, or cannot change one on the way.
    """
    require_law(fmu, case)
    if fmu.own_starts:
        return Setting(case.parameters, case.steps)
    values = case.start
    changed = sorted({name for step in case.steps for name in step.changes})
    need(fmu, [*lacking(fmu, values, case.own), *changed])
    need_changeable(fmu, changed, case.own)
    return Setting({n: value for n, value in values.items() if fmu.has(n)}, case.steps)


def require_law(fmu: FmuFile, case: Case) -> None:
    """Raise `FmuError` if an FMU lacks a parameter of the friction law of a case, not Coulomb's."""
    if case.law == COULOMB_NAME:
        fmu.look_for(case.own, optional=True)
        return
    fmu.look_for(case.own)
    absent = [each.name for each in case.own if not fmu.has(each.name)]
    if absent:
        raise FmuError(
            f"{fmu.path}: has no variable {', '.join(absent)}, which the friction law {case.law} "
            f"of the case {case.id} needs; build the FMU with this law, or name it with --names"
        )


def law_of(fmu: FmuFile) -> str:
    """Return the name of the built-in friction law whose parameters an FMU has; else Coulomb's."""
    for name, law in BUILT_IN.items():
        if name != COULOMB_NAME:
            fmu.look_for(law.parameters, optional=True)
            if all(fmu.has(each.name) for each in law.parameters):
                return name
    return COULOMB_NAME


def fitting(fmu: FmuFile, cases: Sequence[Case]) -> list[Case]:
    """Return the cases of the friction law of an FMU, or from elsewhere; `FmuError` if none is."""
    law = law_of(fmu)
    fit = [case for case in cases if case.law == law or case.law not in BUILT_IN]
    if not fit:
        laws = " and ".join(dict.fromkeys(case.law for case in cases))
        raise FmuError(
            f"{fmu.path}: its friction law is {law}, and the cases are of the friction law {laws}; "
            f"choose cases of {law}, or build the FMU with stickslip build --law {cases[0].law}"
        )
    return fit


def lacking(fmu: FmuFile, values: Mapping[str, float], own: Sequence[Parameter] = ()) -> list[str]:
    """Return the names that an FMU has no variable for and whose value is not our default."""
    starts = {**START_VALUES, **{each.name: each.start for each in own}}
    return [n for n in values if not fmu.has(n) and values[n] != starts[n]]


def defaults(fmu: FmuFile) -> dict[str, float]:
    """Return our default of every parameter and input that the FMU has (SI)."""
    return {name: value for name, value in START_VALUES.items() if fmu.has(name)}


def may_change(fmu: FmuFile, name: str, own: Sequence[Parameter] = ()) -> bool:
    """Whether a variable, maybe one of a friction law's `own`, may be set between two steps."""
    variable = fmu.variables.get(name)
    return (
        variable is not None
        and name in changeable(own)
        and (variable.causality == "input" or variable.variability == "tunable")
    )


def need(fmu: FmuFile, names: Iterable[str]) -> None:
    """Raise `NotApplicableError` with the names that the FMU lacks, if it lacks any."""
    absent = [name for name in dict.fromkeys(names) if not fmu.has(name)]
    if absent:
        raise NotApplicableError(f"it has no variable {', '.join(absent)}")


def need_changeable(fmu: FmuFile, names: Iterable[str], own: Sequence[Parameter] = ()) -> None:
    """Raise `NotApplicableError` with the variables that cannot be set between two steps."""
    fixed = [name for name in names if not may_change(fmu, name, own)]
    if fixed:
        raise NotApplicableError(f"it cannot change {', '.join(fixed)} on the way")


def need_instances(fmu: FmuFile) -> None:
    """Raise `NotApplicableError` if only one instance may be made in a process."""
    need_ability(not fmu.once_per_process, "be instantiated twice in a process")


def need_ability(able: bool, what: str) -> None:
    """Raise `NotApplicableError` with what an FMU says that it cannot do."""
    if not able:
        raise NotApplicableError(f"it cannot {what}, by its description")


AfterStep = Callable[[float], bool]
"""Called with the time since the start [s] after each step; True ends the run there."""
_STATES = 100  # that exist at once, once
_UNREAD_STEPS, _BUSY_STEPS, _TINY, _ROUNDING = 40, 100, 1e-9, 2e-15
"""Steps that one step of a case is cut into where nothing is read, and where inputs are set too;
the shortest part of a step; part of its value by which an input set before every step is off."""


class Master:
    """One run of an FMU through a setting; the first of its ``instances`` runs the case.

    ``names`` are read, ``start`` are the start values of the case, ``values`` these with what was
    changed so far; its ``seed`` decides orders and cuts. ``number`` and ``next`` are the next step,
    ``mark`` is one at which a way does something.
    """

    next: CommunicationStep

    def __init__(
        self,
        fmu: FmuFile,
        setting: Setting,
        way: Way | None = None,
        start: Mapping[str, float] | None = None,
        seed: str = "",
    ) -> None:
        self.fmu, self.setting, self.way = fmu, setting, way or Way()
        self.names: Sequence[str] = available(fmu, OUTPUT_NAMES)
        self.start = start or {}
        self.values = dict(self.start)
        self.seed, self.draw = seed, Random(seed)
        self.instances: list[FmuInstance] = []
        self.number = self.mark = 0
        self._initial: list[float] = []
        self._rows: dict[int, list[float]] = {}
        self._readers: dict[FmuInstance, Callable[[], list[float]]] = {}

    @property
    def instance(self) -> FmuInstance:
        """The instance that runs the case."""
        return self.instances[0]

    @property
    def time(self) -> float:
        """The communication point [s]."""
        return self.setting.start_time + self.setting.points[self.number]

    def run(self, after_step: AfterStep | None = None) -> Run:
        """Drive the FMU and return what was read; `FmuError` if it refuses a call."""
        way, steps, points = self.way, self.setting.steps, self.setting.points
        with ExitStack() as stack:
            for _ in range(way.instances):
                self.instances.append(stack.enter_context(self.fmu.instantiate()))
            way.begin(self)
            for self.number, self.next in enumerate(steps):
                self.values |= self.next.changes
                way.set(self)
                way.step(self)
                if way.reads or self.number + 1 == len(steps):
                    self._rows[self.number] = way.read(self)
                if after_step is not None and after_step(points[self.number + 1]):
                    break
        columns = np.array(list(self._rows.values()), dtype=np.float64)
        columns = columns.reshape(len(self._rows), len(self.names))
        return Run(
            times=np.array([points[number + 1] for number in self._rows]),
            outputs=dict(zip(self.names, columns.T, strict=True)),
            initial=dict(zip(self.names, self._initial, strict=False)),
            messages=tuple(self.instance.messages),
        )

    def begin(self) -> None:
        """Set the parameters and initialize."""
        self.instance.start(self.setting.parameters, self.setting.start_time)
        if self.way.reads_start:
            self._initial = self.read()

    def set(self) -> None:
        """Set what changes before the next step."""
        self.instance.set(self.next.changes)

    def step(self) -> None:
        """Make the next step."""
        self.instance.step(self.time, self.next.h)

    def read(self, instance: FmuInstance | None = None) -> list[float]:
        """Read the outputs in their order."""
        instance = instance or self.instance
        if instance not in self._readers:
            self._readers[instance] = instance.reader(self.names)
        return self._readers[instance]()

    def read_again(self) -> None:
        """Read the outputs of the last step again, after a state was set."""
        if self.number:
            self._rows[self.number - 1] = self.read()

    def go(self, instance: FmuInstance, begin: int, end: int) -> None:
        """Take steps with an instance, and read after each; the values do not count."""
        setting = self.setting
        for step, time in zip(setting.steps[begin:end], setting.points[begin:end], strict=False):
            instance.set(step.changes)
            instance.step(time, step.h)
            self.read(instance)

    def pieces(self, cuts: int) -> Iterator[tuple[float, float]]:
        """Cut the next step into `cuts` + 1 uneven pieces and a tiny one: their time and length."""
        h, time = self.next.h, self.time
        ends = sorted([_TINY * h, *(h * self.draw.random() for _ in range(cuts)), h])
        for before, after in zip([0.0, *ends], ends, strict=False):
            if after > before:
                yield time, after - before
                time += after - before

    def others(self, *, changeable: bool = False) -> dict[str, float]:
        """Return values, some unlike and some as the case's; `changeable` on the way alone."""
        start, draw = self.start, Random(f"other than {self.seed}")
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
        may_set = partial(may_change, self.fmu) if changeable else self.fmu.has
        return {name: value for name, value in values.items() if may_set(name)}


@dataclass(frozen=True)
class Way:
    """A way of calling: what it does otherwise than the plain one.

    ``begin``, ``set``, ``step``, ``read`` are called in place of the master's own. ``setting`` says
    what is run, ``back`` makes of the run what is to equal the plain one. ``reads`` and
    ``reads_start`` say whether outputs are read after each step, and after the initialization;
    ``states`` and ``written`` whether states are set, and whether they are written as bytes.
    """

    begin: Callable[[Master], None] = Master.begin
    set: Callable[[Master], None] = Master.set
    step: Callable[[Master], None] = Master.step
    read: Callable[[Master], list[float]] = Master.read
    setting: Callable[[FmuFile, Case], Setting] = setting_of
    back: Callable[[Run], Run] = lambda run: run
    reads: bool = True
    reads_start: bool = True
    instances: int = 1
    states: bool = False
    written: bool = False

    def __call__(self, fmu: FmuFile, case: Case) -> Run:
        """Run a case; `FmuError`, or `NotApplicableError` with what the FMU lacks."""
        setting = self.setting(fmu, case)
        need_ability(not self.written or fmu.can_serialize_state, "serialize its state")
        need_ability(not self.states or fmu.can_get_and_set_state, "get and set its state")
        if self.instances > 1:
            need_instances(fmu)
        run = self.back(Master(fmu, setting, self, start=case.start, seed=case.id).run())
        complete = len(run.times) == len(case.steps)
        return replace(run, times=np.array(case.times)) if complete else run


def _in_parts(m: Master, cuts: int, then: Callable[[Master], object] = lambda _: None) -> None:
    """Cut the step into steps of very different length, and do something after each."""
    for piece in m.pieces(cuts):
        m.instance.step(*piece)
        then(m)


def _in_parts_set(m: Master) -> None:
    """Set the inputs before every step, moved by rounding each time."""
    inputs = {name: m.values[name] for name in ("v", "F_ext") if may_change(m.fmu, name)}
    for number, piece in enumerate(m.pieces(_BUSY_STEPS)):
        off = _ROUNDING if number % 2 else -_ROUNDING
        m.instance.set({name: value * (1.0 + off) for name, value in inputs.items()})
        m.instance.step(*piece)
    m.instance.set(inputs)


def _set_between_reads(m: Master) -> None:
    _read_one_by_one(m)
    m.set()
    _read_one_by_one(m)


def _read_one_by_one(m: Master) -> list[float]:
    """Read again and again, singly and in lists, in another order each time."""
    values: dict[str, float] = {}
    for length in m.draw.sample((1, 2, len(m.names)), 3):
        order = m.draw.sample(m.names, len(m.names))
        for n in range(0, len(order), length):
            some = order[n : n + length]
            values |= zip(some, m.instance.reader(some)(), strict=True)
    return [values[name] for name in m.names]


def _begin_alone(m: Master) -> None:
    """Choose one or two outputs, which alone are read."""
    few = min(len(m.names), m.draw.randint(1, 2))
    m.names = m.draw.sample(m.names, few)
    m.begin()


def _begin_apart(m: Master) -> None:
    _set_singly(m, m.setting.parameters)
    m.instance.start({})


def _set_apart(m: Master) -> None:
    """Set some values to something else first: what is set last before a step counts."""
    other = m.others(changeable=True)
    there_and_back = m.draw.sample(sorted(other), len(other) // 2)
    m.instance.set({name: other[name] for name in there_and_back})
    _set_singly(m, {name: m.values[name] for name in [*there_and_back, *m.next.changes]})


def _set_singly(m: Master, values: Mapping[str, float]) -> None:
    """Set each value by a call of its own, some twice, in another order each time."""
    order = [*sorted(values), *m.draw.sample(sorted(values), len(values) // 2)]
    m.draw.shuffle(order)
    for name in order:
        m.instance.set({name: values[name]})


def _set_back(m: Master) -> None:
    """Take states before and after a set, go on otherwise, and set them back in another order."""
    instance, h, time = m.instance, m.next.h, m.time
    before = instance.get_state()
    m.set()
    after = instance.get_state()
    instance.set(m.others(changeable=True))
    crowded = m.number == Random(m.seed).randrange(len(m.setting.steps))
    others = [instance.get_state() for _ in range(_STATES if crowded else 1)]
    for part in (h / 3.0, h):
        instance.step(time, part)
        time += part
    for state in (others[0], before, after):
        instance.set_state(state)
    for state in (before, *others, after):
        instance.free_state(state)


def _begin_far_apart(m: Master) -> None:
    m.instances[1].start(m.others())
    m.instances[1].step(0.0, 0.1)
    m.begin()


def _carry_over(m: Master) -> None:
    """Carry a state, written when its instance has gone on, into one that ran something else."""
    m.set()
    state = m.instance.get_state()
    m.instance.set(m.others(changeable=True))
    m.instance.step(m.time, m.next.h / 3.0)
    written = m.instance.written(state)
    m.instances.reverse()
    m.instance.restore(written)


def _begin_two(m: Master) -> None:
    m.begin()
    m.instances[1].start(m.others())


def _step_two(m: Master) -> None:
    """Step another instance in between, with other values throughout."""
    m.instances[1].step(m.time, m.next.h)
    m.step()
    m.instances[1].set(m.others(changeable=True))


def _begin_after_another_run(m: Master) -> None:
    m.instance.start(m.others())
    m.instance.step(0.0, 0.1)
    m.instance.set(m.others(changeable=True))
    m.instance.reset()
    m.begin()


MANNERS: Mapping[str, Way] = {
    name: replace(way, reads_start=False)
    for name, way in {
        "plain": Way(),
        "unread": Way(step=partial(_in_parts, cuts=_UNREAD_STEPS), reads=False),
        "busy": Way(step=_in_parts_set, reads=False),
        "in_pieces": Way(step=partial(_in_parts, cuts=3, then=Master.read)),
        "one_by_one": Way(set=_set_between_reads, read=_read_one_by_one),
        "alone": Way(begin=_begin_alone),
        "apart": Way(begin=_begin_apart, set=_set_apart),
        "set_back": Way(set=_set_back, states=True),
        "carried_over": Way(
            begin=_begin_far_apart, set=_carry_over, instances=2, states=True, written=True
        ),
        "two_at_once": Way(begin=_begin_two, step=_step_two, instances=2),
        "reset": Way(begin=_begin_after_another_run),
    }.items()
}
"""What a family of sequences can name as ``manner``."""


def run_case(fmu: FmuFile, case: Case, manner: str | None = None) -> Run:
    """Drive a fresh instance of an FMU through a case, plainly or in a manner of `MANNERS`."""
    return (MANNERS[manner] if manner else Way())(fmu, case)


def run(
    fmu: FmuFile,
    setting: Setting,
    after_step: AfterStep | None = None,
    own: Iterable[str] = (),
) -> Run:
    """Drive a fresh instance of an FMU through a setting; `FmuError` if it refuses a call.

    An output that the FMU lacks is absent from the run; ``own`` are those of its friction law.
    `after_step` shows progress, and may end the run early.
    """
    master = Master(fmu, setting)
    master.names = [*master.names, *available(fmu, own)]
    return master.run(after_step)
