"""What holds on every side and under every friction law, on random settings and changes."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from random import Random
from typing import NamedTuple

import pytest

from stickslip_verification.drive.other_runs import HEAVIER, MIRROR, QUICKER, Symmetry
from stickslip_verification.truth import friction_law
from tests.facts.sides import BLOCK, QUICK, REFERENCE, TRUTH, Row, Setting, Side, each_side
from tests.fmu.blocks import Draw, Segment, draw, draw_ageing
from tests.laws.stribeck import curve, draw_curve, draw_smooth

pytestmark = pytest.mark.filterwarnings("ignore::stickslip_ref.FrictionClampWarning")


class Case(NamedTuple):
    """A side under a friction law: how its settings are drawn, how often, and what may differ.

    The block's errors are roundings; the reference's those of its integration over some slips, at
    the conditioning of a shallow stop, theory (17); the truth carries fifty digits.
    """

    side: Side
    law: str
    draw: Draw
    times: int
    tolerance: float

    def settings(self, seed: str) -> Iterator[tuple[Random, Setting]]:
        for n in range(self.times):
            generator = Random(f"{seed} {n}")
            values, segments = self.draw(generator)
            if self.side is not BLOCK:
                segments = segments[:4]
                for segment in segments:
                    longest = 10.0 * math.sqrt(values["m"] / values["k"])
                    segment.length = min(segment.length, longest)
                segments[0].changes.pop("k", None)
            yield generator, Setting(values, segments, self.law)


CASES = {
    "block, constant": Case(BLOCK, "coulomb", draw, 100, 1e-12),
    "block, growing": Case(BLOCK, "coulomb", draw_ageing, 100, 1e-12),
    "block, smooth": Case(BLOCK, "stribeck", draw_smooth, 12, 1e-12),
    "block, curve": Case(BLOCK, "stribeck", draw_curve, 20, 1e-12),
    "reference, growing": Case(REFERENCE, "coulomb", draw_ageing, 10, 1e-8),
    "reference, curve": Case(REFERENCE, "stribeck", draw_curve, 2, 1e-8),
    "truth, growing": Case(TRUTH, "coulomb", draw_ageing, 10, 1e-40),
}

EXTREMES: list[dict[str, float]] = [
    {"v_s": 1e-9},
    {"v_s": 1e3, "delta": 1.3},
    {"v_s": 1e9, "shape": 2},
    {"delta": 1e300},
    {"mu_k": 0.499999},
    {"v": 0.0, "z_start": 0.02, "c": 2000.0, "delta": 1.5},
    {"v": 0.02, "x_dot_start": -0.05, "delta": 1.4},
    {"v": 0.02, "x_dot_start": 5.0, "shape": 2},
    {"k": 1e8, "m": 1e-3, "v": 1e-6},
    {"k": 1.0, "m": 1e4, "v": 10.0},
]
"""Settings of Stribeck's law; ten turns of each."""


@pytest.fixture(params=CASES)
def case(request: pytest.FixtureRequest) -> Case:
    return CASES[request.param]


def assert_same_motion(one: Sequence[Row], other: Sequence[Row], tolerance: float) -> None:
    scale = max(max(abs(row["z"]), abs(row["x"])) for row in one)
    for a, b in zip(one, other, strict=True):
        assert all(abs(a[name] - b[name]) <= tolerance * scale for name in ("x", "z", "x_pull"))
        assert a["n_slips"] == b["n_slips"]


def cut(setting: Setting, generator: Random, most: int = 40) -> tuple[Setting, list[int]]:
    segments: list[Segment] = []
    ends = []
    for segment in setting.segments:
        shares = [generator.random() ** 4 + 1e-9 for _ in range(generator.randint(2, most))]
        steps = [segment.length * share / math.fsum(shares) for share in shares]
        steps[-1] += math.fsum([segment.length, *(-step for step in steps)])
        segments += [Segment(steps[0], segment.changes), *map(Segment, steps[1:])]
        ends.append(len(segments) - 1)
    return replace(setting, segments=segments), ends


DURATIONS = ("t_stick", "t_slip", "T", "delta_x", "spring_drop", "x_dot_peak")


def test_the_step_does_not_matter(case: Case) -> None:
    for generator, setting in case.settings("steps"):
        fine, ends = cut(setting, generator)
        rows = case.side.rows(fine)
        # The steps add up to the length but for a rounding.
        tolerance = max(case.tolerance, 1e-12)
        assert_same_motion(case.side.rows(setting), [rows[n] for n in ends], tolerance)


def test_durations_do_not_depend_by_a_bit_on_how_steps_cut_them() -> None:
    for generator, drawn in CASES["block, growing"].settings("durations"):
        setting = replace(drawn, segments=[Segment(each.length) for each in drawn.segments])
        fine, ends = cut(setting, generator)
        rows = BLOCK.rows(fine)
        for n, once in zip(ends, BLOCK.rows(setting), strict=True):
            assert [rows[n][name] for name in DURATIONS] == [once[name] for name in DURATIONS]


@pytest.mark.parametrize("own", EXTREMES, ids=str)
def test_extreme_settings_do_not_depend_on_the_step(own: dict[str, float]) -> None:
    turns = 60.0 * math.sqrt(own.get("m", 1.0) / own.get("k", 1000.0))
    whole = Setting({"v_s": 0.01, **own}, [Segment(turns)], "stribeck")
    fine, _ = cut(whole, Random(5))
    assert_same_motion(BLOCK.rows(whole), BLOCK.rows(fine)[-1:], 1e-12)


