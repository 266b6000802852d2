"""What is often said and what is so: each number of the table against Python, each row used."""

from __future__ import annotations

import math
import re
import tomllib
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from importlib.resources import files
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from mpmath import mp, mpf
from scipy.optimize import brentq

from stickslip.page import texts
from stickslip_design.claims.verlet import march
from stickslip_ref import (
    Cycle,
    FrictionClampWarning,
    Parameters,
    coulomb_limit,
    simplified,
    steady_cycle,
)
from tests.page.browser import planted
from tests.page.exchange import ask
from tests.page.settings import NAMES, Setting, batch, block, log_uniform, wide
from tests.page.test_friction import rests
from tests.page.using import drawn, press, set_values, setting

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

Numbers = Mapping[str, float]

BOUND = 1e-9
"""Largest relative error of a number."""

ROUNDING = 8.0 * 2.0**-52
"""What rounding leaves of the deviations of a script: quotients near 1, less 1."""

LIGHT, HEARING, STEP = 0.03, 2e4, 1e-3
"""The light damping ratio [1], the limit of hearing [Hz] and the step [s] of the sentences."""

ASK = "questions => questions.map(({ id, values }) => window.stickslip.said(id, values))"


def table() -> list[dict[str, Any]]:
    """Give the sentences as they are written down."""
    text = (files("stickslip.page") / "said" / "said.toml").read_text(encoding="utf-8")
    found: list[dict[str, Any]] = tomllib.loads(text)["sentence"]
    return found


SENTENCES = {each["id"]: each for each in table()}


def values_of(name: str) -> Setting:
    """Give the setting of a sentence, mu_k as it is asked for."""
    start = Parameters()
    return {**{each: float(getattr(start, each)) for each in NAMES}, **SENTENCES[name]["set"]}


