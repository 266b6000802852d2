"""Instances of any FMU: the same numbers in SI behind any face, and calls that fail."""

import re
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from stickslip_verification import FmuError, truth
from stickslip_verification.drive import CommunicationStep, FmuFile, Setting, run
from stickslip_verification.drive.instance import FmuInstance
from tests.makers import RENAMED, SLIDER, SLIDER_3, Foreign, altered, edited, in_c, misbehaving
from tests.needs import needs
from tests.python import python

ULP = 2.0**-52
STEPS = (0.01,) * 120 + (0.003, 0.2, 1e-9, 0.7, 0.07) * 8


def follow(instance: FmuInstance, begin: float, steps: Sequence[float]) -> list[list[float]]:
    read = instance.reader(["x", "x_dot", "z", "T", "n_slips"])
    rows = []
    for h in steps:
        instance.step(begin, h)
        begin += h
        rows.append(read())
    return rows


@pytest.mark.parametrize("fmu", [SLIDER, SLIDER_3, RENAMED], ids=lambda fmu: fmu.name)
@pytest.mark.parametrize("values", [{}, {"v": -0.3, "m": 4.0, "k": 12500.0, "mu_k": 0.2}])
def test_behind_any_names_units_signs_and_version_is_the_exact_motion(
    fmu: Foreign, values: dict[str, float]
) -> None:
    given = {**truth.START_VALUES, **values}
    file = fmu.opened()
    setting = Setting(
        {n: v for n, v in given.items() if file.has(n)}, [CommunicationStep(h, {}) for h in STEPS]
    )
    got = run(file, setting).outputs
    exact = truth.run(values, [truth.Step(h) for h in STEPS]).samples
    assert got["n_slips"][-1] > 2
    for name in ("x", "x_dot", "x_pull", "z", "F", "F_s", "mode", "n_slips", "spring_drop"):
        expected = np.array([float(sample[name]) for sample in exact])
        # Parameters that are off by a rounding move the motion by as much in each of 60 cycles.
        allowed = 4 * 60 * ULP * np.max(np.abs(expected))
        assert np.max(np.abs(got[name] - expected)) <= allowed, name


def test_values_come_back_in_si_and_those_of_si_untouched(fmu_path: Path) -> None:
    whole = {"m": 3.0, "g": 1.62, "k": 700.0, "mu_s": 0.25, "v": 0.125}
    # Of an FMU in SI the numbers are handed over bit for bit, whatever they are.
    odd = {"k": 1e3 / 3.0, "v": 0.1 + 0.2, "mu_s": 1.0 / 7.0}
    for file, given in ((SLIDER.opened(), whole), (FmuFile(fmu_path), odd)):
        with file.instantiate() as instance:
            instance.start(given)
            assert instance.reader(list(given))() == list(given.values())


def test_a_datum_moves_the_position(tmp_path: Path) -> None:
    datum = edited(('m="1" factor="0.001"', r'\g<0> offset="0.5"'))
    moved = FmuFile(altered(SLIDER.path, tmp_path / "datum.fmu", datum), SLIDER.names)
    setting = Setting({}, [CommunicationStep(h, {}) for h in STEPS[:40]])
    there, plain = (run(file, setting).outputs for file in (moved, SLIDER.opened()))
    for name, by in (("x", 0.5), ("z", -0.5), ("F", 0.0)):
        assert np.array_equal(there[name], plain[name] + by), name


def test_a_reset_instance_is_a_new_one() -> None:
    for file in (SLIDER.opened(), SLIDER_3.opened()):
        rows = []
        with file.instantiate() as instance:
            for values in ({}, {"v": 0.5, "k": 5e3}, {}):
                instance.start(values)
                rows.append(follow(instance, 0.0, STEPS[:60]))
                instance.reset()
        assert rows[0] == rows[2] != rows[1]


@pytest.mark.parametrize("fmu", [SLIDER_3, None], ids=["FMI 3.0", "FMI 2.0"])
def test_a_state_brings_back_the_motion_here_and_in_another_instance(
    fmu: Foreign | None, fmu_path: Path
) -> None:
    file = fmu.opened() if fmu else FmuFile(fmu_path)
    with file.instantiate() as one, file.instantiate() as other:
        one.start({"v": 0.05})
        follow(one, 0.0, [0.1] * 30)
        state = one.get_state()
        first = follow(one, 3.0, [0.1] * 30)
        for _ in range(2):
            one.set_state(state)
            assert follow(one, 3.0, [0.1] * 30) == first
        other.start({})
        other.restore(one.written(state))
        assert follow(other, 3.0, [0.1] * 30) == first


