"""Part of every random set, and how the sets are drawn and counted."""

import math
from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import partial
from pathlib import Path
from random import Random

import pytest

from stickslip_verification import RandomTestResult, prove
from stickslip_verification.random_sets import cycles, draws, sequences
from stickslip_verification.random_sets.tally import Tally
from tests.makers import ODD

Running = Iterator[RandomTestResult | None]

OF_THE_FMU: dict[str, Callable[[Path, int, float], Running]] = {
    "cycle": cycles.fmu_cycle,
    "damped cycle": cycles.damped_cycle,
    "million cycles": cycles.million_cycles,
    "sequences": sequences.split_and_truth,
    "tuned sequences": partial(sequences.split_and_truth, tunable=True),
    "energy": sequences.energy,
    "no hidden scale": sequences.no_hidden_scale,
}


@pytest.fixture
def share(pytestconfig: pytest.Config) -> float:
    return 0.1 if pytestconfig.getoption("soak") else 0.02


def ends_of(running: Running) -> list[RandomTestResult]:
    return [result for result in running if result is not None]


@pytest.mark.parametrize("random_test", OF_THE_FMU.values(), ids=OF_THE_FMU)
def test_what_is_claimed_of_the_fmu_holds_on_part_of_each_set(
    random_test: Callable[[Path, int, float], Running], fmu_path: Path, share: float
) -> None:
    results = ends_of(random_test(fmu_path, 1, share))
    assert results
    assert [result for result in results if not result.passed] == []


def test_all_random_tests_run_in_one_call_and_tell_their_progress(fmu_path: Path) -> None:
    told: set[str] = set()
    results = prove(fmu_path, seed=2, fraction=0.001, progress=lambda name, *_: told.add(name))
    assert {result.side for result in results} == {"fmu", "reference"}
    assert len({result.name for result in results}) == len(results)
    assert len(told) == 9
    assert all(result.passed for result in results)
    with pytest.raises(ValueError, match="fraction = 0"):
        prove(fmu_path, fraction=0.0)


@pytest.mark.parametrize("random_test", OF_THE_FMU.values(), ids=OF_THE_FMU)
def test_an_fmu_without_the_variables_fails_every_draw_with_the_reason(
    random_test: Callable[[Path, int, float], Running],
) -> None:
    of_fmu = [r for r in ends_of(random_test(ODD.path, 1, 0.001)) if r.side == "fmu"]
    assert of_fmu
    for result in of_fmu:
        assert result.refuted == result.judged > 0
        assert "has no variable" in result.where


@pytest.mark.parametrize("h", [0.3, 1e-6, 7.0, 399.0, 12345.678])
def test_the_pieces_of_a_step_sum_to_it_exactly(h: float) -> None:
    draw = Random(3)
    for pieces in (None, None, None, 1000):
        steps = draws.split(draw, h, pieces)
        assert sum(map(Fraction, steps)) == Fraction(h)
        assert min(steps) > 0.0
        assert len(steps) > 3


def test_a_set_is_named_by_its_seed_and_a_smaller_share_is_its_beginning() -> None:
    whole = [p for p, _ in cycles.undamped_points(7, 0.01)]
    assert len(whole) == 60
    assert [p for p, _ in cycles.undamped_points(7, 0.005)][:25] == whole[:25]
    assert [p for p, _ in cycles.undamped_points(8, 0.01)] != whole


@pytest.mark.parametrize("bad", [1.5, math.nan])
def test_one_draw_beyond_its_bound_refutes_and_the_worst_is_told(bad: float) -> None:
    tally = Tally("name", "fmu", "bound", 1)
    tally.judge({"T": 0.2}, "first")
    tally.judge({"T": 0.1, "t_slip": bad}, "second")
    result = tally.result()
    assert (result.passed, result.refuted, result.judged) == (False, 1, 2)
    assert result.where == "t_slip of draw 2: second"


@pytest.mark.parametrize(("left_out", "passed"), [(1, True), (2, False)])
def test_a_set_of_which_one_in_a_hundred_is_left_out_proves_nothing(
    left_out: int, passed: bool
) -> None:
    tally = Tally("name", "fmu", "bound", 1, most_left_out=0.01)
    for _ in range(left_out):
        tally.leave_out()
    for _ in range(200 - left_out):
        tally.judge({"T": 0.0}, "draw")
    assert tally.result().passed is passed


@pytest.mark.parametrize(
    ("name", "value", "expected"),
    # Rounding of 1 + 1e-9.
    [("x", 1.0, 0.0), ("n_slips", 0.0, math.inf), ("x", 1.0 + 1e-9, pytest.approx(1e3, rel=1e-6))],
)
def test_a_motion_with_one_slip_less_is_infinitely_far(
    name: str, value: float, expected: float
) -> None:
    state = dict.fromkeys((*sequences.MEASURED, *sequences.COUNTED), 1.0)
    scale = dict.fromkeys(sequences.MEASURED, 1.0)
    assert sequences.apart([{**state, name: value}], [state], scale, 1e-12)[name] == expected
