"""The run: the truth once per case, both sides, every check."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from stickslip_verification import provenance, truth
from stickslip_verification.cases import Case
from stickslip_verification.checks import Exact, failed, judge
from stickslip_verification.quantities import OUTPUT_NAMES
from stickslip_verification.record import Record
from stickslip_verification.sides import FmuSide, ReferenceSide, Side
from stickslip_verification.truth.parameters import complete
from stickslip_verification.verdict import CheckResult, Verdict

Progress = Callable[[str, int, int], None]
"""Called with what is being done, how much of it is done, and out of how much."""


def verify(fmu: Path, cases: Sequence[Case], progress: Progress | None = None) -> Verdict:
    """Judge an FMU and the reference on the cases.

    What a side does wrong, an exception included, is a failed check. Before each case `progress`
    is called with its id, the number of cases done and their number, and once at the end.

    Raises
    ------
    FmuError
        The file does not exist or is not an FMU that can be driven at all.
    """
    sides: tuple[Side, ...] = (FmuSide(fmu), ReferenceSide())
    results: list[CheckResult] = []
    for done, case in enumerate(cases):
        if progress is not None:
            progress(case.id, done, len(cases))
        results += judge_case(case, sides)
    if progress is not None:
        progress("", len(cases), len(cases))
    return Verdict(results, provenance.collect(fmu))


def judge_case(case: Case, sides: Sequence[Side]) -> list[CheckResult]:
    """Give the result of every check of one case on every side, check by check."""
    try:
        exact = exact_motion(case)
    except Exception as error:
        reason = f"the truth cannot be computed: {_reason(error)}"
        return [
            failed(case.id, check, side.name, reason) for check in case.checks for side in sides
        ]
    judged = [list(_judge_side(case, side, exact)) for side in sides]
    return [result for row in zip(*judged, strict=True) for result in row]


def exact_motion(case: Case) -> Exact:
    """Compute the exact motion of a case in high precision, rounded to double once."""
    steps = [truth.Step(step.h, dict(step.changes)) for step in case.steps]
    run = truth.run(case.parameters, steps)
    outputs = {
        name: np.array([float(sample[name]) for sample in run.samples]) for name in OUTPUT_NAMES
    }
    return Exact(
        record=Record(
            times=np.array(case.times),
            outputs=outputs,
            initial={name: float(run.initial[name]) for name in OUTPUT_NAMES},
        ),
        start=complete(case.parameters),
        event_times=[float(event.time) for event in run.events],
    )


def _judge_side(case: Case, side: Side, exact: Exact) -> Iterator[CheckResult]:
    try:
        record = side.run(case)
    except Exception as error:
        for check in case.checks:
            yield failed(case.id, check, side.name, _reason(error))
    else:
        for check in case.checks:
            yield judge(case.id, check, side.name, exact, record)


def _reason(error: Exception) -> str:
    return f"{type(error).__name__}: {' '.join(str(error).split())}"
