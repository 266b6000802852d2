"""The velocity of the mass as a sound: its harmonics, its pitch as recorded, and its silences."""

from __future__ import annotations

import math
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
import pytest

from stickslip_ref import steady_cycle
from tests.page.exact import ROUNDING, is_decidable
from tests.page.settings import PRESETS, START, Setting, batch, block, parameters
from tests.page.window import Window, another

if TYPE_CHECKING:
    from playwright.sync_api import Browser

Array = npt.NDArray[np.float64]

RATE = 48000
"""Samples per second [Hz] of a recording."""

FADE = 0.1
"""From here on [s] a recording is at its full level."""

NODES, WEIGHTS = np.polynomial.legendre.leggauss(200)
"""Of an integral over one slip: exact to rounding, as 40 harmonics are 250 rad at most."""


def frequency(p: Setting) -> float:
    return float(steady_cycle(parameters(p)).f)


def harmonics_of_the_motion(window: Window, count: int) -> npt.NDArray[np.complex128]:
    """Return c_n [m/s] of the velocity, x_dot = sum c_n exp(i n W t), from its slip in the page."""
    cycle, p = window.cycle, window.setting
    within = 0.5 * cycle["t_slip"] * (NODES + 1.0)
    times = cycle["F_s"] / (p["k"] * p["v"]) + within
    speeds = window.js("ts => ts.map(t => stickslip.at(t).x_dot)", times.tolist())
    turns = np.outer(np.arange(count), within) / cycle["T"]
    share = 0.5 * cycle["t_slip"] / cycle["T"]
    found: npt.NDArray[np.complex128] = np.exp(-2j * np.pi * turns) @ (WEIGHTS * speeds) * share
    return found


def test_the_harmonics_are_those_of_the_motion(window: Window) -> None:
    drawn = [p for p in batch("sound", 30, 15, 15) if is_decidable(p)]
    judged = [p for p in drawn if steady_cycle(parameters(p)).exists]
    assert len(judged) > 30
    for p in judged:
        window.set(None, **p)
        got, cycle = window.js("stickslip.harmonics(40)"), window.cycle
        own = 0.5 * (np.array(got["cosines"]) - 1j * np.array(got["sines"]))
        own[0] *= 2.0
        off = np.abs(own - harmonics_of_the_motion(window, 41)).max()
        # Near a graze the end of the slip is known to half of the digits, and the time of the slip
        # to its rounding.
        dated = 4.0 * ROUNDING * cycle["w"] * cycle["F_s"] / (p["k"] * p["v"])
        assert off <= (1e-9 + dated) * cycle["x_dot_peak"], p


def recording(window: Window, seconds: float) -> Array:
    samples = window.js("seconds => stickslip.record(seconds).then(s => [...s])", seconds)
    return np.array(samples)[round(FADE * RATE) :]


def test_a_tone_has_the_partials_of_the_cycle_and_a_fair_level(window: Window) -> None:
    draw = Random("tones")
    random = [p for p in (block(draw) for _ in range(30)) if 25.0 < frequency(p) < 5000.0][:3]
    for p in [*(PRESETS[name] for name in ("violin-bow", "brake-pad", "squeaky-drawer")), *random]:
        window.set(**p)
        samples, f = recording(window, 1.6), frequency(p)
        lines = np.abs(harmonics_of_the_motion(window, 8)[1:])[: int(8000.0 / f)]
        # Another pitch by a part in a thousand would have other partials in these windows.
        turns = np.outer(f * np.arange(1, lines.size + 1), np.arange(samples.size)) / RATE
        heard = np.abs(np.exp(-2j * np.pi * turns) @ (np.hanning(samples.size) * samples))
        # The browser computes in single precision and interpolates in tables of some thousands.
        assert heard / heard.max() == pytest.approx(lines / lines.max(), abs=1e-4)
        assert 0.03 < math.sqrt(np.mean(samples**2)) < 0.15
        assert np.abs(samples).max() <= 0.9


def test_below_20_hz_each_slip_is_a_thud_a_period_apart(window: Window) -> None:
    T = 1.0 / frequency(START)
    samples = np.abs(recording(window, FADE + 8.0 * T))
    loud = np.flatnonzero(samples > 0.05 * samples.max())
    begins = loud[np.flatnonzero(np.diff(loud, prepend=-RATE) > 0.5 * T * RATE)]
    assert 7 <= begins.size <= 9
    # The onset of a thud is read from its envelope, to a millisecond or less.
    assert np.diff(begins[1:]).mean() / RATE == pytest.approx(T, rel=1e-3)
    assert np.mean(samples < 1e-3) > 0.2


def scaled_to(f: float) -> Setting:
    """Return the start values with time scaled to a frequency [Hz]: docs/theory.md (18)."""
    q = f / frequency(START)
    return {**START, "k": START["k"] * q * q, "g": START["g"] * q * q, "v": START["v"] * q}


def heard(window: Window) -> str:
    window.drawn()
    window.page.wait_for_timeout(80)
    return window.text("#sound-said")


def test_up_to_half_a_semitone_off_a_key_of_the_piano_it_is_named(window: Window) -> None:
    window.page.click("#sound")
    keys = {27.5: "A,, (A0)", 138.591: "c♯ (C♯3)", 440.0: "a′ (A4)", 4186.01: "c′′′′′ (C8)"}
    for f, name in keys.items():
        for cents in (-45, 45):
            window.set(**scaled_to(f * 2.0 ** (cents / 1200)))
            assert heard(window).endswith(f"Hz, close to {name}.")


def test_what_cannot_be_heard_is_silent_and_says_why(window: Window) -> None:
    window.page.click("#sound")
    for words, p in {
        "Silent: one slip in 28 years.": PRESETS["fault-block"],
        "Silent: one slip in 33 s.": scaled_to(0.0301),
        "Silent: 21.00 kHz is above hearing.": scaled_to(21e3),
        "Steady sliding makes no periodic sound.": {**START, "c": 100.0},
    }.items():
        window.set(**p)
        assert heard(window) == words
        assert not recording(window, 0.3).any()


SPY = """
window.contexts = [];
const { AudioContext: Own } = window;
window.AudioContext = class extends Own {
  constructor(...given) {
    super(...given);
    window.contexts.push(this);
  }
};
window.hide = hidden => {
  Object.defineProperty(document, "hidden", { configurable: true, get: () => hidden });
  document.dispatchEvent(new Event("visibilitychange"));
};
"""
STATE = "wanted => contexts.length === 1 && contexts[0].state === wanted"


def test_nothing_sounds_before_it_is_asked_for_nor_while_hidden(
    browser: Browser, page_file: Path
) -> None:
    with another(browser, page_file, SPY) as window:
        for name in PRESETS:
            window.preset(name)
        window.press("k", "ArrowLeft")
        window.page.click("#play")
        assert heard(window) == ""
        assert window.js("contexts.length") == 0
        window.preset("violin-bow")
        window.page.press("#sound", "Enter")
        window.until(STATE, "running")
        assert window.part("#sound", "aria-pressed") == "true"
        window.js("hide(true)")
        window.until(STATE, "suspended")
        window.js("hide(false)")
        window.until(STATE, "running")
        window.page.press("#sound", "Space")
        window.until(STATE, "suspended")
        window.js("[hide(true), hide(false)]")
        window.press("k", "ArrowLeft")
        assert heard(window) == ""
        window.until(STATE, "suspended")
