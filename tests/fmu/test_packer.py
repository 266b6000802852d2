"""The FMU file: complete, reproducible, described by the table."""

import random
import zipfile
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu

from stickslip_fmu import packer
from stickslip_fmu.block import Block
from stickslip_fmu.settings import Settings
from stickslip_fmu.variables import VARIABLES, start_values
from stickslip_ref import Parameters

from .blocks import outputs


def test_two_builds_are_the_same_bytes(fmu_path: Path, tmp_path: Path) -> None:
    """A second build gives the same file."""
    again = packer.build(tmp_path / "another name.fmu")
    assert again.read_bytes() == fmu_path.read_bytes()


def test_fmpy_finds_nothing_to_say(fmu_path: Path) -> None:
    """The description passes fmpy's schema and its further checks."""
    assert validate_fmu(str(fmu_path)) == []


def test_description_is_the_table(fmu_path: Path) -> None:
    """Every row of the table stands in the model description, and nothing else."""
    description = fmpy.read_model_description(str(fmu_path))
    assert [each.name for each in description.modelVariables] == [each.name for each in VARIABLES]
    for found, row in zip(description.modelVariables, VARIABLES, strict=True):
        assert (found.type, found.causality, found.variability) == (
            row.kind,
            row.causality,
            row.variability,
        )
        assert (found.unit or "") == row.unit
        assert found.description == row.description
        if row.start is not None:
            assert float(found.start) == row.start
        if row.minimum is not None:
            assert float(found.min) == row.minimum
    assert all(unknown.dependencies == [] for unknown in description.outputs)
    initial = {each.variable.name: each.dependencies for each in description.initialUnknowns}
    assert {each.name for each in initial["x_pull"]} == {"x_start", "z_start"}


def test_the_description_claims_what_importers_ask_for(fmu_path: Path) -> None:
    """No execution tool is needed, states can be kept, and the default experiment is there."""
    description = fmpy.read_model_description(str(fmu_path))
    slave = description.coSimulation
    assert slave.needsExecutionTool is False
    assert slave.canGetAndSetFMUstate
    assert slave.canSerializeFMUstate
    assert slave.canHandleVariableCommunicationStepSize
    experiment = description.defaultExperiment
    assert (experiment.startTime, experiment.stopTime, experiment.stepSize) == (
        "0.0",
        "10.0",
        "0.01",
    )
    assert description.generationDateAndTime.endswith("Z")


def test_units_are_those_of_physics(fmu_path: Path) -> None:
    """Base units have the exponents of SI, display units their factors."""
    description = fmpy.read_model_description(str(fmu_path))
    exponents = {
        unit.name: (unit.baseUnit.kg, unit.baseUnit.m, unit.baseUnit.s)
        for unit in description.unitDefinitions
    }
    assert exponents == {
        "kg": (1, 0, 0),
        "m": (0, 1, 0),
        "s": (0, 0, 1),
        "m/s": (0, 1, -1),
        "m/s2": (0, 1, -2),
        "N": (1, 1, -2),
        "N/m": (1, 0, -2),
        "N.s/m": (1, 0, -1),
        "J": (1, 2, -2),
        "Hz": (0, 0, -1),
        "1": (0, 0, 0),
    }
    displays = {
        display.name: float(display.factor)
        for unit in description.unitDefinitions
        for display in unit.displayUnits
    }
    assert displays == {
        "mm": 1e3,
        "ms": 1e3,
        "mm/s": 1e3,
        "kN": 1e-3,
        "N/mm": 1e-3,
        "mJ": 1e3,
    }
    shown = {each.name: each.displayUnit for each in description.modelVariables if each.displayUnit}
    assert shown["x"] == "mm"
    assert shown["v"] == "mm/s"


def test_initial_values_depend_on_what_the_description_says(fmu_path: Path) -> None:
    """Each start value moves those outputs at the start that name it, and no other."""
    description = fmpy.read_model_description(str(fmu_path))
    named = {
        each.variable.name: {dependency.name for dependency in each.dependencies}
        for each in description.initialUnknowns
    }
    generator = random.Random(5)
    seen: dict[str, set[str]] = {name: set() for name in named}
    shifts = {"load": 5.0, "x_start": 0.01, "x_dot_start": 0.1, "z_start": 0.01, "F_ext": 5.0}
    for _ in range(600):
        base = start_values()
        base |= {
            "z_start": generator.uniform(-0.01, 0.01),
            "x_dot_start": generator.choice([0.0, 0.0, 0.1, -0.1]),
            "F_ext": generator.uniform(-5.0, 5.0),
            "c": 1.0,
        }
        before = outputs(Block(Settings(base)))
        for name in base:
            shift = shifts.get(name, 0.0) * generator.uniform(-1.0, 1.0)
            other = {**base, name: base[name] * generator.uniform(0.2, 3.0) + shift}
            after = outputs(Block(Settings(other)))
            for output in named:
                if after[output] != before[output]:
                    seen[output].add(name)
    assert seen == named


def test_the_date_is_that_of_the_release_or_of_the_build(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """SOURCE_DATE_EPOCH dates the description; what is no number of seconds is refused."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    built = packer.build(tmp_path)
    description = fmpy.read_model_description(str(built))
    assert description.generationDateAndTime == "1970-01-02T00:00:00Z"
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "yesterday")
    with pytest.raises(ValueError, match="SOURCE_DATE_EPOCH = 'yesterday'"):
        packer.build(tmp_path)


def test_start_values_are_the_defaults_of_the_reference() -> None:
    """The FMU and the reference, which share no code, start from the same numbers."""
    reference = Parameters()
    for name, value in start_values().items():
        assert getattr(reference, name) == value


def test_a_build_works_beside_the_running_fmu(fmu_path: Path, tmp_path: Path) -> None:
    """A process that runs the FMU can build it again, and goes on running it."""
    before = fmpy.simulate_fmu(str(fmu_path), stop_time=1.0)
    packer.build(tmp_path)
    after = fmpy.simulate_fmu(str(fmu_path), stop_time=1.0)
    assert before.tolist() == after.tolist()


def test_parts_are_packed(tmp_path: Path) -> None:
    """Files handed to the packer travel under their path."""
    built = packer.build(tmp_path, {"documentation/index.html": b"<html></html>"})
    with zipfile.ZipFile(built) as archive:
        assert archive.read("documentation/index.html") == b"<html></html>"
        assert archive.testzip() is None


def test_a_failed_build_leaves_what_was_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A build that cannot be finished leaves the old file and no half-written one."""
    target = tmp_path / "StickSlip.fmu"
    target.write_bytes(b"old")

    def broken(self: zipfile.ZipFile, *arguments: object, **options: object) -> None:
        raise OSError("disk full")

    monkeypatch.setattr(zipfile.ZipFile, "writestr", broken)
    with pytest.raises(OSError, match="disk full"):
        packer.build(target)
    assert target.read_bytes() == b"old"
    assert [path.name for path in tmp_path.iterdir()] == ["StickSlip.fmu"]
