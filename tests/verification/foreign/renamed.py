"""A foreign FMU 2.0 of the exact block: other names, units, signs and conventions; closed forms.

Lengths in mm, forces in N and kN, times in ms, mass in t; the axis points against the pull of a
positive v here, and friction is the force on the way.
"""

from __future__ import annotations

from tests.verification.foreign.exact_block import ExactBlock
from tests.verification.foreign.foreign_face import COUNT, FLAG, Block, ForeignFace, Given, Shown

FAULT = ""

CONVENTIONS = ("start", "not yet", "clamp", "reversal", "first stick", "instants")
"""Those of `ExactBlock`, and start: after initialization every output is 0 until the first step."""


class Renamed(ForeignFace):
    """The block behind a face of other names, units and signs."""

    fixed = (
        Given("m", "table.mass", "t", 1.0),
        Given("g", "world.gravity", "mm/s2", 9.81),
        Given("x_start", "table.s0", "mm", 0.0, -1),
        Given("x_dot_start", "table.v0", "mm/s", 0.0, -1),
        Given("z_start", "spring.stretch0", "mm", 0.0),
    )
    tunable = (
        Given("k", "spring.rate", "N/mm", 1000.0),
        Given("c", "guide.damping", "N.s/mm", 0.0),
        Given("mu_s", "guide.mu_rest", "1", 0.5),
        Given("mu_k", "guide.mu_motion", "1", 0.3),
    )
    inputs = (
        Given("v", "drive.v", "mm/s", 0.02, -1),
        Given("load", "guide.preload", "kN", 0.0),
        Given("F_ext", "table.push", "kN", 0.0, -1),
    )
    shows = (
        Shown("x", "table.s", "mm", -1),
        Shown("x_dot", "table.v", "mm/s", -1),
        Shown("x_pull", "drive.s", "mm", -1),
        Shown("z", "spring.stretch", "mm"),
        Shown("F", "spring.tension", "kN"),
        Shown("F_friction", "guide.force", "N"),
        Shown("F_s", "guide.limit", "N"),
        Shown("sticking", "guide.stuck", FLAG),
        Shown("mode", "guide.direction", COUNT, -1),
        Shown("delta_x", "cycle.jump", "mm", -1),
        Shown("spring_drop", "cycle.relief", "mm"),
        Shown("t_stick", "cycle.stick", "ms"),
        Shown("t_slip", "cycle.slip", "ms"),
        Shown("T", "cycle.period", "ms"),
        Shown("f", "cycle.rate", "kHz"),
        Shown("x_dot_peak", "cycle.top", "mm/s", -1),
        Shown("n_slips", "cycle.count", COUNT),
        Shown("t_event", "cycle.instant", "ms"),
        Shown("W_pull", "energy.drive", "mJ"),
        Shown("W_k", "energy.tuning", "mJ"),
        Shown("Q_friction", "energy.heat", "mJ"),
        Shown("mu_k_used", "guide.mu_motion_used", "1"),
    )

    def make_block(self) -> Block:
        """Return the block at its start."""
        off = FAULT == "no-damping-after-reversal"
        return ExactBlock(self.given, self.start_time, CONVENTIONS, off)

    def at_start(self) -> dict[str, float]:
        """Return what the outputs show after initialization."""
        return {} if "start" in CONVENTIONS else super().at_start()

    def take(self, key: str, value: float) -> None:
        """Keep a value [SI] that the master sets."""
        super().take(key, value)
        if FAULT == "clamp-when-set":
            self.given["mu_k"] = min(self.given["mu_k"], self.given["mu_s"])
