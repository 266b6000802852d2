"""What a record told, as people get it: the axis file, the sentence on the axis, the page."""

import io
import json
import math
import random
import re
import shutil
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from rich.console import Console

from stickslip.identified import Identification
from stickslip.show.tables import identified_summary
from stickslip.systems import Move, driver_of, start_values
from stickslip_design.axis import (
    AxisError,
    AxisFile,
    axis_file_of,
    example,
    read_axis_file,
    template,
)
from stickslip_design.axis import Number as Stated
from stickslip_design.identify.axis_text import axis_of, rounded, written
from stickslip_design.identify.model import Curve, Identified, Number, Residual, Trace
from stickslip_design.identify.report import data, html, scaled, sentence
from stickslip_design.measures.moving import with_number
from stickslip_design.study import design
from stickslip_units import per_minute
from tests.conftest import Sized
from tests.design.axes import DRIVE
from tests.examples.coupled import simulate

if TYPE_CHECKING:
    from playwright.sync_api import Browser

UNITS = {"mass": "kg", "c": "N.s/m", "stiffness": "N/m", "force_along": "N"}
FILE = axis_file_of(example())
SCREW = axis_file_of(
    example().replace('stiffness = "40 N/um"\n', "").replace(
        "[drive]", '[drive]\ncore_diameter = "33 mm"\nfixing = "fixed-fixed"\n'
        'free_length = ["0.3 m", "0.9 m"]\nbearing_distance = "1.2 m"',
    )
)  # fmt: skip
RIGID = {"axis.mass": 500.0, "axis.stiffness": 4e7, "axis.c": 4e3, "friction.F_s": 981.0}


def told(values: dict[str, float], part: float = 0.02, **changes: Any) -> Identified:
    """Return what a record tells that has these numbers to a part of them."""
    t = np.linspace(0.0, 20.0, 500)
    way = 0.1 * np.sin(t)
    off = way + 1e-6 * np.sin(1e4 * t)
    speed = np.array([-0.1, -0.01, 0.01, 0.1])
    force = 20.0 * np.sign(speed) + 200.0 * speed
    return Identified(**{
        "kind": "excitation", "reason": "the speed changes all the time",
        "numbers": tuple(
            Number(
                name=name, meaning="a number", unit=UNITS.get(name.rpartition(".")[2], "N"),
                value=value, low=value - part * abs(value), high=value + part * abs(value),
            )
            for name, value in values.items()
        ),
        "missing": (("the stiffness", "the motion is too slow"),),
        "residual": Residual(rms=1.0, unit="N", memory=0.0),
        "traces": (Trace(name="position", unit="m", t=t, measured=off, fitted=way),) * 2,
        "segments": ((0.0, 10.0, "forward"), (10.0, 20.0, "back")),
        "curve": Curve(speed=speed, force=force, band=0.1 * force**2, law="two", fitted=force),
        "next_measurement": "Measure at 1 mm/min.",
        **changes,
    })  # fmt: skip


def value_of(text: str, path: str) -> Stated:
    value = axis_file_of(text).values[path]
    assert isinstance(value, Stated)
    return value


@pytest.mark.parametrize(
    ("value", "half", "shown"),
    [
        (95.1089, 0.4312, ("95.11", "0.44")),
        (1234.5, 67.0, ("1234", "67")),
        (98765.0, 1010.0, ("98800", "1100")),
        (0.0218, 0.00031, ("0.02180", "0.00031")),
        (-0.2, 0.3, ("-0.20", "0.30")),
    ],
)
def test_a_value_is_cut_to_its_interval_which_is_never_narrowed(
    value: float, half: float, shown: tuple[str, str]
) -> None:
    assert rounded(value, half) == shown


def test_only_the_lines_of_numbers_that_the_record_tells_change() -> None:
    text = written(told({"axis.mass": 512.3, "axis.c": 3456.0}), FILE, "run.csv")
    changed = {line for line in text.splitlines() if not line.startswith("#: ")}
    assert changed ^ {*example().splitlines()} == {
        'mass = "500 kg"', '# mass = "500 kg"', 'mass = "512 kg ± 11 kg"  # run.csv, 95 %',
        'c = "4 kN s/m"', '# c = "4 kN s/m"', 'c = "3456 N·s/m ± 70 N·s/m"  # run.csv, 95 %',
    }  # fmt: skip
    again = written(told({"axis.mass": 500.0}), axis_file_of(text), "other.csv")
    assert again.count("#: identified") == 1
    assert value_of(again, "axis.c") == value_of(text, "axis.c")


