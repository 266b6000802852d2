"""How far what an importer recorded is from the exact solution, at the importer's own times."""

import math
from functools import cache
from itertools import pairwise

from stickslip_verification.truth import Run, Step
from stickslip_verification.truth import run as exact_run
from tests.facts.closed import Exact
from tests.importers.cases import CASES, Case
from tests.importers.running import Rows

EXACT = ("mode", "sticking", "n_slips")
"""Outputs that must not differ at all."""


def deviations(case: Case, rows: Rows, nested: bool = False) -> dict[str, float]:
    """Return the largest deviation of every output, of mode, sticking and n_slips the difference.

    Of the second of two blocks (`nested`), which is pushed over a step by the F that the first
    showed at the end of the step before: what was recorded of that is exact here.
    """
    outputs, pushed = rows["outputs"], None
    times = tuple(rows["times"])
    if nested:
        # The spring is relaxed at the start, which not every importer shows.
        pushed = tuple(outputs["F"] if times[0] == 0.0 else [0.0, *outputs["F"]])
        assert rows["nested"][0]["x"] != outputs["x"]
        [outputs] = rows["nested"]
    exact = _exact(case.name, times, pushed)
    samples = [exact.initial, *exact.samples][-len(times) :]
    assert len(times) in (case.steps, case.steps + 1)
    assert set(outputs) == set(exact.initial), "an output is missing"
    scales = _scales(case)
    return {
        name: max(
            abs(float(got) - float(sample[name]))
            / (scales.get(name) or abs(float(sample[name])) or 1.0)
            for got, sample in zip(recorded, samples, strict=True)
        )
        for name, recorded in outputs.items()
    }


@cache
def _exact(name: str, times: tuple[float, ...], pushed: tuple[float, ...] | None) -> Run:
    case = CASES[name]
    # Some importers show the state at the start, some begin with the end of the first step.
    points = times if times[0] == 0.0 else (0.0, *times)
    steps = []
    for number, (begin, end) in enumerate(pairwise(points)):
        more = {} if pushed is None else {"F_ext": pushed[number]}
        steps.append(Step(end - begin, {**case.changes.get(number, {}), **more}))
    run = exact_run(case.start, steps, digits=30)
    # The importers' times differ by some 1e-13 s: rounding must not put an event on the other side
    # of a communication point. An event that a change causes stands at the point itself.
    assert run.margin > 1e-6
    for event in run.events:
        nearest = min(abs(float(event.time) - float(point)) for point in (0.0, *run.times))
        assert nearest == 0.0 or nearest > 1e-7, f"an event {nearest} s from a sample"
    return run


def _scales(case: Case) -> dict[str, float]:
    p = Exact(case.start)
    length, F_s = float(2 * p.Delta), float(p.F_s)
    return {
        **dict.fromkeys(("x", "x_pull", "z", "delta_x", "spring_drop"), length),
        **dict.fromkeys(("F", "F_friction", "F_s"), F_s),
        **dict.fromkeys(("x_dot", "x_dot_peak"), float(p.v * (1 + math.hypot(1, p.lambda_)))),
        **dict.fromkeys(("W_pull", "W_k", "Q_friction"), F_s * length),
        **dict.fromkeys(EXACT, 1.0),
        "t_event": math.pi / float(p.w),
    }
