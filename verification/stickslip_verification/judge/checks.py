"""Judgement of one check of a case: its places in the run, its values and their error.

`Contract` says which tolerances a side is held to, and which classes of checks decide its verdict.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from stickslip_verification.drive.exact import Exact
from stickslip_verification.judge.band import Band
from stickslip_verification.model.formulas import FORMULAS
from stickslip_verification.model.quantities import QUANTITIES
from stickslip_verification.model.run import Run, Series
from stickslip_verification.model.verdict import CheckResult, Klass, Measure
from stickslip_verification.suite.cases import At, Case, Check


@dataclass(frozen=True)
class Contract:
    """How a side is judged.

    Attributes
    ----------
    side
        fmu or reference.
    interface
        Whether it promises the interface, so that its own start values are tried, and a missing
        output is a failure and not a feature that it lacks.
    exact
        Whether it is held to the tolerances of the exact block, or to those of a numerical
        solution.
    contract
        Whether contract checks decide.
    """

    side: str
    interface: bool = True
    exact: bool = True
    contract: bool = True

    @property
    def column(self) -> str:
        """Whose tolerance it is held to: fmu or reference."""
        return "fmu" if self.exact else "reference"

    def decides(self, klass: str) -> bool:
        """Whether a failure in a check of this class fails the verdict."""
        return klass == Klass.PHYSICS or self.contract

    @property
    def numerical(self) -> bool:
        """Whether an FMU is judged as a numerical solution, see `run.numerical`."""
        return self.side == "fmu" and not self.exact


EXACT_CONTRACT = Contract("fmu")
REFERENCE_CONTRACT = Contract("reference", exact=False)
PHYSICS_CONTRACT = Contract("fmu", interface=False, exact=False, contract=False)
STRICT_CONTRACT = Contract("fmu", interface=False)


class CheckError(ValueError):
    """A check cannot be evaluated; the message says what is not there."""


class LackingError(CheckError):
    """A side does not have an output that a check needs."""


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


def extract(quantity: str, record: Run, start: Mapping[str, float]) -> Series:
    """Return the samples of a quantity at all communication points, in its unit.

    Raises
    ------
    LackingError
        The record lacks an output that the quantity needs.
    CheckError
        It has the wrong number of samples.
    """
    needs = QUANTITIES[quantity].needs
    missing = [name for name in needs if name not in record.outputs]
    if missing:
        raise LackingError(f"no output {', '.join(missing)}")
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
    if measure == Measure.ABSOLUTE:
        return difference
    size = np.abs(expected) if measure == Measure.RELATIVE else np.full_like(difference, scale)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(difference == 0.0, 0.0, difference / size)


def judge(
    case: Case,
    check: Check,
    contract: Contract,
    exact: Exact,
    record: Run,
    band: Band | None = None,
) -> CheckResult:
    """Compare one side's record with the truth of one check, given a `band` within that band.

    Never raises for what a side did: a missing output, a NaN or an infinity is a failed check
    with its reason. An output that a foreign FMU does not have makes the check not applicable.
    """
    empty = blank(case, check, contract)
    try:
        chosen = places(check.at, exact)
        truth_samples = extract(check.quantity, exact.record, exact.start)
        expected = _expected(check, exact, truth_samples, chosen)
        scale = float(np.max(np.abs(truth_samples)))
    except Exception as error:
        return replace(empty, failure=f"the truth cannot be computed: {error}")
    if not np.all(np.isfinite(expected)):
        return replace(empty, failure="the truth is not a finite number here")
    try:
        got = extract(check.quantity, record, exact.start)[chosen]
    except (CheckError, IndexError) as error:
        return without_value(empty, contract, error, float(expected[-1]))
    found = errors(check.measure, got, expected, scale)
    broken = np.flatnonzero(~np.isfinite(got) | ~np.isfinite(found))
    if len(broken):
        first = int(broken[0])
        time = float(exact.record.times[chosen[first]])
        reason = f"{check.quantity} is {got[first]} at t = {time:.6g} s"
        return replace(empty, failure=reason, expected=float(expected[first]))
    worst = last_worst(found)
    return replace(
        empty,
        expected=float(expected[worst]),
        got=float(got[worst]),
        error=float(found[worst]),
        passed=bool(found[worst] <= empty.tolerance),
    )


def judge_in_band(
    empty: CheckResult,
    quantities: Sequence[str],
    contract: Contract,
    band: Band,
    record: Run,
) -> CheckResult:
    """Judge whether quantities of a run stay in a band; the result shows the worst of them.

    ``record`` may hold some of the points of the exact motion only. What the run lacks is not
    judged; the result is not applicable where nothing is left.
    """
    because = "the bound for any input sequence, of the largest value of its kind"
    empty = replace(empty, measure=Measure.ABSOLUTE, because=because)
    try:
        read = _places_of(record, band.exact.record)
    except CheckError as error:
        return replace(empty, failure=str(error))
    worst, nearest, lacking = None, -1.0, []
    for quantity in quantities:
        try:
            extract(quantity, record, band.exact.start)
        except LackingError as error:
            lacking.append(error)
            continue
        except CheckError as error:
            return replace(empty, failure=str(error))
        expected, got = band.pair(quantity, record, read)
        where = band.judged(quantity)[read] & np.isfinite(expected)
        broken = np.flatnonzero(where & ~np.isfinite(got))
        if len(broken):
            time = float(record.times[broken[0]])
            return replace(empty, failure=f"{quantity} is {got[broken[0]]} at t = {time:.6g} s")
        if not where.any():
            continue
        allowed = band.allowed(quantity)[read][where]
        found = np.abs(got[where] - expected[where])
        with np.errstate(divide="ignore", invalid="ignore"):
            ratios = np.where(found == 0.0, 0.0, found / allowed)
        place = last_worst(ratios)
        if ratios[place] > nearest:
            nearest = float(ratios[place])
            scale = 0.0 if QUANTITIES[quantity].discrete else band.largest(quantity)
            worst = replace(
                empty,
                quantity=quantity,
                unit=QUANTITIES[quantity].unit,
                measure=Measure.OF_SCALE if scale else Measure.ABSOLUTE,
                expected=float(expected[where][place]),
                got=float(got[where][place]),
                error=float(found[place]) / (scale or 1.0),
                tolerance=float(allowed[place]) / (scale or 1.0),
                passed=nearest <= 1.0,
            )
    if worst is not None:
        return worst
    if lacking:
        return without_value(empty, contract, lacking[0])
    return replace(empty, not_applicable="it was only agreed on")


def _places_of(record: Run, exact: Run) -> NDArray[np.intp]:
    """Return where the points of a record are among those of the exact motion."""
    at = np.minimum(np.searchsorted(exact.times, record.times), exact.times.size - 1)
    if not np.array_equal(exact.times[at], record.times) or len(set(at)) < len(at):
        raise CheckError(f"{record.times.size} samples at other points than the case has")
    return at


def last_worst(found: Series) -> int:
    """Return the index of the largest error; of equal errors (all 0, say) the last one."""
    return len(found) - 1 - int(np.argmax(found[::-1]))


def blank(case: Case, check: Check, contract: Contract) -> CheckResult:
    """Return the result of a check of a case before anything was compared."""
    return CheckResult(
        case=case.id,
        check=check.id,
        quantity=check.quantity,
        unit=check.unit,
        truth=check.truth.kind,
        side=contract.side,
        expected=None,
        got=None,
        error=None,
        tolerance=check.tolerance[contract.column],
        because=check.because[contract.column],
        passed=False,
        klass=case.klass,
        measure=check.measure,
        decides=contract.decides(case.klass),
    )


def without_value(
    empty: CheckResult, contract: Contract, error: Exception, expected: float | None = None
) -> CheckResult:
    """Return the result where the side has no value to compare: not applicable, or a failure."""
    if isinstance(error, LackingError) and not contract.interface:
        return replace(empty, not_applicable=f"it has {error}", expected=expected)
    return replace(empty, failure=str(error), expected=expected)


def _expected(check: Check, exact: Exact, truth_samples: Series, chosen: Sequence[int]) -> Series:
    if check.truth.formula is None:
        return truth_samples[list(chosen)]
    value = FORMULAS[check.truth.formula].evaluate(exact.start)
    return np.full(len(chosen), float(value))
