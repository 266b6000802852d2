"""Pure functions that judge other runs of an FMU: whether they gave the motion of the plain one."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from stickslip_verification.drive.answer import Answer
from stickslip_verification.drive.exact import Exact
from stickslip_verification.judge.band import Band
from stickslip_verification.judge.checks import Contract, errors, last_worst
from stickslip_verification.judge.invariant_checks import blank
from stickslip_verification.judge.metrics import Course
from stickslip_verification.judge.metrics.course import Mask
from stickslip_verification.model.quantities import OUTPUT_NAMES, QUANTITIES
from stickslip_verification.model.run import Run, Series
from stickslip_verification.model.verdict import CheckResult, Measure
from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.invariants import RunInvariant

ROUNDED = 1e-11
"""Rounding of a run, as a part of the largest value, where forces or times are scaled."""


def judge_run(
    invariant: RunInvariant,
    case: Case,
    contract: Contract,
    exact: Exact,
    plain: Run,
    other: Answer[Run],
) -> CheckResult:
    """Judge whether another run of the FMU gave the motion of the plain one, the start included."""
    empty = replace(
        blank(invariant, case.id, contract),
        quantity="every output",
        unit="1",
        measure=Measure.ABSOLUTE if invariant.tolerance is None else Measure.OF_SCALE,
        tolerance=invariant.tolerance or 0.0,
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
    return _same_motion(empty, first, second, scales)


def same_run(empty: CheckResult, plain: Run, other: Run, band: Band) -> CheckResult:
    """Judge whether another run of a numerical solution equals the plain one, but for rounding.

    ``other`` may hold some of the points and outputs only.
    """
    read = np.flatnonzero(np.isin(plain.times, other.times))
    empty = replace(empty, tolerance=ROUNDED, because="it is the same run but for rounding")
    if read.size != other.times.size or not set(other.outputs) <= set(plain.outputs):
        return replace(empty, failure="the runs have other outputs, or other points")
    judged = {name: band.judged(name)[read] for name in other.outputs}
    names = [name for name, where in judged.items() if where.any()]
    first = {name: plain.outputs[name][read][judged[name]] for name in names}
    second = {name: other.outputs[name][judged[name]] for name in names}
    scales = {name: band.largest(name) or 1.0 for name in first}
    return _same_motion(replace(empty, measure=Measure.OF_SCALE), first, second, scales)


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
    )


def _same_motion(
    empty: CheckResult,
    plain: Mapping[str, Series],
    other: Mapping[str, Series],
    scales: Mapping[str, float],
) -> CheckResult:
    worst, largest = replace(empty, error=0.0), -1.0
    for name, expected in plain.items():
        got, quantity = other[name], QUANTITIES[name]
        measure = Measure.ABSOLUTE if quantity.discrete else Measure.OF_SCALE
        found = errors(measure, got, expected, scales[name])
        if not np.all(np.isfinite(found)):
            reason = f"{name} is no finite number in one of them"
            return replace(empty, quantity=name, failure=reason)
        place = last_worst(found)
        if found[place] > largest:
            largest = float(found[place])
            worst = replace(
                worst,
                quantity=name,
                unit=quantity.unit,
                expected=float(expected[place]),
                got=float(got[place]),
                error=float(found[place]),
            )
    return replace(worst, passed=largest <= empty.tolerance)


def _equal(a: Series, b: Series) -> Mask:
    return np.asarray((a == b) | (np.isnan(a) & np.isnan(b)))
