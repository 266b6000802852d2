"""How far what an importer recorded is from the exact solution, at the importer's own times."""

from __future__ import annotations

import math
from functools import cache
from itertools import pairwise

from stickslip_verification.truth import Run, Step
from stickslip_verification.truth import run as exact_run
from tests.importers.cases import CASES, Case
from tests.importers.running import Rows

_RELATIVE = ("t_stick", "t_slip", "T", "f", "mu_k_used")
EXACT = ("mode", "sticking", "n_slips")
"""Outputs that must not differ at all."""


def deviations(case: Case, rows: Rows) -> dict[str, float]:
    """Return the largest deviation of every output over the communication points.

    Lengths as parts of 2 Delta, forces of F_s, speeds of the peak velocity of a slip, energies of
    F_s 2 Delta, t_event of the shortest slip; all at the start values of the case. Durations, f
    and mu_k_used relative to what is exact. Of mode, sticking and n_slips the largest difference.
    """
    return _compared(case, rows, _exact(case.name, rows.times))


def nested_deviations(case: Case, rows: Rows) -> dict[str, float]:
    """Return the deviations of the second of two blocks, which the first one's F pushes.

    Over a step it is pushed by what the first showed at the end of the step before. What was
    recorded of the first is what the second was given, so it is exact here.
    """
    assert rows.nested is not None
    assert rows.nested.outputs["x"] != rows.outputs["x"]
    forces = [float(force) for force in rows.outputs["F"]]
    # The spring is relaxed at the start, which not every importer shows.
    pushed = tuple(forces if rows.times[0] == 0.0 else [0.0, *forces])
    return _compared(case, rows.nested, _exact(case.name, rows.times, pushed))


def _compared(case: Case, rows: Rows, exact: Run) -> dict[str, float]:
    samples = [exact.initial, *exact.samples][-len(rows.times) :]
    assert len(rows.times) in (case.steps, case.steps + 1)
    assert set(rows.outputs) == set(exact.initial), "an output is missing"
    scales, found = _scales(case), {}
    for name, recorded in rows.outputs.items():
        errors = []
        for got, sample in zip(recorded, samples, strict=True):
            expected = float(sample[name])
            scale = abs(expected) if name in _RELATIVE and expected else scales.get(name, 1.0)
            errors.append(abs(float(got) - expected) / scale)
        found[name] = max(errors)
    return found


@cache
def _exact(name: str, times: tuple[float, ...], pushed: tuple[float, ...] | None = None) -> Run:
    """Return the exact course of a case at these times, with F_ext from step to step if given."""
    case = CASES[name]
    # Some importers show the state at the start, some begin with the end of the first step.
    points = times if times[0] == 0.0 else (0.0, *times)
    steps = []
    for number, (begin, end) in enumerate(pairwise(points)):
        changes = dict(case.changes.get(number, {}))
        if pushed is not None:
            changes["F_ext"] = pushed[number]
        steps.append(Step(end - begin, changes))
    run = exact_run(case.start, steps, digits=30)
    # The importers' times differ by some 1e-13 s: rounding must not put an event on the other side
    # of a communication point. An event that a change causes stands at the point itself.
    assert run.margin > 1e-6
    for event in run.events:
        nearest = min(abs(float(event.time) - float(point)) for point in (0.0, *run.times))
        assert nearest == 0.0 or nearest > 1e-7, f"an event {nearest} s from a sample"
    return run


def _scales(case: Case) -> dict[str, float]:
    """Return what the deviation of an output is a part of, by name."""
    values = {"mu_s": 0.5, "mu_k": 0.3, "v": 0.02} | dict(case.start)
    m, g, k, v = 1.0, 9.81, 1000.0, values["v"]
    F_s, Delta = values["mu_s"] * m * g, (values["mu_s"] - values["mu_k"]) * m * g / k
    w = math.sqrt(k / m)
    return {
        **dict.fromkeys(("x", "x_pull", "z", "delta_x", "spring_drop"), 2.0 * Delta),
        **dict.fromkeys(("F", "F_friction", "F_s"), F_s),
        **dict.fromkeys(("x_dot", "x_dot_peak"), v * (1.0 + math.hypot(1.0, w * Delta / v))),
        **dict.fromkeys(("W_pull", "W_k", "Q_friction"), F_s * 2.0 * Delta),
        "t_event": math.pi / w,
    }
