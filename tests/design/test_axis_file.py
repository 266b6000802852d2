"""Axis files: what they say, what they assume, what they refuse."""

import math
import re
from dataclasses import replace
from pathlib import Path

import pytest

from stickslip_design.axis import (
    Axis,
    AxisError,
    Demand,
    Filter,
    Friction,
    axis_file_of,
    example,
    read_axis_file,
    template,
)
from stickslip_design.axis.keys import KEYS
from tests.examples.axes import Axis as ServoAxis

RIGID = {
    "axis": {"mass": '"500 kg"', "stiffness": '"50 N/um"'},
    "friction": {"mu_s": "0.25", "mu_k": "0.15"},
}
DRIVE = {
    "pitch": '"10 mm"', "inertia": '"60 kg cm2"', "K_v": '"25 1/s"', "bandwidth": '"300 1/s"',
    "rated_torque": '"11 N m"',
}  # fmt: skip
OTHERS = ("drive.filter", "limits")
SECTION_OF = {key.name: key.section for key in KEYS.values() if key.section not in OTHERS}
SECTION_OF["kind"] = "drive"
EXCLUDED = {
    "F_s": ["mu_s"], "F_k": ["mu_k"], "velocity_gain": ["bandwidth"], "curve": ["mu_s", "mu_k"],
}  # fmt: skip
FILTERS = """\
[[drive.filter]]
kind = "low pass"
frequency = "800 Hz"
damping = 0.7
[[drive.filter]]
kind = "notch"
frequency = "400 Hz"
width = "200 Hz"
[[drive.filter]]
kind = "low pass"
frequency = "1 kHz"
"""
CORNER = Filter("low pass", 1000.0)
READ = replace(CORNER, frequency=800.0, damping=0.7), Filter("notch", 400.0, 0.25), CORNER
PER_TURN = 200.0 * math.pi
"""Force at the slide of 1 N m at a screw of 10 mm [N]."""


def written(changes: str = "") -> str:
    """Return an axis file with lines `key = value` changed, `-key` left out, `[section]` added."""
    sections = {**{name: dict(keys) for name, keys in RIGID.items()}, "drive": dict(DRIVE)}
    sections["demand"] = {}
    lines = changes.splitlines()
    end = next((number for number, line in enumerate(lines) if line.startswith("[")), len(lines))
    for line in lines[:end]:
        name, _, value = line.partition(" = ")
        for other in [name[1:]] if name.startswith("-") else EXCLUDED.get(name, ()):
            sections[SECTION_OF[other]].pop(other, None)
        if value:
            sections[SECTION_OF.get(name, "demand")][name] = value
    found = []
    for section, keys in sections.items():
        found += [f"[{section}]", *(f"{name} = {value}" for name, value in keys.items())]
    return "\n".join([*found, *lines[end:], ""])


def test_the_least_file_is_a_table_on_a_rigid_drive() -> None:
    axis = axis_file_of(written().partition("[drive]")[0], "shop/x.toml").axis()
    assert axis == Axis(
        name="x", m=500.0, k=5e7, friction=Friction(mu_s=0.25, mu_k=0.15), assumed=axis.assumed
    )
    assumed = {each.key: each.value for each in axis.assumed}
    assert (assumed["drive"], assumed["axis.gravity"]) == ("a rigid drive", "9.81 m/s2")


def test_the_example_is_to_the_bit_the_axis_of_the_feed_axis_fmus() -> None:
    axis, servo = axis_file_of(example()).axis(), ServoAxis()
    assert axis.drive == servo.designed.drive
    assert axis.block(servo.feed) == servo.designed.block(servo.feed)
    assert axis.demand == Demand(feeds=(5e-4, 2e-3, 5e-3), acceleration=servo.acceleration)


FALLING = 'law = "stribeck"\nv_s = "10 mm/s"\n'
SCREW = """\
-stiffness
core_diameter = "33 mm"
fixing = "fixed-fixed"
free_length = "0.3 m"
bearing_distance = "1.2 m"
"""
NEEDED = {
    "F_s": 'F_k = "736 N"\n', "F_k": 'F_s = "981 N"\n', "t_0": "B = 0.01\n",
    "shape": FALLING, "v_s": FALLING, "delta": FALLING, "core_diameter": SCREW,
    "fixing": SCREW, "free_length": SCREW, "bearing_distance": SCREW, "modulus": SCREW,
    "in_series": SCREW,
}  # fmt: skip


