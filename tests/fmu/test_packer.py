"""The FMU file: complete, reproducible, described by the table."""

import zipfile
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu

from stickslip_fmu import packer
from stickslip_fmu.variables import VARIABLES, start_values
from stickslip_ref import Parameters


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


def test_documentation_is_packed(tmp_path: Path) -> None:
    """Files handed to the packer stand in documentation/."""
    built = packer.build(tmp_path, {"index.html": b"<html></html>"})
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
