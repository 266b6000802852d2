"""What coupling in steps does to drive and table, and that it vanishes as the step falls."""

import itertools
import math
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from examples.feed_axis.axis import Axis
from examples.feed_axis.document import STEPS, WAYS, coupling_table, exact_axis
from examples.feed_axis.estimates import coupling_damping
from examples.feed_axis.monolithic import solve
from examples.feed_axis.study import rows_of
from stickslip_ref import Parameters, steady_cycle

from .in_process import couple, make_block
from .running import ROOT, run_all

Array = NDArray[np.float64]

EXACT = {"resolution_motor": 0.0, "resolution_table": 0.0}

# No control, a table that holds, and a force that acts from the start on: drive against spring.
FREE: dict[str, Any] = {
    **EXACT,
    "omega_v": 0.0,
    "d": 0.0,
    "mu_s": 10.0,
    "mu_k": 9.0,
    "friction_feedforward": 400.0,
}


@pytest.fixture(scope="module")
def errors(fmus: Path) -> dict[str, list[float]]:
    """Return the largest error of the table's position [m] by way of coupling, over `STEPS`."""
    axis = exact_axis()
    truth = solve(axis, 0.5).column("x", axis)
    runs = [
        ({**EXACT, "follow": follow}, 0.5, step, order)
        for order, follow in WAYS.values()
        for step in STEPS
    ]
    found = iter(run_all(fmus, runs, "time", "x"))
    return {name: [error_at_samples(axis, truth, *next(found)) for _ in STEPS] for name in WAYS}


def error_at_samples(axis: Axis, truth: Array, time: Array, x: Array) -> float:
    """Return the largest error where the run has a sample of the controller."""
    sample = time / axis.T_s
    at = np.abs(sample - np.rint(sample)) < 1e-6
    return float(np.max(np.abs(x[at] - truth[np.rint(sample[at]).astype(int)])))


def orders(errors: list[float]) -> list[float]:
    """Return the observed order from step to half the step."""
    return [math.log2(coarse / fine) for coarse, fine in itertools.pairwise(errors)]


def test_the_coupled_loop_converges_to_the_whole_one_with_the_square_of_the_step(
    errors: dict[str, list[float]],
) -> None:
    """Halving the communication step quarters the distance from the loop solved as one."""
    # From 0.25 ms on; the next term is smaller by w h < 0.08 of a period's radian.
    assert orders(errors["as shipped"][2:]) == pytest.approx([2.0, 2.0], abs=0.08)


@pytest.mark.parametrize("way", ["table before drive", "force held"])
def test_other_couplings_converge_with_the_step_only(
    way: str, errors: dict[str, list[float]]
) -> None:
    """Told the end of the step for its start, or with the force held, the drive errs by order h."""
    assert orders(errors[way][2:]) == pytest.approx([1.0, 1.0], abs=0.08)
    assert errors[way][2] > 10.0 * errors["as shipped"][2]


def test_the_how_to_tells_these_errors(errors: dict[str, list[float]]) -> None:
    """The table of coupling errors in the how-to is that of these runs."""
    told = rows_of((ROOT / "docs/feed-axis.md").read_text(encoding="utf-8"), "coupling")
    for line in coupling_table(errors)[2:]:
        step, *found = (cell.strip() for cell in line.strip("|").split("|"))
        # Three digits are told, and rounding changes the last one.
        assert [float(cell) for cell in told[step][1:]] == pytest.approx(
            [float(cell) for cell in found], rel=0.01
        )


def test_coupling_damps_by_what_the_how_to_derives(fmus: Path) -> None:
    """With the table stuck: nothing as shipped, w h/2 one after the other, -w h/4 held."""
    axis, h = Axis(**FREE), 250e-6
    w_d = math.sqrt(axis.k / axis.m_d)
    ways = [("jacobi", True), ("table first", True), ("drive first", True), ("jacobi", False)]
    runs = [({**FREE, "follow": follow}, 1.0, h, order) for order, follow in ways]
    found = [damping(x - 400.0 / axis.k, w_d) for _, x in run_all(fmus, runs, "time", "x_motor")]
    assert abs(found[0]) < 1e-9
    # The next term of each is smaller by (w h)^2 = 1e-3 or, held, by w h / 4.
    assert found[1:3] == pytest.approx([0.5 * w_d * h] * 2, rel=2e-3)
    assert found[3] == pytest.approx(-0.25 * w_d * h, rel=1e-2)