def clamped(p: Setting) -> Parameters:
    """Give the reference's parameters of a setting."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FrictionClampWarning)
        return Parameters(**p)


def cycle(p: Setting, **changes: float) -> Cycle:
    """Give the steady cycle of a setting with some values changed, mu_k clamped before."""
    return steady_cycle(clamped({**in_use(p), **changes}))


def in_use(p: Setting) -> Setting:
    """Give a setting with its kinetic coefficient clamped."""
    return {**p, "mu_k": float(clamped(p).mu_k_used)}


def jump(p: Setting) -> Numbers:
    """Compare the jumps."""
    exact = cycle(p)
    simple = float(simplified(clamped(p)).delta_x)
    return {
        "simplified": simple,
        "exact": float(exact.delta_x),
        "off": simple / float(exact.delta_x) - 1.0,
        "spring": float(exact.spring_drop),
    }


def stick(p: Setting) -> Numbers:
    """Compare the first load-up with a stick of the cycle."""
    own = clamped(p)
    first, exact = float(own.F_s) / (p["k"] * p["v"]), float(cycle(p).t_stick)
    return {"first": first, "exact": exact, "factor": quotient(first, exact)}


def speed(p: Setting) -> Numbers:
    """Compare the jumps at three speeds with the one that knows none."""
    simple = float(simplified(clamped(p)).delta_x)
    speeds = {"slow": p["v"] / 25.0, "middle": p["v"] / 2.5, "fast": p["v"]}
    offs = {f"off_{at}": simple / float(cycle(p, v=v).delta_x) - 1.0 for at, v in speeds.items()}
    return {"simplified": simple, **speeds, **offs}


def friction(p: Setting) -> Numbers:
    """Take the same off both coefficients."""
    own = in_use(p)
    less = min(0.2, own["mu_k"])
    other = {"mu_s": own["mu_s"] - less, "mu_k": own["mu_k"] - less}
    return {
        "exact": float(cycle(own).delta_x),
        "other": float(cycle(own, **other).delta_x),
        "F_s": float(clamped(own).F_s),
        "F_s_other": float(clamped({**own, **other}).F_s),
    }


def gap(p: Setting) -> Numbers:
    """Close the gap to a quarter."""
    own = in_use(p)
    narrow = own["mu_s"] - (own["mu_s"] - own["mu_k"]) / 4.0
    v, slow = p["v"], p["v"] / 20.0
    at_v, at_slow = (
        float(cycle(own, v=each).delta_x / cycle(own, v=each, mu_k=narrow).delta_x)
        for each in (v, slow)
    )
    return {"v": v, "slow": slow, "ratio": at_v, "ratio_slow": at_slow}


def faster(p: Setting) -> Numbers:
    """Ask for the end of the cycle with a light damping."""
    exact = cycle(p)
    c = 2.0 * LIGHT * math.sqrt(p["k"] * p["m"])
    return {
        "v": p["v"],
        "f": float(exact.f),
        "exact": float(exact.delta_x),
        "zeta": LIGHT,
        "c": c,
        "v_c": float(coulomb_limit(clamped({**in_use(p), "c": c}))),
    }


def stiffer(p: Setting) -> Numbers:
    """Compare with a fifth of the stiffness."""
    exact, before = float(cycle(p).delta_x), float(cycle(p, k=p["k"] / 5.0).delta_x)
    return {"exact": exact, "before": before, "ratio": exact / before}


def audible(p: Setting) -> Numbers:
    """Search the stiffness at which the undamped cycle leaves hearing."""

    def excess(log: float) -> float:
        return math.log(HEARING * float(cycle(p, c=0.0, k=p["k"] * math.exp(log)).T))

    f = float(cycle(p, c=0.0).f)
    wanted = math.log(HEARING / f)
    ends = sorted((0.9 * wanted, 2.1 * wanted))
    log = brentq(excess, *ends, xtol=1e-13, rtol=1e-14)
    return {"f": f, "limit": HEARING, "natural": (HEARING / f) ** 2, "factor": math.exp(log)}


def slope(p: Setting) -> Numbers:
    """Compare the critical velocities on this stiffness and on a quarter of it."""
    v_c, before = (float(coulomb_limit(clamped({**p, "k": k}))) for k in (p["k"], p["k"] / 4.0))
    return {"v_c": v_c, "before": before}


def condition(p: Setting) -> Numbers:
    """Give the steepest fall of friction that damping holds."""
    return {"slope": p["c"] / float(clamped(p).N)}


def clamp(p: Setting) -> Numbers:
    """Compare the forces of a kinetic coefficient above the static one."""
    own = clamped(p)
    return {
        "asked": p["mu_k"],
        "used": float(own.mu_k_used),
        "F_s": float(own.F_s),
        "asked_force": p["mu_k"] * float(own.N),
    }


def line(p: Setting) -> Numbers:
    """Follow the spring force to its greatest: where the mass first has the speed of the pull.

    docs/theory.md (3) with 40 digits: rho = x_dot - v starts at -v with the acceleration w^2 Delta;
    its integral up to its first zero is what the spring still grows.
    """
    own = clamped(p)
    found = {"F_s": float(own.F_s)}
    with mp.workdps(40):
        m, k, c, v = (mpf(p[name]) for name in ("m", "k", "c", "v"))
        a_0 = (mpf(p["mu_s"]) - mpf(float(own.mu_k_used))) * (m * mpf(p["g"]) + mpf(p["load"])) / m
        root = mp.sqrt(mp.mpc((c / (2 * m)) ** 2 - k / m))
        fast, slow = c / (2 * m) + root, c / (2 * m) - root
        # rho = A e^(-fast t) + B e^(-slow t); zero where e^((fast - slow) t) = -A/B.
        B = (a_0 - fast * v) / (fast - slow)
        A = -v - B
        turn = mp.log(-A / B)
        if root.imag:
            time = (turn.imag % (2 * mp.pi)) / (2 * root.imag)
        elif not mp.re(-A / B) > 1:
            return {**found, "over": math.nan, "after": math.nan}
        else:
            time = mp.re(turn) / (2 * mp.re(root))
        grown = -A * (1 - mp.exp(-fast * time)) / fast - B * (1 - mp.exp(-slow * time)) / slow
        return {**found, "over": float(k * mp.re(grown)), "after": float(time)}


def quotient(a: float, b: float) -> float:
    """Divide as IEEE 754 does."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(np.float64(a) / np.float64(b))


PYTHON: Mapping[str, Callable[[Setting], Numbers]] = {
    each.__name__: each
    for each in (
        jump,
        stick,
        speed,
        friction,
        gap,
        faster,
        stiffer,
        audible,
        slope,
        condition,
        clamp,
        line,
    )
}
"""The numbers of each sentence by the reference; those of the step are marched for many at once."""


@cache
def settings() -> tuple[Setting, ...]:
    """Give 300 settings: undamped, damped, near the critical velocity, and outside the sliders."""
    draw = Random("said wide")
    return (*batch("said", undamped=140, damped=80, critical=40), *(wide(draw) for _ in range(40)))


