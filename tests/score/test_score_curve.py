"""Curves as files of any tool."""

from pathlib import Path

import numpy as np
import pytest

from stickslip_score import Curve, CurveError, read_curve

ROWS = [(0.1 * i, 0.001 * i, 2.0 * i) for i in range(8)]


def written(folder: Path, text: str, encoding: str = "utf-8") -> Path:
    """Write a file and give its path."""
    file = folder / "curve.csv"
    file.write_bytes(text.encode(encoding))
    return file


def table(header: str, separator: str = ",", comma: bool = False) -> str:
    """Give rows of time, position and force under a header."""
    lines = [separator.join(f"{cell:.6g}" for cell in row) for row in ROWS]
    if comma:
        lines = [line.replace(".", ",") for line in lines]
    return "\n".join([header, *lines]) + "\n"


@pytest.mark.parametrize(
    ("text", "x_unit"),
    [
        (table('"time","x","F"'), 1.0),
        (table("\ufefftime,x,F"), 1.0),
        (table("t;x [mm];F [N]", ";", comma=True), 1e-3),
        (table("Time (s)\tmass.s\tspring.f", "\t"), 1.0),
        ("# made by hand\n\n" + table("TIME, Position [um], Force (N)"), 1e-6),
        (table("time,StickSlip.x,StickSlip.F").replace("\n", "\r\n"), 1.0),
    ],
)
def test_files_of_many_tools_give_the_same_curve(tmp_path: Path, text: str, x_unit: float) -> None:
    """Separator, decimal comma, quotes, byte order mark, comments and units are read over."""
    curve = read_curve(written(tmp_path, text))
    assert curve.x is not None
    assert curve.F is not None
    t, x, F = np.array(ROWS).T
    assert curve.t == pytest.approx(t)
    assert curve.x == pytest.approx(x * x_unit)
    assert pytest.approx(F) == curve.F


def test_a_unit_in_the_letters_of_windows_is_read(tmp_path: Path) -> None:
    """A file in Latin-1 with µm in its header is read in micrometres."""
    curve = read_curve(written(tmp_path, table("time,x [µm],F"), "latin-1"))
    assert curve.x is not None
    assert curve.x[-1] == pytest.approx(7e-9)


def test_columns_can_be_named(tmp_path: Path) -> None:
    """Names that say nothing are taken as told, with the unit in the header or without."""
    file = written(tmp_path, table("Stunde [ms],a,b"))
    curve = read_curve(file, {"t": "stunde", "F": "b"})
    assert curve.t[-1] == pytest.approx(0.7e-3)
    assert curve.x is None
    assert curve.F is not None


def test_an_own_file_gives_force_and_not_frequency(tmp_path: Path) -> None:
    """Among F, f, T and time the case of the letter tells which is which."""
    curve = read_curve(written(tmp_path, table("time,T,f").replace("time,T,f", "f,time,F")))
    assert curve.F is not None
    assert curve.F[1] == 2.0
    assert curve.t[1] == 0.001


def test_both_rows_of_an_event_count_as_one(tmp_path: Path) -> None:
    """Tools write an event as two rows of one time; position does not jump there."""
    text = table("time,x,F").replace("0.3,0.003,6\n", "0.3,0.003,6\n0.3,0.003,6\n")
    assert read_curve(written(tmp_path, text)).t.size == len(ROWS)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "is empty"),
        (table("a,x,F"), "no column of time; the columns are a, x, F"),
        (table("time,a,b"), "no column of the position x nor of the spring force F"),
        (table("time,m1.s,m2.s"), "position may be any of m1.s, m2.s"),
        (table("time,x [ft],F"), "the unit of the position is none of"),
        (table("time,x,F").replace("0.003", "abc"), "line 5: x is 'abc', not a number"),
        (table("time,x,F").replace("0.003", "NaN"), "line 5: x is nan"),
        (table("time,x,F").replace("0.003", "inf"), "line 5: x is inf"),
        (table("time,x,F").replace("0.3,", "0.15,"), "line 5: time does not increase"),
        (table("time,x,F").replace("0.3,", "0.2,"), "line 5: time does not increase"),
        ("time,x\n0,0\n1,1\n", "2 samples; at least 5 are needed"),
        (table("0,0,0"), "no header line"),
        (table("time,x,F").replace("0.3,0.003,6", "0.3"), "line 5: 1 cells"),
    ],
)
def test_a_bad_file_is_refused_in_one_line(tmp_path: Path, text: str, reason: str) -> None:
    """The message names the file, the place and what is wrong there."""
    file = written(tmp_path, text)
    with pytest.raises(CurveError) as refused:
        read_curve(file)
    message = str(refused.value)
    assert reason in message
    assert message.startswith(str(file))
    assert "\n" not in message


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    """A wrong path is an error of the curve and no traceback of the system."""
    with pytest.raises(CurveError, match=r"nowhere\.csv: no such file"):
        read_curve(tmp_path / "nowhere.csv")
    with pytest.raises(CurveError, match="cannot be read"):
        read_curve(tmp_path)


def test_a_name_that_is_not_there_lists_what_is(tmp_path: Path) -> None:
    """A wrong column name is answered with the right ones."""
    with pytest.raises(CurveError, match="no column 'weg'; the columns are time, x, F"):
        read_curve(written(tmp_path, table("time,x,F")), {"x": "weg"})


@pytest.mark.parametrize("form", [".4g", ".6g", ".9g", ".5f", ".3e"])
def test_the_digits_of_printed_numbers_are_counted(form: str) -> None:
    """Half a unit in the last place bounds what printing took away, and is no idle bound."""
    true = 0.9 * np.sin(np.linspace(0.2, 3.0, 500))
    printed = np.array([float(f"{number:{form}}") for number in true])
    lost = float(np.max(np.abs(printed - true)))
    assert 0.999 * lost <= Curve.of(np.arange(500.0), x=printed).x_rounding <= 1.1 * lost


def test_round_times_on_an_even_grid_are_exact() -> None:
    """A step of 0.1 s needs one digit and loses none; one of 1/60 s printed so does."""
    x = np.zeros(50)
    assert Curve.of(0.1 * np.arange(50), x=x).t_rounding < 1e-14
    assert Curve.of(np.round(np.arange(50) / 60.0, 4), x=x).t_rounding == pytest.approx(5e-5)
