"""Drive and block coupled in this process, without FMUs, and the axes that are tried."""

import math
import random
import tempfile
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from examples.feed_axis.masters import NAMES, run_in_fmpy
from examples.feed_axis.whole_loop import solve
from fmi.model import ModelError
from fmi.system import Values
from stickslip.systems import write_system
from stickslip_design.loop.stability import is_stable
from stickslip_drive.model import ServoDrive
from stickslip_drive.table import Settings
from stickslip_fmu.block import Block
from tests.fmu.blocks import make_block

from .axes import Axis, critically_damped

EXACT: dict[str, Any] = {"resolution_motor": 0.0, "resolution_table": 0.0}
"""Without encoder counts, whose rounding would hide how errors shrink."""
NOTCH = {"notch": 200.0, "notch_damping": 0.4, "notch_depth": 0.1}
LOW_PASS = {"low_pass": 500.0, "low_pass_damping": 0.7}
FILTERED: dict[str, Any] = {**NOTCH, **LOW_PASS, "lag": 3e-4, "dead_time": 4e-4}


def simulate(fmus: Path, values: Values, stop: float) -> dict[str, NDArray[np.float64]]:
    with tempfile.TemporaryDirectory() as folder:
        file = write_system("drive", Path(folder) / "FeedAxis.ssp", values, fmus / "StickSlip.fmu")
        rows = np.array(run_in_fmpy(file, stop, values["drive"]["T_s"]))
    return dict(zip(("time", *NAMES), rows.T, strict=True))


def servo(values: Mapping[str, float]) -> ServoDrive:
    settings = Settings.at_start()
    for name, value in values.items():
        settings = settings.changed(name, value)
    return ServoDrive(settings)


@dataclass
class Motion:
    """Times [s], positions of table and motor [m] at communication points; the block."""

    block: Block
    time: list[float] = field(default_factory=lambda: [0.0])
    x: list[float] = field(default_factory=lambda: [0.0])
    x_motor: list[float] = field(default_factory=lambda: [0.0])

    def off(self, truth: Any) -> float:
        own, samples = np.array(self.time), np.array(truth.time)
        where = np.minimum(np.searchsorted(own, samples - 1e-9), len(own) - 1)
        both = np.abs(own[where] - samples) < 1e-9
        return float(np.max(np.abs(np.array(self.x)[where] - truth.column("x"))[both]))


def couple(axis: Axis, steps: Iterable[float], first: str = "") -> Motion:
    """Step both with what the other gave at the start, or one of them `first`."""
    block, drive = make_block(**axis.values["table"]), servo(axis.values["drive"]).drive
    motion = Motion(block)
    block.refresh()
    for h in steps:
        F, x = float(block.F), float(block.x)
        if first == "drive":
            drive.advance(h, F, x)
        block.set("v", drive.output)
        block.advance(motion.time[-1], h)
        block.refresh()
        if first == "table":
            F, x = float(block.F), float(block.x)
        if first != "drive":
            drive.advance(h, F, x)
        motion.time.append(motion.time[-1] + h)
        motion.x.append(float(block.x))
        motion.x_motor.append(drive.x)
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
    last, _ = solve(axis.values, course[-1][0], course).jumps[-1]
    return float(np.interp(last, *np.array(course).T))


def random_axis(seed: int) -> Axis:
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
        with suppress(ModelError):
            axis = Axis(**changes, **EXACT)
            servo(axis.values["drive"])
            if is_stable(axis.designed):
                return axis