def test_the_template_is_read_and_has_an_example_of_every_key() -> None:
    text = template()
    assert axis_file_of(text).axis().drive is not None
    for key in (key for key in KEYS.values() if key.fits("screw")):
        line = f"{key.name} = {key.example}"
        assert re.search(rf"^(# )?{re.escape(line)}$", text, re.MULTILINE)
        if key.section != "drive.filter" and key.name != "curve":
            place = "[limits]\n" if key.section == "limits" else NEEDED.get(key.name, "")
            read = axis_file_of(written(place + line)).axis()
            assert not (key.reason and key.path in {each.key for each in read.assumed})


@pytest.mark.parametrize(
    ("changes", "field", "value"),
    [
        ('stiffness = ["80 N/um", "50 N/um"]', "stiffest", 8e7),
        ('zeta = "5 %"\nstiffness = ["80 N/um", "50 N/um"]', "c", 0.1 * math.sqrt(25e9)),
        ('load = "-1 kN"', "normal_force", 3905.0),
        ('F_s = "981 N"\nF_k = "490.5 N"\nload = "4905 N"', "friction.mu_k", 0.05),
        ('F_s = "1 N m"\nF_k = "0.8 Nm"', "F_s", PER_TURN),
        ('F_s = "8 %"\nF_k = "6 %"', "F_k", 0.06 * 11.0 * PER_TURN),
        ('law = "stribeck"\nv_s = "5 mm/s"\nshape = "hyperbolic"', "friction.own",
         {"shape": 2.0, "v_s": 0.005}),
        ('B = 0.01\nt_0 = "1 ms"', "friction.own", {"B": 0.01, "t_0": 0.001}),
        ('viscous_friction = "2 mN m s/rad"', "drive.d", 0.002 * PER_TURN**2),
        ('dry_friction = "100 Ncm"', "drive.dry", PER_TURN),
        ('velocity_gain = "1.8 N m s/rad"', "drive.bandwidth", 300.0),
        ('encoder = "2500 lines/turn"', "drive.resolution_motor", 1e-6),
        ('kind = "rigid"', "drive", None),
        ("", "drive.inertia", 0.006 * (2.0 * math.pi / 0.01) ** 2),
        ("", "drive.T_n", 4.0 / 300.0),
        ("", "drive.T_s", 0.25e-3),
        (FILTERS, "drive.filters", READ),
        ('feeds = ["2 mm/s", "30 mm/min"]', "demand.feeds", (0.0005, 0.002)),
        ('mass = "500 kg ± 5 %"', "spread", {"axis.mass": 25.0}),
        ('mu_s = "0.25 +- 0.02"', "spread", {"friction.mu_s": 0.02}),
        ('stiffness = ["50 N/um ± 10 %", "80 N/um"]', "spread", {"axis.stiffness[1]": 5e6}),
    ],
)  # fmt: skip
def test_a_key_sets_its_field_in_si_at_the_slide(changes: str, field: str, value: object) -> None:
    found: object = axis_file_of(written(changes)).axis()
    for name in field.split("."):
        found = getattr(found, name)
    # Roundings of some conversions.
    rounded = isinstance(value, float) or field == "spread"
    assert found == (pytest.approx(value, rel=1e-14) if rounded else value)


@pytest.mark.parametrize(("more", "mu_s"), [("", 0.25), ("\nmu_s = 0.3", 0.3)])
def test_a_measured_curve_is_the_friction(more: str, mu_s: float, tmp_path: Path) -> None:
    curve = "speed [mm/s],force [N]\n0,1226.25\n10,490.5\n50,1471.5\n"
    (tmp_path / "way.csv").write_text(curve)
    file = tmp_path / "x.toml"
    with pytest.raises(AxisError, match=r"x\.toml: .*no such file"):
        read_axis_file(file).axis()
    file.write_text(written(f'curve = "way.csv"{more}'), encoding="utf-8")
    friction = read_axis_file(file).axis().friction
    assert friction.law == "stribeck"
    # Roundings of forces over the normal force.
    assert (friction.mu_s, friction.mu_k) == pytest.approx((mu_s, 0.10), rel=1e-12)
    assert friction.own["u_3"] == pytest.approx(0.05, rel=1e-12)


