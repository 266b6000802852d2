"""The motion under a friction curve in the page against the block in Python, and the bar over v."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Any, NamedTuple

import pytest

from stickslip_fmu.laws.stribeck.law import STRIBECK
from stickslip_fmu.spec import spec_of
from stickslip_ref import Parameters, critical_velocity, simulate
from tests.fmu.blocks import block_of
from tests.laws.stribeck import curve as own_of
from tests.page.browser import planted
from tests.page.by_python import on_a_grid
from tests.page.exchange import ask
from tests.page.settings import NAMES, Setting, block, log_uniform, with_damping

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

Curve = Sequence[Sequence[float]]

BATCHES = 10
"""Of 100 settings each."""
SEEDS = [0, *(pytest.param(seed, marks=pytest.mark.soak) for seed in range(1, BATCHES))]

BOUND = 1e-12
"""Largest error of a state over its scale, largest relative error of the cycle's numbers."""

FALLS_TWICE: Curve = ((0.0, 0.5), (0.02, 0.3), (0.15, 0.45), (0.4, 0.2), (0.6, 0.25))
SPEC = spec_of(STRIBECK)

_ASK = """
questions => questions.map(({ values, curve, times }) => {
  const page = window.stickslip;
  page.set(values, curve);
  return { cycle: page.cycle, states: times.map(t => page.at(t)) };
})
"""


class Case(NamedTuple):
    """A setting under a curve, and what the block gives at some times [s]."""

    setting: Setting
    curve: Curve
    times: Sequence[float]
    outputs: Sequence[Mapping[str, float]]


def drawn_curve(draw: Random) -> tuple[Setting, Curve]:
    """Draw a setting and a curve with its points about the speeds of its slips.

    Slopes are up to 3 times the critical damping, falling and rising.
    """
    p = draw.choice([block, with_damping])(draw)
    w, N = math.sqrt(p["k"] / p["m"]), p["m"] * p["g"] + p["load"]
    fast = p["mu_s"] * N / p["m"] / w + p["v"]
    steepest = 6.0 * w * p["m"] / N
    curve = [(0.0, p["mu_s"] * draw.choice([1.0, draw.random()]))]
    for _ in range(draw.randint(1, 11)):
        u, mu = curve[-1]
        width = max(draw.choice([fast, p["v"]]) * log_uniform(draw, 1e-3, 1.0), u * 1e-2)
        wanted = p["mu_s"] * draw.random()
        curve.append((u + width, min(max(wanted, mu - steepest * width), mu + steepest * width)))
    return p, curve


@functools.cache
def drawn(seed: int) -> tuple[Case, ...]:
    """Give the 100 settings of a seed, and what the block says of them."""
    draw = Random(f"curve {seed}")
    return tuple(case(*drawn_curve(draw)) for _ in range(100))


def case(p: Setting, curve: Curve) -> Case:
    """Ask the block: through the first load-up, over some swings and over the second stick."""
    first = p["mu_s"] * (p["m"] * p["g"] + p["load"]) / (p["k"] * p["v"])
    turn = 2.0 * math.pi * math.sqrt(p["m"] / p["k"])
    instants = [0.5 * first, *(first + 0.37 * n * turn for n in range(1, 25))]
    # A stick is no longer than the load-up from the spring's opposite end; a long one is not seen.
    times = on_a_grid([*instants, instants[-1] + min(2.0 * first, 40.0 * turn)])
    values = {name: p[name] for name in NAMES if name != "mu_k"}
    model = block_of(SPEC, {**values, **own_of(curve)})
    before, outputs = 0.0, []
    for time in times:
        model.advance(before, time - before)
        before = time
        model.refresh()
        meter = model.meter
        names = ("x", "x_dot", "x_pull", "z", "F", "F_friction", "mode")
        of_cycle = ("T", "t_slip", "t_stick", "delta_x", "spring_drop", "x_dot_peak", "n_slips")
        outputs.append(
            {name: float(getattr(model, name)) for name in names}
            | {name: float(getattr(meter, name)) for name in of_cycle}
        )
    return Case(p, curve, times, outputs)


