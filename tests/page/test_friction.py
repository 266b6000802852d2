"""The motion under a friction curve in the page against the block, and the bar over the speeds."""

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from random import Random
from typing import Any, NamedTuple

import pytest

from stickslip_ref import Parameters, critical_velocity
from tests.conftest import built
from tests.driver import loaded
from tests.fmu.blocks import log_uniform
from tests.laws import stribeck
from tests.page.exact import BOUND, ROUNDING, on_a_grid
from tests.page.settings import NAMES, Setting, block, with_damping
from tests.page.window import Window

Curve = Sequence[Sequence[float]]
Sized = Callable[[int], int]

FALLS_TWICE: Curve = [[0.0, 0.5], [0.02, 0.3], [0.15, 0.45], [0.4, 0.2], [0.6, 0.25]]
STATE = ("x", "x_dot", "x_pull", "z", "F", "F_friction", "mode")
METER = ("T", "t_slip", "t_stick", "delta_x", "spring_drop", "x_dot_peak")


class Run(NamedTuple):
    """A setting under a curve, the block's outputs at some times [s], whether it came to rest."""

    setting: Setting
    curve: Curve
    times: Sequence[float]
    outputs: Sequence[Mapping[str, float]]
    rests: bool


def drawn(draw: Random) -> tuple[Setting, Curve]:
    """Draw a setting, and a curve with slopes up to 3 times the critical damping."""
    p = draw.choice([block, with_damping])(draw)
    w, N = math.sqrt(p["k"] / p["m"]), p["m"] * p["g"] + p["load"]
    fast = p["mu_s"] * N / p["m"] / w + p["v"]
    steepest = 6.0 * w * p["m"] / N
    curve = [(0.0, p["mu_s"] * draw.choice([1.0, draw.random()]))]
    for _ in range(draw.randint(1, 11)):
        u, mu = curve[-1]
        width = max(draw.choice([fast, p["v"]]) * log_uniform(draw, 1e-3, 1.0), u * 1e-2)
        aim = p["mu_s"] * draw.random()
        curve.append((u + width, min(max(aim, mu - steepest * width), mu + steepest * width)))
    return p, curve


def run(p: Setting, curve: Curve) -> Run:
    first = p["mu_s"] * (p["m"] * p["g"] + p["load"]) / (p["k"] * p["v"])
    turn = 2.0 * math.pi * math.sqrt(p["m"] / p["k"])
    instants = [0.5 * first, *(first + 0.37 * n * turn for n in range(1, 25))]
    # A stick is no longer than the load-up from the spring's opposite end; a long one is not seen.
    times = on_a_grid([*instants, instants[-1] + min(2.0 * first, 40.0 * turn)])
    values = {name: p[name] for name in NAMES if name != "mu_k"} | stribeck.curve(curve)
    instance = loaded(built("python-2", "stribeck")).instance()
    instance.start(**{n: int(x) if n in ("shape", "n_points") else x for n, x in values.items()})
    outputs = []
    for before, time in pairwise([0.0, *times]):
        instance.step(time - before)
        read = instance.get(*STATE, *METER)
        outputs.append({name: float(x) for name, x in zip((*STATE, *METER), read, strict=True)})
    instance.free()
    rests = outputs[-1]["T"] > 0.0 or any(each["mode"] == 0.0 for each in outputs[1:])
    return Run(p, curve, times, outputs, rests)


def states_off(states: Sequence[Mapping[str, Any]], made: Run) -> dict[str, float]:
    """Return the largest error of each part of the state over its bound.

    The state of the page is that of the exact motion at a time that rounding leaves open: 8
    roundings of the time. Growing swings carry it on, by e at most in the swings compared.
    """
    p, k = made.setting, made.setting["k"]
    largest = {name: max(abs(each[name]) for each in made.outputs) for name in STATE[:-1]}
    speed = largest["x_dot"] + p["v"]
    x_ddot = (largest["F"] + largest["F_friction"]) / p["m"]
    fall = max(abs(b[1] - a[1]) / (b[0] - a[0]) for a, b in pairwise(made.curve))
    damping = p["c"] + fall * (p["m"] * p["g"] + p["load"])
    # Friction is known no better than its slope lets the speed be.
    largest["F_friction"] += damping * largest["x_dot"]
    rates = {"x": speed, "x_dot": x_ddot, "x_pull": p["v"], "z": speed, "F": k * speed}
    rates["F_friction"] = max(k * p["v"], damping * x_ddot)
    found = dict.fromkeys((*rates, "mode"), 0.0)
    for t, state, output in zip(made.times, states, made.outputs, strict=True):
        if state["mode"] != output["mode"]:
            found["mode"] = math.inf
        for name, rate in rates.items():
            bound = BOUND * largest[name] + 8.0 * ROUNDING * math.e * t * rate
            found[name] = max(found[name], abs(state[name] - output[name]) / bound)
    return found


