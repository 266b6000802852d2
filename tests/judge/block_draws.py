"""Random blocks for the judge of blocks, and the states from which each of them is started."""

from __future__ import annotations

import math
from dataclasses import dataclass
from random import Random

import numpy as np

from tests.fmu.blocks import log_uniform

BLOCKS = 1000
GRAVITY = 9.81
SLOWEST = 300.0
"""Longest first stick of a relaxed spring, in periods of the mass on it: longer ones cost only."""
DISTURBED = (
    *((1e-3, 0.0), (0.03, 0.0), (0.3, 0.0), (-0.5, 0.3), (0.0, 0.7), (-0.9, 0.0)),
    *((0.0, 0.95), (0.5, 1.5), (2.0, 0.0), (0.0, 5.0)),
)
"""Disturbances of even sliding: of the velocity over v, of the spring over v / w."""


@dataclass(frozen=True)
class Setting:
    """One block: what was drawn, the FMU's friction law, and its parameters with the pull ``v``."""

    number: int
    kind: str
    law: str
    values: dict[str, float]

    @property
    def w(self) -> float:
        return math.sqrt(self.values["k"] / self.values["m"])

    def friction(self, u: float) -> float:
        p = self.values
        shape, mu = p.get("shape", 0), p["mu_k"]
        if shape == 1:
            mu += (p["mu_s"] - mu) * math.exp(-((u / p["v_s"]) ** p["delta"]))
        elif shape == 2:
            mu += (p["mu_s"] - mu) / (1.0 + u / p["v_s"])
        elif shape == 3:
            rest = range(2, int(p["n_points"]) + 1)
            speeds, coefficients = [p[f"u_{i}"] for i in rest], [p[f"mu_{i}"] for i in rest]
            mu = float(np.interp(u, [0.0, *speeds], [p["mu_1"], *coefficients]))
        return mu * p["m"] * GRAVITY

    def hold(self, age: float) -> float:
        p = self.values
        share = -math.expm1(-age / p["tau_s"]) if p.get("tau_s") else 1.0
        growth = p["B"] * math.log1p(age / p["t_0"]) if p.get("B") else 0.0
        return (p["mu_k"] + (p["mu_s"] - p["mu_k"]) * share + growth) * p["m"] * GRAVITY


def setting(number: int) -> Setting:
    draw = Random(f"judge of blocks {number}")
    kind = ("coulomb", "dwell", "dwell reversing", "formula", "curve")[number % 5]
    p = {"m": log_uniform(draw, 0.1, 1e3), "mu_s": log_uniform(draw, 0.05, 1.5)}
    p["k"] = p["m"] * log_uniform(draw, 5.0, 500.0) ** 2
    ratios = {"dwell": (1.02, 2.5), "dwell reversing": (2.5, 12.0)}
    p["mu_k"] = p["mu_s"] / log_uniform(draw, *ratios.get(kind, (1.02, 6.0)))
    w = math.sqrt(p["k"] / p["m"])
    zeta = draw.choice([0.0, log_uniform(draw, 1e-4, 0.3), log_uniform(draw, 1e-2, 0.3)])
    p["c"] = 2.0 * zeta * p["m"] * w
    # A force as large as the gap of friction brings the mass to this speed in the time 1 / w.
    gap = (p["mu_s"] - p["mu_k"]) * GRAVITY / w
    damped = gap / math.sqrt(4.0 * math.pi * (zeta or 0.01))
    if kind == "coulomb":
        v = damped * log_uniform(draw, 0.02, 5.0)
    elif kind.startswith("dwell"):
        p["tau_s"] = log_uniform(draw, 0.05, 50.0) / w
        if draw.random() < 0.2:
            p |= {"B": p["mu_s"] * log_uniform(draw, 0.01, 0.2), "t_0": p["tau_s"]}
            p["tau_s"] *= draw.choice([0.0, 1.0])
        growing = 2.0 * gap / (w * p["tau_s"] or 1.0)
        v = min(damped, growing) * log_uniform(draw, 0.02, 2.0)
    elif kind == "formula":
        p |= {"shape": draw.choice([1, 1, 2]), "delta": draw.choice([1.0, 2.0, 3.0])}
        p["v_s"] = gap * log_uniform(draw, 0.03, 3.0)
        v = p["v_s"] * log_uniform(draw, 0.02, 20.0)
    else:
        p |= _curve(draw, p["mu_s"], p["mu_k"], gap * log_uniform(draw, 0.03, 3.0))
        v = p[f"u_{draw.randint(2, int(p['n_points']))}"] * log_uniform(draw, 0.05, 5.0)
    p["v"] = max(v, p["mu_s"] * GRAVITY / (w * 2.0 * math.pi * SLOWEST))
    return Setting(number, kind, "stribeck" if "shape" in p else "coulomb", p)


def _curve(draw: Random, mu_s: float, mu_k: float, u: float) -> dict[str, float]:
    plateau = draw.random() < 0.6
    mu = [mu_s if plateau else mu_s * draw.choice([1.0, draw.uniform(0.7, 1.0)])]
    mu += mu * plateau + [min(mu_k, mu[0])]
    for low, high in draw.choice([[], [], [(1.0, 2.0)], [(1.0, 2.0), (0.5, 1.0)]]):
        mu.append(mu[-1] * draw.uniform(low, high))
    curve = {"shape": 3, "n_points": len(mu), "mu_1": mu[0]}
    for i in range(2, len(mu) + 1):
        curve |= {f"u_{i}": u, f"mu_{i}": mu[i - 1]}
        u *= draw.uniform(1.1, 3.0)
    return curve


def starts(drawn: Setting) -> list[dict[str, float]]:
    p, k, v = drawn.values, drawn.values["k"], drawn.values["v"]
    even = (drawn.friction(v) + p["c"] * v) / k
    scale = p.get("tau_s") or p.get("t_0") or 0.0
    reach = drawn.hold(10.0 * scale) / k
    disturbed = ((v * (1.0 + faster), even + v / drawn.w * longer) for faster, longer in DISTURBED)
    sliding = [{"x_dot_start": x_dot, "z_start": z} for x_dot, z in disturbed]
    falling = [{"z_start": part * reach} for part in (1.02, 1.5, 2.5, -1.3)]
    parts = (0.02, 0.1, 0.3, 1.0, 3.0)
    ages = [part * (min(scale, reach / v) or 0.2 * reach / v) for part in parts]
    sticks = [{"z_start": drawn.hold(age) / k - v * age} for age in ages]
    if scale:
        falling[-1]["age_start"] = sticks[1]["age_start"] = 0.3 * scale
        sticks[-1] = {"age_start": 3.0 * scale}
    return [{}, *sliding, *falling, *sticks]
