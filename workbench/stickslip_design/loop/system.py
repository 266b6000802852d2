"""A servo axis as a linear system from sample to sample: drive, spring, table and controller.

docs/feed-axis.md (1), (2). Between the samples the motor's force is held, and in a given `Mode` of
friction everything is linear, so the motion over a part of a sample is a matrix. Friction in slip
is straight lines over the speed, from knot to knot. Encoder counts, the limit of the force and the
dead band are left out.
"""

from __future__ import annotations

import math
from collections import deque
from functools import cache, cached_property
from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from stickslip_ref import STRIBECK, Parameters, Shape

from ..axis import Axis

_LINES: Final = 24
"""Lines of a smooth fall: within 0.2 % of its drop."""
_LOOKS: Final = 4000
_SLOWEST, _FASTEST = 1e-3, 1e3
"""Speeds at which a smooth fall is looked at, over v_s."""


class Line(NamedTuple):
    """Dry friction from one speed to the next."""

    low: float
    high: float
    """The speeds [m/s]; the last line goes to infinity."""
    force: float
    """Friction at the lower speed [N]."""
    slope: float
    """How it rises with the speed [N.s/m]."""


def _law(axis: Axis) -> Parameters:
    """Return the parameters of the Stribeck friction of an axis."""
    return STRIBECK.complete(axis.block(1.0), axis.friction.own)


def _lines_of(axis: Axis) -> tuple[Line, ...]:
    """Return the dry friction of the guideway in slip, without its viscous part.

    One line for constant coefficients; those between the points of a measured curve; of a smooth
    fall lines whose distance from it is alike everywhere.
    """
    friction = axis.friction
    if friction.law != "stribeck" or (friction.mu_s == friction.mu_k and not friction.is_curve):
        return (Line(0.0, math.inf, axis.F_k, 0.0),)
    p = _law(axis)
    if p.own["shape"] == Shape.CURVE:
        speeds = np.array([0.0, *STRIBECK.knots(p)])
    else:
        v_s = p.own["v_s"]
        looks = np.concatenate([[0.0], np.geomspace(_SLOWEST * v_s, _FASTEST * v_s, _LOOKS)])
        force = STRIBECK.friction_at(p, looks)
        slope = np.diff(force) / np.diff(looks)
        # The bend of each place, so that lines are short where the friction bends.
        bend = np.sqrt(np.abs(np.diff(slope)) * 0.5 * (looks[2:] - looks[:-2]))
        share = np.concatenate([[0.0, 0.0], np.cumsum(bend)])
        speeds = np.interp(np.linspace(0.0, share[-1], _LINES + 1), share, looks[: share.size])
        speeds[0] = 0.0
    forces = STRIBECK.friction_at(p, speeds)
    knots = zip(speeds.tolist(), forces.tolist(), strict=True)
    lines = [
        Line(low, high, force, (following - force) / (high - low))
        for (low, force), (high, following) in pairwise(knots)
    ]
    return (*lines, Line(float(speeds[-1]), math.inf, float(forces[-1]), 0.0))


def line_at(axis: Axis, feed: float) -> Line:
    """Return the dry friction of the guideway about a feed [m/s]: the line that touches it."""
    friction = axis.friction
    if friction.law != "stribeck" or friction.is_curve:
        system = system_of(axis)
        return system.lines[system.line(feed)]
    p = _law(axis)
    return Line(feed, math.inf, STRIBECK.slip_friction(p, feed), STRIBECK.slope(p, feed))


Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

MOTOR, MOTOR_SPEED, TABLE, SPEED, FORCE, INTEGRAL, LAST = range(7)
"""Places in the state: position and speed of motor and table, the force that the motor has behind
the lag of its current loop, the integral, and the motor's position at the last sample. The
commanded forces that wait, the memory of the filters, the set point, what is left of each part by
which static friction grows since the table stopped, and the number 1 follow."""

_FINEST: Final = 0.1
"""Longest part of a sample, times the quickest rate of the motion: a cubic through values and
slopes at its ends is then within 3e-7 of a swing's amplitude."""
_NONE: Final = 1e-9
"""A part of a sample this short is none, relative to the sample."""
_OF_LOGARITHM: Final = 10.0 ** np.arange(1.0, -11.5, -0.5)
"""Rates of the exponentials that stand for ln(1 + t/t_0), times t_0. By the rule of trapezoids over
ln s in ln(1 + t) = integral of (1 - exp(-s t)) exp(-s) ds/s: within 1e-3 of it up to 1e8 t_0."""


class Mode(NamedTuple):
    """The directions in which table and motor move, 0 at rest, and the line of the friction.

    Without dry friction of the motor its direction stays 1. The line counts in slip alone.
    """

    table: int
    motor: int
    line: int = 0


