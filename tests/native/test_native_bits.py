"""The native block and the Python block are the same arithmetic."""

import math
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stickslip_native import batch, library
from stickslip_native.batch import FirstSlips, Numbers, first_slips
from stickslip_native.compiler import CompilerError
from stickslip_native.named import native_law
from tests.conftest import Sized
from tests.native.bits import bits, comparisons
from tests.native.core import Core, compile_core
from tests.needs import needs

SEQUENCES = {"coulomb": 10_000, "stribeck": 3_000}
"""Number of random sequences at full size."""
RUNS = 100

needs_cc = needs("cc")
each_law = pytest.mark.parametrize("law", ["coulomb", "stribeck"])


@needs_cc
@each_law
def test_all_outputs_are_equal_to_the_bit_after_every_step(
    law: str, tmp_path: Path, sized: Sized
) -> None:
    core, compared, refused = Core(compile_core(tmp_path, law), law), 0, 0
    count = sized(SEQUENCES[law])
    for name, pairs in comparisons(core, law, count):
        for number, (expected, given) in enumerate(pairs):
            assert bits(expected) == bits(given), (name, number, expected, given)
            compared += expected is not None
            refused += expected is None
    assert compared > 8 * count
    assert 0.02 * count < refused < 0.4 * count


def runs(law: str) -> dict[str, list[float]]:
    chance = random.Random(2)

    def of_a_run() -> dict[str, float]:
        values = {
            "m": chance.uniform(0.1, 10.0),
            "k": math.exp(chance.uniform(2.0, 12.0)),
            "v": chance.choice((-1.0, 1.0)) * math.exp(chance.uniform(-9.0, -2.0)),
            "mu_s": chance.uniform(0.3, 0.6),
            "mu_k": chance.uniform(0.1, 0.3),
        }
        if law == "stribeck":
            values |= {
                "shape": chance.choice((1, 2, 3)),
                "v_s": math.exp(chance.uniform(-8.0, 0.0)),
                "delta": chance.choice((1.0, 2.0, 3.0, chance.uniform(1.0, 3.0))),
                "n_points": chance.choice((2, 3, 12)),
                "mu_1": values["mu_s"] * chance.choice((1.0, 0.9)),
            }
        return values

    drawn = [of_a_run() for _ in range(RUNS)]
    return {name: [each[name] for each in drawn] for name in drawn[0]}


@needs_cc
@each_law
def test_a_first_slip_of_a_batch_is_that_of_the_python_block_to_the_bit(law: str) -> None:
    settings = runs(law)
    found = zip(*first_slips(settings, law), strict=True)
    spec = native_law(law).spec
    for number, given in enumerate(found):
        values = {name: each[number] for name, each in settings.items()}
        block: Any = spec.model(spec.values({**spec.table.start_values(), **values}))
        t_stick, t_slip = given[:2]
        if t_slip == math.inf:
            block.advance(0.0, t_stick + 10.0)
            assert (block.meter.t_stick, block.meter.n_slips) == (t_stick, 0)
        else:
            block.advance(0.0, (t_stick + t_slip) * (1.0 + 1e-9))
            assert block.meter.n_slips == 1
            assert list(given) == [getattr(block.meter, name) for name in FirstSlips._fields]


@needs_cc
def test_what_lasts_for_ever_is_infinite() -> None:
    at_rest, sliding = first_slips({"v": 0.0}), first_slips({"c": 3.0, "mu_k": 0.5})
    assert (at_rest.t_stick[0], sliding.t_slip[0]) == (math.inf, math.inf)
    assert math.isnan(at_rest.t_slip[0])
    assert math.isnan(sliding.delta_x[0])


@needs_cc
def test_a_swing_that_grows_from_a_start_in_motion_turns_more_than_once_before_it_stops() -> None:
    fall = {"v_s": 0.1, "mu_s": 0.5, "mu_k": 0.3, "shape": 1.0, "delta": 1.0}
    start = {"x_dot_start": 0.055, "z_start": (0.3 + 0.2 * math.exp(-0.5)) * 9.81 / 1000.0}
    found = first_slips({"v": [0.05], "c": 0.0, **fall, **start}, "stribeck")
    assert 2.0 < found.t_slip[0] / (2.0 * math.pi / math.sqrt(1000.0)) < 3.0


@needs_cc
def test_a_number_is_for_all_runs_of_a_batch_and_an_array_has_one_for_each() -> None:
    found = first_slips({"m": np.array([1.0, 2.0]), "v": [0.02, 0.03], "k": 1000, "c": 1.0})
    single = first_slips({"m": 2.0, "v": 0.03, "c": 1.0})
    assert [each[1] for each in found] == [each[0] for each in single]
    assert [len(each) for each in first_slips({"m": []})] == [0] * 5


@needs_cc
@pytest.mark.parametrize(
    ("values", "law", "words"),
    [
        ({"x": 0.1}, "coulomb", "'x' is no parameter or input of the block"),
        ({"shape": 2}, "coulomb", "'shape' is no parameter or input of the block"),
        ({"m": [1.0, 2.0], "k": [1.0]}, "coulomb", "differ in length: m has 2, k has 1"),
        ({"c": [1.0, math.nan, 0.0]}, "coulomb", "run 1: c = nan N.s/m is out of range"),
        ({"load": [0.0, 0.0, -20.0]}, "coulomb", "run 2: load = -20.0 N is out of range"),
        ({"shape": [1.0, 1.5]}, "stribeck", "run 1: shape = 1.5 is no whole number"),
        ({"shape": 3, "mu_1": [0.4, 0.6]}, "stribeck", "run 1: mu_1 = 0.6 is out of range: .* 0.5"),
        ({}, "viscous", "viscous"),
    ],
)  # fmt: skip
def test_a_wrong_value_of_a_batch_is_refused_with_its_run(
    values: dict[str, float | Numbers], law: str, words: str
) -> None:
    with pytest.raises(ValueError, match=words):
        first_slips(values, law)


def test_without_a_compiler_the_batch_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def none(this_machine: bool) -> None:
        raise CompilerError("there is none")

    monkeypatch.setattr(library, "compiler_for", none)
    # What was compiled is kept.
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    clear: Callable[[], None] = batch._function.cache_clear
    clear()
    with pytest.raises(CompilerError, match=r"install gcc or clang .* pip install"):
        first_slips({})
