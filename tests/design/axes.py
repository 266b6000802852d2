"""Axes that the tests of the design tool judge."""

import math
import random
from dataclasses import replace
from typing import Any

from stickslip_design.axis import Axis, Demand, Drive, Filter, Friction

DRIVE = Drive(
    inertia=6e-3 * (2.0 * math.pi / 0.01) ** 2, K_v=25.0, bandwidth=300.0, T_n=4.0 / 300.0,
    T_s=250e-6, d=1000.0,
)  # fmt: skip
SERVO = Axis(
    name="servo", m=500.0, k=4e7, c=4000.0, friction=Friction(mu_s=0.20, mu_k=0.15), drive=DRIVE,
    demand=Demand(feeds=(5e-4,), acceleration=0.1),
)  # fmt: skip
"""The axis of docs/feed-axis.md, without encoder counts."""

RIGID = Axis(
    name="rigid", m=500.0, k=5e7, c=2.0 * 0.05 * math.sqrt(5e7 * 500.0),
    friction=Friction(mu_s=0.25, mu_k=0.15), demand=Demand(feeds=(3e-3,)),
)  # fmt: skip
"""An axis on a rigid drive, of 50 N/um and a damping ratio of 5 %."""


def driven(**changed: Any) -> Axis:
    return replace(SERVO, drive=replace(DRIVE, **changed))


def random_axis(seed: int) -> Axis:
    """Return a servo axis, perhaps unstable, under one of all kinds of friction."""
    draw = random.Random(seed)

    def between(low: float, high: float) -> float:
        return math.exp(draw.uniform(math.log(low), math.log(high)))

    m, k, mu_s = between(20.0, 5e3), between(5e6, 5e8), between(0.02, 0.4)
    mu_k = mu_s * (1.0 - between(0.03, 0.6))
    laws: list[tuple[str, dict[str, float]]] = [
        ("coulomb", {}),
        ("coulomb", {"tau_s": between(0.02, 3.0)}),
        ("coulomb", {"B": mu_s * between(3e-3, 0.03), "t_0": between(0.01, 1.0)}),
        ("stribeck", {"shape": 1.0, "v_s": between(1e-3, 0.1), "delta": between(1.0, 3.0)}),
        ("stribeck", {"shape": 2.0, "v_s": between(1e-3, 0.1)}),
        ("stribeck", {"shape": 3.0, "n_points": 3.0, "mu_1": mu_s, "u_2": between(1e-3, 0.02),
                      "mu_2": mu_k, "u_3": 0.1, "mu_3": 0.5 * (mu_s + mu_k)}),
    ]  # fmt: skip
    law, own = laws[seed % len(laws)]
    T_s, bandwidth, inertia = draw.choice([125e-6, 5e-4, 1e-3]), between(50.0, 600.0), m
    drive = Drive(
        inertia=inertia * between(0.1, 5.0), K_v=between(5.0, 60.0), bandwidth=bandwidth,
        T_n=draw.choice([0.0, between(4.0, 20.0) / bandwidth]), T_s=T_s,
        d=draw.choice([0.0, inertia]), dry=draw.choice([0.0, (mu_s - mu_k) * m * 9.81]),
        lag=draw.choice([0.0, between(1e-4, 1e-3)]), on_table=draw.random() < 0.5,
        dead_time=draw.choice([0.0, 1.5 * T_s]),
        filters=(Filter("low pass", 0.2 / T_s, 0.7),) * draw.randrange(2),
    )  # fmt: skip
    return Axis(
        name=f"axis {seed}", m=m, k=k, c=2.0 * between(1e-3, 0.1) * math.sqrt(k * m),
        friction=Friction(mu_s=mu_s, mu_k=mu_k, law=law, own=own), drive=drive,
    )  # fmt: skip
