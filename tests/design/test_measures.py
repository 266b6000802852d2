"""Measures against juddering: what they move, which are offered, limits, pairs, bad catalogues."""

from dataclasses import replace
from pathlib import Path

import pytest

from stickslip_design.axis import Axis, AxisError, Friction, axis_file_of, example, read_axis_file
from stickslip_design.loop.critical import critical_feed
from stickslip_design.measures.catalogue import FILE, catalogue, read_catalogue
from stickslip_design.measures.moving import with_measure
from stickslip_design.study import design
from stickslip_design.verdict import EFFORTS, Verdict
from tests.design import verdicts
from tests.design.axes import SERVO

AXES = Path(__file__).parents[2] / "examples" / "axes"
TEXT = FILE.read_text(encoding="utf-8")


def limited(limits: str) -> Verdict:
    return design(axis_file_of(f"{example()}\n[limits]\n{limits}\n"))


def after(name: str, axis: Axis = SERVO, step: int = 0) -> Axis:
    changed = with_measure(axis, catalogue()[name], step, {})
    assert changed is not None
    return changed


def test_a_measure_moves_all_the_numbers_that_it_moves() -> None:
    rolling = after("rolling-way")
    weight = SERVO.m * SERVO.g
    assert (rolling.F_s, rolling.F_k) == pytest.approx((0.0033 * weight + 22, 0.003 * weight + 20))
    assert rolling.c == pytest.approx(0.1 * SERVO.c)
    assert SERVO.drive is not None
    stated = replace(SERVO, drive=replace(SERVO.drive, dry=100.0))
    nut = after("more-nut-preload", stated)
    assert nut.drive is not None
    assert (nut.k / SERVO.k, nut.drive.dry) == pytest.approx((1.08, 200.0))
    # A way that falls with the speed gets one that does not.
    falling = Friction(mu_s=0.2, mu_k=0.15, law="stribeck", own={"v_s": 0.01})
    assert after("lining", replace(SERVO, friction=falling)).friction.constant


def test_a_lined_guideway_is_offered_what_can_be_ordered_and_not_a_lining() -> None:
    found = design(read_axis_file(AXES / "lined_guide.toml"))
    best = found.best
    assert best is not None
    assert best.ids == ("way-oil",)
    numbers = {change.number for one in found.measures for change in one.changes}
    assert "axis.mass" not in numbers
    assert "lining" in found.left_out["does not apply"]


def test_each_measure_that_is_enough_ends_the_jumps_and_the_least_effort_comes_first() -> None:
    found = verdicts.juddering()
    enough = [one for one in found.measures if one.enough and one.critical_feed is not None]
    efforts = [EFFORTS.index(one.effort) for one in enough]
    assert efforts == sorted(efforts)
    for one in enough:
        if one.effort != "program":
            steps = range(catalogue()[one.ids[0]].steps)
            reached = [critical_feed(after(one.ids[0], found.axis, step)) for step in steps]
            assert one.critical_feed in reached, one.ids
            assert one.margin is not None


def test_a_measure_that_makes_it_worse_is_not_offered() -> None:
    found = verdicts.juddering()
    assert {"higher-gain", "higher-bandwidth"} <= set(found.left_out["no help"])
    assert critical_feed(after("higher-gain")) > critical_feed(SERVO)
    for one in found.measures:
        if not one.enough:
            assert one.critical_feed is not None
            assert one.critical_feed < found.critical_feed
    offered = [name for one in found.measures if len(one.ids) == 1 for name in one.ids]
    left = [name for names in found.left_out.values() for name in names]
    assert sorted(offered + left) == sorted(catalogue())


def test_no_measure_goes_beyond_the_limits_of_the_file() -> None:
    found = limited('inertia = ["2000 kg", "2400 kg"]\npitch = ["10 mm", "10 mm"]\n'
                    'stiffness = ["40 N/um", "52 N/um"]\nwithout = ["way-oil"]')  # fmt: skip
    assert found.left_out["excluded by [limits]"] == ("way-oil",)
    assert {"less-inertia", "larger-pitch"} <= set(found.left_out["beyond [limits]"])
    for one in found.measures:
        for change in one.changes:
            if change.number == "axis.stiffness":
                assert float(change.then) <= 52e6 * (1.0 + 1e-9)
    (note,) = {cure.note for cure in found.cures if cure.number == "stiffness"}
    assert note == "beyond what exists: the [limits] of the file"


def test_two_parts_together_come_before_a_rebuild_where_one_is_not_enough() -> None:
    found = limited('without = ["way-oil"]')
    first, second, *others = found.measures
    assert (len(first.ids), len(second.ids)) == (2, 2)
    assert found.best is first
    assert {first.effort, second.effort} == {"part"}
    assert first.margin is not None
    assert first.margin > 1.0
    assert all(len(one.ids) == 1 for one in others)
    kinds = [catalogue()[name].kind for name in first.ids]
    assert kinds[0] != kinds[1]


@pytest.mark.parametrize(
    ("limits", "words"),
    [
        ('mass = ["550 kg", "600 kg"]', "limits.mass = .* excludes the present value, 500 kg"),
        ('mass = "500 kg"', "limits.mass = .* is no range; expected two values"),
        ('without = ["rolling-ways"]', "limits.without = .* no measure .*; nearest: rolling-way"),
    ],
)
def test_limits_that_cannot_be_are_refused_in_one_line(limits: str, words: str) -> None:
    with pytest.raises(AxisError, match=words) as refused:
        limited(limits)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('costs = "Travel."\n', "", "measures.shorter-length.costs is missing"),
        ('effort = "setting"', 'effort = "easy"', 'gain.effort = "easy" is no kind of effort'),
        ('key = "drive.K_v"', 'key = "drive.K_y"', '"drive.K_y" names no key of an axis file'),
        ('source = "nb"', 'source = "NSK"', '"NSK" is no source of the catalogue'),
        ("scale = [0.8, 0.5], s", "s", r"moves\[1\] needs one of set, scale, add"),
    ],
)
def test_a_measure_without_its_keys_is_refused_with_key_and_reason(
    old: str, new: str, words: str
) -> None:
    with pytest.raises(AxisError, match=words):
        read_catalogue(TEXT.replace(old, new))
