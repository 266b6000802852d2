"""The first slips of many runs by the native core, called from Python."""

import math
import random

import numpy as np
import pytest

from stickslip_native import batch
from stickslip_native.batch import Numbers, first_slips
from stickslip_native.compiler import CompilerError
from stickslip_native.named import native_law
from tests.needs import needs

COUNT = 200


def _runs(seed: int) -> dict[str, list[float]]:
    """Return random settings whose first slip ends."""
    random_ = random.Random(seed)
    drawn = [
        {
            "m": random_.uniform(0.1, 10.0),
            "k": math.exp(random_.uniform(2.0, 12.0)),
            "v": random_.choice((-1.0, 1.0)) * math.exp(random_.uniform(-9.0, -2.0)),
            "mu_s": random_.uniform(0.3, 0.6),
            "mu_k": random_.uniform(0.1, 0.3),
        }
        for _ in range(COUNT)
    ]
    return {name: [each[name] for each in drawn] for name in drawn[0]}


@needs("cc")
def test_the_slip_is_that_of_the_closed_form() -> None:
    """Duration and jump of an undamped slip agree with docs/theory.md (8) to rounding."""
    runs = _runs(1)
    found = [np.array(each) for each in first_slips(runs)]
    t_stick, t_slip, delta_x, spring_drop, _ = found
    m, k, v, mu_s, mu_k = (np.array(runs[name]) for name in ("m", "k", "v", "mu_s", "mu_k"))
    relief = 2.0 * (mu_s - mu_k) * m * 9.81 / k
    w = np.sqrt(k / m)
    exact = 2.0 / w * (np.pi - np.arctan(0.5 * w * relief / np.abs(v)))
    # A few roundings of numbers that do not cancel.
    rounding = 2e-15
    np.testing.assert_allclose(t_stick, mu_s * m * 9.81 / (k * np.abs(v)), rtol=rounding)
    np.testing.assert_allclose(t_slip, exact, rtol=rounding)
    np.testing.assert_allclose(spring_drop, np.sign(v) * relief, rtol=rounding)
    np.testing.assert_allclose(delta_x, np.sign(v) * relief + v * exact, rtol=rounding)


def _stribeck(seed: int) -> dict[str, list[float]]:
    """Return random settings of friction that depends on the speed."""
    random_ = random.Random(seed)
    runs = _runs(seed)
    own = [
        {
            "shape": random_.choice((1, 2, 3)),
            "v_s": math.exp(random_.uniform(-8.0, 0.0)),
            "delta": random_.choice((1.0, 2.0, 3.0, random_.uniform(1.0, 3.0))),
            "n_points": random_.choice((2, 3, 12)),
            "mu_1": mu_s * random_.choice((1.0, 0.9)),
        }
        for mu_s in runs["mu_s"]
    ]
    return runs | {name: [each[name] for each in own] for name in own[0]}


@needs("cc")
@pytest.mark.parametrize("law", ["coulomb", "stribeck"])
def test_the_slip_is_that_of_the_python_block_to_the_bit(law: str) -> None:
    """A run gives what the meter of the Python block shows after its first slip."""
    runs = _runs(2) if law == "coulomb" else _stribeck(2)
    found = first_slips(runs, law)
    spec = native_law(law).spec
    for number in range(COUNT):
        values = {name: each[number] for name, each in runs.items()}
        given = [each[number] for each in found]
        block = spec.model(spec.values({**spec.table.start_values(), **values}))
        meter = block.meter  # type: ignore[attr-defined]
        if given[1] == math.inf:
            block.advance(0.0, given[0] + 10.0)
            assert (meter.t_stick, meter.n_slips) == (given[0], 0)
            continue
        block.advance(0.0, (given[0] + given[1]) * (1.0 + 1e-9))
        assert meter.n_slips == 1
        assert given == [getattr(meter, name) for name in batch.FirstSlips._fields]


