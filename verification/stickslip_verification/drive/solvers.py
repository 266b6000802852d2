"""Sliders as people write them: honest solvers, whose errors an FMU's are compared with.

Each integrates the model of a case by a common method: fixed steps that locate no event, or a
method that adapts its steps and locates them. They are right and only so accurate.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import Any, Final

import numpy as np

from ..model.verdict import Run
from ..suite.cases import Case

Method = Callable[
    [Callable[[float, float], float], float, float, float, float], tuple[float, float]
]
"""From acceleration(z, x_dot), z, x_dot, v, h: the displacement and the velocity after a step."""

LATE: Final = ", late"  # end of the name of a solver that breaks away late
SHARES: Final = ("x", "x_dot", "F")  # the outputs that they have

_EQUAL: Final = 1e-14
_MOST_PHASES: Final = 200  # in one communication step; more are a chattering that never ends
_MOST_IN_STEP: Final = 10  # in one step of a method
_FARTHEST: Final = 1e9  # elongation of a spring [m] beyond which a model has no bounds


def _semi_implicit(a: Any, z: float, u: float, v: float, h: float) -> tuple[float, float]:
    after = u + h * a(z, u)
    return h * after, after


def _euler(a: Any, z: float, u: float, v: float, h: float) -> tuple[float, float]:
    return h * u, u + h * a(z, u)


def _verlet(
    a: Any, z: float, u: float, v: float, h: float, late: bool = False
) -> tuple[float, float]:
    before = a(z, u)
    way = h * u + 0.5 * h * h * before
    return way, u + 0.5 * h * (before + a(z + v * h - way, u if late else u + h * before))


def _implicit_euler(a: Any, z: float, u: float, v: float, h: float) -> tuple[float, float]:
    def missed(after: float) -> float:
        return after - u - h * float(a(z + h * (v - after), after))

    after, secant = u, u + h * a(z, u)
    for _ in range(_MOST_IN_STEP):
        rest, before = missed(after), missed(secant)
        if rest == before:
            break
        after, secant = after - rest * (after - secant) / (rest - before), after
    return h * after, after


def _heun(a: Any, z: float, u: float, v: float, h: float) -> tuple[float, float]:
    first = a(z, u)
    after = u + h * first
    second = a(z + h * (v - u), after)
    return 0.5 * h * (u + after), u + 0.5 * h * (first + second)


def _runge_kutta(a: Any, z: float, u: float, v: float, h: float) -> tuple[float, float]:
    half = 0.5 * h
    u_1, a_1 = u, a(z, u)
    u_2 = u + half * a_1
    a_2 = a(z + half * (v - u_1), u_2)
    u_3 = u + half * a_2
    a_3 = a(z + half * (v - u_2), u_3)
    u_4 = u + h * a_3
    a_4 = a(z + h * (v - u_3), u_4)
    return (
        h / 6.0 * (u_1 + 2.0 * u_2 + 2.0 * u_3 + u_4),
        u + h / 6.0 * (a_1 + 2.0 * a_2 + 2.0 * a_3 + a_4),
    )


@dataclass(frozen=True)
class Solver:
    """A slider: a method with steps of `step` [s], or `parts` of each communication step.

    It finds out at the end of a step what has happened in it, or has the events `located`. One that
    is `late` breaks away by the forces at the end of a step. One with a `band` [m/s] takes a
    smaller speed for none, and static friction acts till it is exceeded (the switch model, Leine et
    al. 1998). Without a method SciPy's `adapts` locates events at the tolerance `rtol`, absolute
    `atol` (SI), by default small against the motion; a `bold` one first tries all
    that is left of a communication step.
    """

    method: Method | None = None
    step: float = 0.0
    parts: int = 0
    located: bool = False
    late: bool = False
    band: float = 0.0
    rtol: float = 0.0
    atol: float = 0.0
    adapts: str = "RK45"
    bold: bool = False

    def run(self, case: Case) -> Run:
        """Run a case; the outputs are `SHARES`."""
        return Slider(self, case).run()


_METHODS: Final[Mapping[str, Method]] = {
    "semi-implicit Euler": _semi_implicit,
    "Euler": _euler,
    "Verlet": _verlet,
    "Heun": _heun,
    "Runge-Kutta": _runge_kutta,
    "Verlet, damping late": partial(_verlet, late=True),
    "implicit Euler": _implicit_euler,
}


def _family() -> Iterator[tuple[str, Solver]]:
    def steps(*lengths: float) -> list[tuple[str, dict[str, Any]]]:
        return [(f"{1e3 * length:g} ms", {"step": length}) for length in lengths]

    def parts(*counts: int) -> list[tuple[str, dict[str, Any]]]:
        return [(f"{count} in a step", {"parts": count}) for count in counts]

    for sizes in (steps(1e-3, 3e-4, 1e-4), parts(1, 3, 10, 30)):
        for late, (name, method), (shown, size) in product((False, True), _METHODS.items(), sizes):
            yield f"{name}, {shown}{LATE if late else ''}", Solver(method, late=late, **size)
    for sizes in (steps(1e-3, 3e-4), parts(3, 10)):
        for name, (shown, size) in product(("Heun", "Runge-Kutta"), sizes):
            yield f"{name}, {shown}, events located", Solver(_METHODS[name], located=True, **size)
    for adapts, absolute, tolerances in (
        ("RK45", False, (1e-3, 1e-4, 1e-6, 1e-8, 1e-10)),
        ("RK45", True, (1e-3, 1e-5, 1e-7, 1e-9)),
        ("RK23", False, (1e-3, 1e-5)),
        ("DOP853", False, (1e-4, 1e-7)),
        ("LSODA", False, (1e-4, 1e-6)),
        ("BDF", False, (1e-4, 1e-6)),
    ):
        for rtol in tolerances:
            solver = Solver(rtol=rtol, atol=rtol if absolute else 0.0, adapts=adapts)
            yield f"{adapts}, {rtol:g}{' absolute' if absolute else ''}", solver
    for rtol in (1e-3, 1e-4, 1e-6):
        yield f"RK45, {rtol:g}, whole steps first", Solver(rtol=rtol, bold=True)
    for band in (1e-4, 1e-5, 1e-6):
        solver = Solver(_runge_kutta, step=1e-4, band=band)
        yield f"switch model, {1e3 * band:g} mm/s", solver


SOLVERS: Final[Mapping[str, Solver]] = dict(_family())
"""The family by its names, which say method and step, or tolerance."""

Acceleration = Callable[
    [Mapping[str, float], int, Callable[[float], float]], Callable[[float, float], float]
]
"""From values, direction and friction force at a velocity: the acceleration(z, x_dot) in slip."""


def _of_model(
    p: Mapping[str, float], s: int, friction: Callable[[float], float]
) -> Callable[[float, float], float]:
    m, k, c, force = p["m"], p["k"], p["c"], p["F_ext"]
    return lambda z, u: (k * z + force - s * friction(u) - c * u) / m


class Slider:
    """One slider on its way through a case; `acceleration` is that of another model."""

    def __init__(self, solver: Solver, case: Case, acceleration: Acceleration = _of_model) -> None:
        self.solver, self.case, self.acceleration = solver, case, acceleration
        self.p = dict(case.start)
        self.x, self.z, self.u = (self.p[name] for name in ("x_start", "z_start", "x_dot_start"))
        self.mode = (self.u > 0.0) - (self.u < 0.0)
        self.age = self.p.get("age_start", 0.0)

    def run(self) -> Run:
        """Run the case; the outputs are `SHARES`."""
        rows = []
        first = self._shown()
        for step in self.case.steps:
            self.p |= step.changes
            if self.solver.method is None:
                self._locate(step.h)
            else:
                self._step(self.solver.method, step.h)
            rows.append(self._shown())
        columns = zip(*rows, strict=True)
        return Run(
            np.array(self.case.times),
            {name: np.array(column) for name, column in zip(SHARES, columns, strict=True)},
            dict(zip(SHARES, first, strict=True)),
        )

    def _shown(self) -> tuple[float, float, float]:
        return self.x, self.u, self.p["k"] * self.z

    @property
    def _normal(self) -> float:
        return max(self.p["m"] * self.p["g"] + self.p["load"], 0.0)

    @property
    def _mu_k(self) -> float:
        mu_s, mu_k = self.p["mu_s"], self.p["mu_k"]
        return mu_k if mu_k <= mu_s else max(mu_s - 0.01, 0.0)

    def _break_away_force(self, age: float) -> float:
        """Return the break-away force [N] at an age of the stick [s]."""
        p, mu_k = self.p, self._mu_k
        mu = p["mu_s"]
        if p.get("tau_s"):
            mu = mu_k + (mu - mu_k) * -math.expm1(-age / p["tau_s"])
        if p.get("B"):
            mu += p["B"] * math.log1p(age / p["t_0"])
        return mu * self._normal

    def _slip_friction(self) -> Callable[[float], float]:
        """Return the coefficient in slip at a speed [m/s]."""
        p, mu_k = self.p, self._mu_k
        gap = p["mu_s"] - mu_k
        match p.get("shape"):
            case None:
                return lambda _: mu_k
            case 1.0:
                return lambda u: mu_k + gap * math.exp(-((u / p["v_s"]) ** p["delta"]))
            case 2.0:
                return lambda u: mu_k + gap / (1.0 + u / p["v_s"])
        count = int(p["n_points"]) + 1
        speeds = [0.0, *(p[f"u_{i}"] for i in range(2, count))]
        values = [p[f"mu_{i}"] for i in range(1, count)]
        return lambda u: float(np.interp(u, speeds, values))

    def _acceleration(self) -> Callable[[float, float], float]:
        normal, friction = self._normal, self._slip_friction()
        return self.acceleration(self.p, self.mode, lambda u: normal * friction(abs(u)))

    def _breaks_away(self) -> bool:
        driving = self.p["k"] * self.z + self.p["F_ext"]
        if abs(driving) <= self._break_away_force(self.age) * (1.0 + _EQUAL):
            return False
        self.mode = 1 if driving > 0.0 else -1
        return True

    def _stop(self) -> None:
        self.u, self.mode, self.age = 0.0, 0, 0.0

    def _step(self, method: Method, h: float) -> None:
        count = self.solver.parts or max(1, round(h / self.solver.step))
        h, v = h / count, self.p["v"]
        acceleration = self._acceleration()
        for _ in range(count):
            if self.solver.located:
                self._locate(h)
                continue
            if self.mode == 0:
                if self.solver.late or not self._breaks_away():
                    self.z += v * h
                    self.age += h
                    if self.solver.late and self._breaks_away():
                        acceleration = self._acceleration()
                    continue
                acceleration = self._acceleration()
            slow = self.mode * self.u <= self.solver.band
            applied = self._within_band if slow and self.solver.band else acceleration
            way, after = method(applied, self.z, self.u, v, h)
            self.x += way
            self.z += v * h - way
            self.u = after
            if self.mode * after <= (0.0 if slow else self.solver.band):
                self._stop()

    def _within_band(self, z: float, u: float) -> float:
        driving = self.p["k"] * z + self.p["F_ext"] - self.p["c"] * u
        return (driving - self.mode * self._break_away_force(self.age)) / self.p["m"]

    def _locate(self, left: float) -> None:
        least = _EQUAL * left
        fixed = self.solver.method is not None
        slip = self._cut if fixed else self._adapt
        for _ in range(_MOST_IN_STEP if fixed else _MOST_PHASES):
            if left <= least:
                return
            left -= slip(left) if self.mode or self._breaks_away() else self._rest(left)

    def _cut(self, h: float) -> float:
        """Slip for one step [s], or the part of it after which the mass stops; return how long."""
        assert self.solver.method is not None
        acceleration, v = self._acceleration(), self.p["v"]
        state = self.z, self.u
        way, after = self.solver.method(acceleration, *state, v, h)
        low, high, stops = 0.0, h, self.mode * after <= 0.0
        while stops and high - low > _EQUAL * h:
            middle = 0.5 * (low + high)
            way, after = self.solver.method(acceleration, *state, v, middle)
            low, high = (middle, high) if self.mode * after > 0.0 else (low, middle)
        self.x += way
        self.z += v * high - way
        self.u = after
        if stops:
            self._stop()
        return high

    def _rest(self, left: float) -> float:
        """Stick until the mass breaks away, or for the time left [s]; return for how long."""
        k, v = self.p["k"], self.p["v"]
        driving = k * self.z + self.p["F_ext"]

        def sticks(t: float) -> bool:
            return abs(driving + k * v * t) <= self._break_away_force(self.age + t) * (1.0 + _EQUAL)

        low, high = 0.0, left
        while not sticks(left) and high - low > _EQUAL * left:
            middle = 0.5 * (low + high)
            low, high = (middle, high) if sticks(middle) else (low, middle)
        self.z += v * high
        self.age += high
        return high

    def _adapt(self, left: float) -> float:
        """Slip until the mass stops, or for the time left [s]; return for how long.

        `ValueError` if the motion has no bounds: steps would get ever shorter.
        """
        s, v, rtol = self.mode, self.p["v"], self.solver.rtol
        acceleration = self._acceleration()

        def velocity(_: float, y: Any) -> float:
            if abs(y[0]) > _FARTHEST:
                raise ValueError(f"the spring is stretched by more than {_FARTHEST:g} m")
            return float(s * y[1])

        # It takes half a second to import, which only the processes that solve need.
        from scipy.integrate import solve_ivp

        # SciPy takes an event's options as attributes of the function.
        velocity.terminal, velocity.direction = True, -1  # type: ignore[attr-defined]
        way = max(abs(self.z), 1e-6)
        sizes = (way, max(abs(v), way * math.sqrt(self.p["k"] / self.p["m"])), way)
        solution = solve_ivp(
            lambda _, y: (v - y[1], acceleration(y[0], y[1]), y[1]),
            (0.0, left),
            (self.z, self.u, 0.0),
            rtol=rtol,
            atol=self.solver.atol or [1e-3 * rtol * size for size in sizes],
            method=self.solver.adapts,
            events=velocity,
            first_step=left if self.solver.bold else None,
        )
        self.z, self.u, way = map(float, solution.y[:, -1])
        self.x += way
        if solution.status == 1:
            self._stop()
        return float(solution.t[-1])
