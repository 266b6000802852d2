"""`python -m stickslip_verification`: what tests the suite itself."""

import re
from pathlib import Path

import pytest

from stickslip_verification.__main__ import main
from stickslip_verification.suite.cases import CASES_FOLDER
from stickslip_verification.suite.faults import FAULTS_FOLDER


@pytest.mark.gate
@pytest.mark.parametrize(
    ("foretold", "code", "words"),
    [
        ("F_s-course", 0, "1 of 1 planted faults detected by a check named in advance"),
        ("stick-holds-x", 1, "SURVIVED mine (named: stick-holds-x): failing checks: "),
    ],
)
def test_own_faults_can_be_tried(
    capsys: pytest.CaptureFixture[str],
    fmu_path: Path,
    tmp_path: Path,
    foretold: str,
    code: int,
    words: str,
) -> None:
    text = (FAULTS_FOLDER / "constants.toml").read_text(encoding="utf-8")
    text = "[mine]" + text.partition("[constant-g]")[2].partition("\n[")[0]
    text = re.sub(r"detected_by = \[.*?\]", f'detected_by = ["{foretold}"]', text, flags=re.S)
    mine = tmp_path / "mine.toml"
    mine.write_text(text, encoding="utf-8")
    arguments = ("faults", fmu_path, mine, "--cases", "default", "-o", tmp_path / "r")
    assert main(list(map(str, arguments))) == code
    assert words in capsys.readouterr().out
    assert "mine" in (tmp_path / "r" / "index.html").read_text(encoding="utf-8")


def test_the_linter_names_what_is_wrong(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    text = (CASES_FOLDER / "no-pull.toml").read_text(encoding="utf-8")
    reason = text[text.index('because = "') :].split("\n")[0]
    (tmp_path / "other.toml").write_text(text.replace(reason, 'because = "seems fine"'), "utf-8")
    assert main(["lint", "--cases", str(tmp_path)]) == 1
    out = capsys.readouterr().out
    assert "'seems' is no reason" in out


def test_wrong_use_has_its_own_code(fmu_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["faults", str(fmu_path), "none.toml"]) == 2
    assert "none.toml: no such file" in capsys.readouterr().err
