"""The report on an axis: what it says first, its numbers and units, JSON, pictures and paper."""

from __future__ import annotations

import itertools
import json
import math
import re
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from stickslip_design.axis import Demand
from stickslip_design.report import data, html, plots, tables
from stickslip_design.shown import EXACT, decibels, number, per_minute, told
from stickslip_design.verdict import Verdict

from . import verdicts

if TYPE_CHECKING:
    from playwright.sync_api import Browser

MOST_PAGES = 4


@cache
def page(name: str) -> str:
    """Return the report of an axis."""
    return html(verdicts.ALL[name]())


@pytest.mark.parametrize(
    ("value", "unit", "digits", "text"),
    [
        (1.5506e-3, "m/s", 3, "1.55 mm/s"),
        (1.6e-3, "m/s", 3, "1.60 mm/s"),
        (1.6e-3, "m/s", EXACT, "1.6 mm/s"),
        (1.35915e-5, "m", 3, "13.6 µm"),
        (0.01, "m", EXACT, "10 mm"),
        (40e6, "N/m", EXACT, "40 N/µm"),
        (2368.7, "kg", EXACT, "2369 kg"),
        (12345.6, "N", 3, "12346 N"),
        (0.25e-3, "s", EXACT, "0.25 ms"),
        (0.85136, "s", 3, "0.851 s"),
        (math.pi / 4.0, "rad", 3, "45.0°"),
        (-2.5e-5, "1", 3, "−2.50e−5"),
        (0.0, "N", 3, "0 N"),
        (math.inf, "m/s", 3, "∞ mm/s"),
        (math.nan, "m", 3, "–"),
        (None, "m", 3, "–"),
    ],
)
def test_quantities_are_told_as_engineers_write_them(
    value: float | None, unit: str, digits: int, text: str
) -> None:
    """Three digits of a result, four of a given number, in the workshop's unit."""
    assert told(value, unit, digits) == text


def test_feeds_and_factors_have_their_own_spelling() -> None:
    """A feed is told a minute too, a gain margin in dB."""
    assert per_minute(1.55e-3) == "93.0"
    assert decibels(72.184 / 25.0) == "9.2"
    assert decibels(math.inf) == "∞"
    assert number(1e9) == "1000000000"


def test_the_answer_comes_first() -> None:
    """Verdict, sentence, critical feed and range, margin, the cheapest cure of each aim."""
    first = texts_in(page("juddering").partition("</header>")[0])
    assert "Feed axis of a milling machine judders At 2 mm/min this axis jumps 13.9 µm" in first
    assert "1.55 mm/s (93.0 mm/min); 1.21 to 1.93 mm/s within the ± of the file" in first
    assert "0.0215 at the slowest feed, 0.03333 mm/s (2 mm/min)" in first
    assert "no jump at the slowest feed: less gap, mu_s 0.2 → 0.1661" in first
    assert "faster" not in first
    assert "lighter" not in first
    assert "a jump that is allowed: stiffer, stiffness 40 → 280 N/µm" in first
    # By more than a factor of ten it is none to name.
    assert "dead band" not in first


def test_every_feed_has_its_margin_and_its_motion() -> None:
    """Exact beside the familiar formula; no jump where there is none."""
    rows = tables.operating_points(verdicts.juddering()).rows
    assert rows[0][:4] == ("0.03333", "2", "0.0215", "jumps, and turns back between the jumps")
    assert rows[1] == ("0.5", "30", "0.322", "jumps", "18.4", "12.3", "27.1", "40.8")
    assert rows[2][3] == "jumps, or moves evenly, by its start"
    assert rows[3][2:7] == ("3.22", "moves evenly", "–", "12.3", "–")


