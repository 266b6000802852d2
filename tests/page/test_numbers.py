"""The page's script against Python, in a real browser, from the page's unrounded values."""

from collections.abc import Callable
from random import Random

import pytest

from tests.page.exact import ASK, DECIDABLE, Exact, ratios
from tests.page.settings import CORNERS, PRESETS, Setting, batch, wide
from tests.page.window import Window

Sized = Callable[[int], int]


def on_the_sliders(size: int) -> list[Setting]:
    return list(batch("page", undamped=size // 2, damped=3 * size // 10, critical=size // 5))


def far_outside(size: int) -> list[Setting]:
    draw = Random("page wide")
    return [wide(draw) for _ in range(size * 4 // 10)]


@pytest.mark.parametrize(
    "drawn",
    [
        on_the_sliders,
        far_outside,
        lambda _: list(CORNERS.values()),
        lambda _: list(PRESETS.values()),
    ],
    ids=["on the sliders", "lambda from 1e-5 to 1e9", "corners", "presets"],
)
def test_cycle_states_and_events_of_the_page_are_those_of_python(
    window: Window, sized: Sized, drawn: Callable[[int], list[Setting]]
) -> None:
    settings = [Exact(each) for each in drawn(sized(1000))]
    judged = [each for each in settings if abs(each.distance) > DECIDABLE]
    assert len(judged) >= 0.99 * len(settings)
    answers = window.js(ASK, [[each.setting, each.times] for each in judged])
    refuted = {}
    for answer, each in zip(answers, judged, strict=True):
        for name, ratio in ratios(answer, each).items():
            if not ratio <= 1.0:
                refuted[name] = f"{ratio:.3g} times its bound at {each.setting}"
    assert not refuted
