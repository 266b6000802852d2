"""An exact run of the block, steps and changes in, every output out: from event to event.

docs/theory.md (1), (4). Where a decision depends on the equality of two numbers, it is taken on a
difference that is exactly zero when they are equal (the gap between the frictions, the square under
the root of a grazing stop), never on the sign of a rounded result.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any

import mpmath

from .coulomb import COULOMB
from .law import FrictionLaw, Slip
from .lugre import LUGRE
from .march import March
from .parameters import Context, Number, changeable, complete, exact, high_precision, sign
from .rate_state import RATE_STATE
from .series import Series, bracketed_zero
from .stribeck import STRIBECK


class Meter:
    """The cycle meter of one run.

    `readings` are its outputs by name, SI, 0 until first written; `stick_start` [s] is when the
    last stick began.
    """

    def __init__(self, context: Context, start_time: Number) -> None:
        zero = context.zero
        names = ("delta_x", "spring_drop", "t_stick", "t_slip", "T", "f", "x_dot_peak")
        self.readings: dict[str, Number] = dict.fromkeys(names, zero)
        self.readings |= {"n_slips": 0, "t_event": start_time}
        self._zero = zero
        self.stick_start = start_time
        self._last_break_away: Number | None = None
        self._slip_start: tuple[Number, Number, Number] | None = None
        self._direction = 0
        self._top_speed = zero

    def begin_slip(self, time: Number, direction: int, x: Number, z: Number) -> None:
        """Mark where a slip begins: time [s], s, mass [m] and spring [m]."""
        self._slip_start = (time, x, z)
        self._direction = direction
        self._top_speed = self._zero

    def break_away(self, time: Number) -> None:
        """Write what a break-away at `time` [s] shows."""
        self.readings["t_stick"] = time - self.stick_start
        if self._last_break_away is not None:
            T = time - self._last_break_away
            self.readings |= {"T": T, "f": 1 / T}
        self._last_break_away = time
        self.readings["t_event"] = time

    def speed_reached(self, top_speed: Number) -> None:
        """Note the largest speed [m/s] along one stretch of the slip under way."""
        self._top_speed = max(self._top_speed, top_speed)

    def end_slip(self, time: Number, x: Number, z: Number) -> None:
        """Write what the end of a slip at `time` [s] shows, mass at x [m], spring at z [m]."""
        assert self._slip_start is not None
        start_time, start_x, start_z = self._slip_start
        self.readings["t_slip"] = time - start_time
        self.readings["delta_x"] = x - start_x
        self.readings["spring_drop"] = start_z - z
        self.readings["x_dot_peak"] = self._direction * self._top_speed
        self.readings["n_slips"] += 1
        self.readings["t_event"] = time
        self._slip_start = None


@dataclass(frozen=True)
class Event:
    """A transition of the mass."""

    time: Number  # [s]
    kind: str  # "break-away", "re-stick" or "reversal"
    mode: int  # after it: s, or 0 for stick
    x: Number  # of the mass [m]
    z: Number  # of the spring [m]


@dataclass(frozen=True)
class Stick:
    """A stick with all inputs and parameters constant."""

    wait: Number | None  # time from here to break-away [s], None if there is none
    overload: Number  # of the force beyond F_s at that break-away [N], within the slack
    way: Number  # what the force lacks to break-away here [N], below 0 only within the slack


class Motion:
    """The state of one run, carried along its arcs; `values` are all parameters."""

    def __init__(
        self, context: Context, values: Mapping[str, float], start_time: float, law: FrictionLaw
    ) -> None:
        self._context = context
        self._law = law
        self._values = dict(values)
        self._n = exact(context, self._values)
        # Rest test, docs/theory.md (4): beyond F_s by more than this part of the forces is larger.
        self._slack = context.ldexp(8, -52)
        self._tie = context.ldexp(1, -52)
        self.time = context.mpf(start_time)
        self.events: list[Event] = []
        self.margin = context.inf
        self._meter = Meter(context, self.time)
        self._x = context.mpf(self._values["x_start"])
        self._z = context.mpf(self._values["z_start"])
        self._W_pull = context.zero
        self._W_k = context.zero
        self._Q_friction = context.zero
        self._arc_start = self.time
        self._arc: Slip | Stick
        self._mode = 0
        # A break-away or reversal that the rest test has decided and no time has followed yet.
        self._undone = False
        # When the stick under way began, as its age counts: a first stick may be older.
        self._born = self.time - law.age_start(self._n)
        self._state = law.state_start(self._n)
        x_dot = context.mpf(self._values["x_dot_start"])
        # Without a stick: whether the mass is ahead of the pull, and when in the arc it came to be.
        self._falls, self._seen = False, context.mpf(-1)
        if not law.sticks:
            self._mode = 1
            self._follow(x_dot)
            if self._falls:
                self._meter.begin_slip(self.time, self._along, self._x, self._z)
        elif x_dot:
            self._mode = sign(x_dot)
            self._meter.begin_slip(self.time, self._mode, self._x, self._z)
            self._slip_on(abs(x_dot))
        else:
            self._rest_test()

    def change(self, changes: Mapping[str, float]) -> None:
        """Set inputs and tunable parameters now; a value that is already there changes nothing."""
        new = {name: value for name, value in changes.items() if value != self._values[name]}
        if not new:
            return
        self._values.update(new)
        changed = exact(self._context, self._values)
        if not isinstance(self._arc, Stick) and self._arc.stays(
            changed, self.time - self._arc_start
        ):
            self._n = changed
            return
        speed = self._close_arc(self.time)
        before = self._n
        self._n = changed
        self._W_k += (self._n.k - before.k) * self._z * self._z / 2
        if not self._law.sticks:
            self._state = self._law.changed(before, changed, self._state)
            was_ahead = self._falls
            self._follow(speed)
            if self._falls != was_ahead:
                self._pass(self.time, self._x, self._z)
        elif self._mode == 0 or speed == 0:
            self._rest_test()
        else:
            self._slip_on(speed)

    def advance(self, h: float) -> None:
        """Let h > 0 seconds pass."""
        if self._undone:
            self._break_away_done()
        self.time += self._context.mpf(h)
        while True:
            arc = self._arc
            if isinstance(arc, Stick):
                arc = self._aged(arc)
                # Would pass: at exactly the break-away time the mass still sticks.
                if arc.wait is None or self._arc_start + arc.wait >= self.time:
                    return
                self._load_up_ends(self._arc_start + arc.wait, arc.overload)
            else:
                arc.reach(self.time - self._arc_start)
                if isinstance(arc, March) and not self._law.sticks:
                    self._look_for_extremes(arc, self.time - self._arc_start)
                end = None if arc.duration is None else self._arc_start + arc.duration
                if end is None or end > self.time:
                    self._note_decision(arc, self.time - self._arc_start)
                    return
                self._slip_ends(end, arc)

    def outputs(self) -> dict[str, Number]:
        """Return every output of the block by name, SI; mode and n_slips int, sticking bool."""
        n, z = self._n, self._z
        elapsed = self.time - self._arc_start
        x, x_dot, mode = self._x, self._context.zero, self._mode
        own: dict[str, Number] = {}
        W_pull, Q_friction = self._W_pull, self._Q_friction
        if isinstance(self._arc, Stick):
            W_pull = W_pull + n.v * n.k * (z + n.v * elapsed / 2) * elapsed
            z = z + n.v * elapsed
            F_friction = -(n.k * z + n.F_ext)
            F_s = self._hold(self.time - self._born, self._rested(elapsed))
        else:
            state = self._arc.state(elapsed)
            F_s = self._hold(self._context.zero, state)
            speed, distance = self._arc.motion(elapsed)
            work, heat = self._arc.work_and_heat(elapsed, speed, distance)
            heat -= self._law.stored(n, state) - self._law.stored(n, self._state)
            W_pull, Q_friction = W_pull + work, Q_friction + heat
            x = x + self._mode * distance
            z = z + n.v * elapsed - self._mode * distance
            x_dot = self._mode * speed
            F_friction = -(self._mode * self._arc.dry_friction(elapsed) + n.c * x_dot)
            if not self._law.sticks:
                mode = 0 if abs(x_dot) < n.own.get("v_stick", 0) else sign(x_dot)
                own = self._law.shown(self._context, n, x_dot, state)
        mu_k_used = self._law.mu_k_used(n)
        if mu_k_used is not None:
            own["mu_k_used"] = mu_k_used
        return {
            "x": x,
            "x_dot": x_dot,
            "x_pull": x + z,
            "z": z,
            "F": n.k * z,
            "F_friction": F_friction,
            "F_s": F_s,
            "sticking": mode == 0,
            "mode": mode,
            **self._meter.readings,
            "W_pull": W_pull,
            "W_k": self._W_k,
            "Q_friction": Q_friction,
            **own,
        }

    def _close_arc(self, time: Number) -> Number:
        """Move the start of what follows to `time`, energies included; return the speed there."""
        n, arc = self._n, self._arc
        elapsed = time - self._arc_start
        self._arc_start = time
        if isinstance(arc, Stick):
            self._W_pull += n.v * n.k * (self._z + n.v * elapsed / 2) * elapsed
            self._z += n.v * elapsed
            self._state = self._rested(elapsed)
            return self._context.zero
        if elapsed == 0:
            return arc.speed
        arc.reach(elapsed)
        state_before, self._state = self._state, arc.state(elapsed)
        speed, distance = arc.motion(elapsed)
        if arc.duration is not None and elapsed >= arc.duration:
            speed = self._context.zero
        work, heat = arc.work_and_heat(elapsed, speed, distance)
        self._W_pull += work
        stored = self._law.stored
        self._Q_friction += heat - (stored(n, self._state) - stored(n, state_before))
        self._x += self._mode * distance
        self._z += n.v * elapsed - self._mode * distance
        if self._law.sticks:
            self._meter.speed_reached(arc.top_speed(elapsed))
        elif self._falls and isinstance(arc, March):
            self._meter.speed_reached(arc.farthest(max(self._seen, 0), elapsed))
        self._note_decision(arc, elapsed)
        return speed

    def _rest_test(self) -> None:
        """Apply (4) to a mass at rest, at the start or after a change."""
        n = self._n
        kz = n.k * self._z
        A = kz + n.F_ext
        # A break-away that no time has followed has not ended the stick yet.
        rests = self._mode == 0 or self._undone
        age = self._arc_start - self._born if rests else self._context.zero
        F_s = self._hold(age, self._state)
        scale = abs(kz) + abs(n.F_ext) + F_s
        self._note(abs(abs(A) - F_s), scale)
        if abs(A) - F_s > self._slack * scale:
            direction = sign(A)
            from_stick = self._mode == 0
            self._mode = direction
            self._meter.begin_slip(self._arc_start, direction, self._x, self._z)
            self._undone = self._undone or from_stick
            self._slip((abs(A) - self._sliding()) / n.m)
            return
        if self._mode != 0 and not self._undone:
            # A reversal at this very instant that the change takes back: rest begins here.
            self._begin_stick(self._arc_start)
        self._mode = 0
        self._undone = False
        self._stick(F_s - sign(n.v) * A)

    def _stick(self, way: Number) -> None:
        """Begin a stick; `way` [N]: what the force lacks to break-away in the pull's direction."""
        n = self._n
        zero = self._context.zero
        wait = max(way, zero) / (n.k * abs(n.v)) if n.v else None
        self._arc = Stick(wait, max(-way, zero), way)

    def _begin_stick(self, time: Number) -> None:
        self._meter.stick_start = time
        self._born = time

    def _aged(self, stick: Stick) -> Stick:
        """Return a stick with the time to break-away of a force that grows with the age.

        That force is concave in the age and the load is linear, so what the load lacks has one
        zero after the beginning, and is negative after it. Where it lacks nothing at the beginning
        but the force grows faster than the load, the mass sticks on until that zero.
        """
        if not self._law.ages(self._n) or stick.wait is None:
            return stick
        elapsed = self.time - self._arc_start
        if elapsed <= stick.wait:
            return Stick(None, stick.overload, stick.way)
        n, began = self._n, self._arc_start - self._born
        rate = n.k * abs(n.v)
        first = self._hold(began, self._state)
        way = max(stick.way, self._context.zero)

        def lacking(t: Number) -> tuple[Number, Number]:
            grown = self._hold_series(began + t, self._rested(t))
            return way + grown.term(0) - first - rate * t, grown.term(1) - rate

        if lacking(elapsed)[0] >= 0:
            return Stick(None, stick.overload, stick.way)
        if way == 0 and lacking(stick.wait)[1] <= 0:
            return stick
        wait = bracketed_zero(self._context, lacking, stick.wait, elapsed)
        return Stick(wait, stick.overload, stick.way)

    def _slip_on(self, speed: Number) -> None:
        n = self._n
        force = self._mode * (n.k * self._z + n.F_ext) - self._sliding(speed) - n.c * speed
        self._slip(force / n.m, speed)

    @property
    def _along(self) -> int:
        """Direction of the pull; +1 at rest."""
        return -1 if self._n.v < 0 else 1

    def _follow(self, x_dot: Number) -> None:
        """Begin an arc of a law without a stick."""
        n = self._n
        force = n.k * self._z + n.F_ext
        x_dot, self._state = self._law.started(self._context, n, force, x_dot, self._state)
        self._slip_on(x_dot)
        self._falls = self._along * (x_dot - n.v) > 0
        self._seen = self._context.mpf(-1)

    def _look_for_extremes(self, arc: March, elapsed: Number) -> None:
        """Read the meter at the extremes of the spring that the arc has met."""
        for time, ahead in arc.passes(self._seen, elapsed):
            if self._falls:
                self._meter.speed_reached(arc.farthest(max(self._seen, 0), time))
            self._falls, self._seen = ahead, time
            distance = arc.motion(time)[1]
            z = self._z + self._n.v * time - distance
            self._pass(self._arc_start + time, self._x + distance, z)

    def _pass(self, time: Number, x: Number, z: Number) -> None:
        """End a phase: the spring falls from here on if the mass is ahead of the pull."""
        n = self._n
        if self._falls:
            self._meter.begin_slip(time, self._along, x, z)
            self._meter.break_away(time)
        else:
            self._meter.end_slip(time, x, z)
            self._meter.stick_start = time
        mode = 0 if abs(n.v) < n.own.get("v_stick", 0) else sign(n.v)
        self.events.append(Event(time, "break-away" if self._falls else "re-stick", mode, x, z))

    def _slip(self, acceleration: Number, speed: Number | None = None) -> None:
        """Begin an arc of slip with s x_ddot = `acceleration` [m/s2], by default from rest."""
        speed = self._context.zero if speed is None else speed
        self._arc = self._law.slip(
            self._context, self._n, self._mode, speed, acceleration, self._state
        )

    def _hold_series(self, age: Number, state: tuple[Number, ...]) -> Series:
        """Return the break-away force [N] as a series about the age [s]."""
        hold = self._law.hold(self._n, Series.variable(self._context, age), state)
        return hold if isinstance(hold, Series) else Series(self._context, [hold])

    def _hold(self, age: Number, state: tuple[Number, ...]) -> Number:
        return self._hold_series(age, state).term(0)

    def _sliding(self, speed: Number = 0) -> Number:
        """Return the friction [N] at a speed [m/s], now."""
        context = self._context
        state = [Series(context, [each]) for each in self._state]
        return self._law.kinetic(self._n, Series(context, [context.mpf(speed)]), state).term(0)

    def _rested(self, duration: Number) -> tuple[Number, ...]:
        return self._law.rested(self._n, duration, self._state)

    def _load_up_ends(self, time: Number, overload: Number) -> None:
        """Break away because the pulled end has brought the force to F_s, (6)."""
        n = self._n
        self._close_arc(time)
        self._mode = sign(n.v)
        F_s = self._hold(time - self._born, self._state)
        self._z = (self._mode * (F_s + overload) - n.F_ext) / n.k
        self._meter.begin_slip(time, self._mode, self._x, self._z)
        self._break_away_done()
        self._slip((self._law.gap(n, F_s, self._sliding()) + overload) / n.m)

    def _break_away_done(self) -> None:
        self._undone = False
        self._meter.break_away(self._arc_start)
        self._record("break-away")

    def _slip_ends(self, time: Number, slip: Slip) -> None:
        """End a slip: re-stick, or reverse at once if the force is beyond F_s, (1), (4)."""
        n, direction = self._n, self._mode
        self._close_arc(time)
        # The balance of forces at x_dot = 0, so that a mirror-image stop is one exactly.
        inertia, F_k = n.m * slip.end_acceleration, self._sliding()
        F_s = self._hold(self._context.zero, self._state)
        self._z = (direction * (F_k + inertia) - n.F_ext) / n.k
        self._meter.end_slip(time, self._x, self._z)
        # A stop is never beyond F_s along the slip: only the other side is a question.
        backward = -(F_k + inertia)
        scale = abs(n.k * self._z) + abs(n.F_ext) + F_s
        self._note(abs(F_s - backward), scale)
        if backward - F_s > self._slack * scale:
            self._mode = -direction
            self._meter.begin_slip(time, self._mode, self._x, self._z)
            self._record("reversal")
            self._slip((backward - F_k) / n.m)
            return
        self._mode = 0
        self._begin_stick(time)
        self._record("re-stick")
        along = sign(n.v) == direction
        self._stick(self._law.gap(n, F_s, F_k) - inertia if along else F_s - backward)

    def _record(self, kind: str) -> None:
        self.events.append(Event(self._arc_start, kind, self._mode, self._x, self._z))

    def _note(self, distance: Number, scale: Number) -> None:
        """Keep the smallest distance of a force from F_s; a tie to a rounding is no near miss."""
        if distance > self._tie * scale:
            self.margin = min(self.margin, distance / scale)

    def _note_decision(self, slip: Slip, elapsed: Number) -> None:
        decision = slip.decision(elapsed)
        if decision is not None:
            self.margin = min(self.margin, decision)


