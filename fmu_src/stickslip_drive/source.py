"""A source of speed as a model of fmi: it follows the set point, whatever pulls back."""

from __future__ import annotations

import math
from typing import Any

from fmi.model import Model, ModelError, Spec
from fmi.plain import check, values
from fmi.table import Table, Values

from . import model
from .setpoint import SetPoint
from .table import TABLE

_ROWS = ("feed", "acceleration", "distance", "v", "x_command")
_OWN: dict[str, dict[str, Any]] = {"feed": {"start": 0.02}, "v": {"path": "v"}}


class Settings(
    Values,
    table=Table(
        TABLE.units,
        TABLE.quantities.values(),
        (
            TABLE.by_name[name]._replace(number=number, **_OWN.get(name, {}))
            for number, name in enumerate(_ROWS)
        ),
    ),
):
    """Parameters of the source, SI."""


class SpeedSource(Model):
    """The source, at rest at the start.

    Its speed is the mean over a step as long as the last one, and makes up for what that was off.
    """

    wanted: Settings

    def __init__(self, settings: Settings, start_time: float = 0.0) -> None:
        self.wanted = settings
        self.v = self._time = self._x = 0.0

    @property
    def x_command(self) -> float:
        """Commanded position [m]."""
        return self._at(self._time)

    def _at(self, time: float) -> float:
        wanted = self.wanted
        return SetPoint(wanted.feed, wanted.acceleration, wanted.distance).at(time)[0]

    def set(self, name: str, value: float) -> None:
        """Set nothing: the source has no inputs, and its parameters are fixed."""

    def advance(self, time: float, step: float) -> None:
        """Move on by `step` [s]; raises ModelError unless it is above 0 and finite."""
        if not 0.0 < step < math.inf:
            raise ModelError(f"step = {step!r} s is out of range: it must be above 0")
        self._time += step
        self._x += self.v * step
        self.v = (self._at(self._time + step) - self._x) / step

    def freeze(self) -> tuple[Settings, float, float, float]:
        """Return the whole state for `thaw`."""
        return self.wanted, self._time, self._x, self.v

    def thaw(self, frozen: tuple[Settings, float, float, float]) -> None:
        """Take up a state that `freeze` returned, bit for bit."""
        self.wanted, self._time, self._x, self.v = frozen

    def save(self) -> dict[str, Any]:
        """Return the whole state as plain data for `restore`."""
        settings, *motion = self.freeze()
        return {"settings": settings.as_dict(), "motion": motion}

    def restore(self, saved: Any) -> None:
        """Take up a state that `save` returned; raises ModelError for anything else."""
        check(saved, {"settings": self.wanted.as_dict(), "motion": [0.0, 0.0, 0.0]})
        self.thaw((values(Settings, saved["settings"]), *saved["motion"]))


SPEC = Spec(
    name="SpeedSource",
    description="A source of speed: a feed, or a move by a trapezoid of speed and a hold",
    author=model.SPEC.author,
    version=model.SPEC.version,
    date=model.SPEC.date,
    licence=model.SPEC.licence,
    values=Settings,
    model=SpeedSource,
)