def damping(x: Array, w: float, h: float = 250e-6) -> float:
    """Return the damping ratio from the growth of the peaks of an oscillation around 0."""
    peaks = np.flatnonzero((x[1:-1] > x[:-2]) & (x[1:-1] >= x[2:])) + 1
    before, at, after = x[peaks - 1], x[peaks], x[peaks + 1]
    # The peak of the parabola through three points.
    height = at + (before - after) ** 2 / (8.0 * (2.0 * at - before - after))
    return float(-np.polyfit(h * peaks, np.log(height), 1)[0] / w)


@pytest.mark.parametrize("table", ["slides", "stuck"])
def test_plain_coupling_takes_damping_away(table: str) -> None:
    """A drive that holds the force and gives its speed of now adds -(w_d^2 / w) h / 2."""
    axis, h = Axis(), 250e-6
    w_d = math.sqrt(axis.k / axis.m_d)
    w = w_d if table == "stuck" else math.hypot(w_d, math.sqrt(axis.k / axis.m))
    mu = 10.0 if table == "stuck" else 0.0
    block = make_block(m=axis.m, k=axis.k, mu_s=mu, mu_k=mu, z_start=1e-5, v=0.0)
    v, stretch = 0.0, []
    for index in range(4000):
        block.refresh()
        stretch.append(float(block.z))
        block.set("v", v)
        v -= h * float(block.F) / axis.m_d
        block.advance(index * h, h)
    found = damping(np.array(stretch), w)
    # The next terms are smaller by (w h)^2 < 0.01; the estimate is of first order in 0.016.
    assert found == pytest.approx(coupling_damping(w_d, w, h), rel=0.03)


def test_uneven_steps_are_as_good_as_even_ones() -> None:
    """Steps of any length, with the last digits that importers leave, change the order not."""
    generator = random.Random(1)
    axis = exact_axis()
    truth = solve(axis, 0.3)
    times = np.array(truth.time[4::4])
    x = truth.column("x", axis)[4::4]

    def cut(length: float, parts: int) -> list[float]:
        shares = [0.4 + generator.random() for _ in range(parts)]
        steps = [length * share / sum(shares) for share in shares]
        return [*steps[:-1], length - sum(steps[:-1])]

    errors = []
    for parts in (4, 8):
        steps = [step for _ in times for step in cut(4 * axis.T_s, parts)]
        errors.append(float(np.max(np.abs(couple(axis, steps).table_at(times) - x))))
    # Uneven halves halve each step on average only; second order remains: 4, against 2.
    assert errors[0] < 1e-6
    assert 3.0 < errors[0] / errors[1] < 5.0


def test_a_step_short_by_rounding_neither_loses_nor_doubles_a_sample() -> None:
    """Steps of 0.00024999999999999 s and a rest of 1e-16 s give what even steps give."""
    axis = exact_axis()
    even = couple(axis, [axis.T_s] * 800)
    rounded = couple(axis, [step for _ in range(800) for step in (axis.T_s - 1e-14, 1e-14)])
    # Speeds differ by 1e-14 / 2.5e-4 of themselves in each step, and motion is 1e-4 m.
    assert rounded.x[-1] == pytest.approx(even.x[-1], abs=1e-9)


def test_nut_and_motor_stay_together() -> None:
    """Where the block has its pulled end, the motor is, to a prediction of one step."""
    axis = exact_axis()
    motion = couple(axis, [axis.T_s] * 4000)
    apart = np.abs(np.array(motion.x_motor) - np.array(motion.x_pull))
    # The largest force that one step does not see, k h^2 a with a = (F_s - F_k)/m, moves the
    # drive by that over m_d times h^2.
    h, a = axis.T_s, (axis.mu_s - axis.mu_k) * 9.81
    assert float(apart.max()) < axis.k * h * h * a / axis.m_d * h * h * 10.0


def test_a_drive_that_never_gives_way_leaves_the_steady_cycle(fmus: Path) -> None:
    """With a thousand million times the inertia the table jumps as docs/theory.md (10) says."""
    still = {"J": 6e6, "F_max": 1e30, "on_table": False, "feed": 1e-3, **EXACT}
    (columns,) = run_all(fmus, [(still, 1.0, 250e-6, "jacobi")], "delta_x", "T")
    cycle = steady_cycle(Parameters(m=500.0, k=4e7, c=4000.0, mu_s=0.2, mu_k=0.15, v=1e-3))
    # The speed gives way by 981 N / K_p = 1.4e-12 of 1e-3 m/s; the cycle's sensitivity is O(10).
    assert columns[0][-1] == pytest.approx(float(cycle.delta_x), rel=1e-7)
    assert columns[1][-1] == pytest.approx(float(cycle.T), rel=1e-7)
