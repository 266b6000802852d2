"""The invariants as data: what is read, and what a broken file is told."""

import math
from collections import Counter
from pathlib import Path

import pytest

from stickslip_verification.drive.answer import Answer
from stickslip_verification.drive.other_runs import RUNS
from stickslip_verification.drive.probes import PROBES
from stickslip_verification.judge.checks import EXACT_CONTRACT, PHYSICS_CONTRACT, Contract
from stickslip_verification.judge.invariant_checks import agreeing, judge_agreement
from stickslip_verification.judge.metrics import METRICS
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.model.run import Run
from stickslip_verification.model.verdict import CheckResult
from stickslip_verification.suite.invariants import (
    Agreement,
    InvariantError,
    Order,
    Probe,
    ResidualInvariant,
    RunInvariant,
    load_invariants,
)

from .records import Draft, exact_of, named, planted

INVARIANTS = load_invariants()

RESIDUAL = """\
[[residuals]]
id = "pull"
title = "The pulled end moves at v"
kind = "invariant"
class = "physics"
source = 1
metric = "outputs.pulled_end"
quantity = "way less v h"
tolerance = { fmu = 1e-14, reference = 1e-12 }
because.fmu = "one product and one addition"
because.reference = "one product and one addition"
means = "The input v does not arrive."
look = "The sampling of v."
"""

RUN = """\
[[runs]]
id = "again"
title = "The same again"
kind = "invariant"
class = "contract"
source = 16
run = "reset"
because = "the same operations on the same numbers"
means = "Something is kept."
look = "The reset of everything."
"""

ORDER = """\
[[orders]]
id = "order"
title = "It converges"
source = 3
quantity = "z"
cases = ["default"]
order = 1.0
coarsest = 1e-9
finest = 1e-11
levels = 5
tolerance = 0.2
halves = 0.7
because.order = "what the method promises"
because.halves = "what the method promises"
means = "It does not converge."
look = "The limit of steps."
"""

PROBE = """\
[[probes]]
id = "starts"
title = "It starts"
probe = "declared_starts"
means = "It does not start."
look = "The start."
"""

AGREEMENT = """\
[[agreements]]
id = "agree"
title = "They agree"
quantity = "z"
"""


def test_each_family_is_read_whole(tmp_path: Path) -> None:
    """A file may hold invariants of every family, and gives each what its family has in common."""
    (tmp_path / "all.toml").write_text(
        "\n".join((RESIDUAL, RUN, ORDER, PROBE, AGREEMENT)), encoding="utf-8"
    )
    invariants = load_invariants(tmp_path)
    assert [type(invariant) for invariant in invariants] == [
        ResidualInvariant,
        RunInvariant,
        Probe,
        Agreement,
        Order,
    ]
    (run,), (probe,) = invariants.runs, invariants.probes
    assert run.tolerance is None
    assert (probe.klass, probe.kind, dict(probe.arguments)) == ("contract", "invariant", {})
    assert invariants.agreements[0].kind == "cross_code"
    assert invariants.orders[0].kind == "convergence"
    assert all(invariant.means and invariant.look for invariant in invariants)


