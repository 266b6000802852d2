"""The score of measurements: exact motions with noise of any kind, drift, counts of an encoder."""

import itertools
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from scipy.signal import lfilter

from stickslip_score import Cause, Curve, Score, score
from stickslip_verification import truth
from tests.score import curve_makers as makers
from tests.score.curve_makers import Floats, Made, exact, stepped, with_defaults

QUANTITIES = ("period", "t_stick", "t_slip", "delta_x")
INNOCENT = {Cause.EXACT, Cause.NOISY}
SOLVER = {Cause.FIXED_STEP, Cause.REGULARISED}
ROUNDING = 1e-11
"""Relative: the reference is right to 4e-14 of mu_s/(mu_s - mu_k) (docs/theory.md (17))."""

SETTINGS: Mapping[str, Mapping[str, float]] = {
    "default": {},
    "damped": {"c": 2.0, "v": 0.01},
    "stiff axis, backward": {
        "m": 20.0, "k": 5e5, "v": -5e-3, "mu_s": 0.25, "mu_k": 0.15, "load": 30.0, "F_ext": 4.0,
    },
    "mostly slip": {"v": 0.1, "mu_s": 0.4, "mu_k": 0.25},
    "slow": {"v": 2e-3, "k": 4000.0},
}  # fmt: skip
"""lambda is 3.1, 5.6, 1.5, 0.47 and 19."""

SAMPLINGS = (1e-4, 3e-4, 1e-3, 3e-3, 1e-2)
"""Steps between samples [s]."""

NOISES = ((0.0, ""), *((part, on) for part in (1e-4, 1e-3, 1e-2) for on in ("x", "F", "x F")))
"""Part of the swing of a signal over a steady cycle, and the signals that carry it."""

FEW = (("default", 1e-3), ("stiff axis, backward", 1e-3), ("slow", 1e-2))
"""Settings and samplings of `make test`; the soak tries all."""


@dataclass(frozen=True)
class Exact:
    """An exact motion, the spring's swing over a steady cycle [m], and the period [s]."""

    p: Mapping[str, float]
    made: Made
    swing: float
    period: float

    def noisy(self, noise: Mapping[str, Floats | float], columns: Iterable[str]) -> Curve:
        """Return columns with noise on them, in parts of the swing."""
        unit = {"x": self.swing, "F": self.swing * self.p["k"]}
        given = {n: getattr(self.made, n) + unit[n] * noise.get(n, 0.0) for n in columns}
        return Curve.of(self.made.t, **given)

    def cut(self, chosen: slice) -> "Exact":
        return Exact(self.p, self.made.rows(chosen), self.swing, self.period)


@cache
def exact_motion(setting: str, step: float) -> Exact:
    """Give the reference's motion over the first load-up and eight cycles."""
    p = with_defaults(SETTINGS[setting])
    cycle = truth.steady_cycle({**p, "v": abs(p["v"])}, digits=20)
    assert cycle is not None
    period = float(cycle["T"])
    N = p["m"] * p["g"] + p.get("load", 0.0)
    direction = math.copysign(1.0, p["v"])
    begin = (p["mu_s"] * N - direction * p.get("F_ext", 0.0)) / (p["k"] * abs(p["v"]))
    times = step * np.arange(round((begin + 8.0 * period) / step), dtype=np.float64)
    made = exact(p, times)
    return Exact(p, made, float(np.ptp(made.F[times > begin])) / p["k"], period)


def ratios(scores: Sequence[Score]) -> Floats:
    """Return the errors of figures in parts of their resolution."""
    figures = [getattr(each, name) for each in scores for name in QUANTITIES]
    return np.array([
        max(abs(each.error) - ROUNDING * abs(each.exact), 0.0) / each.resolution
        for each in figures
        if each.error is not None
    ])  # fmt: skip


def assert_honest(scores: Sequence[Score]) -> None:
    """No exact motion is a solver's, and 95 % of the figures are within their resolution."""
    guilty = [each.explanation for each in scores if each.cause not in INNOCENT]
    assert len(guilty) <= 0.01 * len(scores), guilty
    assert np.mean(ratios(scores) <= 1.0) >= 0.95


GRID = [
    pytest.param(*cell, marks=() if cell in (*FEW, ("damped", 3e-3)) else pytest.mark.soak)
    for cell in itertools.product(SETTINGS, SAMPLINGS)
]


