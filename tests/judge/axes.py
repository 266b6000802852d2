"""A judge of feed axes that shares nothing with the code it judges: their motion in small steps.

An axis is linear but for dry friction, and the matrix exponential is exact for a friction that is
constant over a step. That friction is what the law gives at the mean velocity of the step (second
order, without numerical damping), or what stops the table, or holds it up to static friction (time
stepping, J. J. Moreau 1988). No event is searched for: a step with a stop or a break-away in it
takes both frictions, by their shares. `steep` is the second opinion: a stiff solver.

Equations: docs/feed-axis.md (1), (2), docs/theory.md (1), (19), (26). Encoders are exact. The first
stick of a start from rest has age 0.
"""

from __future__ import annotations

import math
from bisect import bisect
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, Literal

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import expm

Tables = dict[str, Any]
"""The tables of an axis file; a curve as a list of points (speed [mm/s], mu)."""
Start = Literal["rest", "jumps", "near"]
"""From rest, spring relaxed; from rest at twice the break-away force; 1 % off even motion."""

UNITS = {"": 1.0, "kg": 1.0, "N": 1.0, "kN": 1e3, "N s/m": 1.0, "kN s/m": 1e3, "N/um": 1e6}
UNITS |= {"s": 1.0, "ms": 1e-3, "1/s": 1.0, "Hz": 1.0, "m/min/mm": 1e3 / 60.0, "%": 0.01}
UNITS |= {"mm": 1e-3, "um": 1e-6, "mm/s": 1e-3, "mm/min": 1e-3 / 60.0, "m/s2": 1.0}
AT_MOTOR = {"kg cm2": (1e-4, 2), "N m": (1.0, 1), "N m s/rad": (1.0, 2)}
"""Units at the motor, and the power of 2 pi / pitch that brings them to the slide."""

FINE = 0.08
"""Largest step times the fastest angular frequency: damping is off by FINE**2 / 12 of itself."""
EVEN = 1e-4
"""A swing by less than this part of the feed that fades is even motion."""
ROUNDING = 1e-9
"""A swing by less is rounding: what grows does not come down to it."""
STEADY = 2e-3
"""Change of a lasting swing between looks, relative; one that only lingers changes ever faster."""
REPEATS = 0.02
"""Change of a stick between looks, relative: samples of the controller cut the sticks unevenly."""
ENOUGH = 3
"""Sticks in a look that are compared."""
MOST = 600_000
"""Steps of one run."""


@dataclass(frozen=True)
class Seen:
    """What a start settles to: "unsettled" where nothing lasted, or a stick came now and then only.

    The amplitude is half the range of the table's velocity over the feed; frequency [Hz] of swings;
    jump [m], period and stick [s] are means, `longest` is the longest jump: longer and shorter ones
    may take turns. Sticks that never repeat have `repeats` False.
    """

    kind: Literal["even", "swings", "sticks", "unsettled"]
    amplitude: float = 0.0
    frequency: float = math.nan
    jump: float = math.nan
    longest: float = math.nan
    period: float = math.nan
    reverses: bool = False
    t_stick: float = math.nan
    sticks: int = 0
    repeats: bool = True


def quantity(value: str | float, ratio: float = 1.0) -> float:
    amount, _, unit = str(value).partition("±")[0].strip().partition(" ")
    scale, power = AT_MOTOR.get(unit) or (UNITS[unit], 0)
    return float(amount) * scale * ratio**power


class Guideway:
    """Dry friction of the guideway [N] under a normal force N."""

    def __init__(self, friction: Tables, N: float, ratio: float) -> None:
        curve: list[tuple[float, float]] = friction.get("curve", [])
        self.points = [(1e-3 * u, mu * N) for u, mu in curve]
        self.speeds = [u for u, _ in self.points]
        slowest = curve[0][1] if curve else math.nan
        self.F_s, self.F_k = (quantity(friction.get(mu, slowest)) * N for mu in ("mu_s", "mu_k"))
        if "F_s" in friction:
            self.F_s, self.F_k = (quantity(friction[F], ratio) for F in ("F_s", "F_k"))
        self.v_s = quantity(friction.get("v_s", 0.0))
        self.delta = quantity(friction.get("delta", 2.0))
        self.hyperbolic = friction.get("shape") == "hyperbolic"
        self.tau_s = quantity(friction.get("tau_s", 0.0))
        self.B = quantity(friction.get("B", 0.0)) * N
        self.t_0 = quantity(friction.get("t_0", 1.0))

    def slides(self, u: float) -> float:
        if self.points:
            i = min(max(bisect(self.speeds, u), 1), len(self.points) - 1)
            (u_0, F_0), (u_1, F_1) = self.points[i - 1 : i + 1]
            return F_0 + (F_1 - F_0) * min(max((u - u_0) / (u_1 - u_0), 0.0), 1.0)
        if not self.v_s:
            return self.F_k
        q = u / self.v_s
        falls = 1.0 / (1.0 + q) if self.hyperbolic else math.exp(-math.pow(q, self.delta))
        return self.F_k + (self.F_s - self.F_k) * falls

    def holds(self, age: float) -> float:
        if not (self.tau_s or self.B):
            return self.F_s
        fresh = math.exp(-age / self.tau_s) if self.tau_s else 0.0
        return self.F_s - (self.F_s - self.F_k) * fresh + self.B * math.log1p(age / self.t_0)