def refuted(page: Page, cases: Sequence[Case]) -> dict[str, str]:
    """Give each quantity that breaks its bound, how far, and where."""
    questions = [
        {"values": dict(each.setting), "curve": each.curve, "times": each.times} for each in cases
    ]
    worst: dict[str, tuple[float, Case]] = {}
    for answer, each in zip(ask(page, _ASK, questions), cases, strict=True):
        for name, ratio in {**_states(answer, each), **_cycle(answer["cycle"], each)}.items():
            severity = math.inf if math.isnan(ratio) else ratio
            if severity > worst.get(name, (1.0,))[0]:
                worst[name] = severity, each
    return {
        name: f"{ratio:.3g} times its bound at {dict(each.setting)}, {each.curve}"
        for name, (ratio, each) in worst.items()
    }


def _states(answer: Mapping[str, Any], each: Case) -> dict[str, float]:
    """Give the largest error of each part of the state over its bound.

    The state of the page is that of the exact motion at a time that rounding leaves open: 4 parts
    in 2^53 of the time. Growing swings carry it on, by e at most in the swings that are compared.
    """
    p, k = each.setting, each.setting["k"]
    largest = {
        name: max(abs(output[name]) for output in each.outputs)
        for name in ("x", "x_dot", "x_pull", "z", "F", "F_friction")
    }
    speed = largest["x_dot"] + p["v"]
    x_ddot = (largest["F"] + largest["F_friction"]) / p["m"]
    fall = max(
        abs(after[1] - before[1]) / (after[0] - before[0])
        for before, after in zip(each.curve, each.curve[1:], strict=False)
    )
    damping = p["c"] + fall * (p["m"] * p["g"] + p["load"])
    # Friction is known no better than its slope lets the speed be.
    largest["F_friction"] += damping * largest["x_dot"]
    rates = {
        "x": speed,
        "x_dot": x_ddot,
        "x_pull": p["v"],
        "z": speed,
        "F": k * speed,
        "F_friction": max(k * p["v"], damping * x_ddot),
    }
    found = dict.fromkeys((*rates, "mode"), 0.0)
    for t, state, output in zip(each.times, answer["states"], each.outputs, strict=True):
        if state["mode"] != output["mode"]:
            found["mode"] = math.inf
        for name, rate in rates.items():
            bound = BOUND * largest[name] + 4.0 * 2.0**-53 * math.e * t * rate
            found[name] = max(found[name], abs(state[name] - output[name]) / bound)
    return found


def _cycle(cycle: Mapping[str, Any], each: Case) -> dict[str, float]:
    """Hold the numbers of the cycle against the meter of the block, where it has seen a cycle."""
    last = each.outputs[-1]
    rested = _rests(each)
    found = {"exists": 0.0 if cycle["exists"] is rested else math.inf}
    backward = any(output["mode"] < 0.0 for output in each.outputs) or last["delta_x"] < 0.0
    if not rested or last["T"] == 0.0:
        return found
    names = ["T", "t_stick", "spring_drop"]
    p = each.setting
    F_s = p["mu_s"] * (p["m"] * p["g"] + p["load"])
    # A slip back is one of its own to the meter.
    names += [] if backward else ["t_slip", "delta_x", "x_dot_peak"]
    for name in names:
        wanted = abs(last[name])
        if backward and name == "spring_drop":
            wanted = p["v"] * last["t_stick"]
        # What the slip gains near a graze the stick loses: held against the whole period.
        whole = {"t_stick": last["T"], "t_slip": last["T"], "spring_drop": p["v"] * last["T"]}
        # The block carries the spring itself: a small part of it is known to its rounding.
        part = p["k"] * p["v"] * last["t_stick"] / F_s
        bound = BOUND + 4.0 * 2.0**-53 / part
        found[name] = abs(cycle[name] - wanted) / (bound * whole.get(name, wanted))
    return found


def _rests(each: Case) -> bool:
    """Tell whether the block has come to rest; a second break-away shows a stick unseen."""
    return each.outputs[-1]["T"] > 0.0 or any(one["mode"] == 0.0 for one in each.outputs[1:])


