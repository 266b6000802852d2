"""Comparisons: of a side with the truth, with an invariant, with another run; each is a result.

None raises for what a side did: a missing output, a NaN or an infinity is a failed check with its
reason. An output that a foreign FMU does not have makes the check not applicable.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Final, Literal

import numpy as np

from ..drive.exact import Exact, slope
from ..drive.instance import FmuFile
from ..drive.processes import Answer
from ..model.quantities import FORMULAS, OUTPUT_NAMES, QUANTITIES
from ..model.verdict import (
    CheckResult,
    ChosenContract,
    Kind,
    Klass,
    Measure,
    ObservedOrder,
    Run,
    Series,
    margin,
)
from ..suite.cases import At, Case, Check
from ..suite.invariants import Agreement, Invariant, Order, Probe, ResidualInvariant, RunInvariant
from ..suite.tolerances import DISTURBED
from .course import Band, CheckError, Course, LackingError, Residual
from .metrics import METRICS

Wanted = Literal["exact", "physics"]


@dataclass(frozen=True)
class Contract:
    """How a side, fmu or reference, is judged.

    ``interface``: it promises the interface, so that its own start values are tried, and a missing
    output is a failure and not a feature that it lacks. ``exact``: it is held to the tolerances of
    the exact block, not to those of a numerical solution. ``contract``: contract checks decide.
    ``solved``: through model exchange, by the suite's solver.
    """

    side: str
    interface: bool = True
    exact: bool = True
    contract: bool = True
    solved: bool = False

    @property
    def column(self) -> str:
        """Whose tolerance it is held to: fmu or reference."""
        return "fmu" if self.exact else "reference"

    @property
    def numerical(self) -> bool:
        """Whether an FMU is judged as a numerical solution, see `run.numerical`."""
        return self.side == "fmu" and not self.exact


EXACT_CONTRACT = Contract("fmu")
REFERENCE_CONTRACT = Contract("reference", exact=False)
PHYSICS_CONTRACT = Contract("fmu", interface=False, exact=False, contract=False)
STRICT_CONTRACT = Contract("fmu", interface=False)

CONTRACTS: Final = {"exact": EXACT_CONTRACT, "physics": PHYSICS_CONTRACT, "strict": STRICT_CONTRACT}
"""How an FMU is judged, by the name of the contract."""


def chosen_contract(
    fmu: FmuFile, wanted: Wanted | None = None, *, strict: bool = False
) -> ChosenContract:
    """Choose the contract of an FMU, and say why.

    With a names file it is held to the physics contract, whatever it promises. `wanted` is what the
    person says; `strict` holds an FMU to the strict contract in place of the physics one.
    """
    named = bool(fmu.names.targets)
    if wanted is not None:
        return ChosenContract(wanted, f"--contract {wanted}")
    if fmu.stated.exact and not named:
        return ChosenContract("exact", fmu.stated.told)
    if strict:
        return ChosenContract("strict", "--strict")
    return ChosenContract("physics", "a names file is given" if named else fmu.stated.told)


ROUNDED = 1e-11
"""Rounding of a run, as a part of the largest value, where forces or times are scaled."""


def of_invariant(
    invariant: Invariant, case: Case | str, contract: Contract, **values: Any
) -> CheckResult:
    """Return the result of an invariant before anything was compared.

    In a case of class contract, not its id alone, every check is of that class.
    """
    klass = invariant.klass
    if isinstance(case, Case):
        klass, case = Klass.CONTRACT if case.klass == Klass.CONTRACT else klass, case.id
    row = CheckResult(
        case=case,
        check=invariant.id,
        truth=invariant.kind,
        side=contract.side,
        klass=klass,
        decides=contract.contract or klass == Klass.PHYSICS,
    )
    return replace(row, **values)


def of_check(case: Case, check: Check, contract: Contract) -> CheckResult:
    """Return the result of a check of a case before anything was compared."""
    return CheckResult(
        case=case.id,
        check=check.id,
        quantity=check.quantity,
        unit=check.unit,
        truth=Kind.CLOSED_FORM,
        side=contract.side,
        tolerance=check.tolerance[contract.column],
        because=check.because[contract.column],
        klass=case.klass,
        measure=check.measure,
        decides=contract.contract or case.klass == Klass.PHYSICS,
    )


def compared(
    empty: CheckResult, expected: float, got: float, error: float, **values: Any
) -> CheckResult:
    """Return the result of a comparison."""
    return replace(
        empty,
        expected=float(expected),
        got=float(got),
        error=float(error),
        passed=bool(error <= empty.tolerance),
        **values,
    )


def without(empty: CheckResult, answer: Answer[Any]) -> CheckResult:
    """Return the result of a check whose run, or probe, gave nothing to judge."""
    why = answer.not_applicable
    return replace(empty, failure=answer.failure, not_applicable=why, late=answer.late)


def _lacking(empty: CheckResult, contract: Contract, error: Exception) -> CheckResult:
    if isinstance(error, LackingError) and not contract.interface:
        return replace(empty, not_applicable=f"it has {error}")
    return replace(empty, failure=str(error))


def _worst(
    empty: CheckResult,
    expected: Series,
    got: Series,
    scale: Series | float,
    times: Series | None = None,
) -> CheckResult:
    """Compare samples by the measure of a check; the result shows the worst one.

    Of equal errors (all 0, say) it is the last one. An error is NaN where a value is NaN, and
    infinite for x/0 with x != 0; it fails, with its time [s] where `times` are passed.
    """
    found = np.abs(got - expected)
    if empty.measure != Measure.ABSOLUTE:
        size = np.abs(expected) if empty.measure == Measure.RELATIVE else scale
        with np.errstate(divide="ignore", invalid="ignore"):
            found = np.where(found == 0.0, 0.0, found / size)
    broken = np.flatnonzero(~np.isfinite(got) | ~np.isfinite(found))
    if broken.size:
        if times is None:
            return replace(empty, failure=f"{empty.quantity} is no finite number on one side")
        first, time = got[broken[0]], times[broken[0]]
        nothing = ", where the exact motion has nothing" if np.isfinite(first) else ""
        reason = f"{empty.quantity} is {first} at t = {time:.6g} s{nothing}"
        return replace(empty, failure=reason, expected=float(expected[broken[0]]))
    place = found.size - 1 - int(np.argmax(found[::-1]))
    return compared(empty, expected[place], got[place], found[place])


def places(at: At, exact: Exact) -> list[int]:
    """Return the indices of the communication points that a check looks at.

    `CheckError` where the exact motion has none in that stick or after that event.
    """
    record = exact.record
    count = len(record.times)
    if at.kind == "end":
        return [count - 1]
    if at.kind == "every_point":
        return list(range(count))
    if at.kind == "cycle":
        in_stick = (record.outputs["n_slips"] == at.number) & (record.outputs["mode"] == 0)
        if not in_stick.any():
            raise CheckError(f"no communication point in the stick after slip {at.number}")
        return [int(np.argmax(in_stick))]
    events = exact.event_times
    if at.number > len(events):
        raise CheckError(f"the motion has {len(events)} events, not {at.number}")
    after = int(np.searchsorted(record.times, events[at.number - 1], side="left"))
    if after >= count or (at.number < len(events) and events[at.number] <= record.times[after]):
        raise CheckError(f"no communication point between events {at.number} and {at.number + 1}")
    return [after]


def extract(quantity: str, record: Run, start: Mapping[str, float]) -> Series:
    """Return the samples of a quantity at all communication points, in its unit.

    `LackingError` where the record lacks an output that the quantity needs, `CheckError` where it
    has the wrong number of samples.
    """
    needs = QUANTITIES[quantity].columns
    missing = [name for name in needs if name not in record.outputs]
    if missing:
        raise LackingError(f"no output {', '.join(missing)}")
    for name in needs:
        if (count := record.outputs[name].size) != record.times.size:
            raise CheckError(f"{count} samples of {name} at {record.times.size} points")
    return QUANTITIES[quantity].compute(record.outputs, start)


def judge(case: Case, check: Check, contract: Contract, exact: Exact, record: Run) -> CheckResult:
    """Compare one side's record with the truth of one check."""
    empty = of_check(case, check, contract)
    try:
        chosen = places(check.at, exact)
        samples = extract(check.quantity, exact.record, exact.start)
        expected = samples[chosen]
        if check.formula:
            expected = np.full(len(chosen), float(FORMULAS[check.formula](exact.start)))
    except Exception as error:
        return replace(empty, failure=f"the truth cannot be computed: {error}")
    if not np.all(np.isfinite(expected)):
        return replace(empty, failure="the truth is not a finite number here")
    try:
        got = extract(check.quantity, record, exact.start)[chosen]
    except (CheckError, IndexError) as error:
        return _lacking(replace(empty, expected=float(expected[-1])), contract, error)
    scale = float(np.max(np.abs(samples)))
    return _worst(empty, expected, got, scale, exact.record.times[chosen])