def test_a_changed_number_leaves_alone_what_the_file_states_beside_it() -> None:
    stiffer = {"axis.stiffness": 2e8}
    by_zeta = axis_file_of(written('zeta = "5 %"'))
    assert by_zeta.changed(stiffer).axis().c == pytest.approx(2.0 * by_zeta.axis().c)
    assert axis_file_of(written('c = "4 kN s/m"')).changed(stiffer).axis().c == 4000.0
    forces = axis_file_of(written('F_s = "981 N"\nF_k = "700 N"'))
    heavier = forces.changed({"axis.mass": 1000.0}).axis()
    assert (heavier.F_s, heavier.F_k) == pytest.approx((981.0, 700.0))
    overlap = axis_file_of(written('mu_s = "0.2 ± 0.02"\nmu_k = "0.19 ± 0.02"'))
    assert overlap.changed({"friction.mu_k": 0.21}).axis().friction.mu_k == 0.2
    with pytest.raises(KeyError):
        overlap.changed({"axis.load": 1.0})


FILTER = "[[drive.filter]]\nkind = "

REFUSALS = [
    # What is changed, or a file from its first section on; the line that is named; words.
    ('mass = "5 N"', 2, "is a force; expected a mass in kg, above 0"),
    ("feeds = [2]", 14, "demand.feeds[1] = 2 has no unit"),
    ('mass = "500 kg ± 500 kg"', 2, "out of range with its ±"),
    ('pitch = "10 mm ± 1 mm"', 8, "a ±, which is not allowed"),
    ('mass = "1,5 kg"', 2, "a comma where the decimal point"),
    ('mass = "nan kg"', 2, "not a finite number"),
    ("mu_k = 0.3", 6, "friction.mu_k = 0.3 is above static friction; expected at most 0.25"),
    ('F_s = "8 %"\nF_k = "6 %"\n-rated_torque', 7, "drive.rated_torque is missing"),
    ('load = "-5 kN"', 4, "lifts the table off its guideway"),
    ('c = "4 kN s/m"\nzeta = 0.05', 4, "stands beside zeta, which says the same"),
    ("-mass", 1, "axis.mass is missing; expected a mass in kg, above 0; write such as mass ="),
    ('law = "stribeck"', 4, "friction.v_s is missing"),
    ('law = "Stribek"', 7, 'expected one of "coulomb", "stribeck"; "stribeck" is the nearest'),
    ('K_v = "25 Hz"', 10, 'drive.K_v = "25 Hz" is an angular frequency'),
    ('curve = "none.csv"', 5, "is no friction curve: none.csv: no such file"),
    ('mass = "1e-300 kg"\nstiffness = "1e300 N/m"', 1, "numbers that do not go together"),
    (f'{FILTER}"low pass"\nfrequency = "2 kHz"', 16, "expected below 2000 Hz, half the sampling"),
    ("[drives]", 14, "drives is no section of an axis file; nearest: [drive]"),
    ("feed = 1", 14, "demand.feed = 1 is an unknown key; nearest: feeds"),
    ("[friction]\nmu_s = 0,2\n", 2, "a number has a decimal point, such as mu_s = 0.2"),
]


@pytest.mark.parametrize(("changes", "line", "words"), REFUSALS)
def test_what_is_wrong_is_named_in_one_line_with_its_place(
    changes: str, line: int, words: str
) -> None:
    is_file = changes.startswith(("[axis]", "[friction]", "[drive]"))
    with pytest.raises(AxisError) as refused:
        axis_file_of(changes if is_file else written(changes), "shop/x.toml").axis()
    assert str(refused.value).startswith(f"shop/x.toml: line {line}: ")
    assert words in str(refused.value)
    assert refused.value.line == line
    assert "\n" not in str(refused.value)
