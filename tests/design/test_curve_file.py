"""Measured friction curves from CSV files: units, forces, and what is refused."""

from pathlib import Path

import pytest

from stickslip_design.curve_file import CurveError, read_curve

GOOD = "speed [mm/s], mu\n0, 0.42\n5, 0.31\n50, 0.27\n"


def _file(folder: Path, text: str) -> Path:
    file = folder / "curve.csv"
    file.write_text(text, encoding="utf-8")
    return file


def test_a_curve_sets_the_points_of_the_friction_law(tmp_path: Path) -> None:
    """Speeds are SI values, the first point is the friction at speed 0."""
    assert read_curve(_file(tmp_path, GOOD), None).parameters == {
        "shape": 3, "n_points": 3, "mu_1": 0.42, "u_2": 0.005, "mu_2": 0.31, "u_3": 0.05,
        "mu_3": 0.27,
    }  # fmt: skip


@pytest.mark.parametrize(
    "text",
    [
        "# guide 7\n\nspeed [mm/s];mu\n0;0,42\n\n5;0,31\n# worn\n50;0.27\n",
        "velocity (m/s)\tcof\n0\t0.42\n0.005\t0.31\n0.05\t0.27\n",
        "mu,u,temperature [K]\n0.42,0,300\n0.31,5 mm/s,301\n0.27,50mm/s,302\n",
        "\ufeffSpeed [mm/s], Friction force [N]\n0, 84\n5, 62\n50, 54\n",
    ],
)
def test_separators_names_units_and_comments_are_as_tools_write_them(
    tmp_path: Path, text: str
) -> None:
    """The same curve comes of all of them; forces are divided by the normal force."""
    force = 200.0 if "force" in text else None
    found = read_curve(_file(tmp_path, text), force)
    assert found.of_forces == ("force" in text)
    assert found.parameters == read_curve(_file(tmp_path, GOOD), None).parameters


def test_below_the_lowest_speed_friction_stays_what_it_is(tmp_path: Path) -> None:
    """A file that begins above speed 0 has the friction of its first row from there on."""
    curve = read_curve(_file(tmp_path, "u,mu\n0.001,0.4\n0.01,0.3\n"), None)
    assert curve.speeds == (0.0, 0.001, 0.01)
    assert curve.coefficients == (0.4, 0.4, 0.3)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "is empty"),
        ("0,0.4\n1,0.3\n", "line 1: the header names no column of speed"),
        ("speed,what\n0,0.4\n", "line 1: the header names no column of friction"),
        (
            "speed,mu\n0,0.4\n-1,0.3\n",
            "line 3: speed = -1 m/s is out of range: at least 0; one",
        ),
        ("speed,mu\n0,0.4\n2,0.3\n2,0.2\n", "line 4: speed = 2 m/s is out of range: above that of"),
        ("speed,mu\n0,0.4\n1,-0.3\n", "line 3: friction = -0.3 is out of range: at least 0"),
        ("speed,mu\n0,0.4\n1\n", "line 3: has 1 cells, and the header 2"),
        ("speed,mu\n0,0.4\n1,0,3\n", "line 3: has 3 cells, and the header 2"),
        ("speed,mu\n0,0.4\n1,\n", "line 3: '' is not a finite number"),
        ("speed,mu\n0,0.4\n1,0.3\n1.5,nan\n", "line 4: 'nan' is not a finite number"),
        ("speed [kg],mu\n0,0.4\n1,0.3\n", "line 2: '0 kg' is a mass"),
        ("speed,mu\n0,0.4\n", "has 1 points"),
        ("speed,mu\n" + "".join(f"{n},0.3\n" for n in range(13)), "has 13 points"),
        ("speed,mu\n" + "".join(f"{n},0.3\n" for n in range(1, 13)), "has 13 points"),
        ("speed,force [N]\n0,4\n1,3\n", "line 1: has forces; name the normal force"),
    ],
)
def test_what_is_wrong_with_a_file_is_one_line(tmp_path: Path, text: str, told: str) -> None:
    """The line by its number, the value, its range, and what to do."""
    with pytest.raises(CurveError) as caught:
        read_curve(_file(tmp_path, text), None)
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_file_that_is_not_there_is_told(tmp_path: Path) -> None:
    """So is one that cannot be read as text."""
    with pytest.raises(CurveError, match="no such file"):
        read_curve(tmp_path / "none.csv", None)
