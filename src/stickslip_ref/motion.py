"""The block moving from event to event; docs/theory.md (1), (4), (15).

Stick is linear and evaluated as such; slip is integrated. What happens between them - break-away,
re-stick, reversal, a change of input - is decided here, at rest, and nowhere else.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from functools import partial

import numpy as np

from .friction import FrictionLaw, breaks_away
from .inputs import Segment
from .meter import Phase
from .parameters import Parameters
from .slip import Floats, Sampling, integrate_slip
from .trajectory import Event, EventKind

MAX_SIMULTANEOUS = 100
"""Events at one time. Re-stick, break-away and a reversal may follow each other, more may not."""


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
    the segment's very end, and not with an event. ``sample`` is as in `slip.Slip`, for sticks too.
    """

    begin: float
    end: float
    duration: float
    closed: bool
    mode: int
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
        self.mode = int(np.sign(self.x_dot))
        self.account = Account()
        self.phases: list[Phase] = []
        self.events: list[Event] = []
        self._open = _Open(x_dot_peak=self.x_dot)
        self._simultaneous = 0
        # k z + F_ext - s slip_friction(0) [N], where an event gives it more exactly than z does.
        self._net_force: float | None = None
        if self.mode == 0:
            self._test_rest()

    def change(self, p: Parameters) -> None:
        """Let new inputs and parameters act from now on. A change of k keeps z."""
        work = 0.5 * (float(p.k) - float(self.p.k)) * self.z * self.z
        self.account = replace(self.account, W_k=self.account.W_k + work)
        self.p = p
        self._net_force = None
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
            duration, sample, event = self._slip(left) if self.mode else self._stick(left)
            end = min(self.now + duration, segment.end) if event else segment.end
            yield Arc(
                begin=self.now,
                end=end,
                duration=duration,
                closed=event is None,
                mode=self.mode,
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

    def _stick(self, left: float) -> tuple[float, Sampling, Callable[[], None] | None]:
        """Let the pulled end move until break-away, or for the time that is left."""
        z, v = self.z, float(self.p.v)
        wait, rate = math.inf, float(self.p.k) * v
        if rate != 0.0:
            reach = math.copysign(self._hold, v) - float(self.p.F_ext) - float(self.p.k) * z
            wait = max(reach / rate, 0.0)

        def sample(times: Floats) -> tuple[Floats, ...]:
            none = np.zeros_like(times)
            return -v * times, none, (z + 0.5 * v * times) * times, none

        # A break-away that falls on the end of the segment is left to what acts from then on.
        return (wait, sample, self._break_away) if wait < left else (left, sample, None)

    def _slip(self, left: float) -> tuple[float, Sampling, Callable[[], None] | None]:
        """Let the mass slip until it stops, or for the time that is left."""
        net_force = self._net_force
        if net_force is None:
            net_force = self._pull - self.mode * self.law.slip_friction(self.p, 0.0)
        slip = integrate_slip(
            self.p, self.law, self.mode, self.z, self.x_dot, net_force, left, self.rtol
        )
        self._open.x_dot_peak = max(self._open.x_dot_peak, slip.x_dot_peak, key=self._along)
        if not slip.stopped:
            return slip.duration, slip.sample, None
        if slip.grazes:
            return slip.duration, slip.sample, self._graze
        return slip.duration, slip.sample, partial(self._stop_slip, slip.uncertainty)

    def _advance(self, duration: float, end: float, sample: Sampling) -> None:
        """Take over the state at the end of an arc. In stick, x keeps every bit."""
        relief, x_dot, integral_z, heat = (float(each[0]) for each in sample(np.array([duration])))
        p, account = self.p, self.account
        step = float(p.v) * duration + relief if self.mode else 0.0
        self.account = Account(
            W_pull=account.W_pull + float(p.k) * float(p.v) * integral_z,
            W_k=account.W_k,
            W_ext=account.W_ext + float(p.F_ext) * step,
            Q_friction=account.Q_friction + heat,
        )
        self.z -= relief
        self.x += step
        self.x_dot = x_dot
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
        if self._open.duration > 0.0:
            self.z = (s * self._hold - float(self.p.F_ext)) / float(self.p.k)
        self._transit("break-away", s)
        self._net_force = s * max(self._hold - self.law.slip_friction(self.p, 0.0), 0.0)

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
        balance = self.mode * self.law.slip_friction(self.p, 0.0)
        self.z = (balance - float(self.p.F_ext)) / float(self.p.k)
        self._stop_slip()

    def _transit(self, kind: EventKind, mode: int) -> None:
        """Close the phase under way and begin the next."""
        time = self.start_time + self.now
        self.phases.append(Phase(kind, time, **asdict(self._open)))
        self.events.append(Event(time, kind, mode, self.x, self.z))
        self._open = _Open()
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

    def _along(self, x_dot: float) -> float:
        return self.mode * x_dot

    @property
    def _pull(self) -> float:
        """What pulls at the mass beside friction and damping [N]."""
        return float(self.p.k) * self.z + float(self.p.F_ext)

    @property
    def _hold(self) -> float:
        """Break-away force [N]."""
        return self.law.break_away_force(self.p)
