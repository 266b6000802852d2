"""Screw, belt and rotary table: what their keys give, in which units, and what is refused."""

import math
import re
from functools import cache
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

import stickslip as ss
from stickslip.judgements import Design
from stickslip.systems import Move, start_values
from stickslip_design.axis import TEMPLATES, Axis, AxisError, axis_file_of, read_axis_file, template
from stickslip_design.axis.keys import KEYS
from stickslip_design.loop.critical import critical_feed, jumps_of
from stickslip_design.loop.rest import hunting, limit_from_rest
from stickslip_design.study import design
from stickslip_design.verdict import Verdict

AXES = Path(__file__).parents[2] / "examples" / "axes"
LOOP = 'inertia = "60 kg cm2"\nK_v = "25 1/s"\nbandwidth = "300 1/s"\n'
SLIDE = '[axis]\nmass = "500 kg"\n[friction]\nmu_s = 0.2\nmu_k = 0.15\n[drive]\n' + LOOP
SCREW = SLIDE + 'pitch = "10 mm"\ncore_diameter = "30 mm"\n'
BELT = SLIDE + 'kind = "belt"\nspecific_stiffness = "1 MN"\nbelt_length = "5 m"\n'
TEETH = 'teeth = 15\ntooth_pitch = "10 mm"\n'
A_E = 0.25 * math.pi * 0.03**2 * 206e9
"""Section times modulus of a screw of 30 mm [N]."""
FIXED, FREE = ('fixing = "fixed-fixed"\nbearing_distance = "1.2 m"\n', 'fixing = "fixed-free"\n')
ROUNDED = 1e-12
"""Some roundings of a double, times the condition of a closed loop."""


@cache
def judged(name: str) -> Verdict:
    return design(read_axis_file(AXES / f"{name}.toml"))


def figures(axis: Axis) -> tuple[float, ...]:
    jumps, hunts, acceleration = jumps_of(axis, 5e-4), hunting(axis), axis.demand.acceleration
    assert jumps
    assert hunts
    assert acceleration
    limits = critical_feed(axis), limit_from_rest(axis, acceleration, 0.01)
    return (*axis.demand.feeds, acceleration, *limits, jumps.way, hunts.jump)


def axis_of(text: str) -> Axis:
    return axis_file_of(text).axis()


@pytest.mark.parametrize(
    ("text", "least", "stiffest"),
    [
        (SCREW + FREE + 'free_length = "0.5 m"', A_E / 0.5, None),
        (SCREW + FREE + 'free_length = ["1 m", "0.5 m"]', A_E, A_E / 0.5),
        # Held at both ends a screw, as a belt, is softest in the middle, which is no end of travel.
        (SCREW + FIXED + 'free_length = ["0.3 m", "1 m"]', 4.0 * A_E / 1.2, A_E * (5.0 + 1.0)),
        (SCREW + FREE + 'free_length = "0.5 m"\nin_series = "100 N/um"',
         1.0 / (0.5 / A_E + 1e-8), None),
        (BELT + TEETH + 'strand = "2.5 m"', 4e6 / 5.0, None),
        (BELT + TEETH + 'strand = ["1 m", "4.5 m"]', 4e6 / 5.0, 1e6 * (1.0 / 4.5 + 1.0 / 0.5)),
        (BELT + TEETH + 'strand = ["0.5 m", "2 m"]', 1e6 * (1.0 / 2.0 + 1.0 / 3.0),
         1e6 * (1.0 / 0.5 + 1.0 / 4.5)),
    ],
)  # fmt: skip
def test_stiffness_over_the_travel_is_that_of_its_parts(
    text: str, least: float, stiffest: float | None
) -> None:
    axis = axis_of(text)
    assert axis.k == pytest.approx(least, rel=ROUNDED)
    assert axis.stiffest == (stiffest if stiffest is None else pytest.approx(stiffest, rel=ROUNDED))


@pytest.mark.parametrize(
    ("keys", "way"),
    [
        (TEETH, 0.15), (TEETH + "gear = 5\n", 0.03), ('pitch = "150 mm"\n', 0.15),
        ('pulley_diameter = "100 mm"\ngear = 2', 0.05 * math.pi),
    ],
)  # fmt: skip
def test_a_belt_takes_what_is_stated_at_the_motor_to_the_slide(keys: str, way: float) -> None:
    drive = axis_of(f'{BELT}strand = "1 m"\n{keys}').drive
    assert drive is not None
    assert drive.pitch == pytest.approx(way, rel=ROUNDED)
    assert drive.inertia == pytest.approx(0.006 * (2.0 * math.pi / way) ** 2, rel=ROUNDED)


def test_a_rotary_table_of_radius_1_m_is_the_slide_of_the_same_numbers() -> None:
    feeds = '[demand]\nfeeds = ["0.5 mm/s", "5 mm/s"]\nacceleration = "0.1 m/s2"\n'
    slide = (
        SLIDE + 'pitch = "10 mm"\ndry_friction = "0.1 N m"\nencoder = "2500 lines/turn"\n' + feeds
    )
    slide = slide.replace("[friction]", 'stiffness = "40 N/um"\nload = "1 kN"\n[friction]')
    table = slide.replace('pitch = "10 mm"', f'kind = "rotary"\ngear = {200.0 * math.pi!r}')
    table = table.replace("N/um", "MN m/rad").replace("mm/s", "mrad/s").replace("m/s2", "rad/s2")
    table = table.replace("mu_s", 'radius = "1 m"\nmu_s').replace(
        "[axis]", '[axis]\ninertia = "500 kg m2"'
    )
    one, other = axis_of(slide), axis_of(table)
    assert other.turns
    assert figures(other) == pytest.approx(figures(one), rel=ROUNDED)