def test_an_unstable_loop_is_called_that_before_anything_else() -> None:
    """No margins and no motions are told of it; what it bears is."""
    verdict = verdicts.unstable()
    assert tables.standing(verdict) == ("unstable", "bad")
    assert tables.motions(verdict) == ()
    assert plots.feeds(verdict) is None
    assert not tables.margins(verdict).rows
    said = texts_in(page("unstable"))
    assert said.index("The loop: unstable") < said.index("Numbers of the axis")
    assert "An unstable loop has no margins." in said
    assert "Operating points" not in said
    assert "72.2 1/s; now 100 1/s, 2.8 dB above" in said


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({}, "judders"),
        ({"points": verdicts.juddering().points[2:]}, "depends on the start"),
        ({"points": verdicts.juddering().points[3:]}, "hunts at a target"),
        ({"points": verdicts.juddering().points[3:], "hunting": None}, "clean"),
        ({"points": (), "hunting": None}, "jumps at low feed"),
        ({"points": (), "critical_feed": math.inf}, "judders"),
        ({"points": (), "critical_feed": 0.0, "hunting": None}, "clean"),
    ],
)
def test_the_verdict_in_a_word(changes: dict[str, Any], word: str) -> None:
    """By what is asked for: feeds, starts, targets."""
    assert tables.standing(replace(verdicts.juddering(), **changes)).word == word


def test_a_jump_that_is_allowed_is_no_judder() -> None:
    """The largest jump of the demand decides, and 1 nm below the jump it is exceeded."""
    verdict = verdicts.juddering()
    largest = max(point.jump or 0.0 for point in verdict.points)

    def word(allowed: float) -> str:
        axis = replace(verdict.axis, demand=Demand(largest_jump=allowed))
        return tables.standing(replace(verdict, axis=axis)).word

    assert word(largest) == "jumps within the limit"
    assert word(largest - 1e-9) == "judders"


@pytest.mark.parametrize("name", ["juddering", "rigid", "clean", "undamped"])
def test_one_motion_is_told_of_every_feed(name: str) -> None:
    """The ranges follow each other from 0 to infinity; both motions exist between the limits."""
    verdict = verdicts.ALL[name]()
    found = tables.motions(verdict)
    assert found[0].low == 0.0
    assert found[-1].high == math.inf
    assert all(one.high == other.low for one, other in itertools.pairwise(found))
    both = [(each.low, each.high) for each in found if each.motion == "both"]
    assert both == ([(verdict.from_rest, verdict.critical_feed)] if name == "juddering" else [])


def test_cures_say_what_does_not_help() -> None:
    """Where no value does; and a change of unit on the way keeps both units."""
    rows = {row[0]: row for row in tables.cures(verdicts.juddering()).rows}
    assert rows["more damping"][2:4] == ("now 4000 N·s/m; none found", "–")
    assert rows["stiffer"][5].startswith("held: zeta, the damping ratio")
    longer = replace(verdicts.CURES[4], now=5e-5, then=2e-3)
    assert tables.change(longer) == "50 µm → 2 mm"
    assert "none of the single changes meets the aim" in page("undamped")


def test_hunting_is_told_with_what_ends_it() -> None:
    """Amplitude, period, dead band, what is allowed, and that presliding is left out."""
    said = " ".join(tables.hunting(verdicts.juddering()))
    for part in (
        "13.6 µm",
        "0.851 s",
        "dead band that ends it is 6.80 µm",
        "is more than the 5 µm",
    ):
        assert part in said
    assert "Presliding" in said
    assert tables.hunting(verdicts.clean()) == ("It comes to rest: it does not hunt.",)


def test_what_the_file_did_not_state_is_told() -> None:
    """Each assumption with its value and reason; and that there was none."""
    rows = tables.assumed(verdicts.large().axis).rows
    why = "not on the data sheet: a usual value of such drives"
    assert rows[1] == ("drive.velocity_feedforward_1", "1 ms", why)
    assert "Nothing: every number stands in the file." in page("clean")


def test_every_number_of_the_axis_is_told_with_its_range() -> None:
    """A ± stands beside its number, one of an unknown name in a row of its own."""
    axis = replace(
        verdicts.AXIS,
        spread={
            "axis.stiffness": 4e6,
            "friction.mu_s": 0.02,
            "drive.viscous_friction": 100.0,
            "strange": 0.5,
        },
    )
    rows = {row[0]: row[1:] for row in tables.numbers(axis).rows}
    assert rows["stiffness between drive and table"] == ("40 N/µm", "4 N/µm")
    assert rows["viscous friction of the guideway"] == ("4000 N·s/m", "")
    assert rows["viscous friction of motor and nut"] == ("1000 N·s/m", "100 N·s/m")
    assert rows["static coefficient"] == ("0.2", "0.02")
    assert rows["strange"] == ("", "0.5 (SI)")
    assert rows["damping ratio, drive held fast"] == ("1.41 %", "")


