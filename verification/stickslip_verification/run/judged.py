"""The run of an FMU: everything it is asked, and the result of every check, invariant and probe."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from stickslip_verification.drive import workers
from stickslip_verification.drive.answer import Answer
from stickslip_verification.judge import checks, run_checks
from stickslip_verification.judge import invariant_checks as invariant_checks
from stickslip_verification.judge.checks import REFERENCE_CONTRACT, Contract
from stickslip_verification.model.run import Run
from stickslip_verification.model.verdict import CheckResult, Klass, Motion
from stickslip_verification.run.baseline import Baseline, Progress
from stickslip_verification.suite.cases import Check
from stickslip_verification.suite.invariants import Invariants, ResidualInvariant, RunInvariant

FINISHES = "runs-to-the-end"
"""The check that a run which does not finish fails; for the others nothing is there to judge."""


@dataclass(frozen=True)
class Answers:
    """What an FMU did: its plain run and its other runs of each case, and the probes' answers."""

    plain: Mapping[str, Answer[Run]]
    runs: Mapping[tuple[str, str], Answer[Run]]
    probes: Mapping[str, Answer[list[str]]]


def ask(
    pool: workers.Pool,
    baseline: Sequence[Baseline],
    invariants: Invariants,
    progress: Progress | None = None,
) -> Answers:
    """Run the FMU of a pool through the cases of the baseline and what the invariants ask for."""
    cases = [each.case for each in baseline]
    kinds = list(dict.fromkeys(invariant.run for invariant in invariants.runs))
    asked = [(case, kind) for case in cases for kind in kinds]
    plain = pool.each(workers.plain_run, [(case,) for case in cases])
    runs = pool.each(workers.other_run, asked)
    probes = pool.each(
        workers.probe, [(invariant,) for invariant in invariants.probes], most=workers.PROBE_LIMIT
    )
    found: dict[str, Answer[Run]] = {}
    others: dict[tuple[str, str], Answer[Run]] = {}
    for done, case in enumerate(cases):
        if progress is not None:
            progress(f"FMU: {case.id}", done, len(cases))
        found[case.id] = next(plain)
    for done, (case, kind) in enumerate(asked):
        if progress is not None and done % len(kinds) == 0:
            progress(f"FMU in other runs: {case.id}", done // len(kinds), len(cases))
        others[case.id, kind] = next(runs)
    return Answers(found, others, {invariant.id: next(probes) for invariant in invariants.probes})


def judge(
    baseline: Sequence[Baseline],
    invariants: Invariants,
    answers: Answers,
    contract: Contract,
    *,
    reference: bool = True,
) -> Iterator[CheckResult]:
    """Give the result of every check, case by case, then those of the FMU as a whole.

    Without `reference` only what the FMU did is judged.
    """
    for each in baseline:
        results = _judge_case(each, invariants, answers, contract, reference=reference)
        if each.case.klass == Klass.CONTRACT:
            # Whatever is said of a convention is no more than a convention.
            results = (_by_contract(result, contract) for result in results)
        yield from results
    for invariant in invariants.probes:
        yield invariant_checks.judge_probe(invariant, contract, answers.probes[invariant.id])


def motions(baseline: Sequence[Baseline], answers: Answers) -> Iterator[Motion]:
    """Give what each case looked like on the sides that ran."""
    for each in baseline:
        if each.exact.value is None:
            continue
        sides = {"fmu": answers.plain[each.case.id].value, "reference": each.reference.value}
        yield Motion(
            case=each.case.id,
            title=each.case.title,
            about=each.case.about,
            exact=each.exact.value.record,
            event_times=each.exact.value.event_times,
            records={name: record for name, record in sides.items() if record is not None},
        )


def _judge_case(
    baseline: Baseline,
    invariants: Invariants,
    answers: Answers,
    contract: Contract,
    *,
    reference: bool,
) -> Iterator[CheckResult]:
    case = baseline.case
    plain = answers.plain[case.id]
    sides = [(contract, plain)] + ([(REFERENCE_CONTRACT, baseline.reference)] if reference else [])
    for check in case.checks:
        for side, answer in sides:
            yield _judge_side(checks.blank(case, check, side), baseline, answer, check, side)
    for invariant in baseline.invariants:
        for side, answer in sides:
            yield _judge_invariant(baseline, invariant, answer, side)
    for run in invariants.runs:
        if run.holds_for(case.law):
            yield _judge_run(baseline, run, answers, contract)
    yield from _judge_against_reference(
        baseline, invariants, answers, contract, reference=reference
    )


def _by_contract(result: CheckResult, contract: Contract) -> CheckResult:
    decides = (REFERENCE_CONTRACT if result.side == "reference" else contract).decides(
        Klass.CONTRACT
    )
    return replace(result, klass=Klass.CONTRACT, decides=decides)


def _unanswered(empty: CheckResult, answer: Answer[Run]) -> CheckResult:
    """Give the result where a run gave no record.

    One check fails with the reason; the others say that there is nothing to judge.
    """
    if answer.not_applicable is not None or empty.check == FINISHES:
        return replace(empty, failure=answer.failure, not_applicable=answer.not_applicable)
    return replace(empty, not_applicable=f"the run did not end: see {FINISHES}")


def _judge_side(
    empty: CheckResult, baseline: Baseline, answer: Answer[Run], check: Check, side: Contract
) -> CheckResult:
    if baseline.exact.value is None:
        return replace(empty, failure=f"the truth cannot be computed: {baseline.exact.failure}")
    if answer.value is None:
        return _unanswered(empty, answer)
    return checks.judge(baseline.case, check, side, baseline.exact.value, answer.value)


def _judge_invariant(
    baseline: Baseline, invariant: ResidualInvariant, answer: Answer[Run], side: Contract
) -> CheckResult:
    empty = invariant_checks.blank(invariant, baseline.case.id, side)
    if baseline.exact.value is None:
        return replace(empty, failure=f"the truth cannot be computed: {baseline.exact.failure}")
    if answer.value is None:
        return _unanswered(empty, answer)
    return invariant_checks.judge_residual(
        invariant, baseline.case, side, baseline.exact.value, answer.value
    )


def _judge_run(
    baseline: Baseline, invariant: RunInvariant, answers: Answers, contract: Contract
) -> CheckResult:
    plain = answers.plain[baseline.case.id]
    empty = invariant_checks.blank(invariant, baseline.case.id, contract)
    if plain.value is None:
        return _unanswered(empty, plain)
    if baseline.exact.value is None:
        return replace(empty, failure=f"the truth cannot be computed: {baseline.exact.failure}")
    other = answers.runs[baseline.case.id, invariant.run]
    exact = baseline.exact.value
    return run_checks.judge_run(invariant, baseline.case, contract, exact, plain.value, other)


def _judge_against_reference(
    baseline: Baseline,
    invariants: Invariants,
    answers: Answers,
    contract: Contract,
    *,
    reference: bool,
) -> Iterator[CheckResult]:
    case = baseline.case
    records = {"fmu": answers.plain[case.id], "reference": baseline.reference}
    for invariant in invariants.agreements:
        check = invariant_checks.agreeing(invariant, case)
        if check is not None and invariant.holds_for(case.law):
            yield invariant_checks.judge_agreement(
                invariant, case, check, contract, baseline.exact, records
            )
    if reference:
        for order, seen in baseline.orders:
            yield from invariant_checks.judge_order(order, case.id, REFERENCE_CONTRACT, seen)
