"""The axis as the design tool has it, which computes what the runs are compared with."""

from __future__ import annotations

import math
from typing import Final

from stickslip_design import axis as design

from .axis import Axis

_SAME: Final = (
    *("K_v", "T_n", "T_s", "d", "dry", "lag", "dead_time", "on_table", "F_max", "pitch"),
    *("velocity_feedforward", "friction_feedforward", "dead_band"),
    *("resolution_motor", "resolution_table"),
)


def designed(axis: Axis) -> design.Axis:
    """Return an axis of the example as one of the design tool; it has no set point."""
    filters = []
    if axis.low_pass:
        filters.append(design.low_pass(axis.low_pass, axis.low_pass_damping or math.inf))
    if axis.notch:
        filters.append(design.notch(axis.notch, axis.notch_damping, axis.notch_depth))
    drive = design.Drive(
        inertia=axis.m_d,
        bandwidth=axis.omega_v,
        filters=tuple(filters),
        **{name: getattr(axis, name) for name in _SAME},
    )
    friction = design.Friction(mu_s=axis.mu_s, mu_k=axis.mu_k)
    return design.Axis(
        name="", m=axis.m, k=axis.k, c=axis.c, g=axis.g, friction=friction, drive=drive
    )
