"""Typed values: every digit counts, and nonsense is refused in place while the picture stays."""

from __future__ import annotations

from decimal import Decimal, localcontext
from random import Random
from typing import TYPE_CHECKING

import pytest

from stickslip.errors import CommandError
from stickslip.units import KINDS, parse
from tests.page.exchange import ask
from tests.page.settings import presets
from tests.page.using import SI, said, set_values, setting, shown, type_in

if TYPE_CHECKING:
    from playwright.sync_api import Page

NONSENSE = {
    "abc": "not a finite number",
    "1e999": "larger",
    "": "needed",
    " ": "needed",
    "-5": "above 0",
    "1,5": "comma",
    "0x10": "unknown unit “x10”",
    "NaN": "not a finite number",
    "Infinity": "not a finite number",
    "-Infinity": "not a finite number",
    "1e-400": "above 0",
    "0": "above 0",
    "1e300": "from",
    "5 N": "is a force; expected a stiffness in N/m, such as 1 kN/m",
    "5 J/m": "is a force",
    "5 N.m2": "has the unit “N.m2”",
    "5 %": "is a plain number",
    "5 parsec/s": "unknown unit “parsec/s”",
    "5 toString": "unknown unit",
    "-5 N/m": "above 0",
    "1.2.3": "unknown unit",
    "1_000": "unknown unit",
    "٣": "not a finite number",
    "<b>7</b>": "not a finite number",
    "9" * 400: "larger",
    "1" * 100_000 + "x": "unknown unit",
    "5 " + "x" * 100_000: "unknown unit",
}
"""What is no stiffness, and a word of the reason."""

WHOLES = ("m", "s", "N", "kg", "g", "t", "J", "W", "Hz", "min", "h", "day", "year", "%", "1")
PREFIXES = ("", "", "p", "n", "u", "µ", "μ", "m", "c", "d", "k", "M", "G", "T")
SIGNS = (".", "·", "*", " . ", "/", " / ")
POWERS = ("", "", "", "2", "-1", "^2", "**3", "²", "^-12", "0")
BROKEN = (
    "m/",
    "/s",
    "kkg",
    "m m",
    "furlong",
    "-",
    "N..m",
    "m***2",
    "m^",
    "in",
    ",5",
    "²",
    "T",
    "µ",
)


def test_a_typed_number_is_taken_to_its_last_digit(page: Page) -> None:
    """What is typed is the very double that its digits name in the shown unit, rounded once."""
    draw = Random("typed")
    numbers = [repr(draw.uniform(10.0, 1e4)) for _ in range(8)] + ["1234.5678901234567", "1e3"]
    for text in numbers:
        type_in(page, "k", text)
        assert setting(page)["k"] == float(text)
    for text in ["20", "0.1", "33.3", "1e-3", "17.123456789012345", "+5", ".5", "7."]:
        type_in(page, "v", text)
        assert setting(page)["v"] == parse(f"{text} mm/s", "m/s", "v")
    for name, text in {"mu_s": "0.6000000000000001", "mu_k": "0.123456789012345678"}.items():
        type_in(page, name, text)
        assert setting(page)[name] == float(text)
    for name, text in {"m": "1.0000000000000002", "c": "1e-7"}.items():
        type_in(page, name, text)
        assert setting(page)[name] == float(text)


def test_a_field_takes_the_units_that_the_command_takes(page: Page) -> None:
    """The unit in the text counts, and not the one beside the field."""
    for name, text in {
        "v": "2 mm/min",
        "k": "40 N/um",
        "m": "500 g",
        "c": "2 kN.s/m",
        "mu_s": "60 %",
        "mu_k": "55%",
    }.items():
        type_in(page, name, text)
        assert setting(page)[name] == parse(text, SI[name], name)
    type_in(page, "v", "31 mm/year")
    assert setting(page)["v"] == parse("31 mm/year", "m/s", "v")
    page.press("#v", "Enter")
    assert (page.input_value("#v"), page.inner_text("#v-unit")) == ("31", "mm/year")
    type_in(page, "N", "5 kN")
    assert setting(page)["load"] == 5000.0 - 0.5 * 9.81


