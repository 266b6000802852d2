"""The report on an axis: what it says first, its numbers and units, JSON, pictures and paper."""

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

from stickslip_design.axis import Demand
from stickslip_design.report import data, html, plots
from stickslip_design.shown import EXACT, told
from tests.design import verdicts

if TYPE_CHECKING:
    from playwright.sync_api import Browser


@cache
def page(name: str) -> str:
    """Return the report of an axis."""
    return html(verdicts.ALL[name]())


def words_in(page: str) -> str:
    """Return the words of a page with one blank between them."""
    plain = re.sub(r"<style>.*?</style>|<svg.*?</svg>|<title>.*?</title>", " ", page, flags=re.S)
    return " ".join(re.sub(r"\s+([,:;.])", r"\1", re.sub(r"<[^>]*>", " ", plain)).split())


@pytest.mark.parametrize(
    ("value", "unit", "digits", "text"),
    [
        (1.5506e-3, "m/s", 3, "1.55 mm/s"),
        (1.6e-3, "m/s", EXACT, "1.6 mm/s"),
        (1.35915e-5, "m", 3, "13.6 µm"),
        (0.01, "m", EXACT, "10 mm"),
        (40e6, "N/m", EXACT, "40 N/µm"),
        (0.85136, "s", 3, "0.851 s"),
        (math.pi / 4.0, "rad", 3, "45.0°"),
        (-2.5e-5, "1", 3, "−2.50e−5"),
        (math.inf, "m/s", 3, "∞ mm/s"),
        (None, "m", 3, "–"),
    ],
)
def test_quantities_are_shown_as_engineers_write_them(
    value: float | None, unit: str, digits: int, text: str
) -> None:
    assert told(value, unit, digits) == text


def test_the_answer_comes_first_and_names_the_cheapest_cure_of_each_aim() -> None:
    first = words_in(page("juddering").partition("</header>")[0])
    for words in (
        "Feed axis of a milling machine judders At 2 mm/min this axis jumps 13.9 µm",
        "1.55 mm/s (93.0 mm/min); 1.21 to 1.93 mm/s within the ± of the file",
        "0.0215 at the slowest feed, 0.03333 mm/s (2 mm/min)",
        "no jump at the slowest feed: less gap, mu_s 0.2 → 0.1661",
        "a jump that is allowed: stiffer, stiffness 40 → 280 N/µm",
    ):
        assert words in first
    # A faster feed is what is asked for; a change by more than a factor of ten is no cure to name.
    assert not re.search("faster|lighter|dead band", first)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("juddering", "0.03333 2 0.0215 jumps, and turns back between the jumps"),
        ("juddering", "0.5 30 0.322 jumps 18.4 12.3 27.1 40.8"),
        ("juddering", "5 300 3.22 moves evenly – 12.3 –"),
        ("juddering", "it jumps 13.6 µm there and back again in 0.851 s"),
        ("juddering", "dead band that ends it is 6.80 µm"),
        ("juddering", "more damping damping now 4000 N·s/m; none found –"),
        ("juddering", "stiffness between drive and table 40 N/µm 4 N/µm"),
        ("juddering", "damping ratio, drive held fast 1.41 %"),
        ("juddering", "at the position error stuck – –"),
        ("unstable", "An unstable loop has no margins."),
        ("juddering", "Nothing: every number stands in the file."),
        ("large", "drive.velocity_feedforward_1 1 ms not on the data sheet: a usual value"),
    ],
)
def test_the_page_says(name: str, words: str) -> None:
    assert words in words_in(page(name))


def test_an_unstable_loop_is_called_that_first_and_has_no_motions() -> None:
    words = words_in(page("unstable"))
    assert words.index("The loop: unstable") < words.index("Numbers of the axis")
    assert "Operating points" not in words
    assert plots.feeds(verdicts.unstable()) is None


def judged(**changes: Any) -> str:
    """Return the verdict in a word on the juddering axis, changed."""
    return str(data(replace(verdicts.juddering(), **changes))["standing"])


@pytest.mark.parametrize(
    ("points", "changes", "word"),
    [
        (0, {}, "judders"),
        (2, {}, "depends on the start"),
        (3, {}, "hunts at a target"),
        (3, {"hunting": None}, "clean"),
        (5, {"hunting": None}, "jumps at low feed"),
        (5, {"critical_feed": 0.0, "hunting": None}, "clean"),
        (0, {"stable": False}, "unstable"),
    ],
)
def test_the_word_is_of_the_feeds_starts_and_targets_asked_for(
    points: int, changes: dict[str, Any], word: str
) -> None:
    assert judged(points=verdicts.juddering().points[points:], **changes) == word


