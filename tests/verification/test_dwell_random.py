"""Static friction that grows at rest: the block, the reference and the limits on random settings.

The settings take every size of growth against a swing, damping or none, speeds near the limit too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from random import Random

import pytest

from stickslip_fmu.laws.named import friction_law
from stickslip_fmu.spec import spec_of
from stickslip_ref import COULOMB, Cycle, Parameters, simulate, steady_cycle
from stickslip_ref.dwell import cycle_ranges
from stickslip_verification import truth
from stickslip_verification.random_sets.draws import log_uniform, oscillator, w_of
from stickslip_verification.truth import Step
from tests.conftest import Sized
from tests.fmu.blocks import block_of, outputs

SPEC = spec_of(friction_law("coulomb").law)

SETTINGS = 1000

METER = ("t_stick", "t_slip", "T", "delta_x", "spring_drop", "x_dot_peak")
POINTS = 20

BLOCK = 1e-12
"""Some thousand roundings, of the largest value and times mu_s/(mu_s - mu_k): theory (17)."""

REFERENCE = 1e-9
"""What a careful integration keeps, with the same factor and that of a shallow re-stick, (17)."""

SMALLEST_MARGIN = 1e-12
"""A stop, or a slip that goes on, that is decided by less hangs on roundings."""


@dataclass(frozen=True)
class Setting:
    """A block with a growing static friction, and where its stick-slip ends [m/s]."""

    values: dict[str, float]
    own: dict[str, float]
    limit: float

    def at(self, v: float) -> Parameters:
        """Return the reference's parameters at a pulling speed [m/s]."""
        return COULOMB.complete(Parameters(**self.values, v=v), self.own)

    @property
    def gap(self) -> float:
        """Return what grows of the first kind [1]."""
        return self.values["mu_s"] - self.values["mu_k"]

    def start(self, v: float, excess: float) -> dict[str, float]:
        """Return all values at rest, with the force a part of the gap beyond kinetic friction."""
        force = (self.values["mu_k"] + excess * self.gap) * self.values["m"] * self.values["g"]
        extension = math.copysign(force / self.values["k"], v)
        return {**self.values, **self.own, "v": v, "z_start": extension}


def drawn(draw: Random) -> Setting:
    """Draw a block: either growth or both, zeta 1e-4 to 0.9 in half of them."""
    p = oscillator(draw)
    w, gap = w_of(p), p["mu_s"] - p["mu_k"]
    own = {}
    kind = draw.choice(("exponential", "logarithmic", "both"))
    if kind != "logarithmic":
        own["tau_s"] = log_uniform(draw, 1e-2, 1e3) / w
    if kind != "exponential":
        own["B"] = gap * log_uniform(draw, 1e-2, 1.0)
        own["t_0"] = log_uniform(draw, 1e-3, 1e2) / w
    if draw.random() < 0.5:
        p["c"] = 2.0 * log_uniform(draw, 1e-4, 0.9) * math.sqrt(p["k"] * p["m"])
    plain = Setting(p, own, math.inf)
    high = 1e6 * w * gap * p["m"] * p["g"] / p["k"]
    found = cycle_ranges(plain.at(1.0), (1e-12 * high, high))
    return Setting(p, own, found[-1].high if found else 0.0)


def speed(draw: Random, setting: Setting) -> float:
    """Draw a pulling speed: near the limit on either side, or up to a thousand times slower."""
    near = setting.limit * (1.0 + draw.choice((-1.0, 1.0)) * log_uniform(draw, 1e-8, 0.9))
    slow = setting.limit / log_uniform(draw, 1.0, 1e3)
    if setting.own.get("tau_s") is None and not setting.values.get("c"):
        # Without a limit: up to where the gap is a hundredth of the speed.
        slow = near = 1e-6 * setting.limit / log_uniform(draw, 1e-2, 1e3)
    return draw.choice((near, slow)) * draw.choice((-1.0, 1.0))


def _run(draw: Random) -> tuple[Setting, dict[str, float], float, truth.Run] | None:
    """Draw a motion of some cycles; None where its course hangs on roundings."""
    setting = drawn(draw)
    if not setting.limit:
        return None
    v = speed(draw, setting)
    w = w_of(setting.values)
    values = setting.start(v, draw.uniform(-1.0, 1.0))
    values["age_start"] = draw.choice((0.0, log_uniform(draw, 1e-2, 1e4) / w))
    cycle = steady_cycle(setting.at(v))
    h = 0.37 * (float(cycle.T) if cycle.exists else 7.0 / w)
    run = truth.run(values, [Step(h)] * POINTS)
    return None if run.margin < SMALLEST_MARGIN else (setting, values, h, run)


