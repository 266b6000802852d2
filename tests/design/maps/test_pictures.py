"""Pictures of maps: slices, limits, and the page that holds them."""

import json
import re
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import stickslip as ss
from stickslip_design.maps.page import page
from stickslip_design.maps.views import View, contours
from tests.needs import needs

if TYPE_CHECKING:
    import xarray
    from playwright.sync_api import Browser

OVER = {"v": "1..900 mm/s log 20", "k": "0.1..10 kN/m log 11", "c": "0.5..6 15", "m": "1..9 kg 7"}


@cache
def some_page() -> tuple[View, list["xarray.Dataset"], str, dict[str, Any]]:
    view = View(ss.map(OVER, workers=1))
    text = page(view, view.places(60), view.overall())
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL)
    assert found is not None
    return view, view.slices(view.places(60)), text, json.loads(found[1])


@needs("studies")
def test_a_slice_is_what_the_dataset_has_there() -> None:
    view, slices, _, _ = some_page()
    places = view.places(60)
    # The first picture is nearest to the start values.
    assert view.nearest() == {"c": 0, "m": 0}
    dataset = ss.map(OVER, workers=1)
    for place, part in list(zip(places, slices, strict=True))[::13]:
        there = dataset.isel(place)
        for name in ("delta_x", "regime"):
            expected = there[name].transpose("k", "v")
            np.testing.assert_array_equal(part[name], expected)
        np.testing.assert_array_equal(part["v_c"].values[:, 0], there["v_c"].values)


@needs("studies")
def test_the_limit_that_is_drawn_is_the_critical_velocity() -> None:
    view, slices, _, _ = some_page()
    part = slices[len(slices) // 2]
    border = view.border(part)
    assert border is not None
    (line,) = contours(border, 0.0)
    limits = part["v_c"].values[:, 0]
    rows = np.flatnonzero((limits > view.x.values[0]) & (limits < view.x.values[-1]))
    assert rows.size
    for row in rows:
        column = line[np.argmin(np.abs(line[:, 1] - row)), 0]
        number = np.arange(view.x.values.size)
        expected = np.interp(np.log(limits[row]), np.log(view.x.values), number)
        assert column == pytest.approx(expected, abs=0.01)  # of the distance of two values


@needs("studies")
def test_a_page_has_sixty_slices_at_most_and_says_how_many_values_it_left_out() -> None:
    view, slices, text, data = some_page()
    assert 30 < len(slices) <= 60
    for name, size in (("c", 15), ("m", 7)):
        chosen = sorted({place[name] for place in view.places(60)})
        assert (chosen[0], chosen[-1]) == (0, size - 1)
        # Even, to whole numbers.
        assert np.ptp(np.diff(chosen)) <= 1
        assert len(chosen) == size or f"{len(chosen)} of {size} values are in this page" in text
    # It asks for nothing, and has words for its pictures.
    assert not re.search(r"(?:src|href)=[\"'](?!data:|#)|https?://|url\((?!#)", text)
    assert all("sticks and slips at" in each for each in data["told"])


@needs("studies")
def test_sliders_and_buttons_choose_the_picture_by_keyboard(
    browser: "Browser", tmp_path: Path
) -> None:
    _, _, text, data = some_page()
    file = tmp_path / "index.html"
    file.write_text(text, encoding="utf-8")
    with browser.new_page() as window:
        errors: list[str] = []
        window.on("pageerror", lambda error: errors.append(str(error)))
        window.goto(file.as_uri())
        slider, picture = window.locator("#slider-0"), window.locator("#picture")
        slider.focus()
        slider.press("Home")
        first = window.locator("#told").inner_text()
        slider.press("ArrowRight")
        assert window.locator("#told").inner_text() != first
        place = int(slider.input_value()) * data["counts"][1]
        place += int(window.locator("#slider-1").input_value())
        assert picture.get_attribute("href") == data["pictures"]["delta_x"][place]
        assert window.locator("#limit").get_attribute("d") == data["limits"][place]
        window.get_by_label("Regime").check()
        assert picture.get_attribute("href") == data["pictures"]["regime"][place]
        assert not errors
