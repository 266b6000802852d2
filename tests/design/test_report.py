"""The report on an axis: what it says first, its numbers and units, JSON, pictures and paper."""

import json
import math
import re
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from stickslip_design.axis import Demand
from stickslip_design.report import data, html, motion
from stickslip_units import EXACT, told
from tests.design import verdicts

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page


@cache
def page(name: str) -> str:
    return html(verdicts.ALL[name]())


def words_in(page: str) -> str:
    plain = re.sub(r"<style>.*?</style>|<svg.*?</svg>|<title>.*?</title>", " ", page, flags=re.S)
    return " ".join(re.sub(r"\s+([,:;.])", r"\1", re.sub(r"<[^>]*>", " ", plain)).split())


@pytest.mark.gate
def test_the_answer_comes_first_and_names_the_measure_of_least_effort() -> None:
    first = words_in(page("juddering").partition("</header>")[0])
    for words in (
        "X axis judders At 30 mm/min this axis jumps 18.4 µm",
        "1.55 mm/s (93.0 mm/min); 0.859 to 2.39 mm/s within the ± of the file",
        "0.322 at the slowest feed, 0.5 mm/s (30 mm/min)",
        "Least effort: way oil with friction modifier (part).",
    ):
        assert words in first
    words = words_in(page("unstable"))
    assert words.index("The loop: unstable") < words.index("Numbers of the axis")
    assert "Operating points" not in words


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("juddering", "0.5 30 0.322 sticks and slips; moves evenly after another start 18.4"),
        ("juddering", "5 300 3.22 moves evenly – 12.3 –"),
        ("juddering", "it jumps 13.6 µm there and back again in 0.851 s"),
        ("juddering", "axis.stiffness 40 N/µm 4 N/µm"),
        ("juddering", "No help: higher position gain; faster velocity loop; "),
        ("large", "drive.velocity_feedforward_1 1 ms not on the data sheet: usual"),
    ],
)
def test_the_page_says(name: str, words: str) -> None:
    assert words in words_in(page(name))


@pytest.mark.parametrize(
    ("points", "changes", "word"),
    [
        (0, {}, "judders"),
        (2, {}, "depends on the start"),
        (3, {}, "hunts at a target"),
        (3, {"hunting": None}, "clean"),
        (5, {"hunting": None}, "jumps at low feed"),
        (0, {"stable": False}, "unstable"),
        (0, {"allowed": 1.0}, "jumps within the limit"),
        (0, {"allowed": 1.0 - 1e-6}, "judders"),
    ],
)
def test_the_word_is_of_the_feeds_starts_and_targets_asked_for(
    points: int, changes: dict[str, Any], word: str
) -> None:
    verdict, changes = verdicts.juddering(), dict(changes)
    if "allowed" in changes:
        cycles = [point.regime.stick_slip for point in verdict.points]
        largest = max(cycle.jump for cycle in cycles if cycle)
        demand = Demand(largest_jump=changes.pop("allowed") * largest)
        changes["axis"] = replace(verdict.axis, demand=demand)
    changed = replace(verdict, points=verdict.points[points:], **changes)
    assert data(changed)["standing"] == word


@pytest.mark.parametrize("name", ["unstable", "large"])
def test_the_page_asks_for_nothing_and_names_of_a_file_are_no_markup(name: str) -> None:
    assert not re.search(r"https?:|<script|<link|<img|@import|url\((?!#)|<b>", page(name))


def keys_of_numbers(found: Any, key: str = "") -> Iterator[str]:
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
    verdict = verdicts.juddering()
    found = data(verdict)
    assert verdict.hunting is not None
    assert found["hunting"] == verdict.hunting._asdict()
    assert float(found["cures"][-1]["effort"]) == math.inf
    gain = found["responses"][0]["gain"]
    together = np.array(gain["real"]) + 1j * np.array(gain["imag"])
    assert np.array_equal(together, verdict.responses[0].gain)
    assert data(replace(verdict, critical_feed=math.nan))["critical_feed"] is None


@pytest.mark.parametrize("name", verdicts.ALL)
def test_the_first_page_is_verdict_pictures_and_measures(
    name: str, browser: "Browser", tmp_path: Path
) -> None:
    verdict, file = verdicts.ALL[name](), tmp_path / "report.html"
    file.write_text(page(name), encoding="utf-8")
    with browser.new_page(viewport={"width": 360, "height": 800}) as window:
        window.goto(file.as_uri())
        assert window.evaluate("document.documentElement.scrollWidth") == 360
        assert pages(window) <= 4
        behind = window.locator("main > div")
        assert "What was assumed" in behind.inner_text()
        behind.evaluate("part => part.remove()")
        assert pages(window) == 1
        left = window.locator("body").inner_text()
        assert (not verdict.stable) == (window.locator("#bar").count() == 0)
        assert window.locator("#before, #after").count() == (2 if verdict.points else 0)
        sketch = window.locator("#sketch").inner_html()
    assert verdict.sentence in left
    assert all(one.name in left for one in verdict.measures[:5])
    assert told(verdict.axis.k, "N/m", EXACT) in sketch
    assert ("rigid" in sketch) == (verdict.axis.drive is None)


def pages(window: "Page") -> int:
    return len(re.findall(rb"/Type\s*/Page\b", window.pdf(prefer_css_page_size=True)))


@pytest.mark.parametrize("name", ["juddering", "rigid"])
def test_both_motions_have_the_same_scales_and_only_the_first_keeps_jumping(name: str) -> None:
    verdict = verdicts.ALL[name]()
    before, after = (motion(verdict, which) for which in ("before", "after"))
    assert before is not None
    assert after is not None
    (first,), (second,) = before.axes, after.axes
    assert (first.get_xlim(), first.get_ylim()) == (second.get_xlim(), second.get_ylim())
    # Two periods of the jumps in each part.
    jumps, swings = (
        [np.ptp(part) for part in np.split(np.asarray(on.lines[-1].get_ydata()), 4)]
        for on in (first, second)
    )
    point = verdict.points[0]
    assert point.jump is not None
    # A jump takes the table ahead by its way, less that of the feed meanwhile.
    assert 0.3 < 1e-6 * jumps[-1] / point.jump < 1.0
    # A peak lies between two of 75 samples of a period.
    assert jumps[-1] == pytest.approx(jumps[-2], rel=0.01)
    assert all(later < 0.9 * sooner for sooner, later in pairwise(swings))
    uncured = replace(verdict, measures=(), after=None)
    assert motion(uncured, "before") is not None
    assert motion(uncured, "after") is None