def test_a_jump_up_to_the_largest_allowed_is_no_judder() -> None:
    largest = max(point.jump or 0.0 for point in verdicts.juddering().points)
    for allowed, word in ((largest, "jumps within the limit"), (largest - 1e-9, "judders")):
        axis = replace(verdicts.AXIS, demand=Demand(largest_jump=allowed))
        assert judged(axis=axis) == word


@pytest.mark.parametrize("name", ["unstable", "large"])
def test_the_page_asks_for_nothing_and_has_no_date(name: str) -> None:
    assert not re.search(r"https?:|<script|<link|<img|@import|url\((?!#)|20\d\d-\d\d", page(name))


def test_names_of_a_file_are_text_and_no_markup() -> None:
    assert "<b>" not in page("large")
    assert "&lt;b&gt;X&lt;/b&gt; &amp; Y" in page("large")


def keys_of_numbers(found: Any, key: str = "") -> Iterator[str]:
    """Give the key of every number, or text for one, in what JSON gave."""
    if isinstance(found, dict):
        for name, each in found.items():
            # These name their numbers as the axis file and the friction law do.
            yield from keys_of_numbers(each, key if key in ("own", "spread") else name)
    elif isinstance(found, list):
        for each in found:
            yield from keys_of_numbers(each, key)
    elif (isinstance(found, int | float) and not isinstance(found, bool)) or found == "Infinity":
        yield key


@pytest.mark.parametrize("name", verdicts.ALL)
def test_json_has_every_attribute_and_a_unit_for_every_number(name: str) -> None:
    verdict = verdicts.ALL[name]()
    found = json.loads(json.dumps(data(verdict), allow_nan=False))
    assert set(vars(verdict)) < set(found)
    assert set(keys_of_numbers(found)) <= found["units"].keys() | {"format"}


def test_json_keeps_all_digits_of_a_number() -> None:
    found = data(verdicts.juddering())
    assert found["hunting"] == {"jump": 1.3592e-5, "period": 0.85136, "dead_band": 6.8018e-6}
    assert float(found["cures"][-1]["effort"]) == math.inf
    assert found["axis"]["F_s"] == pytest.approx(981.0, rel=1e-15)  # one rounding
    gain = found["responses"][0]["gain"]
    together = np.array(gain["real"]) + 1j * np.array(gain["imag"])
    assert np.array_equal(together, verdicts.juddering().responses[0].gain)
    assert data(verdicts.unstable())["critical_feed"] is None


@pytest.mark.parametrize("width", [plots.WIDE, plots.NARROW])
@pytest.mark.parametrize(
    ("feeds", "critical", "from_rest"),
    [
        ((1e-3, 1.01e-3, 1.02e-3, 1.5e-3, 1.6e-3), 1.55e-3, 1.5e-3),
        ((0.5,), 3e-5, 2.9e-5),
        ((3e-5,), 0.5, 0.49),
        (tuple(1e-3 * 1.1**n for n in range(12)), 2e-3, None),
    ],
)
def test_no_label_of_the_bar_covers_another_or_leaves_the_picture(
    feeds: tuple[float, ...], critical: float, from_rest: float | None, width: float
) -> None:
    verdict = replace(
        verdicts.juddering(), critical_feed=critical, from_rest=from_rest,
        critical_range=(0.9 * critical, 1.2 * critical),
        points=tuple(verdicts.point(feed, critical) for feed in feeds),
    )  # fmt: skip
    figure = plots.feeds(verdict, width)
    assert figure is not None
    figure.draw_without_rendering()
    FigureCanvasAgg(figure)
    on_bar = figure.axes[0].texts
    assert len(on_bar) == len(feeds) + (1 if from_rest is None else 2)
    boxes = [text.get_window_extent() for text in (*on_bar, *figure.legends[0].get_texts())]
    assert not any(one.overlaps(other) for one, other in itertools.combinations(boxes, 2))
    assert all(figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1 for box in boxes)


def test_a_full_report_fits_a_phone_and_four_pages_with_the_answer_on_the_first(
    browser: "Browser", tmp_path: Path
) -> None:
    file = tmp_path / "report.html"
    file.write_text(page("large"), encoding="utf-8")
    with browser.new_page(viewport={"width": 360, "height": 800}) as window:
        window.goto(file.as_uri())
        assert window.evaluate("document.documentElement.scrollWidth") == 360
        assert window.locator("figure.narrow svg").is_visible()
        printed = window.pdf(prefer_css_page_size=True)
        assert len(re.findall(rb"/Type\s*/Page\b", printed)) <= 4
        # The printed width of A4, and its height, in CSS pixels.
        window.set_viewport_size({"width": 688, "height": 1009})
        window.emulate_media(media="print")
        assert window.locator("figure.wide svg").is_visible()
        box = window.locator("section").first.bounding_box()
        assert box is not None
        assert box["y"] + box["height"] < 1009
