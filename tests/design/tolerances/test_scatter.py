"""How likely an axis jumps, against series whose probability is known in closed form."""

import json
import math
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from scipy.special import ndtri

from stickslip_design.axis import AxisFile, axis_file_of, example
from stickslip_design.chunks import Results, Study, run
from stickslip_design.points.axes import EVEN, STICKS
from stickslip_design.tolerances.indices import Mixed
from stickslip_design.tolerances.nominal import Turns
from stickslip_design.tolerances.probability import interval, probability
from stickslip_design.tolerances.question import question
from stickslip_design.tolerances.result import Scatter
from stickslip_design.tolerances.samples import Population, Samples
from stickslip_design.tolerances.study import answer, scatter
from stickslip_design.tolerances.words import sentences
from tests.needs import needs

from .series import MU_K, SERIES, gap, series, share_that_jumps

MU_S = "normal 0.2 0.02"
BOTH = {"friction.mu_s": MU_S, "friction.mu_k": "normal 0.15 0.015"}


def here(study: Study, name: str) -> Results:
    """Compute a study in this process."""
    return run(study, workers=1)


def asked(file: AxisFile | None = None, **arguments: Any) -> Scatter:
    """Return the answer for a series, without Sobol indices."""
    return answer(question(file or series(), **{"indices": 0, **arguments}), here)


def test_probabilities_agree_with_the_closed_case_in_95_of_100_trials() -> None:
    """2,000 trials of 500 machines each, at feeds where 3 to 97 % jump.

    The critical feed is proportional to mu_s - mu_k, so that the share of a normal mu_s is known.
    """
    trials, machines = 2000, 500
    feeds = tuple(
        float((0.2 - MU_K + 0.02 * ndtri(share)) / gap(1.0)) for share in (0.03, 0.2, 0.5, 0.9)
    )
    population = question(series(), vary={"friction.mu_s": MU_S}, seed=20).population
    found = Samples(population, feeds, trials * machines, regimes_only=True).compute(
        0, trials * machines
    )
    held = []
    for place, feed in enumerate(feeds, 1):
        hits = (found[f"regime {place}"].reshape(trials, machines) == STICKS).sum(axis=1)
        low, high = interval(hits.astype(np.float64), np.full(trials, float(machines)))
        truth = share_that_jumps(feed, (0.2, 0.02))
        held.append(float(np.mean((low <= truth) & (truth <= high))))
    assert [0.94 < each < 0.96 for each in held] == [True] * len(feeds), held


@pytest.mark.parametrize("rho", [-0.5, 0.0, 0.8])
def test_correlation_changes_the_probability_as_the_closed_case_does(rho: float) -> None:
    """The difference of two correlated normals is normal."""
    feed = 0.03 / gap(1.0)
    found = asked(vary=BOTH, feeds=[feed], correlation={("friction.mu_s", "friction.mu_k"): rho})
    truth = share_that_jumps(feed, (0.2, 0.02), (0.15, 0.015), rho)
    jumps = found.outcomes[0].jumps
    # Four standard errors of a share.
    assert jumps.value == pytest.approx(truth, abs=4.0 * math.sqrt(truth * (1.0 - truth) / 1e5))
    assert jumps.low < jumps.value < jumps.high
    assert jumps.value + found.outcomes[0].even.value == pytest.approx(1.0, abs=1e-15)


def test_clamp_is_counted_each_time_it_acts() -> None:
    """It acts where mu_k is above mu_s, and those machines never jump."""
    found = asked(vary=BOTH, samples=20_000)
    mu_s, mu_k = (
        found.columns[name].astype(np.float64) for name in ("friction.mu_s", "friction.mu_k")
    )
    above = mu_k > mu_s
    assert 0 < found.clamped == above.sum()
    assert_array_equal(found.columns["clamped"], above)
    assert np.all(found.columns["critical_feed"][above] == 0.0)
    truth = 1.0 - share_that_jumps(0.0, (0.2, 0.02), (0.15, 0.015))
    assert found.clamped / 20_000 == pytest.approx(truth, abs=4.0 * math.sqrt(truth / 20_000))
    told = next(each for each in sentences(found) if "mu_k came above mu_s" in each)
    assert f"in {found.clamped} of 20000 machines" in told