COULOMB_NAME = "coulomb"  # the name of Coulomb's law
BUILT_IN: dict[str, FrictionLaw] = {
    COULOMB_NAME: COULOMB,
    "stribeck": STRIBECK,
    "lugre": LUGRE,
    "rate_state": RATE_STATE,
}
"""The laws that come along, by name; any other name is a dotted one."""

_EXAMPLE = "'my_laws.stribeck:STRIBECK'"


def friction_law(name: str) -> FrictionLaw:
    """Return the truth's side of the friction law of a name.

    That is a name in `BUILT_IN`, or ``"module:NAME"``: an object whose attribute ``truth``
    is in turn the dotted name of a `FrictionLaw`. `ValueError`, with the reason and an example, if
    the name is not of this form, a module or an attribute is missing, or the object is no
    `FrictionLaw`.
    """
    if name in BUILT_IN:
        return BUILT_IN[name]
    inner = getattr(_found(name), "truth", None)
    if not isinstance(inner, str):
        raise ValueError(
            f"the friction law {name!r} has no attribute 'truth' with the dotted name of "
            "the truth's side, such as 'my_laws.stribeck.truth:LAW'"
        )
    law = _found(inner)
    if not isinstance(law, FrictionLaw):
        raise ValueError(
            f"{inner!r} is a {type(law).__name__}; the truth's side of a friction law is an "
            "object of a subclass of stickslip_verification.truth.FrictionLaw"
        )
    return law


