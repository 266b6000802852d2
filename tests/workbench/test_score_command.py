"""`stickslip score` as a person meets it."""

import json
from pathlib import Path

import fmpy
import pytest
from fmpy.util import write_csv

from .running import Command


@pytest.fixture(scope="module")
def curve(fmu_path: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a result file as fmpy writes it, of our FMU at the defaults."""
    result = fmpy.simulate_fmu(
        str(fmu_path), stop_time=3.0, output_interval=0.01, output=["x", "x_dot", "F"]
    )
    file = tmp_path_factory.mktemp("curve") / "result.csv"
    write_csv(file, result)
    return file


def test_an_exact_curve_is_told_as_exact(command: Command, curve: Path) -> None:
    """The table shows the four quantities beside the exact ones, and the cause."""
    answer = command("score", curve, "--k", "1000", "--v", "20mm/s")
    assert answer.code == 0
    for word in ("period", "stick", "slip", "jump", "resolution", "exact"):
        assert word in answer.out


def test_json_is_for_machines(command: Command, curve: Path) -> None:
    """Four quantities with got, exact, error and resolution, and the cause."""
    score = json.loads(command("score", curve, "--json").out)
    assert score["cause"] == "exact"
    for name in ("period", "t_stick", "t_slip", "delta_x"):
        assert {"got", "exact", "error", "resolution"} <= set(score[name])
        assert abs(score[name]["error"]) <= score[name]["resolution"]
    assert score["period"]["exact"] == pytest.approx(0.3152, abs=1e-4)


def test_a_wrong_parameter_is_no_exact_curve(command: Command, curve: Path) -> None:
    """Against another stiffness the same curve is not exact."""
    score = json.loads(command("score", curve, "--k", "1010", "--json").out)
    assert score["cause"] != "exact"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "empty"),
        ("x,F\n0,0\n", "time"),
        ("t,x\n0,0\n0.1,nan\n0.2,0\n", "line 3"),
        ("t,x\n0,0\n0.2,0\n0.1,0\n", "line 4"),
        ("t,x\n0,0\n0.1,much\n", "line 3"),
        ("t,y\n0,0\n", "x"),
    ],
)
def test_a_bad_file_is_one_line(command: Command, tmp_path: Path, text: str, told: str) -> None:
    """No time, NaN, time not increasing, no number: exit 2 with the file and the line."""
    (tmp_path / "bad.csv").write_text(text, encoding="utf-8")
    answer = command("score", "bad.csv")
    assert answer.code == 2
    assert answer.err.startswith("stickslip: bad.csv")
    assert told in answer.err
    assert answer.err.count("\n") == 1


def test_a_missing_file_is_one_line(command: Command) -> None:
    """No such file: exit 2."""
    answer = command("score", "none.csv")
    assert answer.code == 2
    assert "none.csv: no such file" in answer.err
