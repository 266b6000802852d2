"""Other runs of a case, which are compared with the plain one, see docs/theory.md (18)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING

from stickslip_units import spelled

from ..model.quantities import OUTPUTS, Quantity
from ..model.verdict import Run
from ..truth.parameters import PARAMETERS, Parameter
from .description import Variable
from .exact import kept, run_reference
from .instance import FmuFile
from .masters import (
    CommunicationStep,
    Master,
    NotApplicableError,
    Setting,
    Way,
    lacking,
    may_change,
    need,
    need_changeable,
    setting_of,
)

if TYPE_CHECKING:
    from ..suite.cases import Case

_PIECES = (0.3, 0.45)  # parts of a step that it is cut into, the rest being the last
_ROLLBACKS, _REPEATED = 5, 20
"""How often a run is set back, over how many steps each time."""


@dataclass(frozen=True)
class Symmetry:
    """A change of everything that is set, under which the motion is the same but for factors.

    ``mass`` and ``pace`` are the factors on the units of mass and time; ``pace`` is also that on
    the lengths of steps. ``mirrored``: what is directed changes its sign.
    """

    name: str
    mass: float = 1.0
    pace: float = 1.0
    mirrored: bool = False

    def factor(self, of: Parameter | Quantity) -> float:
        """Return the factor on a parameter, an input or an output."""
        unit = spelled(of.unit)
        assert unit is not None
        sign = -1.0 if self.mirrored and of.directed else 1.0
        return sign * float(self.mass ** unit.dimension[0] * self.pace ** unit.dimension[2])

    @cached_property
    def outputs(self) -> Mapping[str, float]:
        """The factors on outputs by name."""
        return {each.name: self.factor(each) for each in OUTPUTS}

    def scaled(
        self, setting: Mapping[str, float], own: Sequence[Parameter] = ()
    ) -> dict[str, float]:
        """Return `setting` with its factors; `own` are the friction law's parameters in it."""
        known = {each.name: each for each in (*PARAMETERS, *own)}
        return {name: value * self.factor(known[name]) for name, value in setting.items()}


MIRROR = Symmetry("mirror", mirrored=True)
HEAVIER = Symmetry("m, k, c, load, F_ext times 4", mass=4.0)
QUICKER = Symmetry("k, g, load, F_ext times 4, v, c, x_dot_start times 2, time halved", pace=0.5)


def _symmetric(symmetry: Symmetry) -> Way:
    def scaled(step: CommunicationStep, case: Case) -> CommunicationStep:
        return CommunicationStep(step.h * symmetry.pace, symmetry.scaled(step.changes, case.own))

    def setting(fmu: FmuFile, case: Case) -> Setting:
        steps = [scaled(step, case) for step in setting_of(fmu, case).steps]
        values = symmetry.scaled(case.start, case.own)
        # What the plain run does without, of a friction law's parameters, has no effect.
        own = {each.name for each in case.own}
        need(fmu, lacking(fmu, {n: value for n, value in values.items() if n not in own}))
        return Setting({n: value for n, value in values.items() if fmu.has(n)}, steps)

    def back(run: Run) -> Run:
        factors = symmetry.outputs
        return replace(
            run,
            outputs={n: s / factors.get(n, 1.0) for n, s in run.outputs.items()},
            initial={n: value / factors.get(n, 1.0) for n, value in run.initial.items()},
        )

    return Way(setting=setting, back=back)


def _cut(fmu: FmuFile, case: Case) -> Setting:
    plain = setting_of(fmu, case)
    pieces = []
    for step in plain.steps:
        first, second = (step.h * part for part in _PIECES)
        for h, changes in ((first, step.changes), (second, {}), (step.h - first - second, {})):
            pieces.append(CommunicationStep(h, changes))
    return Setting(plain.parameters, pieces)


def _joined(run: Run) -> Run:
    ends = slice(len(_PIECES), None, len(_PIECES) + 1)
    outputs = {name: samples[ends] for name, samples in run.outputs.items()}
    return replace(run, times=run.times[ends], outputs=outputs)


_SHIFT = 2.0  # of a shifted run, in ways that the pulled end goes to the first break-away


def _shifted(fmu: FmuFile, case: Case) -> Setting:
    """Stretch the spring, let F_ext make up for it, and load for half of the weight."""
    plain, p, now = setting_of(fmu, case), case.start, dict(case.start)
    # How much farther the spring is stretched [m].
    offset = -_SHIFT * p["mu_s"] * max(p["m"] * p["g"] + p["load"], 0.0) / p["k"]
    pairs = ({"z_start", "F_ext"}, {"g", "load"})
    moved = {name for pair in pairs if all(map(fmu.has, pair)) for name in pair}
    if not moved:
        need(fmu, pairs[0])

    def there(names: Iterable[str]) -> dict[str, float]:
        values = {
            "z_start": now["z_start"] + offset,
            "F_ext": now["F_ext"] - now["k"] * offset,
            "g": 0.5 * now["g"],
            "load": now["load"] + 0.5 * now["m"] * now["g"],
        }
        return {name: (values if name in moved else now)[name] for name in names}

    parameters, steps = there({*plain.parameters, *moved}), []
    for step in plain.steps:
        now |= step.changes
        changed = [*step.changes, *(moved & {"F_ext"} if "k" in step.changes else ())]
        need_changeable(fmu, changed, case.own)
        steps.append(CommunicationStep(step.h, there(changed)))
    return Setting(parameters, steps)


