"""A file is there whole, or as it was before."""

import os
from pathlib import Path

import pytest

from stickslip_verification import replacing


def test_an_interrupted_write_leaves_the_old_file(tmp_path: Path) -> None:
    """Where the block fails the file is as it was, and nothing else is left beside it."""
    file = tmp_path / "report.json"
    file.write_bytes(b"old")

    def interrupted() -> None:
        with replacing(file) as stream:
            stream.write(b"half of the n")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert file.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [file]


def test_a_replaced_file_has_the_permissions_of_a_new_one(tmp_path: Path) -> None:
    """Who may read it is what the process's mask says, whatever temporary files are."""
    file = tmp_path / "report.json"
    before = os.umask(0o027)
    try:
        with replacing(file) as stream:
            stream.write(b"new")
        assert os.umask(0o027) == 0o027
    finally:
        os.umask(before)
    assert file.read_bytes() == b"new"
    assert file.stat().st_mode & 0o777 == 0o640