def three_steps(instance: FmuInstance) -> None:
    for begin, end in pairwise((0.0, 0.1, 0.2, 0.3)):
        instance.step(begin, end - begin)


ENDS = r"fmi3DoStep\(t = 0\.2, h = 0\.\d+\) ends the simulation at t = 0\.3"
DISCARDED = r"fmi2DoStep\(t = 0\.2, .*\) failed: without a message \(status discarded\)"
RAISED = r"fmi2DoStep\(t = 0\.2, .*\) failed: .*the slider has had enough.* \(status fatal\)"
REFUSALS = [
    (SLIDER, lambda i: i.set({"mode": 0.5}), "mode = 0.5 is no value of type Integer"),
    (SLIDER, lambda i: i.set({"load": 1.0, "v": 0.1, "c": 2.0}), "has no variable load, c"),
    (SLIDER_3, lambda i: i.reader(["x", "Q_friction"]), "has no variable Q_friction"),
    (misbehaving("terminate", fmi=3), three_steps, ENDS),
    (misbehaving("discard"), three_steps, DISCARDED),
    (misbehaving("raise"), three_steps, RAISED),
]


@pytest.mark.parametrize(("fmu", "call", "words"), REFUSALS)
def test_a_call_that_fails_or_is_not_offered_is_told_on_one_line(
    fmu: Foreign, call: Callable[[FmuInstance], object], words: str
) -> None:
    with fmu.opened().instantiate() as instance:
        instance.start({})
        with pytest.raises(FmuError) as caught:
            call(instance)
    assert re.fullmatch(rf"{fmu.name}\.fmu: {words}", str(caught.value))


NUMBERS = {
    "x": 0.25, "k": 0.1, "mode": -1.0, "mu_k": 250.0, "mu_s": -300.0, "g": 60000.0, "F": -1e9,
    "n_slips": 4e9, "v": -(2.0**40), "m": 2.0**63, "sticking": 1.0, "load": 1.0,
}  # fmt: skip
"""A value for each variable that the next smaller type could not hold."""


@needs("cc")
def test_a_number_of_any_type_of_fmi_3_is_taken_and_given_back(tmp_path: Path) -> None:
    file = FmuFile(in_c(tmp_path / "Numbers.fmu"))
    sizes = [f"{kind}{size}" for kind in ("Int", "UInt") for size in (8, 16, 32, 64)]
    kinds = {*sizes, "Float32", "Float64", "Boolean", "Enumeration"}
    assert {variable.kind for variable in file.variables.values()} == kinds
    with file.instantiate() as instance:
        instance.start(NUMBERS)
        read = instance.reader(list(NUMBERS))
        assert dict(zip(NUMBERS, read(), strict=True)) == NUMBERS
        refused = ("mu_k", "mu_k", "sticking", "v", "v", "v")
        for name, value in zip(refused, (300.0, -1.0, 2.0, np.nan, np.inf, 0.5), strict=True):
            with pytest.raises(FmuError, match=rf": {name} = .* is no value of type \w+$"):
                instance.set({name: value})
        # A step that met an event is done; one that stopped before its end is not.
        instance.step(0.0, 0.5)
        with pytest.raises(FmuError, match=r"h = 2\.0\) returns early at t = 1\.0$"):
            instance.step(0.0, 2.0)
        instance.step(0.0, 0.5)


DRIVE = """
import sys
from pathlib import Path
from stickslip_verification import load_names
from stickslip_verification.drive import FmuFile

for path, names in zip(sys.argv[1::2], sys.argv[2::2]):
    fmu = FmuFile(Path(path), load_names(Path(names)) if names else None)
    kept = [fmu.instantiate() for _ in range(2)]
    for instance in kept:
        instance.start({})
        for n in range(3):
            instance.step(n * 0.1, 0.1)
    kept[0].free()
print("done")
"""


def test_a_process_ends_well_after_any_fmus_with_an_instance_left(fmu_path: Path) -> None:
    si, mm = ((fmu.path, fmu.names_file) for fmu in (SLIDER_3, SLIDER))
    ours = (fmu_path, "")
    for order in ((si, mm, ours), (ours, mm, si)):
        arguments = [str(each) for pair in order for each in pair]
        process = python("-c", DRIVE, *arguments)
        assert (process.stdout, process.stderr) == ("done\n", "")
