"""The stick-slip block: inputs and parameters in, exact motion out, from event to event.

The state is an arc (`arcs`) and how far along it the block stands. A communication step only
moves along the arc. A new arc starts at an event, or at the first step after an input or
parameter took another value; nothing else re-bases the motion.
"""

import math
from operator import attrgetter
from typing import Any, Dict, List, Optional, Tuple, Union

from fmukit.model import ModelError
from fmukit.plain import values

from .arcs import SlipArc, StickArc
from .compensated import CompensatedSum, add
from .friction import clamp_warning, direction_from_rest, friction_forces, kinetic_coefficient
from .meter import CycleMeter
from .oscillator import Oscillator
from .saved import check_saved
from .settings import Settings

# What one step may hold: above it the caller would wait for minutes, so the step is refused.
MOST_TRANSITIONS = 2**24
# After every so many transitions the rest of a step is estimated from the part that is done.
_TRANSITIONS_TO_ESTIMATE = 4096

# All that the motion and the meter go on from; what a block shows follows from it.
_STATE = (
    "wanted",
    "_settings",
    "mu_k_used",
    "F_s",
    "_kinetic",
    "_gap",
    "_oscillator",
    "_origin",
    "_arc",
    "mode",
    "_duration",
    "_elapsed",
    "_elapsed_low",
    "_x",
    "_W_pull",
    "_W_k",
    "_Q_friction",
    "meter",
    "_started",
    "_changed",
    "_plain",
)
_freeze = attrgetter(*_STATE)

_NOT_FINITE = "the motion or its forces leave the range of double-precision numbers"