@pytest.mark.parametrize("name", verdicts.ALL)
def test_the_page_asks_for_nothing_and_carries_no_date(name: str) -> None:
    """One file: no address, script or picture outside."""
    assert not re.search(r"https?:|<script|<link|<img|@import|url\((?!#)|20\d\d-\d\d", page(name))


def test_the_same_verdict_gives_the_same_page() -> None:
    """To the byte, ids of pictures too."""
    assert html(verdicts.unstable()) == page("unstable")


def test_names_of_a_file_are_text() -> None:
    """What is written in an axis file is no markup."""
    axis = replace(verdicts.AXIS, name="<b>X</b> & Y")
    made = html(replace(verdicts.rigid(), axis=axis))
    assert "<b>" not in made
    assert "&lt;b&gt;X&lt;/b&gt; &amp; Y" in made


@pytest.mark.parametrize("name", verdicts.ALL)
def test_json_has_every_attribute_and_a_unit_for_every_number(name: str) -> None:
    """Without NaN and infinity, which JSON does not know."""
    verdict = verdicts.ALL[name]()
    found = json.loads(json.dumps(data(verdict), allow_nan=False))
    assert set(vars(verdict)) < set(found)
    nameless = {key for key in keys_of_numbers(found) if key not in found["units"]}
    assert not nameless - {"format"}


def test_json_keeps_numbers_as_they_are() -> None:
    """All digits; infinity is a text that Python and JavaScript read as a number."""
    found = data(verdicts.juddering())
    assert found["hunting"] == {"jump": 1.3592e-5, "period": 0.85136, "dead_band": 6.8018e-6}
    assert float(found["cures"][-1]["effort"]) == math.inf
    assert found["axis"]["F_s"] == pytest.approx(981.0, rel=1e-15)
    gain = found["responses"][0]["gain"]
    whole = np.array(gain["real"]) + 1j * np.array(gain["imag"])
    assert np.array_equal(whole, verdicts.juddering().responses[0].gain)
    assert data(verdicts.unstable())["critical_feed"] is None


@pytest.mark.parametrize("width", [plots.WIDE, plots.NARROW])
@pytest.mark.parametrize(
    ("feeds", "critical", "from_rest"),
    [
        ((3e-5, 5e-4, 1.2e-3, 5e-3, 0.5), 1.55e-3, 9.9e-4),
        ((1e-3, 1.01e-3, 1.02e-3, 1.5e-3, 1.6e-3), 1.55e-3, 1.5e-3),
        ((0.5,), 3e-5, 2.9e-5),
        ((3e-5,), 0.5, 0.49),
        (tuple(1e-3 * 1.1**n for n in range(12)), 2e-3, None),
    ],
)
def test_no_label_of_the_bar_covers_another(
    feeds: tuple[float, ...], critical: float, from_rest: float | None, width: float
) -> None:
    """Of feeds that lie close, of limits at the edge; and all are within the picture."""
    verdict = replace(
        verdicts.juddering(), critical_feed=critical, from_rest=from_rest,
        critical_range=(0.9 * critical, 1.2 * critical),
        points=tuple(verdicts.point(feed, critical) for feed in feeds),
    )  # fmt: skip
    figure = plots.feeds(verdict, width)
    assert figure is not None
    figure.draw_without_rendering()
    (on,) = figure.axes
    labels = [(text.get_text(), box_of(figure, text)) for text in on.texts]
    assert len(labels) == len(feeds) + (1 if from_rest is None else 2)
    labels += [(text.get_text(), box_of(figure, text)) for text in figure.legends[0].get_texts()]
    for (one, box), (other, box_too) in itertools.combinations(labels, 2):
        assert not box.overlaps(box_too), (one, other)
    whole = figure.bbox
    for name, box in labels:
        assert whole.x0 <= box.x0, name
        assert box.x1 <= whole.x1, name


