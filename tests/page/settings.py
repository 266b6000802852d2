"""Random settings of the page, and settings far outside its sliders. All values SI."""

import math
import tomllib
import warnings
from collections.abc import Iterator, Mapping
from importlib.resources import files
from random import Random
from typing import Any

from stickslip_ref import FrictionClampWarning, Parameters, critical_lambda
from tests.fmu.blocks import log_uniform

NAMES = ("m", "g", "load", "k", "c", "mu_s", "mu_k", "v")
Setting = Mapping[str, float]


def batch(seed: str, undamped: int, damped: int, critical: int) -> Iterator[dict[str, float]]:
    """Draw so many settings of each kind; the seed names them for ever."""
    draw = Random(seed)
    for count, kind in ((undamped, block), (damped, with_damping), (critical, near_critical)):
        for _ in range(count):
            yield kind(draw)


def block(draw: Random) -> dict[str, float]:
    """Draw what the sliders reach, undamped; mu_k below, at and above mu_s."""
    mu_s = draw.uniform(0.02, 1.5)
    gap = log_uniform(draw, 1e-3, 1.0)
    return {
        "m": log_uniform(draw, 0.01, 100.0),
        "g": draw.uniform(1.0, 30.0),
        "load": draw.choice([0.0, log_uniform(draw, 0.1, 1e3)]),
        "k": log_uniform(draw, 10.0, 1e4),
        "c": 0.0,
        "mu_s": mu_s,
        # Sometimes no gap, or a coefficient that will be clamped.
        "mu_k": mu_s * (1.0 - draw.choice([gap] * 17 + [0.0, -gap, -gap])),
        "v": log_uniform(draw, 1e-4, 0.2),
    }


def with_damping(draw: Random) -> dict[str, float]:
    """Draw a damping ratio of 1e-4 to 3: with a cycle, without one, and over-damped."""
    return damped_by(log_uniform(draw, 1e-4, 3.0), block(draw))


def near_critical(draw: Random) -> dict[str, float]:
    """Draw a speed beside the critical one, from 2e-9 of it to 0.9: stops that graze."""
    p = damped_by(log_uniform(draw, 1e-4, 0.9), block(draw))
    p["mu_k"] = p["mu_s"] * (1.0 - log_uniform(draw, 1e-3, 1.0))
    distance = draw.choice((1.0, -1.0)) * log_uniform(draw, 2e-9, 0.9)
    own = Parameters(**p)
    p["v"] = float(own.w * own.Delta / critical_lambda(own.zeta)) / (1.0 + distance)
    return p


def wide(draw: Random) -> dict[str, float]:
    """Draw what only typing reaches: from a brake to a fault in rock, lambda from 1e-5 to 1e9."""
    mu_s = log_uniform(draw, 0.01, 1.5)
    p = {
        "m": log_uniform(draw, 1e-3, 1e6),
        "g": log_uniform(draw, 0.1, 1e3),
        "load": 0.0,
        "k": log_uniform(draw, 1.0, 1e8),
        "c": 0.0,
        "mu_s": mu_s,
        "mu_k": mu_s * (1.0 - log_uniform(draw, 1e-3, 1.0)),
    }
    own = Parameters(**p)
    p["v"] = max(float(own.w * own.Delta) / log_uniform(draw, 1e-5, 1e9), 1e-9)
    return damped_by(log_uniform(draw, 1e-6, 30.0), p) if draw.random() < 0.5 else p


def damped_by(zeta: float, p: Setting) -> dict[str, float]:
    return {**p, "c": 2.0 * zeta * math.sqrt(p["k"] * p["m"])}


def table(section: str, rows: str) -> list[dict[str, Any]]:
    """Return the table of a section of the page, such as its applications, as it is written."""
    file = files("stickslip.page") / section / f"{section}.toml"
    found: list[dict[str, Any]] = tomllib.loads(file.read_text(encoding="utf-8"))[rows]
    return found


PRESETS = {
    row["id"]: {name: float(row[name]) for name in NAMES}
    for row in table("applications", "application")
}
START = PRESETS["default"]

CORNERS = {
    "frictionless": {"mu_s": 0.0, "mu_k": 0.0},
    "clamped to no gap": {"mu_s": 0.0, "mu_k": 0.3},
    "clamped to 0": {"mu_s": 0.005, "mu_k": 0.3},
    "kinetic friction 0": {"mu_s": 0.5, "mu_k": 0.0},
    "no gap": {"mu_s": 0.5, "mu_k": 0.5},
    "no gap, damped": {"mu_s": 0.5, "mu_k": 0.5, "c": 1.0},
    "frictionless, damped": {"mu_s": 0.0, "mu_k": 0.0, "c": 1.0},
    # c^2 = 4 k m exactly.
    "critically damped": {"k": 1024.0, "c": 64.0},
    "a hair below critical damping": {"k": 1024.0, "c": 64.0 * (1.0 - 2.0**-52)},
    "a hair above critical damping": {"k": 1024.0, "c": 64.0 * (1.0 + 2.0**-52)},
    "far above critical damping": {"c": 1e5},
    "slowest and stiffest": {"k": 1e8, "v": 1e-9},
    "slowest and softest": {"k": 10.0, "v": 1e-9},
    "fastest": {"v": 1e3},
}
"""Settings where a formula takes another branch or comes to its end; the rest as the FMU starts."""
CORNERS = {name: {**START, **values} for name, values in CORNERS.items()}


def parameters(p: Setting) -> Parameters:
    """Return a setting for the reference, mu_k clamped without a word."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FrictionClampWarning)
        return Parameters(**p)
