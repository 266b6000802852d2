"""Block and reference against the truth, on random settings of every friction law."""

from __future__ import annotations

import math
from random import Random

import pytest

from stickslip_verification import truth
from tests.conftest import Sized
from tests.facts.closed import START
from tests.facts.sides import BLOCK, REFERENCE, Setting, Side
from tests.fmu.blocks import Draw, draw, draw_ageing
from tests.laws.stribeck import draw_curve, draw_smooth

NEAR = 1e-12
"""A thousand roundings. A stop, or a slip that goes on, that is decided by less hangs on them."""

TOLERANCES = {"block": NEAR, "reference": 1e-9}
"""Of the largest value of its unit in the run, an output's error: a thousand roundings, and what a
careful integration keeps; times mu_s/(mu_s - least mu in slip), theory (17)."""

WHOLE = ("mode", "n_slips")
UNITS = (
    ("x", "x_pull", "z", "delta_x", "spring_drop"),
    ("F", "F_friction", "F_s"),
    ("x_dot", "x_dot_peak"),
    ("t_event", "t_stick", "t_slip", "T"),
    ("f",),
    ("W_pull", "W_k", "Q_friction"),
    ("mu_k_used",),
)


def drawn(law: str, draw: Draw, generator: Random) -> Setting:
    values, segments = draw(generator)
    longest = (2.0 if law == "stribeck" else 20.0) * math.sqrt(values["m"] / values["k"])
    for segment in segments[:4]:
        segment.length = min(segment.length, longest)
    # The reference takes what changes at the start as what it starts with: no work is booked.
    segments[0].changes.pop("k", None)
    return Setting(values, segments[:4], law)


def motion(setting: Setting, digits: int, part: float = 0.0) -> truth.Run:
    """Return the exact motion, with every pulling velocity off by a part of it."""
    first, *changed = (
        {name: value * (1.0 + part) if name == "v" else value for name, value in values.items()}
        for values in (setting.values, *(segment.changes for segment in setting.segments))
    )
    steps = [
        truth.Step(segment.length, changes)
        for segment, changes in zip(setting.segments, changed, strict=True)
    ]
    return truth.run(first, steps, digits=digits, law=setting.law)


def conditioning(setting: Setting) -> float:
    values, largest = {**START, **setting.values}, 1.0
    law = truth.friction_law(setting.law)
    values |= {each.name: values.get(each.name, each.start) for each in law.parameters}
    for segment in setting.segments:
        values |= segment.changes
        spread = law.spread(values)
        if spread:
            largest = max(largest, values["mu_s"] / spread)
    return largest


def assert_is_the_truth(side: Side, setting: Setting, exact: truth.Run, digits: int) -> None:
    rows, samples = side.rows(setting), exact.samples
    near = TOLERANCES[side.name] * conditioning(setting)
    for row, sample in zip(rows, samples, strict=True):
        assert [row[name] for name in WHOLE] == [sample[name] for name in WHOLE], setting
    nearby: truth.Run | None = None
    for unit in UNITS:
        scale = max(abs(float(sample[name])) for sample in samples for name in unit)
        if "t_event" in unit:
            # The clock counts from the start of the run.
            scale = float(exact.times[-1])
        for name in unit:
            for n, (row, sample) in enumerate(zip(rows, samples, strict=True)):
                off = abs(float(sample[name] - row[name]))
                if off <= near * scale:
                    continue
                # A motion that grows, or all but touches rest, is more sensitive than that.
                nearby = nearby or motion(setting, digits, TOLERANCES[side.name])
                moved = abs(float(nearby.samples[n][name] - sample[name]))
                assert off <= near * scale + moved, (name, off / scale, moved / scale, setting)


@pytest.mark.parametrize(
    ("law", "draw", "count", "digits"),
    [
        ("coulomb", draw, 800, 30),
        ("coulomb", draw_ageing, 400, 25),
        ("stribeck", draw_smooth, 40, 25),
        ("stribeck", draw_curve, 120, 25),
    ],
)
@pytest.mark.parametrize("share", [1, *(pytest.param(n, marks=pytest.mark.soak) for n in (2, 3))])
@pytest.mark.filterwarnings("ignore::stickslip_ref.FrictionClampWarning")
def test_block_and_reference_give_every_output_of_the_truth(
    sized: Sized, share: int, law: str, draw: Draw, count: int, digits: int
) -> None:
    left_out = 0
    for n in range(sized(count)):
        setting = drawn(law, draw, Random(f"far {share} {n}"))
        exact = motion(setting, digits)
        if exact.margin < NEAR:
            left_out += 1
            continue
        assert_is_the_truth(BLOCK, setting, exact, digits)
        # An integration sees no shallower stop, and takes a while.
        if exact.margin > 1e-6 and n % 4 == 0:
            assert_is_the_truth(REFERENCE, setting, exact, digits)
    assert left_out <= max(1, sized(count) // 50)
