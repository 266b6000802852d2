"""A fixed tenth of every random set, and facts about how the sets are drawn and counted."""

import math
from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import partial
from pathlib import Path
from random import Random

import pytest

from stickslip_verification import RandomTestResult, prove
from stickslip_verification.random_sets import cycles as random_cycles
from stickslip_verification.random_sets import draws
from stickslip_verification.random_sets import sequences as random_sequences
from stickslip_verification.random_sets.tally import Tally

SEED = 1
TENTH = 0.1

Running = Iterator[RandomTestResult | None]

OF_THE_FMU: dict[str, Callable[[Path, int, float], Running]] = {
    "cycle": random_cycles.fmu_cycle,
    "damped cycle": random_cycles.damped_cycle,
    "million cycles": random_cycles.million_cycles,
    "sequences": random_sequences.split_and_truth,
    "tuned sequences": partial(random_sequences.split_and_truth, tunable=True),
    "energy": random_sequences.energy,
    "no hidden scale": random_sequences.no_hidden_scale,
}


@pytest.mark.parametrize("random_test", OF_THE_FMU.values(), ids=OF_THE_FMU)
def test_the_fmu_holds_on_a_tenth_of_each_set(
    random_test: Callable[[Path, int, float], Running], fmu_path: Path
) -> None:
    """What is claimed of the FMU holds on the first tenth of each random set."""
    results = [result for result in random_test(fmu_path, SEED, TENTH) if result is not None]
    assert results
    assert [result for result in results if not result.passed] == []


@pytest.mark.parametrize(
    "random_test",
    [random_cycles.reference_cycle, random_cycles.reference_formulas],
    ids=lambda random_test: random_test.__name__,
)
def test_the_reference_holds_on_a_tenth_of_each_set(
    random_test: Callable[[int, float], Running],
) -> None:
    """What is claimed of the reference holds on the first tenth of each random set."""
    results = [result for result in random_test(SEED, TENTH) if result is not None]
    assert results
    assert [result for result in results if not result.passed] == []


def test_all_random_tests_run_in_one_call(fmu_path: Path) -> None:
    """`prove` runs every set, tells its progress, and judges both sides."""
    told: set[str] = set()
    results = prove(fmu_path, seed=2, fraction=0.001, progress=lambda name, *_: told.add(name))
    assert {result.side for result in results} == {"fmu", "reference"}
    assert len({result.name for result in results}) == len(results)
    assert len(told) == 9
    assert all(result.passed for result in results)
    with pytest.raises(ValueError, match="fraction = 0"):
        prove(fmu_path, fraction=0.0)


@pytest.mark.parametrize("random_test", OF_THE_FMU.values(), ids=OF_THE_FMU)
def test_an_fmu_that_cannot_be_asked_is_refuted(
    random_test: Callable[[Path, int, float], Running], foreign_fmu: Path
) -> None:
    """An FMU without the block's variables fails every draw with the reason, and ends nothing."""
    results = [result for result in random_test(foreign_fmu, SEED, 0.001) if result is not None]
    of_fmu = [result for result in results if result.side == "fmu"]
    assert of_fmu
    for result in of_fmu:
        assert result.refuted == result.judged > 0
        assert "has no variable" in result.where


@pytest.mark.parametrize("h", [0.3, 1e-6, 7.0, 399.0, 12345.678])
def test_a_split_step_is_the_whole_step(h: float) -> None:
    """The pieces of a step sum to it exactly and are no shorter than 1e-13 s, or its last place."""
    draw = Random(3)
    for pieces in (None, None, None, 1000):
        steps = draws.split(draw, h, pieces)
        assert sum(map(Fraction, steps)) == Fraction(h)
        assert min(steps) > 0.0
        assert len(steps) > 3


def test_a_set_is_named_by_its_seed() -> None:
    """The same seed draws the same set; a smaller share is its beginning."""
    whole = [p for p, _ in random_cycles.undamped_points(7, 0.01)]
    part = [p for p, _ in random_cycles.undamped_points(7, 0.005)]
    assert len(whole) == 60
    assert whole[:25] == part[:25]
    assert [p for p, _ in random_cycles.undamped_points(8, 0.01)] != whole


def test_the_damped_points_lie_on_both_sides() -> None:
    """A good share of the damped draws has a cycle, a good share has none, all are decidable."""
    distances = [d for _, d, _ in random_cycles.damped_points(SEED, 0.2)]
    assert 50 < sum(d > 0 for d in distances) < 150
    assert min(map(abs, distances)) > random_cycles.DECIDABLE


def test_a_draw_beyond_its_bound_refutes() -> None:
    """One ratio above 1, or one that is no number, refutes; the worst is told with its draw."""
    for bad in (1.5, math.nan):
        tally = Tally("name", "fmu", "bound", SEED)
        tally.judge({"T": 0.2}, "first")
        tally.judge({"T": 0.1, "t_slip": bad}, "second")
        result = tally.result()
        assert not result.passed
        assert (result.refuted, result.judged) == (1, 2)
        assert result.where == "t_slip of draw 2: second"


def test_too_many_undecided_draws_refute() -> None:
    """A set of which one in a hundred is left out proves nothing."""
    for left_out, passed in ((1, True), (2, False)):
        tally = Tally("name", "fmu", "bound", SEED, most_left_out=0.01)
        for _ in range(left_out):
            tally.leave_out()
        for _ in range(200 - left_out):
            tally.judge({"T": 0.0}, "draw")
        assert tally.result().passed is passed


def test_a_missed_slip_refutes() -> None:
    """A motion with one slip less than another is infinitely far from it."""
    states = [dict.fromkeys((*random_sequences.MEASURED, *random_sequences.COUNTED), 1.0)]
    fewer = [{**states[0], "n_slips": 0.0}]
    later = [{**states[0], "x": 1.0 + 1e-9}]
    scale = dict.fromkeys(random_sequences.MEASURED, 1.0)
    assert max(random_sequences.apart(states, states, scale, 1e-12).values()) == 0.0
    assert random_sequences.apart(fewer, states, scale, 1e-12)["n_slips"] == math.inf
    assert random_sequences.apart(later, states, scale, 1e-12)["x"] == pytest.approx(
        1000.0, rel=1e-6
    )
