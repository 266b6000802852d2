"""Typed values: every digit counts, and nonsense is refused in place while the picture stays."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from tests.page.using import said, setting, shown, type_in

if TYPE_CHECKING:
    from playwright.sync_api import Page

NONSENSE = {
    "abc": "no number",
    "1e999": "larger",
    "": "needed",
    " ": "needed",
    "-5": "0",
    "1,5": "point",
    "0x10": "no number",
    "NaN": "no number",
    "Infinity": "no number",
    "-Infinity": "no number",
    "1e-400": "above 0",
    "0": "above 0",
    "1e300": "from",
    "5 N/m": "no number",
    "1.2.3": "no number",
    "1_000": "no number",
    "٣": "no number",
    "<b>7</b>": "no number",
    "9" * 400: "larger",
    "1" * 100_000 + "x": "no number",
}
"""What is no stiffness, and a word of the reason."""


def test_a_typed_number_is_taken_to_its_last_digit(page: Page) -> None:
    """What is typed is the very double that its digits name, shifted to SI without a rounding."""
    draw = Random("typed")
    numbers = [repr(draw.uniform(10.0, 1e4)) for _ in range(8)] + ["1234.5678901234567", "1e3"]
    for text in numbers:
        type_in(page, "k", text)
        assert setting(page)["k"] == float(text)
    for text in ["20", "0.1", "33.3", "1e-3", "17.123456789012345", "+5", ".5", "7."]:
        type_in(page, "v", text)
        # One rounding, from the typed digits and not from the double of the millimetres.
        assert setting(page)["v"] == float(f"{float(text)!r}e-3") or setting(page)["v"] == shift(
            text
        )
    type_in(page, "v", "20")
    assert setting(page)["v"] == 0.02
    for name, text in {"mu_s": "0.6000000000000001", "mu_k": "0.123456789012345678"}.items():
        type_in(page, name, text)
        assert setting(page)[name] == float(text)
    for name, text in {"m": "1.0000000000000002", "g": "9.80665", "c": "1e-7"}.items():
        type_in(page, name, text)
        assert setting(page)[name] == float(text)


def shift(text: str) -> float:
    """Give the double of typed millimetres in metres, rounded once."""
    mantissa, _, exponent = text.partition("e")
    return float(f"{mantissa}e{int(exponent or 0) - 3}")


def test_nonsense_is_refused_where_it_stands(page: Page) -> None:
    """A reason in sight, a field marked invalid; the last good picture and setting stay."""
    good, picture, values = setting(page), shown(page), page.inner_text(".results")
    for text, reason in NONSENSE.items():
        type_in(page, "k", text)
        note = said(page, "k")
        assert reason in note, text
        assert len(note) < 200
        assert page.get_attribute("#k", "aria-invalid") == "true"
        assert (setting(page), shown(page), page.inner_text(".results")) == (good, picture, values)


def test_every_field_refuses_what_is_no_value_of_it(page: Page) -> None:
    """Each field refuses letters, a negative number, and a number beyond all numbers."""
    good, picture = setting(page), shown(page)
    for name in ("v", "mu_s", "mu_k", "m", "g", "c"):
        zero_means_something = name in ("mu_s", "mu_k", "c")
        for text in ["x", "-0.5", "1e999", ""] + ([] if zero_means_something else ["0", "1e-400"]):
            type_in(page, name, text)
            assert said(page, name), text
            assert page.get_attribute(f"#{name}", "aria-invalid") == "true"
        assert (setting(page), shown(page)) == (good, picture)


def test_an_objection_is_tied_to_its_field(page: Page) -> None:
    """Who cannot see the note hears it: the field is described by it, and it is announced."""
    type_in(page, "k", "abc")
    described = (page.get_attribute("#k", "aria-describedby") or "").split()
    assert "k-said" in described
    assert page.get_attribute("#k-said", "aria-live") == "polite"


def test_escape_brings_the_value_in_use_back(page: Page) -> None:
    """Escape in a field full of nonsense puts the value in use there and ends the objection."""
    type_in(page, "k", "abc")
    page.press("#k", "Escape")
    assert page.input_value("#k") == "1000"
    assert said(page, "k") == ""
    assert page.get_attribute("#k", "aria-invalid") is None


def test_a_good_value_ends_an_objection(page: Page) -> None:
    """The next good value is taken, drawn, and the objection goes."""
    picture = shown(page)
    type_in(page, "k", "abc")
    type_in(page, "k", "2000")
    assert setting(page)["k"] == 2000.0
    assert said(page, "k") == ""
    assert page.get_attribute("#k", "aria-invalid") is None
    assert shown(page) != picture


def test_a_refused_field_stays_marked_while_another_is_used(page: Page) -> None:
    """Nonsense left standing is never shown as if it were the value in use."""
    type_in(page, "k", "abc")
    type_in(page, "v", "30")
    refused = page.get_attribute("#k", "aria-invalid") == "true" and said(page, "k") != ""
    assert refused or page.input_value("#k") == "1000"


def test_a_very_long_text_is_refused_at_once(page: Page) -> None:
    """A million digits and a letter are no number, and it takes one look to see that.

    Looked at again for each digit, they would take hours.
    """
    page.evaluate(
        """text => setTimeout(() => {
          const field = document.querySelector("#k");
          field.focus();
          field.value = text;
          field.dispatchEvent(new Event("input"));
        })""",
        "1" * 1_000_000 + "x",
    )
    page.wait_for_function("document.querySelector('#k-said').textContent.includes('no number')")
    assert len(said(page, "k")) < 200
