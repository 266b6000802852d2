"""Pure functions that judge one check: where it looks, what it compares, by what measure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from stickslip_verification.cases import At, Check
from stickslip_verification.formulas import FORMULAS
from stickslip_verification.quantities import QUANTITIES
from stickslip_verification.record import Record, Series
from stickslip_verification.verdict import CheckResult


@dataclass(frozen=True)
class Exact:
    """The exact motion of a case.

    Attributes
    ----------
    record
        Its samples, rounded to double once.
    start
        Every value at the start, the defaults included (SI).
    event_times
        Times of its transitions [s].
    """

    record: Record
    start: Mapping[str, float]
    event_times: Sequence[float]


class CheckError(ValueError):
    """A check cannot be evaluated; the message says what is not there."""


def places(at: At, exact: Exact) -> list[int]:
    """Find the communication points that a check looks at, as indices, on the exact motion.

    Raises
    ------
    CheckError
        The exact motion has no communication point in the wanted stick or after the wanted event.
    """
    record = exact.record
    count = len(record.times)
    if at.kind == "end":
        return [count - 1]
    if at.kind == "every_point":
        return list(range(count))
    if at.kind == "cycle":
        in_stick = (record.outputs["n_slips"] == at.number) & (record.outputs["mode"] == 0)
        found = np.flatnonzero(in_stick)
        if not len(found):
            raise CheckError(f"no communication point in the stick after slip {at.number}")
        return [int(found[0])]
    events = exact.event_times
    if at.number > len(events):
        raise CheckError(f"the motion has {len(events)} events, not {at.number}")
    after = int(np.searchsorted(record.times, events[at.number - 1], side="left"))
    if after >= count or (at.number < len(events) and events[at.number] <= record.times[after]):
        raise CheckError(f"no communication point between events {at.number} and {at.number + 1}")
    return [after]


def extract(quantity: str, record: Record, start: Mapping[str, float]) -> Series:
    """Give the samples of a quantity at all communication points, in its unit.

    Raises
    ------
    CheckError
        The record lacks an output that the quantity needs, or has the wrong number of samples.
    """
    needs = QUANTITIES[quantity].needs
    missing = [name for name in needs if name not in record.outputs]
    if missing:
        raise CheckError(f"no output {', '.join(missing)}")
    for name in needs:
        count = record.outputs[name].size
        if count != record.times.size:
            raise CheckError(f"{count} samples of {name} at {record.times.size} points")
    return QUANTITIES[quantity].compute(record.outputs, start)


def errors(measure: str, got: Series, expected: Series, scale: float) -> Series:
    """Error at each place by the measure; NaN where a value is NaN, infinity for x/0 with x != 0.

    Parameters
    ----------
    measure
        relative (divides by ``|expected|``), of_scale (divides by `scale`) or absolute.
    scale
        Largest magnitude of the quantity in the exact motion, in its unit.
    """
    difference = np.abs(got - expected)
    if measure == "absolute":
        return difference
    size = np.abs(expected) if measure == "relative" else np.full_like(difference, scale)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(difference == 0.0, 0.0, difference / size)


def judge(case: str, check: Check, side: str, exact: Exact, record: Record) -> CheckResult:
    """Compare one side's record with the truth of one check.

    Never raises for what a side did: a missing output, a NaN or an infinity is a failed check
    with its reason.
    """
    try:
        chosen = places(check.at, exact)
        truth_samples = extract(check.quantity, exact.record, exact.start)
        expected = _expected(check, exact, truth_samples, chosen)
        scale = float(np.max(np.abs(truth_samples)))
    except Exception as error:
        return failed(case, check, side, f"the truth cannot be computed: {error}")
    if not np.all(np.isfinite(expected)):
        return failed(case, check, side, "the truth is not a finite number here")
    try:
        got = extract(check.quantity, record, exact.start)[chosen]
    except (CheckError, IndexError) as error:
        return failed(case, check, side, str(error), float(expected[-1]))
    found = errors(check.measure, got, expected, scale)
    broken = np.flatnonzero(~np.isfinite(got) | ~np.isfinite(found))
    if len(broken):
        first = int(broken[0])
        time = float(exact.record.times[chosen[first]])
        reason = f"{check.quantity} is {got[first]} at t = {time:.6g} s"
        return failed(case, check, side, reason, float(expected[first]))
    # Of places that are equally bad, most of all when none is, the last tells most.
    worst = len(found) - 1 - int(np.argmax(found[::-1]))
    return CheckResult(
        case=case,
        check=check.id,
        quantity=check.quantity,
        unit=check.unit,
        truth=check.truth.kind,
        side=side,
        expected=float(expected[worst]),
        got=float(got[worst]),
        error=float(found[worst]),
        tolerance=check.tolerance[side],
        because=check.because[side],
        passed=bool(found[worst] <= check.tolerance[side]),
    )


def failed(
    case: str, check: Check, side: str, reason: str, expected: float | None = None
) -> CheckResult:
    """Give the result of a check where there is nothing to compare, and why."""
    return CheckResult(
        case=case,
        check=check.id,
        quantity=check.quantity,
        unit=check.unit,
        truth=check.truth.kind,
        side=side,
        expected=expected,
        got=None,
        error=None,
        tolerance=check.tolerance[side],
        because=check.because[side],
        passed=False,
        failure=reason,
    )


def _expected(check: Check, exact: Exact, truth_samples: Series, chosen: Sequence[int]) -> Series:
    if check.truth.formula is None:
        return truth_samples[list(chosen)]
    value = FORMULAS[check.truth.formula].evaluate(exact.start)
    return np.full(len(chosen), float(value))
