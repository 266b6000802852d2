"""The FMU file: complete, reproducible, described by the table."""

import zipfile
from dataclasses import fields
from pathlib import Path

import fmpy
import pytest

from fmukit.packer import write_archive
from stickslip_fmu import packer
from stickslip_fmu.spec import TABLE
from stickslip_ref import COULOMB, Parameters


def test_two_builds_are_the_same_bytes(fmu_path: Path, tmp_path: Path) -> None:
    """A second build gives the same file."""
    again = packer.build(tmp_path / "another name.fmu")
    assert again.read_bytes() == fmu_path.read_bytes()


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
    own = {name: parameter.start for name, parameter in COULOMB.parameters.items()}
    shared = {each.name: each.default for each in fields(Parameters) if each.init}
    assert {**shared, **own} == TABLE.start_values()


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


def test_an_archive_that_cannot_take_its_place_leaves_nothing(tmp_path: Path) -> None:
    """What is written beside the target is gone when the target turns out to be a folder."""
    target = tmp_path / "StickSlip.fmu"
    target.mkdir()
    with pytest.raises(IsADirectoryError):
        write_archive({"modelDescription.xml": b"<fmiModelDescription/>"}, target)
    assert [path.name for path in tmp_path.iterdir()] == ["StickSlip.fmu"]
