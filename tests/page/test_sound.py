"""The velocity of the mass as a sound: its harmonics, its pitch as recorded, and its silences."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from itertools import islice
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import pytest
from mpmath import mp, mpc, mpf

from stickslip_verification import truth
from tests.page.browser import opened, planted
from tests.page.by_python import DIGITS, exact_critical_velocity
from tests.page.comparison import DECIDABLE
from tests.page.exchange import ask
from tests.page.settings import Setting, block, near_critical, presets, with_damping
from tests.page.test_said import clamped, cycle
from tests.page.using import drawn, press, set_values

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

Array = npt.NDArray[np.float64]

BOUND = 1e-9
"""Largest error of a harmonic over the largest velocity of the mass."""

PITCH = 1e-3
"""Largest relative error of a recorded pitch."""

RATE = 48000
"""Samples per second [Hz] of a recording."""

FADE = 0.1
"""From here on [s] a recording is at its full level."""

NUMBERS = (0, 1, 2, 3, 5, 8, 21, 40)
"""Harmonics that are compared."""

HARMONICS = """
({ settings, count }) => settings.map(values => {
  window.stickslip.set(values);
  return window.stickslip.harmonics(count);
})
"""


@cache
def settings() -> tuple[Setting, ...]:
    """Give 300 settings that have a cycle: undamped, damped, and near the critical velocity."""

    def drawn_ones() -> Iterator[Setting]:
        draw = Random("sound")
        while True:
            for kind in (block, block, with_damping, near_critical):
                p = kind(draw)
                v_c = exact_critical_velocity(p, clamped(p))
                if float(v_c / p["v"] - 1) > DECIDABLE:
                    yield p

    return tuple(islice(drawn_ones(), 300))


def exact_harmonics(p: Setting, numbers: Sequence[int]) -> tuple[list[complex], float]:
    """Give harmonics c_n [m/s] of the velocity, x_dot = sum c_n exp(i n W t), and its peak.

    In slip u = x_dot obeys u'' + 2 a u' + w^2 u = w^2 v and is 0 at both ends. Integrated by parts
    against exp(-i y t), with E = exp(-i y t_slip) and u' = a_0, a_1 at the ends, this gives

        (w^2 - y^2 + 2 i a y) I = w^2 v (1 - E)/(i y) + a_0 - a_1 E.
    """
    own = truth.steady_cycle(p, digits=DIGITS)
    assert own is not None
    with mp.workdps(DIGITS):
        m, k, c, v = (mpf(p[name]) for name in ("m", "k", "c", "v"))
        squared = k / m
        gap = mpf(p["mu_s"]) - mpf(float(clamped(p).mu_k_used))
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


@cache
def expected() -> tuple[tuple[list[complex], float], ...]:
    """Give the exact harmonics of the 300 settings."""
    return tuple(exact_harmonics(p, NUMBERS) for p in settings())


def wrong(page: Page) -> list[str]:
    """Give the settings at which a harmonic of the page is not the exact one."""
    question = {"settings": [dict(p) for p in settings()], "count": max(NUMBERS)}
    answers = ask(page, HARMONICS, question)
    found = []
    for p, got, (exact, peak) in zip(settings(), answers, expected(), strict=True):
        for n, c in zip(NUMBERS, exact, strict=True):
            half = 1.0 if n == 0 else 0.5
            own = complex(half * got["cosines"][n], -half * got["sines"][n])
            if not abs(own - c) <= BOUND * peak:
                found.append(f"harmonic {n} is {own}, not {c}, at {p}")
    return found


def test_the_harmonics_are_those_of_the_exact_motion(page: Page) -> None:
    """At 300 settings each harmonic is within 1e-9 of the peak of that in 30 digits."""
    assert not wrong(page)


def test_the_exact_harmonics_are_the_integrals_of_the_motion() -> None:
    """The closed form of the comparison is the quadrature of the velocity over the slip."""
    for p in settings()[:4]:
        own = truth.steady_cycle(p, digits=DIGITS)
        assert own is not None
        (_, got), peak = exact_harmonics(p, [0, 3])
        with mp.workdps(20):
            w = mp.sqrt(mpf(p["k"]) / p["m"])
            zeta = mpf(p["c"]) / (2 * p["m"] * w)
            nu = mp.sqrt(1 - zeta**2)
            lambda_ = mpf(float(clamped(p).Delta)) * w / p["v"]

            def harmonic(t: Any) -> Any:
                # docs/theory.md (3), in units of v and 1/w.
                angle = nu * w * t  # noqa: B023 - called in this turn alone
                sway = mp.cos(angle) - (lambda_ - zeta) / nu * mp.sin(angle)  # noqa: B023
                rho = -mp.exp(-zeta * w * t) * sway  # noqa: B023
                return p["v"] * (1 + rho) * mp.expjpi(-6 * t / own["T"])  # noqa: B023

            pieces = mp.linspace(0, own["t_slip"], 9)
            wanted = complex(mp.quad(harmonic, pieces) / own["T"])
        assert abs(got - wanted) <= 1e-12 * peak


def recording(page: Page, seconds: float) -> Array:
    """Give the samples of the present setting's sound, at its full level."""
    samples = page.evaluate(
        "seconds => window.stickslip.record(seconds).then(s => [...s])", seconds
    )
    return np.array(samples)[round(FADE * RATE) :]


