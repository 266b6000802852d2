"""What is often said and what is so: each number of the table against Python, each row used."""

import math
import re
from collections.abc import Callable, Mapping
from typing import Any

import pytest
from docs.rules_of_thumb import march
from scipy.optimize import brentq

from stickslip.page import texts
from stickslip_ref import coulomb_limit, simplified, steady_cycle
from tests.page.drawing import SIZES
from tests.page.settings import START, Setting, parameters, table
from tests.page.test_friction import ends_of, regimes
from tests.page.window import Window

Numbers = Mapping[str, Any]

BOUND = 1e-9
"""Largest relative error of a number: roots are searched on both sides."""

ROUNDING = 8.0 * 2.0**-52
"""What rounding leaves of the deviations of a script."""

HEARING, STEP = 2e4, 1e-3
"""The limit of hearing [Hz] and the step [s] of the sentences."""

SENTENCES = {each["id"]: each for each in table("said", "sentence")}


def values_of(name: str) -> dict[str, float]:
    return {**START, **SENTENCES[name]["set"]}


def jump(p: Setting, **changes: float) -> float:
    return float(steady_cycle(parameters({**p, **changes})).delta_x)


def simple_jump(p: Setting) -> float:
    return float(simplified(parameters(p)).delta_x)


def v_c(p: Setting, **changes: float) -> float:
    return float(coulomb_limit(parameters({**p, **changes})))


def inaudible(p: Setting) -> float:
    """Return the factor of k at which the cycle leaves hearing."""

    def beyond(factor: float) -> float:
        return HEARING / float(steady_cycle(parameters({**p, "k": p["k"] * factor})).f) - 1.0

    return float(brentq(beyond, 2.0, 1e4, xtol=1e-12))


def spring(p: Setting) -> Numbers:
    """Return how far the force passes the line, and how long after break-away, undamped."""
    own = steady_cycle(parameters(p))
    over = p["k"] * own.Delta * (math.hypot(1.0, 1.0 / own.lambda_) - 1.0)
    # Where the mass has the speed of the pull: half of the slip and a quarter of a swing on.
    return {"over": over, "after": math.atan(1.0 / own.lambda_) / parameters(p).w}


def scripted(p: Setting) -> Numbers:
    """Return by how much a script of this step is off."""
    made = march(parameters(p), STEP, cycles=1, longest=100.0).values
    exact = {**vars(steady_cycle(parameters(p))), "break_away": first_stick(p)}
    return {name: float(value / exact[name]) - 1.0 for name, (value,) in made.items()}


def off_at(p: Setting, v: float) -> float:
    return simple_jump(p) / jump(p, v=v) - 1.0


def first_stick(p: Setting) -> float:
    return float(parameters(p).F_s / (p["k"] * p["v"]))


PYTHON: Mapping[str, Callable[[Setting], Numbers]] = {
    "jump": lambda p: {"exact": jump(p), "simplified": simple_jump(p), "off": off_at(p, p["v"])},
    "stick": lambda p: {
        "first": first_stick(p),
        "factor": first_stick(p) / steady_cycle(parameters(p)).t_stick,
    },
    "speed": lambda p: {
        "off_slow": off_at(p, 0.002),
        "off_middle": off_at(p, 0.02),
        "off_fast": off_at(p, 0.05),
    },
    "friction": lambda p: {"other": jump(p, mu_s=0.3, mu_k=0.1), "F_s_other": 0.3 * 9.81},
    "gap": lambda p: {
        "ratio": jump(p) / jump(p, mu_s=0.5, mu_k=0.45),
        "ratio_slow": jump(p, v=0.001) / jump(p, v=0.001, mu_s=0.5, mu_k=0.45),
    },
    "faster": lambda p: {"v_c": v_c(p, c=2.0 * 0.03 * math.sqrt(p["k"] * p["m"]))},
    "stiffer": lambda p: {"before": jump(p, k=1000.0), "ratio": jump(p) / jump(p, k=1000.0)},
    "audible": lambda p: {
        "natural": (HEARING / steady_cycle(parameters(p)).f) ** 2,
        "factor": inaudible(p),
    },
    "slope": lambda p: {"v_c": v_c(p), "before": v_c(p, k=1000.0)},
    "condition": lambda p: {"slope": p["c"] / parameters(p).N},
    "clamp": lambda p: {"used": 0.29, "F_s": 0.3 * 9.81, "asked_force": 0.5 * 9.81},
    "line": spring,
    "step": scripted,
    "gapless": lambda p: {
        "slope": 0.2 / 0.05,
        "held": p["c"] / parameters(p).N,
        "exact": under_its_curve("gapless"),
    },
}
"""What each sentence says at its own setting beyond its cycle, by the reference."""


