"""The falling friction law in the block and its FMU: truth, Coulomb's law and invariants."""

from __future__ import annotations

import json
import math
import random
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path

import fmpy
import fmpy.validation
import pytest

from fmukit.model import ModelError
from stickslip_fmu.block import Block
from stickslip_fmu.laws.named import friction_law
from stickslip_fmu.packer import build
from stickslip_fmu.spec import spec_of
from stickslip_verification import truth
from stickslip_verification.truth import Step
from tests.fmu.blocks import Segment, block_of, draw, log_uniform, outputs, uneven, whole
from tests.fmu.blocks import drive as drive_coulomb

NAME = "tests.laws.falling:FALLING"
SPEC = spec_of(friction_law(NAME).law)


def make_block(**values: float) -> Block:
    """Return a block under falling friction with these values."""
    return block_of(SPEC, values)


def draw_falling(generator: random.Random) -> tuple[dict[str, float], list[Segment]]:
    """Draw a block over the range of use and changes, its effective damping of either sign.

    The ratio of the effective damping goes from -3 on; the limit of the law lies beyond twice the
    speed that the gap gives without damping, and may be reached.
    """
    values, segments = draw(generator)
    normal = values["m"] * 9.81
    critical = 2.0 * math.sqrt(values["k"] * values["m"])
    mu_s, mu_k = values["mu_s"], values["mu_k"]
    speed = (mu_s - mu_k) * normal / math.sqrt(values["k"] * values["m"]) + abs(values["v"])
    steepest = mu_k / (2.0 * speed)
    values["slope"] = min(critical / normal * log_uniform(generator, 1e-4, 3.0), steepest)
    for segment in segments:
        # These alone could make friction rise again beyond any limit.
        segment.changes.pop("load", None)
        segment.changes.pop("mu_k", None)
        if generator.random() < 0.2:
            segment.changes["slope"] = values["slope"] * generator.random()
    return values, segments


def drive(
    values: Mapping[str, float], segments: Sequence[Segment], split: object = whole
) -> list[dict[str, float]] | None:
    """Return the outputs at the end of each segment; None where the motion leaves the law."""
    block = make_block(**values)
    time, record = 0.0, []
    for segment in segments:
        for name, value in segment.changes.items():
            block.set(name, value)
        try:
            for step in split(segment.length):  # type: ignore[operator]
                block.advance(time, step)
                time += step
        except ModelError as error:
            if "falling friction ends at the speed" not in str(error):
                raise
            return None
        record.append(outputs(block))
    return record


def test_without_slope_every_bit_is_coulombs() -> None:
    """At slope = 0 every output equals that of Coulomb's law, bit for bit."""
    generator = random.Random(21)
    for _ in range(100):
        values, segments = draw(generator)
        assert drive({**values, "slope": 0.0}, segments) == drive_coulomb(values, segments)


def test_the_step_does_not_matter() -> None:
    """One step gives what random uneven steps give, within 1e-12 of the motion's scale."""
    generator = random.Random(22)
    held = 0
    for _ in range(200):
        values, segments = draw_falling(generator)
        once, often = drive(values, segments), drive(values, segments, uneven(generator))
        assert (once is None) == (often is None)
        if once is None or often is None:
            continue
        held += 1
        scale = max(max(abs(row["z"]), abs(row["x"])) for row in once)
        for one, many in zip(once, often, strict=True):
            for name in ("x", "z", "x_pull"):
                assert one[name] == pytest.approx(many[name], abs=1e-12 * scale, rel=0.0)
            assert one["n_slips"] == many["n_slips"]
    assert held > 100


def test_energy_is_kept() -> None:
    """Work in, less heat out, is the change of the stored energy, also where the motion grows."""
    generator = random.Random(23)
    held = 0
    for _ in range(200):
        values, segments = draw_falling(generator)
        rows = drive(values, segments)
        if rows is None:
            continue
        held += 1
        k, m = values["k"], values["m"]
        start = 0.5 * m * values["x_dot_start"] ** 2 + 0.5 * k * values["z_start"] ** 2
        largest, external, x, work = start, 0.0, 0.0, 0.0
        for segment, row in zip(segments, rows, strict=True):
            external = segment.changes.get("F_ext", external)
            k = segment.changes.get("k", k)
            work += external * (row["x"] - x)
            x = row["x"]
            stored = 0.5 * m * row["x_dot"] ** 2 + 0.5 * k * row["z"] ** 2
            largest = max(largest, stored, abs(row["W_pull"]), row["Q_friction"], abs(work))
            gap = math.fsum([start, work, row["W_pull"], row["W_k"], -row["Q_friction"], -stored])
            assert abs(gap) <= 1e-11 * largest
    assert held > 100


def test_state_returns_bit_for_bit() -> None:
    """A state that went through JSON, or was frozen, repeats every output."""
    generator = random.Random(24)
    for _ in range(30):
        values, segments = draw_falling(generator)
        block = make_block(**values)
        try:
            for segment in segments:
                for name, value in segment.changes.items():
                    block.set(name, value)
                other, third = make_block(), make_block()
                other.restore(json.loads(json.dumps(block.save())))
                third.thaw(block.freeze())
                for each in (block, other, third):
                    each.advance(1.0, segment.length)
                assert outputs(block) == outputs(other) == outputs(third)
        except ModelError:
            continue