def test_friction_is_written_as_the_file_states_it() -> None:
    forces = told({"friction.F_s": 900.0, "friction.F_k": 700.0})
    text = written(forces, FILE, "run.csv")
    for which, force in (("s", 900.0), ("k", 700.0)):
        stated = value_of(text, f"friction.mu_{which}")
        # To two digits of the interval.
        assert stated.value == pytest.approx(force / (500.0 * 9.81), abs=0.05 * stated.spread)
    # A weight that the record tells widens them: both are 2 %.
    both = told({"axis.mass": 600.0, "friction.F_s": 900.0, "friction.F_k": 700.0})
    stated = value_of(written(both, FILE, "run.csv"), "friction.mu_s")
    assert stated.spread / stated.value == pytest.approx(0.02 * math.sqrt(2.0), rel=0.06)
    newtons = axis_file_of(example().replace("mu_s = 0.20", 'F_s = "9 kN"').replace(
        "mu_k = 0.15", 'F_k = "0.8 kN"'
    ))  # fmt: skip
    text = written(forces, newtons, "run.csv")
    assert 'F_s = "900 N ± 18 N"  # run.csv, 95 %' in text.splitlines()


def test_static_friction_that_is_not_in_the_record_is_that_of_the_file_or_missing() -> None:
    kinetic = told({"friction.F_k": 700.0})
    text = written(kinetic, FILE, "run.csv")
    assert "#: static friction is not in this record: friction.mu_s of the file is held" in text
    above = written(told({"friction.F_k": 1100.0}), FILE, "run.csv")
    assert sentence(above, "axis.toml").startswith(
        "These numbers are not enough for a verdict: friction."
    )


def test_a_position_alone_and_the_mass_of_the_file_make_an_axis() -> None:
    file = axis_file_of(example().replace('"500 kg"', '"500 kg ± 3 %"'))
    text = written(told({"k/m": 8e4, "c/m": 8.0, "gap": 6e-6}, 0.04), file, "run.csv")
    for path, value, part in (("axis.stiffness", 4e7, 0.05), ("axis.c", 4e3, 0.05)):
        stated = value_of(text, path)
        assert (stated.value, stated.spread) == pytest.approx((value, part * value), rel=0.02)
    # The gap is 240 N of 4905: 0.0489 beside mu_k = 0.15, to 4 % of it and 5 % of the stiffness.
    static = value_of(text, "friction.mu_s")
    assert static.value == pytest.approx(0.15 + 240.0 / 4905.0, abs=0.05 * static.spread)
    assert static.spread == pytest.approx(math.hypot(0.04, 0.05) * 240.0 / 4905.0, rel=0.05)
    forces = written(told({"F_s - F_k": 245.25}), FILE, "run.csv")
    assert value_of(forces, "friction.mu_s").value == pytest.approx(0.2, abs=1e-4)


def test_without_a_file_a_rigid_axis_says_what_is_missing() -> None:
    text = written(told({"axis.mass": 500.0, "friction.F_k": 736.0}), None, "run.csv")
    assert 'missing: axis.stiffness, such as stiffness = "40 N/um"' in text
    assert "missing: friction.F_s, such as" in text
    assert "axis.stiffness is missing" in sentence(text, "axis.toml")
    full = written(told(RIGID | {"friction.F_k": 736.0}), None, "run.csv")
    axis = axis_file_of(full).axis()
    assert (axis.m, axis.k, axis.drive) == (500.0, 4e7, None)
    assert axis.spread["axis.stiffness"] == pytest.approx(8e5)
    assert "This axis can judder" in sentence(full, "axis.toml")


@pytest.mark.parametrize(
    ("name", "ends", "stated"),
    [
        ("axis.mass", (300.0, 800.0), (550.0, 250.0)),
        ("axis.c", (-1000.0, 9000.0), (4500.0, 4500.0)),
        ("axis.c", (0.0, 2020.0), (1100.0, 1100.0)),
        ("axis.mass", (1.0, 800.0), (500.0, 0.0)),
        ("axis.mass", (-10.0, 800.0), (500.0, 0.0)),
        ("axis.mass", (100.0, math.inf), (500.0, 0.0)),
    ],
)
def test_what_is_not_identified_goes_in_as_its_range_or_not_at_all(
    name: str, ends: tuple[float, float], stated: tuple[float, float]
) -> None:
    found = told({name: 500.0})
    wide = replace(found.numbers[0], low=ends[0], high=ends[1])
    assert not wide.identified
    text = written(replace(found, numbers=(wide,)), FILE, "run.csv")
    value = value_of(text, name)
    assert (value.value, value.spread) == pytest.approx(stated)
    assert ("not identified: a range" in text) == (stated[1] > 0.0)
    assert ("it is not in the range of the key" in text) == (stated[1] == 0.0)
    rigid = axis_file_of(written(replace(found, numbers=(wide,)), None, "run.csv"))
    assert (name in rigid.values) == (stated[1] > 0.0)