def test_energy_is_kept_and_heat_never_falls(case: Case) -> None:
    for generator, drawn in case.settings("energy"):
        setting, _ = cut(drawn, generator, 4)
        k, m = setting.values["k"], setting.values["m"]
        x_dot, z = setting.values["x_dot_start"], setting.values["z_start"]
        start = 0.5 * m * x_dot**2 + 0.5 * k * z**2
        largest, external, x, work, heat = start, 0.0, 0.0, 0.0, 0.0
        for segment, row in zip(setting.segments, case.side.rows(setting), strict=True):
            external = segment.changes.get("F_ext", external)
            k = segment.changes.get("k", k)
            work, x = work + external * (row["x"] - x), row["x"]
            stored = (m * row["x_dot"] ** 2 + k * row["z"] ** 2) / 2
            largest = max(largest, stored, abs(row["W_pull"]), row["Q_friction"], abs(work))
            gap = start + work + row["W_pull"] + row["W_k"] - row["Q_friction"] - stored
            # `start` is a double.
            assert abs(gap) <= max(case.tolerance, 1e-15) * largest
            assert row["Q_friction"] >= heat - case.tolerance * largest
            heat = row["Q_friction"]


@pytest.mark.parametrize("symmetry", [MIRROR, HEAVIER, QUICKER], ids=lambda each: each.name)
def test_mirror_and_scaling_change_no_digit(case: Case, symmetry: Symmetry) -> None:
    own = friction_law(case.law).parameters
    for _, drawn in case.settings("symmetry"):
        setting = replace(drawn, values={"g": 9.81, **drawn.values})
        segments = [
            Segment(each.length * symmetry.pace, symmetry.scaled(each.changes, own))
            for each in setting.segments
        ]
        other = replace(setting, values=symmetry.scaled(setting.values, own), segments=segments)
        for one, two in zip(case.side.rows(setting), case.side.rows(other), strict=True):
            for name in symmetry.outputs.keys() & one.keys():
                off = abs(two[name] - symmetry.outputs[name] * one[name])
                assert off <= (1e-40 * abs(one[name]) if case.side is TRUTH else 0.0), name


SHAPES: dict[str, dict[str, float]] = {
    "whole": {"shape": 1, "v_s": 0.05},
    "not whole": {"shape": 1, "v_s": 0.05, "delta": 1.5},
    "hyperbolic": {"shape": 2, "v_s": 0.05},
    "curve": curve([(0.0, 0.5), (0.03, 0.35), (0.2, 0.3)]),
}
COEFFICIENTS: dict[str, Callable[[float], float]] = {
    "whole": lambda u: 0.3 + 0.2 * math.exp(-((u / 0.05) ** 2)),
    "not whole": lambda u: 0.3 + 0.2 * math.exp(-((u / 0.05) ** 1.5)),
    "hyperbolic": lambda u: 0.3 + 0.2 / (1.0 + u / 0.05),
    "curve": lambda u: 0.5 - 5.0 * u if u < 0.03 else max(0.3, 0.35 - (u - 0.03) * 0.05 / 0.17),
}
CHANGES = {"v": 0.06, "load": 3.0, "F_ext": 0.5, "k": 700.0, "c": 2.0}
SMOOTH = {"mu_s": 0.6, "mu_k": 0.2, "v_s": 0.08}


@pytest.mark.parametrize("side", each_side())
@pytest.mark.parametrize("shape", SHAPES)
def test_friction_in_slip_is_that_of_its_speed(side: Side, shape: str) -> None:
    for start in (-1e-4, 0.01, 0.029, 0.031, -0.08, 0.5):
        values = {**SHAPES[shape], "c": 2.0, "x_dot_start": start}
        (row,) = side.rows(Setting(values, [Segment(1e-9)], "stribeck"))
        u = float(row["x_dot"])
        expected = -math.copysign(9.81 * COEFFICIENTS[shape](abs(u)), u) - 2.0 * u
        assert float(row["F_friction"]) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize("side", each_side(QUICK))
@pytest.mark.parametrize(
    ("shape", "name", "new"),
    [
        *(
            (shape, name, new)
            for shape in SHAPES
            for name, new in (CHANGES if shape == "curve" else {**CHANGES, **SMOOTH}).items()
        ),
        ("whole", "delta", 3.0),
        ("not whole", "delta", 3.0),
    ],
)
def test_a_change_in_slip_gives_the_slip_that_begins_so(
    side: Side, shape: str, name: str, new: float
) -> None:
    own = SHAPES[shape]
    steps = [Segment(0.27), Segment(0.004, {name: new})]
    before, changed = side.rows(Setting(own, steps, "stribeck"))
    assert before["mode"] == 1
    starts = {f"{each}_start": float(before[each]) for each in ("x", "x_dot", "z")}
    fresh = Setting({**own, **starts, name: new}, [Segment(0.004)], "stribeck")
    (expected,) = side.rows(fresh)
    for output in ("x", "x_dot", "z", "F_friction"):
        # What 50 steps of an integration leave, or some hundred roundings.
        assert changed[output] == pytest.approx(expected[output], rel=1e-11), output
