"""The cures of the page: their numbers against the exact solution, and what a button does."""

import math
from collections.abc import Iterator
from dataclasses import replace
from random import Random
from typing import Any

import numpy as np
import pytest

from stickslip_ref import Parameters, coulomb_limit, steady_cycle
from stickslip_verification import truth
from tests.page.exact import is_decidable
from tests.page.settings import NAMES, PRESETS, batch, parameters
from tests.page.window import Window

NEAR = 1e-9
"""Largest relative error of a searched root, and the distance to a limit of the cycle at which its
two sides are told apart: rounding of the parameters moves it by 1e-16 times at most 1e3."""

PRESS = """
async settings => {
  const seen = [];
  for (const asked of settings) {
    window.stickslip.set(asked);
    const values = window.stickslip.setting;
    await new Promise(done => setTimeout(done, 300));
    for (const row of document.querySelectorAll("[data-cure]")) {
      for (const [index, cell] of [...row.querySelectorAll("td")].entries()) {
        const button = cell.querySelector("button");
        if (button.hidden) continue;
        const before = window.stickslip.cycle.delta_x;
        button.click();
        const { exists, delta_x } = window.stickslip.cycle;
        const now = window.stickslip.setting;
        seen.push({
          aim: ["halve", "end"][index], before, exists, delta_x, values, now,
          changed: Object.keys(now).filter(name => now[name] !== values[name]),
          parameter: row.dataset.parameter,
        });
        window.stickslip.set(values);
      }
    }
  }
  return seen;
}
"""


