"""The score of a curve on terminals of any width."""

import io

import pytest
from rich.console import Console

from stickslip.show.score_table import score_table
from stickslip_score import Cause, Compared, Score

SCORE = Score(
    period=Compared(0.315973, 0.315243, 0.00073, 2.4e-5),
    t_stick=Compared(0.1965, 0.1962, 0.0003, 0.0005),
    t_slip=Compared(0.1195, 0.119043, 0.000457, 0.0005),
    delta_x=Compared(0.00632, 0.00630486, 1.51e-05, 2e-10),
    cause=Cause.FIXED_STEP,
    explanation="fixed steps: the mass rests in stick, but events wait for the next step",
    findings=("the figures come from one cycle only",),
    cycles=1,
)
NOTHING = Compared(None, 0.3, None, None)


def lines(score: Score, width: int) -> list[str]:
    """Return what a console of this width prints."""
    said = io.StringIO()
    Console(file=said, width=width, markup=False, highlight=False).print(score_table(score))
    return said.getvalue().splitlines()


@pytest.mark.parametrize("width", [50, 60, 80, 120])
def test_a_score_shows_its_figures_in_units_that_people_read(width: int) -> None:
    """Times are in ms and lengths in mm, with the errors, on any line."""
    shown = lines(SCORE, width)
    assert all(len(line) <= width for line in shown)
    row = next(line for line in shown if "jump" in line and "mm" in line)
    assert "6.32 mm" in row
    assert "+15.1 µm" in row
    assert ("±0.2 nm" in row) == (width > 60)
    assert any("315.973 ms" in line and "+730 µs" in line for line in shown)


def test_the_cause_stands_below_the_table_with_its_findings() -> None:
    """The verdict is told after the figures, in the words of the score."""
    text = " ".join(" ".join(lines(SCORE, 120)).split())
    assert "fixed_step: the mass rests in stick, but events wait for the next step" in text
    assert "note: the figures come from one cycle only" in text
    assert text.index("delta_x") < text.index("fixed_step")


def test_what_a_curve_does_not_show_is_a_dash() -> None:
    """A quantity without a figure keeps its row, with the exact value alone."""
    score = Score(NOTHING, NOTHING, NOTHING, NOTHING, Cause.OTHER, "too few samples", (), 0)
    row = next(line for line in lines(score, 120) if "t_slip" in line)
    assert row.split() == ["slip", "t_slip", "–", "300", "ms", "–", "–"]