class Motion:
    """An axis at a feed from a start; its state is [z, w, u, x, F, integral, last nut, ...].

    z is the spring's extension, w and u the speeds of nut and table, x the table, F the motor's
    force behind its lag, then the forces under way (dead time) and the memory of the filters. On a
    rigid drive the force is the acceleration of the nut.
    """

    def __init__(self, axis: Tables, feed: str | float, start: Start) -> None:
        table, drive = axis["axis"], axis.get("drive", {"kind": "rigid"})
        ratio = 2.0 * math.pi / quantity(drive.get("pitch", 1.0))
        self.m, stiffness = quantity(table["mass"]), table["stiffness"]
        self.k = min(map(quantity, stiffness if isinstance(stiffness, list) else [stiffness]))
        self.c = 2.0 * quantity(table.get("zeta", 0.0)) * math.sqrt(self.k * self.m)
        self.c += quantity(table.get("c", 0.0))
        self.along = quantity(table.get("force_along", 0.0))
        N = self.m * quantity(table.get("gravity", 9.81)) + quantity(table.get("load", 0.0))
        self.guideway = Guideway(axis["friction"], N, ratio)
        self.v, self.t = quantity(feed), 0.0
        self.rigid = drive.get("kind") == "rigid"
        demand = {} if self.rigid else axis.get("demand", {})
        self.acceleration = quantity(demand.get("acceleration", math.inf))
        self.lag = self.dry = self.T_s = late = 0.0
        self.filters: list[tuple[list[float], list[float]]] = []
        self.w = math.sqrt(self.k / self.m)
        self.slow = 40.0 * math.pi / self.w
        if not self.rigid:
            self._drive(drive, ratio)
            late = quantity(drive.get("dead_time", 0.0)) / self.T_s
        h = self._longest(N)
        if self.rigid:
            self.T_s = 8.0 * h
        # Within a sample the force of an earlier one acts first: two lengths of steps.
        self.behind = math.floor(late + 1e-9)
        part = max(late - self.behind, 0.0)
        self.parts = [
            (n := math.ceil(length / h), length / max(n, 1))
            for length in (self.T_s * part, self.T_s * (1.0 - part))
        ]
        self._cut()
        self.state = [0.0] * (8 + self.behind + 2 * len(self.filters))
        self.age = self.offset = self.R = self.D = 0.0
        self.slipped: list[tuple[float, float, float]] = []
        self.passed: list[float] = []
        if start != "rest":
            self._under_way(start)

    def _drive(self, drive: Tables, ratio: float) -> None:

        def at_slide(key: str, default: float = 0.0) -> float:
            return quantity(drive.get(key, default), ratio)

        self.m_d, self.d, self.dry = map(at_slide, ("inertia", "viscous_friction", "dry_friction"))
        self.T_s = quantity(drive.get("sample_time", "0.25 ms"))
        self.K_v, self.K_p = at_slide("K_v"), at_slide("velocity_gain")
        self.K_p = self.K_p or at_slide("bandwidth") * self.m_d
        self.T_n = at_slide("integral_time", 4.0 * self.m_d / self.K_p)
        self.on_table = drive.get("position", "table") == "table"
        self.f_v, self.F_c = at_slide("velocity_feedforward", 1.0), at_slide("friction_feedforward")
        self.dead_band, self.F_max = at_slide("dead_band"), at_slide("limit", math.inf)
        self.lag = at_slide("current_lag")
        self.filters = [_filter(one, self.T_s) for one in drive.get("filter", ())]
        self.w = math.sqrt(self.k / self.m + self.k / self.m_d)
        self.slow += 4.0 / self.K_v + 4.0 * self.T_n

    def _longest(self, N: float) -> float:
        speeds = np.linspace(0.0, 4.0 * self.v, 800)
        friction = np.array([self.guideway.slides(u) for u in speeds])
        steepest = float(np.abs(np.diff(friction)).max() / speeds[1])
        # The friction of a step is found by iteration, which halves its error at least.
        h = min(FINE / self.w, 0.5 * self.m / max(steepest, 1e-9 * N))
        # A stick that loads the spring by the gap of friction lasts some steps.
        gap = self.guideway.F_s - min([F for _, F in self.guideway.points] or [self.guideway.F_k])
        return max(min(h, 0.2 * gap / (self.k * self.v)), 0.4 * h)

    def system(self) -> np.ndarray:
        """Return d/dt of (z, w, u, x, F) for these and (R, D, command, 1)."""
        A = np.zeros((9, 9))
        A[0, [1, 2]] = 1.0, -1.0
        A[1, 7] = self.rigid
        if not self.rigid:
            A[1, [0, 1, 6]] = -self.k / self.m_d, -self.d / self.m_d, -1.0 / self.m_d
            A[1, 4 if self.lag else 7] = 1.0 / self.m_d
        A[2, [0, 2, 5, 8]] = self.k / self.m, -self.c / self.m, -1.0 / self.m, self.along / self.m
        A[3, 2] = 1.0
        # Without a lag F is not used, and fades.
        A[4, [4, 7]] = -1.0 / (self.lag or self.T_s), 1.0 / (self.lag or self.T_s)
        return A

    def _cut(self) -> None:
        self.rows = [expm(self.system() * h)[:5].tolist() for _, h in self.parts]

    def _under_way(self, start: Start) -> None:
        v, u = self.v, 0.0 if start == "jumps" else 1.01 * self.v
        # Twice what holds: beyond all that a cycle reaches, and the first slip still stops.
        pull = self.guideway.slides(v) + self.c * v if u else 2.0 * self.guideway.F_s
        z, F, integral = (pull - self.along) / self.k, 0.0, 0.0
        self.t = v / self.acceleration
        if not self.rigid:
            F = self.k * z + self.d * v + self.dry
            lack = 0.0 if self.T_n else (F - self.F_c) / self.K_p
            integral = F - self.F_c - self.K_p * lack
            error = (lack + (1.0 - self.f_v) * v) / self.K_v
            self.offset = error + (0.0 if self.on_table else z) - 0.5 * v * self.t
        self.state = [z, v, u, 0.0, F, integral, z - v * self.T_s, *[F] * (self.behind + 1)]
        for b, a in self.filters:
            later = (b[2] - a[1]) * F
            self.state += [(b[1] - a[0]) * F + later, later]

    def free(self, slope: float) -> None:
        """Leave out what is not linear but friction; its `slope` [N s/m] damps the table."""
        self.dry, self.dead_band, self.F_max, self.c = 0.0, 0.0, math.inf, self.c + slope
        self._cut()

    def command(self) -> None:
        z, w, _, x, _, integral, last, *under_way = self.state
        ramp = self.v / self.acceleration
        if self.rigid:
            later = self.t + self.T_s
            speed = self.v if later >= ramp else self.acceleration * later
            self.state[7] = (speed - w) / self.T_s
            return
        t = min(self.t, ramp)
        speed = self.v if self.t >= ramp else self.acceleration * t
        position = self.offset + 0.5 * speed * t + self.v * (self.t - t)
        error = position - (x if self.on_table else x + z)
        acted_on = error if abs(error) > self.dead_band else 0.0
        lack = self.K_v * acted_on + self.f_v * speed - (x + z - last) / self.T_s
        grows = self.K_p * self.T_s / self.T_n * lack if self.T_n else 0.0
        force = self.K_p * lack + integral + grows + (self.F_c if speed else 0.0)
        limited = min(max(force, -self.F_max), self.F_max)
        if limited == force or limited * grows <= 0.0:
            integral += grows
        memory: list[float] = []
        for n, (b, a) in enumerate(self.filters):
            s, r = under_way[self.behind + 1 + 2 * n :][:2]
            out = b[0] * limited + s
            memory += [b[1] * limited - a[0] * out + r, b[2] * limited - a[1] * out]
            limited = out
        self.state[5:] = [integral, x + z, *under_way[1 : self.behind + 1], limited, *memory]

    def advance(self, samples: int) -> None:
        """Go on; note break-aways (time, place, age), passes of the feed, the speed's range."""
        self.slipped, self.passed = [], []
        low, high = math.inf, -math.inf
        v, k, guideway, dry = self.v, self.k, self.guideway, self.dry
        age, R, D, t = self.age, self.R, self.D, self.t
        holds, slides, close = guideway.holds, guideway.slides, 1e-7 * guideway.F_s
        for _ in range(samples):
            self.t, earlier = t, self.state[7]
            self.command()
            z, w, u, x, F = self.state[:5]
            forces = earlier, self.state[7]
            for (n, h), rows, P in zip(self.parts, self.rows, forces, strict=True):
                (zz, zw, zu, _, zF, zR, zD, zP, z1), (wz, ww, wu, _, wF, wR, wD, wP, w1) = rows[:2]
                (uz, uw, uu, _, uF, uR, uD, uP, u1), (xz, xw, xu, _, xF, xR, xD, xP, x1) = rows[2:4]
                FF, FP = rows[4][4], rows[4][7]
                for _ in range(n):
                    w_new = wz * z + ww * w + wu * u + wF * F + wP * P + w1 + wR * R
                    if dry:
                        D = math.copysign(dry, w)
                        if not w or (w_new + wD * D) * w <= 0.0:
                            D = min(max(-w_new / wD, -dry), dry)
                    free = uz * z + uw * w + uu * u + uF * F + uP * P + u1 + uD * D
                    # What stops the table in this step, or holds it for a part of the step.
                    before, stops, u_new = R, -free / uR, 0.0
                    s, part, grows = math.copysign(1.0, u or stops), 0.0, 0.0
                    if not u:
                        grows, lasts = s * k * w * h, holds(age + h)
                        short = s * stops + 0.5 * grows - lasts
                        if short > 0.0:
                            nears = grows - lasts + holds(age)
                            part = min(max(1.0 - short / nears, 0.0), 0.999) if nears > 0 else 0.0
                            self.slipped.append((t + part * h, x, age + part * h))
                            age = 0.0
                        else:
                            age, part, R = age + h, 1.0, stops
                    if part < 1.0:
                        needs = stops + 0.5 * s * part * grows
                        for _ in range(60):
                            slides_at = max(0.5 * s * (u + free + uR * R), 0.0)
                            guess, R = R, stops - (1.0 - part) * (needs - s * slides(slides_at))
                            if abs(R - guess) <= close:
                                break
                        else:
                            raise ArithmeticError("friction changes too fast for the step")
                        u_new = free + uR * R
                        if s * u_new <= 0.0 < guideway.F_s:
                            # It comes to rest within the step, and rests or goes back at once.
                            rest = u_new / (u_new - u) if u else 0.0
                            age, R, u_new = h * rest, stops, 0.0
                            if s * (k * z + self.along) < -holds(0.0):
                                age, R = 0.0, s * (1.0 - 2.0 * rest) * slides(0.0)
                                u_new = free + uR * R
                    w_new = 0.0 if dry and abs(D) < dry else w_new + wR * (R - before) + wD * D
                    x_new = x + xz * z + xw * w + xu * u + xF * F + xP * P + x1 + xR * R + xD * D
                    z = zz * z + zw * w + zu * u + zF * F + zP * P + z1 + zR * R + zD * D
                    x, F, t = x_new, FF * F + FP * P, t + h
                    if u < v <= u_new:
                        self.passed.append(t - h * (u_new - v) / (u_new - u))
                    low, high = u_new if u_new < low else low, u_new if u_new > high else high
                    w, u = w_new, u_new
            self.state[:5] = z, w, u, x, F
        self.age, self.R, self.D, self.low, self.high, self.t = age, R, D, low, high, t

    def look(self, samples: int) -> Seen:
        self.advance(samples)
        turns, n = len(self.passed) - 1, len(self.slipped) - 1
        seen = Seen("swings", 0.5 * (self.high - self.low) / self.v, reverses=self.low < 0.0)
        if turns > 0:
            seen = replace(seen, frequency=turns / (self.passed[-1] - self.passed[0]))
        if n < 0 and self.low != 0.0:
            return seen
        seen = replace(seen, kind="sticks", frequency=math.nan, sticks=max(n, 0))
        if n < 1:
            return seen
        (t_0, x_0, _), (t_1, x_1, _) = self.slipped[0], self.slipped[-1]
        t_stick = sum(age for _, _, age in self.slipped[1:]) / n
        longest = max(end[1] - begin[1] for begin, end in pairwise(self.slipped))
        seen = replace(seen, jump=(x_1 - x_0) / n, longest=longest)
        return replace(seen, period=(t_1 - t_0) / n, t_stick=t_stick)


