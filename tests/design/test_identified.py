"""What a record told, as people get it: the axis file, the sentence on the axis, the page."""

import io
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
from stickslip_design.identify.axis_text import axis_of, written
from stickslip_design.identify.model import Identified, Number, Record, Trace
from stickslip_design.identify.report import sentence
from stickslip_design.identify.study import identify
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
NONE = axis_file_of({})
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
        "traces": (Trace(name="position", unit="m", at=t, measured=off, fitted=way),) * 2,
        "noise": 1e-6,
        "segments": ((0.0, 10.0, "forward"), (10.0, 20.0, "back")),
        "friction": Trace(
            name="two", unit="N", at=speed, measured=force, band=0.1 * force**2, fitted=force
        ),
        "next_measurement": "Measure at 1 mm/min.",
        **changes,
    })  # fmt: skip


def text_of(found: Identified, file: AxisFile, source: str) -> str:
    return written(found, file, source).text


def value_of(text: str, path: str) -> Stated:
    value = axis_file_of(text).values[path]
    assert isinstance(value, Stated)
    return value


def test_the_file_states_what_the_other_does_and_the_numbers_of_the_record() -> None:
    text = text_of(told({"axis.mass": 512.3, "axis.c": 3456.0}), FILE, "run.csv")
    assert 'mass = "512.3 kg ± 2 %"' in text.splitlines()
    assert 'c = "3456 N·s/m ± 2 %"' in text.splitlines()
    stated, new = dict(FILE.values), dict(axis_file_of(text).values)
    assert {path for path in new if new[path] != stated.pop(path)} == {"axis.mass", "axis.c"}
    assert not stated
    comments = [line for line in FILE.text.splitlines() if line.startswith("#")]
    assert comments
    assert {*comments} < {*text.splitlines()}
    again = text_of(told({"axis.mass": 500.0}), axis_file_of(text), "other.csv")
    assert again.startswith("# from other.csv, ± is half the interval of 95 %: axis.mass\n")
    assert "# from run.csv, ± is half the interval of 95 %: axis.mass, axis.c\n" in again
    assert value_of(again, "axis.c") == value_of(text, "axis.c")


def test_friction_is_written_as_the_file_states_it() -> None:
    forces = told({"friction.F_s": 900.0, "friction.F_k": 700.0})
    text = text_of(forces, FILE, "run.csv")
    for which, force in (("s", 900.0), ("k", 700.0)):
        stated = value_of(text, f"friction.mu_{which}")
        # To two digits of the interval.
        assert stated.value == pytest.approx(force / (500.0 * 9.81), abs=0.05 * stated.spread)
    newtons = axis_file_of(example().replace("mu_s = 0.20", 'F_s = "9 kN"').replace(
        "mu_k = 0.15", 'F_k = "0.8 kN"'
    ))  # fmt: skip
    text = text_of(forces, newtons, "run.csv")
    assert 'F_s = "900 N ± 2 %"' in text.splitlines()


def test_static_friction_that_is_not_in_the_record_is_that_of_the_file_or_missing() -> None:
    kinetic = told({"friction.F_k": 700.0})
    text = text_of(kinetic, FILE, "run.csv")
    assert value_of(text, "friction.mu_s").value == 0.2
    above = text_of(told({"friction.F_k": 1100.0}), FILE, "run.csv")
    assert sentence(axis_file_of(above)).startswith(
        "These numbers are not enough for a verdict: friction."
    )


def test_a_position_alone_and_the_mass_of_the_file_make_an_axis() -> None:
    file = axis_file_of(example().replace('"500 kg"', '"500 kg ± 3 %"'))
    text = text_of(told({"k/m": 8e4, "c/m": 8.0, "gap": 6e-6}, 0.04), file, "run.csv")
    for path, value, part in (("axis.stiffness", 4e7, 0.05), ("axis.c", 4e3, 0.05)):
        stated = value_of(text, path)
        assert (stated.value, stated.spread) == pytest.approx((value, part * value), rel=0.02)
    # The gap is 240 N of 4905: 0.0489 beside mu_k = 0.15, to 4 % of it and 5 % of the stiffness.
    static = value_of(text, "friction.mu_s")
    assert static.value == pytest.approx(0.15 + 240.0 / 4905.0, abs=0.05 * static.spread)
    assert static.spread == pytest.approx(math.hypot(0.04, 0.05) * 240.0 / 4905.0, rel=0.05)
    forces = text_of(told({"F_s - F_k": 245.25}), FILE, "run.csv")
    assert value_of(forces, "friction.mu_s").value == pytest.approx(0.2, abs=1e-4)


