"""What coupling in steps does to drive and table, and that it vanishes as the step falls."""

import itertools
import json
import math
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from examples.feed_axis import document, study
from examples.feed_axis.axis import Axis
from examples.feed_axis.coupling import coupling_damping
from examples.feed_axis.document import WAYS, check_coupling, exact_axis
from examples.feed_axis.monolithic import solve
from examples.feed_axis.study import rows_of
from stickslip_ref import Parameters, steady_cycle
from tests.fmu.blocks import make_block

from .in_process import couple
from .running import ROOT, output_of, run_all

Array = NDArray[np.float64]

TEXT = (ROOT / "docs/feed-axis.md").read_text(encoding="utf-8")

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
    found: dict[str, list[float]] = json.loads(output_of("coupled", str(fmus)))
    return found


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
    """The table of coupling errors in the how-to is that of these runs; another is found wrong."""
    assert check_coupling(TEXT, errors) == []
    finest = f"{errors['as shipped'][-1] * 1e6:#.3g}"
    wrong = check_coupling(TEXT.replace(f"| {finest} |", "| 0.00901 |"), errors)
    assert wrong == [f"62.5: 0.00901 is told, {finest} was found"]
    assert len(check_coupling(TEXT.replace("| 62.5 |", "| 50 |"), errors)) == 1


