"""An axis that follows a command, with friction that turns over by presliding: docs/reversal.md.

The loop is that of docs/feed-axis.md (1), (2) in continuous time: a delay of dead time and T_s
stands for what sampling does (half a T_s until a force acts on average, half a T_s from the
difference that is taken for the speed). Counts, the limit of the force and the dead band are left
out, as in `loop.system`. Positions and speeds in the state are deviations from the command, which
a force along the way only shifts.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import odeint

from stickslip_ref import STRIBECK
from stickslip_units import EXACT, told

from ..axis import Assumed, Axis, Drive, Filter
from ..one_thread import one_thread
from .stability import is_stable

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Over = Callable[[float], float]

ROLLING: Final = 25e-6
"""Presliding of a rolling way [m]: friction has turned over by 95 % after 3.7 times as much, and
balls roll freely after 100 um (Futami and others, Nanotechnology 1 (1990) 31)."""
SLIDING: Final = 2e-6
"""Presliding of a sliding way [m]: an estimate, as such ways yield by some um."""
_ROLLS: Final = 0.01
"""Kinetic coefficient up to which a way is taken to roll, as by the catalogue of measures."""
FALL: Final = 1e-3
"""Speed over which friction falls where two coefficients are all that is stated [m/s]."""
_LEAST: Final = 1e-3
"""Least dry friction, over the break-away force: the law divides by it."""
_RTOL, _ATOL = 1e-8, 1e-12
"""Error of a step, of a position in [m]. LSODA finds the kink of |x_dot| at a reversal by its step:
as good there, to 0.1 nm of 20 um, as stopped at it."""
_PER_SECOND, _PER_METRE = 1e2, 1e7
"""Error of a speed [1/s] and a force [N/m] over that of a position."""
_MOST: Final = 3_000_000
"""Most evaluations of a motion, half a minute."""


class Contact(NamedTuple):
    """Dry friction of a mass: Canudas de Wit and others, IEEE TAC 40 (1995) 419."""

    speed: int
    """Place of its speed in the state."""
    mass: float
    """[kg]."""
    slip: Over
    """Friction in slip [N] over the speed [m/s]."""
    kinetic: float
    """That of a fast slip [N]."""
    sigma_0: float
    """Stiffness of the presliding [N/m]."""
    sigma_1: float
    """Its damping at rest [N.s/m]: critical for the mass on sigma_0 alone."""
    v_d: float
    """Speed over which that falls [m/s], so that it adds a tenth of kinetic friction at most: in
    presliding friction follows the way, hardly the speed. The law is passive then."""

    def force(self, v: float, z: float) -> tuple[float, float]:
        """Return friction [N] and the rate of the bristles [m/s], from speed and bristles [m]."""
        z_dot = v - self.sigma_0 * abs(v) * z / self.slip(abs(v))
        return self.sigma_0 * z + self.sigma_1 * math.exp(-((v / self.v_d) ** 2)) * z_dot, z_dot


class Follower:
    """A table that follows its command; ValueError if its loop is unstable.

    Two coefficients without a speed fall over `v_s` [m/s].

    Attributes
    ----------
    rates
        Matrix of d state/dt without dry friction: a column for each place of the state, then those
        of speed [m/s] and acceleration [m/s2] of the command and of the force fed forward [N].
    table
        Place of the table's deviation from the command [m]; that of its speed follows.
    contacts
        The dry frictions.
    decay
        Rate of the slowest motion without dry friction [1/s].
    """

    def __init__(self, axis: Axis, v_s: float = FALL) -> None:
        self.rates, self.table = _rigid(axis) if axis.drive is None else _servo(axis, axis.drive)
        self.contacts = tuple(_contacts(axis, self.table + 1, v_s))
        self.size = len(self.rates)
        roots = np.linalg.eigvals(self.rates[:, : self.size])
        self.decay = -float(roots.real.max())
        # An undamped table on a rigid drive stands at the limit.
        if self.decay < -1e-9 * float(np.abs(roots).max()) or not is_stable(axis):
            raise ValueError(f"{axis.name}: its loop is unstable; stickslip design says more of it")

    def follow(
        self, speed: Over, acceleration: Over, knots: Sequence[float], at: Vector, forward: float
    ) -> Vector:
        """Return the table's deviation from the command [m] at some times [s].

        The command is that of `states`. It begins in even motion. A force of `forward` [N] is fed
        forward in its direction.
        """
        start = self.even(speed(knots[0]), forward)
        return self.states(start, speed, acceleration, knots, at, forward)[:, self.table]

    def even(self, v_c: float, forward: float = 0.0, held: bool = False) -> Vector:
        """Return the state in even motion at a speed of the command [m/s], a force fed forward [N].

        Or with the table `held` back: at rest, its contact at the break-away force, all else even.
        """
        y = np.zeros(self.size + len(self.contacts))
        even = self.rates[:, self.size] * v_c
        even += self.rates[:, self.size + 2] * math.copysign(forward, v_c)
        for place, contact in enumerate(self.contacts, self.size):
            at_rest = held and contact.speed == self.table + 1
            force = math.copysign(contact.slip(0.0 if at_rest else abs(v_c)), v_c)
            y[place] = force / contact.sigma_0
            even[contact.speed] -= force / contact.mass
        y[: self.size] = np.linalg.solve(self.rates[:, : self.size], -even)
        y[self.table + 1] -= v_c * held
        return y

    @one_thread
    def states(
        self,
        start: Vector,
        speed: Over,
        acceleration: Over,
        knots: Sequence[float],
        at: Vector,
        forward: float = 0.0,
    ) -> Matrix:
        """Return the states at some times [s]: a row for each, the bristles [m] behind the others.

        The command has a speed [m/s] and an acceleration [m/s2] over the time [s], smooth between
        its knots: start, turns and corners, end [s]. RuntimeError if it cannot be followed to its
        end.
        """
        size, inputs, left = self.size, np.zeros(self.size + 3), _MOST
        contacts = tuple(enumerate(self.contacts, size))

        def rates(t: float, y: Vector) -> Vector:
            nonlocal left
            if (left := left - 1) < 0:
                raise RuntimeError("the axis judders on and on: following it takes too long")
            v_c = speed(t)
            inputs[:size], inputs[size], inputs[size + 1] = y[:size], v_c, acceleration(t)
            result = np.empty(y.size)
            np.dot(self.rates, inputs, out=result[:size])
            for place, contact in contacts:
                force, result[place] = contact.force(float(y[contact.speed]) + v_c, float(y[place]))
                result[contact.speed] -= force / contact.mass
            return result

        y, scale = start, np.full(start.size, _ATOL)
        scale[1 : self.table + 2 : 2] *= _PER_SECOND
        scale[self.table + 2 : size] *= _PER_METRE
        # Backward differences of higher order swing by themselves where a servo hardly damps.
        orders, found = 2 if self.table else 5, []
        for begin, end in pairwise(knots):
            inputs[size + 2] = math.copysign(forward, speed(0.5 * (begin + end)))
            times = [begin, *at[(at > begin) & (at < end)], end]
            rows, how = odeint(
                rates,
                y,
                times,
                tfirst=True,
                full_output=True,
                rtol=_RTOL,
                atol=scale,
                tcrit=[end],
                mxstep=_MOST,
                mxords=orders,
            )
            if "success" not in how["message"]:
                raise RuntimeError(f"the motion of the axis cannot be followed: {how['message']}")
            y = rows[-1]
            found.append(rows[1:-1])
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


def _contacts(axis: Axis, speed: int, v_s: float) -> Iterator[Contact]:
    """Yield the dry friction of the table, whose speed has that place, and of the motor."""
    F_s, dry = axis.F_s, axis.drive.dry if axis.drive else 0.0
    for place, mass, slip, kinetic, stiffness in (
        (speed, axis.m, _slip(axis, v_s), max(axis.F_k, _LEAST * F_s), F_s / presliding(axis)),
        (1, axis.drive.inertia if axis.drive else 1.0, lambda _: dry, dry, dry / ROLLING),
    ):
        if kinetic > 0.0:
            sigma_1 = 2.0 * math.sqrt(stiffness * mass)
            v_d = 0.1 * math.sqrt(2.0 * math.e) * kinetic / sigma_1
            yield Contact(place, mass, slip, kinetic, stiffness, sigma_1, v_d)


def presliding(axis: Axis) -> float:
    """Return the presliding of a way [m], as stated or as usual for its kind."""
    return axis.friction.presliding or (ROLLING if axis.friction.mu_k <= _ROLLS else SLIDING)


def assumed(axis: Axis) -> Iterator[Assumed]:
    """Yield what is taken of the friction of a way that the axis does not state."""
    friction, kind = axis.friction, "rolling" if axis.friction.mu_k <= _ROLLS else "sliding"
    if axis.F_s > 0.0 and not friction.presliding:
        way = told(presliding(axis), "m", EXACT)
        yield Assumed("friction.presliding", way, f"an estimate for a {kind} way")
    if friction.law != "stribeck" and axis.F_s > axis.F_k:
        yield Assumed("friction.v_s", told(FALL, "m/s", EXACT), "two coefficients are stated")


def _slip(axis: Axis, v_s: float) -> Over:
    """Return friction in slip [N] over the speed [m/s]."""
    F_k, fall, least = axis.F_k, axis.F_s - axis.F_k, _LEAST * axis.F_s
    if axis.friction.law == "stribeck":
        p = STRIBECK.complete(axis.block(1.0), axis.friction.own)
        return lambda v: max(STRIBECK.slip_friction(p, v), least)
    return lambda v: max(F_k + fall * math.exp(-((v / v_s) ** 2)), least)
