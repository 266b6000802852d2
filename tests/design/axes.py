"""Axes that the tests of the design tool judge."""

import math
from dataclasses import replace
from typing import Any

from stickslip_design.axis import Axis, Demand, Drive, Friction

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
