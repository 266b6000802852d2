"""Pictures of maps: slices, units, ticks, colours, and the page that holds them."""

import base64
import io
import json
import math
import re
from functools import cache
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import stickslip_design
from stickslip_design.maps import page as page_module
from stickslip_design.maps import pictures
from stickslip_design.maps.page import page, ticks
from stickslip_design.maps.pictures import EVEN, picture
from stickslip_design.maps.views import Side, Unit, Variable, View, colours, contours, unit_of
from tests.needs import needs

if TYPE_CHECKING:
    import xarray
    from playwright.sync_api import Browser

OVER = {"v": "1..900 mm/s log 30", "k": "0.1..10 kN/m log 20", "c": "0.5..6 15", "m": "1..9 kg 7"}


@cache
def some_map() -> "xarray.Dataset":
    """Return a map over four parameters."""
    return stickslip_design.map_(OVER, workers=1)


def some_page() -> tuple[View, str]:
    """Return it, and its page."""
    view = View(some_map())
    slices, told = view.read(view.places(60))
    return view, page(view, slices, told)


def data_of(text: str) -> dict[str, Any]:
    """Return the data of a page."""
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL)
    assert found is not None
    data: dict[str, Any] = json.loads(found[1])
    return data


@pytest.mark.parametrize(
    ("unit", "largest", "typed", "shown"),
    [
        ("m", 3e-3, "", (1e-3, "mm")),
        ("m", 4e-5, "", (1e-6, "µm")),
        ("m", 2000.0, "", (1.0, "m")),
        ("N/m", 5e7, "", (1e6, "N/µm")),
        ("N/m", 5e7, "N/mm", (1e3, "N/mm")),
        ("m/s", 0.05, "mm/min", (1e-3 / 60.0, "mm/min")),
        ("N", 12e3, "", (1e3, "kN")),
        ("N.s/m", 4.0, "", (1.0, "N.s/m")),
        ("1", 0.5, "", (1.0, "")),
    ],
)
def test_values_are_shown_in_the_unit_that_was_typed_or_fits(
    unit: str, largest: float, typed: str, shown: tuple[float, str]
) -> None:
    """Small lengths in millimetres, stiff springs in N/µm."""
    found = unit_of(unit, largest, typed)
    assert found.symbol == shown[1]
    assert found.size == pytest.approx(shown[0], rel=1e-15)


@pytest.mark.parametrize(
    ("values", "log", "labels"),
    [
        (np.geomspace(0.1, 50.0, 100), True, ["0.1", "1", "10"]),
        (np.geomspace(1.0, 50.0, 100), True, ["1", "2", "5", "10", "20", "50"]),
        (np.linspace(0.0, 1.0, 101), False, ["0", "0.2", "0.4", "0.6", "0.8", "1"]),
        (np.array([0.31, 0.4, 0.5]), False, ["0.31", "0.4", "0.5"]),
        (np.geomspace(2.1, 4.9, 60), True, ["2.5", "3", "3.5", "4", "4.5"]),
    ],
)
def test_ticks_are_round_numbers_at_their_places(values: Any, log: bool, labels: list[str]) -> None:
    """Few values have a tick each."""
    found = ticks(Side("v", "", values, Unit(1.0, ""), log), 100.0)
    assert [each.label for each in found] == labels
    assert all(a.at < b.at for a, b in pairwise(found))
    if labels[0] == str(values[0]):
        assert found[0].at == pytest.approx(50.0 / values.size, abs=0.01)


def test_colours_go_from_nothing_or_by_ratios() -> None:
    """By ratios where the largest is fifty times the smallest; shares of a period never."""
    wide = colours("m", [np.array([1e-5, 1e-2]), np.array([np.nan, 0.0])])
    assert (wide.low, wide.high) == pytest.approx((0.01, 10.0))
    assert wide.log
    np.testing.assert_allclose(wide.part(np.array([1e-5, 1e-2])), [0.0, 1.0], atol=1e-12)
    assert not colours("m", [np.array([1e-3, 1e-2])]).log
    assert not colours("1", [np.array([1e-3, 1.0])]).log
    assert colours("m", [np.zeros(3)]).high == 1.0
    # A pull backward gives the jumps the other sign.
    assert colours("m", [np.array([-1e-3, -1e-2])]) == colours("m", [np.array([1e-3, 1e-2])])


