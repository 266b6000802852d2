"""The velocity of the mass as a sound: its harmonics, its pitch as recorded, and its silences."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cache
from itertools import islice
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import pytest
from mpmath import mp, mpc, mpf

from stickslip_ref import steady_cycle
from stickslip_verification import truth
from tests.page.exact import DECIDABLE, DIGITS, exact_critical_velocity
from tests.page.settings import (
    PRESETS,
    START,
    Setting,
    block,
    near_critical,
    parameters,
    with_damping,
)
from tests.page.window import Window, another

if TYPE_CHECKING:
    from playwright.sync_api import Browser

Array = npt.NDArray[np.float64]

PITCH = 1e-3
"""Largest relative error of a recorded pitch: a bin of the spectrum, by interpolation."""

RATE = 48000
"""Samples per second [Hz] of a recording."""

FADE = 0.1
"""From here on [s] a recording is at its full level."""

NUMBERS = (0, 1, 2, 3, 5, 8, 21, 40)
"""Harmonics that are compared."""


def frequency(p: Setting) -> float:
    return float(steady_cycle(parameters(p)).f)


def settings_with_a_cycle() -> Iterator[Setting]:
    draw = Random("sound")
    while True:
        for kind in (block, block, with_damping, near_critical):
            p = kind(draw)
            if float(exact_critical_velocity(p) / p["v"] - 1) > DECIDABLE:
                yield p


def exact_harmonics(p: Setting, numbers: Sequence[int]) -> tuple[list[complex], float]:
    """Return harmonics c_n [m/s] of the velocity, x_dot = sum c_n exp(i n W t), and its peak.

    In slip u = x_dot obeys u'' + 2 a u' + w^2 u = w^2 v and is 0 at both ends. Integrated by parts
    against exp(-i y t), with E = exp(-i y t_slip) and u' = a_0, a_1 at the ends, this gives

        (w^2 - y^2 + 2 i a y) I = w^2 v (1 - E)/(i y) + a_0 - a_1 E.
    """
    own = truth.steady_cycle(p, digits=DIGITS)
    assert own is not None
    with mp.workdps(DIGITS):
        m, k, c, v = (mpf(p[name]) for name in ("m", "k", "c", "v"))
        squared = k / m
        gap = mpf(p["mu_s"]) - mpf(float(parameters(p).mu_k_used))
        a_0 = gap * (m * mpf(p["g"]) + mpf(p["load"])) / m
        a_1 = a_0 - squared * own["spring_drop"]
        found = [complex(v)]
        for n in numbers[1:]:
            # Without a gap it is at resonance, where this form is 0/0; so near it, it is not.
            y = 2 * mp.pi * n / own["T"] * (1 + mpf("1e-14"))
            E = mp.exp(mpc(0, -y * own["t_slip"]))
            right = squared * v * (1 - E) / mpc(0, y) + a_0 - a_1 * E
            found.append(complex(right / mpc(squared - y * y, c / m * y) / own["T"]))
        return found, float(own["x_dot_peak"])


def test_the_harmonics_are_those_of_the_exact_motion(window: Window) -> None:
    settings = list(islice(settings_with_a_cycle(), 200))
    answers = window.js(
        "all => all.map(p => { stickslip.set(p, null); return stickslip.harmonics(40); })", settings
    )
    for p, got in zip(settings, answers, strict=True):
        exact, peak = exact_harmonics(p, NUMBERS)
        for n, c in zip(NUMBERS, exact, strict=True):
            own = (1.0 if n == 0 else 0.5) * complex(got["cosines"][n], -got["sines"][n])
            # Near a graze the end of the slip is known to half of the digits.
            assert abs(own - c) <= 1e-9 * peak, (n, p)


def recording(window: Window, seconds: float) -> Array:
    """Return the samples of the present setting's sound, at its full level."""
    samples = window.js("seconds => stickslip.record(seconds).then(s => [...s])", seconds)
    return np.array(samples)[round(FADE * RATE) :]


def pitch(samples: Array) -> float:
    """Return the frequency [Hz] of the lowest partial of a recording."""
    size = np.abs(np.fft.rfft(samples * np.hanning(samples.size)))
    tops = np.flatnonzero((size[1:-1] > size[:-2]) & (size[1:-1] >= size[2:])) + 1
    top = next(n for n in tops if size[n] > 0.02 * size.max())
    # The top of a parabola through the logarithms.
    left, here, right = np.log(size[top - 1 : top + 2])
    shift = 0.5 * (left - right) / (left - 2.0 * here + right)
    return float((top + shift) * RATE / samples.size)


