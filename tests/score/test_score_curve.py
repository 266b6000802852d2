"""Curves as files of any tool: what is read, and what is refused rather than guessed."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stickslip_score import Curve, CurveError, read_curve

T, X, F = np.array([(0.1 * i, 0.001 * i, 2.0 * i) for i in range(8)]).T


def written(folder: Path, text: str, encoding: str = "utf-8") -> Path:
    file = folder / "curve.csv"
    file.write_bytes(text.encode(encoding))
    return file


def table(header: str, separator: str = ",", comma: bool = False) -> str:
    """Give rows of time, position and force under a header."""
    rows = (f"{t:.6g}{separator}{x:.6g}{separator}{F:.6g}" for t, x, F in zip(T, X, F, strict=True))
    lines = [line.replace(".", ",") if comma else line for line in rows]
    return "\n".join([header, *lines]) + "\n"


PLAIN = table("time,x,F")
TRAILING = PLAIN.replace("\n", ",\n").replace("F,", "F")
TWICE = PLAIN.replace("0.3,0.003,6\n", "0.3,0.003,6\n0.3,0.003,6\n")


@pytest.mark.parametrize(
    ("text", "names", "t_unit", "x_unit"),
    [
        (table('"time","x","F"'), {}, 1.0, 1.0),
        (table("\ufefftime,x,F"), {}, 1.0, 1.0),
        (table("t;x [mm];F [N]", ";", comma=True), {}, 1.0, 1e-3),
        (table("Time (s)\tmass.s\tspring.f", "\t"), {}, 1.0, 1.0),
        ("# made by hand\n\n" + table("TIME, Position [um], Force (N)"), {}, 1.0, 1e-6),
        (table("time,StickSlip.x,StickSlip.F").replace("\n", "\r\n"), {}, 1.0, 1.0),
        (table("time,x [µm],F"), {}, 1.0, 1e-6),
        (TRAILING, {}, 1.0, 1.0),
        # Tools write an event as two rows of one time.
        (TWICE, {}, 1.0, 1.0),
        # Columns that are named, with the unit in the header or with the name.
        (table("Stunde [ms],a,b"), {"t": "stunde", "x": "a", "F": "b"}, 1e-3, 1.0),
        (PLAIN, {"x": "x [mm]", "t": "TIME (ms)"}, 1e-3, 1e-3),
    ],
)
def test_files_of_many_tools_give_the_same_curve(
    tmp_path: Path, text: str, names: dict[str, str], t_unit: float, x_unit: float
) -> None:
    # Windows writes µ otherwise.
    curve = read_curve(written(tmp_path, text, "latin-1" if "µ" in text else "utf-8"), names)
    assert curve.x is not None
    assert curve.F is not None
    assert curve.t == pytest.approx(T * t_unit)
    assert curve.x == pytest.approx(X * x_unit)
    assert pytest.approx(F) == curve.F


def test_a_frequency_f_is_no_force(tmp_path: Path) -> None:
    curve = read_curve(written(tmp_path, table("f,time,F")))
    assert curve.F is not None
    assert curve.F[1] == 2.0
    assert curve.t[1] == 0.001


def numbers(form: str, separator: str = ";", quote: str = "") -> str:
    """Give a position that passes 1000 um, in a form with `,` and `.` as in English."""
    rows = [
        f"{0.5 * i:.1f}{separator}{quote}{format(999.0 + 0.5 * i, form)}{quote}" for i in range(8)
    ]
    return "\n".join([f"t{separator}x [um]", *rows]) + "\n"


@pytest.mark.parametrize(
    "text",
    [
        numbers(",.0f"),
        numbers(",.1f"),
        numbers(",.1f", ","),
        numbers(",.1f", ",", '"'),
        numbers(",.1f").replace(",", "'"),
        numbers(",.1f").replace(".", ";").replace(",", ".").replace(";", ",").replace(",x", ";x"),
        "t;x\n" + "\n".join(f"{i},0;1.00{i}" for i in range(8)),
        "t;x\n" + "\n".join(f"{1000 + i};1,00{i}" for i in range(8)),
    ],
)
def test_a_comma_or_point_that_may_separate_thousands_is_refused(tmp_path: Path, text: str) -> None:
    with pytest.raises(CurveError):
        read_curve(written(tmp_path, text))


@pytest.mark.parametrize(
    "text",
    [
        "t;x\n" + "\n".join(f"{1000 + i};1,00{i}" for i in range(8)) + "\n1008;0,5",
        "t;x\n" + "\n".join(f"{i},5;1,00{i}" for i in range(8)),
        "t,x\n" + "\n".join(f'"{i},5","1,00{i}"' for i in range(8)),
    ],
)
def test_decimal_commas_are_read_where_they_can_be_nothing_else(tmp_path: Path, text: str) -> None:
    curve = read_curve(written(tmp_path, text))
    assert curve.x is not None
    assert curve.x[:8] == pytest.approx(1.0 + 0.001 * np.arange(8))


REFUSED = [
    ("", {}, "is empty"),
    (table("a,x,F"), {}, "no column of time; the columns are a, x, F"),
    (table("time,a,b"), {}, "no column of the position x nor of the spring force F"),
    (table("time,m1.s,m2.s"), {}, "position may be any of m1.s, m2.s"),
    (table("time,x [ft],F"), {}, "the unit of the position is none of"),
    (PLAIN.replace("0.003", "abc"), {}, "line 5: x is 'abc', not a number"),
    (PLAIN.replace("0.003", "NaN"), {}, "line 5: x is nan"),
    (PLAIN.replace("0.003", "inf"), {}, "line 5: x is inf"),
    (PLAIN.replace("0.3,", "0.15,"), {}, "line 5: time does not increase"),
    (PLAIN.replace("0.3,", "0.2,"), {}, "line 5: time does not increase"),
    ("time,x\n0,0\n1,1\n", {}, "2 samples; at least 5 are needed"),
    (table("0,0,0"), {}, "no header line"),
    (PLAIN.replace("0.3,0.003,6", "0.3"), {}, "line 5: 1 cells"),
    # A comma inside a number was taken for a separator.
    (PLAIN.replace("0.3,0.003,6", "0,3,0.003,6"), {}, "line 5: 4 cells under a header of 3"),
    (PLAIN, {"x": "weg"}, "no column 'weg'; the columns are time, x, F"),
    (table("time,x [m],F"), {"x": "x [mm]"}, "no column"),
]


@pytest.mark.parametrize(("text", "names", "words"), REFUSED)
def test_a_bad_file_is_refused_with_file_and_place_in_one_line(
    tmp_path: Path, text: str, names: dict[str, str], words: str
) -> None:
    file = written(tmp_path, text)
    with pytest.raises(CurveError) as refused:
        read_curve(file, names)
    assert words in str(refused.value)
    assert str(refused.value).startswith(str(file))
    assert "\n" not in str(refused.value)


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(CurveError, match=r"nowhere\.csv: no such file"):
        read_curve(tmp_path / "nowhere.csv")
    with pytest.raises(CurveError, match="cannot be read"):
        read_curve(tmp_path)


PRINTED = np.array([float(f"{x:.6g}") for x in 0.9 * np.sin(np.linspace(0.2, 3.0, 500))])
SWING = 5e-3 * np.sin(np.linspace(0.0, 3.0, 500))
MICROMETRES, THIRDS = (step * np.round(SWING / step) for step in (1e-6, 1e-4 / 3.0))


@pytest.mark.parametrize(
    ("t", "x", "t_rounding", "x_rounding"),
    [
        # Half a unit in the last printed place, half a count of an encoder, or nothing.
        (np.arange(500.0), PRINTED, 0.0, 0.5e-6),
        (np.arange(500.0), MICROMETRES, 0.0, 0.5e-6),
        (np.arange(500.0), THIRDS, 0.0, 0.5e-4 / 3.0),
        (0.1 * np.arange(500), SWING, 0.0, 0.0),
        # A step of 1/60 s loses digits.
        (np.round(np.arange(500) / 60.0, 4), SWING, 5e-5, 0.0),
    ],
)
def test_the_digits_of_samples_bound_what_rounding_took(
    t: Any, x: Any, t_rounding: float, x_rounding: float
) -> None:
    curve = Curve.of(t, x=x)
    # What is not rounded has the last digits of doubles.
    assert curve.t_rounding == pytest.approx(t_rounding, rel=0.1, abs=1e-13)
    assert curve.x_rounding == pytest.approx(x_rounding, rel=0.1, abs=1e-15)