@pytest.mark.parametrize("cut", ["force", "position"])
@pytest.mark.parametrize("margin", ["gain", "phase"])
def test_rings_stand_where_the_margins_are_read(cut: Any, margin: str) -> None:
    """At the margin, and on the line as it is drawn."""
    verdict = verdicts.juddering()
    found = next(each for each in verdict.responses if each.cut == cut and each.sliding)
    figure = plots.responses(verdict, cut)
    assert figure is not None
    on = figure.axes[0 if margin == "gain" else 1]
    (ring,) = (
        line
        for line in on.lines
        if line.get_marker() == "o" and line.get_markeredgecolor() == "#0072b2"
    )
    line = on.lines[0]
    (at,), (height,) = (np.asarray(each, dtype=float) for each in ring.get_data())
    frequency, values = (np.asarray(each, dtype=float) for each in line.get_data())
    drawn = float(np.interp(at, frequency, values))
    if margin == "gain":
        assert height == pytest.approx(-20.0 * math.log10(found.gain_margin), abs=1e-12)
        # The line goes from one of 600 frequencies to the next, 2 % apart, beside a resonance.
        assert height == pytest.approx(drawn, abs=0.5)
    else:
        assert (height + 180.0) % 360.0 == pytest.approx(math.degrees(found.phase_margin))
        assert height == pytest.approx(drawn, abs=1.0)
        frequency, values = (
            np.asarray(each, dtype=float) for each in figure.axes[0].lines[0].get_data()
        )
        # There the gain is 1.
        assert float(np.interp(at, frequency, values)) == pytest.approx(0.0, abs=0.5)


def test_a_scale_sees_nothing_of_a_table_that_is_stuck() -> None:
    """What is rounding alone has no margin and no line."""
    verdict = verdicts.juddering()
    stuck = [each for each in verdict.responses if each.cut == "position" and not each.sliding]
    assert [tables.passes(each) for each in stuck] == [False]
    assert tables.margins(verdict).rows[-1] == ("at the position error", "stuck", "–", "–")
    figure = plots.responses(verdict, "position")
    assert figure is not None
    legend = figure.axes[1].get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == ["table sliding"]


def test_the_report_fits_phone_and_paper(browser: Browser, tmp_path: Path) -> None:
    """A full one: nothing beyond a window of 360 px; four pages, the answer on the first."""
    file = tmp_path / "report.html"
    file.write_text(page("large"), encoding="utf-8")
    with browser.new_page(viewport={"width": 360, "height": 800}) as window:
        window.goto(file.as_uri())
        assert window.evaluate("document.documentElement.scrollWidth") == 360
        assert window.locator("figure.narrow svg").is_visible()
        printed = window.pdf(prefer_css_page_size=True)
        assert len(re.findall(rb"/Type\s*/Page\b", printed)) <= MOST_PAGES
        # The printed width of A4, and its height, in CSS pixels.
        window.set_viewport_size({"width": 688, "height": 1009})
        window.emulate_media(media="print")
        assert window.locator("figure.wide svg").is_visible()
        assert not window.locator("figure.narrow svg").is_visible()
        box = window.locator("section").first.bounding_box()
        assert box is not None
        assert box["y"] + box["height"] < 1009


def texts_in(page: str) -> str:
    """Return the words of a page with one blank between them."""
    plain = re.sub(r"<style>.*?</style>|<svg.*?</svg>|<title>.*?</title>", " ", page, flags=re.S)
    return " ".join(re.sub(r"\s+([,:;.])", r"\1", re.sub(r"<[^>]*>", " ", plain)).split())


def keys_of_numbers(found: Any, key: str = "") -> Iterator[str]:
    """Give the key of every number, or text for one, in what JSON gave."""
    if isinstance(found, dict):
        for name, each in found.items():
            # These name their numbers as the axis file and the friction law do.
            yield from (
                ()
                if name == "units"
                else keys_of_numbers(each, key if key in ("own", "spread") else name)
            )
    elif isinstance(found, list):
        for each in found:
            yield from keys_of_numbers(each, key)
    elif (isinstance(found, int | float) and not isinstance(found, bool)) or found == "Infinity":
        yield key


def box_of(figure: Figure, text: Any) -> Any:
    """Return the box that a label covers, as it is drawn."""
    FigureCanvasAgg(figure)
    return text.get_window_extent()


def test_the_fixtures_are_what_they_are_called() -> None:
    """Each of the verdicts made by hand stands where its name says."""
    words = {name: tables.standing(make()).word for name, make in verdicts.ALL.items()}
    assert words == {
        "juddering": "judders", "rigid": "judders", "clean": "clean", "unstable": "unstable",
        "undamped": "judders", "large": "judders",
    }  # fmt: skip
    assert isinstance(verdicts.large(), Verdict)
