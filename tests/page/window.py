"""A window with the page in it, and how a person uses it: types, drags, presses, looks."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip_units import typed as read
from tests.page.browser import watched

if TYPE_CHECKING:
    from playwright.sync_api import Browser, BrowserContext

SI = {"k": "N/m", "v": "m/s", "mu_s": "1", "mu_k": "1", "N": "N", "m": "kg", "c": "N.s/m"}
"""The controls, in the order of the page, with their units as the command knows them."""
CURVES = ("#x-chart .curve.mass", "#x-chart .curve.pull", "#F-chart .curve.force")
SIZE = {"width": 1280, "height": 800}
STILL = {"color_scheme": "light", "forced_colors": "none", "media": "screen"}
"""What a window is like when a test begins; nothing moves by itself."""

_CALL = """async asked => {
  const source = (%s);
  const result = typeof source === "function" ? await source(JSON.parse(asked)) : await source;
  const named = (_, value) =>
    typeof value === "number" && !Number.isFinite(value) ? `${value}` : value;
  return JSON.stringify(result ?? null, named);
}"""
_NAMED = {"NaN": math.nan, "Infinity": math.inf, "-Infinity": -math.inf}
_FRAME = "() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"


class Window:
    """One window of the browser, used again and again: `open` loads the page anew."""

    def __init__(self, context: BrowserContext, file: Path) -> None:
        self.page = context.new_page()
        self.errors = watched(self.page)
        self.file = file

    def open(self, fragment: str = "", motion: str = "reduce") -> None:
        """Load the page, with what stands after # in the address, and wait till it answers."""
        self.page.set_viewport_size(SIZE)  # type: ignore[arg-type]
        self.page.emulate_media(reduced_motion=motion, **STILL)  # type: ignore[arg-type]
        self.page.goto("about:blank")
        self.page.goto(self.file.as_uri() + (f"#{fragment}" if fragment else ""))
        self.ready()

    def reload(self) -> None:
        self.page.reload()
        self.ready()

    def ready(self) -> None:
        try:
            self.until("window.stickslip !== undefined")
        except Exception as error:
            error.add_note(f"errors of the page: {self.errors}")
            raise

    def js(self, source: str, asked: object = None) -> Any:
        """Return what an expression or function gives; doubles pass as text, to the last bit."""
        return _numbers(json.loads(self.page.evaluate(_CALL % source, json.dumps(asked))))

    def until(self, condition: str, asked: object = None) -> None:
        self.page.wait_for_function(condition, arg=asked)

    def drawn(self) -> None:
        """Wait until what was asked for is on the screen: the page draws at the next frame."""
        self.page.evaluate(_FRAME)

    def set(self, curve: object = "same", /, **values: float) -> None:
        """Set parameters (SI), and a friction curve or None, as a script does."""
        asked = [values] if curve == "same" else [values, curve]
        self.js("asked => stickslip.set(...asked)", asked)

    @property
    def setting(self) -> Any:
        return self.js("stickslip.setting")

    @property
    def cycle(self) -> Any:
        return self.js("stickslip.cycle")

    @property
    def N(self) -> float:  # noqa: N802 - the symbol
        p = self.setting
        return float(p["m"] * p["g"] + p["load"])

    @property
    def view(self) -> tuple[float, float]:
        found = self.js("stickslip.view")
        return float(found["from"]), float(found["to"])

    def look(self, start: float, end: float) -> None:
        self.js("([from, to]) => { stickslip.view = { from, to }; }", [start, end])

    def states(self, times: Sequence[float]) -> Any:
        return self.js("ts => ts.map(t => stickslip.at(t))", list(times))

    def preset(self, name: str) -> None:
        self.page.click(f"[data-preset={name}]")
        self.drawn()

    def type(self, name: str, text: str) -> None:
        self.page.fill(f"#{name}", text)

    def press(self, slider: str, *keys: str) -> None:
        self.page.focus(f"#{slider}-slider")
        for key in keys:
            self.page.keyboard.press(key)

    def drag(self, name: str, share: float) -> None:
        """Drag the slider of a parameter with the mouse to a share of its length."""
        slider = self.page.locator(f"#{name}-slider")
        slider.scroll_into_view_if_needed()
        left, top, width, height = self.box(f"#{name}-slider")
        low, high, at = (float(slider.evaluate(f"s => s.{end}")) for end in ("min", "max", "value"))
        # The thumb is 16 px wide and stays inside the track.
        places = [left + 8 + (width - 16) * part for part in ((at - low) / (high - low), share)]
        self.pull(places[0], top + height / 2, places[1] - places[0], 0.0)

    def pull(self, x: float, y: float, dx: float, dy: float) -> None:
        self.page.mouse.move(x, y)
        self.page.mouse.down()
        self.page.mouse.move(x + dx, y + dy, steps=5)
        self.page.mouse.up()
        self.drawn()

    def box(self, selector: str) -> tuple[float, float, float, float]:
        box = self.page.locator(selector).first.bounding_box()
        assert box is not None
        return box["x"], box["y"], box["width"], box["height"]

    def text(self, selector: str) -> str:
        self.drawn()
        return self.page.inner_text(selector).replace("\u00a0", " ")

    def part(self, selector: str, name: str) -> str:
        return self.page.get_attribute(selector, name) or ""

    def style(self, selector: str, name: str) -> str:
        source = "(e, name) => getComputedStyle(e)[name]"
        return str(self.page.eval_on_selector(selector, source, name))

    def paths(self) -> Mapping[str, str]:
        self.drawn()
        return {each: self.part(each, "d") for each in (*CURVES, "#phase-chart .curve.mass")}

    def si_of(self, name: str) -> float:
        typed = f"{self.page.input_value(f'#{name}')} {self.page.inner_text(f'#{name}-unit')}"
        return read(typed, SI[name])

    def said(self, name: str) -> str:
        note = self.page.locator(f"#{name}-said")
        return note.inner_text() if note.is_visible() else ""

    def unfold(self) -> None:
        """Unfold everything that can be unfolded, and wait for what is drawn when it is seen."""
        self.page.evaluate("document.querySelectorAll('details').forEach(e => (e.open = true))")

    def pressed(self, kind: str) -> Any:
        """Return the ids of the presets, or of what else has such buttons, shown as chosen."""
        self.drawn()
        chosen = f"document.querySelectorAll('[data-{kind}][aria-pressed=true]')"
        return self.js(f"[...{chosen}].map(each => each.dataset.{kind})")

    def has_nonsense(self) -> bool:
        """Tell whether a text or a curve that is seen holds what is no number."""
        seen = [self.text("body"), *self.paths().values()]
        return any(re.search(r"NaN|undefined|Infinity", each) for each in seen)

    def save(self, button: str, folder: Path) -> Path:
        self.drawn()
        with self.page.expect_download() as download:
            self.page.click(f"#{button}")
        file = folder / download.value.suggested_filename
        download.value.save_as(file)
        return file


@contextmanager
def another(
    browser: Browser, file: Path, script: str = "", fragment: str = "", **options: Any
) -> Iterator[Window]:
    """Give another kind of window, its script before the page's; it must end without an error."""
    options = {"viewport": SIZE, "reduced_motion": "reduce", **options}
    with browser.new_context(**options) as context:
        window = Window(context, file)
        if script:
            context.add_init_script(script)
        window.page.goto(file.as_uri() + (f"#{fragment}" if fragment else ""))
        window.ready()
        yield window
    assert not window.errors, f"errors of the page: {window.errors}"


def _numbers(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _numbers(each) for key, each in value.items()}
    if isinstance(value, list):
        return [_numbers(each) for each in value]
    return _NAMED.get(value, value) if isinstance(value, str) else value
