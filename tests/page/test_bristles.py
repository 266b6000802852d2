"""LuGre's section: its cycle against the reference, what it says without one, and its numbers."""

from __future__ import annotations

import math
from random import Random
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from stickslip_ref import simulate
from tests.fmu.blocks import log_uniform
from tests.page.settings import NAMES, START, Setting, block, parameters
from tests.page.test_extremes import typed_anywhere

if TYPE_CHECKING:
    from collections.abc import Callable

    from tests.page.window import Window

OWN = {"sigma_0": 1e5, "sigma_1": 300.0, "v_s": 1e-3}
PUBLISHED = (
    {**START, "k": 2.0, "v": 0.1, "c": 0.4, "mu_s": 1.5 / 9.81, "mu_k": 1.0 / 9.81},
    {**OWN, "sigma_1": math.sqrt(1e5)},
)
"""Canudas de Wit et al., IEEE TAC 40 (1995) 419, IV-D."""
CYCLES = {
    "published": (*PUBLISHED, 3),
    "start": (START, OWN, 30),
    "stiff bristles": (START, {**OWN, "sigma_0": 1e7}, 3),
    "slow and damped": ({**START, "v": 0.002, "c": 5.0}, OWN, 3),
    "stiff spring": ({**START, "k": 1e5, "v": 0.001}, {**OWN, "sigma_1": 1000.0}, 25),
}
"""Setting, own numbers, and load-ups with a swing in whose time it is steady."""


def by_reference(p: Setting, own: Setting, rounds: int) -> dict[str, float]:
    """Return the numbers of a cycle in the run of the reference after so many load-ups."""
    contact = parameters(p)
    first = float(contact.F_s) / p["k"] / p["v"]
    stop = first + rounds * (first + 2.0 * math.pi / float(contact.w))
    cycle = simulate(contact, stop, law="lugre", own=own).cycles[-1]
    end = cycle.t_break_away
    times, largest = np.linspace(end - cycle.T, end, 4001), 0.0
    # Once more where friction is largest, as finely as parts per 1e9 of a maximum ask for.
    for _ in range(2):
        run = simulate(contact, end, times=times, law="lugre", own=own)
        largest = max(largest, float(run.F.max()))
        at = int(run.F_friction[1:-1].argmin())
        times = np.linspace(times[at], times[at + 2], 2001)
    found = {name: float(getattr(cycle, name)) for name in ("delta_x", "T", "x_dot_peak")}
    return {**found, "friction_max": -float(run.F_friction.min()), "F_max": largest}


def opened(window: Window, p: Setting, own: Setting) -> list[dict[str, float]]:
    """Load and unfold the section with a setting; return LuGre's numbers and the exact block's."""
    window.open("&".join(f"{name}={value!r}" for name, value in {**p, **own}.items()))
    # Folded, it computes nothing.
    assert window.page.text_content("#bristles-said") == ""
    window.page.click("#bristles summary")
    window.until("document.querySelector('#bristles-said').textContent !== ''")
    rows = "[...document.querySelectorAll('#bristles [data-name]')]"
    cells = "[...row.querySelectorAll('data')].map(e => +e.value)"
    found = window.js(f"{rows}.map(row => [row.dataset.name, {cells}])")
    return [{name: values[n] for name, values in found} for n in range(2)]


@pytest.mark.gate
@pytest.mark.parametrize("name", CYCLES)
def test_the_cycle_is_that_of_the_reference(window: Window, name: str) -> None:
    p, own, rounds = CYCLES[name]
    # Each side repeats its state to 1e-8, and integrates to less.
    assert opened(window, p, own)[0] == pytest.approx(by_reference(p, own, rounds), rel=1e-6)