def test_quantiles_are_those_of_the_machines_that_jump() -> None:
    """A machine that runs evenly has a jump of 0, which has no part in them."""
    found = asked(vary={"friction.mu_s": MU_S}, feeds=[0.05 / gap(1.0)], samples=2000)
    jumps = found.columns["jump 1"].astype(np.float64)
    assert 0 < np.count_nonzero(jumps) < 2000
    assert found.outcomes[0].jump == pytest.approx(
        np.quantile(jumps[jumps > 0.0], [0.05, 0.5, 0.95]), rel=1e-15
    )


@pytest.mark.parametrize("sigma", [0.005, 0.02])
def test_nominal_value_that_holds_a_share_is_that_of_the_closed_case(sigma: float) -> None:
    """99 % run evenly where mu - mu_k - gap is -2.33 sigma, and sigma grows and shrinks with mu."""
    feed, relative = 0.03 / gap(1.0), sigma / 0.2
    found = asked(
        vary={"friction.mu_s": f"normal 0.2 {sigma}"}, samples=50_000, hold=(0.99, feed),
        solve="friction.mu_s",
    ).solved  # fmt: skip
    assert found is not None
    truth = (MU_K + 0.03) / (1.0 + relative * float(ndtri(0.99)))
    assert found.at_most
    assert found.low < truth < found.high
    assert found.low < found.value < found.high
    # Half the width of the interval: the sampling error of the quantile.
    assert found.high - found.low < 0.01 * truth
    assert found.checked.low < 0.99 < found.checked.high
    # The even side of each turn: what is promised is kept by the machines drawn.
    assert found.checked.value >= 0.99
    now = share_that_jumps(feed, (0.2, sigma))
    assert found.share_now.value == pytest.approx(1.0 - now, abs=0.01)


def test_number_that_does_not_vary_is_solved_for_upwards() -> None:
    """More damping makes more machines even: the least zeta, where the file states zeta."""
    feed = 0.06 / gap(1.0)
    found = asked(
        vary={"friction.mu_s": MU_S}, samples=5000, hold=f"90 % at {1e3 * feed} mm/s",
        solve="axis.zeta", within="0.02..0.5",
    ).solved  # fmt: skip
    assert found is not None
    assert not found.at_most
    assert found.now == 0.05
    assert found.low < found.value < found.high
    assert found.within == pytest.approx((0.02, 0.5))
    again = asked(
        series(zeta=str(found.value)), vary={"friction.mu_s": MU_S}, samples=5000, feeds=[feed]
    )
    # The same machines: only the last place of the factor can differ.
    assert again.outcomes[0].even.value == pytest.approx(0.9, abs=2.0 / 5000)


@pytest.mark.parametrize(
    ("within", "said"),
    [((0.19, 0.21), "no value in its range does it"), ((0.05, 0.1), "every value in its range")],
)
def test_share_that_cannot_be_reached_is_told_with_those_at_the_ends(
    within: tuple[float, float], said: str
) -> None:
    """The rest of the answer stands."""
    feed = 0.03 / gap(1.0)
    found = asked(
        vary={"friction.mu_s": MU_S}, samples=20_000, within=within, hold=(0.99, feed),
        solve="friction.mu_s",
    )  # fmt: skip
    assert found.solved is not None
    assert math.isnan(found.solved.value)
    truth = [1.0 - share_that_jumps(feed, (mu, 0.1 * mu)) for mu in within]
    assert found.solved.at_ends == pytest.approx(truth, abs=4.0 * 0.5 / math.sqrt(20_000))
    assert said in list(sentences(found))[-1]