@pytest.mark.parametrize(("setting", "step"), GRID)
def test_exact_motion_with_noise_is_no_solver_and_no_figure_misleads(
    setting: str, step: float, pytestconfig: pytest.Config
) -> None:
    motion = exact_motion(setting, step)
    clean: list[Score] = []
    noisy: list[Score] = []
    for number, (noise, on) in enumerate(NOISES):
        # Another seed for each noise, in the soak a hundred.
        for seed in range(100) if pytestconfig.getoption("soak") else [number]:
            random = np.random.default_rng([seed, number])
            both = ("x F", "x", "F")[seed % 3]
            columns = both if on in ("", "x F") or seed % 2 else on
            # It begins at rest or anywhere, and ends anywhere.
            size = motion.made.t.size
            first = 0 if seed % 3 == 0 else int(random.integers(size // 3))
            last = size - int(random.integers(int(motion.period / step)))
            part = motion.cut(slice(first, last))
            on_it = {name: noise * random.standard_normal(last - first) for name in on.split()}
            result = score(part.noisy(on_it, columns.split()), motion.p)
            assert result.cause not in SOLVER, (noise, on, seed, result.explanation)
            (noisy if set(columns.split()) <= set(on.split()) else clean).append(result)
    assert_honest(clean + noisy)
    # An error of noise is 0.22 of its three standard deviations in the median: no idle bound.
    assert 0.02 < np.median(ratios(noisy)) < 0.5


@pytest.fixture
def default() -> Exact:
    return exact_motion("default", 1e-3)


@pytest.mark.parametrize("noisy", ["x", "F", "xF"])
def test_the_noise_of_each_column_is_told(default: Exact, noisy: str) -> None:
    random = np.random.default_rng(3)
    noise = {name: 1e-3 * random.standard_normal(default.made.t.size) for name in noisy}
    result = score(default.noisy(noise, "xF"), default.p)
    assert result.cause == "exact"
    # A standard deviation of 1,000 samples is right to 2 %, one standard deviation.
    size = 1e-3 * default.swing
    assert result.x_noise == pytest.approx(size * ("x" in noisy), rel=0.1)
    assert result.F_noise == pytest.approx(size * default.p["k"] * ("F" in noisy), rel=0.1)


def test_noise_that_hides_the_friction_is_named_with_its_size() -> None:
    motion = exact_motion("default", 1e-2)
    short = motion.cut(slice(-round(1.2 * motion.period / 1e-2), None))
    white = np.random.default_rng(1).standard_normal(short.made.t.size)
    result = score(short.noisy({"x": white}, "x"), motion.p)
    assert result.cause == "noisy"
    assert "mm rms, hides the motion" in result.explanation


def counted(motion: Exact, count: float, dither: float, white: Floats) -> Floats:
    """Return a position as counts of an encoder, each so large a part of the swing."""
    size = count * motion.swing
    return np.asarray(size * np.round(motion.made.x / size + dither * white))


def with_noise(column: Floats, size: float, noise: Floats | None = None) -> Floats:
    white = np.random.default_rng(6).standard_normal(column.size)
    return np.asarray(column + size * (white if noise is None else noise))


Record = Callable[[Exact, Floats], Floats]
ALIKE, MEAN = ([1.0], [1.0, -0.9]), (np.ones(10) / 10.0, [1.0])
RECORDS: Mapping[str, Record] = {
    "neighbours alike": lambda m, w: with_noise(m.made.x, 0.004 * m.swing, lfilter(*ALIKE, w)),
    "averaged": lambda m, w: with_noise(m.made.x, 0.01 * m.swing, lfilter(*MEAN, w)),
    "of half the swing": lambda m, w: with_noise(m.made.x, 0.5 * m.swing, w),
    "fine counts": lambda m, w: counted(m, 2e-4, 0.0, w),
    "dithered counts": lambda m, w: counted(m, 1.0 / 37.3, 0.3, w),
    "coarse counts": lambda m, w: counted(m, 1.0 / 12.7, 0.0, w),
}


@pytest.mark.parametrize("record", RECORDS)
def test_noise_of_any_colour_and_counts_of_an_encoder_are_no_solver(record: str) -> None:
    scores = []
    for number, (setting, step) in enumerate(FEW):
        motion = exact_motion(setting, step)
        white = np.random.default_rng(number).standard_normal(motion.made.t.size)
        scores.append(score(Curve.of(motion.made.t, x=RECORDS[record](motion, white)), motion.p))
    assert_honest(scores)


DRIFTS: Mapping[str, Callable[[Floats], Floats]] = {
    "evenly": lambda part: 0.1 * part,
    "warming up": lambda part: 0.2 * (1.0 - np.exp(-3.0 * part)),
    "there and back": lambda part: 0.05 * np.sin(2.0 * np.pi * part),
}


@pytest.mark.parametrize("drift", DRIFTS)
@pytest.mark.parametrize("noise", [0.0, 0.002])
def test_a_zero_of_the_force_that_drifts_is_told_and_x_beside_it_stays_exact(
    default: Exact, drift: str, noise: float
) -> None:
    t = default.made.t
    off = DRIFTS[drift](t / t[-1]) + noise * np.random.default_rng(2).standard_normal(t.size)
    alone = score(default.noisy({"F": off}, "F"), default.p)
    assert alone.cause == "other"
    assert "zero of the force sensor drifts" in alone.explanation
    # A hundredth of a percent of a period is a tenth of a sample.
    assert alone.period.error == pytest.approx(0.0, abs=1e-4)
    both = score(default.noisy({"F": off}, "xF"), default.p)
    assert both.cause == "exact", both.explanation
    assert any("drifts" in finding for finding in both.findings)


@pytest.mark.parametrize("noise", [0.0, 1e-3])
@pytest.mark.parametrize("column", ["x", "F"])
def test_a_record_shorter_than_a_cycle_is_no_solver(column: str, noise: float) -> None:
    motion = exact_motion("default", 1e-2)
    random = np.random.default_rng(4)
    steady = np.searchsorted(motion.made.t, motion.made.t[-1] - 4.0 * motion.period)
    samples = motion.period / 1e-2
    for part, begin in itertools.product((0.3, 0.95), (0.0, 0.25, 0.5, 0.75)):
        at = int(steady + begin * samples)
        short = motion.cut(slice(at, at + int(part * samples)))
        white = noise * random.standard_normal(short.made.t.size)
        result = score(short.noisy({column: white}, column), motion.p)
        assert result.cause in (INNOCENT if noise else {Cause.EXACT}), (part, begin)


@pytest.mark.parametrize("columns", ["x", "F", "xF"])
def test_a_pull_against_the_given_v_is_judged_as_it_is(columns: str) -> None:
    made = exact({"v": -0.02}, np.linspace(0.0, 3.0, 3001))
    white = 1e-3 * np.random.default_rng(5).standard_normal(made.t.size)
    backward = Exact(with_defaults({}), made, 4e-3, 0.0)
    result = score(backward.noisy(dict.fromkeys(columns, white), columns), {"v": 0.02})
    assert result.cause == "exact", result.explanation
    assert result.delta_x.exact is not None
    assert result.delta_x.exact < 0.0
    assert np.all(ratios([result]) <= 1.0)
    assert "against the given v" in result.findings[0]


@pytest.mark.parametrize(
    ("wrong", "cause", "words"),
    [
        ({"mu_s": 0.505}, "other", "(mu_s - mu_k) N 2.5 % larger"),
        ({"m": 1.02}, "other", "k/m is 1.9"),
        ({"v": 0.0204}, "other", "advances at 20.4 mm/s"),
        ({"mu_s": 0.3}, "single_coefficient", "one friction coefficient"),
    ],
)
def test_another_block_is_told_through_noise(
    wrong: dict[str, float], cause: str, words: str
) -> None:
    made = exact(wrong, np.linspace(0.0, 3.0, 3001))
    result = score(Curve.of(made.t, x=with_noise(made.x, 5e-6)), {})
    assert result.cause == cause, result.explanation
    assert words in result.explanation


def test_a_record_with_noise_is_not_called_computed() -> None:
    times = np.linspace(0.0, 3.0, 3001)
    for made in (
        stepped(makers.verlet, {}, 3.0, 1e-3),
        makers.tanh_friction({}, times, 1e-3, peak=False),
        makers.tanh_friction({}, times, 1e-2, peak=True),
    ):
        for size, more in ((1e-6, {}), (1e-6, {"F": made.F}), (1e-4, {"F": made.F})):
            result = score(Curve.of(made.t, x=with_noise(made.x, size), **more), {})
            assert result.cause not in SOLVER, result.explanation


@pytest.mark.parametrize(("p", "end"), [({"c": 500.0, "v": 0.1}, 1.0), ({"c": 5.0, "v": 0.2}, 3.0)])
@pytest.mark.parametrize("size", [1e-6, 1e-4])
def test_noise_makes_no_creep_of_a_slide(p: dict[str, float], end: float, size: float) -> None:
    made = exact(p, np.linspace(0.0, end, 2001))
    for given in ({"x": with_noise(made.x, size)}, {"F": with_noise(made.F, 1e3 * size)}):
        result = score(Curve.of(made.t, **given), p)
        assert result.cause in INNOCENT, result.explanation