def cycle_off(cycle: Mapping[str, Any], made: Run) -> dict[str, float]:
    """Hold the numbers of the cycle against the block's meter, where it has seen a cycle."""
    last, p = made.outputs[-1], made.setting
    found = {"exists": 0.0 if cycle["exists"] is made.rests else math.inf}
    if not made.rests or last["T"] == 0.0:
        return found
    expected = {name: abs(last[name]) for name in METER}
    if any(each["mode"] < 0.0 for each in made.outputs) or last["delta_x"] < 0.0:
        # A slip back is one of its own to the meter.
        expected = {name: expected[name] for name in ("T", "t_stick")}
        expected["spring_drop"] = p["v"] * last["t_stick"]
    # The block carries the spring itself: a small part of it is known to its rounding.
    F_s = p["mu_s"] * (p["m"] * p["g"] + p["load"])
    bound = BOUND + 8.0 * ROUNDING * F_s / (p["k"] * p["v"] * last["t_stick"])
    # What the slip gains near a graze the stick loses: held against the whole period.
    whole = {"t_stick": last["T"], "t_slip": last["T"], "spring_drop": p["v"] * last["T"]}
    for name, value in expected.items():
        found[name] = abs(cycle[name] - value) / (bound * whole.get(name, value))
    return found


def test_states_and_cycle_under_a_curve_are_those_of_the_block(
    window: Window, sized: Sized
) -> None:
    draw = Random("curve 0")
    runs = [run(*drawn(draw)) for _ in range(sized(1000))]
    answers = window.js(
        """all => all.map(([values, curve, times]) => {
          stickslip.set(values, curve);
          return [stickslip.cycle, times.map(t => stickslip.at(t))];
        })""",
        [[each.setting, each.curve, each.times] for each in runs],
    )
    assert sum(each.rests for each in runs) > len(runs) / 2
    for (cycle, states), made in zip(answers, runs, strict=True):
        off = {**states_off(states, made), **cycle_off(cycle, made)}
        assert {n: x for n, x in off.items() if not x <= 1.0} == {}, (made.setting, made.curve)


def regimes(window: Window, p: Setting, curve: Curve, low: float, high: float) -> Any:
    window.set(curve, **p)
    return window.js("([c, a, b]) => stickslip.regimes(c, a, b, 0.01)", [curve, low, high])


def ends_of(found: Sequence[Mapping[str, Any]], name: str, wanted: bool) -> list[float]:
    """Return the ends [m/s] of the ranges in which the bar says so, touching ones as one."""
    ends: list[float] = []
    for each in found:
        if each[name] is wanted:
            start = ends[:-1] if ends and ends[-1] == each["low"] else [*ends, each["low"]]
            ends = [*start, each["high"]]
    return ends


def test_the_bar_ends_where_the_reference_finds_the_limits(window: Window, sized: Sized) -> None:
    draw = Random("bar")
    for _ in range(sized(50)):
        p, curve = drawn(draw)
        p = {**p, "mu_k": min(p["mu_k"], p["mu_s"])}
        between = (p["v"] / 30.0, p["v"] * 30.0)
        limits = critical_velocity(Parameters(**p), "stribeck", stribeck.curve(curve), between)
        found = regimes(window, p, curve, *between)
        cycles = [end for each in limits.cycle for end in (each.low, each.high)]
        # The reference integrates to a grazing stop, whose speed is known to half of the digits.
        assert ends_of(found, "sticks", True) == pytest.approx(cycles, rel=1e-9), (p, curve)
        unstable = [end for each in limits.unstable for end in (each.low, each.high)]
        assert ends_of(found, "even", False) == unstable, (p, curve)


def test_a_flat_curve_is_constant_friction_to_the_bit_and_so_is_its_limit(window: Window) -> None:
    draw = Random("flat")
    told = "p => [stickslip.cycle, stickslip.at(1), stickslip.events(0, 1e3 * p.v)]"
    for _ in range(15):
        p = {**with_damping(draw), "load": 0.0}
        p["mu_k"] = 0.6 * p["mu_s"]
        window.set(None, **p)
        constant, v_c = window.js(told, p), window.js("stickslip.criticalVelocity")
        window.set([[0.0, p["mu_k"]], [p["v"], p["mu_k"]], [3.0, p["mu_k"]]], **p)
        assert repr(window.js(told, p)) == repr(constant)
        # Damping above the critical leaves no cycle, and nearly so much one at no speed of use.
        if v_c > 1e-6 * p["v"]:
            flat = [[0.0, p["mu_k"]], [v_c, p["mu_k"]]]
            found = regimes(window, p, flat, v_c / 30.0, v_c * 30.0)
            assert [each["sticks"] for each in found] == [True, False]
            # The least speed of the slip is known to rounding of its swing.
            assert found[0]["high"] == pytest.approx(v_c, rel=1e-11)
