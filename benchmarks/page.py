"""The page in a headless browser: how long a moved slider takes to be seen."""

import shutil
import statistics
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Any

from tests.page.browser import ARGUMENTS

MOVES = 100
ROUNDS = 5
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


class NoBrowserError(Exception):
    """The page cannot be measured here; the message says what is missing."""


@dataclass(frozen=True)
class PageTimes:
    """Times [s], each of the median of some rounds of 100 moves of the slider of k.

    Attributes
    ----------
    median, late
        What the browser is busy with a move: to take it, and from the start of the frame to its
        end, style, layout and paint included. Median and 95th percentile.
    work
        The same without paint: what the page itself does. Median.
    seen
        From the move to the end of its frame, the wait for the frame before included. Median.
    burst
        From the first of 100 moves at once to the end of the frame that shows the last.
    after_burst
        From the move that follows such a burst to the end of its frame.
    """

    median: float
    late: float
    work: float
    seen: float
    burst: float
    after_burst: float


def measure_moves(file: Path) -> PageTimes:
    """Open the page and move its slider.

    Parameters
    ----------
    file
        The page.

    Raises
    ------
    NoBrowserError
        If Playwright or a browser is missing.
    RuntimeError
        If moving the slider does not change the setting.
    """
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
            page = browser.new_page(viewport={"width": 1280, "height": 800})
            page.goto(file.as_uri())
            page.wait_for_function("window.stickslip !== undefined")
            rounds = [page.evaluate(_MEASURE, _positions(n)) for n in range(ROUNDS)]
    if any(each["different"] < MOVES for each in rounds):
        raise RuntimeError("a move of #k-slider did not change the stiffness of the page")
    return PageTimes(
        median=_usual(rounds, "redraw", statistics.median),
        late=_usual(rounds, "redraw", _percentile_95),
        work=_usual(rounds, "work", statistics.median),
        seen=_usual(rounds, "seen", statistics.median),
        burst=_usual(rounds, "burst", float),
        after_burst=_usual(rounds, "after", float),
    )


def _usual(rounds: Sequence[Mapping[str, Any]], name: str, of: Callable[[Any], float]) -> float:
    """Give the median of the rounds' figures, [ms] there and [s] here."""
    return 1e-3 * statistics.median(of(each[name]) for each in rounds)


def _positions(seed: int) -> list[float]:
    """Give 100 different places on the slider, 0 to 1, in random order."""
    positions = [(n + 0.5) / MOVES for n in range(MOVES)]
    Random(seed).shuffle(positions)
    return positions


def _percentile_95(times: Sequence[float]) -> float:
    return statistics.quantiles(times, n=20)[-1]
