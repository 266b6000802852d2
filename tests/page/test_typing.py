"""Typed values: every digit counts, and nonsense is refused in place while the picture stays."""

from decimal import Decimal, localcontext
from random import Random

from stickslip_units import KINDS, QuantityError, typed
from tests.page.window import SI, Window

NONSENSE = {
    "abc": "not a finite number",
    "1e999": "larger",
    "": "needed",
    " ": "needed",
    "1,5": "comma",
    "NaN": "not a finite number",
    "1e-400": "above 0",
    "1e300": "from",
    "5 N": "is a force; expected a stiffness in N/m, such as 1 kN/m",
    "5 toString": "unknown unit",
    "-5 N/m": "above 0",
    "<b>7</b>": "not a finite number",
    "5 " + "x" * 100_000: "unknown unit",
}
"""What is no stiffness, and a word of the reason."""

WHOLES = ["m", "s", "N", "kg", "g", "t", "J", "W", "Hz", "min", "h", "day", "year", "%", "1"]
PREFIXES = ["", "", *["p", "n", "u", "µ", "μ", "m", "c", "d", "k", "M", "G", "T"]]
SIGNS = (".", "·", "*", " . ", "/", " / ")
POWERS = ["", "", "", "2", "-1", "^2", "**3", "²", "^-12", "0"]
LOST = ("m/", "/s", "kkg", "m m", "furlong", "-", "N..m", "m***2", "m^", "in", ",5", "²", "T", "µ")
KNOWN = """
mm/min um/s km/h mm/year m.s-1 N/µm kN/mm kg/s2 TN/m g t mg kN.s/m kg/min N·s/mm N kg.m/s² % ms year
m/s/s cm
"""


def test_what_is_typed_is_taken_to_the_last_bit_in_its_unit_or_the_one_beside(
    window: Window,
) -> None:
    for name, text, unit in (
        ("k", "1234.5678901234567", "N/m"),
        ("v", "17.123456789012345", "mm/s"),
        ("v", "31 mm/year", ""),
        ("mu_s", "60 %", ""),
        ("m", "500 g", ""),
        ("c", "2 kN.s/m", ""),
    ):
        window.type(name, text)
        assert window.setting[name] == typed(f"{text} {unit}", SI[name])


def of_command(text: str, unit: str) -> float | str:
    try:
        return typed(text, unit)
    except QuantityError as error:
        return str(error)


def test_page_and_command_read_3000_texts_alike(window: Window) -> None:
    draw = Random("quantities")
    texts = [(quantity(draw), draw.choice(list(KINDS))) for _ in range(3000)] + edges()
    answers = window.js("all => all.map(([text, unit]) => stickslip.read(text, unit))", texts)
    refused = 0
    for (text, unit), answer in zip(texts, answers, strict=True):
        value = of_command(text, unit)
        if isinstance(value, str):
            reason = answer["wrong"].translate({ord(quote): "'" for quote in "“”"})
            assert reason.partition("…")[0] in value.replace('"', "'"), text
            refused += 1
        else:
            assert float(answer["value"]) == value, text
    assert 1000 < refused < 2300


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
    unit = draw.choice(
        ["", draw.choice(KNOWN.split()), draw.choice(KNOWN.split()), "".join(parts).rstrip("./ ·*")]
    )
    return f"{draw.choice(['', '', '-', '+'])}{number}{exponent}{draw.choice(['', ' '])}{unit}"


def test_nonsense_is_refused_in_place_and_the_last_good_picture_stays(window: Window) -> None:
    good = window.setting, window.paths(), window.text(".results")
    for text, reason in NONSENSE.items():
        window.type("k", text)
        window.page.press("#k", "Enter")
        assert reason in window.said("k"), text[:20]
        assert len(window.said("k")) < 200
        assert window.part("#k", "aria-invalid") == "true"
    # Who cannot see the note hears it.
    assert "k-said" in window.part("#k", "aria-describedby").split()
    assert window.part("#k-said", "aria-live") == "polite"
    for name in SI:
        for text in ("x", "-0.5", "1e999", "", *(("0",) if name in ("k", "v", "m") else ())):
            window.type(name, text)
            assert window.said(name), (name, text)
            assert window.part(f"#{name}", "aria-invalid") == "true"
    assert (window.setting, window.paths(), window.text(".results")) == good
    window.type("v", "30")
    # Nonsense left standing is never shown as if it were the value in use.
    assert window.part("#k", "aria-invalid") == "true" or window.page.input_value("#k") == "1000"
    window.type("k", "abc")
    window.page.press("#k", "Escape")
    assert window.page.input_value("#k") == "1000"
    assert [(window.said(n), window.part(f"#{n}", "aria-invalid")) for n in "kv"] == [("", "")] * 2
    assert window.setting["v"] == 0.03
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
    assert window.setting["v"] == typed("2 mm/min", "m/s")


def test_the_shown_unit_stays_while_numbers_are_typed_in_it(window: Window) -> None:
    for digits in ("5", "500", "50000.000000000001"):
        window.type("k", digits)
        assert window.page.inner_text("#k-unit") == "N/m"
    window.page.keyboard.press("Tab")
    assert (window.page.input_value("#k"), window.page.inner_text("#k-unit")) == ("50000", "N/m")
    assert window.setting["k"] == 50000.000000000001
    # One that was typed with the number is shown after it.
    window.type("v", "31 mm/year")
    window.page.press("#v", "Enter")
    assert (window.page.input_value("#v"), window.page.inner_text("#v-unit")) == ("31", "mm/year")
