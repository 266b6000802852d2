"""What a person takes along: CSV, SVG, PNG, and the command that repeats the run."""

import re
import shlex
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from fmpy.util import read_csv
from matplotlib.image import imread

from stickslip.parameters import Parameters
from tests.page.settings import CORNERS, NAMES, PRESETS, START, block, wide, with_damping
from tests.page.window import Window

COLUMNS = ("time", "x", "x_dot", "x_pull", "z", "F", "F_friction", "F_s", "sticking", "mode")
SVG = "{http://www.w3.org/2000/svg}"
LONG = {"k": 1234.5678901234567, "v": 0.023456789012345678, "mu_s": 0.6000000000000001, "mu_k": 0.1}


def test_the_csv_holds_the_doubles_of_the_page_over_what_is_seen_and_each_event(
    window: Window, tmp_path: Path
) -> None:
    for values in ({}, LONG, PRESETS["fault-block"], CORNERS["far above critical damping"]):
        window.set(**{**START, **values})
        rows, F_s = read_csv(window.save("save-csv", tmp_path)), window.cycle["F_s"]
        assert rows.dtype.names == COLUMNS
        assert (rows["time"][0], rows["time"][-1]) == window.view
        assert np.all(np.diff(rows["time"]) > 0.0)
        events = [each["t"] for each in window.js("v => stickslip.events(...v)", [*window.view])]
        assert {t for t in events if t >= window.view[0]} <= set(rows["time"].tolist())
        assert 2001 <= len(rows) <= 2001 + len(events)
        for row, state in zip(rows, window.states(rows["time"].tolist()), strict=True):
            extra = {"time": row["time"], "F_s": F_s, "sticking": state["mode"] == 0}
            assert row.tolist() == tuple(float((state | extra)[name]) for name in COLUMNS)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_svg_and_png_are_the_pictures_in_the_colours_of_the_page(
    window: Window, tmp_path: Path, scheme: str
) -> None:
    window.page.emulate_media(color_scheme=scheme)  # type: ignore[arg-type]
    values = dict(zip(NAMES, (2.5, 1.62, -1.5, 1234.5, 3.5, 0.55, 0.35, 0.025), strict=True))
    window.set(**{**values, "c": 3.25})
    window.js("stickslip.compare({ c: 3.5 })")
    window.drawn()
    likes = ("#x-chart .curve.mass", "#F-chart .curve.force", "#x-chart .curve.ghost")
    colours = [window.style(like, "stroke") for like in likes]
    drawn = [window.part(like, "d") for like in likes]
    paper = window.style("body", "backgroundColor")
    file = window.save("save-svg", tmp_path)
    pixels = (imread(window.save("save-png", tmp_path))[..., :3] * 255).round().astype(int)

    root = ElementTree.parse(file).getroot()
    assert "var(" not in file.read_text(encoding="utf-8")
    # Nothing else tells a reader of the report of which setting it is.
    caption = " ".join(each.text or "" for each in root.findall(f"{SVG}text"))
    for name, value in values.items():
        symbol = name.replace("mu_s", "μₛ").replace("mu_k", "μₖ")
        assert re.search(rf"\b{symbol} = {value}(?![\d.])", caption), name
    width, height = (float(root.get(side) or "") for side in ("width", "height"))
    # Opened by itself, as any viewer would.
    window.page.goto(file.as_uri())
    for like, colour, path in zip(likes, colours, drawn, strict=True):
        own = like.split(" ")[1]
        assert window.style(own, "stroke") == colour
        found = window.page.locator(own).all()
        assert path in [each.get_attribute("d") for each in found]
    assert window.style(".sheet", "fill") == paper

    # The PNG is twice as fine, on its paper, with its curves.
    assert pixels.shape == (round(2 * height), round(2 * width), 3)
    for colour, fewest in ((colours[0], 500), (colours[1], 500), (paper, 10000)):
        rgb = [int(each) for each in re.findall(r"\d+", colour)[:3]]
        assert (np.abs(pixels - rgb).max(axis=2) <= 2).sum() > fewest


def test_the_command_repeats_the_setting_to_the_last_bit(window: Window) -> None:
    draw = Random("command line")
    kinds: list[Callable[[Random], dict[str, float]]] = [block, with_damping, wide]
    chosen = [make(draw) for make in kinds for _ in range(25)]
    chosen += [LONG, {"v": 1e-9, "k": 1e18, "m": 1e18}, {"m": 1.0, "load": 5.0 - 9.81}]
    chosen += PRESETS.values()
    lines = window.js(
        """all => all.map(values => {
          window.stickslip.set(values);
          const { setting, view } = window.stickslip;
          return [setting, view.to, document.querySelector("#command").textContent];
        })""",
        chosen,
    )
    for setting, end, line in lines:
        program, verb, *rest = shlex.split(line)
        assert (program, verb) == ("stickslip", "simulate")
        options = dict(zip(rest[::2], rest[1::2], strict=True))
        stop = options.pop("--stop-time")
        assert end <= float(stop) <= 1.01 * end
        given: dict[str, Any] = {n[2:].replace("-", "_"): t for n, t in options.items()}
        values = Parameters(**given).values
        assert {name: values[name] for name in setting} == setting
    # In the digits and units that a person types.
    window.preset("machine-slideway")
    typed = "--k 50N/um --v 1mm/s --mu-s 0.2 --mu-k 0.15 --m 500 --c 10kN.s/m"
    assert typed in window.text("#command")


_SHARED = """() => Object.assign(navigator, { canShare: () => true, share: async all => {
  window.shared = [all.url, ...all.files.map(each => [each.name, each.type, each.size > 9000])];
} })"""


def test_the_link_to_a_setting_is_passed_on_with_a_picture_or_copied(window: Window) -> None:
    window.preset("violin-bow")
    window.press("k", "ArrowRight")
    setting = window.setting
    window.page.click("#share")
    window.until("document.querySelector('#share').textContent === 'Link copied'")
    link = window.js("navigator.clipboard.readText()")
    window.js(_SHARED)
    window.page.click("#share")
    window.until("window.shared !== undefined")
    assert window.js("shared") == [link, ["stick-slip.png", "image/png", True]]
    window.open(link.partition("#")[2])
    assert window.setting == setting


def test_the_command_is_copied_or_selected_where_there_is_no_clipboard(window: Window) -> None:
    window.page.click("#copy")
    window.until("document.querySelector('#keep-said').textContent === 'Copied.'")
    assert window.js("navigator.clipboard.readText()") == window.page.inner_text("#command")
    window.js("() => { navigator.clipboard.writeText = () => Promise.reject(); }")
    window.page.click("#copy")
    window.until("String(getSelection()).startsWith('stickslip simulate')")
    assert "Selected" in window.text("#keep-said")