@pytest.mark.parametrize(
    ("text", "old", "new", "told"),
    [
        (RESIDUAL, 'id = "pull"', "id = 5", r"5\.id: 5 is not of type 'string'"),
        (RESIDUAL, 'id = "pull"', 'id = "no good"', "no good.id: 'no good' does not match"),
        (RESIDUAL, 'look = "The sampling of v."\n', "", "pull: 'look' is a required property"),
        (RESIDUAL, '"invariant"', '"cross_code"', "pull.kind: 'cross_code' is not one of"),
        (RESIDUAL, '"physics"', '"chemistry"', "pull.class: 'chemistry' is not one of"),
        (RESIDUAL, "source = 1", "source = 0", "pull.source: 0 is less than the minimum of 1"),
        (RESIDUAL, '"outputs.pulled_end"', '"pulled_end"', "pull.metric: 'pulled_end' does not"),
        (RESIDUAL, "fmu = 1e-14", "fmu = -1.0", "pull.tolerance.fmu: -1.0 is less than"),
        (RESIDUAL, ", reference = 1e-12", "", "pull.tolerance: 'reference' is a required"),
        (RESIDUAL, "because.fmu", "because.ours", "pull.because: .*'ours' was unexpected"),
        (RESIDUAL, '"one product and one addition"', '" "', "pull.because.fmu: ' ' does not"),
        (RESIDUAL, "source = 1", "source = 1\ncolour = 1", "pull: .*'colour' was unexpected"),
        (RESIDUAL, "[[residuals]]", "[[others]]", r"'others' was unexpected"),
        (RESIDUAL, "[[residuals]]", "[[residuals]", r"line 1"),
        (RUN, '"invariant"', '"closed_form"', "again.kind: 'invariant' was expected"),
        (RUN, "source = 16", "source = 16\ntolerance = -1.0", "again.tolerance: -1.0 is less"),
        (ORDER, "levels = 5", "levels = 4", "order.levels: 4 is less than the minimum of 5"),
        (ORDER, '["default"]', "[]", "order.cases: .* should be non-empty"),
        (ORDER, "coarsest = 1e-9", "coarsest = 0.0", "order.coarsest: 0.0 is less than or equal"),
        (PROBE, "[[probes]]", "[[probes]]\narguments = 1", "starts.arguments: 1 is not of type"),
        (AGREEMENT, 'quantity = "z"\n', "", "agree: 'quantity' is a required property"),
        (AGREEMENT, AGREEMENT, "", "should be non-empty"),
    ],
)
def test_a_broken_invariant_is_refused_by_file_invariant_and_field(
    tmp_path: Path, text: str, old: str, new: str, told: str
) -> None:
    """A mistake in a file of invariants is one line: file, invariant, field, reason."""
    assert old in text
    file = tmp_path / "invariants.toml"
    file.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(InvariantError, match=told) as caught:
        load_invariants(tmp_path)
    assert str(caught.value).startswith(f"{file}: ")
    assert "\n" not in str(caught.value)


def test_no_two_invariants_share_an_id(tmp_path: Path) -> None:
    """An id that is taken, in the same file or another, is told with both files."""
    (tmp_path / "a.toml").write_text(RESIDUAL, encoding="utf-8")
    (tmp_path / "b.toml").write_text(RUN.replace('"again"', '"pull"'), encoding="utf-8")
    with pytest.raises(InvariantError, match=r"b\.toml: pull: an invariant of a\.toml has this id"):
        load_invariants(tmp_path)
    (tmp_path / "b.toml").write_text(PROBE + PROBE, encoding="utf-8")
    with pytest.raises(
        InvariantError, match=r"b\.toml: starts: an invariant of b\.toml has this id"
    ):
        load_invariants(tmp_path)


def test_a_file_that_is_no_text_is_told(tmp_path: Path) -> None:
    """Bytes that are not UTF-8 are an error of the file and no traceback."""
    (tmp_path / "invariants.toml").write_bytes(b"\xff\xfe")
    with pytest.raises(InvariantError, match=r"invariants\.toml: is not UTF-8") as caught:
        load_invariants(tmp_path)
    assert "\n" not in str(caught.value)


def test_the_suite_names_only_what_exists() -> None:
    """Every metric, run, probe and quantity that an invariant names is there, and each id once."""
    assert {invariant.metric for invariant in INVARIANTS.residuals} <= set(METRICS)
    assert {invariant.run for invariant in INVARIANTS.runs} <= set(RUNS)
    assert {invariant.probe for invariant in INVARIANTS.probes} <= set(PROBES)
    assert {invariant.quantity for invariant in INVARIANTS.agreements} <= set(OUTPUT_NAMES)
    assert {invariant.quantity for invariant in INVARIANTS.orders} <= set(OUTPUT_NAMES)
    assert {
        n for n, count in Counter(invariant.id for invariant in INVARIANTS).items() if count > 1
    } == set()


