"""The score of measurements: exact motions with noise of any kind, drift, counts of an encoder."""

import itertools
import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from scipy.signal import lfilter

from stickslip_score import Cause, Curve, Score, score
from stickslip_verification import truth
from tests.score import curve_makers as makers
from tests.score.curve_makers import Floats, Made, exact, ratios, stepped, with_defaults

INNOCENT = {Cause.EXACT, Cause.NOISY}
SOLVER = {Cause.FIXED_STEP, Cause.REGULARISED}

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


FEW = [("default", 1e-3), ("stiff axis, backward", 1e-3), ("slow", 1e-2)]
"""Settings and steps between samples [s] of `make test`; the soak tries more."""

GRID = [
    pytest.param(*cell, marks=() if cell in FEW else pytest.mark.soak)
    for cell in itertools.product(SETTINGS, (1e-4, 3e-4, 1e-3, 3e-3, 1e-2))
]
NOISES = ((0.0, ""), *((part, on) for part in (1e-4, 1e-3, 1e-2) for on in ("x", "F", "x F")))
"""Part of the swing of a signal over a steady cycle, and the signals that carry it."""


WHITE = np.random.default_rng(6).standard_normal(100_000)


@dataclass(frozen=True)
class Exact:
    """An exact motion, the spring's swing over a steady cycle [m], and the period [s]."""

    p: Mapping[str, float]
    made: Made
    swing: float
    period: float

    def noisy(self, noise: Mapping[str, Floats | float], columns: Iterable[str]) -> Curve:
        unit = {"x": self.swing, "F": self.swing * self.p["k"]}
        given = {n: getattr(self.made, n) + unit[n] * noise.get(n, 0.0) for n in columns}
        return Curve.of(self.made.t, **given)

    def cut(self, chosen: slice) -> "Exact":
        return Exact(self.p, self.made.rows(chosen), self.swing, self.period)


@cache
def exact_motion(setting: str, step: float) -> Exact:
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
    every = [*clean, *noisy]
    assert np.mean([result.cause in INNOCENT for result in every]) >= 0.99
    assert np.mean(ratios(*every) <= 1.0) >= 0.95
    # An error of noise is 0.22 of its three standard deviations in the median: no idle bound.
    assert 0.02 < np.median(ratios(*noisy)) < 0.5


@pytest.mark.parametrize("noise", [0.0, 0.01])
def test_a_force_that_is_delayed_or_filtered_is_late(noise: float) -> None:
    made = exact({}, 1e-3 * np.arange(3000.0))
    for F in (np.append(np.zeros(3), made.F[:-3]), lfilter([0.25], [1.0, -0.75], made.F)):
        result = score(Curve.of(made.t, x=made.x, F=F + noise * WHITE[:3000]), {})
        assert re.search(r"F is late by about (2\.[89]|3)\d* ms", result.explanation)


def test_noise_that_hides_the_friction_is_named_with_its_size() -> None:
    motion = exact_motion("default", 1e-2)
    short = motion.cut(slice(-round(1.2 * motion.period / 1e-2), None))
    result = score(short.noisy({"x": WHITE[: short.made.t.size]}, "x"), motion.p)
    assert result.cause == "noisy"
    assert "mm rms, hides the motion" in result.explanation


@pytest.mark.parametrize("noise", [0.0, 1e-3])
@pytest.mark.parametrize("column", ["x", "F"])
def test_a_record_shorter_than_a_cycle_is_no_solver(column: str, noise: float) -> None:
    motion = exact_motion("default", 1e-2)
    steady = np.searchsorted(motion.made.t, motion.made.t[-1] - 4.0 * motion.period)
    samples = motion.period / 1e-2
    for part, begin in itertools.product((0.3, 0.95), (0.0, 0.25, 0.5, 0.75)):
        at = int(steady + begin * samples)
        short = motion.cut(slice(at, at + int(part * samples)))
        white = WHITE[at:][: short.made.t.size]
        result = score(short.noisy({column: noise * white}, column), motion.p)
        assert result.cause in (INNOCENT if noise else {Cause.EXACT}), (part, begin)


@pytest.mark.parametrize("columns", ["x", "F"])
def test_a_pull_against_the_given_v_is_judged_as_it_is(columns: str) -> None:
    made = exact({"v": -0.02}, np.linspace(0.0, 3.0, 3001))
    backward = Exact(with_defaults({}), made, 4e-3, 0.0)
    result = score(backward.noisy({columns: 1e-3 * WHITE[:3001]}, columns), {"v": 0.02})
    assert result.cause == "exact", result.explanation
    assert result.delta_x.exact is not None
    assert result.delta_x.exact < 0.0
    assert np.all(ratios(result) <= 1.0)
    assert "against the given v" in result.findings[0]


