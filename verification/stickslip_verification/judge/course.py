"""One side's run of a case, step by step, beside what was set: what the residuals are made of.

The linear motion over a step is exact, docs/theory.md (3), for many steps at once. In the time
``tau = w t`` the extension z, measured from where the slip has its balance, obeys
``z'' + 2 zeta z' + z = 0``. Its transition matrix is summed as a power series and squared up, in
the widest floating-point numbers there are, so that its own rounding is never what is seen.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from ..drive.exact import Exact
from ..model.quantities import GROUPS, OUTPUTS, QUANTITIES
from ..model.verdict import Run, Series, Transition
from ..suite.cases import Case
from ..truth import friction_law

Mask = NDArray[np.bool_]

SLACK = 8.0 * 2.0**-52
"""What the rest test forgives, as a part of the forces it compares: docs/theory.md (4)."""


class CheckError(ValueError):
    """A check cannot be evaluated: the message says what is not there."""


class LackingError(CheckError):
    """A side does not have an output that a check needs."""


_METER = (*GROUPS["meter"], "f", "n_slips", "t_event")
"""Outputs of the meter, whose beginning is a matter of agreement."""


@dataclass(frozen=True)
class Band:
    """What a run of a case is compared with at each point, with what was ``agreed`` on or not."""

    exact: Exact
    agreed: bool = False

    def judged(self, quantity: str) -> Mask:
        """Return the points at which a quantity is physics."""
        meant = [self._meant(output) for output in QUANTITIES[quantity].columns]
        finite = np.isfinite(self._samples(quantity, self.exact.record))
        return np.asarray(finite & np.all(meant, axis=0))

    def pair(self, quantity: str, run: Run) -> tuple[NDArray[np.intp], Series, Series, Mask]:
        """Return a quantity in the exact motion and in a run, at the points that the run has.

        First the indices of these points, last where the quantity is physics. Slips are counted
        from the first event where the start counts none: NaN before, and everywhere in a run that
        does not have that point.
        """
        read = np.minimum(np.searchsorted(self._times, run.times), self._times.size - 1)
        expected = self._samples(quantity, self.exact.record)[read]
        got = self._samples(quantity, run)
        if quantity == "x_pull" and not self.agreed and read.size > 1:
            # Where the pulled end is counted from is a matter of agreement.
            expected, got = expected - expected[0], got - got[0]
        if quantity == "n_slips" and self._starts_in_motion and not self.agreed:
            first = np.flatnonzero(self._meant(quantity))[:1]
            base = np.flatnonzero(np.isin(read, first))
            expected = expected - (expected[base] if base.size else np.nan)
            got = got - (got[base] if base.size else np.nan)
        return read, expected, got, self.judged(quantity)[read] & np.isfinite(expected)

    def _samples(self, quantity: str, run: Run) -> Series:
        with np.errstate(all="ignore"):
            samples = QUANTITIES[quantity].compute(run.outputs, self.exact.start)
        return np.asarray(samples, dtype=np.float64)

    def largest(self, quantity: str) -> float:
        """Return the largest value in play of what has the unit of a quantity, in that unit."""
        unit = QUANTITIES[quantity].unit
        alike = [each.name for each in OUTPUTS if each.unit == unit != "1"] or [quantity]
        values = [self._samples(name, self.exact.record) for name in alike]
        values += [self._pull] if unit == "m/s" else [self._times] if unit == "s" else []
        return float(max(np.max(np.abs(v[np.isfinite(v)]), initial=0.0) for v in values))

    @property
    def _pull(self) -> Series:
        """Mean speed of the pulled end over each step [m/s]."""
        record = self.exact.record
        places = np.concatenate(([record.initial["x_pull"]], record.outputs["x_pull"]))
        return np.asarray(np.diff(places) / np.diff(np.concatenate(([0.0], self._times))))

    @property
    def _times(self) -> Series:
        return self.exact.record.times

    def _meant(self, output: str) -> Mask:
        """Return the points at which an output is physics, and not what our meter agreed on.

        That is whether a start in motion is a slip, the first stick a stick, and a reversal a
        break-away.
        """
        if self.agreed or output not in _METER:
            return np.ones(self._times.size, dtype=np.bool_)
        breaks = self._happened(Transition.BREAK_AWAY)
        if output in ("T", "f"):
            return self._cycled(breaks, 2)
        if output == "t_stick":
            return self._cycled(breaks, 1)
        if output == "t_event":
            return np.asarray(self._times > np.min(self._happened(*Transition), initial=np.inf))
        ends = self._happened(Transition.RE_STICK, Transition.REVERSAL)
        if output == "n_slips":
            began = 0.0 if self._starts_in_motion else -np.inf
        else:
            began = float(np.min(breaks, initial=np.inf))
        first = np.min(ends[ends > began], initial=np.inf)
        whole = output == "n_slips" and not self._starts_in_motion
        return np.asarray(whole | (self._times > first))

    def _cycled(self, breaks: Series, back: int) -> Mask:
        """Return the points after two break-aways at least, the last `back` without a reversal."""
        # A break-away that a change brings about shows after the next step.
        count = np.searchsorted(breaks, self._times)
        since = np.append(breaks, np.inf)[np.where(count >= 2, count - back, -1)]
        reversals = self._happened(Transition.REVERSAL)
        turned = np.searchsorted(reversals, self._times) > np.searchsorted(reversals, since)
        return np.asarray((count >= 2) & ~turned)

    def _happened(self, *kinds: Transition) -> Series:
        """Return the times of these transitions [s], those at the very start left out."""
        events = self.exact.events
        return np.array([each.time for each in events if each.kind in kinds and each.time > 0.0])

    @property
    def _starts_in_motion(self) -> bool:
        first = self.exact.events[0] if self.exact.events else None
        at_once = first is not None and first.time == 0.0
        return at_once or self.exact.start["x_dot_start"] != 0.0


@dataclass(frozen=True)
class Residual:
    """By how much an invariant is missed, step by step.

    ``values`` in ``unit`` are zero where the invariant holds, ``where`` are the steps that it is
    about, both of shape ``(n,)``; ``scale``, above zero, is what the residual is measured against.
    """

    values: Series
    where: Mask
    scale: Series | float
    unit: str


@dataclass(frozen=True)
class Course:
    """The run of one side, `record`, with the exact motion at the same points.

    Every array has one entry per communication step, shape ``(n,)``. An output is taken at the
    end of the step by `after` and at its beginning by `before`. ``event_times`` are the exact times
    of the transitions [s].
    """

    case: Case
    record: Run
    exact: Run
    event_times: Series

    def after(self, name: str) -> Series:
        """Return an output at the end of each step; `LackingError` if the side lacks it."""
        if name not in self.record.outputs:
            raise LackingError(f"no output {name}")
        return self.record.outputs[name]

    def before(self, name: str) -> Series:
        """Return an output at the beginning of each step, or raise as `after` does."""
        samples = self.after(name)
        if name not in self.record.initial:
            raise LackingError(f"no output {name}")
        return np.concatenate(([self.record.initial[name]], samples[:-1]))

    def change(self, name: str) -> Series:
        """Return what each step adds to an output, or raise as `after` does."""
        return self.after(name) - self.before(name)

    def residual(
        self, values: Series, unit: str, where: Mask | None = None, scale: float | None = None
    ) -> Residual:
        """Return a residual, about all steps where none are named, on the scale of its unit."""
        everywhere = np.ones(self.h.size, dtype=np.bool_)
        if scale is None:
            scale = 1.0 if unit == "1" else self.scale[unit]
        return Residual(values, everywhere if where is None else where, scale, unit)

    @cached_property
    def h(self) -> Series:
        """Lengths of the steps [s]."""
        return np.array([step.h for step in self.case.steps])

    @cached_property
    def begins(self) -> Series:
        """Times at the beginning of the steps [s]."""
        return np.concatenate(([0.0], self.record.times[:-1]))

    @cached_property
    def settings(self) -> Mapping[str, Series]:
        """What acts during each step, by name: all values; mu_k as the law uses it: (1)."""
        changes = (step.changes for step in self.case.steps)
        _, *rows = accumulate(changes, lambda row, new: {**row, **new}, initial=self.case.start)
        columns = {name: np.array([row[name] for row in rows]) for name in rows[-1]}
        law = friction_law(self.case.law)
        columns["mu_k"] = np.array([law.coefficient(row) for row in rows])
        return columns

    @cached_property
    def normal_force(self) -> Series:
        """N = m g + load [N] during each step; never below zero by rounding."""
        s = self.settings
        return np.maximum(s["m"] * s["g"] + s["load"], 0.0)

    @property
    def grows(self) -> bool:
        """Whether static friction grows with the age of a stick."""
        return any(np.any(self.settings.get(name, 0.0)) for name in ("tau_s", "B"))

    def static_friction(self, age: Series | None) -> tuple[Series, Series]:
        """Return mu_s N [N] and its rate [N/s], (1), (19), at any age [s] where `age` is None."""
        s = self.settings
        if age is None:
            return s["mu_s"] * self.normal_force, np.zeros(self.h.size)
        gap, ages = s["mu_s"] - s["mu_k"], s["tau_s"] > 0.0
        left = np.where(ages, np.exp(-age / np.where(ages, s["tau_s"], 1.0)), 0.0)
        coefficient = s["mu_s"] - gap * left + s["B"] * np.log1p(age / s["t_0"])
        rate = np.where(ages, gap * left / np.where(ages, s["tau_s"], 1.0), 0.0)
        rate = rate + s["B"] / (s["t_0"] + age)
        return coefficient * self.normal_force, rate * self.normal_force

    @cached_property
    def age(self) -> Series | None:
        """Age [s] of the stick at the end of each step, 0 in slip; None where it is the same."""
        if not self.grows:
            return None
        first = np.where(self.after("n_slips") == 0.0, self.settings["age_start"], 0.0)
        resting = self.record.times - self.after("t_event") + first
        return np.where(self.mode[1] == 0.0, np.maximum(resting, 0.0), 0.0)

    @cached_property
    def mode(self) -> tuple[Series, Series]:
        """Direction of slip before and after each step, from mode or, without it, sticking."""
        if "mode" in self.record.outputs:
            return self.before("mode"), self.after("mode")
        before, after = (
            np.where(at("sticking") != 0, 0.0, np.sign(at("x_dot")))
            for at in (self.before, self.after)
        )
        return before, after

    @property
    def rests(self) -> Mask:
        """Points at which the side says that the mass sticks."""
        return np.asarray(self.mode[1] == 0.0)

    @cached_property
    def eventless(self) -> Mask:
        """Steps in which the side reports no transition, nor changes its mode.

        Where it does not report them: those in which the exact motion has none.
        """
        same = self.mode[0] == self.mode[1]
        reports = [name for name in ("t_event", "n_slips") if name in self.record.outputs]
        if not reports:
            ends = np.searchsorted(self.event_times, self.record.times, side="right")
            starts = np.searchsorted(self.event_times, self.begins, side="left")
            return np.asarray(same & (ends == starts))
        for name in reports:
            same = same & (self.change(name) == 0.0)
        return np.asarray(same)

    @cached_property
    def in_phase(self) -> Mask:
        """Points at which the side is in the same phase of the same slip as the exact motion."""
        same = self.mode[1] == self.exact.outputs["mode"]
        if "n_slips" in self.record.outputs:
            same = same & (self.after("n_slips") == self.exact.outputs["n_slips"])
        return np.asarray(same)

    @cached_property
    def stick(self) -> Mask:
        """Steps that lie in a stick as a whole."""
        return np.asarray(self.eventless & self.rests)

    @cached_property
    def slip(self) -> Mask:
        """Steps that lie in a slip as a whole."""
        return np.asarray(self.eventless & ~self.rests)

    @cached_property
    def since_begin(self) -> Series:
        """From the beginning of each step to the transition that it reports [s]."""
        return np.clip(self.after("t_event") - self.begins, 0.0, self.h)

    @cached_property
    def break_away(self) -> Mask:
        """Steps that begin in stick, end in slip, and hold one break-away and nothing else."""
        one = self.change("n_slips") == 0.0
        return np.asarray(one & (self.mode[0] == 0.0) & ~self.rests & self._dated)

    @cached_property
    def re_stick(self) -> Mask:
        """Steps that begin in slip, end in stick, and hold one re-stick and nothing else."""
        one = self.change("n_slips") == 1.0
        return np.asarray(one & (self.mode[0] != 0.0) & self.rests & self._dated)

    @cached_property
    def _dated(self) -> Mask:
        """Steps whose last transition the side dates into the step, to the rounding of time."""
        dated = self.after("t_event")
        slack = 4.0 * np.spacing(np.abs(self.record.times))
        return np.asarray((dated >= self.begins - slack) & (dated <= self.record.times + slack))

    @cached_property
    def dating(self) -> Series:
        """What the rounding of absolute times leaves open of a transition in each step [s]."""
        return np.asarray(8.0 * np.spacing(np.abs(self.record.times)))

    @cached_property
    def scale(self) -> Mapping[str, float]:
        """Largest magnitude in play by unit: what differences are rounded to.

        In a slip a speed amounts to a length in a radian, and an extension to a speed: "slip m" and
        "slip m/s".
        """
        exact, s = self.exact.outputs, self.settings
        w = np.sqrt(s["k"] / s["m"])
        length = _largest(*(exact[name] for name in ("x", "x_pull", "z")))
        speed = _largest(exact["x_dot"], s["v"])
        stored = 0.5 * s["k"] * exact["z"] ** 2 + 0.5 * s["m"] * exact["x_dot"] ** 2
        works = (exact[name] for name in ("W_pull", "W_k", "Q_friction"))
        return {
            "m": length,
            "m/s": speed,
            "N": _largest(s["k"] * exact["z"], s["F_ext"], exact["F_s"]),
            "J": _largest(stored, _largest(s["F_ext"]) * exact["x"], *works),
            "slip m": max(length, speed / float(np.min(w))),
            "slip m/s": max(speed, float(np.max(w)) * _largest(exact["z"])),
        }

    def scale_of(self, output: str) -> float:
        """Return the largest in play of the kind of an output: what it is measured against."""
        unit = QUANTITIES[output].unit
        own = _largest(self.exact.outputs[output]) or 1.0
        scales = {**self.scale, "s": self.case.stop_time}
        return scales.get(f"slip {unit}", scales.get(unit, own))


def _largest(*series: Series) -> float:
    return float(max(np.max(np.abs(samples)) for samples in series))


Metric = Callable[[Course], Residual]
"""From a side's run to what an invariant leaves over in it. Raises `LackingError`."""