def test_lines_stand_in_the_middle_between_two_values() -> None:
    """Of a picture of two by two values, in the page; by the scale of a side in the file."""
    assert page_module._path(np.array([[-1.0, 1.0], [-1.0, 1.0]]), 0.0).startswith("M320.0 ")
    for log, middle in ((True, math.sqrt(10.0)), (False, 5.5)):
        side = Side("v", "", np.array([1.0, 10.0]), Unit(1.0, ""), log)
        assert pictures._at(side, np.array([0.5])) == pytest.approx(middle, rel=1e-12)
    bar = page_module._bar(Variable("delta_x", "Jump"), colours("m", [np.array([1e-3, 1e-2])]))
    assert bar.ticks[-1].label == "10"


@needs("studies")
def test_slices_follow_the_sliders_and_the_block_itself_is_shown() -> None:
    """The last slider is the fastest; the first picture is nearest to the start values."""
    view = View(some_map())
    places = view.places(60)
    assert places == sorted(places, key=lambda each: (each["c"], each["m"]))
    assert view.nearest() == {"c": 0, "m": 0}
    point = page_module._point(view)
    assert point is not None
    # k = 1 kN/m stands in the middle of 0.1 to 10 kN/m, v = 20 mm/s at log 20/log 900.
    x, y, _ = point
    assert x == pytest.approx(640.0 * (math.log(20.0) / math.log(900.0)), abs=12.0)
    assert y == pytest.approx(220.0, abs=1.0)


@needs("studies")
def test_a_slice_is_what_the_dataset_has_there() -> None:
    """Read in one pass with all others, each in its place; of a variable with fewer sides too."""
    dataset = some_map()
    view = View(dataset)
    places = [{"c": 3, "m": 1}, {"c": 14, "m": 6}]
    slices, told = view.read(places)
    for place, part in zip(places, slices, strict=True):
        there = dataset.isel(place)
        for name in ("delta_x", "regime"):
            wanted = there[name].transpose("k", "v").values
            np.testing.assert_array_equal(part.columns[name], wanted)
        np.testing.assert_array_equal(part.columns["v_c"][:, 0], there["v_c"].values)
    regime = dataset["regime"].values
    assert told[0] == (
        f"{regime.size} points: sticks and slips at {100.0 * np.mean(regime == 1):.1f} %, moves "
        f"evenly at {100.0 * np.mean(regime == 0):.1f} %"
    )
    assert re.match(r"largest jump [\d.]+ m at v = [\d.]+ mm/s, k = [\d.]+ kN/m, c =", told[1])


@needs("studies")
def test_the_limit_that_is_drawn_is_the_critical_velocity() -> None:
    """The line stands at v_c to a hundredth of the distance of two values."""
    view = View(some_map())
    (part,), _ = view.read([{"c": 7, "m": 3}])
    border = view.border(part)
    assert border is not None
    (line,) = contours(border, 0.0)
    number = np.arange(view.x.values.size)
    limits = part.columns["v_c"][:, 0]
    inside = (limits > view.x.values[0]) & (limits < view.x.values[-1])
    for row in np.flatnonzero(inside):
        column = line[np.argmin(np.abs(line[:, 1] - row)), 0]
        wanted = np.interp(np.log(limits[row]), np.log(view.x.values), number)
        assert column == pytest.approx(wanted, abs=0.01)