def test_page_and_command_read_alike(page: Page) -> None:
    """The same double to the last bit, or a refusal for the same reason, for 3,000 texts."""
    draw = Random("quantities")
    texts = [(quantity(draw), draw.choice(list(KINDS))) for _ in range(3000)]
    texts += edges()
    answers = ask(page, "all => all.map(([text, unit]) => stickslip.read(text, unit))", texts)
    read = refused = 0
    for (text, unit), answer in zip(texts, answers, strict=True):
        value = of_command(text, unit)
        if isinstance(value, str):
            reason = answer["wrong"].translate({ord(quote): "'" for quote in "“”"})
            assert reason.partition("…")[0] in value.replace('"', "'"), text
            refused += 1
        else:
            assert float(answer["value"]) == value, text
            read += 1
    assert read > 700
    assert refused > 1000


def of_command(text: str, unit: str) -> float | str:
    """Give the value that the command reads, or its refusal."""
    try:
        return parse(text, unit, "--x")
    except CommandError as error:
        return str(error)


def edges() -> list[tuple[str, str]]:
    """Give velocities halfway between two doubles, where doubles are few, and where they end."""
    with localcontext(prec=1100):
        halves = [Decimal(2**53 + odd) for odd in (1, 3)]
        halves += [Decimal(odd) * Decimal(2) ** -1075 for odd in (1, 3, 5)]
        found = [
            (f"{half * size * nudge:e} {unit}", "m/s")
            for half in halves
            for unit, size in {"m/s": 1, "mm/s": 1000, "mm/min": 60000}.items()
            for nudge in (1, 1 - Decimal("1e-60"), 1 + Decimal("1e-60"))
        ]
    ends = ("1.7976931348623158e311", "1.0786158809173895e313", "1e999999999", "1e-999999999")
    return found + [(f"{end} {unit}", "m/s") for end in ends for unit in ("mm/s", "mm/min")]


def quantity(draw: Random) -> str:
    """Give a number with a unit, of the dimension of some control or of none, or a broken text."""
    digits = str(draw.randrange(10 ** draw.randrange(1, 25)))
    place = draw.randrange(len(digits) + 1)
    number = f"{digits[:place]}.{digits[place:]}" if draw.random() < 0.7 else digits
    exponent = f"{draw.choice('eE')}{draw.randrange(-330, 330)}" if draw.random() < 0.4 else ""
    if draw.random() < 0.1:
        return draw.choice(["", "x", "-", "inf", "1 2", f"{number} {draw.choice(BROKEN)}"])
    unit = draw.choice(["", draw.choice(KNOWN), draw.choice(KNOWN), product(draw)])
    return f"{draw.choice(['', '', '-', '+'])}{number}{exponent}{draw.choice(['', ' '])}{unit}"


KNOWN = (
    *(
        "mm/min",
        "um/s",
        "km/h",
        "mm/year",
        "m.s-1",
        "N/µm",
        "kN/mm",
        "kg/s2",
        "TN/m",
        "N",
        "kg.m/s²",
    ),
    *("g", "t", "mg", "kN.s/m", "kg/min", "N·s/mm", "%", "ms", "year", "min", "m/s/s", "cm"),
)


def product(draw: Random) -> str:
    """Give a product or quotient of units with prefixes and powers."""
    factors = [
        draw.choice(PREFIXES) + draw.choice(WHOLES) + draw.choice(POWERS)
        for _ in range(draw.randrange(1, 4))
    ]
    return "".join(each + draw.choice(SIGNS) for each in factors[:-1]) + factors[-1]


def test_nonsense_is_refused_where_it_stands(page: Page) -> None:
    """A reason in sight, a field marked invalid; the last good picture and setting stay."""
    good, picture, values = setting(page), shown(page), page.inner_text(".results")
    for text, reason in NONSENSE.items():
        type_in(page, "k", text)
        page.press("#k", "Enter")
        note = said(page, "k")
        assert reason in note, text
        assert len(note) < 200
        assert page.get_attribute("#k", "aria-invalid") == "true"
        assert (setting(page), shown(page), page.inner_text(".results")) == (good, picture, values)