Wide = NDArray[np.longdouble]

_PRODUCT = "ijn,jkn->ikn"
_TERMS = 24
_LARGEST = 0.25  # a series of so many terms is exact to 1e-30 for matrices of this norm


@dataclass(frozen=True)
class State:
    """z [m] and x_dot [m/s] of each step, shape ``(n,)``."""

    z: Wide
    x_dot: Wide


@dataclass(frozen=True)
class Slips:
    """The equation of slip of some steps: (3). Arrays of shape ``(n,)``, SI units."""

    m: Wide
    k: Wide
    c: Wide
    v: Wide
    drive: Wide
    """F_ext less kinetic friction, ``F_ext - s mu_k N`` [N]."""

    def acceleration(self, state: State) -> Wide:
        """Return x_ddot [m/s2]."""
        return np.asarray((self.k * state.z + self.drive - self.c * state.x_dot) / self.m)

    def jerk(self, state: State) -> Wide:
        """Return the rate of x_ddot [m/s3]."""
        rate = self.k * (self.v - state.x_dot) - self.c * self.acceleration(state)
        return np.asarray(rate / self.m)

    def move(self, state: State, duration: Series | Wide) -> State:
        """Return the state `duration` [s] later, if the slip lasts."""
        w = np.sqrt(self.k / self.m)
        centre = (self.c * self.v - self.drive) / self.k
        y, rate = state.z - centre, (self.v - state.x_dot) / w
        a, b, c, d = _transition(w * np.asarray(duration, np.longdouble), self.c / (self.m * w))
        return State(centre + a * y + b * rate, self.v - w * (c * y + d * rate))


