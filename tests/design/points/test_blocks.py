"""Steady motions of many blocks, against the reference and against what must hold of any."""

import math
import warnings
from collections.abc import Mapping
from typing import Any, cast

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from numpy.typing import NDArray

import stickslip_ref
from stickslip_design.points import slips
from stickslip_design.points.blocks import COLUMNS, Regime, block_points, critical_speeds
from stickslip_fmu.block import Block
from stickslip_fmu.laws.stribeck.law import STRIBECK
from stickslip_fmu.spec import spec_of
from tests.conftest import Sized
from tests.needs import needs

Floats = NDArray[np.float64]
Points = dict[str, Floats]

ROUNDING = 1e-13
"""Two closed forms of one cycle, or one event by event: roundings times the conditioning of
well-conditioned points."""

INTEGRATED = 1e-10
"""A cycle of `stickslip_ref.simulate`, whose tolerance is 1e-12 a step."""


def drawn(seed: int, count: int, **ranges: tuple[float, float]) -> Points:
    """Return random values, each by the logarithm between two ends."""
    random = np.random.default_rng(seed)
    return {
        name: np.exp(random.uniform(math.log(low), math.log(high), count))
        for name, (low, high) in ranges.items()
    }


def coulomb(seed: int, count: int) -> Points:
    """Return random blocks under Coulomb's law, half of them damped."""
    points = drawn(
        *(seed, count),
        m=(0.1, 10.0),
        k=(1e2, 1e5),
        v=(1e-4, 0.3),
        mu_s=(0.3, 0.6),
        mu_k=(0.05, 0.3),
    )
    ratio = np.random.default_rng(seed).uniform(-0.3, 0.3, count)
    points["c"] = 2.0 * np.maximum(ratio, 0.0) * np.sqrt(points["k"] * points["m"])
    return points


def dwelling(seed: int, count: int) -> Points:
    """Return random blocks whose static friction grows at rest."""
    points = coulomb(seed, count) | drawn(seed + 1, count, tau_s=(5e-3, 5.0), t_0=(1e-3, 2.0))
    random = np.random.default_rng(seed)
    points["B"] = random.uniform(0.005, 0.05, count) * random.integers(0, 2, count)
    points["tau_s"] *= np.where(points["B"] > 0.0, random.integers(0, 2, count), 1)
    return points


def falling(seed: int, count: int) -> Points:
    """Return random blocks under friction that falls with the speed, of all three shapes."""
    points = drawn(
        *(seed, count),
        m=(0.3, 3.0),
        k=(1e2, 2e4),
        v=(2e-3, 1.0),
        mu_s=(0.35, 0.6),
        mu_k=(0.05, 0.3),
        v_s=(5e-3, 0.3),
        mu_2=(0.1, 0.3),
        mu_3=(0.1, 0.5),
    )
    random = np.random.default_rng(seed)
    points["shape"] = random.integers(1, 4, count).astype(float)
    points["delta"] = random.choice([1.0, 1.5, 2.0], count)
    points["c"] = random.uniform(0.0, 8.0, count)
    held = {"mu_1": 0.35, "n_points": 3.0, "u_2": 0.05, "u_3": 0.2}
    return points | {name: np.full(count, each) for name, each in held.items()}


def parameters(points: Mapping[str, Floats], number: int, law: str) -> stickslip_ref.Parameters:
    """Return one point as the reference takes it."""
    values = {name: float(each[number]) for name, each in points.items()}
    of_law = stickslip_ref.friction_law(law)
    own = {name: values.pop(name) for name in tuple(values) if name in of_law.parameters}
    return of_law.complete(stickslip_ref.Parameters(**values), own)


def assert_is(found: Mapping[str, NDArray[Any]], number: int, cycle: Any, tolerance: float) -> None:
    """Assert that a point is a cycle of the reference."""
    for name in ("delta_x", "T", "t_stick", "t_slip"):
        assert_allclose(found[name][number], getattr(cycle, name), rtol=tolerance, err_msg=name)


