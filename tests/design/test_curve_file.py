"""Measured friction curves from CSV files: units, forces, and what is refused."""

from pathlib import Path

import pytest

from stickslip_design.axis.curve_file import Curve, CurveError, read_curve

HEAD = "speed [m/s],mu\n0,0.4\n"


def read(folder: Path, text: str, normal_force: float | None = None) -> Curve:
    file = folder / "curve.csv"
    file.write_text(text, encoding="utf-8")
    return read_curve(file, normal_force)


@pytest.mark.parametrize(
    ("text", "normal_force"),
    [
        ("speed [mm/s], mu\n0, 0.42\n5, 0.31\n50, 0.27\n", None),
        ("# guide 7\n\nspeed [mm/s];mu\n0;0,42\n\n5;0,31\n# worn\n50;0.27\n", None),
        ("velocity (m/s)\tcof\n0\t0.42\n0.005\t0.31\n0.05\t0.27\n", None),
        ("mu,u,temperature [K]\n0.42,0,300\n0.31,5 mm/s,301\n0.27,50mm/s,302\n", None),
        ("\ufeffSpeed [mm/s], Friction force [N]\n0, 84\n5, 62\n50, 54\n", 200.0),
    ],
)
def test_a_curve_sets_the_points_of_the_friction_law_however_tools_write_it(
    tmp_path: Path, text: str, normal_force: float | None
) -> None:
    curve = read(tmp_path, text, normal_force)
    assert curve.of_forces is (normal_force is not None)
    assert curve.parameters == {
        "shape": 3, "n_points": 3, "mu_1": 0.42, "u_2": 0.005, "mu_2": 0.31, "u_3": 0.05,
        "mu_3": 0.27,
    }  # fmt: skip


def test_below_the_lowest_speed_friction_stays_what_it_is(tmp_path: Path) -> None:
    curve = read(tmp_path, "u [m/s],mu\n0.001,0.4\n0.01,0.3\n")
    assert curve.speeds == (0.0, 0.001, 0.01)
    assert curve.coefficients == (0.4, 0.4, 0.3)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("0,0.4\n1,0.3\n", "line 1: the header names no column of speed"),
        (f"{HEAD}2,0.3\n2,0.2\n", "line 4: speed = 2 m/s is out of range: above that of"),
        ("speed [kg],mu\n0,0.4\n1,0.3\n", "line 2: '0 kg' is a mass"),
        ("speed [m/s],mu\n" + "".join(f"{n},0.3\n" for n in range(1, 13)), "has 13 points"),
        ("speed,mu\n0,0.4\n5,0.3\n", "line 3: 5 has no unit; write it in the header"),
        ("speed,force [N]\n0,4\n1,3\n", "line 1: has forces; name the normal force"),
    ],
)
def test_what_is_wrong_with_a_file_is_said_in_one_line(
    tmp_path: Path, text: str, words: str
) -> None:
    with pytest.raises(CurveError) as refused:
        read(tmp_path, text)
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)
