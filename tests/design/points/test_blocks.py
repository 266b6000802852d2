"""Steady motions of many blocks, against the reference and against what must hold of any."""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from numpy.typing import NDArray

import stickslip_ref
from stickslip_design.points import slips
from stickslip_design.points.blocks import block_points, critical_speeds
from stickslip_design.points.columns import Regime
from tests.conftest import Sized
from tests.laws.memory import QDYN
from tests.needs import needs

Points = dict[str, NDArray[np.float64]]

ROUNDING = 1e-13
"""Two closed forms of one cycle, or one event by event: roundings times the conditioning of
well-conditioned points."""

INTEGRATED = 1e-10
"""A cycle of `stickslip_ref.simulate`, whose tolerance is 1e-12 a step."""

# Without a compiler the Python block computes the same.
pytestmark = pytest.mark.filterwarnings("ignore::stickslip_design.points.slips.SlowCoreWarning")


def drawn(seed: int, count: int, **ranges: tuple[float, float]) -> Points:
    random = np.random.default_rng(seed)
    return {
        name: np.exp(random.uniform(math.log(low), math.log(high), count))
        for name, (low, high) in ranges.items()
    }


def coulomb(seed: int, count: int) -> Points:
    points = drawn(
        seed, count, m=(0.1, 10.0), k=(1e2, 1e5), v=(1e-4, 0.3), mu_s=(0.3, 0.6), mu_k=(0.05, 0.3)
    )
    zeta = np.maximum(np.random.default_rng(seed).uniform(-0.3, 0.3, count), 0.0)
    return points | {"c": 2.0 * zeta * np.sqrt(points["k"] * points["m"])}


def dwelling(seed: int, count: int) -> Points:
    points = coulomb(seed, count) | drawn(seed + 1, count, tau_s=(5e-3, 5.0), t_0=(1e-3, 2.0))
    random = np.random.default_rng(seed)
    points["B"] = random.uniform(0.005, 0.05, count) * random.integers(0, 2, count)
    points["tau_s"] *= np.where(points["B"] > 0.0, random.integers(0, 2, count), 1)
    return points


def falling(seed: int, count: int) -> Points:
    points = drawn(
        seed, count, m=(0.3, 3.0), k=(1e2, 2e4), v=(2e-3, 1.0), mu_s=(0.35, 0.6), mu_k=(0.05, 0.3),
        v_s=(5e-3, 0.3), mu_2=(0.1, 0.3), mu_3=(0.1, 0.5),
    )  # fmt: skip
    random = np.random.default_rng(seed)
    points["shape"] = random.integers(1, 4, count).astype(float)
    points["delta"] = random.choice([1.0, 1.5, 2.0], count)
    points["c"] = random.uniform(0.0, 8.0, count)
    fixed = {"mu_1": 0.35, "n_points": 3.0, "u_2": 0.05, "u_3": 0.2}
    return points | {name: np.full(count, value) for name, value in fixed.items()}


def parameters(points: Mapping[str, Any], number: int, law: str) -> stickslip_ref.Parameters:
    values = {name: float(column[number]) for name, column in points.items()}
    of_law = stickslip_ref.friction_law(law)
    own = {name: values.pop(name) for name in tuple(values) if name in of_law.parameters}
    return of_law.complete(stickslip_ref.Parameters(**values), own)


@pytest.mark.parametrize(
    ("points", "count"),
    [(coulomb, 200), pytest.param(dwelling, 60, marks=pytest.mark.gate)],
)
def test_cycles_are_those_of_the_reference(points: Callable[..., Points], count: int) -> None:
    values = points(1, count)
    found = block_points(values, limit=False)
    cycles = [
        stickslip_ref.steady_cycle(parameters(values, number, "coulomb")) for number in range(count)
    ]
    exists = np.array([cycle.exists for cycle in cycles])
    # Sticks that do not settle to one length are no cycle.
    settles = (found["regime"] == Regime.STICKS) & np.isfinite(found["T"])
    assert 0.3 * count < exists.sum() < count
    assert not np.any(exists & ~settles)
    # Where stops reverse the reference may miss a cycle that its simulation settles to.
    assert np.sum(settles & ~exists) <= 1
    for name in ("delta_x", "T", "t_stick", "t_slip"):
        expected = np.array([getattr(cycle, name) for cycle in cycles])[exists]
        assert_allclose(found[name][exists], expected, rtol=ROUNDING, err_msg=name)