@pytest.mark.parametrize(
    ("points", "count"), [(coulomb, 200), pytest.param(dwelling, 200, marks=needs("cc"))]
)
def test_cycles_are_those_of_the_reference(points: Any, count: int) -> None:
    """Of Coulomb's law, and of static friction that grows at rest, which is followed here."""
    values = points(1, count)
    found = block_points(values, limit=False)
    cycles = [
        stickslip_ref.steady_cycle(parameters(values, number, "coulomb")) for number in range(count)
    ]
    exists = np.array([each.exists for each in cycles])
    # Sticks that do not settle to one length are no cycle.
    settles = (found["regime"] == Regime.STICKS) & np.isfinite(found["T"])
    assert 0.3 * count < exists.sum() < count
    assert not np.any(exists & ~settles)
    for number in np.flatnonzero(exists).tolist():
        assert_is(found, number, cycles[number], ROUNDING)
    # Where stops reverse the reference may miss a cycle that its simulation settles to, slowly.
    missed = np.flatnonzero(settles & ~exists)
    assert missed.size <= 1
    for number in missed.tolist():
        p = parameters(values, number, "coulomb")
        run = stickslip_ref.simulate(p, 40.0 * float(found["T"][number]), own=p.own)
        assert_allclose(found["T"][number], run.cycles[-1].T, rtol=1e-8)


@needs("cc")
def test_cycles_of_falling_friction_are_those_that_a_simulation_ends_in(sized: Sized) -> None:
    """And where the reference has no cycle the mass slides evenly or swings, as it says."""
    count = sized(200)
    values = falling(3, count)
    found = block_points(values, "stribeck", limit=False)
    assert len(set(found["regime"].tolist())) > 1
    for number in range(count):
        p, v = parameters(values, number, "stribeck"), float(values["v"][number])
        near = v * (1.0 - 1e-3), v * (1.0 + 1e-3)
        motions = stickslip_ref.critical_velocity(p, "stribeck", between=near).motions(v)
        assert Regime(found["regime"][number]).name.lower() == motions[0]
        if motions[0] == "sticks":
            first = float(p.F_s / (p.k * v))
            run = stickslip_ref.simulate(
                p, first + 3.0 * float(found["T"][number]), law="stribeck", own=p.own
            )
            cycle = run.cycles[-1]
            # The last of two slips goes back: the map takes both for one.
            of_slip = [] if cycle.delta_x < 0.0 else ["delta_x", "t_slip"]
            for name in ("T", "t_stick", *of_slip):
                # What is lost in a step is a part of the whole cycle.
                scale = cycle.delta_x if name == "delta_x" else cycle.T
                off = found[name][number] - getattr(cycle, name)
                assert abs(off) <= INTEGRATED * scale, (name, number)


@needs("cc")
def test_a_stop_beyond_the_break_away_force_slips_back_and_the_cycle_holds_both_slips() -> None:
    """As the reference simulates it: friction that falls so far brakes a fast slip too little."""
    found = block_points({"mu_k": 0.05, "v": 0.35}, "stribeck", limit=False)
    p = stickslip_ref.Parameters(mu_k=0.05, v=0.35)
    run = stickslip_ref.simulate(p, 4.0 * float(found["T"]), law="stribeck")
    assert "reversal" in {event.kind for event in run.events}
    for name in ("T", "t_stick"):
        assert_allclose(found[name], getattr(run.cycles[-1], name), rtol=INTEGRATED)
    assert_allclose(found["t_slip"], found["T"] - found["t_stick"], rtol=ROUNDING)


@needs("cc")
@pytest.mark.parametrize(
    ("law", "values"),
    [
        ("coulomb", {"c": 2.0}),
        ("coulomb", {"c": 2.0, "tau_s": 0.02}),
        ("coulomb", {"c": 0.5, "tau_s": 0.3, "mu_k": 0.4}),
        ("stribeck", {"c": 2.0, "v_s": 0.05}),
        ("stribeck", {"c": 2.0, "shape": 2.0}),
    ],
)
def test_points_within_a_millionth_of_the_critical_velocity_are_marked(
    law: str, values: dict[str, float]
) -> None:
    """On both sides of it; and points ten times as far are not."""
    limit = float(critical_speeds(values, law))
    assert 0.0 < limit < math.inf
    off = np.array([-1e-5, -5e-7, 5e-7, 1e-5])
    found = block_points({**values, "v": limit * (1.0 + off)}, law, limit=False)
    assert_array_equal(found["regime"] == Regime.STICKS, [True, True, False, False])
    assert_array_equal(found["at_limit"], [False, True, True, False])


