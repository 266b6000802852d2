"""Where output goes: files whole or not at all, links and pipes as what they are."""

import os
import threading
from pathlib import Path

import pytest

from stickslip.errors import CommandError
from stickslip.files import check_writable, write


@pytest.mark.parametrize("is_there", [True, False])
def test_a_link_stays_a_link_also_to_a_file_that_is_made(tmp_path: Path, is_there: bool) -> None:
    folder = tmp_path / "far"
    folder.mkdir()
    real, link = folder / "run.csv", tmp_path / "run.csv"
    if is_there:
        real.write_bytes(b"old")
    link.symlink_to("far/run.csv")
    write(link, b"new", "--output-file")
    assert link.is_symlink()
    assert real.read_bytes() == b"new"
    assert sorted(tmp_path.iterdir()) == [folder, link]
    assert list(folder.iterdir()) == [real]


def test_a_named_pipe_is_written_into(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    got: list[bytes] = []
    reader = threading.Thread(target=lambda: got.append(pipe.read_bytes()), daemon=True)
    reader.start()
    write(pipe, b"samples", "--output-file")
    reader.join(10.0)
    assert got == [b"samples"]
    assert pipe.is_fifo()
    assert list(tmp_path.iterdir()) == [pipe]


def test_a_redirected_output_goes_on_where_it_was(tmp_path: Path) -> None:
    link = tmp_path / "output"
    with (tmp_path / "log").open("wb", buffering=0) as log:
        link.symlink_to(f"/dev/fd/{log.fileno()}")
        log.write(b"before ")
        write(link, b"samples ", "--output-file")
        log.write(b"after")
    assert (tmp_path / "log").read_bytes() == b"before samples after"
    assert link.is_symlink()


def test_a_failing_write_names_the_option_and_the_path(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "run.csv"
    target.write_bytes(b"old")
    missing = tmp_path / "none" / "part"
    monkeypatch.setattr("stickslip_verification.replacing", lambda path: missing.open("xb"))
    with pytest.raises(CommandError) as refusal:
        write(target, b"new", "--output-file")
    reason = "cannot write the file: No such file or directory"
    assert str(refusal.value) == f"--output-file {target}: {reason}"
    assert list(tmp_path.iterdir()) == [target]
    assert target.read_bytes() == b"old"


def test_a_circle_of_links_is_refused(tmp_path: Path) -> None:
    first, second = tmp_path / "a", tmp_path / "b"
    first.symlink_to(second)
    second.symlink_to(first)
    with pytest.raises(CommandError, match=r"--plot .*a: cannot write the file"):
        check_writable(first, "--plot")