def _begin_motion(m: Master) -> None:
    """Read the motion alone: z, F and x_pull are others."""
    m.names = [name for name in ("x", "x_dot") if name in m.names]
    m.begin()


def _begin_to_leave(m: Master) -> None:
    """Mark the step before which most values are others; without x_start another x follows."""
    values, other = dict(m.start), [0]
    for step in m.setting.steps[:-1]:
        values |= step.changes
        other.append(sum(values[name] != m.start[name] for name in values))
    m.mark = other.index(max(other))
    _begin_motion(m)
    m.names = [name for name in m.names if name != "x" or m.fmu.has("x_start")]


def _startable(fmu: FmuFile, case: Case) -> Setting:
    setting = setting_of(fmu, case)
    need(fmu, ("x_dot_start", "z_start", "x", "x_dot", "F"))
    return setting


def _go_on_anew(m: Master) -> None:
    """After the mark, when the mass is faster than the pull, start from where it is.

    The time begins anew too, in another instance. `NotApplicableError` if it is never so fast.
    """
    number, setting = m.number, m.setting
    if setting.start_time == 0.0:
        ready = number >= max(m.mark, 1) and not m.next.changes
        x, x_dot, force = m.instance.reader(("x", "x_dot", "F"))() if ready else (0.0, 0.0, 0.0)
        if abs(x_dot) > abs(m.values["v"]):
            m.setting = replace(setting, start_time=-setting.points[number])
            there = {"x_start": x, "x_dot_start": x_dot, "z_start": force / m.values["k"]}
            values = {**m.values, **there}
            m.instances.reverse()
            m.instance.start({name: values[name] for name in setting.parameters})
        elif number + 1 == len(setting.steps):
            raise NotApplicableError("there the mass is never faster than the pull")
    m.set()


def _at_mark(m: Master) -> bool:
    """Whether the next step is one of a few before which a run is set back."""
    marks = range(1, _ROLLBACKS + 1)
    return m.number in {len(m.setting.steps) * n // (_ROLLBACKS + 1) for n in marks}


def _set_back_at_marks(m: Master) -> None:
    """Now and then go on, set the state back, and repeat the same steps."""
    if _at_mark(m):
        state = m.instance.get_state()
        m.go(m.instance, m.number, m.number + _REPEATED)
        m.instance.set_state(state)
        m.instance.free_state(state)
        m.read_again()
    m.set()


def _begin_both(m: Master, **changes: float) -> None:
    m.begin()
    m.instances[1].start({**m.setting.parameters, **changes})
    m.read(m.instances[1])


def _carry_over_at_marks(m: Master) -> None:
    """Now and then go on in the other instance, from the state as bytes."""
    if _at_mark(m):
        written = m.instance.written(m.instance.get_state())
        m.instances.reverse()
        m.instance.restore(written)
        m.read_again()
    m.set()


def _begin_again(m: Master) -> None:
    """Run most of the case, set what may be set, so that what stays shows, and reset."""
    m.begin()
    m.go(m.instance, 0, max(len(m.setting.steps) * 2 // 3, 1))
    changes = {"v": 0.05, "load": 1.0}
    m.instance.set({name: value for name, value in changes.items() if may_change(m.fmu, name)})
    m.instance.reset()
    m.begin()


def _step_other_before(m: Master) -> None:
    if m.number:
        m.go(m.instances[1], m.number - 1, m.number)
    m.set()


RUNS: Mapping[str, Way] = {
    "mirror": _symmetric(MIRROR),
    "forces": _symmetric(HEAVIER),
    "time": _symmetric(QUICKER),
    "splitting": Way(setting=_cut, back=_joined),
    "rollback": Way(set=_set_back_at_marks, states=True),
    "serialized": Way(
        begin=_begin_both, set=_carry_over_at_marks, instances=2, states=True, written=True
    ),
    "reset": Way(begin=_begin_again),
    "two_instances": Way(begin=partial(_begin_both, v=0.037), set=_step_other_before, instances=2),
    "shifted": Way(setting=_shifted, begin=_begin_motion, reads_start=False),
    "continued": Way(
        setting=_startable, begin=_begin_to_leave, set=_go_on_anew, reads_start=False, instances=2
    ),
}
"""What an invariant can name as ``run``."""


def other_run(fmu: FmuFile, case: Case, run: str) -> Run:
    """Drive an FMU through a case in another way of `RUNS`."""
    return RUNS[run](fmu, case)


def trial_run(
    fmu: FmuFile, setting: Setting, variables: Mapping[str, Variable], names: Sequence[str]
) -> Run:
    """Drive an FMU through a setting, and read `names`, by `variables` under any names."""
    fmu.variables = variables
    master = Master(fmu, setting)
    master.names = names
    return master.run()


def reference_run(_: FmuFile, case: Case) -> Run:
    """Run a case with the reference, where the FMU runs."""
    return kept(run_reference, case)