def test_machines_that_turn_back_have_no_one_value(monkeypatch: pytest.MonkeyPatch) -> None:
    """Even at both ends of the range and jumping between: no share has one value."""

    def banded(file: AxisFile, changes: Any, feed: float, **_: Any) -> dict[str, Any]:
        within = np.abs(np.log(changes["friction.mu_s"] / 0.2)) < 1.0
        return {"regime": np.where(within, STICKS, EVEN)}

    monkeypatch.setattr("stickslip_design.tolerances.nominal.axis_points", banded)
    found = asked(vary={"friction.mu_s": MU_S}, samples=50, hold=(0.9, 1e-3), solve="friction.mu_s")
    assert found.solved is not None
    assert found.solved.unsolved.startswith("50 of 50 machines turn back again in its range")
    assert math.isnan(found.solved.value)


@pytest.mark.parametrize(
    ("solve", "within", "message"),
    [
        ("axis.gravity", None, "axis.gravity is no number that the file states"),
        ("axis.load", None, "axis.load is 0, and a number is solved for as a factor"),
        ("axis.mass", "600..500 kg", "reversed"),
        ("axis.mass", (600.0, 500.0), "empty or reversed range"),
        ("axis.load", "-1..1 N", "is 0"),
    ],
)
def test_number_that_cannot_be_solved_for_is_refused(solve: str, within: Any, message: str) -> None:
    """It must be one of the file, not 0, and its range must rise."""
    file = axis_file_of(SERIES.replace("[friction]", 'load = "0 N"\n[friction]'))
    with pytest.raises(ValueError, match=message):
        question(file, vary={"friction.mu_s": MU_S}, hold=(0.99, 1e-3), solve=solve, within=within)


def test_studies_are_the_same_to_the_bit_in_any_chunks() -> None:
    """Machines, mixtures and turns, in chunks of whole blocks, and sent to another process."""
    rigid = question(series(), vary=BOTH, correlation={("friction.mu_s", "friction.mu_k"): 0.5})
    population, feeds = rigid.population, (1e-3, 4e-3)
    studies: list[Study] = [
        Samples(population, feeds, 50_000),
        Mixed(population, feeds, 16_384),
        Turns(population, 1e-3, 20_000, "friction.mu_s", 0.5, 2.0),
    ]
    for study in studies:
        whole = study.compute(0, study.count)
        sent = pickle.loads(pickle.dumps(study))
        for start in range(0, study.count, study.quantum):
            part = sent.compute(start, min(start + study.quantum, study.count))
            for name, values in part.items():
                assert_array_equal(values, whole[name][start : start + study.quantum], name)


def test_first_machines_of_a_larger_sample_are_those_of_a_smaller() -> None:
    """A machine depends on the seed and its number alone."""
    population = question(series(), vary=BOTH, seed=3).population
    small, large = (Samples(population, (1e-3,), count) for count in (1000, 30_000))
    expected = small.compute(0, 1000)
    for name, values in large.compute(0, 30_000).items():
        assert_array_equal(values[:1000], expected[name])


def test_servo_axis_scatters_too() -> None:
    """Each machine of the loop is the file with its numbers, judged as `design` judges it."""
    from stickslip_design.critical import critical_feed

    vary = {"drive.K_v": "uniform 20..30 1/s", "friction.mu_s": "normal 0.2 3 %"}
    found = asked(
        axis_file_of(example()), vary=vary, samples=2, hold="50 % at 1.5 mm/s",
        solve="drive.K_v", within="15..60 1/s",
    )  # fmt: skip
    columns = found.columns
    for place in range(2):
        numbers = {name: float(columns[name][place]) for name in vary}
        limit = critical_feed(axis_file_of(example()).changed(numbers).axis())
        assert columns["critical_feed"][place] == limit
        regimes = [columns[f"regime {n}"][place] for n in (1, 2, 3)]
        assert regimes == [STICKS if feed <= limit else EVEN for feed in found.question.feeds]
    assert found.solved is not None
    assert found.solved.at_most
    assert math.isnan(found.solved.low)