def test_the_published_case_and_the_exact_block_beside_it(window: Window) -> None:
    lugre, exact = opened(window, *PUBLISHED)
    assert lugre["friction_max"] == pytest.approx(1.4765, abs=1e-4)
    assert lugre["F_max"] == pytest.approx(1.508, abs=5e-4)
    assert exact["friction_max"] == 1.5
    assert "= 158.1 N·s/m is above c = 400 mN·s/m" in window.text("#bristles-said")
    _, exact = opened(window, START, OWN)
    p, cycle = parameters(START), window.cycle
    swing = math.hypot(float(p.Delta), p.v / float(p.w))
    closed = {
        "delta_x": 2.0 * swing + p.v * math.pi / float(p.w),
        "F_max": float(p.mu_k_used * p.N) + p.k * swing,
        "friction_max": float(p.F_s),
        **{name: cycle[name] for name in ("T", "x_dot_peak")},
    }
    assert exact == pytest.approx(closed, rel=1e-12)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"c": 20.0}, "comes to slide evenly at 20 mm/s: it has no cycle"),
        ({"v": 1e-9}, "swings grow too slowly"),
        ({"load": -9.81}, "There is no friction"),
        ({"v": 1e3}, "repeats no period"),
    ],
)
def test_without_a_cycle_it_says_so_and_draws_none(
    window: Window, values: Setting, said: str
) -> None:
    opened(window, {**START, **values}, OWN)
    assert said in window.text("#bristles-said")
    assert not window.page.is_visible("#bristles-loop")
    assert window.page.is_visible("#bristles-reversal") is ("friction" not in said)
    assert not window.has_nonsense()


_ASK = """all => all.map(asked => {
  const { states = [], ...cycle } = stickslip.lugre(...asked);
  const all = [...Object.values(cycle), ...states.flatMap(Object.values)];
  return [cycle.outcome, all.every(x => typeof x !== "number" || Number.isFinite(x))];
})"""
OUTCOMES = {"cycle", "even", "creep", "unsettled", "none"}
TYPED = {"sigma_0": (1.0, 1e12), "sigma_1": (1e-3, 1e9), "v_s": (1e-9, 1e3)}
SLID = {"sigma_0": (1e4, 1e8), "sigma_1": (100.0, 1e4), "v_s": (1e-4, 0.1)}


@pytest.mark.parametrize(
    ("drawn", "ends", "most"), [(typed_anywhere, TYPED, 1), (block, SLID, 0.2)]
)
def test_whatever_is_set_ends_in_a_cycle_or_a_reason(
    window: Window, sized: Callable[[int], int], drawn: Any, ends: Any, most: float
) -> None:
    draw = Random("bristles")
    # From a standstill where the force is rounding, which is no place to stay.
    asked = [[{**START, "k": 10.0}, OWN]]
    for _ in range(sized(400)):
        p = parameters(drawn(draw))
        used = {name: float(getattr(p, name)) for name in NAMES} | {"mu_k": float(p.mu_k_used)}
        asked.append([used, {name: log_uniform(draw, *each) for name, each in ends.items()}])
    outcomes, finite = zip(*window.js(_ASK, asked), strict=True)
    assert outcomes[0] == "cycle"
    assert set(outcomes) <= OUTCOMES
    assert all(finite)
    assert outcomes.count("unsettled") <= most * len(asked)


def test_its_numbers_are_set_refused_and_linked_as_others_are(window: Window) -> None:
    opened(window, START, OWN)
    window.type("sigma_0", "2 N/um")
    window.until("document.querySelector('#bristles [data-name=T] data').value > 0.3")
    window.until("location.hash.includes('sigma_0=2000000')")
    assert "sigma_1" not in window.js("location.hash")
    window.type("sigma_0", "0.0005")
    reason = "“0.0005” is out of range: from 1 to 1000000000000 N/m."
    assert window.said("sigma_0").startswith(reason)
    window.press("v_s", "ArrowRight")
    window.page.click("#story-start")
    window.until("/step=1&sigma_0=2000000&v_s=/.test(location.hash)")
    window.open("sigma_0=-1&v_s=0.01")
    assert "sigma_0: -1 is out of range" in window.text("#address-said")
    # A preset keeps them, an address that leaves them out does not.
    window.preset("violin-bow")
    assert window.page.input_value("#v_s") == "10"
    window.page.evaluate("location.hash = '#k=1234'")
    window.until("document.querySelector('#v_s').value === '1'")
