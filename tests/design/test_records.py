"""Records of drives and pull tests: what is read of many makers' files, and what is refused."""

import math
from pathlib import Path

import numpy as np
import pytest

from stickslip_design.axis import Axis, axis_file_of
from stickslip_design.identify.model import Record
from stickslip_design.identify.read import read_record
from stickslip_score import CurveError

STATED = """\
[axis]
mass = "95 kg"
stiffness = "50 N/um"
[friction]
mu_s = 0.1
mu_k = 0.08
[drive]
{}
inertia = "60 kg cm2"
K_v = "25 1/s"
bandwidth = "300 1/s"
rated_torque = "20 N m"
torque_constant = "0.8 N m/A ± 5 %"
"""


def axis_of(way: str = 'pitch = "10 mm"') -> Axis:
    return axis_file_of(STATED.format(way)).axis()


SCREW = axis_of()
BELT = axis_of(
    'kind = "belt"\nteeth = 32\ntooth_pitch = "5 mm"\ngear = 5\nposition = "motor"',
)
BARE = axis_file_of(STATED.partition("rated_torque")[0].format('pitch = "10 mm"')).axis()
RIGID = axis_file_of(STATED.partition("[drive]")[0]).axis()
PER_TURN = 200.0 * math.pi
"""Force at the slide of 1 N m at a screw of 10 mm [N]."""
T = 0.001 * np.arange(8)
X = 0.001 * np.array([0, 1, 3, 6, 10, 15, 21, 28])
F = np.array([5.0, 5.5, 6.0, 6.0, 5.0, 4.5, 4.0, 4.25])


def rows(separator: str = ",", comma: bool = False, t: float = 1.0, x: float = 1.0) -> str:
    """Return lines of T, X and F, in other units."""
    lines = [
        separator.join(f"{number:.10g}" for number in row)
        for row in zip(T * t, X * x, F, strict=True)
    ]
    return "".join(f"{line.replace('.', ',') if comma else line}\n" for line in lines)


def read(
    folder: Path, text: str, axis: Axis | None = None, columns: dict[str, str] | None = None
) -> Record:
    file = folder / "record.csv"
    file.write_text(text, encoding="utf-8")
    return read_record(file, columns, axis)


BENCH = "Test bench 3\nfile:;x;1\n\nt;position;kraft\n[ms];[mm];[N]\n"
SCOPE = """\
Name\tRecord 7
File\tD:\\trace.csv
Starttime of export\t132959733843760000\tMontag, 2. Mai 2022\t15:56:24.376

Name\tAxis 1.ActPos\tAxis 1.Force
SymbolComment\t\t
SampleTime[ms]\t1\t1
Port\t851\t851
Unit\tmm (Length)\t(None)

"""
SINUMERIK = "/Nck/!SD/nckServoDataActPos1stEnc64 [u1, 1]"
NAMED = "/Nck/!SD/nckServoDataActPos1stEnc64 u1-1 [mm]"


@pytest.mark.parametrize(
    ("text", "columns"),
    [
        ("t [s],position [m],force [N]\n" + rows(), {}),
        ("Zeit (ms);Lageistwert (mm);Motorkraft (N)\n" + rows(";", True, 1e3, 1e3), {}),
        ("Time\tActual position\tPull force\nms\tµm\tN\n" + rows("\t", False, 1e3, 1e6), {}),
        (BENCH + rows(";", True, 1e3, 1e3), {}),
        (SCOPE + rows("\t", True, 1e3, 1e3) + "EOF\n", {}),
        ("time,joint.0.motor-pos-fb [mm],force\n" + rows(x=1e3), {}),
        ("counter,s actual [mm],F\n" + rows(t=1e3, x=1e3), {"t": "1 ms"}),
        (f"Time,{SINUMERIK},F\n" + rows(x=1e3), {"position": NAMED}),
        ("时间 [s],实际位置 [mm],力 [N]\n" + rows(x=1e3), {}),
        ('"t";"weg";"F"\n' + rows(";", True), {}),
    ],
)  # fmt: skip
def test_files_of_many_makers_give_the_same_record(
    tmp_path: Path, text: str, columns: dict[str, str]
) -> None:
    record = read(tmp_path, text, None, columns)
    assert record.position is not None
    assert record.force is not None
    assert record.t - record.t[0] == pytest.approx(T)
    assert record.position == pytest.approx(X)
    assert record.force == pytest.approx(F)
    assert record.rounding["position"] == pytest.approx(5e-4)