@pytest.mark.parametrize("seed", SEEDS)
def test_the_page_moves_under_a_curve_as_the_block_does(page: Page, seed: int) -> None:
    """At 1,000 random settings and curves states, cycle and its existence are those of Python."""
    cases = drawn(seed)
    assert sum(map(_rests, cases)) > 50
    assert not refuted(page, cases)


FAULTS = {
    "another acceleration beyond a point": (
        "arcAt(contact, index + step, mode, start, { ...state, x_dot, x_ddot })",
        "arcAt(contact, index + step, mode, start, { ...state, x_dot, x_ddot: 1.000001 * x_ddot })",
    ),
    "slope a little off": (
        "const fall = high < Infinity ? (mu - next) / (high - low) : 0;",
        "const fall = high < Infinity ? (1.0000000001 * (mu - next)) / (high - low) : 0;",
    ),
    "loses a shallow stop": ("if (beyond > 0 || !turns)", "if (beyond > 0.2 * v || !turns)"),
    "no slip back": (
        "if (!(excess > FORCE_SLACK)) {",
        "if (!(excess > 1)) {",
    ),
    "friction of mu_1 throughout": (
        "isConstant ? numbers.F_k : coefficientAt(curve, Math.abs(speed)) * numbers.N",
        "isConstant ? numbers.F_k : coefficientAt(curve, 0) * numbers.N",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_planted_fault_is_found(
    browser: Browser, page_file: Path, tmp_path: Path, name: str
) -> None:
    """The comparison refutes a page that loses a stop, a slip back or the tenth digit."""
    with planted(browser, page_file, tmp_path, *FAULTS[name]) as page:
        assert refuted(page, drawn(0))


def regimes(page: Page, values: Setting, curve: Curve, low: float, high: float) -> Any:
    """Ask the page for the bar at its finest."""
    question = {"values": dict(values), "curve": curve, "low": low, "high": high}
    return ask(
        page,
        "({ values, curve, low, high }) => {"
        " window.stickslip.set(values, curve);"
        " return window.stickslip.regimes(curve, low, high, 0.01); }",
        question,
    )


def rests(values: Setting, curve: Curve, v: float) -> bool:
    """Tell by the reference whether the slip from break-away comes to rest."""
    p = Parameters(**{**values, "v": v})
    first = float(p.F_s / (p.k * v))
    run = simulate(p, first + 30.0 / float(p.w), law="stribeck", own=own_of(curve))
    return any(event.kind == "re-stick" for event in run.events)


def ranges(found: Sequence[Mapping[str, Any]], name: str, wanted: bool) -> list[float]:
    """Give the ends of the ranges in which the bar says so, touching ones as one."""
    ends: list[float] = []
    for each in found:
        if each[name] is not wanted:
            continue
        if ends and ends[-1] == each["low"]:
            ends[-1] = each["high"]
        else:
            ends += [each["low"], each["high"]]
    return ends


@pytest.mark.parametrize("seed", [0, *(pytest.param(n, marks=pytest.mark.soak) for n in (1, 2, 3))])
def test_the_bar_ends_where_the_reference_finds_the_limits(page: Page, seed: int) -> None:
    """Cycles with a stick to 1e-9, which the reference integrates; instability to the bit."""
    draw = Random(f"bar {seed}")
    for _ in range(6 if seed == 0 else 30):
        p, curve = drawn_curve(draw)
        p = {**p, "mu_k": min(p["mu_k"], p["mu_s"])}
        between = (p["v"] / 30.0, p["v"] * 30.0)
        wanted = critical_velocity(Parameters(**p), "stribeck", own_of(curve), between)
        found = regimes(page, p, curve, *between)
        cycles = [end for each in wanted.cycle for end in (each.low, each.high)]
        unstable = [end for each in wanted.unstable for end in (each.low, each.high)]
        assert ranges(found, "sticks", True) == pytest.approx(cycles, rel=1e-9), (p, curve)
        assert ranges(found, "even", False) == unstable, (p, curve)


def test_a_curve_that_falls_twice_sticks_in_two_ranges(page: Page) -> None:
    """Its ends are where the reference finds them; steady sliding changes at points."""
    values = {"c": 2.0}
    found = regimes(page, values, FALLS_TWICE, 1e-3, 10.0)
    ends = [each["low"] for each in found[1:]]
    kinds = [(each["sticks"], each["even"]) for each in found]
    assert [ends[0], ends[3], ends[4]] == [0.02, 0.15, 0.4]
    assert kinds == [
        (True, False), (True, True), (False, True), (True, True), (True, False), (True, True),
        (False, True),
    ]  # fmt: skip
    for end, below in ((ends[1], True), (ends[2], False), (ends[5], True)):
        assert rests(values, FALLS_TWICE, end * (1.0 - 1e-6)) is below
        assert rests(values, FALLS_TWICE, end * (1.0 + 1e-6)) is not below


def test_the_bar_of_a_flat_curve_ends_at_the_critical_velocity(page: Page) -> None:
    """The root of the search is the closed form of constant friction."""
    draw = Random("flat")
    for _ in range(10):
        p = {**with_damping(draw), "load": 0.0}
        p["mu_k"] = 0.6 * p["mu_s"]
        take = "p => { window.stickslip.set(p, null); return window.stickslip.criticalVelocity; }"
        v_c = ask(page, take, p)
        # Damping above the critical leaves no cycle, and nearly so much one at no speed of use.
        if not v_c > 1e-6 * p["v"]:
            continue
        flat = [[0.0, p["mu_k"]], [v_c, p["mu_k"]]]
        found = regimes(page, p, flat, v_c / 30.0, v_c * 30.0)
        assert [each["sticks"] for each in found] == [True, False]
        # The least speed of the slip is known to rounding of its swing.
        assert found[0]["high"] == pytest.approx(v_c, rel=1e-11)


def test_a_flat_curve_is_constant_friction_to_the_bit(page: Page) -> None:
    """With all points alike nothing differs from the page without a curve."""
    draw = Random("alike")
    for _ in range(20):
        p = with_damping(draw)
        p["mu_k"] = min(p["mu_k"], p["mu_s"])
        ask_both = """({ p, curve }) => [null, curve].map(each => {
          window.stickslip.set(p, each);
          const { cycle, at, events } = window.stickslip;
          return [cycle, at(1), events(0, 1e3 * p.v)];
        }).map(each => JSON.stringify(each))"""
        curve = [[0.0, p["mu_k"]], [p["v"], p["mu_k"]], [3.0, p["mu_k"]]]
        one, other = ask(page, ask_both, {"p": p, "curve": curve})
        assert one == other


def test_the_sound_is_that_of_the_motion_under_the_curve(page: Page) -> None:
    """The harmonics in closed form, summed up, are the velocity of the cycle."""
    reverses = [(0.0, 0.5), (0.3, 0.0)]
    for values, curve in (({"c": 2.0, "v": 0.3}, FALLS_TWICE), ({"c": 0.0, "v": 0.1}, reverses)):
        found = ask(
            page,
            """({ values, curve }) => {
              const page = window.stickslip;
              page.set(values, curve);
              const [begin] = page.events(0, 100).filter(({ t }) => t > 0).slice(0, 1);
              const { T } = page.cycle;
              const times = Array.from({ length: 4000 }, (_, n) => (n * T) / 4000);
              const { cosines, sines } = page.harmonics(5);
              return { cosines, sines, speeds: times.map(t => page.at(begin.t + T + t).x_dot) };
            }""",
            {"values": values, "curve": curve},
        )
        count = len(found["speeds"])
        largest = max(found["speeds"])
        for n in range(1, 6):
            turns = [2.0 * math.pi * n * i / count for i in range(count)]
            pairs = list(zip(found["speeds"], turns, strict=True))
            cosine = 2.0 / count * math.fsum(v * math.cos(turn) for v, turn in pairs)
            sine = 2.0 / count * math.fsum(v * math.sin(turn) for v, turn in pairs)
            # The trapezoidal rule over 4,000 samples of a curve with corners.
            assert found["cosines"][n] == pytest.approx(cosine, abs=1e-6 * largest)
            assert found["sines"][n] == pytest.approx(sine, abs=1e-6 * largest)