@pytest.mark.gate
def test_cycles_of_falling_friction_are_those_that_a_simulation_ends_in(sized: Sized) -> None:
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
            end = float(p.F_s / (p.k * v)) + 3.0 * float(found["T"][number])
            cycle = stickslip_ref.simulate(p, end, law="stribeck", own=p.own).cycles[-1]
            # The last of two slips goes back: the map takes both for one.
            of_slip = [] if cycle.delta_x < 0.0 else ["delta_x", "t_slip"]
            for name in ("T", "t_stick", *of_slip):
                # What is lost in a step is a part of the whole cycle.
                scale = cycle.delta_x if name == "delta_x" else cycle.T
                off = found[name][number] - getattr(cycle, name)
                assert abs(off) <= INTEGRATED * scale, (name, number)


REVERSING = {"mu_k": 0.05, "v": 0.35}
"""Friction that falls so far brakes a fast slip too little: it ends beyond break-away."""


def test_where_a_slip_turns_back_the_cycle_holds_both_slips() -> None:
    found = block_points(REVERSING, "stribeck", limit=False)
    p = stickslip_ref.Parameters(**REVERSING)
    run = stickslip_ref.simulate(p, 4.0 * float(found["T"]), law="stribeck")
    assert "reversal" in {event.kind for event in run.events}
    for name in ("T", "t_stick"):
        assert_allclose(found[name], getattr(run.cycles[-1], name), rtol=INTEGRATED)
    assert_allclose(found["t_slip"], found["T"] - found["t_stick"], rtol=ROUNDING)


@pytest.mark.parametrize(
    ("law", "values", "limit"),
    [
        # Where the cycle ends.
        ("coulomb", {"c": 1.0}, None),
        ("coulomb", {"c": 0.5, "tau_s": 0.3, "mu_k": 0.4}, None),
        ("stribeck", {"c": 2.0, "v_s": 0.05}, None),
        ("stribeck", {"c": 2.0, "shape": 2.0}, None),
        # Where the mass begins to turn back, found by halving intervals of v.
        ("stribeck", {"mu_k": 0.0}, 0.7380586785051350),
        ("coulomb", {"c": 0.05, "tau_s": 0.3, "mu_k": 0.01}, 0.007635343500646529),
    ],
)
def test_points_within_a_millionth_of_a_limit_are_marked_and_others_not(
    law: str, values: dict[str, float], limit: float | None
) -> None:
    limit, ends = limit or float(critical_speeds(values, law)), limit is None
    assert 0.0 < limit < math.inf
    off = np.array([-1e-5, -5e-7, 5e-7, 1e-5])
    found = block_points({**values, "v": -limit * (1.0 + off)}, law, limit=False)
    assert_array_equal(found["at_limit"], [False, True, True, False])
    if ends:
        assert_array_equal(found["regime"] == Regime.STICKS, [True, True, False, False])


@pytest.mark.parametrize(
    ("law", "points"), [("coulomb", coulomb), ("coulomb", dwelling), ("stribeck", falling)]
)
def test_backward_is_the_mirror_of_forward(law: str, points: Callable[..., Points]) -> None:
    values = points(5, 20)
    forward = block_points(values, law, limit=False)
    for name, column in block_points({**values, "v": -values["v"]}, law, limit=False).items():
        sign = -1.0 if name.startswith("delta_x") else 1.0
        assert_array_equal(column, sign * forward[name], err_msg=name)


@pytest.mark.parametrize("law", ["coulomb", "stribeck"])
def test_an_open_grid_has_the_points_of_its_list(law: str) -> None:
    v = float(critical_speeds({"k": 1e3, "c": 4.0}, law)) * np.array([0.01, 1.0 - 5e-7, 1.001])
    sides = np.ix_(np.geomspace(1e2, 1e4, 3), np.array([0.0, 4.0]), v)
    listed = (side.ravel() for side in np.broadcast_arrays(*sides))
    of_grid, of_list = (
        block_points(dict(zip("kcv", each, strict=True)), law, limit=law == "coulomb")
        for each in (sides, listed)
    )
    assert of_grid["at_limit"][1, 1].sum() == 1
    for name, column in of_list.items():
        # The vector code of NumPy may round by the place in the array.
        assert_allclose(of_grid[name].ravel(), column, rtol=4e-16, err_msg=name)


