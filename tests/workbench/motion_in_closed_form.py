"""A steady stick-slip motion written out in closed form, so that drawing needs no engine."""

import math
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from stickslip.simulate.run import Run
from stickslip_verification import Event, Transition

_REALS = ("x", "x_dot", "x_pull", "z", "F", "F_s", "delta_x", "t_stick", "t_slip", "T", "t_event")


class ClosedForm:
    """The undamped motion from a relaxed spring at the default parameters."""

    parameters: ClassVar[dict[str, float]] = {
        "m": 1.0, "g": 9.81, "k": 1000.0, "c": 0.0, "mu_s": 0.5, "mu_k": 0.3,
        "v": 0.02, "load": 0.0, "F_ext": 0.0,
        "x_start": 0.0, "x_dot_start": 0.0, "z_start": 0.0,
    }  # fmt: skip

    def __init__(self) -> None:
        p = self.parameters
        self.w = math.sqrt(p["k"] / p["m"])
        self.z_break_away = p["mu_s"] * p["m"] * p["g"] / p["k"]
        self.Delta = (p["mu_s"] - p["mu_k"]) * p["m"] * p["g"] / p["k"]
        self.t_first = self.z_break_away / p["v"]
        self.t_stick = 2.0 * self.Delta / p["v"]
        self.t_slip = 2.0 / self.w * (math.pi - math.atan(self.w * self.Delta / p["v"]))
        self.T = self.t_stick + self.t_slip

    def samples(self, times: NDArray[np.float64]) -> NDArray[np.void]:
        """Return time, outputs and meter at `times` [s], shape (n,)."""
        p = self.parameters
        out = np.zeros(
            len(times),
            dtype=[
                ("time", float),
                *((name, float) for name in (*_REALS, "mu_k_used")),
                *((name, np.int32) for name in ("mode", "n_slips")),
                ("sticking", np.bool_),
            ],
        )
        for row, t in zip(out, times, strict=True):
            slips_begun = 0 if t < self.t_first else int((t - self.t_first) // self.T) + 1
            since = t - self.t_first - (slips_begun - 1) * self.T
            slipping = slips_begun > 0 and since < self.t_slip
            done = slips_begun - slipping
            row["time"], row["x_pull"] = t, p["v"] * t
            row["mode"], row["sticking"], row["n_slips"] = slipping, not slipping, done
            row["delta_x"], row["t_slip"] = (p["v"] * self.T, self.t_slip) if done else (0.0, 0.0)
            row["t_stick"] = [0.0, self.t_first, self.t_stick][min(slips_begun, 2)]
            row["T"] = self.T if slips_begun > 1 else 0.0
            began = self.t_first + (slips_begun - 1) * self.T
            row["t_event"] = 0.0 if not slips_begun else began + (not slipping) * self.t_slip
            if slipping:
                phase = self.w * since
                amplitude = p["v"] / self.w
                row["z"] = (
                    self.z_break_away
                    - self.Delta * (1.0 - math.cos(phase))
                    + amplitude * math.sin(phase)
                )
                row["x_dot"] = p["v"] * (1.0 - math.cos(phase)) + self.Delta * self.w * math.sin(
                    phase
                )
                row["x"] = row["x_pull"] - row["z"]
            else:
                row["x"] = done * p["v"] * self.T
                row["z"] = row["x_pull"] - row["x"]
            row["F"] = p["k"] * row["z"]
            row["F_s"], row["mu_k_used"] = p["mu_s"] * p["m"] * p["g"], p["mu_k"]
        return out

    def events(self, stop_time: float) -> tuple[Event, ...]:
        """Return the transitions until `stop_time` [s]."""
        found = []
        n = 0
        while (time := self.t_first + n * self.T) <= stop_time:
            x = n * self.parameters["v"] * self.T
            found.append(Event(time, Transition.BREAK_AWAY, 1, x, self.z_break_away))
            if (time := time + self.t_slip) <= stop_time:
                z_end = self.z_break_away - 2.0 * self.Delta
                x = (n + 1) * self.parameters["v"] * self.T
                found.append(Event(time, Transition.RE_STICK, 0, x, z_end))
            n += 1
        return tuple(found)

    def run(self, times: NDArray[np.float64]) -> Run:
        """Return the run sampled at `times` [s]."""
        return Run("fmu", self.parameters, self.samples(times), self.events(float(times[-1])))
