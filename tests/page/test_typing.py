"""Typed values: every digit counts, and nonsense is refused in place while the picture stays."""

from decimal import Decimal, localcontext
from random import Random

import pytest

from stickslip.errors import CommandError
from stickslip.units import KINDS, parse
from tests.page.window import SI, Window

NONSENSE = {
    "abc": "not a finite number",
    "1e999": "larger",
    "": "needed",
    " ": "needed",
    "-5": "above 0",
    "1,5": "comma",
    "0x10": "unknown unit “x10”",
    "NaN": "not a finite number",
    "-Infinity": "not a finite number",
    "1e-400": "above 0",
    "0": "above 0",
    "1e300": "from",
    "5 N": "is a force; expected a stiffness in N/m, such as 1 kN/m",
    "5 N.m2": "has the unit “N.m2”",
    "5 %": "is a plain number",
    "5 parsec/s": "unknown unit “parsec/s”",
    "5 toString": "unknown unit",
    "-5 N/m": "above 0",
    "1.2.3": "unknown unit",
    "٣": "not a finite number",
    "<b>7</b>": "not a finite number",
    "9" * 400: "larger",
    "5 " + "x" * 100_000: "unknown unit",
}
"""What is no stiffness, and a word of the reason."""

WHOLES = ["m", "s", "N", "kg", "g", "t", "J", "W", "Hz", "min", "h", "day", "year", "%", "1"]
PREFIXES = ["", "", *["p", "n", "u", "µ", "μ", "m", "c", "d", "k", "M", "G", "T"]]
SIGNS = (".", "·", "*", " . ", "/", " / ")
POWERS = ["", "", "", "2", "-1", "^2", "**3", "²", "^-12", "0"]
LOST = ("m/", "/s", "kkg", "m m", "furlong", "-", "N..m", "m***2", "m^", "in", ",5", "²", "T", "µ")
SPEEDS = ("mm/min", "um/s", "km/h", "mm/year", "m.s-1")
STIFF = ("N/µm", "kN/mm", "kg/s2", "TN/m")
HEAVY = ("g", "t", "mg", "kN.s/m", "kg/min", "N·s/mm", "N", "kg.m/s²")
KNOWN = (*SPEEDS, *STIFF, *HEAVY, "%", "ms", "year", "min", "m/s/s", "cm")


def test_a_typed_value_is_the_double_that_the_command_reads(window: Window) -> None:
    for name, texts in {
        "k": ("1234.5678901234567", "1e3", "4321.000000000001", "40 N/um"),
        "v": ("20", "1e-3", "17.123456789012345", "+5", ".5", "7.", "2 mm/min", "31 mm/year"),
        "mu_s": ("0.6000000000000001", "60 %"),
        "mu_k": ("0.123456789012345678", "45%"),
        "m": ("1.0000000000000002", "500 g"),
        "c": ("1e-7", "2 kN.s/m"),
    }.items():
        for text in texts:
            # The unit in the text counts, else the one beside the field.
            has_unit = text[-1].isalpha() or text.endswith("%")
            unit = "" if has_unit else window.page.inner_text(f"#{name}-unit")
            window.type(name, text)
            assert window.setting[name] == parse(f"{text} {unit}", SI[name], name)


def of_command(text: str, unit: str) -> float | str:
    """Return the value that the command reads, or its refusal."""
    try:
        return parse(text, unit, "--x")
    except CommandError as error:
        return str(error)


def test_page_and_command_read_3000_texts_alike(window: Window) -> None:
    draw = Random("quantities")
    texts = [(quantity(draw), draw.choice(list(KINDS))) for _ in range(3000)] + edges()
    answers = window.js("all => all.map(([text, unit]) => stickslip.read(text, unit))", texts)
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


def edges() -> list[tuple[str, str]]:
    """Return velocities halfway between two doubles, where doubles are few, and where they end."""
    with localcontext(prec=1100):
        halves = [Decimal(2**53 + odd) for odd in (1, 3)]
        halves += [Decimal(odd) * Decimal(2) ** -1075 for odd in (1, 3, 5)]
        found = [
            (f"{half * size * (1 + Decimal(nudge)):e} {unit}", "m/s")
            for half in halves
            for unit, size in {"m/s": 1, "mm/s": 1000, "mm/min": 60000}.items()
            for nudge in ("0", "-1e-60", "1e-60")
        ]
    return [*found, ("1.0786158809173895e313 mm/min", "m/s"), ("1e-999999999 mm/s", "m/s")]


