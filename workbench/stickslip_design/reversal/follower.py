"""An axis that follows a command, with friction that turns over by presliding: docs/reversal.md.

The loop is that of docs/feed-axis.md (1), (2) in continuous time: a delay of dead time and T_s
stands for what sampling does (half a T_s until a force acts on average, half a T_s from the
difference that is taken for the speed). Counts, the limit of the force and the dead band are left
out, as in `loop.system`. Positions and speeds in the state are deviations from the command, which
a force along the way only shifts.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import ODEintWarning, odeint

from stickslip_ref import STRIBECK
from stickslip_units import EXACT, told

from ..axis import Assumed, Axis, Drive, Filter
from ..loop.stability import is_stable
from ..one_thread import one_thread

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

ROLLING: Final = 25e-6
"""Presliding of a rolling way [m]: friction has turned over by 95 % after 3.7 times as much, and
balls roll freely after 100 um (Futami and others, Nanotechnology 1 (1990) 31)."""
SLIDING: Final = 2e-6
"""Presliding of a sliding way [m]: an estimate, as such ways yield by some um."""
_ROLLS: Final = 0.01
"""Kinetic coefficient up to which a way is taken to roll, as by the catalogue of measures."""
_V_S: Final = 1e-3
"""Speed over which friction falls where two coefficients are all that is stated [m/s]."""
_BY_DAMPING: Final = 0.1
"""The most that sigma_1 times the speed comes to, over kinetic friction: in presliding friction
follows the way, hardly the speed."""
_LEAST: Final = 1e-3
"""Least dry friction, over the break-away force: the law divides by it."""
_RTOL: Final = 1e-8
_ATOL: Final = 1e-12
"""Error of a position in a step [m]. LSODA finds the kink of |x_dot| at a reversal by its step: as
good there, to 0.1 nm of 20 um, as stopped at it."""
_PER_SECOND: Final = 1e2
_PER_METRE: Final = 1e7
"""Error of a speed [1/s] and a force [N/m] over that of a position."""
_MOST_STEPS: Final = 1_000_000
_UNDERFLOW: Final = 700.0
_ROUNDING: Final = 1e-9

SPEED, ACCELERATION, FORWARD = range(3)
"""What drives the motion: speed [m/s] and acceleration [m/s2] of the command, force that is fed
forward [N]. Their columns follow those of the state."""


class Contact(NamedTuple):
    """Dry friction of a mass: Canudas de Wit and others, IEEE TAC 40 (1995) 419."""

    speed: int
    """Place of its speed in the state."""
    mass: float
    """[kg]."""
    slip: Callable[[float], float]
    """Friction in slip [N] over the speed [m/s]."""
    kinetic: float
    """That of a fast slip [N]."""
    sigma_0: float
    """Stiffness of the presliding [N/m]."""

    @property
    def sigma_1(self) -> float:
        """Damping of the presliding at rest [N.s/m]: critical for the mass on sigma_0 alone."""
        return 2.0 * math.sqrt(self.sigma_0 * self.mass)

    @property
    def v_d(self) -> float:
        """Speed over which that falls as exp(-(u/v_d)^2) [m/s]; the law is passive then."""
        return _BY_DAMPING * math.sqrt(2.0 * math.e) * self.kinetic / self.sigma_1

    def damping(self, v: float) -> float:
        """Return the damping of the presliding [N.s/m] at a speed [m/s]."""
        return self.sigma_1 * math.exp(-min((v / self.v_d) ** 2, _UNDERFLOW))


class Command(NamedTuple):
    """A motion of the set point that is smooth between its knots."""

    speed: Callable[[float], float]
    """[m/s] over the time [s]."""
    acceleration: Callable[[float], float]
    """[m/s2] over the time [s]."""
    knots: Sequence[float]
    """Start, the times at which it turns back or has a corner, and end [s]."""


class Follower:
    """A table that follows its command; ValueError if its loop is unstable.

    Attributes
    ----------
    rates
        Matrix of d state/dt without dry friction: a column for each place of the state, then one
        for each of `SPEED`, `ACCELERATION`, `FORWARD`.
    table
        Place of the table's deviation from the command [m]; that of its speed follows.
    contacts
        The dry frictions.
    decay
        Rate of the slowest motion without dry friction [1/s].
    """

    def __init__(self, axis: Axis) -> None:
        self.rates, self.table = _rigid(axis) if axis.drive is None else _servo(axis, axis.drive)
        self.contacts = tuple(_contacts(axis, self.table + 1))
        self.size = len(self.rates)
        roots = np.linalg.eigvals(self.rates[:, : self.size])
        self.decay = -float(roots.real.max())
        # An undamped table on a rigid drive stands at the limit.
        if self.decay < -_ROUNDING * float(np.abs(roots).max()) or not is_stable(axis):
            raise ValueError(f"{axis.name}: its loop is unstable; stickslip design says more of it")

    def moving(self, speed: float, forward: float = 0.0) -> Vector:
        """Return the state in even motion at a speed [m/s], a force [N] fed forward."""
        drive: Vector = self.rates[:, self.size] * speed + self.rates[:, self.size + 2] * forward
        for contact in self.contacts:
            drive[contact.speed] -= math.copysign(contact.slip(abs(speed)), speed) / contact.mass
        return np.asarray(np.linalg.solve(self.rates[:, : self.size], -drive), np.float64)

    @one_thread
    def follow(self, command: Command, state: Vector, at: Vector, forward: float = 0.0) -> Vector:
        """Return the table's deviation from the command [m] at some times between its knots [s].

        `state` is that at the first knot, in even motion; a force of `forward` [N] is fed forward
        in the direction of the command. RuntimeError if the solver fails.
        """
        size, contacts, inputs = self.size, self.contacts, np.zeros(self.size + 3)
        speeds = [float(state[each.speed]) + command.speed(command.knots[0]) for each in contacts]
        bent = [
            math.copysign(each.slip(abs(speed)) / each.sigma_0, speed)
            for each, speed in zip(contacts, speeds, strict=True)
        ]

        def rates(t: float, y: Vector) -> Vector:
            v_c = command.speed(t)
            inputs[:size], inputs[size], inputs[size + 1] = y[:size], v_c, command.acceleration(t)
            result = np.empty(y.size)
            np.dot(self.rates, inputs, out=result[:size])
            for place, contact in enumerate(contacts, size):
                v, z = float(y[contact.speed]) + v_c, float(y[place])
                z_dot = v - contact.sigma_0 * abs(v) * z / contact.slip(abs(v))
                force = contact.sigma_0 * z + contact.damping(v) * z_dot
                result[contact.speed] -= force / contact.mass
                result[place] = z_dot
            return result

        y = np.array([*state, *bent])
        scale = np.full(y.size, _ATOL)
        scale[1 : self.table + 2 : 2] *= _PER_SECOND
        scale[self.table + 2 : size] *= _PER_METRE
        found = []
        for begin, end in pairwise(command.knots):
            inputs[size + 2] = math.copysign(forward, command.speed(0.5 * (begin + end)))
            times = [begin, *at[(at >= begin) & (at < end)], end]
            with warnings.catch_warnings():
                warnings.simplefilter("error", ODEintWarning)
                try:
                    rows = odeint(
                        rates, y, times, tfirst=True, rtol=_RTOL, atol=scale, tcrit=[end],
                        mxstep=_MOST_STEPS,
                    )  # fmt: skip
                except ODEintWarning:
                    raise RuntimeError("the motion of the axis cannot be followed") from None
            y = rows[-1]
            found.append(rows[1:-1, self.table])
        return np.concatenate(found)


def _rigid(axis: Axis) -> tuple[Matrix, int]:
    """Return the rates of a table whose spring is pulled by the command itself."""
    e, w, r_dot, r_ddot, _ = np.eye(5)
    return np.array([w, (-axis.k * e - axis.c * (w + r_dot)) / axis.m - r_ddot]), 0


def _servo(axis: Axis, drive: Drive) -> tuple[Matrix, int]:
    """Return the rates of motor, table, integral and what is between command and force."""
    delay = drive.dead_time + drive.T_s
    # Pade's all-pass of second order is a notch that leaves -1.
    passes = Filter("notch", math.sqrt(12.0) / (2.0 * math.pi * delay), math.sqrt(0.75), -1.0)
    chain = [*drive.filters, passes]
    if drive.lag > 0.0:
        chain.append(Filter("low pass", 1.0 / (2.0 * math.pi * drive.lag)))
    at = 5 if drive.T_n > 0.0 else 4
    size = at + sum(1 if math.isinf(each.damping) else 2 for each in chain)
    unit = np.eye(size + 3)
    e_m, w_m, e, w = unit[:4]
    r_dot, r_ddot, forward = unit[size:]
    rates = np.zeros((size, size + 3))
    wanted = (drive.velocity_feedforward - 1.0) * r_dot - w_m
    wanted -= drive.K_v * (e if drive.on_table else e_m)
    force = drive.K_p * wanted + forward
    if drive.T_n > 0.0:
        rates[4] = drive.K_p / drive.T_n * wanted
        force += unit[4]
    for each in chain:
        corner = 2.0 * math.pi * each.frequency
        if math.isinf(each.damping):
            rates[at] = corner * (force - unit[at])
            force, at = unit[at], at + 1
            continue
        x, x_dot = unit[at : at + 2]
        rates[at] = corner * x_dot
        rates[at + 1] = corner * (force - x - 2.0 * each.damping * x_dot)
        through = force - 2.0 * each.damping * (1.0 - each.depth) * x_dot
        force, at = x if each.kind == "low pass" else through, at + 2
    spring = axis.k * (e_m - e)
    rates[0], rates[2] = w_m, w
    rates[1] = (force - spring - drive.d * (w_m + r_dot)) / drive.inertia - r_ddot
    rates[3] = (spring - axis.c * (w + r_dot)) / axis.m - r_ddot
    return rates, 2


def _contacts(axis: Axis, speed: int) -> Iterator[Contact]:
    """Yield the dry friction of table, whose speed has that place, and motor."""
    if axis.F_s > 0.0:
        stiffness = axis.F_s / presliding(axis)
        yield Contact(speed, axis.m, _slip(axis), max(axis.F_k, _LEAST * axis.F_s), stiffness)
    if axis.drive is not None and axis.drive.dry > 0.0:
        dry = axis.drive.dry
        yield Contact(1, axis.drive.inertia, lambda _: dry, dry, dry / ROLLING)


def presliding(axis: Axis) -> float:
    """Return the presliding of a way [m], as stated or as usual for its kind."""
    return axis.friction.presliding or (ROLLING if axis.friction.mu_k <= _ROLLS else SLIDING)


def assumed(axis: Axis) -> Iterator[Assumed]:
    """Yield what is taken of friction at a reversal that the axis does not state."""
    friction = axis.friction
    if axis.F_s > 0.0 and not friction.presliding:
        kind = "rolling way, mu_k up to" if friction.mu_k <= _ROLLS else "sliding way, mu_k above"
        reason = f"an estimate for a {kind} {_ROLLS:g}"
        yield Assumed("friction.presliding", told(presliding(axis), "m", EXACT), reason)
    if axis.drive is not None and axis.drive.dry > 0.0:
        reason = "an estimate: nut and bearings roll"
        yield Assumed("presliding of the motor", told(ROLLING, "m", EXACT), reason)
    if friction.law != "stribeck" and axis.F_s > axis.F_k:
        reason = "two coefficients are stated"
        yield Assumed("friction.v_s", told(_V_S, "m/s", EXACT), reason)
    if friction.tau_s or friction.B:
        yield Assumed("friction.mu_s", "at once", "presliding leaves no rest in which it grows")


def _slip(axis: Axis) -> Callable[[float], float]:
    """Return friction in slip [N] over the speed [m/s]."""
    F_k, least = axis.F_k, _LEAST * axis.F_s
    fall = axis.F_s - F_k
    if axis.friction.law == "stribeck":
        p = STRIBECK.complete(axis.block(1.0), axis.friction.own)
        return lambda v: max(STRIBECK.slip_friction(p, v), least)
    if fall == 0.0:
        return lambda v: F_k
    return lambda v: max(F_k + fall * math.exp(-min((v / _V_S) ** 2, _UNDERFLOW)), least)
