"""The FMU file: complete, reproducible, described by the table."""

import zipfile
from pathlib import Path

import fmpy
import pytest

from stickslip_fmu import packer
from tests.conftest import built


def test_two_builds_are_the_same_bytes(tmp_path: Path) -> None:
    again = packer.build(tmp_path)
    assert again.read_bytes() == built("python-2").read_bytes()
    assert again.name == "StickSlip.fmu"


def test_the_date_is_that_of_the_release_or_of_source_date_epoch(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    description = fmpy.read_model_description(str(packer.build(tmp_path)))
    assert description.generationDateAndTime == "1970-01-02T00:00:00Z"
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "yesterday")
    with pytest.raises(ValueError, match="SOURCE_DATE_EPOCH = 'yesterday'"):
        packer.build(tmp_path)


def test_a_process_that_runs_the_fmu_can_build_it_again(fmu_path: Path, tmp_path: Path) -> None:
    before = fmpy.simulate_fmu(str(fmu_path), stop_time=1.0)
    packer.build(tmp_path)
    after = fmpy.simulate_fmu(str(fmu_path), stop_time=1.0)
    assert before.tolist() == after.tolist()


def test_a_failed_build_leaves_the_old_file_and_no_half_written_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "StickSlip.fmu"
    target.write_bytes(b"old")

    def broken(self: zipfile.ZipFile, *arguments: object, **options: object) -> None:
        raise OSError("disk full")

    monkeypatch.setattr(zipfile.ZipFile, "writestr", broken)
    with pytest.raises(OSError, match="disk full"):
        packer.build(target)
    assert target.read_bytes() == b"old"
    assert [path.name for path in tmp_path.iterdir()] == ["StickSlip.fmu"]
