"""The page in a headless browser: from file to first picture, from a moved slider to its redraw."""

import shutil
import statistics
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Any, NamedTuple

from tests.page.browser import ARGUMENTS

if TYPE_CHECKING:
    from playwright.sync_api import Browser

MOVES = 100
ROUNDS = 5
OPENINGS = 9
PLACES = {"top": "h1", "story": "#story", "maps": "#maps"}
"""What is scrolled into sight while a slider is moved."""
# A frame as soon as there is one: what is timed is the page and not the wait for a tick.
FRAMES_AT_ONCE = ("--disable-frame-rate-limit", "--disable-gpu-vsync")

_MEASURE = """
async positions => {
  const slider = document.querySelector("#k-slider");
  const low = Number(slider.min), high = Number(slider.max);
  const move = position => {
    slider.value = low + position * (high - low);
    slider.dispatchEvent(new Event("input", { bubbles: true }));
  };
  const frame = act => new Promise(done => requestAnimationFrame(() => done(act())));
  // A message that is posted in a frame arrives when its style, layout and paint are done.
  const painted = () => new Promise(done => requestAnimationFrame(() => {
    const channel = new MessageChannel();
    channel.port1.onmessage = () => done(performance.now());
    channel.port2.postMessage(null);
  }));
  const idle = async () => { for (let n = 0; n < 3; n++) await painted(); };
  const stiffness = () => window.stickslip.setting.k;

  const redraw = [], seen = [], work = [], settings = new Set();
  for (const position of positions) {
    const frameBegins = frame(() => performance.now());
    const begin = performance.now();
    move(position);
    const handled = performance.now();
    const end = await painted();
    redraw.push(handled - begin + end - await frameBegins);
    seen.push(end - begin);
    settings.add(stiffness());
  }
  for (const position of positions.toReversed()) {
    const frameBegins = frame(() => performance.now());
    const begin = performance.now();
    move(position);
    const handled = performance.now();
    const laidOut = await frame(() => {
      document.body.getBoundingClientRect();
      return performance.now();
    });
    work.push(handled - begin + laidOut - await frameBegins);
    await painted();
  }
  await idle();
  const begin = performance.now();
  for (const position of positions) move(position);
  const burst = await painted() - begin;
  const then = performance.now();
  move(positions[0]);
  const after = await painted() - then;
  return { redraw, seen, work, burst, after, different: settings.size };
}
"""


OPENING = """
window.opening = new Promise(done => {
  let first = Infinity, shift = 0;
  new PerformanceObserver(list => {
    for (const entry of list.getEntries())
      if (entry.startTime > first && !entry.hadRecentInput) shift += entry.value;
  }).observe({ type: "layout-shift", buffered: true });
  const look = () => {
    if (window.stickslip === undefined) return requestAnimationFrame(look);
    const channel = new MessageChannel();
    channel.port1.onmessage = () => {
      first = performance.now();
      setTimeout(() => done({ first, shift }), 1000);
    };
    channel.port2.postMessage(null);
  };
  requestAnimationFrame(look);
});
"""
"""Script that runs before the page's own: `opening` becomes the time of the first picture [ms] and
the layout shift in the second after it, of what moves without a person."""


class NoBrowserError(Exception):
    """The page cannot be measured here; the message says what is missing."""


class Opening(NamedTuple):
    """The opening of a page file.

    `first` is the time from the navigation to the end of the frame after the script has drawn [s],
    median; `shift` the cumulative layout shift in the second that follows [1], the largest.
    """

    first: float
    shift: float


@contextmanager
def _launched() -> Iterator["Browser"]:
    """Launch the browser; `NoBrowserError` if Playwright or the browser is missing."""
    try:
        # An extra: the other benchmarks run without it.
        from playwright.sync_api import Error, sync_playwright
    except ImportError:
        raise NoBrowserError("Playwright is missing: pip install '.[page]'") from None
    with sync_playwright() as playwright:
        try:
            browser = playwright.chromium.launch(
                executable_path=shutil.which("chromium"), args=[*ARGUMENTS, *FRAMES_AT_ONCE]
            )
        except Error as error:
            reason = error.message.splitlines()[0]
            raise NoBrowserError(f"no browser starts, install chromium ({reason})") from None
        with browser:
            yield browser


def measure_opening(file: Path) -> Opening:
    """Open a page some times, each in a fresh context; `NoBrowserError` without a browser."""
    seen: list[dict[str, float]] = []
    with _launched() as browser:
        for _ in range(OPENINGS):
            with browser.new_context(viewport={"width": 1280, "height": 800}) as context:
                page = context.new_page()
                page.add_init_script(OPENING)
                page.goto(file.as_uri())
                page.wait_for_function("window.stickslip !== undefined")
                seen.append(page.evaluate("window.opening"))
    first = statistics.median(opening["first"] for opening in seen)
    return Opening(1e-3 * first, max(opening["shift"] for opening in seen))


def measure_moves(file: Path) -> dict[str, dict[str, float]]:
    """Open the page and move its slider, with each of `PLACES` in sight; return times [s].

    Each is the median of some rounds of 100 moves of the slider of k:

    - "median", "late": what the browser is busy with a move, to take it, and from the start of the
      frame to its end, style, layout and paint included; median and 95th percentile.
    - "work": the same without paint. "seen": from the move to the end of its frame, the wait for
      the frame before included. Medians.
    - "burst": from the first of 100 moves at once to the end of the frame that shows the last;
      "after": from the move that follows such a burst to the end of its frame.

    Raises
    ------
    NoBrowserError
        If Playwright or a browser is missing.
    RuntimeError
        If moving the slider does not change the setting.
    """
    times = {}
    with _launched() as browser:
        page = browser.new_page(viewport={"width": 1280, "height": 800})
        page.goto(file.as_uri())
        page.wait_for_function("window.stickslip !== undefined")
        for place, selector in PLACES.items():
            element = page.query_selector(selector)
            if element is None:
                continue
            element.scroll_into_view_if_needed()
            rounds = [page.evaluate(_MEASURE, _positions(n)) for n in range(ROUNDS)]
            if any(each["different"] < MOVES for each in rounds):
                raise RuntimeError("a move of #k-slider did not change the stiffness of the page")
            times[place] = {
                name: 1e-3 * statistics.median(of(each[key]) for each in rounds)
                for name, key, of in _FIGURES
            }
    return times


_FIGURES: tuple[tuple[str, str, Callable[[Any], float]], ...] = (
    ("median", "redraw", statistics.median),
    ("late", "redraw", lambda times: statistics.quantiles(times, n=20)[-1]),
    ("work", "work", statistics.median),
    ("seen", "seen", statistics.median),
    ("burst", "burst", float),
    ("after", "after", float),
)
"""Name of a time, what the page's script calls it, and what is made of the 100 of a round."""


def _positions(seed: int) -> list[float]:
    """Give 100 different places on the slider, 0 to 1, in random order."""
    positions = [(n + 0.5) / MOVES for n in range(MOVES)]
    Random(seed).shuffle(positions)
    return positions
