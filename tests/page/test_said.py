"""What is often said and what is so: each number of the table against Python, each row used."""

import math
import re
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from stickslip.page import texts
from stickslip_design.claims.verlet import march
from stickslip_ref import Cycle, coulomb_limit, simplified, steady_cycle
from tests.page.drawing import SIZES
from tests.page.settings import START, Setting, parameters, table
from tests.page.test_friction import ends_of, regimes
from tests.page.window import Window

Numbers = Mapping[str, Any]

BOUND = 1e-9
"""Largest relative error of a number: roots are searched on both sides."""

ROUNDING = 8.0 * 2.0**-52
"""What rounding leaves of the deviations of a script: quotients near 1, less 1."""

LIGHT, HEARING, STEP = 0.03, 2e4, 1e-3
"""The light damping ratio [1], the limit of hearing [Hz] and the step [s] of the sentences."""

SENTENCES = {each["id"]: each for each in table("said", "sentence")}


def values_of(name: str) -> dict[str, float]:
    """Return the setting of a sentence, mu_k as it is asked for."""
    return {**START, **SENTENCES[name]["set"]}


def in_use(name: str) -> dict[str, float]:
    """Return it with mu_k clamped."""
    p = values_of(name)
    return {**p, "mu_k": float(parameters(p).mu_k_used)}


def cycle(p: Setting, **changes: float) -> Cycle:
    return steady_cycle(parameters({**p, **changes}))


def jump(p: Setting, **changes: float) -> float:
    return float(cycle(p, **changes).delta_x)


def simple_jump(p: Setting) -> float:
    return float(simplified(parameters(p)).delta_x)


def v_c(p: Setting, **changes: float) -> float:
    return float(coulomb_limit(parameters({**p, **changes})))


def light(p: Setting) -> float:
    return 2.0 * LIGHT * math.sqrt(p["k"] * p["m"])


def inaudible(p: Setting) -> float:
    """Return the factor of k at which the cycle leaves hearing."""
    return float(brentq(lambda s: HEARING * cycle(p, k=p["k"] * s).T - 1.0, 2.0, 1e4, xtol=1e-12))


def overshoot(p: Setting) -> float:
    """Return how far the spring still grows beyond its length at break-away [m], undamped."""
    own = cycle(p)
    return float(own.Delta * (math.hypot(1.0, 1.0 / own.lambda_) - 1.0))


def scripted(p: Setting) -> Numbers:
    """Return by how much a script of this step is off."""
    own = {name: p[name] for name in ("m", "g", "mu_s", "mu_k")}
    at = np.array([p["k"]]), np.array([p["v"]])
    made = march(*at, h=STEP, block=own, cycles=1, longest=np.array([100.0]))
    exact, first = cycle(p), parameters(p).F_s / (p["k"] * p["v"])
    off = {
        name: float(getattr(made, name)[0, 0] / getattr(exact, name)) - 1.0
        for name in ("T", "t_slip", "t_stick", "delta_x")
    }
    off["break_away"] = float(made.break_away[0] / first) - 1.0
    return {"h": STEP, "stick": float(exact.t_stick), **off}


def under_its_curve(p: Setting, curve: list[list[float]]) -> Numbers:
    slope = (curve[0][1] - curve[1][1]) / curve[1][0]
    exact = texts.Numbers(p, curve).__dict__["delta_x"]
    return {"slope": slope, "held": p["c"] / (p["m"] * p["g"]), "exact": exact}


