"""A slider as people write it: fixed steps, stopped where the velocity has changed its sign; SI."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from tests.makers.foreign_block import START


class StepBlock:
    """Semi-implicit Euler, in steps of `step` [s], or `order` of them in a communication step.

    Faults: load light, by a tenth; damped ahead, and not behind; static friction high, by 1 %;
    ages, by a tenth of mu_k after 700 slips; push weak in stick, by 1 %; damping of the start, also
    after a change; begins at rest.
    """

    def __init__(
        self,
        values: Mapping[str, float],
        start_time: float = 0.0,
        conventions: Sequence[str] = (),
        order: int = 0,
        step: float = 1e-3,
        fault: str = "",
    ) -> None:
        self.p = {**START, **values}
        self.order, self.step, self.fault = order, step, fault
        self.x, self.u, self.z = (self.p[name] for name in ("x_start", "x_dot_start", "z_start"))
        self.damping = self.p["c"]
        if fault == "begins at rest":
            self.u = 0.0
        self.mode = (self.u > 0.0) - (self.u < 0.0)
        self.slips = 0

    def change(self, values: Mapping[str, float]) -> None:
        self.p.update(values)
        if self.fault != "damping of the start":
            self.damping = self.p["c"]

    def _friction(self, mu: str) -> float:
        load = self.p["load"] * (0.9 if self.fault == "load light" else 1.0)
        high = 1.01 if self.fault == "static friction high" and mu == "mu_s" else 1.0
        if self.fault == "ages" and mu == "mu_k" and self.slips > 700:
            high = 0.9
        return high * self.p[mu] * (self.p["m"] * self.p["g"] + load)

    def advance(self, now: float, h: float) -> None:
        p, count = self.p, self.order or max(1, round(h / self.step))
        h /= count
        for _ in range(count):
            driving = p["k"] * self.z + p["F_ext"]
            push = 0.01 * p["F_ext"] if self.fault == "push weak in stick" else 0.0
            if self.mode == 0 and abs(driving - push) > self._friction("mu_s"):
                self.mode = 1 if driving > 0.0 else -1
            if self.mode:
                one_way = self.fault == "damped ahead" and self.u < 0.0
                drag = (
                    self.mode * self._friction("mu_k") + (0.0 if one_way else self.damping) * self.u
                )
                self.u += h * (driving - drag) / p["m"]
                if self.mode * self.u <= 0.0:
                    self.u, self.mode = 0.0, 0
                    self.slips += 1
            self.x += h * self.u
            self.z += h * (p["v"] - self.u)

    def outputs(self) -> dict[str, float]:
        force = self.p["k"] * self.z
        drag = -self.mode * self._friction("mu_k") - self.damping * self.u
        return {
            "x": self.x, "x_dot": self.u, "x_pull": self.x + self.z, "z": self.z, "F": force,
            "F_friction": drag if self.mode else -force - self.p["F_ext"],
            "sticking": self.mode == 0, "mode": self.mode,
        }  # fmt: skip