def test_a_measured_stiffness_takes_the_place_of_the_screw_that_it_was_computed_from() -> None:
    text = written(told({"axis.stiffness": 9e7}), SCREW, "run.csv")
    assert axis_file_of(text).axis().k == 9e7
    assert '\n# core_diameter = "33 mm"\n# fixing = "fixed-fixed"\n# free_length' in text


@pytest.mark.parametrize("file", [FILE, SCREW, axis_file_of(template("belt")), None])
def test_whatever_a_record_tells_the_file_can_be_read(file: AxisFile | None, sized: Sized) -> None:
    draw = random.Random(1)
    names = [f"friction.{each}" for each in ("F_s", "F_k", "mu_s", "mu_k")]
    names += ["axis.mass", "axis.c", "axis.stiffness", "k/m", "c/m", "gap", "F_s - F_k", "offset"]
    for _ in range(sized(500)):
        values = {
            name: draw.choice([1.0, 1.0, 1.0, -1.0, 0.0]) * 10.0 ** draw.uniform(-9.0, 9.0)
            for name in draw.sample(names, 6)
        }
        text = written(told(values, 10.0 ** draw.uniform(-6.0, 1.0)), file, "run.csv")
        assert "axis.mass" in axis_file_of(text).values or file is None


def test_tables_from_python_and_sections_in_a_line_get_a_line_for_each_key() -> None:
    tables = tomllib.loads(example())
    tables["drive"]["filter"] = [{"kind": "low pass", "frequency": "800 Hz"}] * 2
    inline = "\n".join(f"{name} = {as_toml(table)}" for name, table in tables.items())
    for file in (read_axis_file(tables), axis_file_of(inline)):
        stated = dict(axis_file_of(written(told({"axis.mass": 700.0}), file, "run.csv")).values)
        assert stated.pop("axis.mass") == Stated(700.0, "kg", 14.0)
        assert stated == {path: v for path, v in file.values.items() if path != "axis.mass"}


def as_toml(value: Any) -> str:
    if isinstance(value, dict):
        return f"{{{', '.join(f'{name} = {as_toml(each)}' for name, each in value.items())}}}"
    if isinstance(value, list):
        return f"[{', '.join(map(as_toml, value))}]"
    return json.dumps(value)


def test_an_axis_whose_friction_is_sought_has_none_and_a_rotary_table_is_refused() -> None:
    bare = re.sub(r"\[friction\]\n.*\n.*\n", "", example())
    assert (axis_of(axis_file_of(bare)).F_s, axis_of(FILE).F_s) == (0.0, 981.0)
    kinetic = axis_of(axis_file_of(example().replace("mu_s = 0.20\n", "")))
    assert kinetic.friction.mu_s == kinetic.friction.mu_k == 0.15
    rotary = Path(__file__).parents[2] / "examples" / "axes" / "rotary_table.toml"
    with pytest.raises(AxisError, match="is not for identification, which is in mm and N"):
        axis_of(read_axis_file(rotary))


def test_the_scale_of_the_force_widens_forces_and_masses_alone() -> None:
    found = told({"axis.mass": 500.0, "c/m": 2.0}, part=0.03)
    found = replace(found, numbers=(found.numbers[0], replace(found.numbers[1], unit="1/s")))
    wide = scaled(found, 0.04).numbers
    assert wide[0].width == pytest.approx(0.05)
    assert (wide[0].why, wide[1]) == ("± 4 % of the force's scale", found.numbers[1])
    # The motor takes four times the force of the table: 4 % of both are 20 % of the table.
    (motor, _) = scaled(found, 0.04, replace(DRIVE, inertia=2000.0)).numbers
    assert motor.width == pytest.approx(math.hypot(0.03, 0.2))


def asked(part: float) -> tuple[Identified, str]:
    found = told(RIGID | {"friction.F_k": 736.0}, part)
    file = axis_file_of(re.sub(r"feeds = .*", 'feeds = ["30 mm/min"]', example()))
    return found, written(found, file, "run.csv")


@pytest.mark.gate
def test_the_sentence_says_how_surely_the_axis_jumps_and_what_ends_that() -> None:
    _, text = asked(0.02)
    shares = {
        f"{one.name} ({one.effort})": 100 * one.robustness.clean // one.robustness.machines
        for one in design(axis_file_of(text)).measures
        if one.robustness
    }
    least, surest = next(iter(shares)), max(shares, key=lambda name: shares[name])
    assert shares[least] < shares[surest] == 100
    assert sentence(text, "axis.toml") == (
        "With these numbers the axis jumps at 30 mm/min in 100 % of what their ± allow; "
        f"{least} ends that in {shares[least]} %, {surest} ends that in 100 %."
    )
    even = re.sub(r"feeds = .*", 'feeds = ["600 mm/min"]', text)
    assert "moves evenly at its feeds in 100 % of" in sentence(even, "axis.toml")