@pytest.mark.parametrize(
    ("heading", "way", "axis", "spread"),
    [
        ("Drehmomentistwert [Nm]", PER_TURN, SCREW, 0.0),
        ("r80: Torque actual value [%]", 0.2 * PER_TURN, SCREW, 0.0),
        ("I nominal [A]", 0.8 * PER_TURN, SCREW, 0.05),
        ("Motor current [mA]", 0.8e-3 * PER_TURN, SCREW, 0.05),
        ("iq", 0.8 * 2.0 * math.pi / 0.032, BELT, 0.05),
        ("force [kN]", 1e3, SCREW, 0.0),
    ],
)
def test_torque_and_current_of_the_motor_become_force_at_the_slide(
    tmp_path: Path, heading: str, way: float, axis: Axis, spread: float
) -> None:
    record = read(tmp_path, f"t [s],position,{heading}\n" + rows(), axis)
    assert record.force == pytest.approx(way * F)
    assert record.rounding["force"] == pytest.approx(0.125 * way)
    assert record.force_spread == pytest.approx(spread)
    assert any("its ± of 5 % scales mass and all forces" in note for note in record.notes) == (
        spread > 0.0
    )


def test_a_force_is_taken_before_torque_and_current_unless_one_of_those_is_named(
    tmp_path: Path,
) -> None:
    text = "t,force,current\n" + rows(x=1e3)
    assert read(tmp_path, text).force == pytest.approx(1e3 * X)
    named = read(tmp_path, text, SCREW, {"current": "current"})
    assert named.force == pytest.approx(0.8 * PER_TURN * F)


def test_turns_of_the_motor_become_the_speed_of_the_slide(tmp_path: Path) -> None:
    record = read(tmp_path, "t,position,Speed actual value [rpm]\n" + rows(), SCREW)
    assert record.velocity == pytest.approx(F * 0.01 / 60.0)


def test_arrays_and_a_file_make_the_same_record(tmp_path: Path) -> None:
    in_file = read(tmp_path, "t [s],position [m],current [A]\n" + rows(), SCREW)
    of_arrays = read_record({"t": T, "position": X, "current": F}, axis=SCREW)
    assert of_arrays.notes == in_file.notes
    assert of_arrays.rounding == in_file.rounding
    assert of_arrays.force == pytest.approx(in_file.force)
    for columns in ({"position": X}, {"t": T, "x": X}, {"t": T, "force": F[1:]}):
        with pytest.raises(CurveError):
            read_record(columns)


def test_a_column_without_a_unit_and_a_position_of_the_motor_are_said(tmp_path: Path) -> None:
    axis = axis_of('pitch = "10 mm"\nposition = "motor"')
    notes = read(tmp_path, "t [s],position,F [N]\n" + rows(), axis).notes
    assert notes == (
        "position has no unit: it was taken in SI",
        "the position is that of the motor, as drive.position says",
    )


def test_jitter_and_gaps_are_said_and_digits_are_neither() -> None:
    t = 0.001 * np.arange(1000)
    lost = np.delete(t, [500, *range(700, 710)])
    (off, gaps) = read_record({"t": lost, "position": lost}).notes
    assert off == "0.2 % of the steps of time are off 1.00 ms by above 1 %"
    assert gaps == ("the longest step is 11.0 ms at t = 0.699 s; 11 samples are missing in all")
    jittering = t + 1e-4 * np.random.default_rng(1).random(t.size)
    (note, _) = read_record({"t": jittering, "position": t}).notes
    assert "are off 1.00 ms by above 1 %" in note
    in_ms = np.round(0.00125 * np.arange(1000), 3)
    assert read_record({"t": in_ms, "position": t}).notes == ()


