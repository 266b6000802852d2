"""Settings that the benchmarks draw, and the yardsticks that compute them otherwise."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from random import Random
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from stickslip_design.chunks import Columns
from stickslip_fmu.block import Block
from stickslip_fmu.laws.stribeck.law import STRIBECK
from stickslip_fmu.spec import SPEC, spec_of
from stickslip_ref import Parameters, coulomb_limit

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Busy:
    """A study whose points keep a core busy: so many sines of 1000 numbers each, 4 us one."""

    count: int
    work: int = 0
    quantum: int = 1

    @property
    def identity(self) -> Mapping[str, Any]:
        """The results depend on the work alone."""
        return {"work": self.work}

    def compute(self, start: int, stop: int) -> Columns:
        """Return a number a point."""
        x = np.linspace(0.0, 1.0, 1000)
        sums = np.zeros(stop - start)
        for index in range(stop - start):
            for _ in range(self.work):
                sums[index] += np.sin(x * (start + index)).sum()
        return {"x": sums}


def undamped(count: int) -> Parameters:
    """Return machines of all sizes without damping."""
    random = np.random.default_rng(2)
    k = 10.0 ** random.uniform(1.0, 8.0, count)
    m = 10.0 ** random.uniform(-2.0, 4.0, count)
    v = 10.0 ** random.uniform(-6.0, 1.0, count)
    mu_s = 10.0 ** random.uniform(-2.0, 0.17, count)
    mu_k = mu_s * (1.0 - 10.0 ** random.uniform(-3.0, 0.0, count))
    return Parameters(m=m, k=k, v=v, mu_s=mu_s, mu_k=mu_k)


def damped(count: int) -> Parameters:
    """Return damped machines, each pulled below its critical velocity: all have a cycle."""
    p, random = undamped(count), np.random.default_rng(3)
    c = 2.0 * 10.0 ** random.uniform(-4.0, -0.1, count) * np.sqrt(p.k * p.m)
    still = Parameters(m=p.m, k=p.k, c=c, mu_s=p.mu_s, mu_k=p.mu_k)
    v = coulomb_limit(still) * 10.0 ** random.uniform(-6.0, -1e-3, count)
    return Parameters(m=p.m, k=p.k, c=c, mu_s=p.mu_s, mu_k=p.mu_k, v=v)


def under_stribeck(count: int) -> dict[str, list[float]]:
    """Return settings of mass, stiffness, pull and Stribeck velocity over orders of magnitude."""
    draw = Random(1)
    ranges = {"m": (0.1, 10.0), "k": (1e2, 1e5), "v": (1e-4, 0.1), "v_s": (1e-3, 1.0)}
    return {
        name: [math.exp(draw.uniform(math.log(low), math.log(high))) for _ in range(count)]
        for name, (low, high) in ranges.items()
    }


def block_of(law: str, **values: float) -> Block:
    """Return the Python block under a friction law."""
    spec = SPEC if law == "coulomb" else spec_of(STRIBECK)
    block = spec.model(spec.values({**spec.table.start_values(), **values}))
    assert isinstance(block, Block)
    return block


def at_break_away(values: Mapping[str, float]) -> Block:
    """Return a block under Stribeck's law at its first break-away."""
    block = block_of("stribeck", **values)
    block.advance(0.0, block.state.arc.duration)
    return block


def integrated_slip(m: float, k: float, v: float, v_s: float) -> None:
    """Follow a slip under Stribeck's law by SciPy's DOP853, from break-away to the first stop."""
    normal = m * 9.81

    def slope(_: float, state: tuple[float, float]) -> tuple[float, float]:
        z, speed = state
        friction = normal * (0.3 + 0.2 * math.exp(-((speed / v_s) ** 2)))
        return v - speed, (k * z - friction) / m

    def stop(_: float, state: tuple[float, float]) -> float:
        return state[1]

    stop.terminal = True  # type: ignore[attr-defined]
    stop.direction = -1.0  # type: ignore[attr-defined]
    start = (0.5 * normal / k, 0.0)
    longest = 1e3 * math.sqrt(m / k)
    solve_ivp(slope, (0.0, longest), start, "DOP853", events=stop, rtol=1e-9, atol=1e-12)


def plain_steady_cycle(
    m: Array, g: float, k: Array, mu_s: Array, mu_k: Array, v: Array
) -> tuple[Array, ...]:
    """Return every field of `steady_cycle` for c = 0 and v > 0, theory.md (2) and (6)-(11).

    As a competent reader writes it in NumPy.
    """
    weight = m * g
    delta = (mu_s - mu_k) * weight / k
    w = np.sqrt(k / m)
    lambda_ = w * delta / v
    spring_drop = 2.0 * delta
    t_slip = (2.0 / w) * (np.pi - np.arctan(lambda_))
    t_stick = spring_drop / v
    delta_x = spring_drop + v * t_slip
    period = t_stick + t_slip
    peak = v * (1.0 + np.sqrt(1.0 + lambda_ * lambda_))
    of_time = (t_slip, t_stick, period, 1.0 / period, peak, np.isfinite(period))
    return (mu_s * weight, delta, lambda_, spring_drop, delta_x, *of_time)
