"""The exact block by closed forms, with its meter, its energies and its conventions; SI.

It shares nothing with the block under test: another writing of the same physics, for foreign FMUs.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

NOT_YET = -1.0

EQUAL = 1e-14
"""Forces, speeds and sums that differ by less of their parts are equal."""

REST = dict.fromkeys(("c", "load", "F_ext", "x_start", "x_dot_start", "z_start"), 0.0)
"""What acts where the face of the block has no such variable."""


class Slip:
    """A slip from its start or the last change on, by closed forms, with y = z - z_inf; SI.

    y'' + 2 alpha y' + w^2 y = 0, and the velocity is v - y'.
    """

    def __init__(self, p: Mapping[str, float], c: float, s: int, net: float, u: float) -> None:
        m, k, v = p["m"], p["k"], p["v"]
        self.s, self.v, self.u = s, v, u
        self.square = k / m
        self.alpha = 0.5 * c / m
        self.y = (net - c * v) / k
        self.y_rate = v - u
        self.y_bend = (c * u - net) / m
        w = math.sqrt(self.square)
        self.under = self.alpha < w
        self.turn = math.sqrt(abs((w - self.alpha) * (w + self.alpha)))

    def _parts(self, t: float) -> tuple[float, float]:
        """Return exp(-alpha t) times cos(turn t) and sin(turn t)/turn, or times cosh and sinh."""
        if self.under:
            fade, angle = math.exp(-self.alpha * t), self.turn * t
            return fade * math.cos(angle), fade * math.sin(angle) / self.turn
        slow = math.exp(-self.square / (self.alpha + self.turn) * t)
        gone = -math.expm1(-2.0 * self.turn * t)
        sine = 0.5 * gone / self.turn if self.turn > 0.0 else t
        return slow * (1.0 - 0.5 * gone), slow * sine

    def stretched(self, t: float) -> float:
        """Return by how much z has grown since the start [m]."""
        cosine, sine = self._parts(t)
        return (cosine - 1.0) * self.y + (self.y_rate + self.alpha * self.y) * sine

    def velocity(self, t: float) -> float:
        """Return the velocity of the mass [m/s]."""
        cosine, sine = self._parts(t)
        pull = self.square * self.y + self.alpha * self.y_rate
        return self.v - (self.y_rate * cosine - pull * sine)

    def acceleration(self, t: float) -> float:
        """Return the acceleration of the mass [m/s2]."""
        cosine, sine = self._parts(t)
        pull = self.square * self.y_rate + self.alpha * self.y_bend
        return pull * sine - self.y_bend * cosine

    def turns(self) -> tuple[float, float]:
        """Return the times [s] of the first maximum and the first minimum of the velocity along s.

        Infinite where there is none after the start.
        """
        pull = self.square * self.y_rate + self.alpha * self.y_bend
        along = -self.s * self.y_bend
        if self.under:
            phase = math.atan2(self.s * pull / self.turn, along)
            greatest, least = 0.5 * math.pi + phase, 1.5 * math.pi + phase
            greatest += 2.0 * math.pi if greatest <= 0.0 else 0.0
            least -= 2.0 * math.pi if least > 2.0 * math.pi else 0.0
            return greatest / self.turn, least / self.turn
        part = self.y_bend / pull if pull != 0.0 else math.inf
        if self.turn > 0.0:
            part *= self.turn
            once = math.atanh(part) / self.turn if 0.0 < part < 1.0 else math.inf
        else:
            once = part if part > 0.0 else math.inf
        return (once, math.inf) if along > 0.0 else (math.inf, once)

    def stop(self) -> tuple[float, bool]:
        """Return when the velocity first reaches zero [s], and whether it only touches zero there.

        The time is infinite if it never does.
        """
        greatest, least = self.turns()
        if math.isfinite(least):
            lowest = self.s * self.velocity(least)
            touch = EQUAL * (abs(self.v) + math.hypot(self.y_rate, self.y * math.sqrt(self.square)))
            if abs(lowest) <= touch:
                return least, True
            if lowest > 0.0:
                return math.inf, False
            return self._crossing(greatest if greatest < least else 0.0, least), False
        if self.s * self.v >= 0.0:
            return math.inf, False
        low = greatest if math.isfinite(greatest) else 0.0
        high = low + 1.0 / math.sqrt(self.square)
        while self.s * self.velocity(high) > 0.0:
            low, high = high, 2.0 * high
        return self._crossing(low, high), False

    def _crossing(self, low: float, high: float) -> float:
        """Return the zero of a velocity that falls between two times, by Newton in a bracket."""
        t = 0.5 * (low + high)
        for _ in range(200):
            value = self.s * self.velocity(t)
            if value > 0.0:
                low = t
            else:
                high = t
            slope = self.s * self.acceleration(t)
            following = t - value / slope if slope < 0.0 else low
            if not low < following < high:
                following = 0.5 * (low + high)
            if abs(following - t) <= 2.0**-52 * t:
                return following
            t = following
        return t


class ExactBlock:
    """The block with its meter and its energies.

    Parameters
    ----------
    values
        What is given, by the suite's names [SI]; `REST` where it is not.
    start_time
        Time of the start [s].
    conventions
        Where it differs from the exact block of the suite. not yet: what the meter does not know
        yet is -1 m or -1 s. clamp: mu_k above mu_s is taken as mu_s. reversal: a reversal, and a
        start in motion, count as break-aways for T. first stick: it does not set t_stick. instants:
        at the end of a step that is the very instant of a transition, a break-away has happened and
        a stop has not.
    undamped_back
        A fault: after a reversal there is no damping until the mass sticks.
    """

    def __init__(
        self,
        values: Mapping[str, float],
        start_time: float,
        conventions: Sequence[str] = (),
        undamped_back: bool = False,
    ) -> None:
        self.p = {**REST, **values}
        self.conventions = list(conventions)
        self.undamped_back = undamped_back
        self.x, self.u, self.z = (self.p[name] for name in ("x_start", "x_dot_start", "z_start"))
        unknown = NOT_YET if "not yet" in conventions else 0.0
        self.meter = dict.fromkeys(("spring_drop", "f", "x_dot_peak"), 0.0)
        self.meter.update(dict.fromkeys(("delta_x", "t_stick", "t_slip", "T"), unknown))
        self.meter["t_event"] = unknown if "not yet" in conventions else start_time
        self.count = 0
        self.work = self.tuning = self.heat = 0.0
        self.mode = 0
        self.reversed = False
        self.arc: dict[str, float] = {}
        # Length of the phase up to the arc, time since the last break-away (none yet: negative).
        self.before = 0.0
        self.since = -1.0
        self.first = True
        self.from_x = self.from_z = self.peak = 0.0
        if self.u != 0.0:
            if "reversal" in self.conventions:
                self.since = 0.0
            self._begin_slip(1 if self.u > 0.0 else -1)
        else:
            self._begin_arc()

    @property
    def normal(self) -> float:
        """Normal force [N]; a load that takes the weight off leaves none."""
        weight = self.p["m"] * self.p["g"]
        force = weight + self.p["load"]
        return force if force > EQUAL * weight else 0.0

    @property
    def mu_k(self) -> float:
        """Kinetic coefficient in use."""
        mu_s, mu_k = self.p["mu_s"], self.p["mu_k"]
        if mu_k <= mu_s:
            return mu_k
        return mu_s if "clamp" in self.conventions else max(mu_s - 0.01, 0.0)

    @property
    def static(self) -> float:
        """Static friction [N]."""
        return self.p["mu_s"] * self.normal

    @property
    def driving(self) -> float:
        """Spring and external force [N]."""
        return self.p["k"] * self.z + self.p["F_ext"]

    @property
    def damping(self) -> float:
        """Damping in force [N.s/m]."""
        off = self.undamped_back and self.reversed
        return 0.0 if off else self.p["c"]

    def _loose(self) -> int:
        """Return where a mass at rest is driven at once; 0 if friction holds it."""
        parts = abs(self.p["k"] * self.z) + abs(self.p["F_ext"]) + self.static
        if abs(self.driving) - self.static <= EQUAL * parts:
            return 0
        return 1 if self.driving > 0.0 else -1

    def _begin_arc(self, net: float | None = None) -> None:
        """Begin an arc at the present state; `net` is the net force of a slip, where known better.

        The arc's end is kept as its age there.
        """
        if net is None:
            net = self.driving - self.mode * self.mu_k * self.normal
        self.arc = {
            "x": self.x,
            "z": self.z,
            "u": self.u,
            "net": net,
            "age": 0.0,
            "work": self.work,
            "heat": self.heat,
        }
        if self.mode:
            self.arc["end"], self.arc["touches"] = self._slip().stop()
        elif self._loose():
            self.arc["end"] = 0.0
        elif self.p["v"] == 0.0:
            self.arc["end"] = math.inf
        else:
            v = self.p["v"]
            reach = math.copysign(self.static, v) - self.driving
            self.arc["end"] = max(reach / (self.p["k"] * v), 0.0)

    def _slip(self) -> Slip:
        return Slip(self.p, self.damping, self.mode, self.arc["net"], self.arc["u"])

    def change(self, values: Mapping[str, float]) -> None:
        """Put values in force, at the present state."""
        self._note_peak()
        self.tuning += 0.5 * (values.get("k", self.p["k"]) - self.p["k"]) * self.z**2
        self.p.update(values)
        self.before += self.arc["age"]
        self._begin_arc()

    def advance(self, now: float, h: float) -> None:
        """Move on by h [s] from the time `now`."""
        left = h
        early = "instants" in self.conventions
        while left > 0.0:
            rest = max(self.arc["end"] - self.arc["age"], 0.0)
            over = rest < left or (rest == left and early == (self.mode == 0))
            part = rest if over else left
            self._move(self.arc["end"] if over else self.arc["age"] + part)
            if self.since >= 0.0:
                self.since += part
            left -= part
            if over:
                self.meter["t_event"] = now + (h - left)
                if self.mode:
                    self._stop()
                else:
                    self._break_away()

    def _move(self, age: float) -> None:
        """Set the state to an age of the arc [s]."""
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
        spring = momentum + (dry - p["F_ext"]) * age + self.damping * way
        work = p["v"] * spring
        kinetic = 0.5 * p["m"] * (self.u + arc["u"]) * (self.u - arc["u"])
        stored = 0.5 * p["k"] * (self.z + arc["z"]) * grown
        self.work = arc["work"] + work
        self.heat = arc["heat"] + (work + p["F_ext"] * way - kinetic - stored)

    def _break_away(self) -> None:
        v, loose = self.p["v"], self._loose()
        length = self.before + self.arc["age"]
        if not (self.first and "first stick" in self.conventions):
            self.meter["t_stick"] = length
        self.first = False
        self._count_period()
        if loose:
            self._begin_slip(loose)
        else:
            direction = 1 if v > 0.0 else -1
            self.z = (direction * self.static - self.p["F_ext"]) / self.p["k"]
            gap = (self.p["mu_s"] - self.mu_k) * self.normal
            self._begin_slip(direction, direction * gap)

    def _count_period(self) -> None:
        if self.since > 0.0:
            self.meter["T"] = self.since
            self.meter["f"] = 1.0 / self.since
        self.since = 0.0

    def _begin_slip(self, direction: int, net: float | None = None) -> None:
        self.mode = direction
        self.before = 0.0
        self.from_x, self.from_z, self.peak = self.x, self.z, self.u
        self._begin_arc(net)

    def _note_peak(self) -> None:
        """Remember the extreme velocity of the arc up to its age."""
        if self.mode:
            slip, age = self._slip(), self.arc["age"]
            greatest = min(slip.turns()[0], age)
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
            self.mode = 0
            self.before = 0.0
            self._begin_arc()

    def outputs(self) -> dict[str, float]:
        """Return the outputs [SI]."""
        friction = -self.driving
        if self.mode:
            friction = -(self.mode * self.mu_k * self.normal + self.damping * self.u)
        return {
            "x": self.x,
            "x_dot": self.u,
            "x_pull": self.x + self.z,
            "z": self.z,
            "F": self.p["k"] * self.z,
            "F_friction": friction,
            "F_s": self.static,
            "sticking": self.mode == 0,
            "mode": self.mode,
            "n_slips": self.count,
            "W_pull": self.work,
            "W_k": self.tuning,
            "Q_friction": self.heat,
            "mu_k_used": self.mu_k,
            **self.meter,
        }