def judge_sequence(
    empty: CheckResult, contract: Contract, exact: Exact, record: Run
) -> CheckResult:
    """Judge whether every output of an exact block stays in its band under any inputs.

    The result shows the worst of them. ``record`` may hold some of the points of the exact motion
    only. What the run lacks is not judged; the result is not applicable where nothing is left.
    """
    band = Band(exact, agreed=True)
    because = "the bound for any input sequence, of the largest value of its kind"
    empty = replace(empty, because=because)
    times = exact.record.times
    read = np.minimum(np.searchsorted(times, record.times), times.size - 1)
    if not np.array_equal(times[read], record.times) or len(set(read)) < len(read):
        reason = f"{record.times.size} samples at other points than the case has"
        return replace(empty, failure=reason)
    lacking = [name for name in OUTPUT_NAMES if name not in record.outputs]
    results = []
    for name in filter(record.outputs.__contains__, OUTPUT_NAMES):
        try:
            extract(name, record, exact.start)
        except CheckError as error:
            return replace(empty, failure=str(error))
        _, expected, got, where = band.pair(name, record)
        if not where.any():
            continue
        quantity = QUANTITIES[name]
        row = replace(empty, quantity=name, unit=quantity.unit)
        scale = 0.0 if quantity.discrete else band.largest(name)
        if scale:
            row = replace(row, measure=Measure.OF_SCALE, tolerance=DISTURBED)
        results.append(_worst(row, expected[where], got[where], scale, record.times[where]))
        if results[-1].failure is not None:
            return replace(empty, failure=results[-1].failure)
    if results:
        return max(results, key=lambda result: margin(result.error, result.tolerance))
    if lacking:
        return _lacking(empty, contract, LackingError(f"no output {lacking[0]}"))
    return replace(empty, not_applicable="it was only agreed on")


