"""The cures of the page: their numbers are those of Python, and a button does what it says."""

import math
from collections.abc import Callable
from random import Random

import pytest

from stickslip_design.cures import cures
from stickslip_ref import coulomb_limit
from tests.page.exact import is_decidable
from tests.page.settings import CORNERS, PRESETS, START, Setting, batch, parameters
from tests.page.window import Window

NEAR = 1e-9
"""Largest relative difference between the page and Python: a root that is searched, in both."""

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


def near(got: float | None, expected: float | None, scale: float = 0.0) -> bool:
    """Tell whether two numbers, of which both may be missing, are the same."""
    own, other = (math.nan if each is None else each for each in (got, expected))
    return bool(own == pytest.approx(other, rel=NEAR, abs=NEAR * scale, nan_ok=True))


def test_each_value_and_each_lack_of_one_is_that_of_python(
    window: Window, sized: Callable[[int], int]
) -> None:
    settings: list[Setting] = [*loaded_and_lifted(sized(1000)), *PRESETS.values()]
    settings += CORNERS.values()
    answers = window.js(
        """all => all.map(p => {
          stickslip.set(p, null);
          return stickslip.cures(stickslip.setting);
        })""",
        settings,
    )
    offered = 0
    for values, got in zip(settings, answers, strict=True):
        python = cures(parameters(values))
        assert [each["name"] for each in got["cures"]] == [each.name for each in python.cures]
        assert near(got["jump"], python.jump)
        assert near(got["v_c"], python.v_c)
        offered += bool(python.cures)
        for each, cure in zip(got["cures"], python.cures, strict=True):
            # The load is what the weight leaves of the normal force, and is as exact as they are.
            weight = values["m"] * values["g"] if cure.name == "normal force" else 0.0
            for key in ("now", "halve", "end", "least"):
                assert near(each[key], getattr(cure, key), weight), (values, cure, key)
    assert offered > len(settings) / 2


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
            name, python = each["parameter"], cures(parameters(each["values"])).cures
            # A round value, at most 2 % beyond the limit.
            ends = [cure.end or math.inf for cure in python if cure.parameter == name]
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
    factor = 0.5 / float(coulomb_limit(parameters({**START, "c": 10.0})))
    for values, words in (
        ({"c": 10.0, "v": 0.5}, f"{factor:.3g} times the critical"),
        ({"c": 100.0}, "no slip comes to rest"),
        ({"c": 10.0, "mu_k": 0.5}, "no gap"),
    ):
        table.set(**values)
        assert words in table.text("#cures-lead")
        assert table.page.locator(".cures button:visible").count() == 0
