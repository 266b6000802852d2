"""An FMU 2.0 that goes wrong where its parameter `trouble` says so, for tests of sweeps."""

from __future__ import annotations

import ctypes
import os
import tempfile
import time
from pathlib import Path
from typing import Any, ClassVar

from pythonfmu import (
    Boolean,
    Fmi2Causality,
    Fmi2Initial,
    Fmi2Slave,
    Fmi2Variability,
    Integer,
    Real,
    String,
)


class Troubled(Fmi2Slave):  # type: ignore[misc]
    """Integrates its input; what a reset does not forget is `seen`."""

    seen: ClassVar[int] = 0

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.trouble, self.gain, self.on = 0, 1.0, False
        self.u, self.u_begun, self.y, self.runs = 0.0, 0.0, 0.0, 0
        self.label = "nothing"
        fixed = Fmi2Variability.fixed
        parameter = Fmi2Causality.parameter
        kinds = {"trouble": Integer, "gain": Real, "on": Boolean, "label": String}
        for name, kind in kinds.items():
            self.register_variable(kind(name, causality=parameter, variability=fixed))
        self.register_variable(Real("u", causality=Fmi2Causality.input))
        output, calculated = Fmi2Causality.output, Fmi2Initial.calculated
        self.register_variable(Real("y", causality=output, initial=Fmi2Initial.exact))
        self.register_variable(Real("u_begun", causality=output, initial=calculated))
        self.register_variable(Integer("runs", causality=output, initial=calculated))

    def exit_initialization_mode(self) -> None:
        """Count the runs since the library was loaded, and keep the input of the start."""
        self.u_begun = self.u
        type(self).seen += 1
        self.runs = self.seen if self.on else 0

    def do_step(self, current_time: float, step_size: float) -> bool:
        self.y += self.gain * self.u * step_size
        if self.trouble == 1:
            Path(tempfile.gettempdir(), f"hangs-{os.getpid()}").touch()
            time.sleep(300.0)
        if self.trouble == 2:
            ctypes.string_at(0)
        if self.trouble == 3:
            os._exit(3)
        if self.trouble == 4:
            raise ValueError("enough of it")
        if self.trouble == 5:
            os.write(1, b"moving on\n" * 100_000)
            print("moving on " * 1000)
        # Of a crash behind an earlier run, no run of its own is to blame.
        if self.trouble == 6 and self.seen > 1:
            ctypes.string_at(0)
        return self.trouble != 7