def _filter(one: Tables, T_s: float) -> tuple[list[float], list[float]]:
    """Return numerator and denominator (without its 1) of a filter, by the bilinear transform."""
    f, D = quantity(one["frequency"]), one.get("damping")
    g = math.tan(math.pi * f * T_s)
    if "width" in one:
        D = quantity(one["width"]) / (2.0 * f)
    if D is None:
        return [g / (g + 1.0), g / (g + 1.0), 0.0], [(g - 1.0) / (g + 1.0), 0.0]
    leaves, notch = quantity(one.get("leaves", 0.0)), float(one["kind"] == "notch")
    b, a = (
        np.array([g * g + first + second, 2.0 * (g * g - second), g * g - first + second])
        for first, second in ((2.0 * notch * leaves * D * g, notch), (2.0 * D * g, 1.0))
    )
    return (b / a[0]).tolist(), (a[1:] / a[0]).tolist()


def radius(axis: Tables, slope: float = 0.0) -> float:
    """Return by what a disturbance of even sliding grows in a sample; `slope` as in `free`."""
    motion = Motion(axis | {"friction": {"mu_s": 0.0, "mu_k": 0.0}}, 1.0, "rest")
    motion.free(slope)
    rest, ends = motion.state, []
    for start in (np.zeros(len(rest)), *np.eye(len(rest))):
        motion.state, motion.R, motion.t = start.tolist(), 0.0, 0.0
        motion.advance(1)
        ends.append(np.array(motion.state))
    return float(np.abs(np.linalg.eigvals(np.array(ends[1:]) - ends[0])).max())


