"""Tables on terminals of any width: names and numbers stay whole."""

import io
import math
from dataclasses import replace

import pytest
from rich.console import Console, RenderableType

from stickslip.judgements import Design
from stickslip.library import simulate
from stickslip.runs import reference_parameters
from stickslip.show.tables import critical_table, cycle_table, score_table
from stickslip.show.verdict import verdict_table
from stickslip_ref import CriticalVelocity, Interval, Regime, StickSlip, Swinging
from stickslip_score import Cause, Compared, Score
from stickslip_verification import CheckResult, Verdict
from stickslip_verification.model.verdict import Kind
from tests.design import verdicts

CHECK = CheckResult(
    case="slip-against-the-x", check="slip-half-period-at-first-order", quantity="spring_drop",
    unit="N.s/m", truth=Kind.CLOSED_FORM, side="fmu", expected=-1.23456e-08, got=-1.23456e-08,
    error=2.5e-13, tolerance=1e-12, because="rounding", passed=True,
)  # fmt: skip
OTHER = replace(CHECK, check="n_slips-course", error=1.0, tolerance=0.0, passed=False)
CHECKS = (CHECK, replace(CHECK, side="reference", error=3.25e-10, tolerance=1e-7), OTHER)
SCORE = Score(
    period=Compared(0.315973, 0.315243, 0.00073, 2.4e-5),
    t_stick=Compared(0.1965, 0.1962, 0.0003, 0.0005),
    t_slip=Compared(None, 0.119043, None, None),
    delta_x=Compared(0.00632, 0.00630486, 1.51e-05, 2e-10),
    cause=Cause.FIXED_STEP,
    explanation="fixed steps: the mass rests in stick, but events wait for the next step",
    findings=("the figures come from one cycle only",),
    cycles=1,
)
BOTH = Regime(0.2, 0.01, 5.0, (), StickSlip(1e-3, 0.1), "sticks", math.inf)
SWINGS = Regime(0.045, -0.01, 5.0, (Swinging(0.54, 5.0),), None, "swings", math.inf)
FOUND = CriticalVelocity(
    unstable=(Interval(1e-3, 0.05, "none", "eigenvalue"),),
    cycle=(Interval(1e-3, 0.04, "none", "grazing"), Interval(0.15, 0.38, "reversal", "fold")),
    between=(1e-3, 2.0),
    proven=False,
)
widths = pytest.mark.parametrize("width", [60, 80, 120, 200])


def lines(table: RenderableType, width: int) -> list[str]:
    said = io.StringIO()
    Console(file=said, width=width, markup=False, highlight=False).print(table)
    shown = said.getvalue().splitlines()
    assert max(map(len, shown)) <= width
    assert "…" not in said.getvalue()
    return shown


def row(shown: list[str], *parts: str) -> str:
    return next(line for line in shown if all(part in line for part in parts))


@widths
def test_a_verdict(width: int) -> None:
    shown = lines(verdict_table(Verdict(CHECKS)), width)
    numbers = ["-1.23456e-08", "2.5e-13", "1e-12"] if width == 200 else ["0.25", "0.0033"]
    row(shown, CHECK.check, "pass", *numbers)
    row(shown, "n_slips-course", "FAIL")
    assert any(CHECK.case in line for line in shown)
    assert shown[-1] == "2 passed, 1 failed"


@widths
def test_a_cycle(width: int) -> None:
    run = simulate(None, 2.0, engine="reference")
    jump = row(lines(cycle_table(run, reference_parameters(run.parameters)), width), "delta_x")
    assert jump.count("6.30536") == 2
    assert "3.924" in jump
    assert ("-37.77 %" in jump) == ("jump of the mass" in jump) == (width > 80)


@widths
def test_an_axis_is_its_first_page(width: int) -> None:
    verdict = verdicts.juddering()
    shown = lines(Design(verdict).table(), width)
    row(shown, "  0.5  ", "30", "0.322", "18.4")
    row(shown, "1.07", "hunts 4.08 µm")
    row(shown, "mu_s 0.2 → 0.165")
    first, *rest = [one.name for one in verdict.measures if one.enough]
    said = " ".join(" ".join(shown).split())
    assert first in said
    assert rest[-1] not in said
    assert len(shown) <= 45 or width < 80
    assert f"{sum(map(len, verdict.left_out.values()))} left out" in said


@widths
def test_a_score_in_units_that_people_read(width: int) -> None:
    shown = lines(score_table(SCORE), width)
    assert ("±0.2 nm" in row(shown, "jump", "6.32 mm", "+15.1 µm")) == (width > 60)
    row(shown, "315.973 ms", "+730 µs")
    assert "–" in row(shown, "t_slip")
    text = " ".join(" ".join(shown).split())
    assert text.index("delta_x") < text.index("fixed_step: the mass rests in stick, but events")
    assert "note: the figures come from one cycle only" in text


@pytest.mark.parametrize(
    ("there", "told"),
    [
        (None, "a cycle with a stick exists 1 mm/s search 40 mm/s grazing"),
        (None, "150 mm/s reversal 380 mm/s fold"),
        (None, "steady sliding is unstable 1 mm/s search 50 mm/s eigenvalue"),
        (BOTH, "at 200 mm/s the mass sticks and slips; moves evenly after another start"),
        (SWINGS, "at 45 mm/s the mass swings by ± 54 % of the speed, without a stop"),
        (None, "at 200 mm/s the mass sticks and slips, or after another start moves evenly"),
        (None, "no cycle: a is at least b"),
    ],
)
def test_critical_velocities(there: Regime | None, told: str) -> None:
    shown = lines(critical_table(FOUND._replace(reason="a is at least b"), there, 0.2), 120)
    assert told in [" ".join(line.split()) for line in shown]
