"""A record of stick-slip tells spring, mass and friction, as far as it can."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from stickslip_design.identify.jumps import stick_slip
from stickslip_design.identify.model import Identified, Record
from stickslip_design.identify.noise import least_squares
from stickslip_ref import Change, Parameters, simulate
from tests.design.axes import SERVO
from tests.design.simulated import Simulation

m, g, k, c, mu_s, mu_k, v = 120.0, 9.81, 2e6, 600.0, 0.2, 0.12, 5e-4
P = Parameters(m=m, g=g, k=k, c=c, mu_s=mu_s, mu_k=mu_k, v=v)
GAP = (mu_s - mu_k) * m * g
TRUTH = {
    "k/m": k / m, "c/m": c / m, "gap": GAP / k, "axis.mass": m, "axis.stiffness": k, "axis.c": c,
    "friction.F_s": mu_s * m * g, "friction.F_k": mu_k * m * g, "F_s - F_k": GAP,
    "friction.mu_s": mu_s, "friction.mu_k": mu_k,
}  # fmt: skip
LOAD_UP = mu_s * m * g / (k * v)
CYCLE = 2.0 * GAP / (k * v) + 2.0 * math.pi * math.sqrt(m / k)
CYCLES = 8.0
TABLE, FORCE = 2, 16
"""Places in the state of a simulation: of the table, and of the commanded force."""


def pulled(begin: float = 0.0, **law: Any) -> Record:
    """Return what a pull of the block shows from a time on; from 0 with a rest before it."""
    times = np.arange(begin, begin + LOAD_UP + CYCLES * CYCLE, 5e-4, dtype=np.float64)
    run = simulate(P, float(times[-1]), times=times, **law)
    still = np.zeros(0 if begin else 100)
    x, F, command = (np.concatenate([still, s]) for s in (run.x, run.F, v * times))
    t = np.linspace(0.0, 5e-4 * (x.size - 1), x.size)
    return Record(t=t, position=x, force=F, command=command)


def noisy(record: Record, seed: int, of_x: float = 1e-4, of_F: float = 0.01) -> Record:
    draw = np.random.default_rng(seed)
    assert record.position is not None
    assert record.force is not None
    x, F = (
        s + share * np.ptp(s) * draw.standard_normal(s.size)
        for s, share in ((record.position, of_x), (record.force, of_F))
    )
    return replace(record, position=x, force=F)


def covered(found: Identified, truth: dict[str, float] = TRUTH) -> list[bool]:
    return [n.low <= truth[n.name] <= n.high for n in found.numbers]


def test_an_exact_record_tells_the_block() -> None:
    """Without noise all numbers of a pull with a load-up come out to the digits of the solver."""
    found = stick_slip(pulled())
    assert found.explained
    for name in ("k/m", "gap", "axis.mass", "axis.stiffness", "friction.F_s", "friction.F_k"):
        # The solver of the record has a tolerance of 1e-9 or so, a jump of it 100 times that.
        assert found.number(name).value == pytest.approx(TRUTH[name], rel=1e-5)
    assert found.number("axis.c").value == pytest.approx(c, rel=1e-3)


@pytest.mark.parametrize("column", ["position", "force"])
def test_each_column_tells_its_own(column: str) -> None:
    """The position tells ratios, and coefficients after a load-up; the force all in newtons."""
    both = noisy(pulled(), 1)
    alone = replace(both, force=None) if column == "position" else replace(both, position=None)
    found = stick_slip(alone)
    told = {n.name for n in found.numbers}
    assert {"k/m", "c/m", "gap"} < told
    assert ("friction.mu_s" in told) == (column == "position")
    assert ("friction.F_s" in told) == (column == "force")
    assert sum(covered(found)) >= len(told) - 2


def test_without_a_load_up_the_position_tells_only_a_difference() -> None:
    later = replace(noisy(pulled(begin=3.0), 2), force=None)
    found = stick_slip(later)
    assert {name for name, _ in found.missing} == {"friction.mu_s", "friction.mu_k"}


def test_units_scale_the_numbers() -> None:
    """A force in other units scales mass, stiffness and forces by it, and no ratio."""
    record = noisy(pulled(), 3)
    assert record.force is not None
    one, other = stick_slip(record), stick_slip(replace(record, force=2.0 * record.force))
    for n in one.numbers:
        factor = 2.0 if "N" in n.unit or n.unit == "kg" else 1.0
        assert other.number(n.name).value == pytest.approx(factor * n.value, rel=1e-3)


def test_intervals_cover() -> None:
    """Of 30 noisy records 95 % of the intervals hold the truth; three deviations are 6 %."""
    hits = [hit for seed in range(30) for hit in covered(stick_slip(noisy(pulled(3.0), seed)))]
    # Numbers of one record hang together: about 100 independent ones.
    assert np.mean(hits) > 0.95 - 3.0 * math.sqrt(0.05 * 0.95 / 100)


def test_a_drifting_zero_leaves_the_difference_of_forces() -> None:
    record = noisy(pulled(begin=3.0), 4)
    assert record.force is not None
    drift = 0.3 * np.ptp(record.force) * np.linspace(0.0, 1.0, record.t.size)
    found = stick_slip(replace(record, force=record.force + drift))
    assert {"friction.F_s", "friction.F_k"} == {name for name, _ in found.missing}
    n = found.number("F_s - F_k")
    assert n.low <= TRUTH["F_s - F_k"] <= n.high


def test_friction_of_another_kind_is_said() -> None:
    """Friction that falls with the speed leaves a shape in each cycle."""
    own = {"shape": 1.0, "v_s": 2e-3, "delta": 1.0}
    found = stick_slip(noisy(pulled(begin=3.0, law="stribeck", own=own), 5, 1e-5, 3e-3))
    assert any("repeats from cycle to cycle" in fault for fault in found.faults)


def test_only_slips_are_stick_slip() -> None:
    t = np.arange(0.0, 2.0, 1e-3)
    even = Record(t=t, position=1e-3 * t + 1e-9 * np.sin(400.0 * t), command=1e-3 * t)
    with pytest.raises(ValueError, match="no two slips"):
        stick_slip(even)
    # Steady runs in both directions, without a command: the force turns at each end.
    v = np.repeat(1e-3 * np.array([1, -1, 4, -4, 1, -1, 4, -4, 1, -1]), 200)
    rubs = Record(t=t, position=np.cumsum(v * 1e-3), force=np.sign(v) * (300.0 - 100.0 * (t % 0.2)))
    with pytest.raises(ValueError, match="forth and back"):
        stick_slip(rubs)


def test_a_command_of_few_digits_is_one_speed() -> None:
    """A command of 12 bits steps, and tells the feed to a part of a step all the same."""
    record = noisy(pulled(), 6)
    assert record.command is not None
    unit = float(np.ptp(record.command)) / 4096
    found = stick_slip(replace(record, command=unit * np.round(record.command / unit)))
    assert found.number("axis.stiffness").value == pytest.approx(k, rel=2e-3)


def test_a_creep_between_slips_is_said() -> None:
    """A table that creeps by half the noise in each stick shifts the numbers: it is said."""
    record = noisy(pulled(begin=3.0), 7, 1e-4, 3e-3)
    assert record.position is not None
    plain = stick_slip(record)
    assert plain.explained
    ends = [end for _, end, _ in plain.segments]
    creep = np.interp(record.t, ends, np.resize([-0.5, 0.5], len(ends)))
    creeping = replace(record, position=record.position + 5e-8 * creep)
    assert any("creeps" in fault for fault in stick_slip(creeping).faults)


def test_several_feeds_tell_how_the_gap_goes() -> None:
    """Over four feeds of constant coefficients the gap is the same; all feeds share one spring."""
    t = np.arange(0.0, 9.0, 5e-4)
    changes = [Change(2.25 * n, {"v": feed}) for n, feed in enumerate((3e-4, 5e-4, 8e-4, 1.2e-3))]
    run = simulate(P, float(t[-1]), times=t, changes=changes)
    record = Record(t=t, position=run.x, force=run.F, command=run.x_pull)
    found = stick_slip(noisy(record, 8, 1e-5, 3e-3))
    assert found.explained
    assert "the gap is the same at all feeds" in found.notes
    assert found.number("gap").value == pytest.approx(GAP / k, rel=5e-3)


def test_the_loop_of_a_servo_is_in_the_fit() -> None:
    """A servo axis gives way while its table jumps; its own numbers come out, from other ones."""
    feed, step, rows = 5e-4, 1e-3, []
    simulation = Simulation(SERVO, feed)
    simulation.x = simulation.loaded(1.0)
    for number in range(800):
        rows.append([number * step, simulation.x[TABLE], simulation.x[FORCE]])
        simulation.advance(step, feed, feed)
    t, ahead, force = np.array(rows).T
    record = Record(t=t, position=ahead + feed * t, force=force, command=feed * t)
    guess = replace(SERVO, m=1.2 * SERVO.m, k=0.8 * SERVO.k)
    found = stick_slip(noisy(record, 6), guess)
    assert found.explained
    gap = (SERVO.F_s - SERVO.F_k) / SERVO.k
    truth = {
        "k/m": SERVO.k / SERVO.m, "c/m": SERVO.c / SERVO.m, "gap": gap,
        "axis.mass": SERVO.m, "axis.stiffness": SERVO.k, "axis.c": SERVO.c,
        "friction.F_s": SERVO.F_s, "friction.F_k": SERVO.F_k, "F_s - F_k": SERVO.F_s - SERVO.F_k,
    }  # fmt: skip
    assert sum(covered(found, truth)) >= len(truth) - 1


def test_what_is_known_before_leaves_another_number_as_uncertain_as_it_is() -> None:
    rng = np.random.default_rng(5)
    a, b, c = rng.normal(size=(3, 4000))
    # Two columns that differ by 1e-5, and one that changes the record by a millionth of the noise.
    columns = {"a": a, "like a": a + 1e-5 * b, "known": 1e-6 * c}
    y = a + columns["like a"] + rng.normal(size=4000)
    run, free = np.zeros(4000), {"a": math.inf, "like a": math.inf}
    alone = least_squares({name: columns[name] for name in free}, y, run)
    found = least_squares(columns, y, run, known=free | {"known": 0.1})
    assert found.number("a")[1] == pytest.approx(alone.number("a")[1], rel=1e-2)
    assert found.number("a")[1] == pytest.approx(1e5 / math.sqrt(4000.0), rel=5e-2)
