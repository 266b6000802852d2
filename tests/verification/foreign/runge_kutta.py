"""A foreign FMU 2.0 that integrates the slip by Dormand and Prince, events located to 1e-10 / w.

SI, all outputs, able to keep its state. The net force of a slip, e = k z + F_ext - s mu_k N, obeys
e' = k (v - u), the velocity m u' = e - c u.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from tests.verification.foreign.foreign_face import COUNT, FLAG, ForeignFace, Given, Shown

FAULT = ""

STEP = 0.02
"""Internal step in units of 1/max(w, c/m)."""

LOCATED = 1e-10
"""Width to which an event is located, in units of 1/w."""

SLACK = 8.0 * 2.0**-52
"""Part of the forces by which the driving force must exceed static friction to move a mass at
rest."""


class Block:
    """The mass, its phase and the cycle meter; SI."""

    def __init__(self, values: Mapping[str, float], start_time: float) -> None:
        self.p = dict(values)
        self.x = values["x_start"]
        self.u = values["x_dot_start"]
        self.z = values["z_start"]
        # Net force in slip.
        self.e = 0.0
        self.mode = 0
        self.slips = 0
        self.W_pull = self.W_k = self.Q = 0.0
        self.meter = dict.fromkeys(
            ("delta_x", "spring_drop", "t_stick", "t_slip", "T", "f", "x_dot_peak"), 0.0
        )
        self.t_event = start_time
        self.in_phase = 0.0
        # Time since the last break-away; negative before the first.
        self.since_break_away = -1.0
        self.slip_start = [0.0, 0.0]
        self.peak = 0.0
        # Whether the mass has stopped this instant: what drives it on is then no break-away.
        self.just_stopped = False
        if self.u != 0.0:
            direction = 1 if self.u > 0.0 else -1
            self._begin_slip(direction, self._force() - direction * self._kinetic())

    def _force(self) -> float:
        return self.p["k"] * self.z + self.p["F_ext"]

    def _normal(self) -> float:
        return max(self.p["m"] * self.p["g"] + self.p["load"], 0.0)

    def _static(self) -> float:
        return self.p["mu_s"] * self._normal()

    def _mu_k(self) -> float:
        mu_s, mu_k = self.p["mu_s"], self.p["mu_k"]
        return max(mu_s - 0.01, 0.0) if mu_k > mu_s else mu_k

    def _kinetic(self) -> float:
        return self._mu_k() * self._normal()

    def _driven(self) -> int:
        """Return the direction in which a mass at rest is moved at once; 0 if friction holds it."""
        spring, push, static = self.p["k"] * self.z, self.p["F_ext"], self._static()
        if abs(spring + push) - static > SLACK * (abs(spring) + abs(push) + static):
            return 1 if spring + push > 0.0 else -1
        return 0

    def change(self, values: Mapping[str, float]) -> None:
        """Put values in force; the extension stays."""
        self.W_k += (values.get("k", self.p["k"]) - self.p["k"]) * self.z * self.z / 2.0
        self.p.update(values)
        if self.mode != 0:
            self._set_net(self._force() - self.mode * self._kinetic())

    def advance(self, now: float, h: float) -> None:
        """Move on by h [s] from the time `now`."""
        left = h
        while left > 0.0:
            left -= self._stick(now + h, left) if self.mode == 0 else self._slip(now + h, left)

    def _pass(self, dt: float) -> None:
        self.in_phase += dt
        self.just_stopped = False
        if self.since_break_away >= 0.0:
            self.since_break_away += dt

    def _stick(self, end: float, left: float) -> float:
        """Rest for at most `left` [s]; return for how long."""
        k, v = self.p["k"], self.p["v"]
        driven = self._driven()
        if driven:
            if not self.just_stopped:
                self._break_away(end - left)
            self._begin_slip(driven, self._force() - driven * self._kinetic())
            return 0.0
        wait = math.inf
        if v != 0.0:
            wait = max((math.copysign(self._static(), v) - self._force()) / (k * v), 0.0)
        dt = min(wait, left)
        self.W_pull += v * dt * k * (self.z + 0.5 * v * dt)
        self.z += v * dt
        self._pass(dt)
        if wait < left:
            direction = 1 if v > 0.0 else -1
            self.z = (direction * self._static() - self.p["F_ext"]) / k
            self._break_away(end - (left - dt))
            gap = (self.p["mu_s"] - self._mu_k()) * self._normal()
            self._begin_slip(direction, direction * gap)
        return dt

    def _break_away(self, time: float) -> None:
        self.meter["t_stick"] = self.in_phase
        if self.since_break_away > 0.0:
            self.meter["T"] = self.since_break_away
            self.meter["f"] = 1.0 / self.since_break_away
        self.since_break_away = 0.0
        self.t_event = time

    def _begin_slip(self, direction: int, e: float) -> None:
        self.mode = direction
        self.in_phase = 0.0
        self.slip_start = [self.x, self.z]
        self.peak = self.u
        self._set_net(e)

    def _set_net(self, e: float) -> None:
        self.e = e
        if FAULT == "no-external-when-damped" and self.p["c"] > 0.0:
            self.e -= self.p["F_ext"]

    def _slip(self, end: float, left: float) -> float:
        """Slip on for at most `left` [s] by one internal step; return for how long."""
        s, m, k, c = self.mode, self.p["m"], self.p["k"], self.p["c"]
        e, u = self.e, self.u
        w = math.sqrt(k / m)

        def velocity(dt: float) -> float:
            return s * self._moved(e, u, dt)[1]

        def acceleration(dt: float) -> float:
            e_then, u_then, _, _ = self._moved(e, u, dt)
            return s * (e_then - c * u_then) / m

        def located(function: Callable[[float], float], low: float, high: float) -> float:
            return _located(function, low, high, LOCATED / w)

        dt = min(left, STEP / max(w, c / m))
        moved = self._moved(e, u, dt)
        before, after = s * (e - c * u), s * (moved[0] - c * moved[1])
        turn = located(acceleration, 0.0, dt) if before * after < 0.0 else None
        if before > 0.0 and turn is not None:
            self.peak = s * max(s * self.peak, velocity(turn))
        stop = None
        if s * moved[1] <= 0.0:
            stop = located(velocity, turn if before > 0.0 and turn else 0.0, dt)
        elif before < 0.0 and turn is not None and velocity(turn) <= 0.0:
            stop = located(velocity, 0.0, turn)
        if stop is not None:
            dt = stop
            moved = self._moved(e, u, dt)
        self.e, self.u, of_e, of_square = moved
        gone = (self.e - e) / k
        way = self.p["v"] * dt - gone
        self.W_pull += self.p["v"] * (of_e + (k * self.z - e) * dt)
        self.Q += abs(way) * self._kinetic() + c * of_square
        self.z += gone
        self.x += way
        self.peak = s * max(s * self.peak, s * self.u)
        self._pass(dt)
        if stop is not None:
            self._stop(end - (left - dt))
        return dt

    def _moved(self, e: float, u: float, h: float) -> tuple[float, float, float, float]:
        """Return e and u after one step of Dormand and Prince, and the integrals of e and u^2."""
        k, c, m, v = self.p["k"], self.p["c"], self.p["m"], self.p["v"]
        e1, u1 = k * (v - u), (e - c * u) / m
        ub = u + h * u1 / 5.0
        eb = e + h * e1 / 5.0
        e2, u2 = k * (v - ub), (eb - c * ub) / m
        uc = u + h * (3.0 * u1 + 9.0 * u2) / 40.0
        ec = e + h * (3.0 * e1 + 9.0 * e2) / 40.0
        e3, u3 = k * (v - uc), (ec - c * uc) / m
        ud = u + h * (44.0 / 45.0 * u1 - 56.0 / 15.0 * u2 + 32.0 / 9.0 * u3)
        ed = e + h * (44.0 / 45.0 * e1 - 56.0 / 15.0 * e2 + 32.0 / 9.0 * e3)
        e4, u4 = k * (v - ud), (ed - c * ud) / m
        a1, a2, a3, a4 = 19372.0 / 6561.0, 25360.0 / 2187.0, 64448.0 / 6561.0, 212.0 / 729.0
        ue = u + h * (a1 * u1 - a2 * u2 + a3 * u3 - a4 * u4)
        ee = e + h * (a1 * e1 - a2 * e2 + a3 * e3 - a4 * e4)
        e5, u5 = k * (v - ue), (ee - c * ue) / m
        a1, a2, a3 = 9017.0 / 3168.0, 355.0 / 33.0, 46732.0 / 5247.0
        a4, a5 = 49.0 / 176.0, 5103.0 / 18656.0
        uf = u + h * (a1 * u1 - a2 * u2 + a3 * u3 + a4 * u4 - a5 * u5)
        ef = e + h * (a1 * e1 - a2 * e2 + a3 * e3 + a4 * e4 - a5 * e5)
        e6, u6 = k * (v - uf), (ef - c * uf) / m
        b1, b3, b4 = 35.0 / 384.0, 500.0 / 1113.0, 125.0 / 192.0
        b5, b6 = 2187.0 / 6784.0, 11.0 / 84.0
        return (
            e + h * (b1 * e1 + b3 * e3 + b4 * e4 - b5 * e5 + b6 * e6),
            u + h * (b1 * u1 + b3 * u3 + b4 * u4 - b5 * u5 + b6 * u6),
            h * (b1 * e + b3 * ec + b4 * ed - b5 * ee + b6 * ef),
            h * (b1 * u * u + b3 * uc * uc + b4 * ud * ud - b5 * ue * ue + b6 * uf * uf),
        )

    def _stop(self, time: float) -> None:
        self.u = 0.0
        self.slips += 1
        self.t_event = time
        self.meter["t_slip"] = self.in_phase
        self.meter["delta_x"] = self.x - self.slip_start[0]
        self.meter["spring_drop"] = self.slip_start[1] - self.z
        self.meter["x_dot_peak"] = self.peak
        self.mode = 0
        self.in_phase = 0.0
        self.just_stopped = True

    def outputs(self) -> dict[str, float]:
        """Return the outputs [SI]."""
        mode = self.mode or self._driven()
        slipping = -(mode * self._kinetic() + self.p["c"] * self.u)
        return {
            "x": self.x,
            "x_dot": self.u,
            "x_pull": self.x + self.z,
            "z": self.z,
            "F": self.p["k"] * self.z,
            "F_friction": slipping if mode else -self._force(),
            "F_s": self._static(),
            "sticking": mode == 0,
            "mode": mode,
            **self.meter,
            "n_slips": self.slips,
            "t_event": self.t_event,
            "W_pull": self.W_pull,
            "W_k": self.W_k,
            "Q_friction": self.Q,
            "mu_k_used": self._mu_k(),
        }


def _located(function: Callable[[float], float], low: float, high: float, width: float) -> float:
    """Return a zero between `low` and `high`, bracketed to `width`, by regula falsi (Illinois)."""
    at_low, at_high = function(low), function(high)
    if at_high == 0.0:
        return high
    side = 0
    while high - low > width:
        middle = high - at_high * (high - low) / (at_high - at_low)
        if not low < middle < high:
            middle = 0.5 * (low + high)
        value = function(middle)
        if value == 0.0:
            return middle
        if (value > 0.0) == (at_high > 0.0):
            high, at_high = middle, value
            if side == 1:
                at_low *= 0.5
            side = 1
        else:
            low, at_low = middle, value
            if side == -1:
                at_high *= 0.5
            side = -1
    return high if abs(at_high) < abs(at_low) else low


class RungeKutta(ForeignFace):
    """The integrated block behind its face."""

    fixed = (
        Given("m", "mass", "kg", 1.0),
        Given("g", "gravity", "m/s2", 9.81),
        Given("x_start", "x0", "m", 0.0),
        Given("x_dot_start", "xd0", "m/s", 0.0),
        Given("z_start", "extension0", "m", 0.0),
    )
    tunable = (
        Given("k", "stiffness", "N/m", 1000.0),
        Given("c", "damping", "N.s/m", 0.0),
        Given("mu_s", "mu_static", "1", 0.5),
        Given("mu_k", "mu_kinetic", "1", 0.3),
    )
    inputs = (
        Given("v", "pull", "m/s", 0.02),
        Given("load", "normal_load", "N", 0.0),
        Given("F_ext", "push", "N", 0.0),
    )
    shows = (
        Shown("x", "position", "m"),
        Shown("x_dot", "velocity", "m/s"),
        Shown("x_pull", "pulled_end", "m"),
        Shown("z", "extension", "m"),
        Shown("F", "spring_force", "N"),
        Shown("F_friction", "friction_force", "N"),
        Shown("F_s", "static_limit", "N"),
        Shown("sticking", "stuck", FLAG),
        Shown("mode", "direction", COUNT),
        Shown("delta_x", "jump", "m"),
        Shown("spring_drop", "relief", "m"),
        Shown("t_stick", "stick_time", "s"),
        Shown("t_slip", "slip_time", "s"),
        Shown("T", "period", "s"),
        Shown("f", "frequency", "Hz"),
        Shown("x_dot_peak", "peak_velocity", "m/s"),
        Shown("n_slips", "slips", COUNT),
        Shown("t_event", "last_event", "s"),
        Shown("W_pull", "work_of_pull", "J"),
        Shown("W_k", "work_of_tuning", "J"),
        Shown("Q_friction", "heat", "J"),
        Shown("mu_k_used", "mu_kinetic_used", "1"),
    )

    def make_block(self) -> Block:
        """Return the block at its start."""
        return Block(self.given, self.start_time)

    def _get_fmu_state(self) -> dict[str, Any]:
        state = super()._get_fmu_state()
        if FAULT == "state-loses-pending" and self.block is not None:
            state["given"] = dict(self.block.p)
        return state
