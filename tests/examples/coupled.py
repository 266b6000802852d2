"""Drive and block coupled in this process, without FMUs, and the axes that are tried."""

import math
import random
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from examples.feed_axis.axis import Axis, critically_damped
from examples.feed_axis.designed import designed
from examples.feed_axis.monolithic import solve
from examples.feed_axis.servo_drive.model import ServoDrive
from examples.feed_axis.servo_drive.table import Settings
from stickslip_design.loop.stability import is_stable
from stickslip_fmu.block import Block
from tests.fmu.blocks import make_block

EXACT: dict[str, Any] = {"resolution_motor": 0.0, "resolution_table": 0.0}
"""Without encoder counts, whose rounding would hide how errors shrink."""
NOTCH = {"notch": 200.0, "notch_damping": 0.4, "notch_depth": 0.1}
LOW_PASS = {"low_pass": 500.0, "low_pass_damping": 0.7}
FILTERED: dict[str, Any] = {**NOTCH, **LOW_PASS, "lag": 3e-4, "dead_time": 4e-4}


def servo(values: Mapping[str, float]) -> ServoDrive:
    settings = Settings.at_start()
    for name, value in values.items():
        settings = settings.changed(name, value)
    return ServoDrive(settings)


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
    block, drive = make_block(**axis.of_table()), servo(axis.of_drive()).drive
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
    """Return a random stable axis: numbers up to three times those of the example, or a third."""
    generator = random.Random(seed)
    even, choice = generator.uniform, generator.choice
    while True:
        names = ("m", "k", "c", "mu_k", "pitch", "d", "T_s", "K_v", "omega_v", "T_n")
        changes: dict[str, Any] = {
            name: getattr(Axis(), name) * 3.0 ** even(-1.0, 1.0) for name in names
        }
        changes |= {"mu_s": changes["mu_k"] * (1.0 + even(0.08, 0.4)), "F_max": 1e9}
        changes |= {"J": changes["m"] * even(0.4, 5.0) * (changes["pitch"] / 2.0 / math.pi) ** 2}
        changes |= {"on_table": choice([False, True]), "lag": choice([0.0, even(1e-4, 1e-3)])}
        changes |= {"velocity_feedforward": choice([1.0, 0.9, 0.0])}
        changes |= {"dead_time": choice([0.0, 1.0, even(0.0, 2.5)]) * changes["T_s"]}
        changes |= choice([{}, {"low_pass": even(150.0, 1000.0)}, LOW_PASS])
        changes |= choice([{}, NOTCH, {**NOTCH, "notch": even(100.0, 600.0)}])
        # Its sample may be too long for its motion.
        with suppress(ValueError):
            axis = Axis(**changes, **EXACT)
            if is_stable(designed(axis)):
                return axis
