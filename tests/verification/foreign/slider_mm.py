"""A foreign FMU 2.0 of the stock wrapper: in millimetres, the spring counted in compression."""

from __future__ import annotations

from tests.verification.foreign.exact_block import ExactBlock
from tests.verification.foreign.foreign_face import COUNT, FLAG, Block, ForeignFace, Given, Shown

FAULT = 1.0


class SliderMm(ForeignFace):
    """The undamped slider behind a face in millimetres."""

    fixed = (
        Given("m", "slider.mass", "kg", 1.0),
        Given("g", "world.g", "mm/s2", 9.81),
        Given("k", "spring.rate", "N/mm", 1000.0),
        Given("mu_s", "friction.static", "1", 0.5),
        Given("mu_k", "friction.kinetic", "1", 0.3),
    )
    inputs = (Given("v", "drive.speed", "mm/s", 0.02),)
    shows = (
        Shown("x", "slider.s", "millimetre"),
        Shown("x_dot", "slider.v", "mm/s"),
        Shown("x_pull", "drive.s", "millimetre"),
        Shown("z", "spring.compression", "millimetre", -1),
        Shown("F", "spring.force", "kN"),
        Shown("F_friction", "friction.force", "N"),
        Shown("F_s", "friction.limit", "N"),
        Shown("delta_x", "cycle.jump", "millimetre"),
        Shown("spring_drop", "cycle.relief", "millimetre"),
        Shown("t_stick", "cycle.stick", "ms"),
        Shown("t_slip", "cycle.slip", "ms"),
        Shown("T", "cycle.period", "ms"),
        Shown("x_dot_peak", "cycle.top", "mm/s"),
        Shown("mode", "phase", COUNT),
        Shown("n_slips", "cycle.count", COUNT),
        Shown("sticking", "stuck", FLAG),
    )

    def make_block(self) -> Block:
        """Return the block at its start."""
        return ExactBlock({**self.given, "mu_s": self.given["mu_s"] * FAULT}, 0.0)