@cache
def steps() -> tuple[tuple[Setting, Numbers], ...]:
    """Give 300 settings, each with the deviations of a script by the study of scripts.

    Six blocks with 50 springs and speeds each. A first load-up takes at most a second.
    """
    draw = Random("said step")
    found: list[tuple[Setting, Numbers]] = []
    for _ in range(6):
        chosen = {**block(draw), "load": 0.0}
        own = in_use(chosen)
        springs = [log_uniform(draw, 10.0 * own["m"], 1e4 * own["m"]) for _ in range(50)]
        pulls = [
            log_uniform(draw, 1.0, 100.0) * own["mu_s"] * own["m"] * own["g"] / k for k in springs
        ]
        alike = [{**own, "k": k, "v": v} for k, v in zip(springs, pulls, strict=True)]
        found += zip(alike, marched(alike), strict=True)
    return tuple(found)


def marched(alike: Sequence[Setting]) -> list[Numbers]:
    """Give the deviations of a script at settings that differ in stiffness and speed alone."""
    run = march(
        np.array([p["k"] for p in alike]),
        np.array([p["v"] for p in alike]),
        h=STEP,
        block={name: alike[0][name] for name in ("m", "g", "mu_s", "mu_k")},
        cycles=1,
        longest=np.full(len(alike), 100.0),
    )
    found: list[Numbers] = []
    for n, p in enumerate(alike):
        exact = cycle(p)
        off = {
            name: quotient(float(getattr(run, name)[n, 0]), float(getattr(exact, name))) - 1.0
            for name in ("T", "t_slip", "t_stick", "delta_x")
        }
        off["break_away"] = float(run.break_away[n]) / stick(p)["first"] - 1.0
        found.append({"h": STEP, "stick": float(exact.t_stick), **off})
    return found


def wrong(page: Page, name: str) -> dict[str, str]:
    """Give each number of a sentence that is not Python's, with the worst of its settings."""
    pairs = steps() if name == "step" else [(p, PYTHON[name](p)) for p in settings()]
    answers = ask(page, ASK, [{"id": name, "values": dict(p)} for p, _ in pairs])
    found: dict[str, str] = {}
    for got, (p, wanted) in zip(answers, pairs, strict=True):
        if got.keys() != wanted.keys():
            return {"names": f"{sorted(got)} are not {sorted(wanted)}"}
        for each in wanted:
            rounding = ROUNDING if name == "step" else 0.0
            if not close(got[each], wanted[each], rounding):
                found[each] = f"{got[each]!r} is not {wanted[each]!r} at {p}"
    return found


def close(got: float, wanted: float, rounding: float) -> bool:
    """Tell whether two numbers are one; what is no number in one is none in the other."""
    if math.isnan(wanted) or math.isinf(wanted):
        return got == wanted or (math.isnan(got) and math.isnan(wanted))
    return abs(got - wanted) <= BOUND * abs(wanted) + rounding


@pytest.mark.parametrize("name", [*PYTHON, "step"])
def test_the_numbers_of_a_sentence_are_pythons(page: Page, name: str) -> None:
    """At 300 settings each number of a sentence is within 1e-9 of the reference's."""
    assert not wrong(page, name)


def test_every_sentence_is_compared() -> None:
    """The table holds the fifteen sentences, and each has its numbers by Python."""
    assert set(SENTENCES) == {*PYTHON, "step", "above", "gapless"}
    assert len(SENTENCES) == 15


def under_its_curve(page: Page, name: str) -> tuple[Numbers, Setting, list[list[float]]]:
    """Give the numbers of a sentence that has a friction curve, its setting and its curve."""
    curve = SENTENCES[name]["curve"]
    question = {"id": name, "values": dict(values_of(name)), "curve": curve}
    asked = "({ id, values, curve }) => window.stickslip.said(id, values, curve)"
    return ask(page, asked, question), values_of(name), curve


def test_the_curve_that_falls_twice_sticks_where_the_reference_does(page: Page) -> None:
    """At the speeds that the sentence names the reference's slip just begins or ceases to rest."""
    got, p, curve = under_its_curve(page, "above")
    assert got.keys() == {"first", "again", "last", "v", "exact"}
    for name, below in (("first", True), ("again", False), ("last", True)):
        assert rests(p, curve, got[name] * (1.0 - 1e-6)) is below
        assert rests(p, curve, got[name] * (1.0 + 1e-6)) is not below
    assert got["v"] == p["v"]
    # A cycle of the reference: a part in 1e12 of each slip, where it is not near a graze.
    assert got["exact"] == pytest.approx(texts.Numbers(p, curve).__dict__["delta_x"], rel=BOUND)


