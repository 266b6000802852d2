"""Axis files: what they say, what they assume, what they refuse."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from examples.feed_axis.axis import Axis as ServoAxis
from examples.feed_axis.designed import designed
from stickslip_design.axis import (
    Axis,
    AxisError,
    Demand,
    Drive,
    Friction,
    axis_file_of,
    axis_of,
    example,
    low_pass,
    notch,
    read_axis,
    template,
)
from stickslip_design.axis.keys import KEYS

RIGID = """\
[axis]
mass = "500 kg"
stiffness = "50 N/um"
[friction]
mu_s = 0.25
mu_k = 0.15
"""
DRIVE = """\
[drive]
pitch = "10 mm"
inertia = "60 kg cm2"
K_v = "25 1/s"
bandwidth = "300 1/s"
"""


def test_the_least_file_is_a_table_on_a_rigid_drive() -> None:
    """What it does not state is what the model takes without it."""
    axis = axis_of(RIGID, "shop/x.toml")
    assert axis == Axis(
        name="x", m=500.0, k=5e7, friction=Friction(mu_s=0.25, mu_k=0.15), assumed=axis.assumed
    )
    told = {each.key: each.value for each in axis.assumed}
    assert told["drive"] == "a rigid drive"
    assert told["axis.c"] == "0 N s/m"
    assert told["axis.gravity"] == "9.81 m/s2"
    assert "axis.zeta" not in told
    assert "friction.t_0" not in told


def test_a_drive_takes_the_defaults_of_the_model() -> None:
    """The defaults of the keys are those of `Drive`; each is told, with the integral time."""
    axis = axis_of(RIGID + DRIVE)
    inertia = 0.006 * (2.0 * math.pi / 0.01) ** 2
    drive = axis.drive
    assert drive is not None
    assert drive.inertia == pytest.approx(inertia, rel=1e-15)
    assert drive == Drive(
        inertia=drive.inertia, K_v=25.0, bandwidth=300.0, T_n=4.0 / 300.0, T_s=0.25e-3
    )
    told = {each.key for each in axis.assumed if each.key.startswith("drive")}
    unstated = {key.path for key in KEYS if key.section == "drive" and key.reason}
    assert told == unstated | {"drive.filter"}


def test_the_example_is_the_axis_of_the_documentation() -> None:
    """To the last bit, as the FMUs of the example have it."""
    axis, servo = axis_of(example()), ServoAxis()
    assert axis.drive == designed(servo).drive
    assert axis.block(servo.feed) == designed(servo).block(servo.feed)
    assert axis.demand == Demand(feeds=(5e-4, 2e-3, 5e-3), acceleration=servo.acceleration)


def test_the_template_has_every_key_and_is_read() -> None:
    """As it is; with each key that is commented out stated in turn; and on no line too long."""
    text = template()
    assert max(map(len, text.splitlines())) <= 100
    axis = axis_of(text)
    assert axis.drive is not None
    for key in KEYS:
        line = f"{key.name} = {key.example}\n"
        assert f"\n{line}" in text or f"\n# {line}" in text
        if f"\n{line}" not in text:
            _stated(text, key.path)


def _stated(text: str, path: str) -> Axis:
    """Read the template with a key stated, what it needs too, and without what it excludes."""
    section, name = path.rpartition(".")[::2]
    take, leave = {name}, set()
    if section == "drive.filter":
        take |= {"kind", "frequency"} | (set() if name == "damping" else {"width"})
        text = text.replace("# [[drive.filter]]", "[[drive.filter]]")
    if name in {"F_s", "F_k"}:
        take, leave = {"F_s", "F_k"}, {"mu_s", "mu_k"}
    if name == "t_0":
        take |= {"B"}
    if name in {"shape", "v_s", "delta"}:
        take |= {"law", "v_s"}
        text = text.replace('law = "coulomb"', 'law = "stribeck"')
    if name == "velocity_gain":
        leave = {"bandwidth"}
    lines, here = [], ""
    for line in text.splitlines():
        header = re.match(r"(?:# )?\[+([a-z.]+)\]+$", line)
        here = header[1] if header else here
        stated = line.partition(" =")[0].removeprefix("# ")
        if here == section and stated in take:
            line = line.removeprefix("# ")
        if here == section and stated in leave:
            continue
        lines.append(line)
    if name == "curve":
        with pytest.raises(AxisError, match=r"guideway\.csv"):
            axis_of("\n".join(each for each in lines if not each.startswith("mu_k")))
        return axis_of(text)
    axis = axis_of("\n".join(lines))
    assert path not in {re.sub(r"\[\d\]", "", each.key) for each in axis.assumed}
    return axis


@pytest.mark.parametrize(
    ("changes", "field", "value"),
    [
        ({"mass": '"0.5 t"'}, "m", 500.0),
        ({"stiffness": '["80 N/um", "50 N/um"]'}, "k", 5e7),
        ({"stiffness": '["80 N/um", "50 N/um"]'}, "stiffest", 8e7),
        ({"zeta": '"5 %"'}, "c", 0.1 * math.sqrt(5e7 * 500.0)),
        ({"zeta": "0.05"}, "c", 0.1 * math.sqrt(5e7 * 500.0)),
        ({"zeta": "0.05", "stiffness": '["80 N/um", "50 N/um"]'}, "c", 0.1 * math.sqrt(25e9)),
        ({"load": '"-1 kN"'}, "normal_force", 3905.0),
        ({"force_along": '"-300 N"'}, "along", -300.0),
        ({"F_s": '"981 N"', "F_k": '"490.5 N"'}, "F_s", 981.0),
        ({"F_s": '"981 N"', "F_k": '"490.5 N"', "load": '"4905 N"'}, "friction.mu_k", 0.05),
        ({"F_s": '"1 N m"', "F_k": '"0.8 Nm"'}, "F_s", 200.0 * math.pi),
        ({"F_s": '"8 %"', "F_k": '"6 %"'}, "F_s", 0.08 * 11.0 * 200.0 * math.pi),
        ({"F_s": '"8 %"', "F_k": '"6 %"'}, "F_k", 0.06 * 11.0 * 200.0 * math.pi),
        ({"law": '"stribeck"', "v_s": '"5 mm/s"'}, "friction.own", {"shape": 1.0, "v_s": 0.005}),
        (
            {"law": '"stribeck"', "v_s": '"5 mm/s"', "shape": '"hyperbolic"'},
            "friction.own",
            {"shape": 2.0, "v_s": 0.005},
        ),
        ({"B": "0.01", "t_0": '"1 ms"'}, "friction.own", {"B": 0.01, "t_0": 0.001}),
        ({"inertia": '"2400 kg"'}, "drive.inertia", 2400.0),
        ({"viscous_friction": '"1 kN s/m"'}, "drive.d", 1000.0),
        ({"viscous_friction": '"2 mN m s/rad"'}, "drive.d", 0.002 * (200 * math.pi) ** 2),
        ({"viscous_friction": '"1 Nm/(1/s)"'}, "drive.d", (200 * math.pi) ** 2),
        ({"dry_friction": '"100 Ncm"'}, "drive.dry", 200.0 * math.pi),
        ({"K_v": '"1.5 m/min/mm"'}, "drive.K_v", 25.0),
        ({"bandwidth": '"300 rad/s"'}, "drive.bandwidth", 300.0),
        ({"bandwidth": '"48 Hz"'}, "drive.bandwidth", 96.0 * math.pi),
        ({"velocity_gain": '"1.8 N m s/rad"'}, "drive.bandwidth", 300.0),
        ({"velocity_gain": '"3000 N s/m"', "inertia": '"1000 kg"'}, "drive.bandwidth", 3.0),
        ({"bandwidth": '"400 1/s"'}, "drive.T_n", 0.01),
        ({"integral_time": '"0 s"'}, "drive.T_n", 0.0),
        ({"encoder": '"1000000 counts/turn"'}, "drive.resolution_motor", 1e-8),
        ({"encoder": '"2500 lines/turn"'}, "drive.resolution_motor", 1e-6),
        ({"position": '"motor"'}, "drive.on_table", False),
        ({"limit": '"19 N m"'}, "drive.F_max", 19.0 * 200.0 * math.pi),
        ({"friction_feedforward": '"1 N m"'}, "drive.friction_feedforward", 200.0 * math.pi),
        ({"kind": '"rigid"'}, "drive", None),
        ({"feeds": '["2 mm/s", "30 mm/min"]'}, "demand.feeds", (0.0005, 0.002)),
        ({"feeds": '"30 mm/min"'}, "demand.feeds", (0.0005,)),
        ({"largest_jump": '"2 um"'}, "demand.largest_jump", 2e-6),
        ({"mass": '"500 kg ± 5 %"'}, "spread", {"axis.mass": 25.0}),
        ({"mass": '"500 kg +- 25 kg"'}, "spread", {"axis.mass": 25.0}),
        ({"mass": '"500 +/- 25 kg"'}, "spread", {"axis.mass": 25.0}),
        ({"mass": '"0.5 t ± 25 kg"'}, "spread", {"axis.mass": 25.0}),
        ({"mu_s": '"0.25 ± 0.02"'}, "spread", {"friction.mu_s": 0.02}),
        ({"mu_s": '"0.25 ± 10 %"'}, "spread", {"friction.mu_s": 0.025}),
        ({"zeta": '"5 % ± 1 %"'}, "spread", {"axis.zeta": 0.01}),
        ({"load": '"-1 kN ± 10 %"'}, "spread", {"axis.load": 100.0}),
        (
            {"stiffness": '["50 N/um ± 10 %", "80 N/um"]'},
            "spread",
            {"axis.stiffness[1]": 5e6},
        ),
    ],
)
def test_a_key_sets_its_field(changes: dict[str, str], field: str, value: object) -> None:
    """In SI, at the slide, as the model has it."""
    found: object = axis_of(written(changes))
    for name in field.split("."):
        found = getattr(found, name)
    if isinstance(value, float) or field == "spread":
        assert found == pytest.approx(value, rel=1e-14)
    else:
        assert found == value


SECTION_OF = {key.name: key.section for key in KEYS if key.section != "drive.filter"}
SECTION_OF["kind"] = "drive"
INSTEAD = {
    "F_s": {"mu_s"}, "F_k": {"mu_k"}, "velocity_gain": {"bandwidth"}, "curve": {"mu_s", "mu_k"},
}  # fmt: skip


def written(changes: dict[str, str], drop: tuple[str, ...] = (), more: str = "") -> str:
    """Return a file with keys stated as here, in place of those that they exclude."""
    keys: dict[str, dict[str, str]] = {
        "axis": {"mass": '"500 kg"', "stiffness": '"50 N/um"'},
        "friction": {"mu_s": "0.25", "mu_k": "0.15"},
        "drive": {
            "pitch": '"10 mm"', "inertia": '"60 kg cm2"', "K_v": '"25 1/s"',
            "bandwidth": '"300 1/s"', "rated_torque": '"11 N m"',
        },
        "demand": {},
    }  # fmt: skip
    for name, value in changes.items():
        for other in INSTEAD.get(name, ()):
            keys[SECTION_OF[name]].pop(other, None)
        keys[SECTION_OF[name]][name] = value
    return (
        "".join(
            f"[{section}]\n"
            + "".join(f"{name} = {value}\n" for name, value in own.items() if name not in drop)
            for section, own in keys.items()
        )
        + more
    )


def test_filters_stand_in_their_order() -> None:
    """A low pass without damping is of first order; a notch may be stated by its width."""
    text = written({}, more=(
        '[[drive.filter]]\nkind = "low pass"\nfrequency = "1 kHz"\n'
        '[[drive.filter]]\nkind = "low pass"\nfrequency = "800 Hz"\ndamping = 0.7\n'
        '[[drive.filter]]\nkind = "notch"\nfrequency = "400 Hz"\nwidth = "200 Hz"\n'
        '[[drive.filter]]\nkind = "notch"\nfrequency = "300 Hz"\ndamping = 0.5\nleaves = "10 %"\n'
    ))  # fmt: skip
    axis = axis_of(text)
    assert axis.drive is not None
    assert axis.drive.filters == (
        low_pass(1000.0), low_pass(800.0, 0.7), notch(400.0, 0.25), notch(300.0, 0.5, 0.1),
    )  # fmt: skip
    told = {each.key: each.value for each in axis.assumed if each.key.startswith("drive.filter")}
    assert told == {"drive.filter[1].damping": "first order", "drive.filter[3].leaves": "0"}


def test_the_width_of_a_notch_is_that_between_its_3_db_points() -> None:
    """At width = 2 damping frequency, for a full notch without samples."""
    damping, width = 0.25, 2.0 * 0.25 * 400.0
    upper = 0.5 * width + math.sqrt(400.0**2 + (0.5 * width) ** 2)
    for f in (upper, upper - width):
        s = 1j * f / 400.0
        assert abs((s * s + 1.0) / (s * s + 2.0 * damping * s + 1.0)) == pytest.approx(0.5**0.5)


def test_a_measured_curve_is_the_friction(tmp_path: Path) -> None:
    """Forces are divided by the normal force of the axis; what it leaves open is told."""
    (tmp_path / "way.csv").write_text("speed [mm/s],force [N]\n0,1226.25\n10,490.5\n50,735.75\n")
    file = tmp_path / "x.toml"
    file.write_text(written({"curve": '"way.csv"'}), encoding="utf-8")
    axis = read_axis(file)
    assert axis.friction.law == "stribeck"
    assert axis.friction.mu_s == pytest.approx(0.25)
    assert axis.friction.mu_k == pytest.approx(0.10)
    assert axis.friction.own == pytest.approx({
        "shape": 3, "n_points": 3, "mu_1": 0.25, "u_2": 0.01, "mu_2": 0.1, "u_3": 0.05,
        "mu_3": 0.15,
    })  # fmt: skip
    told = {each.key: each.value for each in axis.assumed if each.key.startswith("friction")}
    assert told == {"friction.mu_s": "0.25", "friction.mu_k": "0.1"}
    file.write_text(written({"curve": '"way.csv"', "mu_s": "0.3"}), encoding="utf-8")
    assert read_axis(file).friction.mu_s == 0.3
    file.write_text(written({"curve": '"way.csv"', "mu_s": "0.2"}), encoding="utf-8")
    with pytest.raises(AxisError, match=r"mu_1 = 0.25 is out of range; it must be <= mu_s = 0.2"):
        read_axis(file)


def test_static_friction_is_that_of_the_curve_at_rest(tmp_path: Path) -> None:
    """Also of a curve that rises: its highest friction is at a speed, not at the break-away."""
    (tmp_path / "way.csv").write_text("speed [mm/s],mu\n0,0.1\n10,0.08\n50,0.2\n")
    file = tmp_path / "x.toml"
    file.write_text(written({"curve": '"way.csv"'}), encoding="utf-8")
    assert read_axis(file).friction.mu_s == pytest.approx(0.1)


def test_a_changed_number_holds_what_the_file_states() -> None:
    """The damping ratio, or c; the forces; of a ± that overlaps the kinetic friction is capped."""
    stiffer = {"axis.stiffness": 2e8}
    by_zeta = axis_file_of(written({"zeta": "0.05"}))
    assert by_zeta.changed(stiffer).axis().c == pytest.approx(2.0 * by_zeta.axis().c)
    by_c = axis_file_of(written({"c": '"4 kN s/m"'}))
    assert by_c.changed(stiffer).axis().c == 4000.0
    forces = axis_file_of(written({"F_s": '"981 N"', "F_k": '"700 N"'}))
    heavier = forces.changed({"axis.mass": 1000.0}).axis()
    assert (heavier.F_s, heavier.F_k) == pytest.approx((981.0, 700.0))
    overlap = axis_file_of(written({"mu_s": '"0.2 ± 0.02"', "mu_k": '"0.19 ± 0.02"'}))
    assert overlap.changed({"friction.mu_k": 0.21}).axis().friction.mu_k == 0.2
    with pytest.raises(KeyError):
        overlap.changed({"axis.load": 1.0})


REFUSALS = [
    # What is changed, what is left out, what is added; the line that is named, and what is said.
    ({"mass": '"5 N"'}, (), "", 2, 'axis.mass = "5 N" is a force; expected a mass in kg, above 0'),
    ({"mass": '"500 kilo"'}, (), "", 2, "has the unknown unit 'kilo'"),
    (
        {"mass": "500"},
        (),
        "",
        2,
        'has no unit; expected a mass in kg, above 0; write the unit, such as mass = "500 kg"',
    ),
    ({"feeds": "[2]"}, (), "", 14, "demand.feeds[1] = 2 has no unit"),
    ({"mass": '"500"'}, (), "", 2, "has no unit"),
    ({"mass": '"0 kg"'}, (), "", 2, "is out of range; expected a mass in kg, above 0"),
    ({"mass": '"-5 kg"'}, (), "", 2, "is out of range"),
    ({"mass": '"500 kg ± 500 kg"'}, (), "", 2, "is out of range with its ±"),
    ({"mass": '"500 kg ± -5 kg"'}, (), "", 2, "has a negative ±"),
    ({"mass": '"500 kg ± 5 N"'}, (), "", 2, "is a force"),
    ({"mass": '"500 kg ± 1 kg ± 1 kg"'}, (), "", 2, "has more than one ±"),
    ({"pitch": '"10 mm ± 1 mm"'}, (), "", 8, "has a ±, which is not allowed here"),
    ({"mass": '"1,5 kg"'}, (), "", 2, "has a comma where the decimal point is expected"),
    ({"mass": '"nan kg"'}, (), "", 2, "is not a finite number"),
    ({"mass": '"1e999 kg"'}, (), "", 2, "is larger than a double can hold"),
    ({"mass": "true"}, (), "", 2, "axis.mass = true is not a number with a unit"),
    ({"mass": '["5 kg"]'}, (), "", 2, "is not a number with a unit"),
    ({"mu_s": "nan"}, (), "", 5, "is not a finite number"),
    ({"mu_s": "inf"}, (), "", 5, "is not a finite number"),
    ({"mu_s": "-0.1"}, (), "", 5, "is out of range"),
    ({"mu_s": '"0.2 N"'}, (), "", 5, "is a force; expected a plain number, at least 0"),
    ({"mu_s": "1" + "0" * 400}, (), "", 5, "is larger than a double can hold"),
    (
        {"mu_k": "0.3"},
        (),
        "",
        6,
        "friction.mu_k = 0.3 is above static friction; expected at most "
        "0.25; exchange the two if they are mixed up",
    ),
    (
        {"F_s": '"700 N"', "F_k": '"981 N"'},
        (),
        "",
        6,
        "above static friction; expected at most 700",
    ),
    (
        {"F_s": '"8"', "F_k": '"6 %"'},
        (),
        "",
        5,
        "has no unit; expected a force in N or a torque in N.m or percent of drive.rated_torque",
    ),
    (
        {"F_s": '"8 %"', "F_k": '"6 %"'},
        ("rated_torque",),
        "",
        7,
        "drive.rated_torque is missing; friction.F_s is stated in terms of it",
    ),
    (
        {"stiffness": '["1 N/um", "2 N/um", "3 N/um"]'},
        (),
        "",
        3,
        "has 3 values; expected one or two values",
    ),
    ({"stiffness": "[]"}, (), "", 3, "has 0 values"),
    (
        {"load": '"-5 kN"'},
        (),
        "",
        4,
        'axis.load = "-5 kN" lifts the table off its guideway: mass '
        "times gravity is 4905 N; expected above -4905 N",
    ),
    ({"c": '"4 kN s/m"', "zeta": "0.05"}, (), "", 4, "axis.c = "),
    ({"c": '"4 kN s/m"', "zeta": "0.05"}, (), "", 4, "stands beside zeta, which says the same"),
    ({"F_s": '"981 N"', "mu_s": "0.25"}, (), "", 7, "stands beside F_s, which says the same"),
    ({"F_s": '"981 N"'}, (), "", 5, "friction.mu_k = 0.15 stands beside F_s"),
    ({"velocity_gain": '"1 N m s"', "bandwidth": '"3 1/s"'}, (), "", 13, "stands beside velocity_"),
    (
        {},
        ("mass",),
        "",
        1,
        'axis.mass is missing; expected a mass in kg, above 0; write such as mass = "500 kg"',
    ),
    ({}, ("mu_k",), "", 4, "friction.mu_k is missing, or F_k or curve in its place"),
    ({}, ("inertia",), "", 7, "drive.inertia is missing"),
    ({}, ("bandwidth",), "", 7, "drive.bandwidth is missing, or velocity_gain in"),
    ({"law": '"stribeck"'}, (), "", 4, "friction.v_s is missing"),
    (
        {"v_s": '"5 mm/s"'},
        (),
        "",
        7,
        'friction.v_s = "5 mm/s" goes with law = "stribeck" only; '
        'state law = "stribeck", or leave v_s out',
    ),
    ({"t_0": '"5 ms"'}, (), "", 7, "goes with B only"),
    (
        {"law": '"lugre"'},
        (),
        "",
        7,
        'is none of the choices; expected one of "coulomb", "stribeck"',
    ),
    ({"law": '"Stribek"'}, (), "", 7, '"stribeck" is the nearest'),
    ({"name": "5"}, (), "", 4, "axis.name = 5 is not a text"),
    ({"name": '" "'}, (), "", 4, "is not a text"),
    ({"K_v": '"25 Hz"'}, (), "", 10, 'drive.K_v = "25 Hz" is an angular frequency'),
    ({"K_v": '"0 1/s"'}, (), "", 10, "is out of range"),
    ({"kind": '"linear motor"'}, (), "", 13, 'drive.kind = "linear motor" is not computed yet'),
    ({"kind": '"rack"'}, (), "", 13, "is not computed yet"),
    (
        {"curve": '"none.csv"'},
        (),
        "",
        5,
        'friction.curve = "none.csv" is no friction curve: none.csv: no such file',
    ),
    ({"inertia": '"1e300 kg m2"', "pitch": '"1e-9 mm"'}, (), "", 9, "larger than a double"),
    (
        {"mass": '"1e-300 kg"', "stiffness": '"1e300 N/m"'},
        (),
        "",
        1,
        "axis has numbers that do not go together: k = 1e+300 N/m",
    ),
    (
        {},
        (),
        '[[drive.filter]]\nkind = "notch"\nfrequency = "400 Hz"\n',
        14,
        "drive.filter[1].damping is missing, or width in its place",
    ),
    ({}, (), '[[drive.filter]]\nkind = "notch"\n', 14, "drive.filter[1].frequency is missing"),
    (
        {},
        (),
        '[[drive.filter]]\nkind = "low pass"\nfrequency = "2 kHz"\n',
        16,
        "is out of range; expected below 2000 Hz, half the sampling frequency",
    ),
    (
        {},
        (),
        '[[drive.filter]]\nkind = "low pass"\nfrequency = "400 1/s"\n',
        16,
        "is a rate; expected a frequency in Hz",
    ),
    (
        {},
        (),
        '[[drive.filter]]\nkind = "low pass"\nfrequency = "1 Hz"\n[[drive.filter]]\n'
        'kind = "low pass"\nfrequency = "1 Hz"\nleaves = 0.1\n',
        20,
        "drive.filter[2].leaves",
    ),
    ({}, (), "[drive.filter]\n", 14, "is no section; write [[drive.filter]] on a line"),
    (
        {},
        (),
        "[drives]\n",
        14,
        "drives is no section of an axis file; expected [axis], [friction], "
        "[drive], [demand]; [drive] is the nearest",
    ),
    ({}, (), "[[axes]]\n", 14, "axes is no section of an axis file"),
    ({}, (), "feed = 1\n", 14, "demand.feed is an unknown key; nearest: feeds"),
    ({}, (), 'mass = "5 kg"\n', 14, "demand.mass is an unknown key; mass stands in [axis]"),
    ({}, (), "xyzzy = 1\n", 14, "[demand] has feeds, acceleration, largest_jump, largest_error"),
]


@pytest.mark.parametrize(("changes", "drop", "more", "line", "told"), REFUSALS)
def test_what_is_wrong_is_named_with_line_range_and_remedy(
    changes: dict[str, str], drop: tuple[str, ...], more: str, line: int, told: str
) -> None:
    """One line of text; the line is where it stands in the file."""
    text = written(changes, drop, more)
    with pytest.raises(AxisError) as caught:
        axis_of(text, "shop/x.toml")
    message = str(caught.value)
    assert told in message
    assert message.startswith(f"shop/x.toml: line {line}: ")
    assert caught.value.line == line
    assert "\n" not in message


@pytest.mark.parametrize(
    ("text", "line", "told"),
    [
        ("", 1, "axis is missing; write a section [axis]"),
        ("[axis]\nmass = 500 kg\n", 2, "is not TOML: "),
        ('[axis]\nmass = "1 kg"\nmass = "2 kg"\n', 3, "is not TOML: cannot overwrite a value"),
        ("[axis]\nmass = [\n", 2, "is not TOML: "),
        ('mass = "5 kg"\n', 1, 'mass = "5 kg" stands outside a section; write it below [axis]'),
        ("\naxis = 5\n", 2, "axis = 5 is no section; write [axis] on a line of its own"),
        ("[axis]\nM = 5\n", 2, "axis.M is an unknown key; nearest: mass"),
        ("[axis]\nk = 5\n", 2, "nearest: stiffness"),
        ("[axis]\nstifness = 5\n", 2, "nearest: stiffness"),
        ("[drive]\nT_n = 5\n", 2, "nearest: integral_time"),
        ("[drive]\nKp = 5\n", 2, "nearest: velocity_gain"),
        ("[drive]\nlead = 5\n", 2, "nearest: pitch"),
        ("[friction]\nmu_s = 0,2\n", 2, "a number has a decimal point, such as mu_s = 0.2"),
        ("[drive]\nJ = 5\n", 2, "nearest: inertia"),
        ("[drive]\nkv = 5\n", 2, "nearest: K_v"),
        ('axis.mass = "5 N"\n', 1, "is a force"),
        ('[axis]\n"mass" = "5 N"\n', 2, "is a force"),
        ("drive = { filter = [ 5 ] }\n", 1, "drive.filter[1] = 5 is no section"),
    ],
)
def test_what_is_wrong_with_a_text_is_named(text: str, line: int, told: str) -> None:
    """Keys by other names find the right one: symbols, wrong case, slips of the pen."""
    with pytest.raises(AxisError) as caught:
        axis_of(text)
    assert told in str(caught.value)
    assert caught.value.line == line


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    """It is not there, it is a folder, or no text."""
    file = tmp_path / "x.toml"
    with pytest.raises(AxisError, match=r"x\.toml: cannot be read: no such file"):
        read_axis(file)
    file.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(AxisError, match=r"x\.toml: is no text in UTF-8; save the file as UTF-8"):
        read_axis(file)
    with pytest.raises(AxisError, match="is a directory"):
        read_axis(tmp_path)
    file.write_text("\ufeff" + RIGID, encoding="utf-8")
    assert read_axis(file).name == "x"