PYTHON: Mapping[str, Callable[[Setting], Numbers]] = {
    "jump": lambda p: {
        "simplified": simple_jump(p),
        "exact": jump(p),
        "off": simple_jump(p) / jump(p) - 1.0,
        "spring": cycle(p).spring_drop,
    },
    "stick": lambda p: {
        "first": parameters(p).F_s / (p["k"] * p["v"]),
        "exact": cycle(p).t_stick,
        "factor": parameters(p).F_s / (p["k"] * p["v"]) / cycle(p).t_stick,
    },
    "speed": lambda p: {
        "simplified": simple_jump(p),
        "slow": p["v"] / 25.0,
        "middle": p["v"] / 2.5,
        "fast": p["v"],
        "off_slow": simple_jump(p) / jump(p, v=p["v"] / 25.0) - 1.0,
        "off_middle": simple_jump(p) / jump(p, v=p["v"] / 2.5) - 1.0,
        "off_fast": simple_jump(p) / jump(p) - 1.0,
    },
    "friction": lambda p: {
        "exact": jump(p),
        "other": jump(p, mu_s=p["mu_s"] - 0.2, mu_k=p["mu_k"] - 0.2),
        "F_s": parameters(p).F_s,
        "F_s_other": (p["mu_s"] - 0.2) * p["m"] * p["g"],
    },
    "gap": lambda p: {
        "v": p["v"],
        "slow": p["v"] / 20.0,
        "ratio": jump(p) / jump(p, mu_k=0.25),
        "ratio_slow": jump(p, v=p["v"] / 20.0) / jump(p, v=p["v"] / 20.0, mu_k=0.25),
    },
    "faster": lambda p: {
        "v": p["v"],
        "f": cycle(p).f,
        "exact": jump(p),
        "zeta": LIGHT,
        "c": light(p),
        "v_c": v_c(p, c=light(p)),
    },
    "stiffer": lambda p: {
        "exact": jump(p),
        "before": jump(p, k=p["k"] / 5.0),
        "ratio": jump(p) / jump(p, k=p["k"] / 5.0),
    },
    "audible": lambda p: {
        "f": cycle(p).f,
        "limit": HEARING,
        "natural": (HEARING * cycle(p).T) ** 2,
        "factor": inaudible(p),
    },
    "slope": lambda p: {"v_c": v_c(p), "before": v_c(p, k=p["k"] / 4.0)},
    "condition": lambda p: {"slope": p["c"] / parameters(p).N},
    "clamp": lambda p: {
        "asked": p["mu_k"],
        "used": p["mu_s"] - 0.01,
        "F_s": parameters(p).F_s,
        "asked_force": p["mu_k"] * parameters(p).N,
    },
    "line": lambda p: {
        "F_s": parameters(p).F_s,
        "over": p["k"] * overshoot(p),
        # Where the mass has the speed of the pull: half of the slip and a quarter of a swing on.
        "after": math.atan(1.0 / cycle(p).lambda_) / parameters(p).w,
    },
    "step": scripted,
    "gapless": lambda p: under_its_curve(p, SENTENCES["gapless"]["curve"]),
}
"""The numbers of each sentence at its own setting, by the reference."""


FIGURES = {
    "jump": "6.305 mm, not 3.924 mm",
    "stick": "5 times too long",
    "speed": "−4.91 % at 2 mm/s, −37.8 % at 20 mm/s and −64.4 % at 50 mm/s",
    "gap": "3.71 times as far at 1 mm/s and 1.53 times at 20 mm/s",
    "stiffer": "2.027 mm of 6.305 mm",
    "audible": "16 times the stiffness",
    "clamp": "to 0.29",
}
"""What people come for, as they read it."""


def close(got: float, expected: float, name: str) -> bool:
    return abs(got - expected) <= BOUND * abs(expected) + (ROUNDING if name == "step" else 0.0)


def asked(window: Window, name: str) -> Any:
    """Return the numbers of a sentence by the page, at its own setting."""
    known = [name, values_of(name), SENTENCES[name].get("curve")]
    return window.js("asked => stickslip.said(...asked)", known)


def test_the_numbers_of_a_sentence_are_those_of_the_reference(window: Window) -> None:
    assert set(SENTENCES) == {*PYTHON, "above"}
    for name, by_python in PYTHON.items():
        got, expected = asked(window, name), by_python(values_of(name))
        assert got.keys() == expected.keys()
        assert [n for n in got if not close(got[n], float(expected[n]), name)] == [], (name, got)


def test_the_curve_that_falls_twice_sticks_where_its_bar_says(window: Window) -> None:
    got, p, curve = asked(window, "above"), values_of("above"), SENTENCES["above"]["curve"]
    ranges = ends_of(regimes(window, p, curve, 1e-3, 10.0), "sticks", True)
    assert [got[name] for name in ("first", "again", "last")] == pytest.approx(
        ranges[1:], rel=BOUND
    )
    assert got["v"] == p["v"]
    # A cycle of the reference: a part in 1e12 of each slip, where it is not near a graze.
    assert got["exact"] == pytest.approx(texts.Numbers(p, curve).__dict__["delta_x"], rel=BOUND)


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
    compared = {name for name, each in SENTENCES.items() if "before" in each}
    assert compared >= {"speed", "friction", "gap", "stiffer"}
    for name, sentence in SENTENCES.items():
        window.page.click(f"[data-said={name}]")
        assert window.setting == in_use(name)
        assert window.pressed("said") == [name]
        assert not window.has_nonsense()
        # The first load-up is seen where the sentence is about it, else steady cycles alone.
        if sentence.get("from") == "start" or window.cycle["exists"]:
            assert (window.view[0] == 0.0) == (sentence.get("from") == "start"), name
        ghost = window.part("#phase-chart .curve.ghost", "d")
        assert bool(ghost) == (name in compared)
        text = window.text(f"#said-{name}")
        assert FIGURES.get(name, "") in text
        assert not re.search(r"–|[{}]", text), text
        assert window.text(f"#said-{name} b") == sentence["verdict"]
        link = window.part(f"#said-{name} a", "href")
        assert window.page.locator(f"#theory {link}").count() == 1
    window.press("k", "ArrowRight")
    assert window.pressed("said") == []
