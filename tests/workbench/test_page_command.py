"""`stickslip page` and `stickslip explore` as a person meets them."""

from pathlib import Path

import pytest

from stickslip.page import page

from .running import Command


def test_the_page_is_one_file(command: Command, tmp_path: Path) -> None:
    """What is printed is what is on the disk, and it is the page."""
    answer = command("page", "-o", "a.html")
    content = (tmp_path / "a.html").read_bytes()
    assert answer.code == 0
    assert answer.out.split() == ["a.html", str(len(content)), "bytes"]
    assert content.decode() == page()


def test_the_page_has_a_name_of_its_own(command: Command, tmp_path: Path) -> None:
    """Without -o the file is stick-slip.html, here."""
    assert command("page").code == 0
    assert [file.name for file in tmp_path.iterdir()] == ["stick-slip.html"]


def test_the_page_begins_where_the_person_says(command: Command, tmp_path: Path) -> None:
    """Values with units are in the file as SI, each the very double that was meant."""
    assert command("page", "-o", "a.html", "--v", "5mm/s", "--k", "2 kN/m").code == 0
    text = (tmp_path / "a.html").read_text(encoding="utf-8")
    assert '"setting":{"k":2000.0,"v":0.005}' in text


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (["--k", "-1"], ["--k '-1'", "above 0"]),
        (["--v", "-5mm/s"], ["--v '-5mm/s'", "1e-15 to 1e+06 m/s"]),
        (["--v", "0"], ["--v '0'", "1e-15 to 1e+06 m/s"]),
        (["--m", "1e30 kg"], ["--m", "1e-09 to 1e+18 kg"]),
        (["--mu-s", "high"], ["--mu-s 'high'"]),
        (["--load", "-20 N"], ["--load '-20 N'", "lift the mass", "9.81 N"]),
        (["--load", "1e19"], ["--load '1e19'", "-1e+18 to 1e+18 N"]),
        (["-o", "missing/a.html"], ["-o missing/a.html", "no folder missing"]),
        (["-o", "."], ["-o .", "it is a folder"]),
    ],
)
def test_wrong_use_is_answered_in_one_line(
    command: Command, tmp_path: Path, arguments: list[str], parts: list[str]
) -> None:
    """Exit code 2, one line with name, value and range, and no file."""
    answer = command("page", *arguments)
    assert answer.code == 2
    assert answer.err.startswith("stickslip: ")
    assert answer.err.count("\n") == 1
    for part in parts:
        assert part in answer.err
    assert not list(tmp_path.iterdir())


def test_explore_opens_the_page(
    command: Command, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The browser gets a file that is still there when the command has ended."""
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    opened: list[str] = []

    def open_(address: str) -> bool:
        opened.append(address)
        return True

    monkeypatch.setattr("webbrowser.open", open_)
    answer = command("explore", "--v", "5mm/s")
    file = Path(answer.out.strip())
    assert answer.code == 0
    assert opened == [file.as_uri()]
    assert '"setting":{"v":0.005}' in file.read_text(encoding="utf-8")


def test_without_a_browser_explore_says_where_the_page_is(
    command: Command, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The file is printed all the same, and the code is not that of success."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setattr("webbrowser.open", lambda address: False)
    answer = command("explore")
    assert answer.code == 1
    assert Path(answer.out.strip()).is_file()
    assert "no browser" in answer.err
