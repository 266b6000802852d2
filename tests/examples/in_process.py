"""Drive and block coupled in this process, without FMUs, over any steps."""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from examples.feed_axis.axis import Axis
from examples.feed_axis.servo_drive.controller import Controller, Gains
from examples.feed_axis.servo_drive.drive import Drive
from examples.feed_axis.servo_drive.setpoint import SetPoint
from tests.fmu.blocks import make_block


def make_drive(axis: Axis) -> tuple[Drive, Controller]:
    """Return the drive of an axis, and its controller."""
    values = axis.of_drive()
    gains = Gains(**{name: values[name] for name in Gains._fields})  # type: ignore[arg-type]
    controller = Controller(gains, SetPoint(axis.feed, axis.acceleration, axis.distance))
    way = axis.lag, axis.dead_time, axis.dry
    return Drive(axis.m_d, axis.d, values["k"], axis.T_s, controller, *way), controller


@dataclass
class Motion:
    """Times [s], positions of table and motor [m], spring forces [N] at communication points."""

    time: list[float] = field(default_factory=lambda: [0.0])
    x: list[float] = field(default_factory=lambda: [0.0])
    x_motor: list[float] = field(default_factory=lambda: [0.0])
    x_pull: list[float] = field(default_factory=lambda: [0.0])

    def table_at(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the table's position at these times, which are communication points."""
        where = np.searchsorted(self.time, times - 1e-9)
        return np.array(self.x)[where]


def couple(axis: Axis, steps: Iterable[float]) -> Motion:
    """Step drive and block side by side, each with what the other gave at the step's start."""
    block, (drive, _) = make_block(**axis.of_table()), make_drive(axis)
    motion = Motion()
    for h in steps:
        block.refresh()
        v, F, x = drive.output, float(block.F), float(block.x)
        block.set("v", v)
        block.advance(motion.time[-1], h)
        drive.advance(h, F, x)
        block.refresh()
        motion.time.append(motion.time[-1] + h)
        motion.x.append(float(block.x))
        motion.x_motor.append(drive.x)
        motion.x_pull.append(float(block.x_pull))
    return motion
