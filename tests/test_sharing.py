"""What the processes of a run share is made once."""

from pathlib import Path

import pytest

from tests.sharing import made_once


def test_the_second_takes_what_the_first_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Both have the same folder; another name is another folder."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    made: list[Path] = []
    first, second = (made_once("one", made.append) for _ in range(2))
    assert made == [first] == [second]
    assert made_once("two", made.append) != first


def test_what_failed_is_tried_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder that was half made is not taken."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))

    def fails(folder: Path) -> None:
        (folder / "half").touch()
        raise OSError("half made")

    with pytest.raises(OSError, match="half made"):
        made_once("one", fails)
    assert not list(made_once("one", lambda _: None).iterdir())