def quantity(draw: Random) -> str:
    """Draw a number with a unit, of the dimension of some control or of none, or a broken text."""
    digits = str(draw.randrange(10 ** draw.randrange(1, 25)))
    place = draw.randrange(len(digits) + 1)
    number = f"{digits[:place]}.{digits[place:]}" if draw.random() < 0.7 else digits
    exponent = f"{draw.choice('eE')}{draw.randrange(-330, 330)}" if draw.random() < 0.4 else ""
    if draw.random() < 0.1:
        return draw.choice(["", "x", "-", "inf", "1 2", f"{number} {draw.choice(LOST)}"])
    parts = [
        draw.choice(PREFIXES) + draw.choice(WHOLES) + draw.choice(POWERS) + draw.choice(SIGNS)
        for _ in range(draw.randrange(1, 4))
    ]
    unit = draw.choice(["", draw.choice(KNOWN), draw.choice(KNOWN), "".join(parts).rstrip("./ ·*")])
    return f"{draw.choice(['', '', '-', '+'])}{number}{exponent}{draw.choice(['', ' '])}{unit}"


def test_nonsense_is_refused_in_place_and_the_last_good_picture_stays(window: Window) -> None:
    good = window.setting, window.paths(), window.text(".results")
    for text, reason in NONSENSE.items():
        window.type("k", text)
        window.page.press("#k", "Enter")
        assert reason in window.said("k"), text[:20]
        assert len(window.said("k")) < 200
        assert window.part("#k", "aria-invalid") == "true"
    # Looked at again for each of a million digits, it would take hours.
    window.js(
        """() => setTimeout(() => {
          document.querySelector("#k").value = "1".repeat(1e6) + "x";
          document.querySelector("#k").dispatchEvent(new Event("input"));
        })"""
    )
    window.until("document.querySelector('#k-said').textContent.includes('111…')")
    # Who cannot see the note hears it.
    assert "k-said" in window.part("#k", "aria-describedby").split()
    assert window.part("#k-said", "aria-live") == "polite"
    for name in ("v", "mu_s", "mu_k", "N", "m", "c"):
        may_be_zero = name not in ("v", "m")
        for text in ["x", "-0.5", "1e999", ""] + ([] if may_be_zero else ["0", "1e-400"]):
            window.type(name, text)
            assert window.said(name), (name, text)
            assert window.part(f"#{name}", "aria-invalid") == "true"
    assert (window.setting, window.paths(), window.text(".results")) == good
    window.type("k", "abc")
    window.type("v", "30")
    # Nonsense left standing is never shown as if it were the value in use.
    assert window.part("#k", "aria-invalid") == "true" or window.page.input_value("#k") == "1000"
    window.type("k", "abc")
    window.page.press("#k", "Escape")
    assert window.page.input_value("#k") == "1000"
    window.type("m", "2")
    for name in ("k", "m"):
        assert (window.said(name), window.part(f"#{name}", "aria-invalid")) == ("", "")
    assert (window.setting["v"], window.setting["m"]) == (0.03, 2.0)
    assert window.paths() != good[1]


def test_a_unit_that_is_half_typed_is_complained_of_later(window: Window) -> None:
    window.page.focus("#v")
    window.page.keyboard.press("Control+a")
    for key in "2 mm/mi":
        window.page.keyboard.type(key)
        assert window.said("v") == ""
    assert not window.page.is_visible("#v-unit")
    window.until("document.querySelector('#v-said').textContent.includes('unknown unit')")
    window.page.keyboard.type("n")
    assert window.said("v") == ""
    assert window.setting["v"] == parse("2 mm/min", "m/s", "v")
    window.type("v", "2 N")
    window.page.keyboard.press("Tab")
    assert "is a force" in window.said("v")


def test_the_shown_unit_stays_while_numbers_are_typed_in_it(window: Window) -> None:
    for digits in ("5", "500", "50000", "50000.000000000001"):
        window.type("k", digits)
        assert window.page.inner_text("#k-unit") == "N/m"
    window.page.keyboard.press("Tab")
    assert (window.page.input_value("#k"), window.page.inner_text("#k-unit")) == ("50000", "N/m")
    window.type("v", "30")
    assert window.setting["k"] == 50000.000000000001
    for number in (5886, 6000):
        window.type("N", str(number))
        window.page.press("#N", "Enter")
        assert pytest.approx(number, rel=1e-12) == window.N
    # Another mass moves the normal force, but not the unit in which it is typed.
    window.type("m", "600")
    assert window.page.inner_text("#N-unit") == "N"
    # One that was typed with the number is shown after it.
    window.type("v", "31 mm/year")
    window.page.press("#v", "Enter")
    assert (window.page.input_value("#v"), window.page.inner_text("#v-unit")) == ("31", "mm/year")
