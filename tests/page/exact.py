"""What Python says of a setting, and the page's error in units of what it may be."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from itertools import pairwise
from typing import Any

from stickslip_ref import coulomb_limit, simplified, steady_cycle
from stickslip_verification import truth
from tests.page.settings import Setting, parameters

DIGITS = 30
CYCLES = 3
WITHIN = (1e-6, 0.02, 0.31, 0.5, 0.77, 0.98, 1.0 - 1e-6)
"""Where in each slip and stick the states are compared: its inside, and close to either event."""

BOUND = 1e-12
"""Largest relative error of a read-out or a date, largest error of a state over its scale."""

ROUNDING = 2.0**-53
"""Largest relative error of one operation in doubles."""

DECIDABLE = 1e-9
"""|lambda/lambda_c - 1| below which nobody is asked whether the cycle exists."""

Ratios = dict[str, float]


class Exact:
    """A setting, its closed forms by the reference, and its motion in high precision.

    `distance` is lambda/lambda_c - 1 = v_c/v - 1: infinite without damping, -1 where damping leaves
    no cycle. `samples` and `events` are every output at `times` [s], and the transitions till then.
    """

    def __init__(self, setting: Setting) -> None:
        self.setting = setting
        self.p = parameters(setting)
        self.cycle = steady_cycle(self.p)
        self.v_c = float(coulomb_limit(self.p))
        self.distance = self.v_c / setting["v"] - 1.0
        self.times = on_a_grid(_instants(self))
        steps = [truth.Step(b - a) for a, b in pairwise([0.0, *self.times])]
        run = truth.run(setting, steps, digits=DIGITS)
        self.samples, self.events = run.samples, run.events


def is_decidable(setting: Setting) -> bool:
    return abs(float(coulomb_limit(parameters(setting))) / setting["v"] - 1.0) > DECIDABLE


def on_a_grid(times: Sequence[float]) -> list[float]:
    """Move the times to multiples of one unit, so that their differences are exact doubles."""
    unit = math.ulp(max(times))
    return [n * unit for n in sorted({round(t / unit) for t in times}) if n > 0]


def _instants(exact: Exact) -> list[float]:
    p, cycle = exact.p, exact.cycle
    first = float(p.F_s / (p.k * p.v))
    phases = [(0.0, first)]
    if cycle.exists:
        for n in range(CYCLES):
            begin = first + n * float(cycle.T)
            phases.append((begin, float(cycle.t_slip)))
            phases.append((begin + float(cycle.t_slip), float(cycle.t_stick)))
    else:
        # Three turns, and three times the slower rate's time where damping is strong.
        phases.append((first, 3.0 * (2.0 * math.pi + 2.0 * float(p.zeta)) / float(p.w)))
    times = [begin + part * length for begin, length in phases for part in WITHIN if length > 0.0]
    # The run ends well inside a phase, where nobody can doubt which events it has had.
    return times[:-1]


ASK = """questions => questions.map(([values, times]) => {
  const page = window.stickslip;
  page.set(values, null);
  const { setting, cycle, simplified, criticalVelocity } = page;
  const states = times.map(t => page.at(t));
  const events = page.events(0, times.at(-1));
  return { setting, cycle, simplified, criticalVelocity, states, events };
})"""
"""Sets one setting after another in the page and reads everything back, unrounded."""


def ratios(answer: Mapping[str, Any], exact: Exact) -> Ratios:
    return {
        **_cycle(answer, exact),
        **_events(answer["events"], exact),
        **_states(answer["states"], exact),
    }


def relative(got: float, expected: float) -> float:
    """Return error over size; 0 where both are equal or both are no number."""
    if got == expected or (math.isnan(got) and math.isnan(expected)):
        return 0.0
    if math.isnan(got) or math.isnan(expected) or math.isinf(expected) or expected == 0.0:
        return math.inf
    return abs(got - expected) / abs(expected)


def _grazing(exact: Exact) -> float:
    """Return the growth of a relative error of state in t_slip, 1 + 1/sqrt(d): design.md, 2.

    As the mass hardly moves there, T and delta_x = v T do not take part: the stick loses it.
    """
    return 1.0 + 1.0 / math.sqrt(exact.distance) if exact.distance > 0.0 else 1.0


def _cycle(answer: Mapping[str, Any], exact: Exact) -> Ratios:
    p, got = exact.p, answer["cycle"]
    formulas, rules = asdict(exact.cycle), asdict(simplified(p))
    found = {
        "setting": 0.0 if answer["setting"] == {**exact.setting, "mu_k": p.mu_k_used} else math.inf,
        "exists": 0.0 if got["exists"] is bool(formulas.pop("exists")) else math.inf,
        "v_c": relative(answer["criticalVelocity"], exact.v_c) / BOUND,
    }
    del formulas["attractors"]
    for each in (formulas, rules):
        each["share"] = each["t_stick"] / each["T"]
    formulas |= {"w": p.w, "zeta": p.zeta}
    for label, numbers, shown in (
        ("", formulas, got),
        ("simplified ", rules, answer["simplified"]),
    ):
        for name, expected in numbers.items():
            grazes = name in ("t_slip", "t_stick", "spring_drop", "share") and shown is got
            bound = BOUND * (_grazing(exact) if grazes else 1.0)
            found[label + name] = relative(shown[name], float(expected)) / bound
    return found


def _events(got: Sequence[Mapping[str, Any]], exact: Exact) -> Ratios:
    if [each["kind"] for each in got] != [each.kind for each in exact.events]:
        return {"kinds of events": math.inf}
    worst = {"time of break-away": 0.0, "time of re-stick": 0.0}
    for each, event in zip(got, exact.events, strict=True):
        bound = BOUND * event.time
        if event.kind == "re-stick":
            bound += BOUND * (_grazing(exact) - 1.0) * float(exact.cycle.t_slip)
        error = abs(each["t"] - event.time)
        name = f"time of {event.kind}"
        worst[name] = max(worst[name], float(error / bound) if error else 0.0)
    return worst


def _dating(exact: Exact, t: float) -> float:
    """Return how well doubles date the last break-away before a time [s]: design.md, 2, for T.

    An undamped slip is rounded four times; a damped period eight times, and its logarithm is the
    difference of two numbers below ln(1 + lambda) of five operations. Over all periods that passed.
    """
    if not exact.cycle.exists:
        return 0.0
    past = max(t - float(exact.events[0].time), 0.0)
    if exact.p.c == 0.0:
        slips = math.ceil(past / float(exact.cycle.T))
        return ROUNDING * 4.0 * slips * float(exact.cycle.t_slip)
    return ROUNDING * (8.0 + 2.5 * math.log1p(float(exact.p.lambda_))) * past


def _states(got: Sequence[Mapping[str, Any]], exact: Exact) -> Ratios:
    parts = _sizes(exact)
    worst = dict.fromkeys((*parts, "mode"), 0.0)
    for t, state, sample in zip(exact.times, got, exact.samples, strict=True):
        uncertain = _dating(exact, t)
        # There the mode changes and friction jumps: on which side t lies is not known in doubles.
        at_an_event = any(abs(event.time - t) <= uncertain for event in exact.events)
        if state["mode"] != sample["mode"] and not at_an_event:
            worst["mode"] = math.inf
        for name, (scale, swiftness) in parts.items():
            if name == "F_friction" and at_an_event:
                continue
            error = float(abs(state[name] - sample[name]))
            bound = BOUND * scale + uncertain * swiftness
            worst[name] = max(worst[name], error / bound if error else 0.0)
    return worst


def _sizes(exact: Exact) -> dict[str, tuple[float, float]]:
    p = exact.p

    def largest(*names: str) -> float:
        return max(float(abs(sum(sample[n] for n in names))) for sample in exact.samples)

    F_s, k, v, speed = float(p.F_s), float(p.k), float(p.v), largest("x_dot")
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