@needs("cc")
def test_what_lasts_for_ever_is_infinite() -> None:
    """A mass that is not pulled sticks for ever; one without gap and with damping slips so."""
    at_rest, sliding = first_slips({"v": 0.0}), first_slips({"c": 3.0, "mu_k": 0.5})
    assert (at_rest.t_stick[0], sliding.t_slip[0]) == (math.inf, math.inf)
    assert math.isnan(at_rest.t_slip[0])
    assert math.isnan(sliding.delta_x[0])


@needs("cc")
def test_a_swing_that_grows_from_a_start_in_motion_stops() -> None:
    """It turns more than once before; from rest such a slip would have no end."""
    fall = {"v_s": 0.1, "mu_s": 0.5, "mu_k": 0.3, "shape": 1.0, "delta": 1.0}
    start = {"x_dot_start": 0.055, "z_start": (0.3 + 0.2 * math.exp(-0.5)) * 9.81 / 1000.0}
    found = first_slips({"v": [0.05], "c": 0.0, **fall, **start}, "stribeck")
    assert 2.0 < found.t_slip[0] / (2.0 * math.pi / math.sqrt(1000.0)) < 3.0


@needs("cc")
def test_a_number_is_for_all_runs_and_an_array_has_one_for_each() -> None:
    """Lists, arrays of numpy and numbers may stand side by side; without a run nothing is given."""
    found = first_slips({"m": np.array([1.0, 2.0]), "v": [0.02, 0.03], "k": 1000, "c": 1.0})
    single = first_slips({"m": 2.0, "v": 0.03, "c": 1.0})
    assert [each[1] for each in found] == [each[0] for each in single]
    assert [len(each) for each in first_slips({"m": []})] == [0] * 5


@needs("cc")
@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ({"mu": 0.1}, "'mu' is no parameter or input of the block"),
        ({"x": 0.1}, "'x' is no parameter or input of the block"),
        ({"m": [1.0, 2.0], "k": [1.0]}, "the lists differ in length: m has 2, k has 1"),
        ({"shape": 2}, "'shape' is no parameter or input of the block"),
        ({"k": [1.0, 0.0]}, "run 1: k = 0.0 N/m is out of range: it must be finite and above 0"),
        ({"c": [1.0, math.nan, 0.0]}, "run 1: c = nan N.s/m is out of range"),
        ({"load": [0.0, 0.0, -20.0]}, "run 2: load = -20.0 N is out of range"),
    ],
)  # fmt: skip
def test_a_value_out_of_range_is_refused_with_its_run(
    values: dict[str, float | Numbers], reason: str
) -> None:
    """The message names the run, the variable, its value and its range."""
    with pytest.raises(ValueError, match=f"^{reason}"):
        first_slips(values)


@needs("cc")
@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ({"shape": [1, 4]}, "run 1: shape = 4.0 is out of range"),
        ({"shape": [1.0, 1.5]}, "run 1: shape = 1.5 is no whole number"),
        ({"shape": 3, "mu_1": [0.4, 0.6]}, "run 1: mu_1 = 0.6 is out of range: .* mu_s = 0.5"),
    ],
)
def test_what_a_law_refuses_is_told_with_its_run(
    values: dict[str, float | Numbers], reason: str
) -> None:
    """Whole numbers are whole, and what the law finds out of range together is told."""
    with pytest.raises(ValueError, match=f"^{reason}"):
        first_slips(values, "stribeck")


def test_without_a_compiler_the_remedy_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither cc nor Zig: the error says what to install."""

    def none(this_machine: bool) -> None:
        raise CompilerError("there is none")

    monkeypatch.setattr(batch, "compiler_for", none)
    batch._function.cache_clear()
    with pytest.raises(CompilerError, match=r"install gcc or clang .* pip install"):
        first_slips({})


def test_an_unknown_law_is_told() -> None:
    """The friction law has to have a native side."""
    with pytest.raises(ValueError, match="viscous"):
        first_slips({}, "viscous")