class Part(NamedTuple):
    """A part of a sample over which one commanded force holds: its length [s], and which one."""

    length: float
    late: int


class Layout(NamedTuple):
    """Where in the state what follows the fixed places begins."""

    commands: int
    filters: int
    command: int
    feed: int
    acceleration: int
    ungrown: slice
    one: int

    @property
    def size(self) -> int:
        """The length of the state."""
        return self.one + 1


class System:
    """The linear systems of a servo axis; ValueError if it has no drive.

    A smooth fall of its friction is taken as straight lines.

    Attributes
    ----------
    axis, drive
        What it is of.
    layout
        Where things are in the state.
    parts
        The parts of a sample.
    offsets
        When each part begins and the last one ends, since the sample [s].
    control
        What the controller makes of the state at a sample.
    rates, steps
        The matrix of d state/dt in a mode under the `late`-th last commanded force; and what each
        part of a sample makes of the state in a mode.
    growth
        Rates [1/s] and forces [N] of the parts by which static friction grows while the table
        rests: each lacks its force times exp(-rate t).
    fully
        What static friction grows to [N].
    """

    def __init__(self, axis: Axis, lines: tuple[Line, ...] | None = None) -> None:
        if axis.drive is None:
            raise ValueError("an axis on a rigid drive has no loop")
        self.axis, self.drive, self._lines = axis, axis.drive, lines
        # The dead time in whole samples, and the rest [s].
        whole = math.floor(self.drive.dead_time / self.drive.T_s + _NONE)
        rest = self.drive.dead_time - whole * self.drive.T_s
        rest = rest if rest > _NONE * self.drive.T_s else 0.0
        waiting = whole + (2 if rest > 0.0 else 1)
        filters = LAST + 1 + waiting
        command = filters + 2 * len(self.drive.filters)
        self.growth = _growth(axis)
        fresh = axis.F_k if axis.friction.tau_s > 0.0 else axis.F_s
        self.fully = fresh + float(self.growth[1].sum())
        grown = command + 3 + len(self.growth[0])
        self.layout = Layout(
            LAST + 1, filters, command, command + 1, command + 2, slice(command + 3, grown), grown
        )
        self.parts = self._parts(whole, rest)
        self.offsets = np.concatenate(([0.0], np.cumsum([part.length for part in self.parts])))
        self.offsets[-1] = self.drive.T_s
        self.control = self._controller()
        self.rates, self.steps = cache(self._rates), cache(self._steps)

    def at_rest(self) -> Vector:
        """Return the state at rest: all 0 but the number 1, static friction not yet grown."""
        state = np.zeros(self.layout.size)
        state[self.layout.ungrown] = state[self.layout.one] = 1.0
        return state

    def held(self, age: float) -> float:
        """Return the most that friction holds after a time at rest [N]."""
        rates, forces = self.growth
        return self.fully - float(forces @ np.exp(-rates * age))

    def holding(self, force: float, feed: float, stretch: float = 0.0) -> Vector:
        """Return the state in which the motor moves evenly at a feed [m/s] against a force [N].

        At a sample; the table is at 0, and the motor ahead by the stretch of the spring [m].
        """
        drive, layout = self.drive, self.layout
        state = self.at_rest()
        motor = force + drive.d * feed + math.copysign(drive.dry, feed)
        state[MOTOR_SPEED] = state[layout.feed] = feed
        state[FORCE] = motor if drive.lag > 0.0 else 0.0
        state[INTEGRAL] = motor - drive.friction_feedforward
        state[layout.commands : layout.filters] = motor
        for number, of_force in enumerate(drive.filters):
            b0, _, b2, _, a2 = of_force.coefficients(drive.T_s)
            state[layout.filters + 2 * number] = (1.0 - b0) * motor
            state[layout.filters + 2 * number + 1] = (b2 - a2) * motor
        state[MOTOR], state[LAST] = stretch, stretch - feed * drive.T_s
        state[layout.command] = (1.0 - drive.velocity_feedforward) * feed / drive.K_v
        if not drive.on_table:
            state[layout.command] += stretch
        return state

    @cached_property
    def lines(self) -> tuple[Line, ...]:
        """The friction of the table in slip."""
        return self._lines or _lines_of(self.axis)

    def line(self, speed: float) -> int:
        """Return which line the friction of the table is at a speed [m/s]."""
        return next(number for number, line in enumerate(self.lines) if speed <= line.high)

    @property
    def sliding(self) -> Mode:
        """The mode in which the table slides fast: friction no longer falls."""
        return Mode(1, 1, len(self.lines) - 1)

    @property
    def moving(self) -> slice:
        """The places of the state that the motion changes: all but set point and the number 1."""
        return slice(0, self.layout.command)

    def _parts(self, whole: int, rest: float) -> tuple[Part, ...]:
        axis, drive = self.axis, self.drive
        rate = math.sqrt(axis.k / drive.inertia + axis.k / axis.m)
        rate += drive.d / drive.inertia + axis.c / axis.m
        parts: list[Part] = []
        for length, late in ((rest, whole + 1), (drive.T_s - rest, whole)):
            # Without a rest that part is none.
            count = math.ceil(length * rate / _FINEST)
            parts += [Part(length / count, late) for _ in range(count)]
        return tuple(parts)

    def _steps(self, mode: Mode) -> list[Matrix]:
        return [expm(self.rates(mode, part.late) * part.length) for part in self.parts]

    def _rates(self, mode: Mode, late: int) -> Matrix:
        axis, drive, layout = self.axis, self.drive, self.layout
        rates = np.zeros((layout.size, layout.size))
        rates[layout.command, layout.feed] = 1.0
        rates[layout.feed, layout.acceleration] = 1.0
        np.fill_diagonal(rates[layout.ungrown, layout.ungrown], -self.growth[0])
        command = layout.commands + late
        if drive.lag > 0.0:
            rates[FORCE, [FORCE, command]] = -1.0 / drive.lag, 1.0 / drive.lag
        if mode.motor:
            rates[MOTOR, MOTOR_SPEED] = 1.0
            force = rates[MOTOR_SPEED]
            force[FORCE if drive.lag > 0.0 else command] = 1.0
            force[[MOTOR, TABLE]] = -axis.k, axis.k
            force[MOTOR_SPEED] = -drive.d
            force[layout.one] = -mode.motor * drive.dry
            force /= drive.inertia
        if mode.table:
            rates[TABLE, SPEED] = 1.0
            force = rates[SPEED]
            force[[MOTOR, TABLE]] = axis.k, -axis.k
            line = self.lines[mode.line]
            force[SPEED] = -axis.c - line.slope
            force[layout.one] = axis.along - mode.table * (line.force - line.slope * line.low)
            force /= axis.m
        return rates

    def _controller(self) -> Matrix:
        drive, layout = self.drive, self.layout
        unit = np.eye(layout.size)
        error = unit[layout.command] - unit[TABLE if drive.on_table else MOTOR]
        speed = (unit[MOTOR] - unit[LAST]) / drive.T_s
        deviation = drive.K_v * error + drive.velocity_feedforward * unit[layout.feed] - speed
        grown = unit[INTEGRAL].copy()
        if drive.T_n > 0.0:
            grown += drive.K_p * drive.T_s / drive.T_n * deviation
        force = drive.K_p * deviation + grown
        # The feed of the study is forward throughout.
        force[layout.one] += drive.friction_feedforward
        control = unit.copy()
        control[INTEGRAL] = grown
        control[LAST] = unit[MOTOR]
        if drive.lag == 0.0:
            # The place is not in use.
            control[FORCE] = 0.0
        for number, of_force in enumerate(drive.filters):
            b0, b1, b2, a1, a2 = of_force.coefficients(drive.T_s)
            first = layout.filters + 2 * number
            out = b0 * force + unit[first]
            control[first] = b1 * force - a1 * out + unit[first + 1]
            control[first + 1] = b2 * force - a2 * out
            force = out
        control[layout.commands + 1 : layout.filters] = unit[layout.commands : layout.filters - 1]
        control[layout.commands] = force
        return control


_LAST_ONES: Final = deque[System](maxlen=8)


def system_of(axis: Axis) -> System:
    """Return the system of a servo axis, kept for the last axes; ValueError if it has no drive."""
    # By identity: its rounding depends on what was asked of it, and not of an axis like it.
    found = next((system for system in [*_LAST_ONES] if system.axis is axis), None)
    if found is None:
        _LAST_ONES.append(found := System(axis))
    return found


def _growth(axis: Axis) -> tuple[Vector, Vector]:
    """Return rates and forces by which static friction grows: docs/theory.md (26)."""
    friction = axis.friction
    rates, forces = np.empty(0), np.empty(0)
    if friction.B > 0.0:
        whole = friction.B * axis.normal_force * 0.5 * math.log(10.0)
        rates, forces = _OF_LOGARITHM / friction.own["t_0"], whole * np.exp(-_OF_LOGARITHM)
    if friction.tau_s > 0.0:
        rates = np.append(rates, 1.0 / friction.tau_s)
        forces = np.append(forces, axis.F_s - axis.F_k)
    return rates, forces