def lines(samples: Array, frequencies: Sequence[float]) -> Array:
    """Give the amplitude of a recording at each frequency [Hz]."""
    window = np.hanning(samples.size)
    t = np.arange(samples.size) / RATE
    waves = np.exp(-2j * np.pi * np.outer(frequencies, t))
    found: Array = 2.0 * np.abs(waves @ (window * samples)) / window.sum()
    return found


def pitch(samples: Array) -> float:
    """Give the frequency [Hz] of the lowest partial of a recording."""
    size = np.abs(np.fft.rfft(samples * np.hanning(samples.size)))
    tops = np.flatnonzero((size[1:-1] > size[:-2]) & (size[1:-1] >= size[2:])) + 1
    top = next(n for n in tops if size[n] > 0.02 * size.max())
    # The top of a parabola through the logarithms.
    left, here, right = np.log(size[top - 1 : top + 2])
    shift = 0.5 * (left - right) / (left - 2.0 * here + right)
    return float((top + shift) * RATE / samples.size)


def tones() -> dict[str, Setting]:
    """Give settings that sound as tones: three of the presets and three random ones."""
    draw = Random("tones")
    found = {name: presets()[name] for name in ("violin-bow", "brake-pad", "squeaky-drawer")}
    while len(found) < 6:
        p = with_damping(draw) if len(found) == 5 else block(draw)
        if 25.0 < float(cycle(p).f) < 5000.0:
            found[f"random {len(found)}"] = p
    return found


@pytest.mark.parametrize("name", tones())
def test_a_tone_has_the_pitch_and_the_partials_of_the_cycle(page: Page, name: str) -> None:
    """The recorded pitch is 1/T within 0.1 %, the partials are the Fourier coefficients."""
    p = tones()[name]
    set_values(page, **p)
    samples = recording(page, 1.6)
    f = float(cycle(p).f)
    assert pitch(samples) == pytest.approx(f, rel=PITCH)
    numbers = range(8)
    exact, _ = exact_harmonics(p, numbers)
    heard = lines(samples, [n * f for n in numbers[1:] if n * f < 8000.0])
    wanted = np.abs(exact[1 : heard.size + 1])
    # The browser computes in single precision and interpolates in tables of some thousand samples.
    assert heard / heard.max() == pytest.approx(wanted / wanted.max(), abs=1e-4)


def test_the_known_pitches(page: Page) -> None:
    """The violin sounds at 440 Hz, the brake at 73 Hz and the drawer at 211 Hz, as recorded."""
    for name, hertz in {"violin-bow": 440, "brake-pad": 73, "squeaky-drawer": 211}.items():
        set_values(page, **presets()[name])
        assert round(pitch(recording(page, 1.1))) == hertz