def carries(axis: Tables) -> float:
    """Return how steeply friction may fall [N s/m] before even sliding is unstable."""
    motion = Motion(axis, 1.0, "rest")
    if motion.rigid:
        return motion.c
    low, high = 0.0, 4.0 * math.sqrt(motion.k * motion.m)
    while high - low > 1e-3 * high:
        fall = 0.5 * (low + high)
        low, high = (fall, high) if radius(axis, -fall) < 1.0 else (low, fall)
    return low


def seen(axis: Tables, feed: str | float, start: Start) -> Seen:
    """Return what a start settles to: looks, each two as long as all before, until three agree."""
    motion = Motion(axis, feed, start)
    ramp = max(motion.v / motion.acceleration - motion.t, 0.0)
    done = math.ceil((ramp + motion.slow) / motion.T_s)
    motion.advance(done)
    looks: list[Seen] = []
    while len(looks) < 3 or done * sum(n for n, _ in motion.parts) < MOST:
        half = done // 2 + 1
        looks = [*looks[-1:], motion.look(half), motion.look(half)]
        last, done = looks[-1], done + 2 * half
        fades = last.amplitude < max(min(EVEN, 0.9 * looks[-2].amplitude), ROUNDING)
        if last.kind == "swings" and fades:
            return Seen("even")
        if len(looks) == 3 and all(_same(look, last) for look in looks[:2]):
            return last
    often = all(look.kind == "sticks" and look.sticks >= ENOUGH for look in looks[1:])
    return replace(last, repeats=_same(looks[1], last)) if often else Seen("unsettled")


