"""Axes of the example by the names of the FMUs' parameters, so that each can be another one."""

import math
from types import SimpleNamespace
from typing import Any

from stickslip.systems import Move, start_values
from stickslip_design import axis as design
from stickslip_drive.motion import inertia_at_slide
from stickslip_drive.table import TABLE

SAME = (
    *("K_v", "T_n", "T_s", "d", "dry", "lag", "dead_time", "F_max", "pitch", "dead_band"),
    *("velocity_feedforward", "friction_feedforward", "resolution_motor", "resolution_table"),
)


def critically_damped(omega_v: float) -> float:
    """Return the integral time [s] that critically damps a velocity loop of omega_v [rad/s]."""
    return 4.0 / omega_v


class Axis(SimpleNamespace):
    """The axis of the how-to, or another; `omega_v` [rad/s] in place of K_p, `follow` of k.

    Without `follow` the drive holds the spring force over its step.
    """

    def __init__(self, **changes: Any) -> None:
        start = {each.name: each.start for each in TABLE.rows if each.causality == "parameter"}
        start |= {"m": 500.0, "g": 9.81, "c": 4000.0, "mu_s": 0.2, "mu_k": 0.15, "omega_v": 300.0}
        start |= {"follow": True}
        del start["K_p"]
        assert changes.keys() <= start.keys()
        super().__init__(**{**start, **changes})

    def __hash__(self) -> int:  # type: ignore[override]
        return hash(tuple(vars(self).values()))

    def but(self, **changes: Any) -> "Axis":
        return Axis(**{**vars(self), **changes})

    @property
    def m_d(self) -> float:
        return inertia_at_slide(self.J, self.pitch)

    @property
    def K_p(self) -> float:  # noqa: N802 - the symbol of control engineers
        return float(self.m_d * self.omega_v)

    @property
    def F_s(self) -> float:  # noqa: N802 - as in the block
        return float(self.mu_s * self.m * self.g)

    @property
    def designed(self) -> design.Axis:
        filters = []
        if self.low_pass:
            filters.append(
                design.Filter("low pass", self.low_pass, self.low_pass_damping or math.inf)
            )
        if self.notch:
            filters.append(design.Filter("notch", self.notch, self.notch_damping, self.notch_depth))
        drive = design.Drive(
            inertia=self.m_d, bandwidth=self.omega_v, filters=tuple(filters),
            on_table=bool(self.on_table), **{name: getattr(self, name) for name in SAME},
        )  # fmt: skip
        friction = design.Friction(mu_s=self.mu_s, mu_k=self.mu_k)
        return design.Axis(
            name="", m=self.m, k=self.k, c=self.c, g=self.g, friction=friction, drive=drive
        )

    @property
    def values(self) -> dict[str, dict[str, float]]:
        values = start_values(self.designed, Move(self.feed, self.acceleration, self.distance))
        values["drive"]["k"] *= self.follow
        return values