def _found(name: str) -> Any:
    module, colon, attribute = name.partition(":")
    if not (module and colon and attribute):
        known = ", ".join(map(repr, BUILT_IN))
        raise ValueError(f"{name!r} is no friction law: {known}, or module:NAME such as {_EXAMPLE}")
    try:
        return getattr(import_module(module), attribute)
    except Exception as error:  # whatever a module of somebody else raises
        raise ValueError(
            f"the friction law {name!r} was not found ({error}); expected module:NAME, such as "
            f"{_EXAMPLE}, of a module that Python can import"
        ) from None


@dataclass(frozen=True)
class Step:
    """One communication step; inputs and tunable parameters act from its start on."""

    h: float  # [s], > 0
    changes: Mapping[str, float] = field(default_factory=dict)  # by name [SI]


@dataclass(frozen=True)
class Run:
    """The exact course of a run, in high-precision numbers, SI.

    ``initial`` has every output at the start, after the rest test there, by name; ``samples`` at
    the end of each step, mode and n_slips being int and sticking bool, at ``times`` [s], start_time
    plus the exact sum of the steps. ``events`` are all transitions in order of time.

    ``margin`` says how near the run came to another course, relative, +inf if no number decided
    anything. It is the smallest of: | |k z + F_ext| - F_s | over |k z| + |F_ext| + F_s at each rest
    test (at the end of a slip: the distance from F_s on the far side, the only one in question),
    exact ties to within 2^-52 left out since the slack of the test decides them; and |x_dot| / (|v|
    + |x_dot - v|) at each least speed of a slip that was stopped at, or passed by, left out where
    structure decides (undamped from rest with nothing changed on the way, undamped or under-damped
    against the pull). With over-damping and v = 0 the second is instead the share of the slow part
    in the start of the slip. A marched slip measures its end as `March.decision` says. Times of
    events near the ends of steps are not in it.
    """

    initial: Mapping[str, Number]
    samples: tuple[Mapping[str, Number], ...]
    times: tuple[Number, ...]
    events: tuple[Event, ...]
    margin: Number


