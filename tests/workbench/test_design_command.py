"""`stickslip design`: what it prints and writes, and what it refuses."""

import json
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from stickslip_design.axis import AxisFile, example, template
from stickslip_design.report import html
from stickslip_design.verdict import Verdict
from tests.design import verdicts
from tests.workbench.running import Command


@pytest.fixture
def studied(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[AxisFile]:
    """Put a verdict made by hand in place of the study; the axes that it is asked for."""
    asked: list[AxisFile] = []

    def study(axis: AxisFile) -> Verdict:
        asked.append(axis)
        return verdicts.rigid()

    monkeypatch.setitem(sys.modules, "stickslip_design.study", SimpleNamespace(design=study))
    (tmp_path / "axis.toml").write_text(example(), encoding="utf-8")
    return asked


@pytest.mark.usefixtures("studied")
def test_a_summary_is_printed_and_the_report_written(command: Command, tmp_path: Path) -> None:
    """The sentence comes first; the report is named after the axis file, or as -o says."""
    answer = command("design", "axis.toml")
    assert answer.code == 0, answer.err
    first, second = answer.out.splitlines()[:2]
    assert first == "Slide of a grinder: judders"
    assert second == verdicts.rigid().sentence
    assert "critical feed: 3.95 mm/s (237 mm/min)" in answer.out
    assert answer.out.splitlines()[-1] == "report: axis.html"
    assert (tmp_path / "axis.html").read_text(encoding="utf-8") == html(verdicts.rigid())
    assert command("design", "axis.toml", "-o", "other.html").code == 0
    assert (tmp_path / "other.html").read_bytes() == (tmp_path / "axis.html").read_bytes()


def test_the_summary_tells_cures_apart_by_what_is_held(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two cures of one number are two rows; those that do not help share a line with the reason."""
    one, *_ = verdicts.rigid().cures
    cures = (
        replace(one, name="stiffer", held="c held"),
        replace(one, name="stiffer", held="zeta held"),
        replace(one, name="lighter", held="", then=None, note="not by a factor of 30"),
    )
    verdict = replace(verdicts.rigid(), cures=cures)
    monkeypatch.setitem(
        sys.modules, "stickslip_design.study", SimpleNamespace(design=lambda axis: verdict)
    )
    (tmp_path / "axis.toml").write_text(example(), encoding="utf-8")
    out = command("design", "axis.toml").out
    assert "stiffer (c held) " in out
    assert "stiffer (zeta held) " in out
    assert f"no help alone for {one.aim} (not by a factor of 30): lighter" in out


@pytest.mark.usefixtures("studied")
def test_json_is_written_beside_the_report(command: Command, tmp_path: Path) -> None:
    """Strict JSON, without NaN."""
    assert command("design", "axis.toml", "--json", "axis.json").code == 0
    found = json.loads((tmp_path / "axis.json").read_text(encoding="utf-8"), parse_constant=str)
    assert found["standing"] == "judders"
    assert found["critical_feed"] == 3.947e-3


def test_what_is_wrong_in_the_file_is_one_line_with_its_number(
    command: Command, tmp_path: Path, studied: list[AxisFile]
) -> None:
    """Exit code 2, nothing studied, nothing written."""
    wrong = example().replace('"500 kg"', '"-5 kg"')
    (tmp_path / "axis.toml").write_text(wrong, encoding="utf-8")
    answer = command("design", "axis.toml", "--json", "axis.json")
    assert answer.code == 2
    line = 1 + wrong.splitlines().index('mass = "-5 kg"')
    assert answer.err.startswith(f'stickslip: axis.toml: line {line}: axis.mass = "-5 kg" is out ')
    assert answer.err.count("\n") == 1
    assert not studied
    assert [each.name for each in tmp_path.iterdir()] == ["axis.toml"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((), "no axis file is named"),
        (("none.toml",), "none.toml: cannot be read: no such file"),
        (("axis.toml", "-o", "no/report.html"), "there is no folder no"),
        (("axis.toml", "-o", "axis.toml"), "that is the axis file"),
        (("axis.toml", "--json", "./axis.html"), "the report goes there"),
        (("--template", "--example"), "give one of them"),
        (("--template", "-o", "x.html"), "without -o and --json"),
        (("--template", "axis.toml"), "there is such a file already"),
    ],
)
def test_wrong_use_is_refused_before_any_work(
    command: Command, tmp_path: Path, studied: list[AxisFile], arguments: tuple[str, ...], said: str
) -> None:
    """One line that says what to do; the axis file stays as it is."""
    answer = command("design", *arguments)
    assert answer.code == 2
    assert said in answer.err
    assert answer.err.count("\n") == 1
    assert not studied
    assert [each.name for each in tmp_path.iterdir()] == ["axis.toml"]
    assert (tmp_path / "axis.toml").read_text(encoding="utf-8") == example()


@pytest.mark.usefixtures("studied")
def test_a_report_that_fails_leaves_the_old_one(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Everything is made before the first file is touched."""
    (tmp_path / "axis.html").write_text("old", encoding="utf-8")

    def failing(verdict: Verdict) -> None:
        raise RuntimeError("no data")

    monkeypatch.setattr("stickslip_design.report.record._plain", failing)
    assert command("design", "axis.toml", "--json", "axis.json").code == 70
    assert (tmp_path / "axis.html").read_text(encoding="utf-8") == "old"
    assert not (tmp_path / "axis.json").exists()


@pytest.mark.usefixtures("studied")
@pytest.mark.parametrize("which", ["template", "example"])
def test_an_axis_file_to_begin_with(command: Command, tmp_path: Path, which: str) -> None:
    """It is printed, or written into the new file that is named."""
    text = template() if which == "template" else example()
    assert command("design", f"--{which}").out == text
    answer = command("design", f"--{which}", "new.toml")
    assert answer.code == 0
    assert answer.out == "new.toml is written; next: stickslip design new.toml\n"
    assert (tmp_path / "new.toml").read_text(encoding="utf-8") == text
