"""Curves as files of any tool: what is read, and what is refused rather than guessed."""

from pathlib import Path

import numpy as np
import pytest

from stickslip_score import CurveError, read_curve

T, X, F = np.array([(0.1 * i, 0.001 * i, 2.0 * i) for i in range(8)]).T


def written(folder: Path, text: str, encoding: str = "utf-8") -> Path:
    file = folder / "curve.csv"
    file.write_bytes(text.encode(encoding))
    return file


def table(header: str, separator: str = ",", comma: bool = False) -> str:
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


def test_a_frequency_beside_a_force_is_no_force(tmp_path: Path) -> None:
    curve = read_curve(written(tmp_path, table("f,time,F")))
    assert curve.F is not None
    assert (curve.F[1], curve.t[1]) == (2.0, 0.001)


def test_a_derivative_of_the_position_is_the_velocity(tmp_path: Path) -> None:
    curve = read_curve(written(tmp_path, table("time,x,der(x)")))
    assert curve.x_dot is not None
    assert curve.x_dot == pytest.approx(F)


def numbers(*columns: str) -> str:
    separator, t, x = columns
    rows = (f"{t}{separator}{x}".replace("#", str(i)) for i in range(8))
    return "\n".join([f"t{separator}x", *rows]) + "\n"


# Where a comma or a point may separate thousands, it is refused; else the first x is 1.
@pytest.mark.parametrize(
    ("text", "is_read"),
    [
        (numbers(";", "#.0", "1,00#"), False),
        (numbers(",", "#.0", '"1,00#.5"'), False),
        (numbers(";", "#.0", "1'00#.5"), False),
        (numbers(";", "#,0", "1.00#,5"), False),
        (numbers(";", "#,0", "1.00#"), False),
        (numbers(";", "100#", "1,00#"), False),
        (numbers(";", "100#", "1,00#") + "1008;0,5", True),
        (numbers(";", "#,5", "1,00#"), True),
        (numbers(",", '"#,5"', '"1,00#"'), True),
    ],
)
def test_decimal_commas_are_read_where_they_can_be_nothing_else(
    tmp_path: Path, text: str, is_read: bool
) -> None:
    file = written(tmp_path, text)
    if is_read:
        x = read_curve(file).x
        assert x is not None
        assert x[:8] == pytest.approx(1.0 + 0.001 * np.arange(8))
    else:
        with pytest.raises(CurveError):
            read_curve(file)


REFUSED = [
    (table("time,a,b"), {}, "no column of the position x nor of the spring force F"),
    (table("time,m1.s,m2.s"), {}, "position may be any of m1.s, m2.s"),
    (table("time,x [ft],F"), {}, "the unit of the position is none of"),
    (PLAIN.replace("0.003", "NaN"), {}, "line 5: x is 'NaN'"),
    (PLAIN.replace("0.3,", "0.2,"), {}, "line 5: time does not increase"),
    ("time,x\n0,0\n1,1\n", {}, "2 samples; at least 5 are needed"),
    (table("0,0,0"), {}, "no header line"),
    # A comma inside a number was taken for a separator.
    (PLAIN.replace("0.3,0.003,6", "0,3,0.003,6"), {}, "line 5: 4 cells under a header of 3"),
    (PLAIN, {"x": "weg"}, "no column 'weg'; the columns are time, x, F"),
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
