"""A foreign FMU 2.0 that solves the slip by Taylor series and finds events by Newton on them.

SI. Its only outputs are position, velocity, spring force and stick; friction and spring are fixed.
The series are those of the net force e = k z + F_ext - s mu_k N and of the velocity u:
e' = k (v - u), m u' = e - c u.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from tests.verification.foreign.foreign_face import FLAG, Block, ForeignFace, Given, Shown

FAULT = ""

ORDER = 22

PRECISION = 2.0**-56
"""The last two terms of a step are below this part of the largest."""

LONGEST = 1.0
"""Longest step in units of 1/w: between two extremes of the velocity lie more than 3."""

SLACK = 8.0 * 2.0**-52
"""Part of the forces by which the driving force must exceed static friction to move a mass at
rest."""


class SeriesBlock:
    """The mass and its phase; SI."""

    def __init__(self, values: Mapping[str, float]) -> None:
        self.p = dict(values)
        self.x, self.u, self.z = 0.0, values["x_dot_start"], values["z_start"]
        self.e = 0.0
        self.mode = 0
        if self.u != 0.0:
            self._begin_slip(1 if self.u > 0.0 else -1)

    def _force(self) -> float:
        return self.p["k"] * self.z + self.p["F_ext"]

    def _normal(self) -> float:
        return max(self.p["m"] * self.p["g"] + self.p["load"], 0.0)

    def _static(self) -> float:
        return self.p["mu_s"] * self._normal()

    def _kinetic(self) -> float:
        mu_s, mu_k = self.p["mu_s"], self.p["mu_k"]
        return (max(mu_s - 0.01, 0.0) if mu_k > mu_s else mu_k) * self._normal()

    def _driven(self) -> int:
        """Return the direction in which a mass at rest is moved at once; 0 if friction holds it."""
        spring, push, static = self.p["k"] * self.z, self.p["F_ext"], self._static()
        if abs(spring + push) - static > SLACK * (abs(spring) + abs(push) + static):
            return 1 if spring + push > 0.0 else -1
        return 0

    def _begin_slip(self, direction: int) -> None:
        self.mode = direction
        self.e = self._force() - direction * self._kinetic()

    def change(self, values: Mapping[str, float]) -> None:
        """Put inputs in force."""
        if FAULT == "load-ignored-backward" and self.mode == -1:
            values = {key: value for key, value in values.items() if key != "load"}
        self.p.update(values)
        if self.mode:
            self.e = self._force() - self.mode * self._kinetic()

    def advance(self, now: float, h: float) -> None:
        """Move on by h [s]."""
        left = h
        while left > 0.0:
            left -= self._stick(left) if self.mode == 0 else self._slip(left)

    def _stick(self, left: float) -> float:
        """Rest for at most `left` [s]; return for how long."""
        k, v, static = self.p["k"], self.p["v"], self._static()
        driven = self._driven()
        if driven:
            self._begin_slip(driven)
            return 0.0
        wait = math.inf
        if v != 0.0:
            wait = max((math.copysign(static, v) - self._force()) / (k * v), 0.0)
        if wait >= left:
            self.z += v * left
            return left
        self.mode = 1 if v > 0.0 else -1
        self.z = (self.mode * static - self.p["F_ext"]) / k
        self.e = self.mode * (static - self._kinetic())
        return wait

    def _series(self) -> tuple[list[float], list[float]]:
        """Return the Taylor coefficients of e and u about the present."""
        m, k, c, v = self.p["m"], self.p["k"], self.p["c"], self.p["v"]
        e, u = [self.e], [self.u]
        for n in range(1, ORDER + 1):
            e_next = k * ((v if n == 1 else 0.0) - u[-1]) / n
            u.append((e[-1] - c * u[-1]) / (m * n))
            e.append(e_next)
        return e, u

    def _length(self, e: Sequence[float], u: Sequence[float]) -> float:
        """Return the step for which the last terms of both series are negligible [s]."""
        w = math.sqrt(self.p["k"] / self.p["m"])
        length = LONGEST / w
        stiffness = self.p["k"] / w
        size = PRECISION * (abs(e[0]) + stiffness * (abs(u[0]) + abs(self.p["v"])))
        for series, scale in ((e, 1.0), (u, stiffness)):
            for n in (ORDER - 1, ORDER):
                term = scale * abs(series[n])
                if term > 0.0 and size > 0.0:
                    length = min(length, (size / term) ** (1.0 / n))
        return length

    def _slip(self, left: float) -> float:
        """Slip on for at most `left` [s] by one series; return for how long."""
        s = self.mode
        e, u = self._series()
        h = min(left, self._length(e, u))
        speed = [s * term for term in u]
        slope = [n * term for n, term in enumerate(speed)][1:]
        # The velocity is monotone between its extremes, of which a step holds one at most.
        rising = next((term > 0.0 for term in slope if term != 0.0), True)
        ends_rising = _value(slope, h) > 0.0
        turn = _zero(slope, 0.0, h) if rising != ends_rising else None
        stop = None
        if turn is not None and not rising and _value(speed, turn) <= 0.0:
            stop = _zero(speed, 0.0, turn)
        elif _value(speed, h) <= 0.0 and (turn is None or rising):
            stop = _zero(speed, turn or 0.0, h)
        dt = h if stop is None else stop
        gone = _value([0.0, *e[1:]], dt) / self.p["k"]
        self.e = _value(e, dt)
        self.u = _value(u, dt)
        self.z += gone
        self.x += self.p["v"] * dt - gone
        if stop is not None:
            self.u = 0.0
            self.mode = 0
        return dt

    def outputs(self) -> dict[str, float]:
        """Return the outputs [SI]."""
        return {
            "x": self.x,
            "x_dot": self.u,
            "F": self.p["k"] * self.z,
            "sticking": self.mode == 0 and not self._driven(),
        }


def _value(series: Sequence[float], t: float) -> float:
    total = 0.0
    for term in reversed(series):
        total = total * t + term
    return total


def _zero(series: Sequence[float], low: float, high: float) -> float:
    """Return the zero between two times of a series that is monotone there, by Newton's method."""
    positive_after = _value(series, high) > 0.0
    slope = [n * term for n, term in enumerate(series)][1:]
    t = 0.5 * (low + high)
    for _ in range(100):
        value = _value(series, t)
        if (value > 0.0) == positive_after:
            high = t
        else:
            low = t
        rate = _value(slope, t)
        following = t - value / rate if rate != 0.0 else low
        if not low < following < high:
            following = 0.5 * (low + high)
        if abs(following - t) <= 2.0**-52 * t:
            return following
        t = following
    return t


