"""Drive and block coupled in this process, without FMUs, and the axes that are tried."""

import math
import random
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from examples.feed_axis.axis import Axis, critically_damped
from examples.feed_axis.designed import designed
from examples.feed_axis.monolithic import solve
from examples.feed_axis.servo_drive.controller import Controller, Gains
from examples.feed_axis.servo_drive.drive import Drive
from examples.feed_axis.servo_drive.setpoint import SetPoint
from stickslip_design.loop.stability import is_stable
from stickslip_fmu.block import Block
from stickslip_fmu.spec import SPEC, TABLE

EXACT: dict[str, Any] = {"resolution_motor": 0.0, "resolution_table": 0.0}
"""Without encoder counts, whose rounding would hide how errors shrink."""
NOTCH = {"notch": 200.0, "notch_damping": 0.4, "notch_depth": 0.1}
LOW_PASS = {"low_pass": 500.0, "low_pass_damping": 0.7}
FILTERED: dict[str, Any] = {**NOTCH, **LOW_PASS, "lag": 3e-4, "dead_time": 4e-4}


def make_block(**values: float) -> Block:
    block = SPEC.model(SPEC.values({**TABLE.start_values(), **values}))
    assert isinstance(block, Block)
    return block


def make_drive(axis: Axis) -> tuple[Drive, Controller]:
    values = axis.of_drive()
    gains = Gains(**{name: values[name] for name in Gains._fields})  # type: ignore[arg-type]
    controller = Controller(gains, SetPoint(axis.feed, axis.acceleration, axis.distance))
    way = axis.lag, axis.dead_time, axis.dry
    return Drive(axis.m_d, axis.d, values["k"], axis.T_s, controller, *way), controller


@dataclass
class Motion:
    """Times [s] and positions of the table [m] at communication points; the block."""

    block: Block
    time: list[float] = field(default_factory=lambda: [0.0])
    x: list[float] = field(default_factory=lambda: [0.0])

    def off(self, truth: Any, axis: Axis) -> float:
        """Return the largest error of the table's position [m] at the samples of the truth."""
        where = np.searchsorted(self.time, np.array(truth.time) - 1e-9)
        return float(np.max(np.abs(np.array(self.x)[where] - truth.column("x", axis))))


def couple(axis: Axis, steps: Iterable[float]) -> Motion:
    """Step drive and block side by side, each with what the other gave at the step's start."""
    block, (drive, _) = make_block(**axis.of_table()), make_drive(axis)
    motion = Motion(block)
    block.refresh()
    for h in steps:
        v, F, x = drive.output, float(block.F), float(block.x)
        block.set("v", v)
        block.advance(motion.time[-1], h)
        drive.advance(h, F, x)
        block.refresh()
        motion.time.append(motion.time[-1] + h)
        motion.x.append(float(block.x))
    return motion


def velocity_loop(omega_v: float) -> dict[str, Any]:
    """Return the changes that make a velocity loop of this bandwidth [rad/s]."""
    return {"omega_v": omega_v, "T_n": critically_damped(omega_v)}


def last_jump(axis: Axis, limit: float, duration: float, share: float) -> float:
    """Return the feed [m/s] at the last jump of the whole loop solved as one.

    The feed rises for a duration [s] from 1 - share to 1 + share of the limit [m/s]. Up to there it
    comes from a tenth of the limit, since from rest a higher feed may be reached without a jump.
    """
    low, high, slow = (1.0 - share) * limit, (1.0 + share) * limit, 0.1 * limit
    # The spring is loaded, and the table jumps twice.
    began = 3.0 * axis.F_s / (axis.k * slow)
    reached = began + 0.4 * duration
    course = [(0.0, 0.0), (0.1, slow), (began, slow), (reached, low), (reached + duration, high)]
    last, _ = solve(axis, course[-1][0], course).jumps[-1]
    return float(np.interp(last, *np.array(course).T))


def random_axis(seed: int) -> Axis:
    """Return a random stable axis, of numbers that are usual for machine tools."""
    generator = random.Random(seed)
    even, choice = generator.uniform, generator.choice

    def over(low: float, high: float) -> float:
        return math.exp(even(math.log(low), math.log(high)))

    while True:
        m, w, pitch = over(100.0, 3000.0), 2.0 * math.pi * over(25.0, 120.0), even(0.005, 0.02)
        m_d, omega_v, mu_k = m * over(0.4, 5.0), over(120.0, 700.0), even(0.05, 0.2)
        T_s: float = choice([62.5e-6, 125e-6, 250e-6, 500e-6, 1e-3])
        values: dict[str, Any] = {"m": m, "k": m * w * w, "c": 2.0 * over(0.003, 0.06) * m * w}
        values |= {"mu_s": mu_k * (1.0 + even(0.08, 0.4)), "mu_k": mu_k, "F_max": 1e9}
        values |= {"J": m_d / (2.0 * math.pi / pitch) ** 2, "pitch": pitch}
        values |= {"d": m_d * even(0.0, 5.0), "T_s": T_s, "K_v": over(12.0, 60.0)}
        values |= {"omega_v": omega_v, "T_n": critically_damped(omega_v) * over(0.6, 2.5)}
        values |= {"on_table": choice([False, True]), "lag": choice([0.0, even(1e-4, 1e-3)])}
        values |= {"velocity_feedforward": choice([1.0, 1.0, 0.9, 0.0])}
        values |= {"dead_time": choice([0.0, T_s, even(0.0, 2.5) * T_s])}
        if choice([False, True]):
            values |= {"low_pass": min(over(150.0, 2000.0), 0.3 / T_s)}
            values |= {"low_pass_damping": choice([0.0, 0.7, 0.9])}
        if choice([False, True]):
            values |= {"notch": min(over(100.0, 800.0), 0.3 / T_s)}
            values |= {"notch_damping": even(0.2, 0.8), "notch_depth": even(0.0, 0.4)}
        # Its sample may be too long for its motion.
        with suppress(ValueError):
            axis = Axis(**values, **EXACT)
            if is_stable(designed(axis)):
                return axis
