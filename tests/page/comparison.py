"""The page against Python: the error of each number in units of what it may be."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from tests.page.by_python import Expected
from tests.page.exchange import ask

if TYPE_CHECKING:
    from playwright.sync_api import Page

BOUND = 1e-12
"""Largest relative error of a read-out or a date, largest error of a state over its scale."""

ROUNDING = 2.0**-53
"""Largest relative error of one operation in doubles."""

DECIDABLE = 1e-9
"""|lambda/lambda_c - 1| below which nobody is asked whether the cycle exists."""

Answer = Mapping[str, Any]
Ratios = dict[str, float]

_ASK = """
questions => questions.map(({ values, times }) => {
  const page = window.stickslip;
  page.set(values);
  return {
    setting: page.setting,
    cycle: page.cycle,
    simplified: page.simplified,
    criticalVelocity: page.criticalVelocity,
    states: times.map(t => page.at(t)),
    events: page.events(0, times.at(-1)),
  };
})
"""


def answers(page: Page, settings: Sequence[Expected]) -> list[Answer]:
    """Set one setting after another in the page and read everything back, unrounded."""
    questions = [{"values": dict(each.setting), "times": list(each.times)} for each in settings]
    found: list[Answer] = ask(page, _ASK, questions)
    return found


def ratios(answer: Answer, expected: Expected) -> Ratios:
    """Give the largest error of each quantity over its bound; infinite where it is wrong in kind.

    Nothing is given for a setting so near the critical velocity that doubles cannot decide it.
    """
    if not decidable(expected):
        return {}
    return {
        **_numbers(answer, expected),
        **_cycle(answer["cycle"], expected),
        **_simplified(answer["simplified"], expected),
        **_events(answer["events"], expected),
        **_states(answer["states"], expected),
    }


def decidable(expected: Expected) -> bool:
    """Tell whether a rounding of the setting cannot change that it has, or lacks, a cycle."""
    return abs(expected.distance) > DECIDABLE


def dating(expected: Expected, t: float) -> float:
    """Give how well doubles date the last break-away before a time [s].

    The first one is a quotient of products and is known to twice the digits, and so is a stick
    without damping; a slip is rounded with w, lambda, atan and their quotient, four times. With
    damping a period holds an exponential, whose logarithm is the difference of two numbers below
    ln(1 + lambda) that take five operations; eight more make it, with w, Delta, lambda and the sum.
    This adds up over the periods that have passed.

    The state at a time t is that of the exact motion at a time so near t. It is what design.md,
    section 2, says of T: an error of the order of that of the state, of which t holds many. Without
    damping it shows only in the friction of a stick that is 1e-4 of its period, or shorter.
    """
    if not expected.cycle.exists:
        return 0.0
    past = max(t - float(expected.events[0].time), 0.0)
    if expected.p.c == 0.0:
        slips = math.ceil(past / float(expected.cycle.T))
        return ROUNDING * 4.0 * slips * float(expected.cycle.t_slip)
    return ROUNDING * (8.0 + 2.5 * math.log1p(float(expected.p.lambda_))) * past


def grazing(expected: Expected) -> float:
    """Give the growth of a relative error of state in t_slip, 1 + 1/sqrt(d): design.md, section 2.

    Near a grazing stop the speed is a parabola whose least is about -v d: the stop lies about
    sqrt(d)/w before that, and an error of d moves it by 1/sqrt(d) as much. As the mass hardly moves
    there, T and delta_x = v T do not take part: what the slip gains, the stick loses.
    """
    return 1.0 + 1.0 / math.sqrt(expected.distance) if expected.distance > 0.0 else 1.0


def _numbers(answer: Answer, expected: Expected) -> Ratios:
    p = expected.p
    v_c = answer["criticalVelocity"]
    used = {**expected.setting, "mu_k": float(p.mu_k_used)}
    found = {
        "setting": 0.0 if answer["setting"] == used else math.inf,
        "w": _relative(answer["cycle"]["w"], float(p.w)) / BOUND,
        "zeta": _relative(answer["cycle"]["zeta"], float(p.zeta)) / BOUND,
        "v_c": _relative(v_c, expected.coulomb_limit) / BOUND,
    }
    zeta = float(p.zeta)
    if 0.0 < zeta < 1.0:
        # Zeta is rounded three times, and ln lambda_c grows steeply towards zeta = 1: theory (13).
        steepness = 0.5 + zeta * (math.pi + math.acos(zeta)) / (1.0 - zeta**2) ** 1.5
        bound = BOUND + 3 * ROUNDING * steepness
        found["v_c, exactly"] = _relative(v_c, float(expected.exact_critical_velocity)) / bound
    return found


def _cycle(got: Mapping[str, Any], expected: Expected) -> Ratios:
    """Hold the read-outs against the reference and against the exact cycle."""
    formulas = asdict(expected.cycle)
    exists = bool(formulas.pop("exists"))
    found = {"exists": 0.0 if got["exists"] is exists is (expected.exact is not None) else math.inf}
    formulas["share"] = expected.cycle.t_stick / expected.cycle.T
    for label, cycle in (("", formulas), (", exactly", expected.exact or {})):
        for name, wanted in cycle.items():
            grazes = name in ("t_slip", "t_stick", "spring_drop", "share")
            bound = BOUND * (grazing(expected) if grazes else 1.0)
            found[name + label] = _relative(got[name], float(wanted)) / bound
    return found


def _simplified(got: Mapping[str, Any], expected: Expected) -> Ratios:
    wanted = asdict(expected.simplified)
    wanted["share"] = wanted["t_stick"] / wanted["T"]
    return {
        f"simplified {name}": _relative(got[name], float(value)) / BOUND
        for name, value in wanted.items()
    }


def _events(got: Sequence[Mapping[str, Any]], expected: Expected) -> Ratios:
    if [each["kind"] for each in got] != [each.kind for each in expected.events]:
        return {"kinds of events": math.inf}
    worst = {"time of break-away": 0.0, "time of re-stick": 0.0}
    for each, event in zip(got, expected.events, strict=True):
        bound = BOUND * event.time
        if event.kind == "re-stick":
            bound += BOUND * (grazing(expected) - 1.0) * float(expected.cycle.t_slip)
        error = abs(each["t"] - event.time)
        name = f"time of {event.kind}"
        worst[name] = max(worst[name], float(error / bound) if error else 0.0)
    return worst


def _states(got: Sequence[Mapping[str, Any]], expected: Expected) -> Ratios:
    parts = sizes(expected)
    worst = dict.fromkeys((*parts, "mode"), 0.0)
    for t, state, sample in zip(expected.times, got, expected.samples, strict=True):
        uncertain = dating(expected, t)
        # There the mode changes and friction jumps: on which side t lies is not known in doubles.
        at_an_event = any(abs(event.time - t) <= uncertain for event in expected.events)
        if state["mode"] != sample["mode"] and not at_an_event:
            worst["mode"] = math.inf
        for name, (scale, swiftness) in parts.items():
            if name == "F_friction" and at_an_event:
                continue
            error = float(abs(state[name] - sample[name]))
            bound = BOUND * scale + uncertain * swiftness
            worst[name] = max(worst[name], error / bound if error else 0.0)
    return worst


def sizes(expected: Expected) -> dict[str, tuple[float, float]]:
    """Give scale and swiftness of each part of the state: its largest size and rate in the run.

    Forces are held against F_s at least. The rates are those of the equation of motion.
    """
    p = expected.p

    def largest(*names: str) -> float:
        return max(float(abs(sum(sample[n] for n in names))) for sample in expected.samples)

    F_s, k, v = float(p.F_s), float(p.k), float(p.v)
    speed = largest("x_dot")
    # Sharpest at the break-away itself, where it is (mu_s - mu_k) N/m, or on the way.
    x_ddot = max(float(p.w**2 * p.Delta), largest("F", "F_friction") / float(p.m))
    return {
        "x": (largest("x"), speed),
        "x_dot": (speed, x_ddot),
        "x_pull": (largest("x_pull"), v),
        "z": (largest("z"), v + speed),
        "F": (max(largest("F"), F_s), k * (v + speed)),
        "F_friction": (max(largest("F_friction"), F_s), max(k * v, float(p.c) * x_ddot)),
    }


def _relative(got: float, wanted: float) -> float:
    """Error over size; 0 where both are equal or both are no number."""
    if got == wanted or (math.isnan(got) and math.isnan(wanted)):
        return 0.0
    if math.isnan(got) or math.isinf(wanted) or wanted == 0.0:
        return math.inf
    return abs(got - wanted) / abs(wanted)