# Effective damping ratio (c - slope N)/(2 sqrt(k m)), and what the pull and the gap are.
SETTINGS = {
    "falls slowly": {"slope": 0.05},
    "damped all the same": {"slope": 0.05, "c": 3.0},
    "no damping left": {"slope": 0.5, "c": 4.0, "g": 8.0},
    "grows fast": {"slope": 2.0, "mu_k": 0.48, "z_start": 0.0049},
    "grows without a swing": {"slope": 8.0, "mu_k": 0.49999, "v": 1e-4, "z_start": 0.0049049},
    "swings a while before it stops": {
        "slope": 0.02,
        "mu_k": 0.5,
        "v": 0.05,
        "x_dot_start": 0.0499,
    },
    "backward": {"slope": 0.3, "v": -0.02},
    "reversals": {"slope": 0.1, "v": 0.0, "z_start": 0.05},
}


@pytest.mark.parametrize("name", SETTINGS)
def test_block_is_the_truth(name: str) -> None:
    """Every output after every step is the truth, to 1e-11 of its scale."""
    values = SETTINGS[name]
    # Growth without a swing leads beyond the law in a tenth of a second.
    pace = 0.05 if name == "grows without a swing" else 1.0
    lengths = [length * pace for length in (0.07, 0.07, 0.07, 0.1, 0.4)]
    steps = [Step(length) for length in lengths]
    steps[3] = Step(lengths[3], {"slope": 0.5 * values["slope"]})
    block = make_block(**values)
    exact = truth.run(values, steps, digits=30, law=NAME).samples
    time, rows = 0.0, []
    for step in steps:
        for changed, value in step.changes.items():
            block.set(changed, value)
        block.advance(time, step.h)
        time += step.h
        rows.append(outputs(block))
    for output in rows[0]:
        course = [float(sample[output]) for sample in exact]
        scale = max(map(abs, course))
        for found, expected in zip(rows, course, strict=True):
            assert found[output] == pytest.approx(expected, rel=0.0, abs=1e-11 * scale), output


def test_a_sliding_that_hardly_grows_is_taken_to_its_stop_at_once() -> None:
    """A swing of 1e-4 v about steady sliding, growing at 5e-7/s, stops after ln(1e4)/5e-7 s."""
    slope = 1e-6 / 9.81
    # Steady sliding has k z = mu_k N - slope N v.
    z_start = (0.5 * 9.81 - 1e-6 * 0.02) / 1000.0
    block = make_block(slope=slope, mu_k=0.5, z_start=z_start, x_dot_start=0.02 * (1.0 - 1e-4))
    # It stops within one period, 0.2 s, of the time at which the swing has grown to v.
    end = block.state.arc.duration
    assert end == pytest.approx(math.log(1e4) / 5e-7, abs=0.2)
    block.advance(0.0, end + 1e-3)
    assert block.meter.n_slips == 1


def test_beyond_the_speed_where_friction_ends_the_block_refuses() -> None:
    """The message names the speed and the limit; until then the motion is as it was."""
    block = make_block(slope=0.3 / 0.08)
    block.advance(0.0, 0.25)
    with pytest.raises(ModelError, match=r"x_dot = 0\.0\d+ m/s .* mu_k/slope = 0\.08 m/s"):
        block.advance(0.25, 0.25)


def test_a_slip_that_grows_fast_stops_or_leaves_the_law_in_time() -> None:
    """At a damping ratio of -490 the spring is nothing to 1e-6: m u' = P + slope N u.

    P is the force on the mass at rest, and the speed is u = (u0 + P/(slope N)) exp(g t) -
    P/(slope N) with g = slope N/m.
    """
    g, u0, limit = 981.0, 1e-5, 3e-3
    fast = {"k": 1.0, "v": 1e-6, "slope": 100.0, "mu_k": 0.3, "x_dot_start": u0}
    # P = -mu_k N: the speed falls from u0 to 0.
    block = make_block(**fast)
    end = math.log(limit / (limit - u0)) / g
    assert block.state.arc.duration == pytest.approx(end, rel=1e-6)
    block.advance(0.0, 1e-4)
    assert block.meter.n_slips == 1
    assert outputs(block)["t_slip"] == pytest.approx(end, rel=1e-6)
    # P = (mu_s - mu_k) N: it grows from u0 to the limit.
    block = make_block(**fast, z_start=4.905)
    force = 2e-3
    end = math.log((limit + force) / (u0 + force)) / g
    assert block.state.arc.duration == pytest.approx(end, rel=1e-6)
    with pytest.raises(
        ModelError, match=r"x_dot = 0\.00(3|29999)\d* m/s .* mu_k/slope = 0\.003 m/s"
    ):
        block.advance(0.0, 1e-2)