@needs("cc")
@pytest.mark.parametrize(
    ("law", "values", "limit"),
    [
        ("stribeck", {"mu_k": 0.0}, 0.7380586785051350),
        ("coulomb", {"c": 0.05, "tau_s": 0.3, "mu_k": 0.01}, 0.007635343500646529),
    ],
)
def test_where_the_mass_begins_to_turn_back_is_marked(
    law: str, values: dict[str, float], limit: float
) -> None:
    """On both sides, at limits that were found by halving intervals of the pulling velocity."""
    off = np.array([-1e-5, -5e-7, 5e-7, 1e-5])
    found = block_points({**values, "v": limit * (1.0 + off)}, law, limit=False)
    assert_array_equal(found["at_limit"], [False, True, True, False])


@needs("cc")
def test_where_steady_sliding_becomes_stable_is_marked_too() -> None:
    """At c = -N mu'(v), with a cycle or without."""
    values = {"c": 3.0, "v_s": 0.05}
    found = stickslip_ref.critical_velocity(
        stickslip_ref.Parameters(c=3.0), "stribeck", {"v_s": 0.05}
    )
    edge = found.unstable[0].high
    marked = block_points({**values, "v": edge * np.array([0.999, 1.0, 1.001])}, "stribeck")
    assert_array_equal(marked["at_limit"], [False, True, False])


@needs("cc")
@pytest.mark.parametrize(
    ("law", "points"), [("coulomb", coulomb), ("coulomb", dwelling), ("stribeck", falling)]
)
def test_backward_is_the_mirror_of_forward(law: str, points: Any) -> None:
    """Jumps change their sign, and nothing else."""
    values = points(5, 60)
    forward = block_points(values, law, limit=False)
    backward = block_points({**values, "v": -values["v"]}, law, limit=False)
    for name in COLUMNS.keys() - {"v_c"}:
        sign = -1.0 if name.startswith("delta_x") else 1.0
        assert_array_equal(
            backward[name], forward[name] if sign > 0.0 else -forward[name], err_msg=name
        )


@pytest.mark.parametrize("law", ["coulomb", pytest.param("stribeck", marks=needs("cc"))])
def test_an_open_grid_has_the_points_of_its_list(law: str) -> None:
    """The critical velocity too, which does not depend on v."""
    closed = law == "coulomb"
    limit = float(critical_speeds({"k": 1e3, "c": 4.0}, law))
    near = limit * (1.0 + np.array([-1e-3, -5e-7, 5e-7, 1e-3]))
    v = np.sort(np.concatenate([np.geomspace(1e-3, 1.0, 7), near]))
    open_ = dict(
        zip("kcv", np.ix_(np.geomspace(1e2, 1e4, 3), np.array([0.0, 4.0]), v), strict=True)
    )
    grid = np.broadcast_arrays(*open_.values())
    full = {name: each.ravel() for name, each in zip("kcv", grid, strict=True)}
    of_grid = block_points(open_, law, limit=closed)
    of_list = block_points(full, law, limit=closed)
    assert ("v_c" in of_grid) == closed
    assert of_grid["at_limit"][1, 1].sum() == 2
    for name, each in of_list.items():
        # The vector code of NumPy may round by the place in the array.
        assert_allclose(of_grid[name].ravel(), each, rtol=4e-16, err_msg=name)


@needs("cc")
def test_without_a_compiler_the_python_block_gives_the_same_and_it_is_told_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """To the bit, in one line, whatever is followed."""
    some = {name: each[:5] for name, each in falling(3, 20).items()}
    # These turn back before they stick.
    some = {name: np.append(each, [each[0]] * 2) for name, each in some.items()}
    for name, each in {**REVERSING, "v": np.array([0.35, 0.5])}.items():
        some[name][-2:] = np.asarray(each)
    grows = {name: each[:3] for name, each in dwelling(1, 20).items()}
    native = block_points(some, "stribeck", limit=False), block_points(grows, limit=False)
    monkeypatch.setattr(slips, "native_problem", lambda: "there is no compiler")
    slips._warn_once.cache_clear()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        slow = block_points(some, "stribeck", limit=False), block_points(grows, limit=False)
    for ours, theirs in zip(native, slow, strict=True):
        for name, each in ours.items():
            assert_array_equal(each, theirs[name], err_msg=name)
    (warning,) = caught
    assert issubclass(warning.category, slips.SlowCoreWarning)
    assert str(warning.message).startswith("there is no compiler; the Python block computes")


