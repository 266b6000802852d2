"""The sliders: their ends, their keys, the mouse, and the gap that the friction sliders keep."""

import pytest

from tests.page.settings import START, table
from tests.page.window import SI, Window


def reached(window: Window, name: str, *keys: str) -> float:
    window.press(name, *keys)
    return window.N if name == "N" else float(window.setting[name])


def test_keys_reach_both_ends_of_a_slider_and_move_it_by_small_steps(window: Window) -> None:
    for row in table("controls", "control"):
        name, ends = row["name"], [row["low"], row["high"]]
        if name != "mu_k":
            found = [reached(window, name, "ArrowRight", key) for key in ("Home", "End")]
            assert found == pytest.approx(ends, rel=1e-12)
    # A value beyond the slider is taken, and its ends follow.
    for name, text in (("k", "300"), ("v", "50"), ("k", "1e6"), ("mu_s", "2.5"), ("N", "0.05")):
        window.type(name, text)
        value = window.N if name == "N" else window.setting[name]
        above = reached(window, name, "ArrowRight")
        below = reached(window, name, "ArrowLeft", "ArrowLeft")
        assert below < value < above < 1.1 * value, name


def test_a_dragged_slider_is_drawn_counted_and_written_into_its_field(window: Window) -> None:
    for name in SI:
        pictures, period = window.paths(), window.text("#readout-T data")
        window.drag(name, 0.35)
        used = window.N if name == "N" else window.setting[name]
        # The field has twelve digits or more.
        assert used == pytest.approx(window.si_of(name), rel=1e-11)
        # Without damping N moves the forces with the jump, and none of the period.
        assert name == "N" or window.text("#readout-T data") != period, name
        # Only v moves the pulled end, and the scale of the axis may stay.
        same = {each for each, path in window.paths().items() if path == pictures[each]}
        assert all(each.endswith("pull") for each in same), name
        window.set(**START)


def test_the_normal_force_sets_the_load_and_has_the_weight_of_the_mass(window: Window) -> None:
    for text, parts in (("20", "load 10.19 N"), ("5", "load −4.81 N"), ("0", "load −9.81 N")):
        window.type("N", text)
        assert window.setting["load"] == float(text) - 9.81
        assert window.text("#N-parts") == f"weight 9.81 N + {parts}"
    # Another mass keeps the load; one that would lift it is held at -m g until the mass is back.
    window.set(load=-15.0, m=2.0)
    for mass, load in (("1", -9.81), ("0.5", -0.5 * 9.81), ("2", -15.0)):
        window.type("m", mass)
        assert window.setting["load"] == load
    # A script that lifts it is told.
    lifted = "() => { try { stickslip.set({ load: -19.9 }); } catch (e) { return e.message; } }"
    assert "-19.9 N would lift the mass" in window.js(lifted)
    assert window.setting["load"] == -15.0


def test_the_kinetic_slider_ends_a_hundredth_below_the_static_coefficient(window: Window) -> None:
    for mu_s in (0.5, 0.57, 0.29, 1.1, 0.1234567, 0.02):
        window.type("mu_s", repr(mu_s))
        assert reached(window, "mu_k", "Home", "End") == mu_s - 0.01
        assert reached(window, "mu_k", "ArrowLeft") < mu_s - 0.01
    # What mu_s takes along it gives back, even over a reload.
    window.set(**START)
    window.drag("mu_s", 0.1)
    low = window.setting
    assert low["mu_k"] == low["mu_s"] - 0.01 < 0.29
    window.until("location.hash.includes('mu_s=0.15&mu_k=0.3&')")
    window.reload()
    assert window.setting == low
    assert "0.3" in window.said("mu_k")
    window.drag("mu_s", 0.5)
    assert (window.setting["mu_k"], window.said("mu_k")) == (0.3, "")


def test_a_kinetic_coefficient_above_the_static_one_is_clamped_and_said(window: Window) -> None:
    # Equal coefficients are no gap and no mistake.
    window.type("mu_k", "0.5")
    assert (window.setting["mu_k"], window.said("mu_k")) == (0.5, "")
    window.type("mu_k", "0.7")
    assert all(number in window.said("mu_k") for number in ("0.7", "0.49"))
    window.page.keyboard.press("Tab")
    assert float(window.page.input_value("#mu_k")) == 0.49
