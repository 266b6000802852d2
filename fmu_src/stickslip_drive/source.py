"""A source of speed as a model of fmi: it follows the set point, whatever pulls back."""

from __future__ import annotations

from typing import Any

from fmi.model import Experiment
from fmi.table import Table, Values

from . import model
from .setpoint import SetPoint
from .table import TABLE

_NAMES = ("feed", "acceleration", "distance", "v", "x_command")
_ROWS = [TABLE.by_name[name]._replace(number=number) for number, name in enumerate(_NAMES)]
_ROWS[0] = _ROWS[0]._replace(start=0.02)


class Settings(Values, table=Table(TABLE.units, TABLE.quantities.values(), _ROWS)):
    """Parameters of the source, SI."""


class _Follower:
    """What stands in for the drive: time [s], position [m], and mean speed to come [m/s]."""

    def __init__(self, set_point: SetPoint) -> None:
        self._set_point = set_point
        self.memory = (0.0, 0.0, 0.0)

    @property
    def output(self) -> float:
        return self.memory[2]

    def advance(self, h: float) -> None:
        """Go one step; the next is taken to be as long, and makes up for what this one was off."""
        time, x, v = self.memory
        time, x = time + h, x + h * v
        self.memory = (time, x, (self._set_point.at(time + h)[0] - x) / h)


class SpeedSource(model.ServoDrive):
    """The source, at rest at the start."""

    def _begin(self, settings: Any) -> None:
        self.wanted, self._time = settings, 0.0
        self._set_point = SetPoint(settings.feed, settings.acceleration, settings.distance)
        self.drive: Any = _Follower(self._set_point)

    def _pull(self, step: float) -> None:
        self.drive.advance(step)


SPEC = model.SPEC._replace(
    name="SpeedSource",
    description="A source of speed: a feed, or a move by a trapezoid of speed and a hold",
    values=Settings,
    model=SpeedSource,
    experiment=Experiment(),
)