WITH_CURRENT = "t,position,current\n" + rows()
BAD = "t,position [mm],force\n" + rows()


@pytest.mark.parametrize(
    ("text", "columns", "axis", "words"),
    [
        (WITH_CURRENT, {}, None, "current of the motor: drive.torque_constant of an axis file"),
        (WITH_CURRENT, {}, RIGID, "current of the motor: drive.torque_constant of an axis file"),
        (WITH_CURRENT, {}, BARE, "drive.torque_constant of an axis file takes it"),
        ("t,x,torque [%]\n" + rows(), {}, BARE, "drive.rated_torque of an axis file takes it to"),
        ("t,x,velocity [rpm]\n" + rows(), {}, None, "velocity of the motor: drive.pitch of"),
        ("t,x [deg],F\n" + rows(), {}, None, "x [deg]: the unit of the position is none of m, cm"),
        ("t,x,F\ns,in,N\n" + rows(), {}, None, "x [in]: the unit of the position is none of m"),
        ("t,x,F\n" + rows(), {"posision": "x"}, None, "posision is none of t, position, command"),
        ("t,speed\n" + rows(), {}, None, "no column of position, force, torque or current; the"),
        ("a,b,c\n" + rows(), {"position": "b"}, None, "no column of time; the columns are a, b, c"),
        ("Name,ActPos,Name,ActualForce\n", {}, None, "time may be any of Name, Name: name the"),
        ("Trace 7\n\nt,ActPos1,ActPos2\n" + rows(), {}, None, "position may be any of ActPos1, A"),
        (BAD.replace("0.003", ""), {}, None, "line 4: position [mm] is '', not a finite number"),
        (BAD.replace("\n0,", "\n,"), {}, None, "line 2: t is '', not a finite number"),
        (BAD.replace("0.003", "NaN"), {}, None, "line 4: position [mm] is 'NaN', not a finite"),
        (BAD.replace("0.003", "a"), {}, None, "line 4: position [mm] is 'a', not a finite"),
        ("x\n\n" + BAD.replace("0.002,", "0,"), {}, None, "line 6: time does not increase (0 aft"),
        (
            BAD.replace("0.003,6", "0.003"),
            {},
            None,
            "line 4: 2 cells under a header of 3: is the l",
        ),
        (BAD.replace("0.003", "1,000"), {}, None, "4 cells under a header of 3: commas inside num"),
        ("t\x1b[2J,b\x07,c\n" + rows(), {}, None, "the columns are t?[2J, b?, c"),
        ("t,x,F\n0,1,2\n", {}, None, "1 samples; at least 5 are needed"),
        ("", {}, None, "is empty"),
        (rows(), {}, None, "has no header line"),
    ],
)
def test_what_cannot_be_read_is_refused_in_one_line_with_its_place(
    tmp_path: Path, text: str, columns: dict[str, str], axis: Axis | None, words: str
) -> None:
    with pytest.raises(CurveError) as refused:
        read(tmp_path, text, axis, columns)
    assert words in str(refused.value)
    assert str(refused.value).startswith(str(tmp_path))
    assert str(refused.value).isprintable()


def test_a_bad_cell_behind_a_million_rows_is_found_with_its_line(tmp_path: Path) -> None:
    lines = [f"{i},{i % 7},1" for i in range(700_000)]
    lines[650_000] = "650000,,1"
    with pytest.raises(CurveError, match=r"line 650002: x is ''"):
        read(tmp_path, "t,x,F\n" + "\n".join(lines))
