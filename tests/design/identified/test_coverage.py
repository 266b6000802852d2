"""The intervals of identified numbers: how often they contain the truth, how wide they are."""

import json
import math
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import binom

from stickslip_design.identify.model import Kind
from stickslip_design.identify.study import identify
from stickslip_design.one_thread import one_thread
from tests.conftest import Sized
from tests.design.identified.loops import loops
from tests.design.identified.records import KINDS, cases, drawn
from tests.design.simulated import Simulation
from tests.needs import needs
from tests.sharing import made_once

pytestmark = pytest.mark.gate

CELLS = list(product(KINDS, range(3), (False, True)))
Told = list[tuple[str, bool, float]]
"""A number's name, whether its interval contains the truth, its half over that of the bound."""


def count(sized: Sized) -> int:
    """Return how many records of a cell are judged."""
    return 400 if sized(1) else 11


@one_thread
def told_of(cell: tuple[Kind, int, bool], count: int) -> list[tuple[str, Told]]:
    """Return the kind that each record of a cell is taken for, and what is told of it."""

    def make(folder: Path) -> None:
        told: list[tuple[str, Told]] = []
        for case in cases(*cell, count):
            try:
                result, numbers = identify(case.record, case.stated), []
            except ValueError:
                told.append(("refused", []))
                continue
            bounds = case.bounds() if case.white else {}
            for number in (each for each in result.numbers if each.name in case.truth):
                half, least = 0.5 * (number.high - number.low), bounds.get(number.name, math.nan)
                inside = number.low <= case.truth[number.name] <= number.high
                numbers.append((number.name, bool(inside), half / (1.96 * least)))
            told.append((str(result.kind), numbers))
        (folder / "told.json").write_text(json.dumps(told), encoding="utf-8")

    made = made_once(f"identified-{CELLS.index(cell)}-{count}", make)
    return [tuple(each) for each in json.loads((made / "told.json").read_text(encoding="utf-8"))]


@cache
def share(cell: tuple[Kind, int, bool], count: int) -> tuple[float, ...]:
    """Return the covered part of the numbers of each record: those of one record go together."""
    numbers = [told for _, told in told_of(cell, count) if told]
    return tuple(float(np.mean([inside for _, inside, _ in told])) for told in numbers)


@needs("cc")
@pytest.mark.parametrize("number", [0, 2, 6])
def test_the_servos_of_the_records_move_as_in_a_simulation_without_events(number: int) -> None:
    axis = drawn(np.random.default_rng([39, number]), "stick-slip", servo=True)
    assert axis.drive
    T_s = axis.drive.T_s
    feed = 40.0 * (axis.F_s - axis.F_k) / axis.k / (16_000 * T_s)
    v = feed * np.minimum(np.arange(16_000) * T_s / 0.05, 1.0)
    x, simulation, seen = np.cumsum(v) * T_s, Simulation(axis, feed, 1e-6), []
    _, table, speed, _ = loops([axis], np.array([axis.c]), x[None], v[None])
    for n in range(len(v) - 1):
        seen.append(simulation.x[2] + x[n])
        simulation.advance(T_s, v[n], v[n + 1])
    assert np.count_nonzero(np.diff(np.sign(speed[0])) > 0) > 2
    # The simulation's break-away is late as if the gap were 0.1 % larger.
    assert np.abs(table[0, :-1] - seen).max() < 3e-3 * np.ptp(table)


@pytest.mark.parametrize("cell", CELLS, ids=str)
def test_stick_slip_is_seen_where_it_is_and_each_record_tells_numbers(
    cell: tuple[Kind, int, bool], sized: Sized
) -> None:
    # Steady runs with hard ramps are an excitation as well. Where the motor's position alone is
    # measured, under noise, jumps may not be seen.
    found = told_of(cell, count(sized))
    seen = sum(kind == "stick-slip" for kind, _ in found)
    least = 0.8 if cell[2] else 1.0
    assert seen >= least * len(found) if cell[0] == "stick-slip" else seen == 0
    assert all(told for kind, told in found if kind != "refused")
    assert cell[0] == "stick-slip" or all(told for _, told in found)


def test_the_intervals_contain_the_truth_as_often_as_they_say(sized: Sized) -> None:
    shares = {cell: share(cell, count(sized)) for cell in CELLS}
    pooled = [each for cell in CELLS for each in shares[cell]]
    # Beside 95 +- 2 % what this many records differ from their mean by chance, in 1 % of all runs.
    chance = 2.58 * math.sqrt(0.95 * 0.05 / len(pooled)) * (len(pooled) < 1000)
    assert 0.93 - chance <= np.mean(pooled) <= 0.97 + chance
    margins = [(n, value) for n in range(3) for value in sorted({cell[n] for cell in CELLS})]
    for n, value in margins:
        some = [each for cell in CELLS if cell[n] == value for each in shares[cell]]
        by_chance = binom.cdf(round(float(np.sum(some))), len(some), 0.92)
        assert by_chance > 0.01 / len(margins), (value, np.mean(some))


@pytest.mark.parametrize(
    ("kind", "servo"), [*((kind, False) for kind in KINDS), ("stick-slip", True)]
)
def test_intervals_are_hardly_wider_than_the_least_that_white_noise_allows(
    kind: Kind, servo: bool, sized: Sized
) -> None:
    # Of a servo's other records the bound takes the motion of both sides of the spring as known:
    # one is measured.
    ratios: dict[str, list[float]] = {}
    for level in range(3):
        for _, numbers in told_of((kind, level, servo), count(sized)):
            for name, _, ratio in numbers:
                ratios.setdefault(name, []).extend([ratio] * math.isfinite(ratio))
    assert ratios
    for name, found in ratios.items():
        assert len(found) < 8 or np.median(found) <= 1.3, name
