"""The native FMU at its limits: many transitions in a step, as many slips as an Integer holds."""

import zipfile
from pathlib import Path

import fmpy
import pytest

from fmukit.model import ModelError
from stickslip_fmu.block import Block
from stickslip_fmu.spec import SPEC, TABLE
from tests.fmu.inside.raw import Raw
from tests.native.core import ACCEPTED, Core, NativeBlock, compile_core
from tests.native.fuzz.damage import with_values
from tests.native.fuzz.player import opened
from tests.needs import needs

MOST_SLIPS = 2**31 - 1
LONG = 5e3

pytestmark = needs("cc")


@pytest.fixture
def raw(native_path: Path, tmp_path: Path) -> Raw:
    """Return the functions of the native FMU."""
    with zipfile.ZipFile(native_path) as archive:
        archive.extractall(tmp_path)
    return opened(tmp_path, fmpy.read_model_description(str(native_path)).guid)


def started(raw: Raw) -> object:
    """Return an instance that may step."""
    instance = raw.instance()
    assert raw.EnterInitializationMode(instance) == 0
    assert raw.ExitInitializationMode(instance) == 0
    return instance


def slips_after_the_most(raw: Raw) -> int:
    """Return the count of slips of a run that had counted to the largest Integer before."""
    instance = started(raw)
    assert raw.DoStep(instance, 0.0, 1.0, 0) == 0
    state = raw.save(instance)
    full = with_values(raw.pack(instance, state), {"n_slips": MOST_SLIPS})
    again = raw.unpack(instance, full)
    assert raw.SetFMUstate(instance, again) == 0
    assert raw.DoStep(instance, 1.0, 5.0, 0) == 0
    status, (count,) = raw.read(instance, "Integer", [TABLE.by_name["n_slips"].number])
    for each in (state, again):
        raw.forget(instance, each)
    raw.FreeInstance(instance)
    assert status == 0
    return int(count)


def beyond_the_numbers(raw: Raw) -> list[tuple[int, int]]:
    """Return the statuses of reading x and one more output, where that one is beyond the numbers.

    A pull of 1e300 m/s passes the largest number in a stick; one of 1e160 m/s has an infinite work,
    and an infinite energy of a changed stiffness.
    """
    found = []
    for settings, step, change, name in (
        ({"mu_s": 1e300, "k": 1e-10, "v": 1e300}, 1e9, 0.0, "x"),
        ({"mu_s": 1e200, "k": 1.0, "v": 1e160}, 1.0, 0.0, "W_pull"),
        ({"mu_s": 1e200, "k": 1.0, "v": 1e160}, 1.0, 2.0, "W_k"),
    ):
        numbers = {each: TABLE.by_name[each].number for each in (*settings, name, "x", "k")}
        instance = raw.instance()
        values = [settings[each] for each in settings]
        assert raw.write(instance, "Real", [numbers[each] for each in settings], values) == 0
        assert raw.EnterInitializationMode(instance) == 0
        assert raw.ExitInitializationMode(instance) == 0
        assert raw.DoStep(instance, 0.0, step, 0) == 0
        if change:
            assert raw.write(instance, "Real", [numbers["k"]], [change]) == 0
            assert raw.DoStep(instance, step, step, 0) == 0
        shown = [raw.read(instance, "Real", [numbers[each]])[0] for each in ("x", name)]
        found.append((shown[0], shown[1]))
        raw.FreeInstance(instance)
    return found


def refused_of_itself(core: Core) -> int:
    """Return why a block without FMI shows no output of a motion beyond the numbers."""
    values = {**TABLE.start_values(), "mu_s": 1e300, "k": 1e-10, "v": 1e300}
    block = NativeBlock(core, values)
    block.advance(0.0, 1e9)
    assert block.refused == ACCEPTED
    block.outputs()
    refusal: int = block.refused
    return refusal


def shown_after_a_long_step(raw: Raw) -> list[float]:
    """Return the Reals after one step with thousands of transitions."""
    instance = started(raw)
    assert raw.DoStep(instance, 0.0, LONG, 0) == 0
    reals = [row.number for row in TABLE.rows if row.kind == "Real" and not row.settable]
    status, values = raw.read(instance, "Real", reals)
    raw.FreeInstance(instance)
    assert status == 0
    return values


def test_the_count_of_slips_ends_at_the_largest_integer(raw: Raw) -> None:
    """After 2,147,483,647 slips the count stays, and does not turn negative."""
    assert slips_after_the_most(raw) == MOST_SLIPS


def test_an_output_beyond_the_numbers_is_refused(raw: Raw) -> None:
    """Motion beyond the largest number is refused; an energy beyond it only where it is read."""
    assert beyond_the_numbers(raw) == [(3, 3), (0, 3), (0, 3)]
    assert all("leave the range of double-precision numbers" in each for each in raw.messages)


def test_the_block_without_fmi_refuses_by_itself(tmp_path: Path) -> None:
    """Who reads a block that moved beyond the numbers gets the refusal, with no face about it."""
    assert refused_of_itself(Core(compile_core(tmp_path))) != ACCEPTED


def test_a_step_may_hold_thousands_of_transitions(raw: Raw) -> None:
    """One step of 5,000 s, 30,000 transitions, shows the bits of the Python block."""
    block = SPEC.model(SPEC.values(TABLE.start_values()), 0.0)
    assert isinstance(block, Block)
    block.advance(0.0, LONG)
    block.refresh()
    assert block.meter.n_slips > 10_000
    expected = []
    for row in TABLE.rows:
        if row.kind == "Real" and not row.settable:
            value: object = block
            for name in row.attribute.split("."):
                value = getattr(value, name)
            expected.append(value)
    assert shown_after_a_long_step(raw) == expected


def test_a_step_that_would_take_minutes_is_refused(raw: Raw) -> None:
    """A step of 1e17 s is refused after its first transitions, by both blocks."""
    instance = started(raw)
    assert raw.DoStep(instance, 0.0, 1e17, 0) == 3
    assert "holds more than 16777216 transitions" in raw.messages[-1]
    raw.FreeInstance(instance)
    with pytest.raises(ModelError, match="holds more than 16777216 transitions"):
        SPEC.model(SPEC.values(TABLE.start_values()), 0.0).advance(0.0, 1e17)