def test_without_a_file_a_rigid_axis_says_what_is_missing() -> None:
    text = text_of(told({"axis.mass": 500.0, "friction.F_k": 736.0}), NONE, "run.csv")
    assert "axis.stiffness is missing" in sentence(axis_file_of(text))
    full = text_of(told(RIGID | {"friction.F_k": 736.0}), NONE, "run.csv")
    axis = axis_file_of(full).axis()
    assert (axis.m, axis.k, axis.drive) == (500.0, 4e7, None)
    assert axis.spread["axis.stiffness"] == pytest.approx(8e5)
    assert "This axis can judder" in sentence(axis_file_of(full))


@pytest.mark.parametrize(
    ("name", "ends", "stated"),
    [
        ("axis.mass", (300.0, 800.0), (550.0, 250.0)),
        ("axis.c", (-1000.0, 9000.0), (4500.0, 4500.0)),
        ("axis.c", (0.0, 2020.0), (1010.0, 1010.0)),
        ("axis.mass", (0.1, 800.0), (500.0, 0.0)),
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
    text = text_of(replace(found, numbers=(wide,)), FILE, "run.csv")
    value = value_of(text, name)
    # The ± has three digits.
    assert (value.value, value.spread) == pytest.approx(stated, rel=5e-3)
    assert ("its interval is not in the range of the key" in text) == (stated[1] == 0.0)
    rigid = axis_file_of(text_of(replace(found, numbers=(wide,)), NONE, "run.csv"))
    assert (name in rigid.values) == (stated[1] > 0.0)


def test_a_measured_stiffness_takes_the_place_of_the_screw_that_it_was_computed_from() -> None:
    text = text_of(told({"axis.stiffness": 9e7}), SCREW, "run.csv")
    assert axis_file_of(text).axis().k == 9e7
    assert not re.search("core_diameter|fixing|free_length", text)


@pytest.mark.parametrize("file", [FILE, SCREW, axis_file_of(template("belt")), NONE])
def test_whatever_a_record_tells_the_file_can_be_read(file: AxisFile, sized: Sized) -> None:
    draw = random.Random(1)
    names = [f"friction.{each}" for each in ("F_s", "F_k", "mu_s", "mu_k")]
    names += ["axis.mass", "axis.c", "axis.stiffness", "k/m", "c/m", "gap", "F_s - F_k", "offset"]
    for _ in range(sized(500)):
        values = {
            name: draw.choice([1.0, 1.0, 1.0, -1.0, 0.0]) * 10.0 ** draw.uniform(-9.0, 9.0)
            for name in draw.sample(names, 6)
        }
        text = text_of(told(values, 10.0 ** draw.uniform(-6.0, 1.0)), file, "run.csv")
        assert "axis.mass" in axis_file_of(text).values or file is NONE


def test_tables_from_python_become_the_text_of_a_file() -> None:
    tables = tomllib.loads(example())
    tables["drive"]["filter"] = [{"kind": "low pass", "frequency": "800 Hz"}] * 2
    file = read_axis_file(tables)
    stated = dict(axis_file_of(text_of(told({"axis.mass": 700.0}), file, "run.csv")).values)
    assert stated.pop("axis.mass") == Stated(700.0, "kg", 14.0)
    assert stated == {path: v for path, v in file.values.items() if path != "axis.mass"}


def test_an_axis_whose_friction_is_sought_has_none_and_a_rotary_table_is_refused() -> None:
    bare = re.sub(r"\[friction\]\n.*\n.*\n", "", example())
    for text in (bare, example(), example().replace("mu_s = 0.20\n", "")):
        axis = axis_of(axis_file_of(text))
        assert (axis.m, axis.F_s, axis.F_k) == (500.0, 0.0, 0.0)
    rotary = Path(__file__).parents[2] / "examples" / "axes" / "rotary_table.toml"
    with pytest.raises(AxisError, match="is not for identification, which is in mm and N"):
        axis_of(read_axis_file(rotary))


def test_the_scale_of_the_force_widens_forces_and_masses_alone() -> None:
    draw, t = np.random.default_rng(1), np.arange(0.0, 20.0, 1e-3)
    x, v, a = 0.1 * np.sin(2.0 * t), 0.2 * np.cos(2.0 * t), -0.4 * np.sin(2.0 * t)
    force = 500.0 * a + 736.0 * np.sign(v) + draw.normal(0.0, 5.0, t.size)
    record = Record(t=t, position=x, force=force)
    narrow, wide = (identify(replace(record, force_spread=part)) for part in (0.0, 0.04))
    for name in ("axis.mass", "friction.F_k"):
        both = math.hypot(narrow.number(name).width, 0.04)
        assert wide.number(name).width == pytest.approx(both, rel=1e-6)
    # The motor takes four times the force of the table: 4 % of both are 20 % of the table.
    axis = replace(axis_of(FILE), drive=replace(DRIVE, inertia=4.0 * 500.0))
    record = replace(record, force=force + 4.0 * 500.0 * a, force_spread=0.04)
    assert identify(record, axis).number("axis.mass").width == pytest.approx(0.2, rel=0.01)


def asked(part: float) -> tuple[Identified, str]:
    found = told(RIGID | {"friction.F_k": 736.0}, part)
    file = axis_file_of(re.sub(r"feeds = .*", 'feeds = ["30 mm/min"]', example()))
    return found, text_of(found, file, "run.csv")


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
    assert sentence(axis_file_of(text)) == (
        "With these numbers the axis jumps at 30 mm/min in 100 % of machines within their ±; "
        f"{surest} ends that in 100 %."
    )
    even = re.sub(r"feeds = .*", 'feeds = ["600 mm/min"]', text)
    assert "100 % of machines within their ± move evenly" in sentence(axis_file_of(even))


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


def identified(found: Identified, sentence: str = "It jumps.") -> Identification:
    """Return it with a sentence on the axis that nobody has to compute."""
    whole = Identification(found, "run.csv", FILE)
    vars(whole)["sentence"] = sentence
    return whole


def words_in(page: str) -> str:
    plain = re.sub(r"<style>.*?</style>|<svg.*?</svg>|<title>.*?</title>", " ", page, flags=re.S)
    return " ".join(re.sub(r"<[^>]*>", " ", plain).split())


def test_the_page_has_all_that_was_found_and_asks_for_nothing() -> None:
    found = told({"axis.mass": 512.3}, notes=("<b>Directions</b> differ.",))
    page = identified(found).html()
    assert not re.search(r"https?:|<script|<link|<img|@import|url\((?!#)|<b>", page)
    for words in (
        "run.csv explained It jumps. Record excitation: the speed changes all the time",
        "axis.mass a number 512.3 kg 502.1 kg 522.5 kg 2 %",
        "it leaves noise of 1.00 µm. Next Measure at 1 mm/min.",
        "the stiffness: the motion is too slow",
    ):
        assert words in words_in(page)
    faulty = replace(found, faults=("it repeats",), friction=None)
    words = words_in(identified(faulty).html())
    assert "run.csv not explained" in words
    assert "The model does not explain the record: it repeats." in words
    assert identified(faulty).to_dict()["known"] == ["axis.mass"]
    assert identified(found).plot().axes


@pytest.mark.parametrize("many", [False, True])
def test_the_first_page_is_the_record_friction_and_numbers(
    browser: "Browser", tmp_path: Path, many: bool
) -> None:
    values = RIGID | {"friction.F_k": 736.0, "axis.force_along": 2.0, "k/m": 8e4}
    found = told(values, segments=tuple((n, n + 0.5, f"{n} mm/s") for n in range(20 * many)))
    file = tmp_path / "report.html"
    file.write_text(identified(found, "It jumps at 30 mm/min. " * 6).html(), encoding="utf-8")
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
        "axis.force_along −20 N −26 N ∞ N not identified a number",
        "axis.stiffness 40 N/µm 28 N/µm 52 N/µm not identified a number",
        "cannot tell the stiffness: the motion is too slow",
        "The model explains the record: it leaves noise of 1.00 µm.",
        "measure next: Measure at 1 mm/min. It jumps.",
    ):
        assert words in text
