"""What a row of the table of facts is."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from tests.facts.closed import Exact, Real
from tests.facts.sides import SIDES, Side
from tests.fmu.blocks import Segment

Expected = Mapping[str, Real]
Step = float | tuple[float, Mapping[str, float]]


@dataclass(frozen=True)
class Fact:
    statement: str
    # Parameters, inputs and start values, those of the start left out.
    values: Mapping[str, float]
    # Lengths of the steps [s], with what changes at the beginning of a step.
    steps: Iterable[Step]
    # Outputs after the last steps from the exact setting: counts, states and zeros to the bit.
    expected: Callable[[Exact], Expected | Sequence[Expected]]
    # What the rounding of the data, or of the arithmetic, is amplified by, and by output.
    factor: float | Mapping[str, float] = 1.0
    # What the error of an integration is amplified by besides, and by output: theory (17).
    integrated: float | Mapping[str, float] = 1.0
    # Where the factor comes from, or why a side is left out.
    why: str = ""
    sides: Sequence[Side] = SIDES
    law: str = "coulomb"
    start_time: float = 0.0

    def tolerance(self, side: Side, name: str) -> float:
        factors = [self.factor, *([self.integrated] if side.integrates else [])]
        tolerance = side.accuracy
        for each in factors:
            tolerance *= each.get(name, 1.0) if isinstance(each, Mapping) else each
        return tolerance

    @property
    def segments(self) -> list[Segment]:
        return [
            Segment(step[0], dict(step[1])) if isinstance(step, tuple) else Segment(step)
            for step in self.steps
        ]
