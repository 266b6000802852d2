"""A foreign FMU 2.0 that misbehaves on its third step, in the way that WHAT names."""

from __future__ import annotations

import ctypes
import os
import sys
import time
from pathlib import Path
from typing import Any

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real
from pythonfmu.enums import Fmi2Status

WHAT = "crash"
NOTES = ""


def leave_daemon() -> None:
    """Start a process with another parent and another session, and note its number."""
    if os.fork() == 0:
        os.setsid()
        daemon = os.fork()
        if daemon == 0:
            time.sleep(300.0)
        else:
            with Path(NOTES).open("a", encoding="utf-8") as notes:
                notes.write(f"{daemon}\n")
        os._exit(0)
    os.wait()


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
        if WHAT == "daemon":
            leave_daemon()
        if WHAT == "eat":
            self.eaten = bytearray(1_000_000_000)
        if WHAT == "print":
            for stream in (sys.stdout, sys.stderr):
                stream.write("moving on\n" * 1_000_000)
        if WHAT == "log":
            for _ in range(10_000):
                self.log("moving on " * 1000, Fmi2Status.warning)
        while WHAT == "hang":
            time.sleep(1.0)
        if WHAT == "raise":
            raise ValueError("the slider has had enough")
        return WHAT != "discard"