def applies(invariant: ResidualInvariant, case: Case, exact: Exact) -> bool:
    """Whether the exact motion has a place that the invariant is about."""
    return bool(np.any(_residual(invariant, case, exact, exact.record).where))


def _residual(invariant: ResidualInvariant, case: Case, exact: Exact, record: Run) -> Residual:
    course = Course(case, record, exact.record, np.array(exact.event_times))
    with np.errstate(all="ignore"):
        return METRICS[invariant.metric](course)


def judge_residual(
    invariant: ResidualInvariant, case: Case, contract: Contract, exact: Exact, record: Run
) -> CheckResult:
    """Judge what an invariant leaves over in one side's run of a case.

    A run in which the invariant finds no place although the exact motion has one is a failure.
    """
    empty = of_invariant(
        invariant,
        case,
        contract,
        quantity=invariant.quantity,
        measure=Measure.OF_SCALE,
        tolerance=invariant.tolerance[contract.column],
        because=invariant.because[contract.column],
        expected=0.0,
    )
    try:
        residual = _residual(invariant, case, exact, record)
        values = residual.values[residual.where]
        scale = np.broadcast_to(residual.scale, residual.where.shape)[residual.where]
    except LackingError as error:
        return _lacking(empty, contract, error)
    except (ValueError, IndexError) as error:
        return replace(empty, failure=f"the samples do not fit together: {error}")
    empty = replace(empty, unit=residual.unit)
    if not values.size:
        return replace(empty, failure="the run has no such place; the exact motion has")
    times = exact.record.times[residual.where]
    return _worst(empty, np.zeros_like(values), values, scale, times)


def agreeing(invariant: Agreement, case: Case) -> Check | None:
    """Find the check of a case whose tolerances say how far FMU and reference may differ."""
    courses = (of for of in case.checks if of.at.kind == "every_point" and not of.formula)
    return next((check for check in courses if check.quantity == invariant.quantity), None)


def judge_agreement(
    invariant: Agreement,
    case: Case,
    check: Check,
    contract: Contract,
    exact: Answer[Exact],
    fmu: Answer[Run],
    reference: Answer[Run],
) -> CheckResult:
    """Compare FMU and reference, within what `check` of the case allows both."""
    sides = (contract.column, "reference")
    because = "; ".join(check.because[side] for side in sides)
    empty = of_invariant(
        invariant,
        case,
        contract,
        side="both",
        quantity=invariant.quantity,
        unit=check.unit,
        measure=check.measure,
        tolerance=sum(check.tolerance[side] for side in sides),
        because=f"the sum of what the case allows each of them: {because}",
    )
    if fmu.value is None or reference.value is None or exact.value is None:
        lacking = next(each for each in (fmu, reference, exact) if each.value is None)
        return replace(empty, not_applicable=lacking.not_applicable or "one of the runs failed")
    try:
        expected, got, motion = (
            extract(invariant.quantity, run, exact.value.start)
            for run in (reference.value, fmu.value, exact.value.record)
        )
    except CheckError as error:
        return _lacking(empty, contract, error)
    return _worst(empty, expected, got, float(np.max(np.abs(motion))))