def test_a_fall_without_a_gap_is_enough(page: Page) -> None:
    """The slope of the curve, what damping would hold, and the jump are the reference's."""
    got, p, curve = under_its_curve(page, "gapless")
    assert curve[0][1] == p["mu_s"]
    exact = texts.Numbers(p, curve).__dict__["delta_x"]
    slope = (curve[0][1] - curve[1][1]) / curve[1][0]
    wanted = {"slope": slope, "held": p["c"] / (p["m"] * p["g"]), "exact": exact}
    assert got == pytest.approx(wanted, rel=BOUND)
    assert wanted["slope"] > wanted["held"]


FAULTS = {
    "jump that is the relief": (
        "const [simple, exact] = [simplified(p).delta_x, jumpAt(p)];",
        "const [simple, exact] = [simplified(p).delta_x, steadyCycle(p).spring_drop];",
        "jump",
    ),
    "stiffness a hair off": ("k: p.k / 5 }", "k: p.k / 5.00000001 }", "stiffer"),
    "script with an Euler step": (
        "x += (x_dot + 0.5 * h * a) * h;",
        "x += x_dot * h;",
        "step",
    ),
    "break-away a step late": (
        "while (n > from && breaks((n - 1) * h)) n -= 1;",
        "n += 1;",
        "step",
    ),
    "clamp that forgets what was asked": (
        "return CLAIMS[name](p, asked.mu_k, curve);",
        "return CLAIMS[name](p, asked.mu_s, curve);",
        "clamp",
    ),
    "another stiffness": (
        "const slope = 0.5 + lambda ** 3 / (1 + lambda ** 2) / now;",
        "const slope = 0.5 + lambda ** 3 / (1 + lambda ** 2) / now; log *= 1.0001;",
        "audible",
    ),
    "overshoot of the undamped": (
        "over: overshoot ? p.k * overshoot.growth : NaN,",
        "over: p.k * numbersOf(p).Delta * (Math.hypot(1, 1 / numbersOf(p).lambda_) - 1),",
        "line",
    ),
}
"""Faults to plant: a piece of the page's script, what to put there, the sentence that tells."""


@pytest.mark.parametrize("fault", FAULTS)
def test_a_planted_fault_is_found(
    browser: Browser, page_file: Path, tmp_path: Path, fault: str
) -> None:
    """The comparison refutes numbers that are a little wrong."""
    piece, other, name = FAULTS[fault]
    with planted(browser, page_file, tmp_path, piece, other) as page:
        assert wrong(page, name)


def pressed(page: Page) -> list[str]:
    """Give the sentences that are shown as current."""
    drawn(page)
    found: list[str] = page.eval_on_selector_all(
        "[data-said][aria-pressed=true]", "all => all.map(each => each.dataset.said)"
    )
    return found


def test_a_sentence_sets_its_stage(page: Page) -> None:
    """A click sets all of the sentence's values; it stays current until the setting is another."""
    for name in SENTENCES:
        page.click(f"[data-said={name}]")
        assert setting(page) == in_use(values_of(name))
        assert pressed(page) == [name]
        assert "NaN" not in page.inner_text("body")
        # The first load-up is seen where the sentence is about it, else steady cycles alone.
        drawn(page)
        from_start = SENTENCES[name].get("from") == "start"
        if from_start or page.evaluate("window.stickslip.cycle.exists"):
            assert (page.evaluate("window.stickslip.view.from") == 0.0) == from_start, name
    press(page, "k", "ArrowRight")
    assert pressed(page) == []
    set_values(page, **values_of("gap"))
    assert pressed(page) == []


WRITTEN = """
([name, sentence]) => {
  const field = document.getElementById(name);
  const { get, set } = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value");
  const written = [];
  Object.defineProperty(field, "value", {
    configurable: true,
    get,
    set(text) {
      written.push(text);
      set.call(field, text);
    },
  });
  document.querySelector(`[data-said=${sentence}]`).click();
  delete field.value;
  return written;
}
"""
"""Presses the button of a sentence and gives what it wrote into the field of a parameter."""


