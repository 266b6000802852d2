"""What holds for every friction law of the block, on random settings and changes."""

import json
import math
import random
from collections.abc import Iterable
from typing import NamedTuple

import pytest

from fmukit.model import Spec
from stickslip_fmu.spec import SPEC
from stickslip_verification.model.symmetries import HEAVIER, MIRROR, QUICKER, Symmetry
from stickslip_verification.truth import friction_law
from tests.fmu.blocks import (
    Draw,
    Segment,
    Splitter,
    block_of,
    draw,
    draw_ageing,
    drive,
    outputs,
    uneven,
    whole,
)
from tests.laws import stribeck
from tests.laws.stribeck import draw_curve, draw_smooth


class Law(NamedTuple):
    """A friction law by its name, the block under it, and how often its settings are drawn how."""

    name: str
    spec: Spec
    draw: Draw
    times: int

    def drive(
        self, values: dict[str, float], segments: list[Segment], split: Splitter = whole
    ) -> list[dict[str, float]]:
        """Return the outputs at the end of each segment."""
        return drive(values, segments, split, self.spec)

    def drawn(self, seed: int) -> Iterable[tuple[random.Random, dict[str, float], list[Segment]]]:
        """Give settings and segments, and the generator that drew them."""
        generator = random.Random(seed)
        for _ in range(self.times):
            yield generator, *self.draw(generator)


LAWS = {
    "constant": Law("coulomb", SPEC, draw, 300),
    "growing at rest": Law("coulomb", SPEC, draw_ageing, 300),
    "a smooth fall": Law("stribeck", stribeck.SPEC, draw_smooth, 60),
    "a curve": Law("stribeck", stribeck.SPEC, draw_curve, 100),
}


@pytest.fixture(params=LAWS)
def law(request: pytest.FixtureRequest) -> Law:
    """Return each friction law."""
    return LAWS[request.param]


def test_the_step_does_not_matter(law: Law) -> None:
    """One step gives what random uneven steps give, within 1e-12 of the motion's scale."""
    for generator, values, segments in law.drawn(11):
        once, often = law.drive(values, segments), law.drive(values, segments, uneven(generator))
        scale = max(max(abs(row["z"]), abs(row["x"])) for row in once)
        for one, many in zip(once, often, strict=True):
            for name in ("x", "z", "x_pull"):
                assert one[name] == pytest.approx(many[name], abs=1e-12 * scale, rel=0.0)
            assert one["n_slips"] == many["n_slips"]


def test_energy_is_kept(law: Law) -> None:
    """Work in, less heat out, is the change of the stored energy; heat never falls."""
    for generator, values, segments in law.drawn(12):
        k, m = values["k"], values["m"]
        start = 0.5 * m * values["x_dot_start"] ** 2 + 0.5 * k * values["z_start"] ** 2
        largest, external, x, work, heat = start, 0.0, 0.0, 0.0, 0.0
        rows = law.drive(values, segments, uneven(generator, 4))
        for segment, row in zip(segments, rows, strict=True):
            external = segment.changes.get("F_ext", external)
            k = segment.changes.get("k", k)
            work += external * (row["x"] - x)
            x = row["x"]
            stored = 0.5 * m * row["x_dot"] ** 2 + 0.5 * k * row["z"] ** 2
            largest = max(largest, stored, abs(row["W_pull"]), row["Q_friction"], abs(work))
            gap = math.fsum([start, work, row["W_pull"], row["W_k"], -row["Q_friction"], -stored])
            assert abs(gap) <= 1e-12 * largest
            assert row["Q_friction"] >= heat
            heat = row["Q_friction"]


@pytest.mark.parametrize("symmetry", [MIRROR, HEAVIER, QUICKER], ids=lambda each: each.name)
def test_mirror_and_scaling_change_no_digit(law: Law, symmetry: Symmetry) -> None:
    """Turned about, or in other units of mass or time, every output is the same to the bit."""
    own = friction_law(law.name).parameters
    for _, values, segments in law.drawn(13):
        setting = {"g": 9.81, **values}
        other = [
            Segment(each.length * symmetry.pace, symmetry.scaled(each.changes, own))
            for each in segments
        ]
        rows = law.drive(symmetry.scaled(setting, own), other)
        for one, two in zip(law.drive(setting, segments), rows, strict=True):
            for name, value in one.items():
                assert two[name] == symmetry.outputs[name] * value, name


def test_state_returns_bit_for_bit(law: Law) -> None:
    """A state that went through JSON, or was frozen, repeats every output."""
    for _, values, segments in law.drawn(16):
        block = block_of(law.spec, values)
        for segment in segments:
            for name, value in segment.changes.items():
                block.set(name, value)
            other, third = block_of(law.spec, {}), block_of(law.spec, {})
            saved = json.loads(json.dumps(block.save()))
            assert saved == block.save()
            other.restore(saved)
            third.thaw(block.freeze())
            for each in (block, other, third):
                each.advance(1.0, segment.length)
            assert outputs(block) == outputs(other) == outputs(third)
