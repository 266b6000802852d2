"""The sliders: their ends, their keys, the mouse, and the gap that the friction sliders keep."""

from random import Random

import pytest

from tests.page.settings import START, parameters
from tests.page.window import SI, Window

ENDS = {
    "k": (10.0, 10000.0),
    "v": (0.0001, 0.2),
    "mu_s": (0.0, 1.5),
    "m": (0.01, 100.0),
    "c": (0.0, 100.0),
}
"""What a slider spans, SI."""


def test_keys_reach_both_ends_of_a_slider_and_move_it_by_small_steps(window: Window) -> None:
    for name, (low, high) in ENDS.items():
        window.set(**START)
        reached = []
        for key in ("Home", "End"):
            window.press(name, key)
            reached.append(window.setting[name])
        assert reached == [low, high]
        window.set(**{name: 0.3 * high})
        window.press(name, "ArrowRight")
        above = window.setting[name]
        window.press(name, "ArrowLeft", "ArrowLeft")
        below = window.setting[name]
        assert below < 0.3 * high < above, name
        assert above - below < 0.1 * 0.3 * high, name


def test_a_dragged_slider_is_drawn_counted_and_written_into_its_field(window: Window) -> None:
    for name in SI:
        pictures, period = window.paths(), window.text("#readout-T data")
        window.drag(name, 0.35)
        used = window.N if name == "N" else window.setting[name]
        # The field has twelve digits or more.
        assert used == pytest.approx(window.si_of(name), rel=1e-11)
        after = window.paths()
        # Without damping N moves the forces with the jump, and none of the period.
        assert name == "N" or window.text("#readout-T data") != period, name
        # Only v moves the pulled end, and the scale of the axis may stay.
        changed = {each for each, path in after.items() if path != pictures[each]}
        assert changed >= {each for each in after if not each.endswith("pull")}, name
        window.set(**START)


def test_the_normal_force_sets_the_load_and_has_the_weight_of_the_mass(window: Window) -> None:
    for text, parts in (("20", "load 10.19 N"), ("5", "load −4.81 N"), ("0", "load −9.81 N")):
        window.type("N", text)
        assert window.setting["load"] == float(text) - 9.81
        assert window.text("#N-parts") == f"weight 9.81 N + {parts}"
    for key, N in (("Home", 0.1), ("End", 1000.0)):
        window.press("N", "ArrowRight", key)
        assert pytest.approx(N, rel=1e-12) == window.N
    # Another mass keeps the load; one that would lift it is held at -m g until the mass is back.
    window.set(load=-15.0, m=2.0)
    for mass, load in (("1", -9.81), ("0.5", -0.5 * 9.81), ("2", -15.0)):
        window.type("m", mass)
        assert window.setting["load"] == load
    assert float(window.page.input_value("#N")) == 4.62
    # On the moon, too, N typed is N in use.
    window.set(g=1.62, m=2.0)
    window.type("N", "5")
    assert window.setting["load"] == 5.0 - 2.0 * 1.62
    assert window.cycle["F_s"] == pytest.approx(0.5 * 5.0, rel=1e-12)
    # A script that lifts it is told.
    good = window.setting
    lifted = "() => { try { stickslip.set({ load: -9.9 }); } catch (e) { return e.message; } }"
    assert "-9.9 N would lift the mass" in window.js(lifted)
    assert window.setting == good


def test_a_value_beyond_the_slider_is_taken_and_its_ends_follow(window: Window) -> None:
    for name, text in (("k", "1e6"), ("mu_s", "2.5"), ("N", "0.05")):
        window.type(name, text)
        low, high = (float(window.part(f"#{name}-slider", end)) for end in ("min", "max"))
        assert low < float(window.page.input_value(f"#{name}-slider")) < high
        seen = []
        for key in ("ArrowRight", "ArrowLeft", "ArrowLeft"):
            window.press(name, key)
            seen.append(window.N if name == "N" else window.setting[name])
        assert seen[2] < float(text) < seen[0] < 1.1 * float(text)


def test_the_kinetic_slider_ends_a_hundredth_below_the_static_coefficient(window: Window) -> None:
    for mu_s in (0.5, 0.57, 0.29, 1.1, 0.1234567, 0.02):
        window.type("mu_s", repr(mu_s))
        window.press("mu_k", "Home", "End")
        assert window.setting["mu_k"] == mu_s - 0.01
        window.press("mu_k", "ArrowLeft")
        assert window.setting["mu_k"] < mu_s - 0.01
    window.press("mu_s", "Home")
    window.press("mu_k", "End", "ArrowRight")
    assert window.setting["mu_k"] == 0.0


def test_mu_s_takes_mu_k_along_and_gives_it_back(window: Window) -> None:
    window.drag("mu_s", 0.1)
    low = window.setting
    assert low["mu_k"] == low["mu_s"] - 0.01 < 0.29
    assert "0.3" in window.said("mu_k")
    # What was asked outlives a reload.
    window.until("location.hash.includes('mu_s=0.15&mu_k=0.3&')")
    window.reload()
    assert window.setting == low
    assert "0.3" in window.said("mu_k")
    window.drag("mu_s", 0.5)
    assert window.setting["mu_k"] == 0.3
    assert window.said("mu_k") == ""


def test_a_kinetic_coefficient_above_the_static_one_is_clamped_as_by_the_reference(
    window: Window,
) -> None:
    draw = Random("clamp")
    for _ in range(25):
        mu_s = draw.choice([draw.uniform(0.0, 0.03), draw.uniform(0.0, 1.5)])
        mu_k = draw.choice([draw.uniform(0.0, 1.5), mu_s, mu_s + 1e-16, mu_s * (1 + 1e-15)])
        window.type("mu_s", repr(mu_s))
        window.type("mu_k", repr(mu_k))
        used = float(parameters({**START, "mu_s": mu_s, "mu_k": mu_k}).mu_k_used)
        assert window.setting["mu_k"] == used
        # Equal coefficients are no gap and no mistake.
        assert bool(window.said("mu_k")) == (mu_k > mu_s)
        window.set(mu_s=0.5, mu_k=0.3)
    window.type("mu_k", "0.7")
    assert all(number in window.said("mu_k") for number in ("0.7", "0.49"))
    window.page.keyboard.press("Tab")
    assert float(window.page.input_value("#mu_k")) == 0.49