@pytest.mark.parametrize("kind", TEMPLATES)
def test_the_template_of_a_kind_is_judged_as_it_is_and_has_all_its_keys(kind: str) -> None:
    text = template(kind)
    assert design(axis_file_of(text)).stable
    for key in filter(lambda key: key.fits(kind), (key.of(kind) for key in KEYS.values())):
        assert f"\n{key.name} = {key.example}" in text.replace("\n# ", "\n"), key.path


def test_a_rotary_table_is_told_in_degrees_and_newton_metres() -> None:
    found = Design(judged("rotary_table"))
    assert "from 0.246°/s on it cannot" in found.verdict.sentence
    units = found.to_dict()["units"]
    assert (units["jump"], units["critical_feed"], units["k"]) == ("rad", "rad/s", "N.m/rad")
    changed = found.to_dict()["measures"][0]["changes"][0]
    assert (changed["number"], changed["unit"]) == ("friction.T_s", "N.m")
    numbers = re.sub(r"<[^>]+>", " ", found.html()).partition("Numbers of the axis")[2]
    console = Console(width=300, record=True, file=StringIO())
    console.print(found.table())
    for told in (console.export_text(), numbers):
        assert re.search(r"\b18( → 0)? N·m", told)
        # But of the contact of a way, whose give is a length.
        assert not re.search(r"\d (mm|µm|N|kg|N/µm)(/s)?\b(?!·| did| m)", told)


@pytest.mark.gate
def test_a_measure_is_of_its_kind_of_drive() -> None:
    belt, table = judged("belt_gantry"), judged("rotary_table")
    offered = {name for one in belt.measures for name in one.ids}
    assert "wider-belt" in offered
    for found in (belt, table):
        assert {"larger-screw", "fixed-fixed"} <= set(found.left_out["does not apply"])
    assert {"wider-belt", "rolling-way"} <= set(table.left_out["does not apply"])


ROTARY = '[axis]\ninertia = "4 kg m2"\nstiffness = "4 MN m/rad"\n[friction]\nT_s = "6 N m"\n' \
    'T_k = "5 N m"\n[drive]\nkind = "rotary"\ngear = 90\n' + LOOP  # fmt: skip


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('[drive]\nkind = "rack"', "have backlash, or two pinions and their preload.*rigid"),
        ('[drive]\nkind = "linear motor"', "no spring is between motor and slide.*rigid"),
        ('[drive]\nkind = "cylinder"', "no spring of oil .* and no flow through a valve.*rigid"),
        (BELT + TEETH, "drive.strand is missing"),
        (SCREW.replace("pitch", 'kind = "rigid"\npitch'), "axis.stiffness is missing"),
        (BELT + TEETH + 'strand = "5 m"', "drive.strand = .* leaves nothing of the other side"),
        (BELT + 'strand = "1 m"', "drive.pitch is missing, or pulley_diameter or teeth in its"),
        (SCREW + FREE + 'free_length = "1 m"\n' + TEETH, "drive.teeth = 15 goes with drive.kind"),
        (SLIDE + 'pitch = "10 mm"', "axis.stiffness is missing, or drive.core_diameter in its"),
        (SCREW.replace("[fri", 'stiffness = "40 N/um"\n[fri'),
         "axis.stiffness = .* stands beside drive.core_diameter, which says the same"),
        (ROTARY.replace("T_s", "F_s"), "friction.F_s = .* goes with drive.kind ="),
        (ROTARY + '[demand]\nfeeds = ["1 mm/s"]', "is a velocity; .* in rad/s"),
        (ROTARY.replace("5 N m", "7 N m"), "T_k = .* at most 6 N m at the table"),
    ],
)  # fmt: skip
def test_keys_of_another_kind_and_what_is_not_modelled_are_refused_in_one_line(
    text: str, words: str
) -> None:
    with pytest.raises(AxisError, match=words) as refused:
        axis_of(text)
    assert "\n" not in str(refused.value)


def test_what_shows_mm_and_newtons_alone_refuses_a_rotary_table() -> None:
    file = AXES / "rotary_table.toml"
    with pytest.raises(AxisError, match='"rotary" is not for a scatter'):
        ss.scatter(file)
    with pytest.raises(AxisError, match='"rotary" is not for a map'):
        ss.map({"axis.inertia": [1.0, 2.0], "axis.zeta": [0.01, 0.02]}, axis=file)
    with pytest.raises(ValueError, match="no units in common"):
        ss.compare([file, AXES / "hydrostatic_guide.toml"])
    with pytest.raises(ValueError, match="the FMUs are of a slide"):
        start_values(read_axis_file(file).axis(), Move(1e-3))
