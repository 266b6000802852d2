"""The result of a random test, and how it is gathered."""

import math
from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class RandomTestResult:
    """What a random set showed.

    Attributes
    ----------
    name, side
        The statement that was tested, on fmu or reference.
    bound
        The bound in words.
    seed
        What the set was drawn with.
    drawn, judged, left_out
        Numbers of draws; those left out had an event margin too small to decide.
    worst
        Largest ratio of error to bound; above 1 the statement is refuted, infinity for a side
        that refused, missed a cycle or gave no number.
    where
        What was worst and the draw it belongs to.
    refuted
        How many draws broke the bound.
    passed
        Whether all judged draws hold and few enough were left out.
    """

    name: str
    side: str
    bound: str
    seed: int
    drawn: int
    judged: int
    left_out: int
    worst: float
    where: str
    refuted: int
    passed: bool


@dataclass
class Tally:
    """Collects the ratios of error to bound, draw by draw."""

    name: str
    side: str
    bound: str
    seed: int
    most_left_out: float = 0.0
    drawn: int = 0
    left_out: int = 0
    worst: float = 0.0
    where: str = ""
    refuted: int = 0

    def leave_out(self) -> None:
        """Count a draw that cannot be decided."""
        self.drawn += 1
        self.left_out += 1

    def judge(self, ratios: Mapping[str, float], draw: object) -> None:
        """Count a draw with the ratio of error to bound of each of its quantities."""
        self.drawn += 1
        name = max(ratios, key=lambda key: _severity(ratios[key]))
        ratio = _severity(ratios[name])
        self.refuted += ratio > 1.0
        if ratio > self.worst:
            self.worst = ratio
            self.where = f"{name} of draw {self.drawn}: {draw}"

    def refuse(self, reason: str, draw: object) -> None:
        """Count a draw on which the side gave nothing."""
        self.judge({reason: math.inf}, draw)

    def result(self) -> RandomTestResult:
        """Close the account."""
        few = self.left_out < self.most_left_out * self.drawn or not self.left_out
        judged = self.drawn - self.left_out
        return RandomTestResult(
            name=self.name,
            side=self.side,
            bound=self.bound,
            seed=self.seed,
            drawn=self.drawn,
            judged=judged,
            left_out=self.left_out,
            worst=self.worst,
            where=self.where,
            refuted=self.refuted,
            passed=judged > 0 and few and self.refuted == 0,
        )


def _severity(ratio: float) -> float:
    return math.inf if math.isnan(ratio) else ratio


def relative(got: float, expected: float) -> float:
    """``|got - expected|/|expected|``, and 0 where both are equal."""
    if got == expected:
        return 0.0
    return abs(got - expected) / abs(expected) if expected else math.inf