def loaded_and_lifted(size: int) -> list[dict[str, float]]:
    """Draw settings, each third one with a load or a lift."""
    draw = Random("cures of the page")
    chosen = list(batch("cures of the page", 2 * size // 5, 7 * size // 20, size // 4))
    for each in chosen[::3]:
        each["load"] = each["m"] * each["g"] * draw.choice([-0.9, -0.3, 0.5, 2.0, 5.0, 30.0])
    return [each for each in chosen if is_decidable(each)]


def blocks(count: int) -> Iterator[Parameters]:
    """Draw blocks with a cycle, undamped or damped, with load, lift and without."""
    draw = Random("cures")
    while count:
        mu_s = draw.uniform(0.02, 1.5)
        m, g, k = (math.exp(draw.uniform(*ends)) for ends in ((-5, 5), (0, 3.4), (2, 9)))
        zeta = draw.choice([0.0, math.exp(draw.uniform(-9, -0.1))])
        block = Parameters(
            m=m, g=g, load=m * g * draw.choice([0.0, 0.0, -0.9, -0.3, 1.0, 3.0, 30.0]), k=k,
            c=2.0 * zeta * math.sqrt(k * m), mu_s=mu_s,
            mu_k=mu_s * (1.0 - math.exp(draw.uniform(-6.9, 0.0))),
            v=math.exp(draw.uniform(-9, -1)),
        )  # fmt: skip
        if steady_cycle(block).exists:
            count -= 1
            yield block


def exact_jump(p: Parameters) -> float | None:
    """Return the jump [m] in high precision, None without a cycle."""
    cycle = truth.steady_cycle(settings_of(p))
    return None if cycle is None else abs(float(cycle["delta_x"]))


def settings_of(p: Parameters) -> dict[str, float]:
    return {name: float(getattr(p, name)) for name in NAMES}


def cures(window: Window, blocks: list[Parameters]) -> list[Any]:
    return list(
        window.js(
            "all => all.map(p => (stickslip.set(p, null), stickslip.cures(stickslip.setting)))",
            [settings_of(p) for p in blocks],
        )
    )


def at(p: Parameters, cure: Any, value: Any) -> Parameters:
    return replace(p, **{cure["parameter"]: value})


def beside(p: Parameters, cure: Any, by: float) -> float:
    """Return a cure's limit, moved by a part of its distance to where nothing presses."""
    base = {"gap": float(p.mu_s), "normal force": -float(p.m) * float(p.g)}.get(cure["name"], 0.0)
    further = 1.0 if cure["name"] in ("stiffer", "damping", "faster") else -1.0
    return float(base + (cure["end"] - base) * (1.0 + further * by))


def test_a_halving_value_halves_the_jump_and_a_limit_ends_the_cycle(window: Window) -> None:
    drawn = [*blocks(16), *(parameters(each) for each in PRESETS.values())]
    halving = limits = 0
    for p, found in zip(drawn, cures(window, drawn), strict=True):
        jump = exact_jump(p)
        assert jump is not None
        # Roundings times the conditioning of the parameters drawn.
        assert found["jump"] == pytest.approx(jump, rel=1e-12)
        for cure in found["cures"]:
            assert (cure["halve"] is None) is (cure["least"] > 0.5)
            if cure["halve"] is not None:
                halving += 1
                halved = exact_jump(at(p, cure, cure["halve"]))
                assert halved == pytest.approx(0.5 * jump, rel=NEAR)
            if cure["end"] is not None:
                limits += 1
                assert exact_jump(at(p, cure, beside(p, cure, -NEAR))) is not None, cure
                assert exact_jump(at(p, cure, beside(p, cure, NEAR))) is None, cure
            if p.c == 0.0:
                assert (cure["end"] is not None) is (cure["name"] == "damping")
            if cure["name"] == "damping":
                assert cure["least"] > 0.5
    assert min(halving, limits) > 30


def test_on_the_way_to_a_cure_the_jump_falls_all_the_time(window: Window) -> None:
    drawn = list(blocks(20))
    for p, found in zip(drawn, cures(window, drawn), strict=True):
        jump = found["jump"]
        for cure in found["cures"]:
            sign = 1.0 if cure["name"] in ("softer", "faster") else -1.0
            goal = cure["halve"] if cure["end"] is None else beside(p, cure, -NEAR)
            if goal is None:
                continue
            # A second limit or halving value before the one given would show.
            jumps = np.abs(steady_cycle(at(p, cure, np.linspace(cure["now"], goal, 40))).delta_x)
            assert np.isfinite(jumps).all(), cure
            # Roundings of the jump.
            assert (sign * np.diff(jumps) >= -1e-12 * jump).all(), cure
            assert np.min(jumps) >= cure["least"] * jump * (1.0 - 1e-12), cure


def test_where_load_brings_the_cycle_back_the_first_limit_is_given(window: Window) -> None:
    p = Parameters(m=100.0, g=10.0, load=300.0, k=1e6, c=60.0, mu_s=0.3, mu_k=0.2)
    masses = np.geomspace(1.0, 100.0, 400)
    v_c = np.asarray(coulomb_limit(replace(p, m=masses)))
    lowest = int(np.argmin(v_c))
    assert 0 < lowest < 399
    p = replace(p, v=1.0001 * float(v_c[lowest]))
    [found] = cures(window, [p])
    (lighter,) = (each for each in found["cures"] if each["name"] == "lighter")
    # Near its minimum the limit is flat.
    assert lighter["end"] == pytest.approx(float(masses[lowest]), rel=0.05)
    for factor, exists in ((1.0 + NEAR, True), (1.0 - NEAR, False), (0.3, True)):
        assert (exact_jump(replace(p, m=factor * lighter["end"])) is not None) == exists


@pytest.mark.parametrize("p", [Parameters(c=20.0, v=1.0), Parameters(c=1e4)])
def test_a_block_without_cycle_needs_no_cure(window: Window, p: Parameters) -> None:
    [found] = cures(window, [p])
    assert found["cures"] == []
    assert found["jump"] is None or math.isnan(found["jump"])


@pytest.fixture
def table(window: Window) -> Window:
    window.page.locator("#cures").scroll_into_view_if_needed()
    window.until("document.querySelector('#cures-lead').textContent !== ''")
    return window


def test_a_button_halves_the_jump_or_ends_the_cycle_and_changes_nothing_else(table: Window) -> None:
    pressed = table.js(PRESS, [*PRESETS.values(), *loaded_and_lifted(100)[50:56]])
    for each in pressed:
        assert each["changed"] == [each["parameter"]], each
        if each["aim"] == "end":
            assert each["exists"] is False, each
            name = each["parameter"]
            [found] = cures(table, [parameters(each["values"])])
            # A round value, at most 2 % beyond the limit.
            ends = [cure["end"] or math.inf for cure in found["cures"] if cure["parameter"] == name]
            near_one = any(math.isclose(each["now"][name], end, rel_tol=0.02) for end in ends)
            assert name in ("load", "mu_k") or near_one, each
        else:
            assert each["delta_x"] == pytest.approx(0.5 * each["before"], rel=NEAR), each
    aims = [each["aim"] for each in pressed]
    assert aims.count("halve") > 15
    assert aims.count("end") > 20


def test_cures_are_compared_from_one_setting_and_back_leads_there(table: Window) -> None:
    # With damping each of the rows offers something.
    table.set(c=5.0, v=0.01)
    before, shown = table.setting, table.text("#cures table")
    for cure in ("stiffer", "damping", "gap"):
        button = table.page.locator(f"[data-cure={cure}] td button:visible").last
        button.press("Enter")
        assert table.text("#cures table") == shown
        assert button.get_attribute("aria-pressed") == "true"
        assert button.evaluate("each => each === document.activeElement")
        assert table.part("#x-chart .ghost", "d")
    table.page.press("#cures-back", "Enter")
    assert table.setting == before
    table.drawn()
    assert not table.page.is_visible("#cures-back")


def test_the_table_says_what_does_not_end_it_and_what_is_out_of_reach(table: Window) -> None:
    for preset, cure, words in (
        ("default", "stiffer", "without damping"),
        ("default", "speed", "without damping"),
        ("default", "gap", "touches rest"),
        # More than a hundredfold a stiffness, more than 0.5 of damping ratio.
        ("machine-slideway", "softer", "out of reach"),
        ("fault-block", "damping", "out of reach"),
    ):
        table.set(**PRESETS[preset])
        assert words in table.text(f"[data-cure={cure}] td:last-child")


def test_without_a_cycle_there_is_nothing_to_suppress(table: Window) -> None:
    for values, words in (
        ({"c": 10.0, "v": 0.5}, "above the critical"),
        ({"c": 100.0}, "does not swing"),
        ({"c": 10.0, "mu_k": 0.5}, "no gap"),
    ):
        table.set(**values)
        assert words in table.text("#cures-lead")
        assert table.page.locator(".cures button:visible").count() == 0
