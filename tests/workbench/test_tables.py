"""Tables on terminals of any width."""

import io
from dataclasses import replace

import pytest
from rich.console import Console, RenderableType

from stickslip.show.cycle_table import cycle_table
from stickslip.show.random_test_table import random_test_table
from stickslip.show.verdict_table import verdict_table
from stickslip.simulate.engines import experiment, reference_parameters, simulate_reference
from stickslip_fmu.spec import TABLE
from stickslip_verification import CheckResult, RandomTestResult, Verdict
from stickslip_verification.model.verdict import Kind

CHECK = CheckResult(
    case="slip-against-the-x", check="slip-half-period-at-first-order", quantity="spring_drop",
    unit="N.s/m", truth=Kind.CLOSED_FORM, side="fmu", expected=-1.23456e-08, got=-1.23456e-08,
    error=2.5e-13, tolerance=1e-12, because="rounding", passed=True,
)  # fmt: skip
CHECKS = (
    CHECK,
    replace(CHECK, side="reference", error=3.25e-10, tolerance=1e-7),
    replace(CHECK, check="n_slips-course", error=0.0, tolerance=0.0),
    replace(
        CHECK, check="n_slips-course", error=1.0, tolerance=0.0, passed=False, side="reference"
    ),
)
PROOF = RandomTestResult(
    name="k, g, load, F_ext times 4, v, c, x_dot_start times 2, time halved", side="reference",
    bound="existence for |d| > 1e-9; 1e-12 times 1 for T and delta_x, 1 + 1/sqrt(d) for t_slip",
    seed=1, drawn=20000, judged=19990, left_out=10, refuted=0, worst=2.1e-05, where="",
    passed=True,
)  # fmt: skip


def lines(table: RenderableType, width: int) -> list[str]:
    """Return what a console of this width prints."""
    said = io.StringIO()
    Console(file=said, width=width, markup=False, highlight=False).print(table)
    return said.getvalue().splitlines()


def assert_fits(shown: list[str], width: int) -> None:
    """Nothing is cut, nothing is too long, and no line ends in blanks."""
    assert all(len(line) <= width for line in shown)
    assert all(line == line.rstrip() for line in shown)
    assert "…" not in "".join(shown)


@pytest.mark.parametrize("width", [60, 80, 120, 200])
def test_a_verdict_keeps_its_names_and_numbers(width: int) -> None:
    """Every case and check is named whole in one line with what it came to."""
    shown = lines(verdict_table(Verdict(CHECKS), width), width)
    assert_fits(shown, width)
    assert any(CHECK.case in line for line in shown)
    row = next(line for line in shown if CHECK.check in line)
    numbers = ["-1.23456e-08", "2.5e-13", "1e-12"] if width == 200 else ["0.25", "0.0033"]
    assert all(number in row for number in numbers)
    assert "pass" in row
    assert "FAIL" in next(line for line in shown if "n_slips-course" in line)
    assert shown[-1] == "3 passed, 1 failed"


@pytest.mark.parametrize("width", [60, 80, 120, 200])
def test_a_cycle_keeps_its_numbers(width: int) -> None:
    """Measured, exact and simplified stand in one line; explanations and deviations give way."""
    run, _ = simulate_reference(experiment(TABLE.start_values(), 0.0, 2.0))
    p = reference_parameters(run.parameters)
    shown = lines(cycle_table(run, p), width)
    assert_fits(shown, width)
    jump = next(line for line in shown if "delta_x" in line)
    assert jump.count("6.30536") == 2
    assert "3.924" in jump
    assert ("-37.77 %" in jump) == (width > 80)
    assert ("jump of the mass" in jump) == (width > 80)


@pytest.mark.parametrize("width", [60, 80, 120, 200])
def test_a_proof_keeps_its_words_and_numbers(width: int) -> None:
    """Statement, bound and numbers are all there, the bound below the statement."""
    shown = lines(random_test_table([PROOF]), width)
    assert_fits(shown, width)
    words = " ".join(shown).split()
    for part in (*PROOF.name.split(), *PROOF.bound.split(), "20000", "10", "2.1e-05", "holds"):
        assert part.strip(",;") in [word.strip(",;") for word in words]
    first = next(n for n, line in enumerate(shown) if "k, g, load" in line)
    assert any("existence for" in line for line in shown[first + 1 :])


def test_without_a_motion_nothing_simplified_is_explained() -> None:
    """For v = 0 the simplified column is empty but for the break-away force: no footnote."""
    run, _ = simulate_reference(experiment({**TABLE.start_values(), "v": 0.0}, 0.0, 1.0))
    p = reference_parameters(run.parameters)
    assert not any("simplified:" in line for line in lines(cycle_table(run, p), 120))
