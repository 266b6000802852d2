"""The page's script against Python, in a real browser, from the page's unrounded values."""

from __future__ import annotations

import functools
import math
import struct
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING

import pytest

from tests.page import settings
from tests.page.browser import planted
from tests.page.by_python import Expected, expected
from tests.page.comparison import Ratios, answers, decidable, ratios
from tests.page.exchange import ask

if TYPE_CHECKING:
    from collections.abc import Callable

    from playwright.sync_api import Browser, Page

BATCHES = 10
"""Of 100 settings each."""
SEEDS = [0, *(pytest.param(seed, marks=pytest.mark.soak) for seed in range(1, BATCHES))]


def worst(page: Page, batch: tuple[Expected, ...]) -> tuple[Ratios, dict[str, settings.Setting]]:
    """Give the largest ratio of error to bound for each quantity, and the setting it is from."""
    largest: Ratios = {}
    where: dict[str, settings.Setting] = {}
    for answer, each in zip(answers(page, batch), batch, strict=True):
        for name, ratio in ratios(answer, each).items():
            severity = math.inf if math.isnan(ratio) else ratio
            if severity >= largest.get(name, 0.0):
                largest[name], where[name] = severity, each.setting
    return largest, where


def refuted(page: Page, batch: tuple[Expected, ...]) -> dict[str, str]:
    """Give every quantity that breaks its bound, how far, and where."""
    largest, where = worst(page, batch)
    return {
        name: f"{ratio:.3g} times its bound at {where[name]}"
        for name, ratio in largest.items()
        if ratio > 1.0
    }


@functools.cache
def drawn(seed: int) -> tuple[Expected, ...]:
    """Give the 100 settings of a seed, half of them damped, and what Python says of them."""
    chosen = settings.batch(f"page {seed}", undamped=50, damped=30, critical=20)
    return tuple(expected(each) for each in chosen)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_page_computes_what_python_computes(page: Page, seed: int) -> None:
    """At 1,000 random settings the page's read-outs, states and events are those of Python."""
    assert not refuted(page, drawn(seed))


def test_few_settings_are_too_near_the_critical_velocity_to_be_judged(
    sized: Callable[[int], int],
) -> None:
    """Of 1,000 random settings, at most one in a hundred is left out as undecidable."""
    every = [each for seed in range(sized(BATCHES)) for each in drawn(seed)]
    assert len(every) == sized(1000)
    assert sum(not decidable(each) for each in every) <= sized(10)


def test_far_outside_the_sliders_the_page_still_computes_what_python_computes(page: Page) -> None:
    """From lambda = 1e-5 to 1e9 the page's numbers are those of Python."""
    draw = Random("page wide")
    assert not refuted(page, tuple(expected(settings.wide(draw)) for _ in range(40)))


def test_a_corner_is_no_exception(page: Page) -> None:
    """Where a formula takes another branch or ends, the page's numbers are those of Python."""
    assert not refuted(page, tuple(expected(settings.corner(name)) for name in settings.CORNERS))


def test_the_presets_are_computed_as_python_computes_them(page: Page) -> None:
    """What the page offers by name is right to the last digits."""
    chosen = settings.presets()
    assert len(chosen) >= 6
    assert not refuted(page, tuple(expected(each) for each in chosen.values()))


def test_doubles_pass_to_the_page_and_back_unchanged(page: Page) -> None:
    """What is compared is what the page has to the last bit, infinities and no-numbers too."""
    draw = Random("doubles")
    patterns = [draw.getrandbits(64).to_bytes(8, "little") for _ in range(1000)]
    numbers: list[float] = [struct.unpack("<d", pattern)[0] for pattern in patterns]
    numbers = [n for n in numbers if math.isfinite(n)] + [5e-324, 0.1, 1.0 + 2.0**-52]
    back = ask(page, "numbers => [...numbers, -1 / 0, 1 / 0, 0 / 0]", numbers)
    assert math.isnan(back.pop())
    assert [float(n).hex() for n in back] == [n.hex() for n in [*numbers, -math.inf, math.inf]]


FAULTS = {
    "slip a few 1e-12 too long": (
        "duration: 2 * (Math.PI - Math.atan(lambda_)),",
        "duration: 2.00000000001 * (Math.PI - Math.atan(lambda_)),",
        "t_slip",
    ),
    "damped slip too long": (
        "const minimum = (2 * Math.PI - angle) / nu;",
        "const minimum = (2.00000000001 * Math.PI - angle) / nu;",
        "T, exactly",
    ),
    "peak without the pull": (
        "peak: 1 + Math.hypot(1, lambda_),",
        "peak: 1 + lambda_,",
        "x_dot_peak",
    ),
    "clamp with another gap": ("const CLAMP_GAP = 0.01;", "const CLAMP_GAP = 0.02;", "setting"),
    "damping left out of friction": (
        "const F_friction = -(mode * kinetic(speed) + p.c * speed);",
        "const F_friction = -mode * kinetic(speed);",
        "F_friction",
    ),
    "mass a trifle ahead": (
        "displacement: p.v * H + Delta * G,",
        "displacement: p.v * H + 1.0000000001 * Delta * G,",
        "x",
    ),
    "critical velocity to first order": (
        "w * Delta * Math.exp(-logCriticalLambda(zeta))",
        "w * Delta / Math.sqrt(4 * Math.PI * zeta)",
        "v_c",
    ),
}
"""Faults to plant: a piece of the page's script, what to put there, what must give it away."""


@pytest.mark.parametrize("name", FAULTS)
def test_a_planted_fault_is_found(
    browser: Browser, page_file: Path, tmp_path: Path, name: str
) -> None:
    """The comparison refutes a page that is wrong, be it in the twelfth digit."""
    piece, fault, gives_away = FAULTS[name]
    with planted(browser, page_file, tmp_path, piece, fault) as page:
        assert gives_away in refuted(page, drawn(0)[::3])
