"""The block under Stribeck's law against the truth, on random settings and changes.

A third of the settings lies within 1e-3 to 1e-6 of an end of the stick-slip, on either side.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from random import Random

import pytest

from stickslip_ref import Parameters, critical_velocity
from stickslip_verification import truth
from stickslip_verification.truth import STRIBECK, Step
from tests.conftest import Sized
from tests.fmu.blocks import Segment, log_uniform
from tests.laws.stribeck import curve, draw_curve, draw_smooth, drive
from tests.laws.test_stribeck_curve import FALLS_TWICE

SETTINGS, SHARES = 1000, 4
AT_ONE_END = 4
"""Settings near one end of a range: two on each side."""

DIGITS = 25

BLOCK = 1e-12
"""Some thousand roundings, times mu_s/(mu_s - least mu in slip): theory (17)."""

SMALLEST_MARGIN = 1e-12
"""A stop, or a slip that goes on, that is decided by less hangs on roundings."""

WHOLE = ("mode", "sticking", "n_slips")
UNITS = (
    ("x", "x_pull", "z", "delta_x", "spring_drop"),
    ("F", "F_friction", "F_s"),
    ("x_dot", "x_dot_peak"),
    ("t_event", "t_stick", "t_slip", "T"),
    ("f",),
    ("W_pull", "W_k", "Q_friction"),
    ("mu_k_used",),
)
"""Outputs by their unit: an error is a part of the largest value of its unit in the run, of a time
of the whole run, since the clock counts from its start."""


@dataclass(frozen=True)
class Setting:
    """A block, what happens to it, and whether it must come to stick, where that is known."""

    values: dict[str, float]
    segments: list[Segment]
    sticks: bool | None = None


def far(draw: Random) -> Setting:
    """Draw a motion whose inputs, stiffness, damping and friction change, in slip and at rest."""
    values, segments = draw.choice((draw_curve, draw_smooth))(draw)
    longest = 2.0 * math.sqrt(values["m"] / values["k"])
    for segment in segments[:4]:
        segment.length = min(segment.length, longest)
    return Setting(values, segments[:4])


def near(draw: Random) -> list[Setting]:
    """Draw slips from break-away next to an end of the stick-slip; inside they come to rest."""
    ends: list[tuple[float, str, float]] = []
    while not ends:
        values, _ = draw.choice((draw_curve, draw_smooth))(draw)
        w = math.sqrt(values["k"] / values["m"])
        values["c"] = 2.0 * values["m"] * w * draw.choice((0.0, log_uniform(draw, 1e-3, 1.0)))
        values = {**values, "mu_k": values.get("mu_k", 0.0), "x_dot_start": 0.0}
        of_friction = ("m", "k", "c", "mu_s", "mu_k")
        plain = {name: values[name] for name in of_friction}
        own = {row.name: values[row.name] for row in STRIBECK.parameters if row.name in values}
        fast = values["mu_s"] * 9.81 / w
        found = critical_velocity(Parameters(**plain), "stribeck", own, (0.02 * fast, 2.0 * fast))
        for each in found.cycle:
            ends += [(each.low, each.low_end, 1.0), (each.high, each.high_end, -1.0)]
        ends = [end for end in ends if end[1] != "none"]
    end, _, inward = draw.choice(ends)
    step = (1.0 + values["c"] / (2.0 * values["m"] * w)) / w
    made = []
    for number in range(AT_ONE_END):
        sticks = number % 2 == 0
        off = log_uniform(draw, 1e-6, 1e-3) * (inward if sticks else -inward)
        v = math.copysign(end * (1.0 + off), values["v"])
        start = {"v": v, "z_start": math.copysign(fast / w, v) - 0.1 * v / w}
        # A motion that reverses, or leaves the speed of the pull slowly, sticks after some turns.
        segments = [Segment(step) for _ in range(100)]
        made.append(Setting({**values, **start}, _decided({**values, **start}, segments), sticks))
    return made


def _decided(values: dict[str, float], segments: list[Segment]) -> list[Segment]:
    """Return the segments up to where the mass sticks, or has passed a least speed and goes on."""
    steps = [Step(segment.length) for segment in segments]
    planned = truth.run(values, steps, digits=None, law="stribeck")
    stuck = [event.time for event in planned.events if event.kind == "re-stick"]
    speeds = [abs(sample["x_dot"]) for sample in planned.samples]
    for n in range(2, len(steps)):
        passed = speeds[n - 2] > speeds[n - 1] < speeds[n] and planned.samples[n]["n_slips"] == 0
        if passed or (stuck and stuck[0] < planned.times[n]):
            return segments[: n + 1]
    return segments


def conditioning(setting: Setting) -> float:
    """Return mu_s/(mu_s - least mu in slip), the largest in the run."""
    values, largest = truth.complete(setting.values, STRIBECK.parameters), 1.0
    for segment in setting.segments:
        values |= segment.changes
        if spread := STRIBECK.spread(values):
            largest = max(largest, values["mu_s"] / spread)
    return largest


def motion(setting: Setting, part: float = 0.0) -> truth.Run:
    """Return the exact motion, with every pulling velocity off by a part of it."""
    first, *changed = (
        {name: value * (1.0 + part) if name == "v" else value for name, value in values.items()}
        for values in (setting.values, *(segment.changes for segment in setting.segments))
    )
    steps = [
        Step(each.length, changes) for each, changes in zip(setting.segments, changed, strict=True)
    ]
    return truth.run(first, steps, digits=DIGITS, law="stribeck")


def assert_is_the_truth(setting: Setting, exact: truth.Run) -> None:
    """Every output after every segment, those that are counts or states to the last digit."""
    rows = drive(setting.values, setting.segments)
    allowed = BLOCK * conditioning(setting)
    nearby: truth.Run | None = None
    for row, sample in zip(rows, exact.samples, strict=True):
        assert [row[name] for name in WHOLE] == [sample[name] for name in WHOLE], setting
    for unit in UNITS:
        scale = max(abs(float(sample[name])) for sample in exact.samples for name in unit)
        if "t_event" in unit:
            scale = float(exact.times[-1])
        for name in unit:
            for n, (row, sample) in enumerate(zip(rows, exact.samples, strict=True)):
                off = abs(float(sample[name] - row[name]))
                if off <= allowed * scale:
                    continue
                # A motion that grows, or all but touches rest, is more sensitive than that.
                nearby = nearby or motion(setting, BLOCK)
                moved = abs(float(nearby.samples[n][name] - sample[name]))
                assert off <= allowed * scale + moved, (name, off / scale, moved / scale, setting)


@pytest.mark.parametrize(
    "share", [1, 3, *(pytest.param(share, marks=pytest.mark.soak) for share in (0, 2))]
)
def test_block_is_the_truth(sized: Sized, share: int) -> None:
    """No stick is missed and none invented, and every output is the truth."""
    count = sized(SETTINGS) // SHARES
    blocks = count // (3 * AT_ONE_END)
    settings = [far(Random(f"far {share} {n}")) for n in range(count - AT_ONE_END * blocks)]
    for n in range(blocks):
        settings += near(Random(f"near {share} {n}"))
    left_out = 0
    for setting in settings:
        exact = motion(setting)
        if exact.margin < SMALLEST_MARGIN:
            left_out += 1
            continue
        if setting.sticks is not None:
            stuck = any(event.kind == "re-stick" for event in exact.events)
            assert stuck == setting.sticks, setting
            assert exact.margin < 0.1, f"nothing was decided: {setting}"
        assert_is_the_truth(setting, exact)
    assert left_out <= count // 100


@pytest.mark.parametrize(
    ("c", "own", "between"),
    [
        pytest.param(2.0, curve(FALLS_TWICE), (0.03, 0.6), id="falls twice"),
        pytest.param(1.0, {"shape": 2, "v_s": 0.2}, (0.1, 1.0), id="hyperbolic"),
        pytest.param(
            5.0, {"v_s": 0.1, "delta": 2.0}, (0.01, 0.3), marks=pytest.mark.soak, id="Stribeck"
        ),
    ],
)
def test_a_scan_by_the_truth_finds_the_ranges(
    sized: Sized, c: float, own: dict[str, float], between: tuple[float, float]
) -> None:
    """At 400 speeds a decade, 20 in the gate, the slip from break-away stops where a range says."""
    low, high = between
    found = critical_velocity(Parameters(c=c), "stribeck", own, between).cycle
    assert any(kind == "grazing" for each in found for kind in each[2:])
    per_decade = 400 if sized(400) == 400 else 20
    count = int(per_decade * math.log10(high / low))
    for number in range(count):
        v = low * (high / low) ** ((number + 0.5) / count)
        values = {**own, "c": c, "v": v, "z_start": 0.5 * 9.81 / 1000.0 - 1e-3 * v}
        slip = Setting(values, _decided(values, [Segment(0.02)] * 40))
        stuck = any(event.kind == "re-stick" for event in motion(slip).events)
        assert stuck == any(v in each for each in found), v


@pytest.mark.parametrize(
    "change",
    [{"v_s": 0.02}, {"delta": 1.5}, {"mu_s": 0.55}, {"mu_k": 0.25}, {"load": 0.3}, {"c": 3.0}],
    ids=str,
)
def test_a_change_of_friction_in_a_slip_acts_at_once(change: dict[str, float]) -> None:
    """One value alone, 20 ms after the break-away, and the motion after 10 and 40 ms more."""
    segments = [Segment(0.265), Segment(0.01, change), Segment(0.03)]
    rows = drive({"v_s": 0.03}, segments)
    steps = [Step(segment.length, segment.changes) for segment in segments]
    samples = truth.run({"v_s": 0.03}, steps, digits=25, law="stribeck").samples[-3:]
    for row, sample in zip(rows, samples, strict=True):
        assert row["mode"] == 1
        for output in ("x_dot", "x", "F_friction", "Q_friction"):
            assert row[output] == pytest.approx(float(sample[output]), rel=1e-12), output


def test_damping_and_a_falling_line_act_as_their_difference() -> None:
    """With c larger by slope N the truth over a straight fall is Coulomb's closed form."""
    common = {"m": 1.0, "g": 8.0, "k": 1024.0, "mu_s": 0.5, "v": 2.0**-6}
    # 2^-4 s/m times 8 N is a damping of -0.5 N.s/m.
    fall = curve([(0.0, 0.25), (4.0, 0.0)])
    steps = [Step(0.1)] * 8
    line = truth.run({**common, **fall, "c": 1.5}, steps, digits=50, law="stribeck")
    coulomb = truth.run({**common, "mu_k": 0.25, "c": 1.0}, steps)
    assert len(line.events) > 2
    for one, other in zip(line.samples, coulomb.samples, strict=True):
        for name in one.keys() - {"mu_k_used"}:
            assert abs(one[name] - other[name]) <= 1e-45, name