@cache
def tones() -> dict[str, Setting]:
    """Return settings that sound as tones: three of the presets and three random ones."""
    draw = Random("tones")
    found: dict[str, Setting] = {
        name: PRESETS[name] for name in ("violin-bow", "brake-pad", "squeaky-drawer")
    }
    while len(found) < 6:
        p = with_damping(draw) if len(found) == 5 else block(draw)
        if 25.0 < frequency(p) < 5000.0:
            found[f"random {len(found)}"] = p
    return found


def test_a_tone_has_the_pitch_and_the_partials_of_the_cycle_and_a_fair_level(
    window: Window,
) -> None:
    known = {"violin-bow": 440, "brake-pad": 73, "squeaky-drawer": 211}
    for name, p in tones().items():
        window.set(**p)
        samples, f = recording(window, 1.6), frequency(p)
        assert pitch(samples) == pytest.approx(f, rel=PITCH)
        assert round(f) == known.get(name, round(f))
        exact, _ = exact_harmonics(p, range(8))
        turns = np.outer([n * f for n in range(1, 8) if n * f < 8000.0], np.arange(samples.size))
        heard = np.abs(np.exp(-2j * np.pi * turns / RATE) @ (np.hanning(samples.size) * samples))
        lines = np.abs(exact[1 : heard.size + 1])
        # The browser computes in single precision and interpolates in tables of some thousands.
        assert heard / heard.max() == pytest.approx(lines / lines.max(), abs=1e-4)
        assert 0.03 < math.sqrt(np.mean(samples**2)) < 0.15
        assert np.abs(samples).max() <= 0.9


def test_below_20_hz_each_slip_is_a_thud_a_period_apart(window: Window) -> None:
    for v in (0.02, 0.2):
        window.set(v=v)
        T = 1.0 / frequency({**START, "v": v})
        samples = np.abs(recording(window, FADE + 8.0 * T))
        loud = np.flatnonzero(samples > 0.05 * samples.max())
        begins = loud[np.flatnonzero(np.diff(loud, prepend=-RATE) > 0.5 * T * RATE)]
        assert 7 <= begins.size <= 9
        assert np.diff(begins[1:]).mean() / RATE == pytest.approx(T, rel=PITCH)
        assert np.mean(samples < 1e-3) > 0.2


def scaled_to(f: float) -> Setting:
    """Return the start values with time scaled to a frequency [Hz]: docs/theory.md (18)."""
    q = f / frequency(START)
    return {**START, "k": START["k"] * q * q, "g": START["g"] * q * q, "v": START["v"] * q}


def heard(window: Window) -> str:
    """Return what the page says of its sound, once it has followed the setting."""
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
window.heard = { contexts: [], started: 0, stopped: 0 };
const { AudioContext: Own } = window;
window.AudioContext = class extends Own {
  constructor(...given) {
    super(...given);
    window.heard.contexts.push(this);
  }
};
for (const name of ["start", "stop"]) {
  const own = AudioScheduledSourceNode.prototype[name];
  const counted = name === "start" ? "started" : "stopped";
  const method = { [name](...given) { window.heard[counted]++; return own.apply(this, given); } };
  AudioScheduledSourceNode.prototype[name] = method[name];
  AudioBufferSourceNode.prototype[name] = method[name];
}
window.hide = hidden => {
  Object.defineProperty(document, "hidden", { configurable: true, get: () => hidden });
  document.dispatchEvent(new Event("visibilitychange"));
};
"""
STATE = "wanted => heard.contexts[0].state === wanted"


def counts(window: Window) -> Any:
    """Return the contexts made, and the sources started and stopped, up to now."""
    window.page.wait_for_timeout(120)
    return window.js("[heard.contexts.length, heard.started, heard.stopped]")


def test_nothing_sounds_before_it_is_asked_for_nor_while_hidden(
    browser: Browser, page_file: Path
) -> None:
    with another(browser, page_file, SPY) as window:
        for name in PRESETS:
            window.preset(name)
        window.press("k", "ArrowLeft")
        window.page.click("#play")
        assert counts(window) == [0, 0, 0]
        assert heard(window) == ""
        window.preset("violin-bow")
        window.page.press("#sound", "Enter")
        window.until(STATE, "running")
        assert window.part("#sound", "aria-pressed") == "true"
        found = [counts(window)]
        for name in ("squeaky-drawer", "fault-block", "violin-bow"):
            window.preset(name)
            found.append(counts(window))
        assert found == [[1, 1, 0], [1, 2, 1], [1, 2, 2], [1, 3, 2]]
        window.js("hide(true)")
        window.until(STATE, "suspended")
        window.js("hide(false)")
        window.until(STATE, "running")
        window.page.press("#sound", "Space")
        window.until(STATE, "suspended")
        window.js("[hide(true), hide(false)]")
        window.press("k", "ArrowLeft")
        assert counts(window) == [1, 3, 3]
        window.until(STATE, "suspended")
        assert heard(window) == ""
