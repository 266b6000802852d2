"""The table of results: unrounded numbers behind what is read, marks, and why there is no cycle."""

from __future__ import annotations

import math
import re
from random import Random
from typing import TYPE_CHECKING, Any

from stickslip_ref import Parameters, coulomb_limit
from tests.page.settings import batch
from tests.page.using import set_values, text_of, type_in

if TYPE_CHECKING:
    from playwright.sync_api import Page

ROWS = ("F_s", "delta_x", "t_stick", "t_slip", "T", "f", "share", "v_c")

_ROWS = """
() => [...document.querySelectorAll("[id^=readout-]")].map(row => ({
  name: row.id.slice("readout-".length),
  values: [...row.querySelectorAll("data")].map(data => data.value),
  words: [...row.cells].map(cell => cell.innerText),
}))
"""
_NUMBERS = """
() => {
  const { cycle, simplified, criticalVelocity } = window.stickslip;
  return { exact: { ...cycle, v_c: criticalVelocity }, simplified };
}
"""


def rows(page: Page) -> dict[str, dict[str, Any]]:
    """Give what each row of the table holds and shows."""
    text_of(page, ".results")
    return {each.pop("name"): each for each in page.evaluate(_ROWS)}


def same(a: float, b: float) -> bool:
    """Tell whether two doubles are one, or both no number."""
    return a == b or (math.isnan(a) and math.isnan(b))


def double(text: str) -> float:
    """Read a double as JavaScript writes it."""
    return float(text.replace("Infinity", "inf"))


def test_behind_each_number_stands_the_unrounded_one(page: Page) -> None:
    """What the table shows is the page's own double, exact and simplified, in every row."""
    for values in batch("table", undamped=6, damped=6, critical=3):
        set_values(page, **values)
        numbers, table = page.evaluate(_NUMBERS), rows(page)
        assert tuple(table) == ROWS
        for name, row in table.items():
            exact, simplified = (double(text) for text in row["values"])
            assert same(exact, float(numbers["exact"][name])), name
            if name in numbers["simplified"]:
                assert same(simplified, float(numbers["simplified"][name])), name


def test_what_is_read_is_the_number_rounded(page: Page) -> None:
    """At the start values the table reads as docs and README have it: 6.305 mm, not 3.924 mm."""
    table = {name: row["words"] for name, row in rows(page).items()}
    assert [table["delta_x"][1], table["delta_x"][2]] == ["6.305\u00a0mm", "3.924\u00a0mm"]
    assert table["F_s"][1] == "4.905\u00a0N"
    assert table["T"][1] == "315.3\u00a0ms"
    assert table["f"][1] == "3.172\u00a0Hz"
    assert table["share"][1] == "62.23\u00a0%"
    assert "37.8 %" in table["delta_x"][3]


def test_both_numbers_of_a_row_have_one_unit(page: Page) -> None:
    """Exact and simplified are compared at a glance, also on either side of a change of units."""
    straddles = 0
    for k in (2000.0, 5000.0, 1e5):
        set_values(page, k=k)
        for name, row in rows(page).items():
            units = [text.partition("\u00a0")[2] for text in row["words"][1:3] if text[0].isdigit()]
            assert len(set(units)) <= 1, (name, row)
            straddles += name == "delta_x" and row["words"][2].startswith("0.")
    assert straddles


def test_more_than_five_percent_is_marked_and_less_is_not(page: Page) -> None:
    """The mark is a sign and a word, beside its colour, and stands exactly where it is due."""
    draw = Random("marks")
    marked = set()
    for _ in range(8):
        set_values(
            page, v=draw.choice([1e-4, 0.02, 0.2]), mu_k=draw.choice([0.0, 0.25, 0.26, 0.45])
        )
        for name, row in rows(page).items():
            exact, simplified = (double(text) for text in row["values"])
            comparable = math.isfinite(exact) and math.isfinite(simplified)
            far = comparable and abs(simplified / exact - 1) > 0.05
            words = row["words"][3]
            assert any(mark in words for mark in "▲▼") is far, (name, row)
            assert ("more than 5 % off" in words) is far
            # Below 0.01 % nobody needs to know the direction.
            if comparable and abs(simplified / exact - 1) > 1e-4:
                sign = "×" if "×" in words else "+" if simplified > exact else "−"
                assert sign in words
                assert not far or ("▲" in words) is (simplified > exact)
            marked.add(far)
    assert marked == {True, False}


def test_the_deviation_in_percent_is_right(page: Page) -> None:
    """The percentage is that of the simplified value over the exact one, to its shown digits."""
    for name, row in rows(page).items():
        exact, simplified = (double(text) for text in row["values"])
        match = re.search(r"([+−])([\d.]+) %", row["words"][3])
        if not match:
            assert name in ("F_s", "v_c")
            continue
        percent = float(match[2]) * (1 if match[1] == "+" else -1)
        # Three digits are shown.
        assert abs(percent - 100 * (simplified / exact - 1)) <= 0.006 * abs(percent)


def test_without_damping_there_is_no_critical_velocity(page: Page) -> None:
    """With c = 0 stick-slip persists at every speed: "none", not a number nor a dash."""
    assert rows(page)["v_c"]["words"][1] == "none"
    type_in(page, "c", "1")
    words = rows(page)["v_c"]["words"]
    v_c = float(coulomb_limit(Parameters(c=1.0)))
    assert math.isclose(float(words[1].split()[0]), 1e3 * v_c, rel_tol=1e-3)
    assert "mm/s" in words[1]


def test_where_there_is_no_cycle_the_page_says_why(page: Page) -> None:
    """Too fast a pull, too much damping and no gap are told apart; what has no cycle is marked."""
    reasons = {
        "above the critical velocity": {"c": 5.0, "v": 0.2},
        "does not swing": {"c": 100.0, "v": 0.02},
        "no gap": {"c": 1.0, "mu_k": 0.5, "v": 0.02},
    }
    for reason, values in reasons.items():
        set_values(page, **values)
        sentence = text_of(page, "#lead")
        assert "No cycle" in sentence
        assert reason in sentence
        assert sum(other in sentence for other in reasons) == 1
        table = rows(page)
        assert {table[name]["words"][1] for name in ("delta_x", "T", "f", "t_stick")} == {"–"}
        offs = {name: table[name]["words"][3] for name in ROWS if name not in ("F_s", "v_c")}
        assert all("✕ no cycle" in words for words in offs.values())


def test_without_gap_and_damping_it_never_sticks(page: Page) -> None:
    """mu_k = mu_s, undamped, is a motion whose stick has no length; the sentence says so."""
    set_values(page, mu_k=0.5)
    assert "never sticks" in text_of(page, "#lead")
    assert rows(page)["t_stick"]["values"][0] == "0"