def test_every_field_refuses_what_is_no_value_of_it(page: Page) -> None:
    """Each field refuses letters, a negative number, and a number beyond all numbers."""
    good, picture = setting(page), shown(page)
    for name in ("v", "mu_s", "mu_k", "N", "m", "c"):
        zero_means_something = name in ("mu_s", "mu_k", "N", "c")
        for text in ["x", "-0.5", "1e999", ""] + ([] if zero_means_something else ["0", "1e-400"]):
            type_in(page, name, text)
            assert said(page, name), text
            assert page.get_attribute(f"#{name}", "aria-invalid") == "true"
        assert (setting(page), shown(page)) == (good, picture)


def test_a_unit_that_is_half_typed_is_not_complained_of(page: Page) -> None:
    """What is wrong with a unit is told when the field is left, or nothing more is typed."""
    page.focus("#v")
    page.keyboard.press("Control+a")
    for key in "2 mm/mi":
        page.keyboard.type(key)
        assert said(page, "v") == ""
    assert not page.is_visible("#v-unit")
    page.wait_for_function("document.querySelector('#v-said').textContent.includes('unknown unit')")
    page.keyboard.type("n")
    assert said(page, "v") == ""
    assert setting(page)["v"] == parse("2 mm/min", "m/s", "v")
    type_in(page, "v", "2 N")
    page.keyboard.press("Tab")
    assert "is a force" in said(page, "v")
    assert page.is_visible("#v-unit") is False


def test_the_shown_unit_follows_the_size(page: Page) -> None:
    """Each preset reads in units of fitting size, with the ends of the sliders in the same ones."""
    expected = {
        "default": "1000 N/m, 20 mm/s, 9.81 N, 1 kg, 0 N·s/m",
        "machine-slideway": "50 N/µm, 1 mm/s, 4.905 kN, 500 kg, 10 kN·s/m",
        "violin-bow": "2823 N/m, 200 mm/s, 1 N, 100 mg, 0 N·s/m",
        "fault-block": "3 TN/m, 31.5576 mm/year, 26.487 TN, 2.7e9 t, 0 N·s/m",
        "brake-pad": "5 N/µm, 20 mm/s, 5 kN, 20 kg, 400 N·s/m",
        "rubber-seal": "10 kN/m, 10 mm/s, 100 N, 3 kg, 30 N·s/m",
        "squeaky-drawer": "1 N/µm, 20 mm/s, 100 N, 500 g, 20 N·s/m",
    }
    names = [name for name in SI if not name.startswith("mu")]
    for preset, values in presets().items():
        set_values(page, **values)
        texts = [f"{page.input_value(f'#{n}')} {page.inner_text(f'#{n}-unit')}" for n in names]
        assert ", ".join(texts) == expected[preset]
        for name in names:
            ends = page.locator(f"#{name}-control .ends span").all_inner_texts()
            assert float(ends[0]) <= float(page.input_value(f"#{name}")) <= float(ends[1])


def test_the_shown_unit_stays_while_the_field_is_used(page: Page) -> None:
    """50000 typed in N/m stay N/m, also when the field is left, and the same double."""
    for digits in ("5", "50", "500", "5000", "50000", "50000.000000000001"):
        type_in(page, "k", digits)
        assert page.inner_text("#k-unit") == "N/m"
    page.keyboard.press("Tab")
    assert (page.input_value("#k"), page.inner_text("#k-unit")) == ("50000", "N/m")
    assert setting(page)["k"] == 50000.000000000001
    type_in(page, "v", "30")
    assert setting(page)["k"] == 50000.000000000001


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
    page.wait_for_function("document.querySelector('#k-said').textContent.includes('unknown')")
    assert len(said(page, "k")) < 200


def test_a_plain_number_stays_in_its_unit(page: Page) -> None:
    """Typed twice without a unit, a number means twice the same: no unit changes on its way."""
    for name, numbers in {"c": (1000, 2000), "N": (5886, 6000)}.items():
        for number in numbers:
            type_in(page, name, str(number))
            page.press(f"#{name}", "Enter")
            p = {**setting(page), "N": setting(page)["g"] + setting(page)["load"]}
            assert p[name] == pytest.approx(number, rel=1e-12)
    # Another mass moves the normal force, but not the unit in which it is typed.
    type_in(page, "m", "600")
    assert page.inner_text("#N-unit") == "N"
    set_values(page, **presets()["machine-slideway"])
    assert page.inner_text("#N-unit") == "kN"
