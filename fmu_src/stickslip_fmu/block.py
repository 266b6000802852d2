"""The stick-slip block: inputs and parameters in, exact motion out, from event to event.

The block walks along arcs, which its friction law makes (`laws.law`). A communication step only
moves along the arc. A new arc starts at an event, or at the first step after an input or
parameter took another value; nothing else re-bases the motion.
"""

import math
from typing import Any, Dict, Optional

from fmi.model import ModelError
from fmi.plain import values

from .laws.law import Arc, Friction, Law, Motion, Start
from .meter import CycleMeter
from .numerics.compensated import ZERO, Sum, add
from .numerics.finite import NOT_FINITE, finite
from .record import Record, plain
from .saved import check_saved
from .settings import Settings

# What one step may hold: above it the caller would wait for minutes, so the step is refused.
MOST_TRANSITIONS = 2**24
# After every so many transitions the rest of a step is estimated from the part that is done.
_TRANSITIONS_TO_ESTIMATE = 4096


class State(Record):
    """All that the motion and the meter go on from; the outputs of a block follow from it.

    Attributes
    ----------
    wanted, settings
        The settings as last set, which act from the next step on, and those that hold.
    friction
        The friction law under the settings that hold.
    arc
        The arc that the block moves along.
    elapsed, elapsed_low
        Time since the start of the arc, a compensated sum [s].
    x, W_pull, W_k, Q_friction
        Position of the mass [m] and energies [J] at the start of the arc, compensated sums.
    meter
        The cycle meter.
    started
        Whether a step was made.
    changed
        Whether `wanted` is to be taken up.
    """

    Q_friction: Sum
    W_k: Sum
    W_pull: Sum
    arc: Arc
    changed: bool
    elapsed: float
    elapsed_low: float
    friction: Friction
    meter: CycleMeter
    settings: Settings
    started: bool
    wanted: Settings
    x: Sum

    def twin(self) -> "State":
        """Return a copy with a meter of its own."""
        twin: State = self.copy()
        twin.meter = self.meter.copy()
        return twin

    def save(self) -> Dict[str, Any]:
        """Return the fields by name as plain data, but for the friction, which follows."""
        fields = {name: getattr(self, name) for name in self.fields if name != "friction"}
        for name in ("wanted", "settings"):
            fields[name] = fields[name].as_dict()
        fields["arc"] = self.arc.start
        return {name: plain(value) for name, value in fields.items()}


