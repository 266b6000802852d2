"""Judgement of the invariants: residuals, other runs, agreement, observed orders, probes."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from stickslip_verification.drive import convergence
from stickslip_verification.drive.answer import Answer
from stickslip_verification.drive.exact import Exact
from stickslip_verification.judge.checks import (
    CheckError,
    Contract,
    LackingError,
    errors,
    extract,
    last_worst,
    without_value,
)
from stickslip_verification.judge.metrics import METRICS, Course, MissingOutputError, Residual
from stickslip_verification.model.run import Run
from stickslip_verification.model.verdict import CheckResult, Measure, ObservedOrder
from stickslip_verification.suite.cases import Case, Check
from stickslip_verification.suite.invariants import (
    Agreement,
    Invariant,
    Order,
    Probe,
    ResidualInvariant,
)


def applies(invariant: ResidualInvariant, case: Case, exact: Exact) -> bool:
    """Whether the exact motion has a place that the invariant is about."""
    return bool(np.any(_residual(invariant, case, exact, exact.record).where))


def judge_residual(
    invariant: ResidualInvariant, case: Case, contract: Contract, exact: Exact, record: Run
) -> CheckResult:
    """Judge what an invariant leaves over in one side's run of a case.

    A run in which the invariant finds no place although the exact motion has one is a failure.
    """
    empty = replace(
        blank(invariant, case.id, contract),
        quantity=invariant.quantity,
        measure=Measure.OF_SCALE,
        tolerance=invariant.tolerance[contract.column],
        because=invariant.because[contract.column],
        expected=0.0,
    )
    try:
        residual = _residual(invariant, case, exact, record)
        found = residual.errors
    except MissingOutputError as error:
        return without_value(empty, contract, LackingError(f"no output {error}"))
    except (ValueError, IndexError) as error:
        return replace(empty, failure=f"the samples do not fit together: {error}")
    empty = replace(empty, unit=residual.unit)
    where = np.flatnonzero(residual.where)
    if not len(where):
        return replace(empty, failure="the run has no such place; the exact motion has")
    broken = np.flatnonzero(~np.isfinite(found))
    if len(broken):
        place = int(where[broken[0]])
        left, time = float(residual.values[place]), float(record.times[place])
        nothing = ", where the exact motion has nothing" if math.isfinite(left) else ""
        return replace(empty, failure=f"it is {left!r} at t = {time:.6g} s{nothing}")
    worst = last_worst(found)
    return replace(
        empty,
        got=float(residual.values[where[worst]]),
        error=float(found[worst]),
        passed=bool(found[worst] <= empty.tolerance),
    )


def agreeing(invariant: Agreement, case: Case) -> Check | None:
    """Find the check of a case whose tolerances say how far FMU and reference may differ."""
    for check in case.checks:
        everywhere = check.at.kind == "every_point" and check.truth.formula is None
        if check.quantity == invariant.quantity and everywhere:
            return check
    return None


def judge_agreement(
    invariant: Agreement,
    case: Case,
    check: Check,
    contract: Contract,
    exact: Answer[Exact],
    records: Mapping[str, Answer[Run]],
) -> CheckResult:
    """Hold the FMU against the reference, within what `check` of the case allows both."""
    empty = replace(
        blank(invariant, case.id, contract),
        side="both",
        quantity=invariant.quantity,
        unit=check.unit,
        measure=check.measure,
        tolerance=check.tolerance[contract.column] + check.tolerance["reference"],
        because=(
            "the sum of what the case allows each of them: "
            f"{check.because[contract.column]}; {check.because['reference']}"
        ),
    )
    fmu, reference = records["fmu"], records["reference"]
    for answer in (fmu, reference, exact):
        if answer.value is None:
            return replace(empty, not_applicable=answer.not_applicable or "one of the runs failed")
    assert fmu.value is not None
    assert reference.value is not None
    assert exact.value is not None
    start = exact.value.start
    try:
        expected = extract(invariant.quantity, reference.value, start)
        got = extract(invariant.quantity, fmu.value, start)
    except CheckError as error:
        return without_value(empty, contract, error)
    scale = float(np.max(np.abs(extract(invariant.quantity, exact.value.record, start))))
    found = errors(check.measure, got, expected, scale)
    if not np.all(np.isfinite(found)):
        return replace(empty, failure=f"{invariant.quantity} is no finite number on one side")
    worst = last_worst(found)
    return replace(
        empty,
        expected=float(expected[worst]),
        got=float(got[worst]),
        error=float(found[worst]),
        passed=bool(found[worst] <= empty.tolerance),
    )


def judge_order(
    invariant: Order, case: str, contract: Contract, seen: Answer[ObservedOrder]
) -> Iterator[CheckResult]:
    """Judge an observed order, and whether it was observed in the asymptotic range."""
    empty = replace(
        blank(invariant, case, contract), quantity=f"order in {invariant.quantity}", unit="1"
    )
    rows = (
        ("", invariant.order, invariant.tolerance, invariant.because["order"]),
        ("-asymptotic", 0.0, invariant.halves, invariant.because["halves"]),
    )
    for suffix, expected, tolerance, because in rows:
        row = replace(
            empty,
            check=invariant.id + suffix,
            quantity=empty.quantity + (", coarser less finer half" if suffix else ""),
            expected=expected,
            tolerance=tolerance,
            because=because,
        )
        if seen.value is None:
            yield replace(row, failure=seen.failure)
            continue
        order = seen.value
        got = (
            convergence.halves(order)
            if suffix
            else convergence.slope(list(order.tolerances), list(order.errors))
        )
        if not np.isfinite(got):
            yield replace(row, failure="an error is zero or no finite number")
            continue
        error = abs(got - expected)
        yield replace(
            row,
            got=got,
            error=error,
            passed=error <= tolerance,
        )


def judge_probe(invariant: Probe, contract: Contract, answer: Answer[list[str]]) -> CheckResult:
    """Judge the complaints of a probe."""
    empty = replace(
        blank(invariant, "", contract),
        quantity="complaints",
        unit="1",
        tolerance=0.0,
        because="the interface is kept or it is not",
        expected=0.0,
    )
    if answer.value is None:
        return replace(empty, failure=answer.failure, not_applicable=answer.not_applicable)
    count = float(len(answer.value))
    return replace(
        empty,
        got=count,
        error=count,
        passed=count == 0.0,
        failure="; ".join(answer.value) or None,
    )


def blank(invariant: Invariant, case: str, contract: Contract) -> CheckResult:
    """Return the result of an invariant before anything was compared."""
    return CheckResult(
        case=case,
        check=invariant.id,
        quantity="",
        unit="1",
        truth=invariant.kind,
        side=contract.side,
        expected=None,
        got=None,
        error=None,
        tolerance=0.0,
        because="",
        passed=False,
        klass=invariant.klass,
        decides=contract.decides(invariant.klass),
    )


def _residual(invariant: ResidualInvariant, case: Case, exact: Exact, record: Run) -> Residual:
    with np.errstate(all="ignore"):
        return METRICS[invariant.metric](
            Course(case, record, exact.record, np.array(exact.event_times))
        )