def test_a_sound_is_neither_faint_nor_too_loud(page: Page) -> None:
    """Every tone has nearly the same effective value, and none is clipped."""
    for p in tones().values():
        set_values(page, **p)
        samples = recording(page, 0.6)
        assert 0.03 < math.sqrt(np.mean(samples**2)) < 0.15
        assert np.abs(samples).max() <= 0.9


def test_below_20_hz_each_slip_is_a_thud(page: Page) -> None:
    """The thuds come a period apart, to 0.1 %, with silence between them."""
    for v in (0.02, 0.2):
        set_values(page, v=v)
        T = float(cycle({**presets()["default"], "v": v}).T)
        samples = np.abs(recording(page, FADE + 8.0 * T))
        loud = np.flatnonzero(samples > 0.05 * samples.max())
        begins = loud[np.flatnonzero(np.diff(loud, prepend=-RATE) > 0.5 * T * RATE)]
        assert 7 <= begins.size <= 9
        apart = np.diff(begins[1:]).mean() / RATE
        assert apart == pytest.approx(T, rel=PITCH)
        assert np.mean(samples < 1e-3) > 0.2


def test_the_thuds_keep_time(page: Page) -> None:
    """A period that is no whole number of the thud's samples is none the longer for it.

    150 periods on, 7.5 s, the sound is the same to the sample; a period 0.1 % off is not.
    """
    period = 2403
    set_values(page, **scaled_to(RATE / period))
    samples = recording(page, 8.5)
    first, later = (
        samples[start : start + period] for start in (RATE // 2, RATE // 2 + 150 * period)
    )
    # The loop turns in single precision.
    assert np.abs(later - first).max() < 0.02 * np.abs(first).max()


NOTES = {
    27.5: "A,, (A0)",
    32.7032: "C, (C1)",
    65.4064: "C (C2)",
    138.591: "c♯ (C♯3)",
    261.626: "c′ (C4)",
    440.0: "a′ (A4)",
    466.164: "a♯′ (A♯4)",
    493.883: "b′ (B4)",
    523.251: "c′′ (C5)",
    4186.01: "c′′′′′ (C8)",
}
"""Frequency [Hz] and name of keys of a piano."""


def scaled_to(f: float) -> Setting:
    """Give the default with its time scaled to a frequency [Hz]: docs/theory.md (18)."""
    p = dict(presets()["default"])
    q = f / float(cycle(p).f)
    return {**p, "k": p["k"] * q * q, "g": p["g"] * q * q, "v": p["v"] * q}


def heard(page: Page) -> str:
    """Give what the page says of its sound, once it has followed the setting."""
    drawn(page)
    page.wait_for_timeout(80)
    return page.inner_text("#sound-said").replace("\u00a0", " ")


def test_the_nearest_note_is_named(page: Page) -> None:
    """A frequency up to half a semitone off a key of the piano is close to it."""
    page.click("#sound")
    for f, name in NOTES.items():
        for cents in (-45, 45):
            set_values(page, **scaled_to(f * 2.0 ** (cents / 1200)))
            assert heard(page).endswith(f"Hz, close to {name}.")


SILENT = {
    "Silent: one slip in 28 years.": presets()["fault-block"],
    "Silent: one slip in 33 s.": scaled_to(0.0301),
    "Silent: 21.00 kHz is above hearing.": scaled_to(21e3),
    "Steady sliding makes no periodic sound.": {**presets()["default"], "c": 100.0},
}


def test_what_cannot_be_heard_is_told(page: Page) -> None:
    """The fault, a slow axis, an ultrasonic one and a sliding one are silent, and say why."""
    page.click("#sound")
    for words, p in SILENT.items():
        set_values(page, **p)
        assert heard(page) == words
        assert not recording(page, 0.3).any()


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
"""


@contextmanager
def spied(browser: Browser, page_file: Path, script: str) -> Iterator[Page]:
    """Open the page after a script of ours."""
    with opened(browser, page_file) as page:
        page.context.add_init_script(script)
        page.reload()
        page.wait_for_function("window.stickslip !== undefined")
        yield page


def counts(page: Page) -> tuple[int, int, int]:
    """Give the contexts made, and the sources started and stopped, up to now."""
    page.wait_for_timeout(120)
    made, started, stopped = page.evaluate(
        "[heard.contexts.length, heard.started, heard.stopped]",
    )
    return made, started, stopped


def state(page: Page, wanted: str) -> None:
    """Wait until the sound device runs, or rests."""
    page.wait_for_function("wanted => heard.contexts[0].state === wanted", arg=wanted)


def test_nothing_sounds_before_it_is_asked_for(browser: Browser, page_file: Path) -> None:
    """Presets, sliders and play make no sound; the button does, and takes it away again."""
    with spied(browser, page_file, SPY) as page:
        for name in presets():
            page.click(f"[data-preset={name}]")
        press(page, "k", "ArrowLeft")
        page.click("#play")
        page.click("#play")
        assert counts(page) == (0, 0, 0)
        assert heard(page) == ""
        page.click("[data-preset=violin-bow]")
        page.press("#sound", "Enter")
        assert page.get_attribute("#sound", "aria-pressed") == "true"
        state(page, "running")
        assert counts(page) == (1, 1, 0)
        page.click("[data-preset=squeaky-drawer]")
        assert counts(page) == (1, 2, 1)
        page.click("[data-preset=fault-block]")
        assert counts(page) == (1, 2, 2)
        page.click("[data-preset=violin-bow]")
        assert counts(page) == (1, 3, 2)
        page.press("#sound", "Space")
        assert page.get_attribute("#sound", "aria-pressed") == "false"
        assert counts(page) == (1, 3, 3)
        state(page, "suspended")
        assert heard(page) == ""
        press(page, "k", "ArrowLeft")
        assert counts(page) == (1, 3, 3)


HIDE = """
hidden => {
  Object.defineProperty(document, "hidden", { configurable: true, get: () => hidden });
  document.dispatchEvent(new Event("visibilitychange"));
}
"""


def test_a_hidden_page_is_silent(browser: Browser, page_file: Path) -> None:
    """While another tab is in front the device rests; back again it runs, if it is still asked."""
    with spied(browser, page_file, SPY) as page:
        page.click("#sound")
        state(page, "running")
        page.evaluate(HIDE, True)
        state(page, "suspended")
        page.evaluate(HIDE, False)
        state(page, "running")
        page.click("#sound")
        state(page, "suspended")
        page.evaluate(HIDE, True)
        page.evaluate(HIDE, False)
        page.wait_for_timeout(100)
        state(page, "suspended")


def test_a_browser_without_sound_says_so(browser: Browser, page_file: Path) -> None:
    """Where no sound can be made the page has no error, and tells it when asked."""
    with spied(browser, page_file, "delete window.AudioContext") as page:
        page.click("#sound")
        assert heard(page) == "This browser plays no sound."
        page.click("[data-preset=violin-bow]")
        assert heard(page) == "This browser plays no sound."


FAULTS = {
    "sine of the wrong sign": (
        "sines.push(-part * (2 * p.v * pull[1] + im));",
        "sines.push(part * (2 * p.v * pull[1] + im));",
    ),
    "damping left out": (
        "const ahead = meanOfExp(-a * t_slip, (b - turn) * t_slip);",
        "const ahead = meanOfExp(0, (b - turn) * t_slip);",
    ),
    "undamped frequency": ("const b = w * Math.sqrt((1 - zeta) * (1 + zeta));", "const b = w;"),
    "pull a trifle slow": (
        "const part = t_slip / T;",
        "const part = (t_slip / T) * (1 - 1e-7);",
    ),
}
"""Faults to plant in the harmonics: a piece of the page's script, and what to put there."""


@pytest.mark.parametrize("name", FAULTS)
def test_a_planted_fault_is_found(
    browser: Browser, page_file: Path, tmp_path: Path, name: str
) -> None:
    """The comparison refutes harmonics that are a little wrong."""
    with planted(browser, page_file, tmp_path, *FAULTS[name]) as page:
        assert wrong(page)
