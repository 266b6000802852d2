"""The random sequences: what happens in them, and that every manner gives the exact motion."""

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from stickslip_verification import truth
from stickslip_verification.drive.exact import exact_motion
from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.manners import MANNERS
from stickslip_verification.judge.band import of_any_sequence
from stickslip_verification.judge.checks import EXACT_CONTRACT, judge_in_band
from stickslip_verification.judge.invariant_checks import blank
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.run.coverage import coverage_table, gaps
from stickslip_verification.suite.invariants import load_invariants
from stickslip_verification.suite.sequences import (
    CELLS,
    COUNT,
    CRITICAL,
    EVERYTHING,
    PLAIN,
    REVERSED,
    STICK,
    Cell,
    RandomSequence,
    Scope,
    coverage,
    draw_sequences,
    tried,
)

SMALLEST_MARGIN = 1e-6
FEW = draw_sequences(seed=7, count=18)
BY_MANNER = {each.manner: each for each in load_invariants().sequences}


def test_the_same_seed_gives_the_same_sequences() -> None:
    """A seed names a set for ever; another one gives other motions."""
    assert draw_sequences(seed=7, count=18) == FEW
    assert draw_sequences(seed=8, count=1)[0].case != FEW[0].case
    # The first of many are the few: a failure is repeated without the rest.
    assert draw_sequences(seed=7, count=5) == FEW[:5]


@pytest.mark.parametrize("seed", [1, 2, 20261122])
def test_every_change_meets_every_phase_at_every_damping(seed: int) -> None:
    """Whatever the seed, no cell of the table is empty, and at most half as many more are drawn."""
    sequences = draw_sequences(seed)
    counts = coverage(sequences)
    assert [cell for cell in CELLS if not counts[cell]] == []
    assert COUNT <= len(sequences) <= 1.5 * COUNT
    assert list(gaps(sequences, EVERYTHING, EXACT_CONTRACT, [BY_MANNER[PLAIN]])) == []


def test_an_empty_cell_is_a_failure_of_the_suite() -> None:
    """Sequences that should fill the table and leave a cell empty fail the verdict, by its name."""
    cell = Cell("load", STICK, CRITICAL)
    thinned = [
        RandomSequence(each.case, tuple(c for c in each.cells if c != cell))
        for each in draw_sequences()
    ]
    (failed,) = gaps(thinned, EVERYTHING, EXACT_CONTRACT, [BY_MANNER[PLAIN]])
    assert failed.failed
    assert failed.failure is not None
    assert failed.failure.endswith("random sequences have no load, stick, critical")
    assert list(gaps(FEW, EVERYTHING, EXACT_CONTRACT, [BY_MANNER[PLAIN]])) == []


def phase_before(run: truth.Run, x_dot_start: float, time: float) -> str:
    """Name the phase of an exact run just before a time, from its events and its start."""
    mode, reversed_ = int(np.sign(x_dot_start)), False
    for event in run.events:
        # A change is dated by the sum of the steps, to its rounding.
        if event.time > time - 1e-12:
            break
        mode, reversed_ = event.mode, event.kind == "reversal"
    if reversed_:
        return REVERSED
    return STICK if mode == 0 else "forward slip" if mode > 0 else "backward slip"


@pytest.mark.parametrize("number", range(len(FEW)))
def test_what_is_counted_happens_in_the_exact_motion(number: int) -> None:
    """The motion in 50 digits has the phases that were counted in doubles, and decides clearly."""
    case, cells = FEW[number].case, FEW[number].cells
    run = truth.run(case.parameters, [truth.Step(s.h, dict(s.changes)) for s in case.steps])
    assert run.margin >= 0.5 * SMALLEST_MARGIN
    times = (0.0, *case.times)
    found = Counter(
        phase_before(run, case.start["x_dot_start"], time)
        for time, step in zip(times, case.steps, strict=False)
        if step.changes and time > 0.0
    )
    of_changes = [cell for cell in cells if cell.row in EVERY_CHANGE]
    assert Counter(cell.phase for cell in of_changes) == found


EVERY_CHANGE = {cell.row for cell in CELLS if EVERYTHING.hindrance(cell) is None} - {
    "load and F_ext from the start",
    "x_dot_start",
    "any change, mu_s above 1",
    "any change, v = 0",
}


def test_what_an_fmu_cannot_set_is_left_out_and_said() -> None:
    """Without F_ext no sequence sets it, and the table says which cells that empties."""
    scope = Scope(EVERYTHING.settable - {"F_ext"}, EVERYTHING.changeable - {"F_ext"})
    sequences = draw_sequences(seed=7, count=12, scope=scope)
    for each in sequences:
        assert each.case.start["F_ext"] == 0.0
        assert not any("F_ext" in step.changes for step in each.case.steps)
    assert "it cannot set F_ext" in coverage_table(sequences, 7, scope).note
    assert coverage_table(draw_sequences(), 1, EVERYTHING).note == ""


def test_each_sequence_is_run_plainly_and_in_one_other_manner() -> None:
    """Every manner gets its share, and none of the suite's manners is without an invariant."""
    pairs = Counter(
        manner.manner for _, manner in tried([each.case for each in FEW], list(BY_MANNER.values()))
    )
    assert set(pairs) == set(MANNERS)
    assert pairs.pop(PLAIN) == len(FEW)
    assert sum(pairs.values()) == len(FEW)
    assert max(pairs.values()) - min(pairs.values()) <= 1


@pytest.mark.parametrize("manner", sorted(MANNERS))
def test_our_fmu_gives_the_exact_motion_in_every_manner(manner: str, fmu_path: Path) -> None:
    """All outputs, within the bound for any sequence, at each point that the manner reads."""
    file = FmuFile(fmu_path)
    for sequence in FEW[:6]:
        empty = blank(BY_MANNER[manner], sequence.case.id, EXACT_CONTRACT)
        band = of_any_sequence(exact_motion(sequence.case))
        run = MANNERS[manner](file, sequence.case)
        result = judge_in_band(empty, OUTPUT_NAMES, EXACT_CONTRACT, band, run)
        assert result.passed, result
        last = run.times.size == 1 and run.times[0] == sequence.case.stop_time
        assert last if manner in ("unread", "busy") else run.times.size == len(sequence.case.steps)
