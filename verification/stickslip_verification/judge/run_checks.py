"""Pure functions that judge other runs of an FMU: whether they gave the motion of the plain one."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from stickslip_verification.drive.answer import Answer
from stickslip_verification.drive.exact import Exact
from stickslip_verification.judge.checks import Contract, errors, last_worst
from stickslip_verification.judge.invariant_checks import blank
from stickslip_verification.judge.metrics import Course
from stickslip_verification.judge.metrics.course import Mask
from stickslip_verification.model.quantities import OUTPUT_NAMES, QUANTITIES
from stickslip_verification.model.run import Run, Series
from stickslip_verification.model.verdict import CheckResult, Measure, Measured
from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.invariants import RunInvariant

SPLIT_GRAIN = 0.5
"""What rounding between machines moves of the distance of two runs, as a part of its tolerance: it
is itself rounding, gathered over a whole run."""


def judge_run(
    invariant: RunInvariant,
    case: Case,
    contract: Contract,
    exact: Exact,
    plain: Run,
    other: Answer[Run],
) -> CheckResult:
    """Judge whether another run of the FMU gave the motion of the plain one, the start included.

    A numerical solution need not repeat a quantity better than the case asks it to know it.
    """
    column = "fmu" if contract.exact else "numerical"
    empty = replace(
        blank(invariant, case.id, contract),
        quantity="every output",
        unit="1",
        measure=Measure.ABSOLUTE if invariant.tolerance is None else Measure.OF_SCALE,
        tolerance=0.0 if invariant.tolerance is None else invariant.tolerance[column],
        because=invariant.because,
    )
    if other.value is None:
        return replace(empty, failure=other.failure, not_applicable=other.not_applicable)
    first, second = _with_start(plain), _with_start(other.value)
    if {n: s.shape for n, s in first.items()} != {n: s.shape for n, s in second.items()}:
        return replace(empty, failure="the runs have other outputs, or other numbers of samples")
    if invariant.tolerance is None:
        return _same_bits(empty, first, second)
    course = Course(case, plain, exact.record, np.array(exact.event_times))
    scales = {name: course.scale_of(name) for name in first}
    allowed = dict.fromkeys(first, empty.tolerance)
    if not contract.exact:
        for check in case.checks:
            if check.quantity in allowed:
                known = check.tolerance[contract.column]
                allowed[check.quantity] = max(allowed[check.quantity], known)
    return _same_motion(empty, first, second, scales, allowed)


def _with_start(record: Run) -> dict[str, Series]:
    """Return the samples of each output, that after initialization first."""
    return {
        name: np.concatenate(([record.initial[name]], record.outputs[name]))
        for name in OUTPUT_NAMES
        if name in record.outputs
    }


def _same_bits(
    empty: CheckResult, plain: Mapping[str, Series], other: Mapping[str, Series]
) -> CheckResult:
    differing = {name: int(np.sum(~_equal(plain[name], other[name]))) for name in plain}
    total = float(sum(differing.values()))
    first = next((name for name in plain if differing[name]), None)
    return replace(
        empty,
        quantity="values that differ" + (f", {first} first" if first else ""),
        expected=0.0,
        got=total,
        error=total,
        passed=total == 0.0,
        measured=Measured(total, 1.0, 0.0),
    )


def _same_motion(
    empty: CheckResult,
    plain: Mapping[str, Series],
    other: Mapping[str, Series],
    scales: Mapping[str, float],
    allowed: Mapping[str, float],
) -> CheckResult:
    worst, nearest = replace(empty, error=0.0), -1.0
    for name, expected in plain.items():
        got, quantity = other[name], QUANTITIES[name]
        measure = Measure.ABSOLUTE if quantity.discrete else Measure.OF_SCALE
        found = errors(measure, got, expected, scales[name])
        if not np.all(np.isfinite(found)):
            reason = f"{name} is no finite number in one of them"
            return replace(empty, quantity=name, failure=reason)
        place = last_worst(found)
        if found[place] > nearest * allowed[name]:
            nearest = float(found[place]) / allowed[name]
            worst = replace(
                worst,
                tolerance=allowed[name],
                quantity=name,
                unit=quantity.unit,
                expected=float(expected[place]),
                got=float(got[place]),
                error=float(found[place]),
            )
    return replace(
        worst,
        passed=nearest <= 1.0,
        measured=Measured(worst.error or 0.0, 1.0, SPLIT_GRAIN * empty.tolerance),
    )


def _equal(a: Series, b: Series) -> Mask:
    return np.asarray((a == b) | (np.isnan(a) & np.isnan(b)))
