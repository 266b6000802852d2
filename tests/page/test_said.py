"""What is often said and what is so: the numbers that no cycle has, each row used."""

import re

import pytest
from docs.rules_of_thumb import march

from stickslip_ref import steady_cycle
from tests.page.settings import START, parameters, table
from tests.page.test_friction import ends_of, regimes
from tests.page.window import Window

SENTENCES = {each["id"]: each for each in table("said", "sentence")}
# Numbers are written down with seven digits or more.
WRITTEN = 1e-6


def values_of(name: str) -> dict[str, float]:
    return {**START, **SENTENCES[name]["set"]}


def test_the_script_of_a_fixed_step_is_off_by_what_is_said_of_it() -> None:
    p = parameters(values_of("step"))
    exact = {**vars(steady_cycle(p)), "break_away": float(p.F_s / (p.k * p.v))}
    made = march(p, 1e-3, cycles=1, longest=100.0).values
    off = {name: float(value / exact[name]) - 1.0 for name, (value,) in made.items()}
    assert SENTENCES["step"]["known"] == pytest.approx(off, rel=WRITTEN)


def test_the_curve_that_falls_twice_sticks_where_its_bar_says(window: Window) -> None:
    p, sentence = values_of("above"), SENTENCES["above"]
    _, *ends = ends_of(regimes(window, p, sentence["curve"], 1e-3, 10.0), "sticks", True)
    assert list(sentence["known"].values()) == pytest.approx(ends, rel=WRITTEN)


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