@needs("cc")
def test_without_a_compiler_the_python_block_gives_the_same_bits(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    cases: tuple[tuple[Mapping[str, Any], str], ...] = (
        (falling(3, 5), "stribeck"), (REVERSING, "stribeck"), (dwelling(1, 3), "coulomb"),
    )  # fmt: skip
    native = [block_points(*case, limit=False) for case in cases]
    monkeypatch.setattr(slips, "native_problem", lambda: "there is no compiler")
    for case, ours in zip(cases, native, strict=True):
        for name, column in block_points(*case, limit=False).items():
            assert_array_equal(ours[name], column, err_msg=name)


@pytest.mark.parametrize("law", ["coulomb", "stribeck"])
def test_without_a_pull_nothing_jumps(law: str) -> None:
    found = block_points({"v": np.array([0.0, 0.02])}, law, limit=False)
    assert found["regime"].tolist() == [Regime.EVEN, Regime.STICKS]
    assert found["delta_x"][0] == found["stick_share"][0] == 0.0
    assert np.isnan(found["T"][0])
    assert not found["at_limit"].any()


@pytest.mark.parametrize(
    ("law", "own"), [("coulomb", {}), ("coulomb", {"tau_s": 0.1}), ("stribeck", {})]
)
def test_kinetic_friction_above_static_is_clamped(law: str, own: dict[str, float]) -> None:
    v = np.geomspace(1e-3, 1.0, 4)
    above, clamped = (
        block_points({"c": 1.0, "mu_s": 0.3, "mu_k": mu_k, "v": v, **own}, law, limit=False)
        for mu_k in (0.4, 0.3 - 0.01)
    )
    for name, column in clamped.items():
        assert_array_equal(above[name], column, err_msg=name)


@pytest.mark.parametrize(
    ("values", "law", "reason"),
    [
        ({"mass": 1.0}, "coulomb", "'mass' is no parameter or input of the block"),
        ({"k": np.array([1.0, -1.0])}, "coulomb", "k = -1.0 N/m is out of range"),
        ({"load": -20.0}, "coulomb", "load = -20.0 N is out of range"),
        (
            {},
            "viscous",
            "'viscous' has no map; the friction laws with one: coulomb, .*, rate_state",
        ),
    ],
)
def test_what_cannot_be_is_refused(values: dict[str, Any], law: str, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        block_points(values, law)


@needs("cc")
def test_the_cycles_of_lugre_blocks_are_those_of_the_published_case() -> None:
    values: dict[str, Any] = {"m": 1.0, "k": 2.0, "c": 0.4, "mu_s": 1.5 / 9.81, "mu_k": 1.0 / 9.81,
              "sigma_1": math.sqrt(1e5), "v": np.array([0.1, -0.1, 1.0])}  # fmt: skip
    found = block_points(values, "lugre")
    # The period is that of the reference; at 1 m/s falls of the spring die away.
    assert found["T"][:2] == pytest.approx(6.36271982, rel=1e-6)
    assert found["delta_x"] == pytest.approx([0.636271982, -0.636271982, 0.0], rel=1e-6)
    assert found["regime"].tolist() == [Regime.STICKS, Regime.STICKS, Regime.EVEN]
    undamped = block_points({"v": 0.1, "k": 1e4}, "lugre")
    assert undamped["regime"] == Regime.SWINGS
    assert np.isnan(found["v_c"]).all()


@needs("cc")
def test_the_cycles_of_rate_and_state_blocks_are_those_of_the_published_case() -> None:
    values = {name: each for name, each in QDYN.items() if name != "z_start"}
    found = block_points({**values, "v": np.array([1e-6, -1e-6])}, "rate_state")
    assert found["T"] == pytest.approx(585.48393, rel=1e-7)
    stable = block_points({"v": 0.02, "a": 0.02}, "rate_state")
    assert stable["regime"] == Regime.EVEN
    assert np.isnan([*found["v_c"], *found["simplified_error"]]).all()
