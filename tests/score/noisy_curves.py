"""Exact motions as a measurement has them: sampled, with Gaussian noise on x, F or both.

Noise is given in percent of a signal's cyclic part: the peak-to-peak of the spring's force over a
steady cycle for F, the same over k for x. A position advances without end, so that its own range
is no scale.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from stickslip_score import Curve
from stickslip_verification import truth
from tests.score.curve_makers import Made, exact, with_defaults

SETTINGS: Mapping[str, Mapping[str, float]] = {
    "default": {},
    "damped": {"c": 2.0, "v": 0.01},
    "stiff axis, backward": {
        "m": 20.0, "k": 5e5, "v": -5e-3, "mu_s": 0.25, "mu_k": 0.15, "load": 30.0, "F_ext": 4.0,
    },
    "mostly slip": {"v": 0.1, "mu_s": 0.4, "mu_k": 0.25},
    "slow": {"v": 2e-3, "k": 4000.0},
}  # fmt: skip
"""lambda is 3.1, 5.6, 1.5, 0.47 and 19."""

SAMPLINGS = (1e-4, 3e-4, 1e-3, 3e-3, 1e-2)
"""Steps between samples [s]."""

NOISES = ((0.0, ""), *((part, on) for part in (1e-4, 1e-3, 1e-2) for on in ("x", "F", "x F")))
"""Part of the cyclic part of a signal, and the signals that carry it."""


@dataclass(frozen=True)
class Cell:
    """A setting, a sampling [s], a noise (part of the cyclic part) and the signals it is on."""

    setting: str
    step: float
    noise: float
    on: str

    def __str__(self) -> str:
        """Name the cell."""
        return f"{self.setting}, {1e3 * self.step:g} ms, {100 * self.noise:g} % on {self.on or '-'}"


CELLS = tuple(
    Cell(setting, step, noise, on)
    for setting in SETTINGS
    for step in SAMPLINGS
    for noise, on in NOISES
)


@dataclass(frozen=True)
class Exact:
    """An exact motion to take records from, the spring's swing [m] and the period [s]."""

    p: dict[str, float]
    made: Made
    swing: float
    period: float


def exact_motion(setting: str, step: float) -> Exact:
    """Give the reference's motion over the first load-up and eight cycles."""
    p = with_defaults(SETTINGS[setting])
    cycle = truth.steady_cycle({**p, "v": abs(p["v"])}, digits=20)
    assert cycle is not None
    period = float(cycle["T"])
    N = p["m"] * p["g"] + p.get("load", 0.0)
    direction = math.copysign(1.0, p["v"])
    begin = (p["mu_s"] * N - direction * p.get("F_ext", 0.0)) / (p["k"] * abs(p["v"]))
    times = step * np.arange(round((begin + 8.0 * period) / step), dtype=np.float64)
    made = exact(p, times)
    steady = made.F[times > begin]
    return Exact(p, made, float(np.ptp(steady)) / p["k"], period)


def record(motion: Exact, cell: Cell, seed: int, columns: str = "x F") -> Curve:
    """Give a noisy record of a motion; it begins at rest, or anywhere, and ends anywhere."""
    random = np.random.default_rng([seed, CELLS.index(cell)])
    t, x, _, F = motion.made
    first = 0 if seed % 3 == 0 else int(random.integers(t.size // 3))
    last = t.size - int(random.integers(int(motion.period / cell.step)))
    noise = {
        name: cell.noise * size * random.standard_normal(t.size) if name in cell.on.split() else 0.0
        for name, size in (("x", motion.swing), ("F", motion.swing * motion.p["k"]))
    }
    given = {"x": x + noise["x"], "F": F + noise["F"]}
    kept = slice(first, last)
    return Curve.of(t[kept], **{name: given[name][kept] for name in columns.split()})