def run(
    parameters: Mapping[str, float],
    steps: Iterable[Step],
    *,
    digits: int | None = 50,
    start_time: float = 0.0,
    law: FrictionLaw | str = COULOMB,
) -> Run:
    """Return the exact course of the block through `steps`, docs/theory.md (1) to (6), (15), (16).

    `parameters` are m g k c mu_s mu_k v load F_ext x_start x_dot_start z_start and the friction
    law's own, SI, as the exact binary numbers they are; what is missing takes its start value. The
    results carry `digits` decimal digits. None computes in doubles: some twenty times as fast, for
    planning a run and for how far nearby runs lie apart, never for a verdict. `start_time` is in s;
    `law` is the friction law, or its name as `friction_law` takes it.

    `ValueError`, with the parameter, its value and its range, for an unknown name; NaN or infinity;
    m, g or k not positive; c, mu_s or mu_k negative; load below -m g; h not positive; a change of
    what is fixed. Also if the friction law is not found, or the mass slips faster than it holds.
    """
    context = mpmath.fp if digits is None else high_precision(digits)
    law = friction_law(law) if isinstance(law, str) else law
    values = complete(parameters, law.parameters)
    law.check(values)
    may_change = changeable(law.parameters)
    if not math.isfinite(start_time):
        raise ValueError(f"start_time = {start_time} is not a finite number")
    motion = Motion(context, values, start_time, law)
    initial = motion.outputs()
    samples: list[Mapping[str, Number]] = []
    times: list[Number] = []
    for step in steps:
        if not (math.isfinite(step.h) and step.h > 0.0):
            raise ValueError(f"h = {step.h} is outside h > 0")
        if step.changes:
            if fixed := sorted(set(step.changes) - may_change):
                names = ", ".join(fixed)
                raise ValueError(f"{names} cannot change in a run; {sorted(may_change)} can")
            values = complete({**values, **step.changes}, law.parameters)
            law.check(values)
            motion.change({name: values[name] for name in step.changes})
        motion.advance(step.h)
        samples.append(motion.outputs())
        times.append(motion.time)
    return Run(initial, tuple(samples), tuple(times), tuple(motion.events), motion.margin)