@needs("studies")
def test_a_page_has_sixty_slices_at_most_and_says_how_many_values_it_left_out() -> None:
    """Chosen evenly, both ends among them."""
    view, text = some_page()
    places = view.places(60)
    assert 30 < len(places) <= 60
    for name, size in (("c", 15), ("m", 7)):
        chosen = sorted({each[name] for each in places})
        assert chosen[0] == 0
        assert chosen[-1] == size - 1
        assert np.ptp(np.diff(chosen)) <= 1
        if len(chosen) < size:
            assert f"{len(chosen)} of {size} values are in this page" in text
    data = data_of(text)
    assert data["pictures"].keys() == {"delta_x", "f", "stick_share", "regime"}
    assert all(len(each) == len(places) for each in data["pictures"].values())
    assert len(data["limits"]) == len(data["told"]) == len(places)


@needs("studies")
def test_a_page_asks_for_nothing_and_has_words_for_its_pictures() -> None:
    """No address but of data; each slice is told in a sentence."""
    _, text = some_page()
    assert not re.search(r"(?:src|href)=[\"'](?!data:|#)|https?://|url\((?!#)", text)
    assert all("sticks and slips at" in each for each in data_of(text)["told"])


@needs("studies")
def test_a_picture_of_the_page_is_coloured_as_the_map_is() -> None:
    """Even motion has its own colour; the largest jump is the brightest."""
    from PIL import Image

    view, text = some_page()
    places = view.places(60)
    slices, _ = view.read(places)
    encoded = data_of(text)["pictures"]["delta_x"][-1].partition("base64,")[2]
    image = np.asarray(Image.open(io.BytesIO(base64.b64decode(encoded))).convert("RGB"))[::-1]
    even = slices[-1].columns["regime"] == 0
    assert 0 < even.sum() < even.size
    colour = [int(EVEN[n : n + 2], 16) for n in (1, 3, 5)]
    np.testing.assert_array_equal(np.all(image == colour, axis=-1), even)
    jump = np.where(even, 0.0, slices[-1].columns["delta_x"])
    light = np.where(even, 0, image.sum(axis=-1, dtype=int))
    assert light.ravel()[np.argmax(jump)] == light.max()


@needs("studies")
def test_a_picture_is_drawn_of_any_two_parameters() -> None:
    """Also of a map without v, without a limit, and of two values by two."""
    maps: tuple[dict[str, str | list[float]], ...] = (
        {"k": "1..2 kN/m 2", "mu_k": [0.1, 0.6]},
        {"v": [-0.02, 0.0, 0.02], "k": "1..2 kN/m 3"},
    )
    for over in maps:
        view = View(stickslip_design.map_(over, values={"c": 2.0}, workers=1))
        (part,), told = view.read([view.nearest()])
        assert picture(view, part).startswith(b"\x89PNG")
        assert data_of(page(view, [part], told))["counts"] == []


@needs("studies")
def test_sliders_and_buttons_choose_the_picture_by_keyboard(
    browser: "Browser", tmp_path: Any
) -> None:
    """Arrow keys move a slider: picture, limit and words follow; the page logs no error."""
    _, text = some_page()
    data = data_of(text)
    file = tmp_path / "index.html"
    file.write_text(text, encoding="utf-8")
    with browser.new_page() as window:
        errors: list[str] = []
        window.on("pageerror", lambda error: errors.append(str(error)))
        window.goto(file.as_uri())
        slider = window.locator("#slider-0")
        slider.focus()
        slider.press("Home")
        first = window.locator("#told").inner_text()
        slider.press("ArrowRight")
        assert window.locator("#told").inner_text() != first
        place = int(slider.input_value()) * data["counts"][1]
        place += int(window.locator("#slider-1").input_value())
        assert (
            window.locator("#picture").get_attribute("href") == data["pictures"]["delta_x"][place]
        )
        assert window.locator("#limit").get_attribute("d") == data["limits"][place]
        window.get_by_label("Regime").check()
        assert window.locator("#picture").get_attribute("href") == data["pictures"]["regime"][place]
        assert not errors
