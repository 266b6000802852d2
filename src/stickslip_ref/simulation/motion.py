"""The motion of the block from event to event; docs/theory.md (1), (4), (15).

Stick is linear and evaluated as such; slip is integrated. Break-away, re-stick, reversal and the
effect of a change of input are decided here and nowhere else.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from functools import partial

import numpy as np
from scipy.optimize import brentq

from ..laws import FrictionLaw
from ..parameters import Parameters
from ..trajectory import Event, EventKind
from .inputs import Segment
from .meter import Phase
from .slip import Floats, Samples, Sampling, integrate_slip
from .whole import integrate_whole

MAX_SIMULTANEOUS = 100
"""Events at one time. Re-stick, break-away and a reversal may follow each other, more may not."""

REST_SLACK = 8.0 * 2.0**-52
"""Rounding slack of the rest test, relative to the sum of the forces it compares; theory (4)."""


@dataclass(frozen=True)
class Account:
    """Energy account since the start [J]; docs/theory.md (15)."""

    W_pull: float = 0.0
    W_k: float = 0.0
    W_ext: float = 0.0
    Q_friction: float = 0.0


@dataclass(frozen=True)
class Arc:
    """A piece of motion in one mode under one set of parameters, and the state it begins with.

    ``begin`` and ``end`` count from the start of the run [s]; ``end`` is a number of its own since
    ``begin + duration`` may round past it. ``closed`` says that the arc ends with its segment, at
    the segment's very end, and not with an event. ``mode`` is None where the motion of a law
    without a stick is taken whole. ``age`` is the age of the stick at the beginning [s].
    """

    begin: float
    end: float
    duration: float
    closed: bool
    mode: int | None
    age: float
    p: Parameters
    x: float
    z: float
    account: Account
    n_events: int
    sample: Sampling


@dataclass
class _Open:
    """The phase under way: what has accumulated since it began."""

    duration: float = 0.0
    delta_x: float = 0.0
    spring_drop: float = 0.0
    x_dot_peak: float = 0.0


class Motion:
    """State of the block, and how it moves on.

    Parameters
    ----------
    p : Parameters
        Numbers only, the initial state among them.
    law : FrictionLaw
        The friction law.
    start_time : float
        Dates the events [s].
    rtol : float
        Relative tolerance of an integration step.
    max_events : int
        How many events to allow.
    """

    def __init__(
        self, p: Parameters, law: FrictionLaw, start_time: float, rtol: float, max_events: int
    ) -> None:
        self.p, self.law, self.start_time = p, law, start_time
        self.rtol, self.max_events = rtol, max_events
        self.now = 0.0
        self.x, self.z, self.x_dot = float(p.x_start), float(p.z_start), float(p.x_dot_start)
        self.state = law.state_start(p)
        self._age_before = law.age_start(p)
        self.x_dot = law.velocity_from(p, self.z, self.x_dot, self.state)
        # Without a stick, 1 while the mass is ahead of the pull and the spring falls, else 0.
        self.mode = int(np.sign(self.x_dot)) if law.sticks else int(self._ahead)
        self._settled = False
        self.account = Account()
        self.phases: list[Phase] = []
        self.events: list[Event] = []
        self._open = _Open(x_dot_peak=self.x_dot)
        self._simultaneous = 0
        # k z + F_ext - s slip_friction(0) [N], where an event gives it more exactly than z does.
        self._net_force: float | None = None
        if law.sticks and self.mode == 0:
            self._test_rest()

    def change(self, p: Parameters) -> None:
        """Let new inputs and parameters act from now on. A change of k keeps z."""
        work = 0.5 * (float(p.k) - float(self.p.k)) * self.z * self.z
        self.account = replace(self.account, W_k=self.account.W_k + work)
        before, self.p = self.p, p
        self._net_force = None
        if not self.law.sticks:
            self.state = self.law.changed(before, p, self.state)
            self.x_dot = self.law.velocity_from(p, self.z, self.x_dot, self.state)
            self._settled = False
            if self._ahead != bool(self.mode):
                self._turn()
            return
        if self.mode == 0:
            self._test_rest()
        elif self.x_dot == 0.0 and not (self._beyond() and self.mode * self._pull > 0.0):
            self._stop_slip()

    def arcs(self, segment: Segment) -> Iterator[Arc]:
        """Move to the end of a segment, arc by arc.

        Raises
        ------
        RuntimeError
            If there are too many events, or the integration of a slip fails.
        """
        while True:
            left = max(segment.end - self.now, 0.0)
            duration, sample, event = self._move(left)
            end = min(self.now + duration, segment.end) if event else segment.end
            yield Arc(
                begin=self.now,
                end=end,
                duration=duration,
                closed=event is None,
                mode=self.mode if self.law.sticks else None,
                age=self._age,
                p=self.p,
                x=self.x,
                z=self.z,
                account=self.account,
                n_events=len(self.events),
                sample=sample,
            )
            self._advance(duration, end, sample)
            if event is None:
                return
            event()

    def _move(self, left: float) -> tuple[float, Sampling, Callable[[], None] | None]:
        """Return the next arc: its duration, motion, and the event that ends it if one does."""
        if not self.law.sticks:
            return self._whole(left)
        return self._slip(left) if self.mode else self._stick(left)

    def _stick(self, left: float) -> tuple[float, Sampling, Callable[[], None] | None]:
        """Let the pulled end move until break-away, or for the time that is left."""
        z, v = self.z, float(self.p.v)
        wait, rate = math.inf, float(self.p.k) * v
        if rate != 0.0:
            reach = math.copysign(self._hold, v) - float(self.p.F_ext) - float(self.p.k) * z
            wait = max(reach / rate, 0.0)
            if self.law.ages(self.p) and wait < left:
                wait = self._aged_wait(wait, abs(rate), left)
        p, law, state = self.p, self.law, self.state

        def sample(times: Floats) -> Samples:
            none = np.zeros_like(times)
            rested = [law.rested(p, time, state) for time in times.tolist()] if state else []
            own = np.array(rested, dtype=np.float64).reshape(len(rested), len(state)).T
            return Samples(-v * times, none, (z + 0.5 * v * times) * times, none, own)

        # A break-away that falls on the end of the segment is left to what acts from then on.
        return (wait, sample, self._break_away) if wait < left else (left, sample, None)

    def _slip(self, left: float) -> tuple[float, Sampling, Callable[[], None] | None]:
        """Let the mass slip until it stops, or for the time that is left."""
        net_force = self._net_force
        p, state = self.p, self.state
        if net_force is None:
            net_force = self._pull - self.mode * self._sliding
        slip = integrate_slip(
            p, self.law, self.mode, self.z, self.x_dot, net_force, state, left, self.rtol
        )
        self._open.x_dot_peak = max(self._open.x_dot_peak, slip.x_dot_peak, key=self._along)
        if not slip.stopped:
            return slip.duration, slip.sample, None
        if slip.grazes:
            return slip.duration, slip.sample, self._graze
        return slip.duration, slip.sample, partial(self._stop_slip, slip.uncertainty)

    def _whole(self, left: float) -> tuple[float, Sampling, Callable[[], None] | None]:
        """Follow a law without a stick to an extreme of the spring, or for the time left."""
        falls, was_settled = bool(self.mode), self._settled
        phase = integrate_whole(
            self.p,
            self.law,
            self.z,
            self.x_dot,
            self.state,
            falls,
            was_settled,
            left,
            self.rtol,
        )
        self._settled = phase.settled
        if falls:
            peak = max(self._open.x_dot_peak, phase.x_dot_peak, key=lambda u: self._pulls * u)
            self._open.x_dot_peak = peak
        if not phase.ended:
            return phase.duration, phase.sample, None
        return phase.duration, phase.sample, self._leave if was_settled else self._pass_pull

    def _pass_pull(self) -> None:
        """Pass an extreme of the spring, where the mass is as fast as the pull."""
        self.x_dot = float(self.p.v)
        self._turn()

    def _turn(self) -> None:
        """End the phase under way."""
        if self.mode:
            self._transit("re-stick", 0)
        else:
            self._transit("break-away", 1)
        self._open.x_dot_peak = self.x_dot

    def _leave(self) -> None:
        """Leave steady sliding: extremes of the spring count again."""
        self._settled = False
        if self._ahead != bool(self.mode):
            self._turn()

    def _advance(self, duration: float, end: float, sample: Sampling) -> None:
        """Take over the state at the end of an arc. In stick, x keeps every bit."""
        *numbers, state = sample(np.array([duration]))
        relief, x_dot, integral_z, heat = (float(each[0]) for each in numbers)
        p, account = self.p, self.account
        sticks = self.law.sticks and self.mode == 0
        step = 0.0 if sticks else float(p.v) * duration + relief
        self.account = Account(
            W_pull=account.W_pull + float(p.k) * float(p.v) * integral_z,
            W_k=account.W_k,
            W_ext=account.W_ext + float(p.F_ext) * step,
            Q_friction=account.Q_friction + heat,
        )
        self.z -= relief
        self.x += step
        self.x_dot = x_dot
        self.state = tuple(state[:, 0].tolist()) if self.state else self.state
        self._net_force = None
        self._open.duration += duration
        self._open.delta_x += step
        self._open.spring_drop += relief
        if end > self.now:
            self._simultaneous = 0
            self.now = end

    def _break_away(self) -> None:
        """Break away at F_s, in the direction of the pull."""
        s = 1 if float(self.p.v) > 0.0 else -1
        excess = self.law.excess(self.p, self._age, self.state)
        if self._open.duration > 0.0:
            self.z = (s * self._hold - float(self.p.F_ext)) / float(self.p.k)
        self._transit("break-away", s)
        self._net_force = s * max(excess, 0.0)

    def _test_rest(self) -> None:
        """Break away at once if the mass rests beyond F_s."""
        if self._beyond():
            self._transit("break-away", 1 if self._pull > 0.0 else -1)

    def _stop_slip(self, uncertainty: float = 0.0) -> None:
        """End a slip: stick, or slip the other way if the force is beyond F_s.

        It does not go on the same way: what stopped the mass is more than what pulls it onward.
        ``uncertainty`` is what is not known of z [m].
        """
        self.x_dot = 0.0
        if self._beyond(uncertainty) and self.mode * self._pull < 0.0:
            self._transit("reversal", -self.mode)
        else:
            self._transit("re-stick", 0)

    def _graze(self) -> None:
        """End a slip that touches x_dot = 0 and no more: nothing accelerates the mass there.

        With F_s = 0 the direction of the next slip hangs on the last bit of z, so z is taken from
        the balance of forces and not from the integration.
        """
        balance = self.mode * self._sliding
        self.z = (balance - float(self.p.F_ext)) / float(self.p.k)
        self._stop_slip()

    def _transit(self, kind: EventKind, mode: int) -> None:
        """Close the phase under way and begin the next."""
        time = self.start_time + self.now
        self.phases.append(Phase(kind, time, **asdict(self._open)))
        shown = mode if self.law.sticks else shown_mode(self.p, np.array(self.x_dot))
        self.events.append(Event(time, kind, int(shown), self.x, self.z))
        self._open = _Open()
        self._age_before = 0.0
        self.mode = mode
        self._simultaneous += 1
        if self._simultaneous > MAX_SIMULTANEOUS:
            raise RuntimeError(
                f"{self._simultaneous} events without motion at t = {time!r} s: the mass neither "
                "sticks nor slips; please report these parameters"
            )
        if len(self.events) > self.max_events:
            raise RuntimeError(
                f"{len(self.events)} events by t = {time!r} s, more than max_events = "
                f"{self.max_events}; shorten the run or raise max_events"
            )

    def _beyond(self, uncertainty: float = 0.0) -> bool:
        k = float(self.p.k)
        return breaks_away(k * self.z, float(self.p.F_ext), self._hold, k * uncertainty)

    @property
    def _pulls(self) -> int:
        """Direction of the pull; +1 at rest."""
        return -1 if float(self.p.v) < 0.0 else 1

    @property
    def _ahead(self) -> bool:
        """Whether the mass is ahead of the pull, so that the spring falls."""
        return self._pulls * (self.x_dot - float(self.p.v)) > 0.0

    def _along(self, x_dot: float) -> float:
        return self.mode * x_dot

    @property
    def _pull(self) -> float:
        """What pulls at the mass beside friction and damping [N]."""
        return float(self.p.k) * self.z + float(self.p.F_ext)

    @property
    def _age(self) -> float:
        """Age of the stick [s]; 0 in slip."""
        return 0.0 if self.mode else self._age_before + self._open.duration

    @property
    def _hold(self) -> float:
        """Break-away force now [N]."""
        return self.law.break_away_force(self.p, self._age, self.state)

    @property
    def _sliding(self) -> float:
        """Friction at the smallest speed now [N]."""
        return self.law.slip_friction(self.p, 0.0, self.state)

    def _aged_wait(self, wait: float, rate: float, left: float) -> float:
        """Return how long [s] a stick lasts whose break-away force grows with its age.

        ``wait`` [s] is how long it would last without growth, ``rate`` [N/s] the growth of the
        load. The break-away force is concave in the age, so what the load lacks of it has one zero
        after the beginning: where it lacks nothing there, but the force grows faster, a later one.
        """
        age, excess = self._age, self.law.excess(self.p, self._age, self.state)

        def lacking(time: float) -> float:
            state = self.law.rested(self.p, time, self.state)
            growth = self.law.excess(self.p, age + time, state) - excess
            return growth - rate * (time - wait)

        if lacking(left) >= 0.0:
            return math.inf
        low = wait
        if wait == 0.0 or lacking(wait) <= 0.0:
            low = left
            while low > wait and lacking(low) <= 0.0:
                low *= 0.5
        if low <= wait and lacking(wait) <= 0.0:
            return wait
        return float(brentq(lacking, low, left, xtol=1e-300, rtol=4.0 * np.finfo(float).eps))


def shown_mode(p: Parameters, x_dot: Floats) -> Floats:
    """Return the mode at a velocity [m/s] of a law without a stick: its sign, 0 below v_stick."""
    return np.where(np.abs(x_dot) < p.own.get("v_stick", 0.0), 0.0, np.sign(x_dot))


def breaks_away(spring_force: float, F_ext: float, F_s: float, uncertainty: float = 0.0) -> bool:
    """Tell whether a mass at rest is pulled by more than friction holds; docs/theory.md (4).

    Parameters
    ----------
    spring_force, F_ext : float
        Spring force ``k z`` and external force [N].
    F_s : float
        Break-away force [N].
    uncertainty : float
        What is not known of the spring force [N], where it comes from an integration.

    Notes
    -----
    Equality sticks, and "more" means by more than rounding: ``8 * 2**-52`` of
    ``|k z| + |F_ext| + F_s``.
    """
    slack = REST_SLACK * (abs(spring_force) + abs(F_ext) + F_s)
    return abs(spring_force + F_ext) - F_s > slack + uncertainty
