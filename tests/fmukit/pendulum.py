"""A damped pendulum of small swings, solved exactly over every step."""

from __future__ import annotations

import math
from typing import Any

from fmukit.model import Experiment, Model, ModelError, Spec
from fmukit.plain import check, values
from fmukit.table import ABOVE_ZERO, Quantity, Table, Unit, Values, Variable

UNITS = {"m": Unit({"m": 1}), "rad": Unit({"rad": 1}), "rad/s": Unit({"rad": 1, "s": -1}),
         "1/s": Unit({"s": -1}), "rad/s2": Unit({"rad": 1, "s": -2})}  # fmt: skip
LENGTH, RATE = Quantity("Length", "Real", "Length", "m"), Quantity("Rate", "Real", "", "1/s")
ANGLE = Quantity("Angle", "Real", "Angle", "rad")
SPEED, PUSH = Quantity("Speed", "Real", "", "rad/s"), Quantity("Push", "Real", "", "rad/s2")
ROWS = [
    Variable(0, "l", LENGTH, "parameter", "fixed", 1.0, "Length", minimum=ABOVE_ZERO),
    Variable(1, "d", RATE, "parameter", "tunable", 0.1, "Rate of decay", minimum=0.0),
    Variable(2, "phi_start", ANGLE, "parameter", "fixed", 0.1, "Angle at the start"),
    Variable(3, "push", PUSH, "input", "continuous", 0.0, "Torque over inertia"),
    Variable(4, "phi", ANGLE, "output", "continuous", None, "Angle", depends=("phi_start",)),
    Variable(5, "omega", SPEED, "output", "continuous", 0.0, "Angular velocity"),
]


class Settings(Values, table=Table(UNITS, [LENGTH, RATE, ANGLE, SPEED, PUSH], ROWS)):
    """Parameters and inputs."""


class Pendulum(Model):
    """phi'' = push - 2 d phi' - g/l phi, with the push held over a step."""

    wanted: Settings

    def __init__(self, settings: Settings, start_time: float = 0.0) -> None:
        self.wanted, self.phi, self.omega = settings, settings.phi_start, 0.0
        self.check()

    def check(self) -> None:
        """Refuse a damping that lets the pendulum creep."""
        if not self.wanted.d < math.sqrt(9.81 / self.wanted.l):
            raise ModelError(f"d = {self.wanted.d!r} 1/s is out of range: below sqrt(g/l)")

    def set(self, name: str, value: float) -> None:
        """Set push or damping for the next step."""
        self.wanted = self.wanted.changed(name, value)

    def advance(self, time: float, step: float) -> None:
        """Swing on by `step` [s], about the angle at which the push is balanced."""
        if not 0.0 < step < math.inf:
            raise ModelError(f"step size h = {step!r} s is out of range: above 0 and finite")
        stiffness, d = 9.81 / self.wanted.l, self.wanted.d
        w, rest = math.sqrt(stiffness - d * d), self.wanted.push / stiffness
        away, omega, fade = self.phi - rest, self.omega, math.exp(-d * step)
        cos, sin = math.cos(w * step), math.sin(w * step) / w
        self.phi = rest + fade * (away * cos + (omega + d * away) * sin)
        self.omega = fade * (omega * cos - (stiffness * away + d * omega) * sin)

    def freeze(self) -> Any:
        """Return the whole state."""
        return self.wanted, self.phi, self.omega

    def thaw(self, frozen: Any) -> None:
        """Take up a state that `freeze` returned."""
        self.wanted, self.phi, self.omega = frozen

    def save(self) -> dict[str, Any]:
        """Return the whole state as plain data."""
        return {"wanted": self.wanted.as_dict(), "motion": [self.phi, self.omega]}

    def restore(self, saved: Any) -> None:
        """Take up plain data; raises ModelError where they are no state."""
        check(saved, self.save())
        self.thaw((values(type(self.wanted), saved["wanted"]), *saved["motion"]))


SPEC = Spec("Pendulum", "A damped pendulum", "You", "1.0", "2026-11-22T00:00:00Z", "MIT",
            Settings, Pendulum, Experiment(0.0, 10.0, 0.01))  # fmt: skip