class Block:
    """One stick-slip block.

    Parameters
    ----------
    settings
        Parameters, inputs and start values.
    start_time
        What `meter.t_event` shows until the first transition [s].

    Attributes
    ----------
    x, x_dot, x_pull, z
        Position and velocity of the mass, of the pulled end, spring extension [m, m/s, m, m].
    F, F_friction, F_s
        Spring force, friction on the mass with its viscous part, break-away force [N].
    mode
        -1 slips backward, 0 sticks, +1 slips forward.
    mu_k_used
        Kinetic coefficient after the clamp.
    meter
        The cycle meter.
    wanted
        The settings as last set, which act from the next step on.
    stale
        Whether the block moved since `refresh` computed the first two lines.

    Raises
    ------
    ModelError
        If the settings are beyond their range together.
    """

    # Set by `_place`, wherever an arc starts.
    _arc: Union[StickArc, SlipArc]
    _origin: List[Optional[float]]
    _duration: float
    _elapsed: float
    _elapsed_low: float

    def __init__(self, settings: Settings, start_time: float = 0.0) -> None:
        self.wanted = settings
        self._x = CompensatedSum(settings.x_start)
        self._W_pull = CompensatedSum()
        self._W_k = CompensatedSum()
        self._Q_friction = CompensatedSum()
        self.meter = CycleMeter(start_time)
        self._started = False
        self._adopt_settings()
        if settings.x_dot_start != 0.0:
            mode = 1 if settings.x_dot_start > 0.0 else -1
            self._slip_on(mode, settings.z_start, settings.x_dot_start)
        else:
            self._start_from_rest(settings.z_start)
        self._changed = False
        self._plain = False
        self.refresh()

    def set(self, name: str, value: float) -> None:
        """Set an input or tunable parameter; it acts from the start of the next step."""
        if getattr(self.wanted, name) != value:
            self.wanted = self.wanted.changed(name, value)
            self._changed = True
            self._plain = False

    def advance(self, time: float, step: float) -> None:
        """Move on by one communication step.

        Parameters
        ----------
        time
            Time at the start of the step [s]; it dates `meter.t_event` and nothing else.
        step
            Length of the step [s], above zero and finite.

        Raises
        ------
        ModelError
            If the step is no such number or holds too many transitions, or if the values set
            since the last step are beyond their range together.
        """
        if self._plain and step > 0.0 and time - time == 0.0:
            elapsed = self._elapsed
            total = elapsed + step
            if total < self._duration:
                # The sum of `compensated.add`, written out: nearly every step ends here.
                shadow = total - elapsed
                low = self._elapsed_low + ((elapsed - (total - shadow)) + (step - shadow))
                self._elapsed = elapsed = total + low
                self._elapsed_low = low - (elapsed - total)
                self.stale = True
                return
        self._advance_through(time, step)

    def check(self) -> None:
        """Raise ModelError if the load that is set would lift the mass."""
        self.wanted.normal_force()

    def warning(self) -> Optional[str]:
        """Return that the kinetic coefficient that is set is clamped; None if it is not."""
        return clamp_warning(self.wanted.mu_s, self.wanted.mu_k)

    def date_start(self, time: float) -> None:
        """Let `meter.t_event` show that the simulation starts at `time` [s], if it has not yet."""
        if not self._started:
            self._part()
            self.meter.t_event = time

    def refresh(self) -> None:
        """Compute the motion where the block stands; raises ModelError where it is not finite."""
        arc = self._arc
        growth, x_dot, displacement = arc.state(self._elapsed)
        settings = self._settings
        self.z = z = arc.z_start + growth
        self.x_dot = x_dot
        start = self._x
        self.x = x = start.high + (start.low + displacement)
        self.x_pull = x_pull = x + z
        self.F = F = settings.k * z
        self.mode = mode = arc.mode
        if mode == 0:
            self.F_friction = 0.0 - (F + settings.F_ext)
        else:
            self.F_friction = -(mode * self._kinetic + settings.c * x_dot)
        self._displacement = displacement
        self.stale = False
        if not abs(x_pull + F) < math.inf:
            raise ModelError(_NOT_FINITE)

    @property
    def sticking(self) -> bool:
        """Whether the mass rests."""
        return self.mode == 0

    @property
    def W_pull(self) -> float:  # noqa: N802 - the symbol of the theory
        """Work done by the pulling end [J]: docs/theory.md (15)."""
        return _finite(self._W_pull.plus(self._arc.pull_work(self._elapsed)))

    @property
    def W_k(self) -> float:  # noqa: N802 - the symbol of the theory
        """Energy put in by changing k [J]: docs/theory.md (15)."""
        return _finite(self._W_k.high)

    @property
    def Q_friction(self) -> float:  # noqa: N802 - the symbol of the theory
        """Heat made by friction and damping [J], after `refresh`: docs/theory.md (15)."""
        heat = self._arc.heat(self._elapsed, self._displacement)
        return _finite(self._Q_friction.plus(heat))

    def freeze(self) -> Tuple[Any, ...]:
        """Return the whole state for `thaw`, of this block or another, quickly.

        It is not written to again: the block parts with what it has handed out before it
        changes it.
        """
        self._x.frozen = True
        frozen: Tuple[Any, ...] = _freeze(self)
        return frozen

    def thaw(self, frozen: Tuple[Any, ...]) -> None:
        """Take up a state that `freeze` returned, bit for bit."""
        for name, value in zip(_STATE, frozen):
            setattr(self, name, value)
        self.stale = True

    def save(self) -> Dict[str, Any]:
        """Return the whole state as plain numbers, lists and dictionaries, for `restore`."""
        return {
            "wanted": self.wanted.as_dict(),
            "settings": self._settings.as_dict(),
            "arc": list(self._origin),
            "elapsed": [self._elapsed, self._elapsed_low],
            "x": self._x.save(),
            "W_pull": self._W_pull.save(),
            "W_k": self._W_k.save(),
            "Q_friction": self._Q_friction.save(),
            "meter": self.meter.save(),
            "started": self._started,
            "changed": self._changed,
        }

    def restore(self, saved: Dict[str, Any]) -> None:
        """Take up a state that `save` returned, bit for bit; raises ModelError for another."""
        check_saved(saved, self.save())
        self.wanted = values(Settings, saved["settings"])
        self._adopt_settings()
        self.wanted = values(Settings, saved["wanted"])
        self._part()
        self._place(*saved["arc"])
        self._elapsed, self._elapsed_low = saved["elapsed"]
        self._x.restore(saved["x"])
        self._W_pull.restore(saved["W_pull"])
        self._W_k.restore(saved["W_k"])
        self._Q_friction.restore(saved["Q_friction"])
        self.meter.restore(saved["meter"])
        self._started = saved["started"]
        self._changed = saved["changed"]
        self._plain = self._started and not self._changed
        self.refresh()

    def _advance_through(self, time: float, step: float) -> None:
        """Move on by one step that may begin with other settings or hold transitions."""
        if not 0.0 < step < math.inf:
            raise ModelError(f"step size h = {step!r} s is out of range: above 0 and finite")
        if not math.isfinite(time):
            raise ModelError(f"communication point t = {time!r} s is out of range: a finite number")
        self._part()
        if self._changed:
            self._change_settings(time)
        if not self._started:
            self._started = True
            if self.mode != 0 and self._arc.x_dot_start == 0.0:
                self.meter.break_away(time)
        high, low = add(self._elapsed, self._elapsed_low, step)
        transitions = 0
        while high >= self._duration:
            left, left_low = add(high, low, -self._duration)
            # A stick ends when time passes its end, a slip when time reaches it: (1).
            if left < 0.0 or (left == 0.0 and self.mode == 0):
                break
            self._pass_event(time + (step - left))
            high, low = left, left_low
            transitions += 1
            if transitions % _TRANSITIONS_TO_ESTIMATE == 0:
                _check_pace(transitions, step, step - left)
        self._elapsed = high
        self._elapsed_low = low
        self._plain = True
        self.stale = True

    def _part(self) -> None:
        """Make sums and meter the block's own, where a frozen state holds them too.

        They are frozen together, so one tells of all.
        """
        if self._x.frozen:
            self._x = self._x.copy()
            self._W_pull = self._W_pull.copy()
            self._W_k = self._W_k.copy()
            self._Q_friction = self._Q_friction.copy()
            self.meter = self.meter.copy()

    def _pass_event(self, time: float) -> None:
        """Go through the end of the arc, at `time` [s], into the next one."""
        arc = self._arc
        if isinstance(arc, StickArc):
            self._bank(arc.duration, (arc.z_end - arc.z_start, 0.0, 0.0))
            self.z = z = arc.z_end
            self.meter.break_away(time)
            mode = 1 if arc.v > 0.0 else -1
            self._place(mode, z, 0.0, mode * self._gap)
            return
        self._bank(arc.duration, arc.end())
        self.meter.end_slip(time)
        z = self.z
        spring, external = self._settings.k * z, self._settings.F_ext
        if direction_from_rest(spring, external, self.F_s) == -arc.mode:
            self._slip_on(-arc.mode, z, 0.0)
        elif arc.mode * arc.v > 0.0:
            self._place(0, z, 0.0, arc.way_to_break_away(self._gap))
        else:
            self._place(0, z, 0.0, None)

    def _change_settings(self, time: float) -> None:
        """Start a new arc under the wanted settings, at `time` [s], where the block stands."""
        tau = self._elapsed
        arc = self._arc
        mode = arc.mode
        state = arc.state(tau)
        # A slip of no length has not begun, so the rest test decides anew whether it does.
        at_rest = mode == 0 or (tau == 0.0 and state[1] == 0.0)
        before = self._slip_terms()
        self._adopt_settings()
        self._changed = False
        if not at_rest and self._slip_terms() == before:
            # What changed is not in the equation of slip, so the arc stays whole.
            return
        self._bank(tau, state)
        z, x_dot = self.z, state[1]
        dk = self._settings.k - before[0]
        self._W_k.add(0.5 * (dk * z) * z)
        if not at_rest:
            self._slip_on(mode, z, x_dot)
            return
        self._start_from_rest(z)
        if self._started and mode == 0 and self.mode != 0:
            self.meter.break_away(time)

    def _slip_terms(self) -> Tuple[float, ...]:
        """Return what the equation of slip is made of, beside mass and direction: (3)."""
        settings = self._settings
        return settings.k, settings.c, settings.v, settings.F_ext, self._kinetic

    def _bank(self, tau: float, state: Tuple[float, float, float]) -> None:
        """Add what the arc gave up to `tau`, where its state is given, to the block's sums."""
        arc = self._arc
        growth, _, displacement = state
        self._x.add(displacement)
        self._W_pull.add(arc.pull_work(tau))
        if isinstance(arc, StickArc):
            self.meter.pass_stick(tau)
        else:
            self._Q_friction.add(arc.heat(tau, displacement))
            self.meter.pass_slip(tau, displacement, -growth, arc.extreme_velocity(tau))
        self.z = arc.z_start + growth

    def _adopt_settings(self) -> None:
        """Let the wanted settings act, and derive what depends on them alone."""
        settings = self.wanted
        normal = settings.normal_force()
        self.mu_k_used = kinetic_coefficient(settings.mu_s, settings.mu_k)
        self.F_s, self._kinetic, self._gap = friction_forces(settings.mu_s, self.mu_k_used, normal)
        _finite(self.F_s)
        self._oscillator = Oscillator(settings.k, settings.m, settings.c)
        self._settings = settings

    def _start_from_rest(self, z: float) -> None:
        """Start a stick at spring extension `z`, or the slip that it cannot hold."""
        settings = self._settings
        mode = direction_from_rest(settings.k * z, settings.F_ext, self.F_s)
        if mode == 0:
            self._place(0, z, 0.0, None)
        else:
            self._slip_on(mode, z, 0.0)

    def _slip_on(self, mode: int, z: float, x_dot: float) -> None:
        """Start a slip arc from any state."""
        settings = self._settings
        force = settings.k * z + settings.F_ext
        self._place(mode, z, x_dot, force - mode * self._kinetic)

    def _place(self, mode: int, z: float, x_dot: float, force: Optional[float]) -> None:
        """Stand at the start of the arc that these four and the settings determine.

        `force` is the net force of a slip, or of a stick the way to break-away where it is known.
        """
        settings = self._settings
        self._origin = [mode, z, x_dot, force]
        if mode == 0 or force is None:
            self._arc = StickArc(settings.k, settings.v, z, self.F_s, settings.F_ext, force)
        else:
            self._arc = SlipArc(self._oscillator, settings.v, z, x_dot, mode, force, self._kinetic)
        self.mode = mode
        self._duration = self._arc.duration
        self._elapsed = 0.0
        self._elapsed_low = 0.0


def _finite(value: float) -> float:
    """Return `value`; raises ModelError where it is none."""
    if not math.isfinite(value):
        raise ModelError(_NOT_FINITE)
    return value


def _check_pace(transitions: int, step: float, done: float) -> None:
    """Refuse a step of which `done` [s] already held so many transitions that it never ends."""
    if transitions > MOST_TRANSITIONS * (done / step):
        raise ModelError(
            f"step size h = {step!r} s is out of range: it holds more than "
            f"{MOST_TRANSITIONS} transitions between stick and slip; make it shorter"
        )