def test_the_block_is_the_truth(sized: Sized) -> None:
    """States, counts, event times and cycle after any of twenty steps of two fifths of a period."""
    left_out = 0
    for n in range(sized(SETTINGS)):
        motion = _run(Random(f"dwell {n}"))
        if motion is None:
            left_out += 1
            continue
        setting, values, h, exact = motion
        scale = {name: max(abs(float(s[name])) for s in exact.samples) for name in METER}
        scale["t_event"] = POINTS * h
        allowed = BLOCK * setting.values["mu_s"] / setting.gap
        block = block_of(SPEC, values)
        for number, sample in enumerate(exact.samples):
            block.advance(math.fsum([h] * number), h)
            got = outputs(block)
            assert (got["n_slips"], got["mode"]) == (sample["n_slips"], sample["mode"]), values
            for name, size in scale.items():
                off = abs(float(sample[name] - got[name]))
                assert off <= allowed * size, (name, off / size, values)
    assert left_out <= sized(SETTINGS) // 100


def test_the_reference_is_the_truth(sized: Sized) -> None:
    """The integrated cycle, where no stop is shallower than the integration sees."""
    compared = 0
    for n in range(sized(SETTINGS) // 4):
        motion = _run(Random(f"dwell {n}"))
        if motion is None or motion[3].margin < 1e-6:
            continue
        setting, values, h, exact = motion
        own = {**setting.own, "age_start": values["age_start"]}
        base = {name: value for name, value in values.items() if name not in own}
        times = [math.fsum([h] * number) for number in range(1, POINTS + 1)]
        run = simulate(Parameters(**base), times[-1], own=own, times=times)
        assert run.n_slips[-1] == exact.samples[-1]["n_slips"], values
        allowed = REFERENCE * setting.values["mu_s"] / setting.gap
        for name in ("T", "delta_x", "x_dot_peak"):
            course = [float(sample[name]) for sample in exact.samples]
            off = max(abs(a - b) for a, b in zip(getattr(run, name), course, strict=True))
            assert off <= allowed * max(map(abs, course)), (name, values)
        compared += 1
    assert compared > sized(SETTINGS) // 8


def _sticks_on(setting: Setting, v: float, begin: Cycle) -> bool:
    """Tell whether the block goes on sticking, from the stop of a cycle at another speed.

    It is followed until it slides on, or its sticks have shrunk to nothing or keep their length.
    """
    stop = float(begin.F_s) / setting.values["k"] - float(begin.spring_drop)
    values = {**setting.values, **setting.own, "v": v, "z_start": stop}
    block = block_of(SPEC, values)
    h = 300.0 * 2.0 * math.pi / w_of(setting.values)
    now = 0.0
    before = outputs(block)
    for _ in range(1000):
        block.advance(now, h)
        now += h
        got = outputs(block)
        if got["mode"] and got["n_slips"] == before["n_slips"]:
            return False
        if got["t_stick"] < 1e-3 * float(begin.t_stick):
            return False
        # Two sticks of one length, or one that takes longer than this.
        still = got["t_stick"] == pytest.approx(before["t_stick"], rel=1e-7)
        if still and (got["n_slips"] > before["n_slips"] or got["sticking"]):
            return True
        before = got
    raise AssertionError(f"undecided after {now} s: {values}")


@pytest.mark.parametrize("damped", [False, True])
def test_the_limit_is_where_the_block_ceases_to_stick(sized: Sized, *, damped: bool) -> None:
    """From the cycle at the limit, a little below it the sticks stay, a little above they go."""
    tried = 0
    for n in range(sized(SETTINGS) // 4):
        setting = drawn(Random(f"limit {n}"))
        if bool(setting.values.get("c")) is not damped or not setting.limit:
            continue
        if "tau_s" not in setting.own and not damped:
            continue
        # Without damping the sticks shrink towards the limit, with it the cycle ends whole.
        off, begin = (1e-3, 1.0 - 1e-6) if damped else (1e-2, 0.9)
        cycle = steady_cycle(setting.at(begin * setting.limit))
        if not cycle.exists or cycle.t_slip * w_of(setting.values) > 2.0 * math.pi + 1e-3:
            continue
        assert _sticks_on(setting, (1.0 - off) * setting.limit, cycle), setting
        assert not _sticks_on(setting, (1.0 + off) * setting.limit, cycle), setting
        tried += 1
    assert tried > sized(SETTINGS) // 20


def test_the_ranges_are_those_of_a_scan(sized: Sized) -> None:
    """Speeds about the limit, 400 a decade in full: a stick goes on exactly in the range."""
    for n in range(4):
        draw = Random(f"scan {n}")
        setting = drawn(draw)
        while not (setting.values.get("c") and 0.0 < setting.limit < math.inf):
            setting = drawn(draw)
        cycle = steady_cycle(setting.at(0.999 * setting.limit))
        per_decade = sized(400)
        for number in range(-per_decade // 2, per_decade // 2):
            v = setting.limit * 10.0 ** ((number + 0.5) / per_decade)
            assert _sticks_on(setting, v, cycle) == (v < setting.limit), (v, setting)
