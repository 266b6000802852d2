"""The random sequences: what happens in them, and that every manner gives the exact motion."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from stickslip_verification import load_invariants, truth
from stickslip_verification.drive import FmuFile
from stickslip_verification.drive.exact import exact_motion, kept
from stickslip_verification.drive.masters import MANNERS
from stickslip_verification.judge.checks import EXACT_CONTRACT, judge_sequence, of_invariant
from stickslip_verification.run.verify import gaps
from stickslip_verification.suite import sequences as drawn
from stickslip_verification.suite.sequences import (
    CELLS,
    EVERYTHING,
    PLAIN,
    coverage,
    coverage_table,
    draw_sequences,
)
from tests.conftest import built

SMALLEST_MARGIN = 1e-6
SOME = draw_sequences(seed=7, count=18)
BY_MANNER = {each.manner: each for each in load_invariants().sequences}


def test_a_seed_names_a_set_and_the_first_of_many_are_the_few() -> None:
    assert draw_sequences(seed=7, count=5) == SOME[:5]
    assert draw_sequences(seed=8, count=1)[0].case != SOME[0].case


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.soak)])
def test_every_change_meets_every_phase_at_every_damping(seed: int) -> None:
    sequences = draw_sequences(seed)
    counts = coverage(sequences)
    assert [cell for cell in CELLS if not counts[cell]] == []
    assert drawn.COUNT <= len(sequences) <= 1.5 * drawn.COUNT
    assert list(gaps(sequences, EVERYTHING, EXACT_CONTRACT, [BY_MANNER[PLAIN]])) == []
    assert coverage_table(sequences, seed, EVERYTHING).note == ""
    # A cell that stays empty is a failure of the suite, by its name.
    empty = drawn.Cell("load", drawn.STICK, drawn.CRITICAL)
    thinned = [replace(each, cells=tuple({*each.cells} - {empty})) for each in sequences]
    (failed,) = gaps(thinned, EVERYTHING, EXACT_CONTRACT, [BY_MANNER[PLAIN]])
    assert failed.failed
    assert (failed.failure or "").endswith("random sequences have no load, stick, critical")
    assert list(gaps(SOME, EVERYTHING, EXACT_CONTRACT, [BY_MANNER[PLAIN]])) == []


def phase_before(run: truth.Run, x_dot_start: float, time: float) -> str:
    mode, reversed_ = int(np.sign(x_dot_start)), False
    for event in run.events:
        # A change is dated by the sum of the steps, to its rounding.
        if event.time > time - 1e-12:
            break
        mode, reversed_ = event.mode, event.kind == "reversal"
    if reversed_:
        return drawn.REVERSED
    return drawn.STICK if mode == 0 else "forward slip" if mode > 0 else "backward slip"


OF_CHANGES = {cell.row for cell in CELLS if EVERYTHING.hindrance(cell) is None} - {
    *("load and F_ext from the start", "x_dot_start", "any change, mu_s above 1"),
    "any change, v = 0",
}


@pytest.mark.parametrize("number", range(len(SOME)))
def test_what_is_counted_happens_in_the_exact_motion(number: int) -> None:
    case, cells = SOME[number].case, SOME[number].cells
    run = truth.run(case.parameters, [truth.Step(s.h, dict(s.changes)) for s in case.steps])
    # The motion in 50 digits decides clearly, half as clearly at least as in doubles.
    assert run.margin >= 0.5 * SMALLEST_MARGIN
    found = Counter(
        phase_before(run, case.start["x_dot_start"], time)
        for time, step in zip((0.0, *case.times), case.steps, strict=False)
        if step.changes and time > 0.0
    )
    assert Counter(cell.phase for cell in cells if cell.row in OF_CHANGES) == found


def test_what_an_fmu_cannot_set_is_left_out_and_said() -> None:
    scope = drawn.Scope(EVERYTHING.settable - {"F_ext"}, EVERYTHING.changeable - {"F_ext"})
    sequences = draw_sequences(seed=7, count=12, scope=scope)
    cases = [each.case for each in sequences]
    assert {case.start["F_ext"] for case in cases} == {0.0}
    assert not any("F_ext" in step.changes for case in cases for step in case.steps)
    assert "it cannot set F_ext" in coverage_table(sequences, 7, scope).note


def test_each_sequence_is_run_plainly_and_in_one_other_manner() -> None:
    cases = [each.case for each in SOME]
    pairs = Counter(manner.manner for _, manner in drawn.tried(cases, list(BY_MANNER.values())))
    assert pairs.pop(PLAIN) == sum(pairs.values()) == len(SOME)
    assert max(pairs.values()) - min(pairs.values()) <= 1


@pytest.mark.parametrize("manner", sorted(MANNERS))
def test_our_fmu_gives_the_exact_motion_in_every_manner(manner: str) -> None:
    file = FmuFile(built("python-2"))
    for sequence in SOME[:4]:
        empty = of_invariant(BY_MANNER[manner], sequence.case.id, EXACT_CONTRACT)
        exact = kept(exact_motion, sequence.case)
        run = MANNERS[manner](file, sequence.case)
        result = judge_sequence(empty, EXACT_CONTRACT, exact, run)
        assert result.passed, result
        if manner in ("unread", "busy"):
            assert run.times.tolist() == [sequence.case.stop_time]
        else:
            assert run.times.size == len(sequence.case.steps)