@needs("studies")
def test_dataset_has_names_units_seed_and_provenance() -> None:
    """By sample, feed and parameter; the solved number is an attribute."""
    dataset = scatter(
        series(mu_s='"0.2 ± 10 %"', mass='"500 kg ± 2 %"'), feeds=["1 mm/s", 4e-3], samples=300,
        indices=64, seed=11, hold="60 % at 4 mm/s", solve="friction.mu_s", workers=1,
    )  # fmt: skip
    assert dict(dataset.sizes) == {"sample": 300, "feed": 2, "quantile": 3, "parameter": 2}
    assert dataset["jump"].dims == ("sample", "feed")
    units = {name: dataset[name].attrs["units"] for name in ("axis.mass", "critical_feed", "feed")}
    assert units == {"axis.mass": "kg", "critical_feed": "m/s", "feed": "m/s"}
    assert dataset.feed.values.tolist() == [1e-3, 4e-3]
    assert dataset.attrs["seed"] == "11"
    assert json.loads(dataset.attrs["inputs"])["seed"] == 11
    assert json.loads(dataset.attrs["solved"])["path"] == "friction.mu_s"
    share = (dataset["regime"] == STICKS).mean("sample")
    assert_array_equal(dataset["probability"], share)
    for place, value in enumerate(share.values.tolist()):
        ends = probability(round(300 * value), 300)
        assert dataset["probability_low"][place] == ends.low
        assert dataset["probability_high"][place] == ends.high
    # At 4 mm/s none jumps: there is no variance to split.
    assert dataset["sobol_total"].isnull().all("parameter").values.tolist() == [False, True]
    assert dataset["sobol_total"][0].sum() > 0.9


@needs("studies")
def test_study_resumes_in_its_folder_and_notices_another_question(tmp_path: Path) -> None:
    """The same question gives the same dataset; another seed in the folder is refused."""
    folder = str(tmp_path / "series")
    arguments: dict[str, Any] = {
        "vary": {"friction.mu_s": MU_S}, "samples": 500, "indices": 0, "folder": folder,
        "workers": 1,
    }  # fmt: skip
    first = scatter(series(), **arguments)
    assert scatter(series(), **arguments).identical(first)
    with pytest.raises(ValueError, match="--fresh"):
        scatter(series(), seed=1, **arguments)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"feeds": ["0 mm/s"]}, "feed 0 mm/s is out of range; it must be above 0"),
        ({"feeds": ["2"]}, "feed 2 has no unit; expected a velocity in m/s above 0"),
        ({"feeds": [math.nan]}, "feed nan is out of range"),
        ({"samples": 0}, "0 samples: at least 1 is needed"),
        ({"indices": 100}, "100 rows for Sobol indices: a power of two"),
        ({"seed": -1}, "the seed -1 is out of range"),
        ({"hold": "99 % at 2 mm/s"}, "given together"),
        ({"solve": "friction.mu_s"}, "given together"),
        ({"within": (0.1, 0.2)}, "goes with a number to solve for"),
        ({"hold": "99 %", "solve": "friction.mu_s"}, '"99 %" does not say what must hold'),
        ({"hold": "often at 2 mm/s", "solve": "friction.mu_s"}, "often is not a finite number"),
        ({"hold": "100 % at 2 mm/s", "solve": "friction.mu_s"}, "a share of 1 is out of range"),
        ({"correlation": {("friction.mu_s", "axis.mass"): 0.5}}, "axis.mass does not vary"),
    ],
)
def test_question_that_cannot_be_asked_is_refused_before_anything_is_computed(
    arguments: dict[str, Any], message: str
) -> None:
    """In one line that names what is wrong."""
    with pytest.raises(ValueError, match=message):
        question(series(), **{"vary": {"friction.mu_s": MU_S}, **arguments})


def test_axis_without_feeds_needs_one() -> None:
    """The file has none, and none is given."""
    file = axis_file_of('[axis]\nmass = "1 kg ± 1 %"\nstiffness = "1 N/m"\n'
                        "[friction]\nmu_s = 0.2\nmu_k = 0.1")  # fmt: skip
    with pytest.raises(ValueError, match="no feed is named"):
        question(file)


def test_population_refuses_correlations_that_cannot_be() -> None:
    """Where it is made, and not by a worker."""
    varied = question(series(), vary={"friction.mu_s": MU_S}).population.varied
    with pytest.raises(ValueError, match="must be -1 to 1"):
        Population(series(), {**varied, "x": varied["friction.mu_s"]},
                   {("friction.mu_s", "x"): 2.0}, 0)  # fmt: skip
