"""The servo drive as a model of fmi."""

from __future__ import annotations

import math
from typing import Any

from fmi.model import Experiment, Model, ModelError, Spec
from fmi.plain import check, values

from . import filters, motion
from .controller import Controller, Gains
from .drive import Drive
from .setpoint import SetPoint
from .table import TABLE, Settings


class ServoDrive(Model):
    """The drive, at rest at the start.

    Parameters
    ----------
    settings
        Parameters and inputs.
    start_time
        Without effect: the set point begins with the simulation.

    Raises
    ------
    ModelError
        If the sample time is too long for the motion or a filter, or there is no such filter.
    """

    wanted: Settings

    def __init__(self, settings: Settings, start_time: float = 0.0) -> None:
        self._begin(settings)

    def _begin(self, settings: Settings) -> None:
        self.wanted = settings
        self._set_point = SetPoint(settings.feed, settings.acceleration, settings.distance)
        m_d = motion.inertia_at_slide(settings.J, settings.pitch)
        refused = motion.objection(m_d, settings.d, settings.k, settings.T_s) or filters.objection(
            settings.T_s,
            settings.dead_time,
            settings.low_pass,
            settings.notch,
            settings.notch_damping,
        )
        if refused is not None:
            raise ModelError(refused)
        gains = Gains(**{name: getattr(settings, name) for name in Gains._fields})
        self.controller = Controller(gains, self._set_point)
        self.drive = Drive(
            m_d,
            settings.d,
            settings.k,
            settings.T_s,
            self.controller,
            settings.lag,
            settings.dead_time,
            settings.dry,
        )
        self._time = 0.0

    @property
    def x_command(self) -> float:
        """Commanded position [m]."""
        return self._set_point.at(self._time)[0]

    def set(self, name: str, value: float) -> None:
        """Set an input for the next step."""
        self.wanted = self.wanted.changed(name, value)

    def advance(self, time: float, step: float) -> None:
        """Move on by `step` [s]; raises ModelError unless it is above 0 and finite."""
        if not 0.0 < step < math.inf:
            raise ModelError(f"step = {step!r} s is out of range: it must be above 0")
        self._pull(step)
        self._time += step

    def _pull(self, step: float) -> None:
        self.drive.advance(step, self.wanted.F, self.wanted.x, self.wanted.F_2)

    def freeze(self) -> tuple[Settings, float, tuple[float, ...]]:
        """Return the whole state for `thaw`."""
        return self.wanted, self._time, self.drive.memory

    def thaw(self, frozen: tuple[Settings, float, tuple[float, ...]]) -> None:
        """Take up a state that `freeze` returned, bit for bit."""
        settings, time, memory = frozen
        self._begin(settings)
        self._time, self.drive.memory = time, memory

    def save(self) -> dict[str, Any]:
        """Return the whole state as plain data for `restore`."""
        settings, time, memory = self.freeze()
        return {"settings": settings.as_dict(), "time": time, "memory": list(memory)}

    def restore(self, saved: Any) -> None:
        """Take up a state that `save` returned; raises ModelError for anything else."""
        given = saved.get("settings", {}) if isinstance(saved, dict) else {}
        settings = values(type(self.wanted), given)
        # How much a state remembers depends on dead time and filters.
        check(saved, type(self)(settings).save())
        self.thaw((settings, saved["time"], tuple(saved["memory"])))


SPEC = Spec(
    name="ServoDrive",
    description="A servo drive: inertia, digital position and velocity control",
    author="The stickslip engineers",
    version="0.1.0",
    date="2026-11-21T00:00:00Z",
    licence="MIT",
    values=Settings,
    model=ServoDrive,
    experiment=Experiment(step_size=TABLE.by_name["T_s"].start),
)
