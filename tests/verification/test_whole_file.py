"""A file is there whole, or as it was before."""

import errno
import os
import sys
from pathlib import Path

import pytest

from stickslip_verification import replacing
from stickslip_verification.model.data_file import write_all
from tests.python import python


def test_an_interrupted_write_leaves_the_old_file_and_nothing_beside_it(tmp_path: Path) -> None:
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


def test_a_file_that_cannot_take_its_place_is_named_and_no_part_is_left(tmp_path: Path) -> None:
    first, second = tmp_path / "first", tmp_path / "folder"
    first.write_bytes(b"old")
    second.mkdir()
    with pytest.raises(IsADirectoryError) as caught:
        write_all({second: b"new", first: b"new"})
    assert caught.value.filename == str(second)
    assert sorted(tmp_path.iterdir()) == [first, second]


FILLING = """\
import resource, signal, sys
from pathlib import Path
from stickslip_verification.model.data_file import write_all

signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))
folder = Path(sys.argv[1])
try:
    write_all({folder / "a": b"a" * 90_000, folder / "b": b"b" * 110_000, folder / "c": b"c"})
except OSError as error:
    print(Path(error.filename).name, error.strerror)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="files have no largest size there")
def test_of_files_that_do_not_fit_none_is_left(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"old")
    assert python("-c", FILLING, tmp_path).stdout == f"b {os.strerror(errno.EFBIG)}\n"
    assert list(tmp_path.iterdir()) == [tmp_path / "a"]
    assert (tmp_path / "a").read_bytes() == b"old"
