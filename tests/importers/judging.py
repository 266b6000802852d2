"""How far what an importer recorded is from the exact solution, at the importer's own times."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from itertools import pairwise

from stickslip_verification.truth import Run, Step
from stickslip_verification.truth import run as exact_run
from tests.importers.cases import CASES, Case
from tests.importers.running import Rows

_DIGITS = 30
"""Of the exact solution: twice those of a double."""

_LENGTHS = ("x", "x_pull", "z", "delta_x", "spring_drop")
_FORCES = ("F", "F_friction", "F_s")
_SPEEDS = ("x_dot", "x_dot_peak")
_ENERGIES = ("W_pull", "W_k", "Q_friction")
_RELATIVE = ("t_stick", "t_slip", "T", "f", "mu_k_used")
EXACT = ("mode", "sticking", "n_slips")
"""Outputs that must not differ at all."""


def deviations(case: Case, rows: Rows) -> dict[str, float]:
    """Return the largest deviation of every output over the communication points.

    Lengths as parts of 2 Delta, forces of F_s, speeds of the peak velocity of a slip, energies of
    F_s 2 Delta, t_event of the shortest slip; all at the start values of the case. Durations, f
    and mu_k_used relative to what is exact. Of mode, sticking and n_slips the largest difference.
    """
    return _compared(rows, _exact(case.name, rows.times), _scales(case))


def nested_deviations(case: Case, rows: Rows) -> dict[str, float]:
    """Return the deviations of the second of two blocks, which the first one's F pushes.

    Over a step it is pushed by what the first showed at the end of the step before. What was
    recorded of the first is what the second was given, so it is exact here.
    """
    assert rows.nested is not None
    forces = [float(force) for force in rows.outputs["F"]]
    # The spring is relaxed at the start, which not every importer shows.
    pushed = tuple(forces if rows.times[0] == 0.0 else [0.0, *forces])
    return _compared(rows.nested, _exact(case.name, rows.times, pushed), _scales(case))


def _compared(rows: Rows, exact: Run, scales: Mapping[str, float]) -> dict[str, float]:
    samples = [exact.initial, *exact.samples][-len(rows.times) :]
    assert set(rows.outputs) == set(exact.initial), "an output is missing"
    found = {}
    for name, recorded in rows.outputs.items():
        assert len(recorded) == len(samples), f"{name}: {len(recorded)} samples"
        errors = []
        for got, sample in zip(recorded, samples, strict=True):
            expected = float(sample[name])
            error = abs(float(got) - expected)
            if name in _RELATIVE and expected:
                error /= abs(expected)
            errors.append(error / scales.get(name, 1.0))
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
    run = exact_run(case.start, steps, digits=_DIGITS, law=case.law)
    _well_posed(run)
    return run


def _well_posed(run: Run) -> None:
    """Raise if rounding could put an event on the other side of a communication point.

    The importers' times differ by some 1e-13 s, their inputs not at all. An event that a change
    causes stands at its communication point itself, whatever the rounding.
    """
    assert run.margin > 1e-6
    points = [0.0, *map(float, run.times)]
    for event in run.events:
        nearest = min(abs(float(event.time) - point) for point in points)
        assert nearest == 0.0 or nearest > 1e-7, f"an event {nearest} s from a sample"


def _scales(case: Case) -> dict[str, float]:
    """Return what the deviation of an output is a part of, by name."""
    parameters = {"m": 1.0, "g": 9.81, "k": 1000.0, "mu_s": 0.5, "mu_k": 0.3, "v": 0.02}
    parameters |= case.start
    m, k, v = (parameters[name] for name in ("m", "k", "v"))
    weight = m * parameters["g"]
    F_s = parameters["mu_s"] * weight
    Delta = (parameters["mu_s"] - parameters["mu_k"]) * weight / k
    w = (k / m) ** 0.5
    peak = v * (1.0 + (1.0 + (w * Delta / v) ** 2) ** 0.5)
    return {
        **dict.fromkeys(_LENGTHS, 2.0 * Delta),
        **dict.fromkeys(_FORCES, F_s),
        **dict.fromkeys(_SPEEDS, peak),
        **dict.fromkeys(_ENERGIES, F_s * 2.0 * Delta),
        "t_event": 3.141592653589793 / w,
    }