def _same(before: Seen, now: Seen) -> bool:
    if before.kind != now.kind:
        return False
    if now.kind == "swings":
        change = abs(now.amplitude - before.amplitude)
        return now.amplitude > EVEN and change < STEADY * now.amplitude
    drift = abs(now.period - before.period) + abs(now.t_stick - before.t_stick)
    # The shortest sticks of all are known to a part of a step, some 0.1 % of a period.
    least = REPEATS * now.t_stick + 0.001 * now.period
    return min(before.sticks, now.sticks) >= ENOUGH and drift < least


def steep(motion: Motion, samples: int, width: float) -> Iterator[tuple[float, float]]:
    """Go on by a stiff solver, friction steep over this part of the feed; give z, u per sample."""
    guideway, narrow, A = motion.guideway, width * motion.v, motion.system()
    gap = guideway.F_s - guideway.slides(0.0)

    def rate(_: float, y: np.ndarray, P: float) -> Any:
        u = y[2] / narrow
        # Static friction is reached at 3 widths, and gone beyond 60.
        friction = guideway.slides(abs(y[2])) + gap * math.exp(-min((u / 30.0) ** 2, 700.0))
        dry = motion.dry * math.tanh(y[1] / narrow)
        return np.dot(A[:5], [*y, friction * math.tanh(u), dry, P, 1.0])

    for _ in range(samples):
        earlier = motion.state[7]
        motion.command()
        for (n, h), P in zip(motion.parts, (earlier, motion.state[7]), strict=True):
            y = motion.state[:5]
            if n:
                # Far below what the steps are off by.
                solved = solve_ivp(rate, (0.0, n * h), y, "LSODA", args=(P,), rtol=1e-8, atol=1e-12)
                motion.state[:5] = solved.y[:, -1].tolist()
        motion.t += motion.T_s
        yield motion.state[0], motion.state[2]