class Taylor(ForeignFace):
    """The block of series behind its face."""

    fixed = (
        Given("m", "m_slider", "kg", 1.0),
        Given("g", "g_n", "m/s2", 9.81),
        Given("k", "k_spring", "N/m", 1000.0),
        Given("c", "d_way", "N.s/m", 0.0),
        Given("mu_s", "mu_0", "1", 0.5),
        Given("mu_k", "mu_1", "1", 0.3),
        Given("x_dot_start", "v_start", "m/s", 0.0),
        Given("z_start", "stretch_start", "m", 0.0),
    )
    inputs = (
        Given("v", "v_drive", "m/s", 0.02),
        Given("load", "extra_load", "N", 0.0),
        Given("F_ext", "disturbance", "N", 0.0),
    )
    shows = (
        Shown("x", "slider_position", "m"),
        Shown("x_dot", "slider_velocity", "m/s"),
        Shown("F", "spring_force", "N"),
        Shown("sticking", "at_rest", FLAG),
    )

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.owed = 0.0

    def make_block(self) -> Block:
        """Return the block at its start."""
        return SeriesBlock(self.given)

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Move on; in the faulty twin, later."""
        if FAULT != "moves-when-read":
            return super().do_step(current_time, step_size)
        self.block.change(self.pending())
        self.owed += step_size
        return True

    def see(self, key: str) -> float:
        """Return an output [SI]."""
        if self.owed > 0.0:
            self.block.advance(0.0, self.owed)
            self.shown = self.block.outputs()
            self.owed = 0.0
        return super().see(key)