@pytest.mark.parametrize("distance", [1e-7, 1e-10, 1e-13, 0.0, -1e-13, -1e-10, -1e-7])
def test_beside_the_critical_negative_damping_the_block_is_the_truth(distance: float) -> None:
    """At a damping ratio of -1, where swings end, the block gives the truth's motion.

    N = 8 N, 2 sqrt(k m) = 64 N.s/m, so the ratio is -1 + `distance`.
    """
    values = {"g": 8.0, "k": 1024.0, "mu_k": 0.25, "slope": 8.0 * (1.0 - distance)}
    values |= {"v": 2.0**-12, "x_dot_start": 2.0**-13, "z_start": 2.0**-9}
    block = make_block(**values)
    block.advance(0.0, 0.03125)
    run = truth.run(values, [Step(0.03125)], law=NAME)
    for name in ("x", "z", "x_dot", "Q_friction"):
        # Growth by exp(32 t) amplifies rounding by e.
        assert outputs(block)[name] == pytest.approx(float(run.samples[0][name]), rel=1e-13)


def test_a_slope_that_cancels_the_damping_leaves_the_undamped_motion() -> None:
    """With c = slope N the run is Coulomb's with c = 0, the heat mu_k N times the way."""
    values = {"c": 4.905, "slope": 0.5, "v": 0.2}
    segments = [Segment(0.125, {})] * 16
    rows, undamped = drive(values, segments), drive_coulomb({"v": 0.2}, segments)
    assert rows is not None
    for row, other in zip(rows, undamped, strict=True):
        for name in ("x", "z", "x_dot", "Q_friction", "t_slip"):
            # Ten slips in 2 s, each to a few units of rounding.
            assert row[name] == pytest.approx(other[name], rel=1e-12, abs=1e-14)


def test_without_a_normal_force_the_mass_swings_without_heat() -> None:
    """At N = 0 the motion from rest is x = v (t - sin(w t)/w), and Q_friction is 0."""
    block = make_block(load=-9.81, slope=0.1)
    block.advance(0.0, 0.7)
    w = math.sqrt(1000.0)
    found = outputs(block)
    assert found["x"] == pytest.approx(0.02 * (0.7 - math.sin(w * 0.7) / w), rel=1e-13)
    assert found["Q_friction"] == 0.0


@pytest.fixture(scope="module", params=[2, 3])
def fmu(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the FMU of the law, of FMI 2.0 and 3.0."""
    return build(tmp_path_factory.mktemp("falling"), face=request.param, law=NAME)


def test_the_fmu_has_a_name_and_rows_of_its_own(fmu: Path) -> None:
    """It is valid, is called by the law, and its parameter comes after the interface's rows."""
    assert not fmpy.validation.validate_fmu(str(fmu))
    assert fmu.name.startswith("FallingFriction")
    description = fmpy.read_model_description(str(fmu))
    assert description.coSimulation.modelIdentifier == "FallingFriction"
    (slope,) = (each for each in description.modelVariables if each.name == "slope")
    assert (slope.valueReference, slope.unit, slope.start) == (34, "s/m", "0.1")
    with zipfile.ZipFile(fmu) as archive:
        assert not [name for name in archive.namelist() if "numpy" in name or "mpmath" in name]


def test_the_fmu_gives_what_the_block_gives(fmu: Path) -> None:
    """A run in fmpy has the block's outputs, bit for bit."""
    run = fmpy.simulate_fmu(
        str(fmu),
        stop_time=1.0,
        step_size=0.125,
        output_interval=0.125,
        start_values={"slope": 0.25},
        output=["x", "z", "F_friction", "Q_friction", "t_slip"],
    )
    block = make_block(slope=0.25)
    for sample in run[1:]:
        block.advance(float(sample["time"]) - 0.125, 0.125)
        found = outputs(block)
        assert all(found[name] == sample[name] for name in run.dtype.names[1:])


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("falling", "is no dotted name module:NAME, such as 'my_laws"),
        ("nowhere:LAW", "was not found (No module named 'nowhere')"),
        ("tests.laws.falling:LAW", "was not found (module 'tests.laws.falling' has no attribute"),
        ("tests.laws.falling.block:LAW", "has no attribute 'block' with the dotted name"),
        ("tests.laws.test_falling_block:NO_LAW", "is a dict; the block's side of a friction law"),
        ("tests.laws.test_falling_block:NAMESAKE", "needs a model name other than StickSlip"),
    ],
)
def test_a_law_that_is_none_is_refused(tmp_path: Path, name: str, reason: str) -> None:
    """What is wrong with a dotted name is said with an example."""
    with pytest.raises(ValueError) as caught:  # noqa: PT011 - the text is compared below
        build(tmp_path, law=name)
    assert reason in str(caught.value)


class _Sides:
    def __init__(self, block: str) -> None:
        self.block = block


NO_LAW = _Sides("tests.laws.test_falling_block:SETTINGS")
NAMESAKE = _Sides("stickslip_fmu.laws.coulomb.law:COULOMB")