def test_a_sentence_that_compares_sets_both_settings(page: Page) -> None:
    """What it is compared with is set first, so that its curves can stay behind the second's."""
    compared = {name: each["before"] for name, each in SENTENCES.items() if "before" in each}
    assert compared.keys() >= {"speed", "friction", "gap", "stiffer"}
    for name, before in compared.items():
        values = dict(values_of(name))
        for parameter in before:
            texts = []
            for each in ({**values, **before}, values):
                set_values(page, **each)
                texts.append(page.input_value(f"#{parameter}"))
            assert texts[0] != texts[1]
            assert page.evaluate(WRITTEN, [parameter, name]) == texts


def test_the_curves_of_what_it_is_compared_with_stay(page: Page) -> None:
    """A sentence that compares leaves a second curve; any other leaves none."""
    for name, sentence in SENTENCES.items():
        page.click(f"[data-said={name}]")
        drawn(page)
        ghost = page.get_attribute("#phase-chart .curve.ghost", "d")
        assert bool(ghost) == ("before" in sentence)


def figures(page: Page, name: str) -> Iterator[tuple[str, str, float, str]]:
    """Give name, kind, value and text of each number in the text of a sentence."""
    rows = page.eval_on_selector_all(
        f"#said-{name} data",
        "all => all.map(each => [each.dataset.of, each.value, each.textContent])",
    )
    for of, value, text in rows:
        key, _, kind = of.partition(":")
        yield key, kind, float(value), text


SIZES = (
    {"km": 1e3, "m": 1.0, "mm": 1e-3, "µm": 1e-6, "nm": 1e-9, "m/s": 1.0, "mm/s": 1e-3}
    | {"kN": 1e3, "N": 1.0, "mN": 1e-3, "s": 1.0, "ms": 1e-3, "µs": 1e-6}
    | {"kHz": 1e3, "Hz": 1.0, "%": 0.01}
)
"""SI size of each unit that a text may use."""


def test_a_text_holds_its_numbers_rounded(page: Page) -> None:
    """What is read is the number of the model, to three or four digits, and of Python."""
    for name in SENTENCES:
        values = values_of(name)
        if "curve" in SENTENCES[name]:
            wanted, _, _ = under_its_curve(page, name)
        else:
            wanted = marched([values])[0] if name == "step" else PYTHON[name](values)
        found = list(figures(page, name))
        assert found
        for key, kind, value, text in found:
            rounding = ROUNDING if name == "step" else 0.0
            assert close(value, wanted[key], rounding), (name, key)
            number, _, unit = text.replace("−", "-").partition("\u00a0")
            digits = 3 if kind in ("percent", "times") else 4
            shown = float(number) * (SIZES[unit] if unit else 1.0)
            assert float(f"{shown:.{digits}g}") == pytest.approx(
                float(f"{value:.{digits}g}"), rel=1e-12
            ), (name, key, text)


def test_the_texts_say_what_the_study_found(page: Page) -> None:
    """The figures that people come for, as they are read."""
    for name, words in {
        "jump": "6.305 mm, not 3.924 mm",
        "stick": "5 times too long",
        "speed": "−4.91 % at 2 mm/s, −37.8 % at 20 mm/s and −64.4 % at 50 mm/s",
        "friction": "0.3/0.1 it jumps 6.305 mm, with 0.5/0.3 6.305 mm",
        "gap": "3.71 times as far at 1 mm/s and 1.53 times at 20 mm/s",
        "stiffer": "2.027 mm of 6.305 mm",
        "audible": "16 times the stiffness",
        "clamp": "to 0.29",
    }.items():
        text = page.inner_text(f"#said-{name}").replace("\u00a0", " ")
        assert words in text, text


def test_no_sentence_lacks_a_number_or_a_verdict(page: Page) -> None:
    """Nothing is left open in a text, and its verdict is told by a sign and in words."""
    for name in SENTENCES:
        text = page.inner_text(f"#said-{name}")
        assert not re.search(r"NaN|undefined|Infinity|–|[{}]", text), text
        verdict = f"#said-{name} b"
        assert page.inner_text(verdict) == SENTENCES[name]["verdict"]
        sign = page.eval_on_selector(verdict, "e => getComputedStyle(e, '::before').content")
        assert sign.strip('"') in {"✗ ", "◐ ", "✓ "}


def test_each_sentence_leads_to_its_equation(page: Page) -> None:
    """The link of each row leads to a place in the theory that is there."""
    targets = page.eval_on_selector_all(
        "#said a[href]", "all => all.map(each => each.getAttribute('href'))"
    )
    assert len(targets) == len(SENTENCES)
    for target in targets:
        assert page.locator(f"#theory {target}").count() == 1