@pytest.mark.parametrize(("setting", "step"), FEW)
def test_noise_of_any_colour_and_counts_are_no_solver_in_x_and_its_force(
    setting: str, step: float
) -> None:
    motion = exact_motion(setting, step)
    x, swing, white = motion.made.x, motion.swing, WHITE[: motion.made.t.size]
    fine, coarse = 2e-4 * swing, swing / 12.7
    records = [
        x + 0.004 * swing * lfilter([1.0], [1.0, -0.9], white),
        x + 0.01 * swing * lfilter(np.ones(10) / 10.0, [1.0], white),
        x + 0.5 * swing * white,
        fine * np.round(x / fine),
        coarse * np.round(x / coarse),
        coarse * np.round(x / coarse + 0.3 * white),
    ]
    t, k, v = motion.made.t, motion.p["k"], motion.p["v"]
    scores = [score(Curve.of(t, x=record), motion.p) for record in records]
    # A force that was made from x shares its noise.
    scores += [score(Curve.of(t, x=x, F=k * (v * t - x)), motion.p) for x in records]
    assert {result.cause for result in scores} <= INNOCENT
    assert np.mean(ratios(*scores) <= 1.0) >= 0.95


@pytest.mark.parametrize("noise", [0.0, 0.002])
def test_a_zero_of_the_force_that_drifts_is_told_and_x_beside_it_stays_exact(noise: float) -> None:
    motion = exact_motion("default", 1e-3)
    part = motion.made.t / motion.made.t[-1]
    for drift in (0.1 * part, 0.2 * (1.0 - np.exp(-3.0 * part)), 0.05 * np.sin(6.3 * part)):
        off = {"F": drift + noise * WHITE[: part.size]}
        alone = score(motion.noisy(off, "F"), motion.p)
        assert alone.cause == "other"
        assert "zero of the force sensor drifts" in alone.explanation
        # A hundredth of a percent of a period is a tenth of a sample.
        assert alone.period.error == pytest.approx(0.0, abs=1e-4)
        both = score(motion.noisy(off, "xF"), motion.p)
        assert both.cause == "exact", both.explanation
        assert any("drifts" in finding for finding in both.findings)


SMOOTHED = makers.tanh_friction({}, np.linspace(0.0, 3.0, 3001), 1e-3, peak=False)


@pytest.mark.parametrize("computed", [stepped({}, 3.0, 1e-3), SMOOTHED])
@pytest.mark.parametrize(("size", "columns"), [(1e-6, "x"), (1e-6, "xF"), (1e-4, "xF")])
def test_a_record_with_noise_is_not_called_computed(
    computed: Made, size: float, columns: str
) -> None:
    # The force has no noise.
    record = Exact(with_defaults({}), computed, 1.0, 0.0)
    noise = {"x": size * WHITE[: computed.t.size]}
    assert score(record.noisy(noise, columns), record.p).cause not in SOLVER


@pytest.mark.parametrize(("p", "end"), [({"c": 500.0, "v": 0.1}, 1.0), ({"c": 5.0, "v": 0.2}, 3.0)])
@pytest.mark.parametrize("column", ["x", "F"])
def test_noise_makes_no_creep_of_a_slide(p: dict[str, float], end: float, column: str) -> None:
    slide = Exact(with_defaults(p), exact(p, np.linspace(0.0, end, 2001)), 1.0, 0.0)
    for size in (1e-6, 1e-4):
        result = score(slide.noisy({column: size * WHITE[:2001]}, column), slide.p)
        assert result.cause in INNOCENT, result.explanation


@pytest.mark.parametrize(
    ("wrong", "cause", "words"),
    [
        ({"mu_s": 0.505}, "other", "(mu_s - mu_k) N 2.5 % larger"),
        ({"m": 1.02}, "other", "k/m is 1.9"),
        ({"mu_s": 0.3}, "single_coefficient", "one friction coefficient"),
    ],
)
def test_noise_is_told_of_its_column_and_hides_no_other_block(
    wrong: dict[str, float], cause: str, words: str
) -> None:
    made = exact(wrong, np.linspace(0.0, 3.0, 3001))
    result = score(Curve.of(made.t, x=made.x + 5e-6 * WHITE[:3001], F=made.F), {})
    alone = score(Curve.of(made.t, x=made.x + 5e-6 * WHITE[:3001]), {})
    # A standard deviation of 1,000 samples is right to 2 %, one standard deviation.
    assert result.x_noise == pytest.approx(5e-6, rel=0.1)
    assert result.F_noise == pytest.approx(0.0, abs=1e-9)
    assert alone.cause == cause, alone.explanation
    assert words in alone.explanation
