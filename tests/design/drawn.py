"""Random feed axes of all friction laws, on a rigid drive and on servo drives."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

import numpy as np

from stickslip_design.axis import Axis, Drive, Filter, Friction
from stickslip_ref import Shape
from tests.design.simulated import Simulation

_LAWS: Final = {
    "constant": 0.35, "dwell": 0.15, "log": 0.1, "stribeck": 0.2, "hyperbolic": 0.1, "curve": 0.1,
}  # fmt: skip
"""Friction laws of random axes, and their shares."""
_SHAPES: Final = {
    "stribeck": Shape.STRIBECK, "hyperbolic": Shape.HYPERBOLIC, "curve": Shape.CURVE,
}  # fmt: skip


def random_axis(number: int) -> tuple[Axis, float]:
    """Return an axis of any kind and friction law, and a feed about where its jumps may end [m/s].

    The loop of a servo axis is stable, table sliding fast or stuck, by `Simulation.growth`.
    """
    rng = np.random.default_rng([35, number])
    m, k, mu_s = _log(rng, 20.0, 5e3), _log(rng, 5e6, 5e8), rng.uniform(0.02, 0.3)
    w, gap, N = math.sqrt(k / m), rng.uniform(0.05, 0.6) * mu_s, m * Axis.g
    # A gap that is free to swing has the speed w gap N/k.
    feed = w * gap * N / k * _log(rng, 0.1, 10.0)
    law = str(rng.choice(list(_LAWS), p=list(_LAWS.values())))
    own: dict[str, float] = {}
    if law == "dwell":
        own = {"tau_s": _log(rng, 0.1, 30.0) / w}
        feed /= 1.0 + own["tau_s"] * w / 3.0
    if law == "log" or (law == "dwell" and rng.random() < 0.3):
        own |= {"B": mu_s * rng.uniform(0.005, 0.05), "t_0": _log(rng, 1e-3, 0.1)}
    if law in _SHAPES:
        own = {"shape": float(_SHAPES[law]), "v_s": feed * _log(rng, 0.1, 10.0)}
    if law == "stribeck":
        own["delta"] = float(rng.choice([1.0, 2.0, rng.uniform(1.0, 2.0)]))
    if law == "curve":
        lost = [rng.choice([0.0, 0.5]), rng.uniform(0.5, 0.7), 0.8, 1.0, rng.uniform(0.6, 1.0)]
        for i, (u, of_gap) in enumerate(zip([0.0, 0.3, 1.0, 3.0, 10.0], lost, strict=True), 1):
            own |= {f"u_{i}": u * own["v_s"], f"mu_{i}": mu_s - gap * of_gap}
        own |= {"n_points": 5.0}
        del own["u_1"], own["v_s"]
    constant = Friction(mu_s=mu_s, mu_k=mu_s - gap)
    axis = Axis(
        name=f"{number}: {law}", m=m, k=k, friction=constant,
        c=2.0 * math.sqrt(k * m) * rng.uniform(0.0, 0.1) * (rng.random() < 0.9),
        along=mu_s * N * rng.uniform(-0.5, 0.5) * (rng.random() < 0.3),
    )  # fmt: skip
    while rng.random() < 0.75 or axis.drive is not None:
        axis = replace(axis, drive=random_drive(rng, m, mu_s * N))
        fast = Simulation(axis, feed)
        if fast.growth() < 0.0 and fast.growth(stuck=True) < 1e-6 * w:
            break
    family = "stribeck" if law in _SHAPES else "coulomb"
    return replace(axis, friction=replace(constant, law=family, own=own)), feed


def random_drive(rng: np.random.Generator, m: float, force: float) -> Drive:
    T_s, bandwidth = float(rng.choice([0.125e-3, 0.25e-3, 0.5e-3, 1e-3, 2e-3])), _log(rng, 50, 600)
    some = (rng.random(8) < 0.4).tolist()
    filters = (Filter("low pass", 0.2 / T_s), Filter("notch", 0.1 / T_s, 0.5, 0.1))
    return Drive(
        inertia=m * _log(rng, 0.3, 10.0), K_v=_log(rng, 5.0, 60.0), bandwidth=bandwidth, T_s=T_s,
        T_n=_log(rng, 4.0, 16.0) / bandwidth if rng.random() < 0.8 else 0.0,
        d=force * _log(rng, 0.1, 10.0) * some[0], dry=rng.uniform(0.0, 0.3) * force * some[1],
        lag=_log(rng, 0.1e-3, 1e-3) * some[2], dead_time=rng.uniform(0.0, 2.0) * T_s * some[3],
        filters=(filters[int(some[5])],) if some[4] else (), on_table=bool(rng.random() < 0.6),
        velocity_feedforward=float(some[6]), friction_feedforward=0.8 * force * some[7],
    )  # fmt: skip


def _log(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))