class Block:
    """One stick-slip block under the friction law of its class.

    Parameters
    ----------
    settings
        Parameters, inputs and start values.
    start_time
        What `t_event` of the meter shows until the first transition [s].

    Attributes
    ----------
    x, x_dot, x_pull, z
        Position and velocity of the mass, of the pulled end, spring extension [m, m/s, m, m].
    F, F_friction, F_s
        Spring force, friction on the mass with its viscous part, break-away force [N].
    mode
        -1 slips backward, 0 sticks, +1 slips forward.
    own
        State of the friction law itself, where it `varies`.
    meter
        The cycle meter.
    state
        What the motion and the meter go on from.
    stale
        Whether the block moved since `refresh` computed the first four lines.

    Raises
    ------
    ModelError
        If the settings are beyond their range together.
    """

    law: Law

    # Length of the arc, and up to where a step only moves along it: none does before the first
    # step and where settings changed [s].
    _duration: float
    _horizon: float
    # Whether the law has outputs that move along an arc.
    _varies: bool

    def __init__(self, settings: Settings, start_time: float = 0.0) -> None:
        self.state = state = State()
        state.wanted = settings
        state.x = (settings.x_start, 0.0)
        state.W_pull = state.W_k = state.Q_friction = ZERO
        state.meter = self.meter = CycleMeter(start_time)
        state.started = False
        self._adopt_settings(None)
        x_dot = settings.x_dot_start
        mode = 0 if x_dot == 0.0 else 1 if x_dot > 0.0 else -1
        friction = state.friction
        self._place(friction.begin(mode, settings.z_start, x_dot, friction.age_start))
        state.changed = False
        self._horizon = -math.inf
        self.refresh()

    @property
    def wanted(self) -> Settings:
        """The settings as last set, which act from the next step on."""
        return self.state.wanted

    def set(self, name: str, value: float) -> None:
        """Set an input or tunable parameter; it acts from the start of the next step."""
        state = self.state
        if getattr(state.wanted, name) != value:
            state.wanted = state.wanted.changed(name, value)
            state.changed = True
            self._horizon = -math.inf

    def advance(self, time: float, step: float) -> None:
        """Move on by one communication step.

        Parameters
        ----------
        time
            Time at the start of the step [s]; it dates `t_event` of the meter and nothing else.
        step
            Length of the step [s], above zero and finite.

        Raises
        ------
        ModelError
            If the step is no such number or holds too many transitions, or if the values set
            since the last step are beyond their range together.
        """
        state = self.state
        elapsed = state.elapsed
        total = elapsed + step
        if total < self._horizon and step > 0.0 and time - time == 0.0:
            # The sum of `compensated.add`, written out: nearly every step ends here.
            shadow = total - elapsed
            low = state.elapsed_low + ((elapsed - (total - shadow)) + (step - shadow))
            state.elapsed = elapsed = total + low
            state.elapsed_low = low - (elapsed - total)
            self.stale = True
            return
        self._advance_through(time, step)

    def check(self) -> None:
        """Raise ModelError if the load that is set would lift the mass."""
        self.state.wanted.normal_force()

    def warning(self) -> Optional[str]:
        """Return what the friction law finds unusual about what is set, or None."""
        return self.law.warning(self.state.wanted)

    def refresh(self) -> None:
        """Compute the motion where the block stands; raises ModelError where it is not finite."""
        state = self.state
        settings = state.settings
        arc = state.arc
        growth, self.x_dot, displacement, friction = arc.state(state.elapsed)
        self.z = z = arc.z_start + growth
        high, low = state.x
        self.x = x = high + (low + displacement)
        self.x_pull = x_pull = x + z
        self.F = F = settings.k * z
        self.F_friction = 0.0 - (F + settings.F_ext) if friction is None else friction
        self.mode = arc.mode
        if self._varies:
            self.F_s = finite(state.friction.hold(self._age()))
            self.own = arc.own(state.elapsed)
        self._displacement = displacement
        self.stale = False
        if not abs(x_pull + F) < math.inf:
            raise ModelError(NOT_FINITE)

    @property
    def sticking(self) -> bool:
        """Whether the mass rests."""
        return self.mode == 0

    @property
    def W_pull(self) -> float:  # noqa: N802 - the symbol of the theory
        """Work done by the pulling end [J]: docs/theory.md (15)."""
        state = self.state
        high, low = state.W_pull
        return finite(high + (low + state.arc.pull_work(state.elapsed)))

    @property
    def W_k(self) -> float:  # noqa: N802 - the symbol of the theory
        """Energy put in by changing k [J]: docs/theory.md (15)."""
        return finite(self.state.W_k[0])

    @property
    def Q_friction(self) -> float:  # noqa: N802 - the symbol of the theory
        """Heat made by friction and damping [J], after `refresh`: docs/theory.md (15)."""
        state = self.state
        high, low = state.Q_friction
        return finite(high + (low + state.arc.heat(state.elapsed, self._displacement)))

    def freeze(self) -> State:
        """Return the whole state for `thaw`, of this block or another; it is not written to."""
        return self.state.twin()

    def thaw(self, frozen: State) -> None:
        """Take up a state that `freeze` returned, bit for bit."""
        self.state = state = frozen.twin()
        self.meter = state.meter
        self._show_law()
        self.mode = state.arc.mode
        self._duration = state.arc.duration
        self._horizon = self._duration if state.started and not state.changed else -math.inf
        self.stale = True

    def save(self) -> Dict[str, Any]:
        """Return the whole state as plain numbers, lists and dictionaries, for `restore`."""
        return self.state.save()

    def restore(self, saved: Dict[str, Any]) -> None:
        """Take up a state that `save` returned, bit for bit; raises ModelError for another."""
        check_saved(saved, self.save())
        kind = type(self.state.wanted)
        state = State()
        state.restore(saved)
        state.wanted = values(kind, saved["wanted"])
        state.settings = values(kind, saved["settings"])
        state.friction = self.law.under(state.settings)
        *start, own = saved["arc"]
        state.arc = state.friction.arc(Start._make([*start, tuple(own)]))
        state.meter = CycleMeter(0.0)
        state.meter.restore(saved["meter"])
        self.thaw(state)
        self.refresh()

    def _advance_through(self, time: float, step: float) -> None:
        """Move on by one step that may begin with other settings or hold transitions."""
        if not 0.0 < step < math.inf:
            raise ModelError(f"step size h = {step!r} s is out of range: above 0 and finite")
        if not math.isfinite(time):
            raise ModelError(f"communication point t = {time!r} s is out of range: a finite number")
        state = self.state
        if state.changed:
            self._change_settings(time)
        if not state.started:
            state.started = True
            if self.mode != 0 and state.arc.x_dot_start == 0.0:
                self.meter.break_away(time)
        high, low = add((state.elapsed, state.elapsed_low), step)
        transitions = 0
        while high >= self._duration:
            left, left_low = add((high, low), -self._duration)
            # A stick ends when time passes its end, a slip when time reaches it: (1).
            if left < 0.0 or (left == 0.0 and self.mode == 0):
                break
            self._pass_event(time + (step - left))
            high, low = left, left_low
            transitions += 1
            estimated = transitions % _TRANSITIONS_TO_ESTIMATE == 0
            if estimated and transitions > MOST_TRANSITIONS * ((step - left) / step):
                raise ModelError(
                    f"step size h = {step!r} s is out of range: it holds more than "
                    f"{MOST_TRANSITIONS} transitions between stick and slip; make it shorter"
                )
        state.elapsed = high
        state.elapsed_low = low
        self._horizon = self._duration
        self.stale = True

    def _pass_event(self, time: float) -> None:
        """Go through the end of the arc, at `time` [s], into the next one."""
        state = self.state
        arc = state.arc
        self._bank(arc.duration, arc.end())
        following = state.friction.after(arc, self.z)
        if following.mode != arc.mode:
            if arc.mode == 0:
                self.meter.break_away(time)
            else:
                self.meter.end_slip(time)
        self._place(following)

    def _change_settings(self, time: float) -> None:
        """Start a new arc under the wanted settings, at `time` [s], where the block stands."""
        state = self.state
        tau = state.elapsed
        arc = state.arc
        mode = arc.mode
        motion = arc.state(tau)
        x_dot = motion[1]
        # A slip of no length has not begun, so the rest test decides anew whether it does.
        at_rest = mode == 0 or (tau == 0.0 and x_dot == 0.0)
        before, k = state.friction, state.settings.k
        self._adopt_settings(before)
        state.changed = False
        if not at_rest and state.friction.slip_terms() == before.slip_terms():
            # What changed is not in the equation of slip, so the arc stays whole.
            return
        self._bank(tau, motion)
        z = self.z
        dk = state.settings.k - k
        state.W_k = add(state.W_k, 0.5 * (dk * z) * z)
        still = 0 if at_rest else mode
        # A mass that breaks away as the run starts has not moved before the first step.
        age = self._age() if state.started else state.friction.age_start
        self._place(state.friction.begin(still, z, x_dot, age, arc.own(tau)))
        if state.started and mode == 0 and self.mode != 0:
            self.meter.break_away(time)

    def _age(self) -> float:
        """Return the time that the mass has been at rest [s]."""
        state = self.state
        return state.arc.age + state.elapsed if state.arc.mode == 0 else 0.0

    def _bank(self, tau: float, motion: Motion) -> None:
        """Add the arc up to `tau`, where its motion is given, to the sums and the meter."""
        state = self.state
        arc = state.arc
        growth, _, displacement, _ = motion
        state.x = add(state.x, displacement)
        state.W_pull = add(state.W_pull, arc.pull_work(tau))
        state.Q_friction = add(state.Q_friction, arc.heat(tau, displacement))
        if arc.mode == 0:
            self.meter.pass_stick(tau)
        else:
            self.meter.pass_slip(tau, displacement, -growth, arc.extreme_velocity(tau))
        self.z = arc.z_start + growth

    def _adopt_settings(self, before: Optional[Friction]) -> None:
        """Let the wanted settings act; `before` is the friction until now."""
        state = self.state
        state.friction = self.law.under(state.wanted, before)
        state.settings = state.wanted
        self._show_law()

    def _show_law(self) -> None:
        """Take from the friction law what stays along an arc."""
        friction = self.state.friction
        self.F_s = friction.F_s
        self._varies = friction.varies

    def _place(self, arc: Arc) -> None:
        """Stand at the start of an arc."""
        state = self.state
        state.arc = arc
        state.elapsed = 0.0
        state.elapsed_low = 0.0
        self.mode = arc.mode
        self._duration = arc.duration