def slips(course: Course, steps: Mask, direction: Series) -> tuple[Slips, State]:
    """Return the equations of the chosen steps, in the direction that each has, and their begin.

    That is the state that the side had there.
    """
    s = {name: np.asarray(values[steps], np.longdouble) for name, values in course.settings.items()}
    friction = direction[steps] * s["mu_k"] * course.normal_force[steps]
    z, x_dot = (np.asarray(course.before(n)[steps], np.longdouble) for n in ("z", "x_dot"))
    equations = Slips(s["m"], s["k"], s["c"], s["v"], s["F_ext"] - friction)
    return equations, State(z, x_dot)


def _transition(tau: Wide, two_zeta: Wide) -> tuple[Wide, Wide, Wide, Wide]:
    """Return the entries of exp([[0, 1], [-1, -2 zeta]] tau), row by row."""
    if tau.size == 0:
        return tau, tau, tau, tau
    norm = np.max(np.abs(tau) * np.maximum(1.0 + two_zeta, 1.0))
    halvings = max(0, int(np.ceil(np.log2(float(norm) / _LARGEST)))) if norm > 0.0 else 0
    short = tau / np.longdouble(2.0) ** halvings
    step = np.stack([np.stack([0 * short, short]), np.stack([-short, -two_zeta * short])])
    eye = np.zeros_like(step)
    eye[0, 0] = eye[1, 1] = 1.0
    total, term = eye.copy(), eye
    for n in range(1, _TERMS):
        term = np.einsum(_PRODUCT, term, step) / n
        total = total + term
    for _ in range(halvings):
        total = np.einsum(_PRODUCT, total, total)
    return total[0, 0], total[0, 1], total[1, 0], total[1, 1]