def judge_order(
    invariant: Order, case: Case | str, contract: Contract, seen: Answer[ObservedOrder]
) -> Iterator[CheckResult]:
    """Judge an observed order, and whether it was observed in the asymptotic range."""
    for name, suffix, words, expected, tolerance in (
        ("order", "", "", invariant.order, invariant.tolerance),
        ("halves", "-asymptotic", ", coarser less finer half", 0.0, invariant.halves),
    ):
        row = of_invariant(
            invariant,
            case,
            contract,
            check=invariant.id + suffix,
            quantity=f"order in {invariant.quantity}{words}",
            expected=expected,
            tolerance=tolerance,
            because=invariant.because[name],
        )
        order = seen.value
        if order is None:
            yield replace(row, failure=seen.failure)
            continue
        levels, errors, middle = order.tolerances, order.errors, len(order.errors) // 2
        got = slope(levels, errors)
        if suffix:
            coarser = slope(levels[: middle + 1], errors[: middle + 1])
            got = coarser - slope(levels[middle:], errors[middle:])
        if np.isfinite(got):
            yield compared(row, expected, got, abs(got - expected))
        else:
            yield replace(row, failure="an error is zero or no finite number")


def judge_probe(invariant: Probe, contract: Contract, answer: Answer[list[str]]) -> CheckResult:
    """Judge the complaints of a probe."""
    empty = of_invariant(
        invariant,
        "",
        contract,
        quantity="complaints",
        because="the interface is kept or it is not",
        expected=0.0,
    )
    if answer.value is None:
        return without(empty, answer)
    count = len(answer.value)
    return compared(empty, 0.0, count, count, failure="; ".join(answer.value) or None)


def judge_run(
    invariant: RunInvariant,
    case: Case,
    contract: Contract,
    exact: Exact,
    plain: Run,
    other: Answer[Run],
) -> CheckResult:
    """Judge whether another run of the FMU gave the motion of the plain one, the start included."""
    empty = of_invariant(
        invariant,
        case,
        contract,
        quantity="every output",
        measure=Measure.ABSOLUTE if invariant.tolerance is None else Measure.OF_SCALE,
        tolerance=invariant.tolerance or 0.0,
        because=invariant.because,
    )
    if other.value is None:
        return without(empty, other)
    first, second = _with_start(plain), _with_start(other.value)
    if {n: s.shape for n, s in first.items()} != {n: s.shape for n, s in second.items()}:
        return replace(empty, failure="the runs have other outputs, or other numbers of samples")
    if invariant.tolerance is None:
        same = {
            n: (one == second[n]) | (np.isnan(one) & np.isnan(second[n]))
            for n, one in first.items()
        }
        differing = {name: int(np.sum(~where)) for name, where in same.items() if not where.all()}
        total = sum(differing.values())
        named = f", {next(iter(differing))} first" if differing else ""
        return compared(empty, 0.0, total, total, quantity=f"values that differ{named}")
    course = Course(case, plain, exact.record, np.array(exact.event_times))
    return _same_motion(empty, first, second, {name: course.scale_of(name) for name in first})


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
    names = filter(record.outputs.__contains__, OUTPUT_NAMES)
    return {name: np.append(record.initial[name], record.outputs[name]) for name in names}


def _same_motion(
    empty: CheckResult,
    plain: Mapping[str, Series],
    other: Mapping[str, Series],
    scales: Mapping[str, float],
) -> CheckResult:
    results = []
    for name, expected in plain.items():
        row = replace(empty, quantity=name, unit=QUANTITIES[name].unit)
        scale = 1.0 if QUANTITIES[name].discrete else scales[name]
        results.append(_worst(row, expected, other[name], scale))
        if results[-1].failure is not None:
            return results[-1]
    nothing = replace(empty, error=0.0, passed=True)
    return max(results, key=lambda result: result.error or 0.0, default=nothing)