@pytest.mark.gate
def test_the_fmus_jump_at_that_feed_before_the_measure_and_do_not_after(
    fmu_path: Path, tmp_path: Path
) -> None:
    shutil.copy(fmu_path, tmp_path / "StickSlip.fmu")
    driver_of("drive", tmp_path)
    verdict = design(axis_file_of(asked(0.02)[1]))
    (feed,), best = verdict.axis.demand.feeds, verdict.best
    assert per_minute(feed) == "30.0"
    assert best is not None
    after = verdict.axis
    for change in best.changes:
        after = with_number(after, change.number, change.then)
    rests = []
    for axis in (verdict.axis, after):
        way = simulate(tmp_path, start_values(axis, Move(feed)), 2.0)["table.x"]
        # The second half: the table was at rest before it broke away.
        rests.append(int(np.sum(np.diff(way[len(way) // 2 :]) == 0.0)))
    # It stands half the time: 4,000 samples of 0.25 ms.
    assert rests[0] > 1000
    assert rests[1] == 0


def words_in(page: str) -> str:
    plain = re.sub(r"<style>.*?</style>|<svg.*?</svg>|<title>.*?</title>", " ", page, flags=re.S)
    return " ".join(re.sub(r"<[^>]*>", " ", plain).split())


def test_the_page_has_all_that_was_found_and_asks_for_nothing() -> None:
    found = told({"axis.mass": 512.3}, notes=("<b>Directions</b> differ.",))
    page = html(found, "run.csv", "It jumps.")
    assert not re.search(r"https?:|<script|<link|<img|@import|url\((?!#)|<b>", page)
    for words in (
        "run.csv explained It jumps. Record excitation: the speed changes all the time",
        "axis.mass a number 512 kg 502 523 2 %",
        "it leaves noise of 1.00 N, white. Next Measure at 1 mm/min.",
        "the stiffness: the motion is too slow",
    ):
        assert words in words_in(page)
    faulty = replace(found, residual=replace(found.residual, faults=("it repeats",)), curve=None)
    words = words_in(html(faulty, "run.csv", "It jumps."))
    assert "run.csv not explained" in words
    assert "The model does not explain the record: it repeats." in words
    assert data(faulty, "run.csv", "")["explained"] is False
    assert Identification(found, "run.csv", FILE).plot().axes


@pytest.mark.parametrize("many", [False, True])
def test_the_first_page_is_the_record_friction_and_numbers(
    browser: "Browser", tmp_path: Path, many: bool
) -> None:
    values = RIGID | {"friction.F_k": 736.0, "axis.force_along": 2.0, "k/m": 8e4}
    found = told(values, segments=tuple((n, n + 0.5, f"{n} mm/s") for n in range(20 * many)))
    file = tmp_path / "report.html"
    file.write_text(html(found, "run.csv", "It jumps at 30 mm/min. " * 6), encoding="utf-8")
    with browser.new_page(viewport={"width": 360, "height": 800}) as window:
        window.goto(file.as_uri())
        assert window.evaluate("document.documentElement.scrollWidth") == 360
        window.locator("main > div").evaluate("part => part.remove()")
        paper = window.pdf(prefer_css_page_size=True)
    assert len(re.findall(rb"/Type\s*/Page\b", paper)) == 1


def test_the_summary_has_80_columns_and_says_what_is_not_identified() -> None:
    found = told({"axis.force_along": -20.0, "axis.stiffness": 4e7}, part=0.3)
    endless = replace(found.numbers[0], high=math.inf)
    summary = identified_summary(
        replace(found, numbers=(endless, *found.numbers)), "run.csv", "It jumps. " * 20
    )
    (console := Console(width=80, file=io.StringIO())).print(summary)
    lines = console.file.getvalue().splitlines()  # type: ignore[attr-defined]
    assert max(map(len, lines)) <= 80
    text = " ".join(" ".join(lines).split())
    for words in (
        "run.csv: excitation, as the speed changes all the time number value from to ±",
        "axis.force_along −20 N −26 ∞ not identified a number",
        "axis.stiffness 40 N/µm 28 52 not identified a number",
        "cannot tell the stiffness: the motion is too slow",
        "The model explains the record: it leaves noise of 1.00 N, white.",
        "measure next: Measure at 1 mm/min. It jumps.",
    ):
        assert words in text