def test_the_check_of_the_how_to_reads_all_three_tables(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What a table of variants and that of the coupling tell wrong, `study --check` reports."""
    how_to = tmp_path / "how-to.md"
    how_to.write_text(TEXT, encoding="utf-8")
    rows = {name: rows_of(TEXT, name) for name in ("creep", "hunting", "coupling")}
    told = [row[1:] for row in rows["coupling"].values()]
    as_told = {
        way: [1e-6 * float(cells[column]) for cells in told] for column, way in enumerate(WAYS)
    }
    monkeypatch.setattr(study, "creep_row", lambda _, each: rows["creep"][each.name])
    monkeypatch.setattr(study, "hunting_row", lambda _, each: rows["hunting"][each.name])
    monkeypatch.setattr(document, "coupling_errors", lambda _: as_told)
    monkeypatch.setattr(document, "pictures_of", lambda *_: {})
    assert document.check_document(how_to, tmp_path, lambda _: None) == []
    rows["creep"]["as it is"][1] = "19.4"
    rows["hunting"]["no integral"][1] = "no"
    as_told["force held"][0] *= 1.1
    wrong = document.check_document(how_to, tmp_path, lambda _: None)
    assert [line.partition(":")[0] for line in wrong] == ["as it is", "no integral", "1000"]


def test_coupling_damps_by_what_the_how_to_derives(fmus: Path) -> None:
    """With the table stuck: 0 as shipped, w h/2 one after the other; held, -w h/4 and w h/4."""
    axis, h = Axis(**FREE), 250e-6
    w_d = math.sqrt(axis.k / axis.m_d)
    ways = [
        ("jacobi", True),
        ("table first", True),
        ("drive first", True),
        ("jacobi", False),
        ("table first", False),
        ("drive first", False),
    ]
    runs = [({**FREE, "follow": follow}, 1.0, h, order) for order, follow in ways]
    found = [damping(x - 400.0 / axis.k, w_d) for _, x in run_all(fmus, runs, "time", "x_motor")]
    assert abs(found[0]) < 1e-9
    # The next term of each is smaller by (w h)^2 = 1e-3 or, held, by w h / 4.
    assert found[1:3] == pytest.approx([0.5 * w_d * h] * 2, rel=2e-3)
    assert found[3] == pytest.approx(-0.25 * w_d * h, rel=1e-2)
    assert found[4:] == pytest.approx([0.25 * w_d * h] * 2, rel=1e-2)


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


@pytest.mark.parametrize("order", ["table first", "drive first"])
def test_plain_coupling_one_after_the_other_leaves_the_damping(order: str) -> None:
    """A drive that gives its speed of now pays nothing in Gauss-Seidel, whichever goes first."""
    axis, h = Axis(), 250e-6
    w_d = math.sqrt(axis.k / axis.m_d)
    block = make_block(m=axis.m, k=axis.k, mu_s=10.0, mu_k=10.0, z_start=1e-5, v=0.0)
    v, stretch = 0.0, []
    for index in range(4000):
        block.refresh()
        stretch.append(float(block.z))
        if order == "drive first":
            v -= h * float(block.F) / axis.m_d
        block.set("v", v)
        block.advance(index * h, h)
        block.refresh()
        if order == "table first":
            v -= h * float(block.F) / axis.m_d
    # The map keeps areas, so the ratio is 0; a parabola through three points finds a peak of the
    # cosine to (w h)^4 = 1e-6 of it, and 41 peaks over 265 radians wash that out further.
    assert abs(damping(np.array(stretch), w_d)) < 1e-8


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
    """Steps of 0.00024999999999 s and a rest of 1e-14 s give what even steps give."""
    axis = exact_axis()
    even = couple(axis, [axis.T_s] * 800)
    rounded = couple(axis, [step for _ in range(800) for step in (axis.T_s - 1e-14, 1e-14)])
    x = np.array(even.x)
    # At the rest the drive sees the table once more before it says its speed, so nut and motor do
    # not part by what one prediction misses, 1.5e-11 m. By that over the feed a jump begins at
    # another time, and is off by that times the table's speed, 5 feeds; there are 5 jumps.
    missed = float(np.max(np.abs(np.array(even.x_motor) - np.array(even.x_pull))))
    speed = np.diff(x) / axis.T_s
    jumps = np.count_nonzero((speed[1:] > 0.0) & (speed[:-1] == 0.0))
    off = np.abs(np.array(rounded.x[::2]) - x)
    # One sample lost or doubled moves the table by 2e-8 m or more.
    assert float(off.max()) < jumps * missed * float(speed.max()) / axis.feed < 1e-9
    # And how long the rest is does not matter: speeds differ by 1e-12 / 2.5e-4 of themselves in a
    # step, which the next makes good; the motion is 1e-4 m.
    longer = couple(axis, [step for _ in range(800) for step in (axis.T_s - 1e-12, 1e-12)])
    apart = np.abs(np.array(rounded.x) - np.array(longer.x))
    assert float(apart[::2].max()) < 1e-12 / axis.T_s * 1e-4


def test_nut_and_motor_part_by_what_one_prediction_misses() -> None:
    """The table's second difference D, by the spring and by the controller: no more, no less."""
    axis = exact_axis()
    motion = couple(axis, [axis.T_s] * 4000)
    h, x = axis.T_s, np.array(motion.x)
    apart = np.array(motion.x_motor) - np.array(motion.x_pull)
    D = x[2:] - 2.0 * x[1:-1] + x[:-2]
    # What is predicted for a step lets the table go on as it went in the step before the last:
    # at tau into the step it is then off by D (1 + tau/h). The spring so misses k D (1 + tau/h),
    # which moves the drive by 2/3 k D h^2 / m_d; the controller misses K_p K_v (1 + h/T_n) D,
    # the other way.
    spring = 2.0 / 3.0 * axis.k / axis.m_d
    controller = 0.5 * axis.omega_v * axis.K_v * (1.0 + h / axis.T_n)
    expected = (spring - controller) * h * h * D[:-1]
    # The next terms are smaller by (w h)^2 = 1.1e-3, the spring's answer to this very motion.
    assert np.max(np.abs(apart[3:] - expected)) < 1.1e-3 * np.max(np.abs(expected))
    assert np.max(np.abs(expected)) > 1e-11


def test_a_drive_that_never_gives_way_leaves_the_steady_cycle(fmus: Path) -> None:
    """With a thousand million times the inertia the table jumps as docs/theory.md (10) says."""
    still = {"J": 6e6, "F_max": 1e30, "on_table": False, "feed": 1e-3, **EXACT}
    (columns,) = run_all(fmus, [(still, 1.0, 250e-6, "jacobi")], "delta_x", "T")
    cycle = steady_cycle(Parameters(m=500.0, k=4e7, c=4000.0, mu_s=0.2, mu_k=0.15, v=1e-3))
    # The speed gives way by 981 N / K_p = 1.4e-12 of 1e-3 m/s; the cycle's sensitivity is O(10).
    assert columns[0][-1] == pytest.approx(float(cycle.delta_x), rel=1e-7)
    assert columns[1][-1] == pytest.approx(float(cycle.T), rel=1e-7)
