"""The table of results: unrounded numbers behind what is read, marks, and why there is no cycle."""

import math
import re
from typing import Any

import pytest

from tests.page.exact import relative
from tests.page.settings import START, batch
from tests.page.window import Window

ROWS = ("F_s", "delta_x", "t_stick", "t_slip", "T", "f", "share", "v_c")

_ROWS = """
() => Object.fromEntries([...document.querySelectorAll("[id^=readout-]")].map(row => [
  row.id.slice("readout-".length),
  {
    values: [...row.querySelectorAll("data")].map(data => Number(data.value)),
    words: [...row.cells].map(cell => cell.innerText.replaceAll("\\u00a0", " ")),
  },
]))
"""


def rows(window: Window) -> dict[str, dict[str, Any]]:
    window.drawn()
    found: dict[str, dict[str, Any]] = window.js(_ROWS)
    return found


def test_the_table_reads_as_the_documents_have_it(window: Window) -> None:
    table = {name: row["words"] for name, row in rows(window).items()}
    assert table["delta_x"][1:3] == ["6.305 mm", "3.924 mm"]
    read = [table[name][1] for name in ("F_s", "T", "f", "share", "v_c")]
    # With c = 0 stick-slip persists at every speed: "none", not a number nor a dash.
    assert read == ["4.905 N", "315.3 ms", "3.172 Hz", "62.23 %", "none"]
    assert "37.8 %" in table["delta_x"][3]


def test_a_row_has_the_unrounded_numbers_one_unit_and_the_deviation_in_words(
    window: Window,
) -> None:
    chosen = [*batch("table", undamped=6, damped=6, critical=3), START, {**START, "k": 5000.0}]
    chosen += [{**START, "mu_k": mu_k} for mu_k in (0.0, 0.25, 0.26, 0.45)]
    marked = []
    for values in chosen:
        window.set(**values)
        numbers = {**window.cycle, "v_c": window.js("stickslip.criticalVelocity")}
        simplified = window.js("stickslip.simplified")
        table = rows(window)
        assert tuple(table) == ROWS
        for name, row in table.items():
            exact, simple = row["values"]
            assert relative(exact, numbers[name]) == 0.0, name
            assert relative(simple, simplified.get(name, simple)) == 0.0, name
            units = [text.partition(" ")[2] for text in row["words"][1:3] if text[0].isdigit()]
            assert len(set(units)) <= 1, (name, row)
            words, off = row["words"][3], simple / exact - 1.0 if exact else math.nan
            far = abs(off) > 0.05 and math.isfinite(off)
            marked.append(far)
            # The mark is a sign, beside its colour.
            assert any(mark in words for mark in "▲▼") is far, (name, row)
            assert not far or ("▲" in words) is (off > 0.0)
            if match := re.search(r"[+−][\d.]+ %", words):
                # Three digits are shown.
                percent = float(match[0].replace("−", "-").rstrip(" %"))
                assert percent == pytest.approx(100.0 * off, rel=0.51e-2, abs=0.0051)
    assert set(marked) == {True, False}


def test_where_there_is_no_cycle_the_page_says_why(window: Window) -> None:
    for reason, values in {
        "above the critical velocity": {"c": 5.0, "v": 0.2},
        "does not swing": {"c": 100.0, "v": 0.02},
        "no gap": {"c": 1.0, "mu_k": 0.5, "v": 0.02},
    }.items():
        window.set(**values)
        assert "It moves evenly" in window.text("#lead")
        assert reason in window.text("#lead")
        table = rows(window)
        assert {table[name]["words"][1] for name in ("delta_x", "T", "f", "t_stick")} == {"–"}
    # Undamped, the stick has no length.
    window.set(c=0.0, mu_k=0.5)
    assert "never sticks" in window.text("#lead")
