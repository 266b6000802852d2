"""A foreign FMU 2.0 that does WHAT on its third step: crash, hang, discard or raise."""

from __future__ import annotations

import ctypes
import time
from typing import Any

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

WHAT = "crash"


class Misbehaving(Fmi2Slave):  # type: ignore[misc]
    """It has what a stick-slip block needs, and does not move."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.m, self.g, self.k, self.mu_s, self.mu_k = 1.0, 9.81, 1000.0, 0.5, 0.3
        self.v, self.x, self.z, self.steps = 0.02, 0.0, 0.0, 0
        for name in ("m", "g", "k", "mu_s", "mu_k"):
            fixed = Fmi2Variability.fixed
            self.register_variable(Real(name, causality=Fmi2Causality.parameter, variability=fixed))
        self.register_variable(Real("v", causality=Fmi2Causality.input))
        for name in ("x", "z"):
            self.register_variable(Real(name, causality=Fmi2Causality.output))

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Count, and misbehave on the third."""
        self.steps += 1
        if self.steps < 3:
            return True
        if WHAT == "crash":
            ctypes.string_at(0)
        while WHAT == "hang":
            time.sleep(1.0)
        if WHAT == "raise":
            raise ValueError("the slider has had enough")
        return WHAT != "discard"