def test_physics_that_demands_every_bit_is_a_sign_or_a_count() -> None:
    """No invariant of physics asks a numerical solution for a digit it cannot keep."""
    strict = {
        invariant.id
        for invariant in INVARIANTS.residuals
        if invariant.tolerance["reference"] == 0.0
    }
    assert {
        invariant.id for invariant in INVARIANTS.residuals if invariant.klass == "physics"
    } & strict == {"finite", "mode-and-sticking-agree", "runs-to-the-end"}
    assert all(
        invariant.klass == "contract"
        for invariant in INVARIANTS.runs
        if invariant.tolerance is None
    )


def test_no_invariant_allows_ours_more_than_a_numerical_solution() -> None:
    """The exact block is held at least as tightly as an integrator, by every invariant."""
    for invariant in INVARIANTS.residuals:
        assert invariant.tolerance["fmu"] <= invariant.tolerance["reference"], invariant.id


AGREE = {invariant.quantity: invariant for invariant in INVARIANTS.agreements}


def agreed(
    name: str, quantity: str, fmu: Run, contract: Contract = EXACT_CONTRACT
) -> CheckResult | None:
    """Hold a record against the exact motion in the place of the reference."""
    invariant, case, exact = AGREE[quantity], named(name), exact_of(name)
    check = agreeing(invariant, case)
    if check is None:
        return None
    records = {"fmu": Answer(fmu), "reference": Answer(exact.record)}
    return judge_agreement(invariant, case, check, contract, Answer(exact), records)


def late(draft: Draft) -> None:
    """Date every transition a microsecond late, and count one slip more."""
    draft.outputs["t_event"] += 1e-6
    draft.outputs["n_slips"] += 1.0


def test_two_codes_agree_within_what_the_case_allows_both() -> None:
    """FMU and reference may differ by the sum of their tolerances, and by no more."""
    case, exact = named("default"), exact_of("default").record
    (check,) = (check for check in case.checks if check.id == "t_event-course")
    for contract in (EXACT_CONTRACT, PHYSICS_CONTRACT):
        result = agreed("default", "t_event", exact, contract)
        assert result is not None
        assert (result.side, result.truth, result.passed) == ("both", "cross_code", True)
        allowed = check.tolerance[contract.column] + check.tolerance["reference"]
        assert result.tolerance == allowed
    for quantity in ("t_event", "n_slips"):
        result = agreed("default", quantity, planted(exact, late))
        assert result is not None
        assert not result.passed
        assert result.error == pytest.approx(1.0 if quantity == "n_slips" else 1e-7, rel=0.02)


def test_agreement_needs_the_output_on_both_sides() -> None:
    """What one side lacks cannot agree: a failure of ours, not applicable to a foreign FMU."""

    def lacking(draft: Draft) -> None:
        del draft.outputs["t_event"]

    poor = planted(exact_of("default").record, lacking)
    ours, foreign = (
        agreed("default", "t_event", poor, contract)
        for contract in (EXACT_CONTRACT, PHYSICS_CONTRACT)
    )
    assert ours is not None
    assert foreign is not None
    assert (ours.verdict, ours.failure) == ("fail", "no output t_event")
    assert (foreign.verdict, foreign.not_applicable) == (
        "not applicable",
        "it has no output t_event",
    )


def test_a_quantity_without_a_course_is_not_compared() -> None:
    """A case that does not check a quantity at every point has no agreement on it."""
    assert agreed("fast-pull", "x_dot", exact_of("fast-pull").record) is None


def test_what_is_no_number_does_not_agree() -> None:
    """NaN on one side is a disagreement with its reason."""

    def nan(draft: Draft) -> None:
        draft.outputs["x"][5] = math.nan

    result = agreed("default", "x", planted(exact_of("default").record, nan))
    assert result is not None
    assert (result.passed, result.failure) == (False, "x is no finite number on one side")