def under_its_curve(name: str) -> float:
    return float(texts.Numbers(values_of(name), SENTENCES[name]["curve"]).__dict__["delta_x"])


def asked(window: Window, name: str) -> Any:
    known = [name, values_of(name), SENTENCES[name].get("curve")]
    return window.js("asked => stickslip.said(...asked)", known)


def test_the_numbers_of_a_sentence_are_those_of_the_reference(window: Window) -> None:
    assert set(SENTENCES) == {*PYTHON, "above"}
    for name, by_python in PYTHON.items():
        got, expected = asked(window, name), by_python(values_of(name))
        # A deviation of a script is a quotient near 1, less 1.
        slack = ROUNDING if name == "step" else 0.0
        for key, value in expected.items():
            assert got[key] == pytest.approx(float(value), rel=BOUND, abs=slack), (name, key)


def test_the_curve_that_falls_twice_sticks_where_its_bar_says(window: Window) -> None:
    got, p, curve = asked(window, "above"), values_of("above"), SENTENCES["above"]["curve"]
    _, *ends = ends_of(regimes(window, p, curve, 1e-3, 10.0), "sticks", True)
    assert [got[name] for name in ("first", "again", "last")] == pytest.approx(ends, rel=BOUND)
    # A cycle of the reference: a part in 1e12 of each slip, where it is not near a graze.
    assert got["exact"] == pytest.approx(under_its_curve("above"), rel=BOUND)


def test_a_text_holds_its_numbers_rounded(window: Window) -> None:
    for name in SENTENCES:
        expected = asked(window, name)
        rows = window.js(
            "where => [...document.querySelectorAll(where)]"
            ".map(each => [each.dataset.of, +each.value, each.textContent])",
            f"#said-{name} data",
        )
        assert rows
        for of, value, text in rows:
            key, _, kind = of.partition(":")
            assert value == expected[key], (name, key)
            number, _, unit = text.replace("−", "-").partition("\u00a0")
            digits = 3 if kind in ("percent", "times") else 4
            # Half of the last digit that is shown, of a number that begins with a 1.
            shown = float(number) * SIZES[unit]
            assert shown == pytest.approx(value, rel=0.51 * 10.0 ** (1 - digits)), (name, text)


def test_a_sentence_sets_its_stage_and_leaves_the_curves_of_what_it_compares_with(
    window: Window,
) -> None:
    for name, sentence in SENTENCES.items():
        window.page.click(f"[data-said={name}]")
        p = values_of(name)
        assert window.setting == {**p, "mu_k": parameters(p).mu_k_used}
        assert window.pressed("said") == [name]
        assert not window.has_nonsense()
        # The first load-up is seen where the sentence is about it, else steady cycles alone.
        if sentence.get("from") == "start" or window.cycle["exists"]:
            assert (window.view[0] == 0.0) == (sentence.get("from") == "start"), name
        assert bool(window.part("#phase-chart .curve.ghost", "d")) == ("before" in sentence)
        text = window.text(f"#said-{name}")
        assert not re.search(r"–|[{}]", text), text
        assert window.text(f"#said-{name} b") == sentence["verdict"]
        link = window.part(f"#said-{name} a", "href")
        assert window.page.locator(f"#theory {link}").count() == 1
    window.press("k", "ArrowRight")
    assert window.pressed("said") == []
