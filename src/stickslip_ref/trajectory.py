"""What a simulation gives: samples, events and measured cycles. Data only."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

EventKind = Literal["break-away", "re-stick", "reversal"]

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True)
class Event:
    """A transition; docs/theory.md (1).

    Attributes
    ----------
    time : float
        When it happened [s].
    kind : str
        ``"break-away"`` (stick to slip), ``"re-stick"`` (slip to stick) or ``"reversal"`` (slip to
        slip the other way).
    mode : int
        The mode from then on: -1 slips backward, 0 sticks, +1 slips forward.
    x, z : float
        Position of the mass and extension of the spring [m].
    """

    time: float
    kind: EventKind
    mode: int
    x: float
    z: float


@dataclass(frozen=True)
class MeasuredCycle:
    """What the meter read at a break-away that completed a cycle; docs/theory.md (16).

    Attributes
    ----------
    t_break_away : float
        Time of the break-away that began the cycle [s].
    t_stick, t_slip : float
        Length of its stick, and of its last slip [s].
    T : float
        Time between the two break-aways [s].
    delta_x, spring_drop : float
        Displacement of the mass and fall of z over its last slip [m], signed.
    x_dot_peak : float
        Extreme velocity of its last slip [m/s], signed.
    """

    t_break_away: float
    t_stick: float
    t_slip: float
    T: float
    delta_x: float
    spring_drop: float
    x_dot_peak: float


@dataclass(frozen=True)
class Trajectory:
    """A simulated motion; all arrays have one entry per sample.

    A sample at the time of an event shows the state after it; one at the time of a change of
    input shows what was before the change, as the output of a block does at the end of a step.

    Attributes
    ----------
    t : array
        Time [s], not decreasing.
    x, x_dot, x_pull, z : array
        Position [m] and velocity [m/s] of the mass, position of the pulled end, spring extension
        [m]; docs/theory.md (1).
    F, F_friction, F_s : array
        Spring force, friction on the mass (viscous part included) and break-away force [N].
    mode : array of int
        -1 slips backward, 0 sticks, +1 slips forward.
    mu_k_used : array
        Kinetic friction coefficient after the clamp [-].
    W_pull, W_k, W_ext, Q_friction : array
        Work of the pulled end, energy put in by changes of k, work of F_ext, heat of friction and
        damping, since the start [J]; docs/theory.md (15).
    delta_x, spring_drop, x_dot_peak : array
        Displacement of the mass [m], fall of z [m], extreme velocity [m/s] of the last completed
        slip, signed; docs/theory.md (16).
    t_stick, t_slip : array
        Length of the last completed stick and slip [s].
    T, f : array
        Time between the last two break-aways [s], and its inverse [Hz]; 0 until the second.
    n_slips : array of int
        Completed slips.
    t_event : array
        Time of the last transition [s]; the start time until the first.
    events : tuple of Event
        All transitions, in order.
    cycles : tuple of MeasuredCycle
        All completed cycles, in order.
    own : mapping of str to array
        The friction law's own outputs by name: zeta [m] and E_bristles [J] of LuGre, theta [s] and
        mu [-] of rate and state.

    Without a stick (LuGre, rate and state) a maximum of the spring is the break-away, a minimum the
    re-stick; the mode is 0 below v_stick.
    """

    t: Floats
    x: Floats
    x_dot: Floats
    x_pull: Floats
    z: Floats
    F: Floats
    F_friction: Floats
    F_s: Floats
    mode: Integers
    mu_k_used: Floats
    W_pull: Floats
    W_k: Floats
    W_ext: Floats
    Q_friction: Floats
    delta_x: Floats
    spring_drop: Floats
    x_dot_peak: Floats
    t_stick: Floats
    t_slip: Floats
    T: Floats
    f: Floats
    n_slips: Integers
    t_event: Floats
    events: tuple[Event, ...]
    cycles: tuple[MeasuredCycle, ...]
    own: Mapping[str, Floats] = field(default_factory=dict)

    @property
    def sticking(self) -> NDArray[np.bool_]:
        """Whether the mass sticks, at each sample."""
        return np.equal(self.mode, 0)
