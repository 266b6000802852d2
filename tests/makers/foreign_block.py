"""The stick-slip block by another hand, by power series, with its meter and energies; SI.

It travels in foreign FMUs and shares nothing with the block under test.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache

EQUAL = 1e-14
"""Forces, speeds and sums that differ by less of their parts are equal."""

START = {
    "m": 1.0, "g": 9.81, "k": 1000.0, "c": 0.0, "mu_s": 0.5, "mu_k": 0.3, "v": 0.02, "load": 0.0,
    "F_ext": 0.0, "x_start": 0.0, "x_dot_start": 0.0, "z_start": 0.0,
}  # fmt: skip


class Slip:
    """A slip by power series about the ends of steps, of `step` in units of 1/max(w, c/m).

    Of the net force e and the velocity u: e' = k (v - u), m u' = e - c u. `start` is direction, e,
    u. As the equations are linear, order 1 is Euler's method, up to 4 those of Runge and Kutta.
    """

    def __init__(
        self, order: int, step: float, m: float, k: float, v: float, c: float, *start: float
    ) -> None:
        self.order, self.m, self.k, self.v, self.c = order, m, k, v, c
        self.s, self.net, u = start
        w = math.sqrt(k / m)
        self.h = step / max(w, c / m)
        self.touch = EQUAL * (abs(v) + math.hypot(v - u, (self.net - c * v) / k * w))
        self.ends = [(self.net, u)]
        self.greatest = self.stop = math.inf
        self.searched, self.touches = 0, False

    def _at(self, t: float) -> tuple[float, float]:
        number = int(t / self.h)
        while len(self.ends) <= number:
            self.ends.append(self._moved(*self.ends[-1], self.h))
        return self._moved(*self.ends[number], t - number * self.h)

    def _moved(self, e: float, u: float, h: float) -> tuple[float, float]:
        moved_e, moved_u, v = e, u, self.v
        for n in range(1, self.order + 1):
            e, u = h / n * self.k * (v - u), h / n * (e - self.c * u) / self.m
            moved_e, moved_u, v = moved_e + e, moved_u + u, 0.0
        return moved_e, moved_u

    def stretched(self, t: float) -> float:
        return (self._at(t)[0] - self.net) / self.k

    def velocity(self, t: float) -> float:
        return self._at(t)[1]

    def _along(self, t: float) -> float:
        return self.s * self.velocity(t)

    def _push(self, t: float) -> float:
        e, u = self._at(t)
        return self.s * (e - self.c * u)

    def search(self, until: float) -> None:
        while self.searched * self.h <= until and self.stop == math.inf:
            low, high = self.searched * self.h, (self.searched + 1) * self.h
            self.searched += 1
            before, after = self._push(low), self._push(high)
            if before > 0.0 >= after:
                turn = falling_zero(self._push, low, high)
                self.greatest = min(self.greatest, turn)
                low = turn
            elif before < 0.0 <= after:
                turn = falling_zero(lambda t: -self._push(t), low, high)
                lowest = self._along(turn)
                self.touches = abs(lowest) <= self.touch
                if lowest <= self.touch:
                    self.stop = turn if self.touches else falling_zero(self._along, low, turn)
                    return
            if self._along(high) <= 0.0:
                self.stop = falling_zero(self._along, low, high)


def falling_zero(function: Callable[[float], float], low: float, high: float) -> float:
    at_low, at_high = function(low), function(high)
    for _ in range(200):
        middle = high - at_high * (high - low) / (at_high - at_low) if at_high < at_low else low
        if not low < middle < high:
            middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        value = function(middle)
        if value > 0.0:
            low, at_low, at_high = middle, value, 0.5 * at_high
        else:
            high, at_high, at_low = middle, value, 0.5 * at_low
    return high


slip_of = lru_cache(maxsize=8)(Slip)


class ForeignBlock:
    """The block with its meter and its energies, of values in SI by the suite's names.

    Conventions: not yet: what the meter does not know yet is -1. clamp: mu_k above mu_s is taken as
    mu_s. reversal: a reversal, and a start in motion, count as break-aways for T. first stick: it
    does not set t_stick. instants: at the end of a step that is the very instant of a transition, a
    break-away has happened and a stop has not. Faults: static friction high, by 0.5 %; undamped
    back, after a reversal until the mass sticks. By default `order` and `step` lose nothing but
    rounding.
    """

    def __init__(
        self,
        values: Mapping[str, float],
        start_time: float = 0.0,
        conventions: Sequence[str] = (),
        order: int = 22,
        step: float = 1.0,
        fault: str = "",
    ) -> None:
        self.p = {**START, **values}
        self.conventions, self.fault = list(conventions), fault
        self.order, self.step = order, step
        self.x, self.u, self.z = (self.p[name] for name in ("x_start", "x_dot_start", "z_start"))
        unknown = -1.0 if "not yet" in conventions else 0.0
        self.meter = dict.fromkeys(("spring_drop", "f", "x_dot_peak"), 0.0)
        self.meter |= dict.fromkeys(("delta_x", "t_stick", "t_slip", "T"), unknown)
        self.meter["t_event"] = unknown or start_time
        self.count = self.mode = 0
        self.work = self.tuning = self.heat = 0.0
        self.reversed, self.first = False, True
        self.arc: dict[str, float] = {}
        # Length of the phase up to the arc, time since the last break-away (none yet: negative).
        self.before, self.since = 0.0, -1.0
        self.from_x = self.from_z = self.peak = 0.0
        if self.u != 0.0:
            if "reversal" in self.conventions:
                self.since = 0.0
            self._begin_slip(1 if self.u > 0.0 else -1)
        else:
            self._begin_arc()

    @property
    def normal(self) -> float:
        weight = self.p["m"] * self.p["g"]
        force = weight + self.p["load"]
        return force if force > EQUAL * weight else 0.0

    @property
    def mu_k(self) -> float:
        mu_s, mu_k = self.p["mu_s"], self.p["mu_k"]
        if mu_k <= mu_s:
            return mu_k
        return mu_s if "clamp" in self.conventions else max(mu_s - 0.01, 0.0)

    @property
    def static(self) -> float:
        high = 1.005 if self.fault == "static friction high" else 1.0
        return high * self.p["mu_s"] * self.normal

    @property
    def driving(self) -> float:
        return self.p["k"] * self.z + self.p["F_ext"]

    @property
    def damping(self) -> float:
        return 0.0 if self.fault == "undamped back" and self.reversed else self.p["c"]

    def _loose(self) -> int:
        parts = abs(self.p["k"] * self.z) + abs(self.p["F_ext"]) + self.static
        if abs(self.driving) - self.static <= EQUAL * parts:
            return 0
        return 1 if self.driving > 0.0 else -1

    def _begin_arc(self, net: float | None = None) -> None:
        if net is None:
            net = self.driving - self.mode * self.mu_k * self.normal
        self.arc = {"x": self.x, "z": self.z, "u": self.u, "net": net, "age": 0.0}
        self.arc |= {"work": self.work, "heat": self.heat}

    def _end(self, until: float) -> float:
        if self.mode:
            slip = self._slip()
            slip.search(until)
            self.arc["touches"] = slip.touches
            return slip.stop
        if self._loose():
            return 0.0
        v = self.p["v"]
        if v == 0.0:
            return math.inf
        k_z = self.p["k"] * self.arc["z"] + self.p["F_ext"]
        return max((math.copysign(self.static, v) - k_z) / (self.p["k"] * v), 0.0)

    def _slip(self) -> Slip:
        of_block = (self.p["m"], self.p["k"], self.p["v"], self.damping)
        start = (self.mode, self.arc["net"], self.arc["u"])
        return slip_of(self.order, self.step, *of_block, *start)

    def change(self, values: Mapping[str, float]) -> None:
        self._note_peak()
        self.tuning += 0.5 * (values.get("k", self.p["k"]) - self.p["k"]) * self.z**2
        self.p.update(values)
        self.before += self.arc["age"]
        self._begin_arc()

    def advance(self, now: float, h: float) -> None:
        left = h
        early = "instants" in self.conventions
        while left > 0.0:
            end = self._end(self.arc["age"] + left)
            rest = max(end - self.arc["age"], 0.0)
            over = rest < left or (rest == left and early == (self.mode == 0))
            part = rest if over else left
            self._move(end if over else self.arc["age"] + part)
            if self.since >= 0.0:
                self.since += part
            left -= part
            if over:
                self.meter["t_event"] = now + (h - left)
                (self._stop if self.mode else self._break_away)()

    def _move(self, age: float) -> None:
        arc, p = self.arc, self.p
        arc["age"] = age
        if self.mode == 0:
            self.z = arc["z"] + p["v"] * age
            self.work = arc["work"] + p["v"] * age * p["k"] * (arc["z"] + 0.5 * p["v"] * age)
            return
        slip = self._slip()
        grown = slip.stretched(age)
        way = p["v"] * age - grown
        self.z, self.x, self.u = arc["z"] + grown, arc["x"] + way, slip.velocity(age)
        # Spring force over the time, from the momentum; heat is what the account leaves.
        momentum = p["m"] * (self.u - arc["u"])
        dry = self.mode * self.mu_k * self.normal
        work = p["v"] * (momentum + (dry - p["F_ext"]) * age + self.damping * way)
        kinetic = 0.5 * p["m"] * (self.u + arc["u"]) * (self.u - arc["u"])
        stored = 0.5 * p["k"] * (self.z + arc["z"]) * grown
        self.work = arc["work"] + work
        self.heat = arc["heat"] + (work + p["F_ext"] * way - kinetic - stored)

    def _break_away(self) -> None:
        if not (self.first and "first stick" in self.conventions):
            self.meter["t_stick"] = self.before + self.arc["age"]
        self.first = False
        self._count_period()
        if loose := self._loose():
            self._begin_slip(loose)
        else:
            direction = 1 if self.p["v"] > 0.0 else -1
            self.z = (direction * self.static - self.p["F_ext"]) / self.p["k"]
            self._begin_slip(direction, direction * (self.static - self.mu_k * self.normal))

    def _count_period(self) -> None:
        if self.since > 0.0:
            self.meter["T"], self.meter["f"] = self.since, 1.0 / self.since
        self.since = 0.0

    def _begin_slip(self, direction: int, net: float | None = None) -> None:
        self.mode, self.before = direction, 0.0
        self.from_x, self.from_z, self.peak = self.x, self.z, self.u
        self._begin_arc(net)

    def _note_peak(self) -> None:
        if self.mode:
            slip, age = self._slip(), self.arc["age"]
            greatest = min(slip.greatest, age)
            speeds = (self.peak, slip.velocity(greatest), slip.velocity(age))
            self.peak = self.mode * max(self.mode * speed for speed in speeds)

    def _stop(self) -> None:
        self._note_peak()
        self.meter["t_slip"] = self.before + self.arc["age"]
        self.meter["delta_x"] = self.x - self.from_x
        self.meter["spring_drop"] = self.from_z - self.z
        self.meter["x_dot_peak"] = self.peak
        self.count += 1
        self.u = 0.0
        if self.arc["touches"]:
            # Neither velocity nor acceleration: the net force is zero.
            self.z = (self.mode * self.mu_k * self.normal - self.p["F_ext"]) / self.p["k"]
        back = self._loose()
        self.reversed = back != 0
        if back:
            if "reversal" in self.conventions:
                self._count_period()
            self._begin_slip(back)
        else:
            self.mode, self.before = 0, 0.0
            self._begin_arc()

    def outputs(self) -> dict[str, float]:
        slipping = -(self.mode * self.mu_k * self.normal + self.damping * self.u)
        return {
            "x": self.x, "x_dot": self.u, "x_pull": self.x + self.z, "z": self.z,
            "F": self.p["k"] * self.z, "F_s": self.static, "mu_k_used": self.mu_k,
            "F_friction": slipping if self.mode else -self.driving,
            "sticking": self.mode == 0, "mode": self.mode, "n_slips": self.count,
            "W_pull": self.work, "W_k": self.tuning, "Q_friction": self.heat,
            **self.meter,
        }  # fmt: skip
