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


def test_a_name_carries_the_unit_that_the_header_lacks(tmp_path: Path) -> None:
    """The person who knows that x is in mm says so with the name of its column."""
    file = written(tmp_path, table("time,x,F"))
    curve = read_curve(file, {"x": "x [mm]", "t": "TIME (ms)"})
    assert curve.x is not None
    assert curve.x[-1] == pytest.approx(7e-6)
    assert curve.t[-1] == pytest.approx(0.7e-3)
    with pytest.raises(CurveError, match="no column"):
        read_curve(written(tmp_path, table("time,x [m],F")), {"x": "x [mm]"})


def numbers(form: str, separator: str = ";", quote: str = "") -> str:
    """Give a position that passes 1000 um, in a form with `,` and `.` as in English."""
    cells = [(f"{0.5 * i:.1f}", format(999.0 + 0.5 * i, form)) for i in range(8)]
    rows = [f"{t}{separator}{quote}{x}{quote}" for t, x in cells]
    return "\n".join([f"t{separator}x [um]", *rows]) + "\n"


@pytest.mark.parametrize(
    "text",
    [
        numbers(",.0f"),
        numbers(",.1f"),
        numbers(",.1f", ","),
        numbers(",.1f", ",", '"'),
        numbers(",.0f").replace(",", "."),
        numbers(",.1f").replace(",", "'"),
        numbers(",.0f").replace(",", " "),
        numbers(",.1f").replace(".", ";").replace(",", ".").replace(";", ",").replace(",x", ";x"),
        "t;x\n" + "\n".join(f"{i},0;1.00{i}" for i in range(8)),
    ],
)
def test_thousands_are_refused_and_never_another_number(tmp_path: Path, text: str) -> None:
    """A comma or point that may separate thousands is refused, whatever separates the cells."""
    with pytest.raises(CurveError):
        read_curve(written(tmp_path, text))


def test_decimal_commas_are_read_where_they_can_be_nothing_else(tmp_path: Path) -> None:
    """In any row one comma tells for the file; in quotes it may stand between commas too."""
    rows = [f"{1000 + i};1,00{i}" for i in range(8)]
    with pytest.raises(CurveError, match="'1,000' may have a separator of thousands"):
        read_curve(written(tmp_path, "\n".join(["t;x", *rows])))
    for text in (
        "\n".join(["t;x", *rows, "1008;0,5"]),
        "\n".join(["t;x", *[f"{i},5;1,00{i}" for i in range(8)]]),
        "\n".join(["t,x", *[f'"{i},5","1,00{i}"' for i in range(8)]]),
    ):
        curve = read_curve(written(tmp_path, text))
        assert curve.x is not None
        assert curve.x[:8] == pytest.approx(1.0 + 0.001 * np.arange(8))


def test_cells_beyond_the_header_are_refused(tmp_path: Path) -> None:
    """More cells than names mean that a comma inside a number was taken for a separator."""
    text = table("time,x,F").replace("0.3,0.003,6", "0,3,0.003,6")
    with pytest.raises(CurveError, match="line 5: 4 cells under a header of 3"):
        read_curve(written(tmp_path, text))
    empty = table("time,x,F").replace("\n", ",\n").replace("F,", "F")
    assert read_curve(written(tmp_path, empty)).t.size == len(ROWS)


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


@pytest.mark.parametrize("step", [1e-6, 2.0**-20, 1e-4 / 3.0])
def test_counts_of_an_encoder_are_counted(step: float) -> None:
    """Whatever digits a count times its step is written with, it carries half a step."""
    true = 5e-3 * np.sin(np.linspace(0.0, 3.0, 500))
    counted = step * np.round(true / step)
    assert Curve.of(np.arange(500.0), x=counted).x_rounding == pytest.approx(0.5 * step)
    assert Curve.of(np.arange(500.0), x=true).x_rounding < 1e-15


def test_round_times_on_an_even_grid_are_exact() -> None:
    """A step of 0.1 s needs one digit and loses none; one of 1/60 s printed so does."""
    x = np.zeros(50)
    assert Curve.of(0.1 * np.arange(50), x=x).t_rounding < 1e-14
    assert Curve.of(np.round(np.arange(50) / 60.0, 4), x=x).t_rounding == pytest.approx(5e-5)