REVERSING = {"m": 1.0, "k": 1e3, "c": 0.0, "mu_s": 0.5, "mu_k": 0.05, "shape": 1.0, "v_s": 0.01}
"""Slips over nearly twice the way that the spring was drawn."""

SWINGS = {
    "m": 0.395,
    "k": 15686.0,
    "c": 7.63,
    "v": 0.04765,
    "mu_s": 0.426,
    "shape": 3.0,
    "n_points": 3.0,
    "mu_1": 0.35,
    "u_2": 0.05,
    "mu_2": 0.17,
    "u_3": 0.2,
    "mu_3": 0.327,
}
"""Friction falls up to a speed just above that of the pull, and rises from there on."""


@needs("cc")
@pytest.mark.parametrize("native", [True, False])
def test_a_slip_that_is_given_up_has_no_end(native: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """It fades or swings for ever: the block slips on for 40 turns."""
    if not native:
        monkeypatch.setattr(slips, "native_problem", lambda: "there is no compiler")
    random = {name: each[:30] for name, each in falling(7, 100).items()}
    runs = {name: np.append(each, SWINGS.get(name, 1.0)) for name, each in random.items()}
    found = slips.first_slips(runs, "stribeck")
    endless = np.flatnonzero(np.isinf(found.t_slip)).tolist()
    assert 5 < len(endless) < 25
    assert endless[-1] == 30
    spec = spec_of(STRIBECK)
    for number in endless:
        values = {name: float(each[number]) for name, each in runs.items()}
        block = cast(Block, spec.model(spec.values({**spec.table.start_values(), **values})))
        turn = 2.0 * math.pi * math.sqrt(values["m"] / values["k"])
        block.advance(0.0, float(found.t_stick[number]) + 40.0 * turn)
        assert (block.mode, block.meter.n_slips) == (1, 0)
    # This one swings, and the others fade.
    speeds = []
    for _ in range(40):
        block.advance(0.0, 0.05 * turn)
        block.refresh()
        speeds.append(block.x_dot)
    assert 0.0 < min(speeds) < 0.8 * SWINGS["v"] < 1.2 * SWINGS["v"] < max(speeds)


@pytest.mark.parametrize("law", ["coulomb", pytest.param("stribeck", marks=needs("cc"))])
def test_without_a_pull_nothing_jumps(law: str) -> None:
    """A jump of 0, no period, and no limit near."""
    found = block_points({"v": np.array([0.0, 0.02])}, law, limit=False)
    assert found["regime"].tolist() == [Regime.EVEN, Regime.STICKS]
    assert found["delta_x"][0] == found["stick_share"][0] == 0.0
    assert np.isnan(found["T"][0])
    assert not found["at_limit"].any()


def test_the_simplified_jump_is_off_by_what_the_pull_adds() -> None:
    """At the start values it is 3.924 mm where the mass jumps 6.305 mm: docs/theory.md (12)."""
    found = block_points({})
    assert_allclose(found["delta_x_simplified"], 3.924e-3, rtol=1e-12)
    assert_allclose(found["simplified_error"], 3.924e-3 / found["delta_x"] - 1.0, rtol=1e-12)
    assert round(float(found["delta_x"]), 6) == 6.305e-3
    assert found["v_c"] == math.inf


@pytest.mark.parametrize(
    ("values", "law", "reason"),
    [
        ({"mass": 1.0}, "coulomb", "'mass' is no parameter or input of the block"),
        ({"k": np.array([1.0, -1.0])}, "coulomb", "k = -1.0 N/m is out of range"),
        ({"v_s": math.nan}, "stribeck", "v_s = nan m/s is out of range"),
        ({"load": -20.0}, "coulomb", "load = -20.0 N is out of range"),
        ({}, "viscous", "'viscous' has no map; the friction laws with one: coulomb, stribeck"),
    ],
)
def test_what_cannot_be_is_refused(values: dict[str, Any], law: str, reason: str) -> None:
    """By the name of the parameter, its value and its range."""
    with pytest.raises(ValueError, match=reason):
        block_points(values, law)
