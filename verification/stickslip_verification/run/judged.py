"""Runs of an FMU in every case, and the result of every check, invariant and probe."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

from stickslip_verification.drive import workers
from stickslip_verification.drive.answer import Answer
from stickslip_verification.drive.exact import Exact
from stickslip_verification.judge import checks, run_checks
from stickslip_verification.judge import invariant_checks as invariant_checks
from stickslip_verification.judge.band import of_any_sequence
from stickslip_verification.judge.checks import REFERENCE_CONTRACT, Contract
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.model.run import Run
from stickslip_verification.model.verdict import CheckResult, Klass, Motion
from stickslip_verification.run.baseline import Baseline, Progress, Trial
from stickslip_verification.suite.invariants import Invariants
from stickslip_verification.suite.sequences import PLAIN

FINISHES = "runs-to-the-end"
"""The check that a run which does not finish fails; for the others nothing is there to judge."""


UNTRIED = "not tried, for the model is wrong in its plain runs; --full tries it"

_UNTRIED: Answer[Run] = Answer(not_applicable=UNTRIED)

MOST_REPEATED = 4
"""Runs of cases, and of sequences, that are repeated; an FMU that often fails fails."""


@dataclass(frozen=True)
class Answers:
    """Results of an FMU.

    The plain run and the other runs of each case, the complaints of the probes, and the run of each
    trial of a sequence, in their order.
    """

    plain: Mapping[str, Answer[Run]]
    runs: Mapping[tuple[str, str], Answer[Run]]
    probes: Mapping[str, Answer[list[str]]]
    sequences: Sequence[Answer[Run]]


def ask(
    pool: workers.Pool,
    baseline: Sequence[Baseline],
    invariants: Invariants,
    progress: Progress | None = None,
    trials: Sequence[Trial] = (),
    enough: Callable[[Mapping[str, Answer[Run]]], bool] | None = None,
) -> Answers:
    """Run the FMU of a pool through the cases of the baseline and what the invariants ask for.

    Where the plain runs are `enough`, only those of the sequences follow.
    """
    cases = [each.case for each in baseline]
    kinds = list(dict.fromkeys(invariant.run for invariant in invariants.runs))
    asked = [(case, kind) for case in cases for kind in kinds]
    plain = pool.each(workers.plain_run, [(case,) for case in cases])
    found: dict[str, Answer[Run]] = {}
    for done, case in enumerate(cases):
        if progress is not None:
            progress(f"FMU: {case.id}", done, len(cases))
        found[case.id] = next(plain)
    if enough is not None and enough(found):
        drawn = [each for each in trials if each.manner.manner == PLAIN]
        ran = pool.each(workers.in_manner, [(each.baseline.case, PLAIN) for each in drawn])
        return Answers(
            found,
            dict.fromkeys(((case.id, kind) for case, kind in asked), _UNTRIED),
            {invariant.id: Answer(not_applicable=UNTRIED) for invariant in invariants.probes},
            [next(ran) if each.manner.manner == PLAIN else _UNTRIED for each in trials],
        )
    runs = pool.each(workers.other_run, asked)
    probes = pool.each(
        workers.probe, [(invariant,) for invariant in invariants.probes], most=workers.PROBE_LIMIT
    )
    tried = pool.each(
        workers.in_manner, [(each.baseline.case, each.manner.manner) for each in trials]
    )
    others: dict[tuple[str, str], Answer[Run]] = {}
    for done, (case, kind) in enumerate(asked):
        if progress is not None and done % len(kinds) == 0:
            progress(f"FMU in other runs: {case.id}", done // len(kinds), len(cases))
        others[case.id, kind] = next(runs)
    asked_of = {invariant.id: next(probes) for invariant in invariants.probes}
    if progress is not None and trials:
        progress("FMU in random sequences", len(cases), len(cases))
    return Answers(found, others, asked_of, list(tried))


def again(
    pool: workers.Pool, baseline: Sequence[Baseline], answers: Answers, trials: Sequence[Trial]
) -> Answers:
    """Repeat a few runs that had no end, one by one: the second result decides."""
    cases = {each.case.id: each.case for each in baseline}
    plain, drawn = dict(answers.plain), list(answers.sequences)
    lost = [case for case, answer in plain.items() if answer.failure is not None]
    for case in lost[:MOST_REPEATED]:
        (plain[case],) = pool.each(workers.plain_run, [(cases[case],)])
    broken = [n for n, answer in enumerate(drawn) if answer.failure is not None]
    for n in broken[:MOST_REPEATED]:
        asked = (trials[n].baseline.case, trials[n].manner.manner)
        (drawn[n],) = pool.each(workers.in_manner, [asked])
    return replace(answers, plain=plain, sequences=drawn)


def judge(
    baseline: Sequence[Baseline],
    invariants: Invariants,
    answers: Answers,
    contract: Contract,
    trials: Sequence[Trial] = (),
    *,
    reference: bool = True,
) -> Iterator[CheckResult]:
    """Yield the result of every check, case by case, then of every sequence and probe.

    Without `reference` only what the FMU did is judged.
    """
    for each in baseline:
        results = _judge_case(each, invariants, answers, contract, reference=reference)
        if each.case.klass == Klass.CONTRACT:
            # Every check of a case of class contract is itself of that class.
            results = (_by_contract(result, contract) for result in results)
        yield from results
    for trial, answer in zip(trials, answers.sequences, strict=True):
        empty = invariant_checks.blank(trial.manner, trial.baseline.case.id, contract)
        judge_sequence = partial(_in_band, empty, contract)
        yield _judge(empty, trial.baseline, answer, judge_sequence)
    for invariant in invariants.probes:
        yield invariant_checks.judge_probe(invariant, contract, answers.probes[invariant.id])


def motions(baseline: Sequence[Baseline], answers: Answers) -> Iterator[Motion]:
    """Yield the motion of each case on the sides that ran, beside the exact one."""
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
            group=each.case.group,
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
            judge_side = partial(checks.judge, case, check, side)
            yield _judge(checks.blank(case, check, side), baseline, answer, judge_side)
    for invariant in baseline.invariants:
        for side, answer in sides:
            empty = invariant_checks.blank(invariant, case.id, side)
            judge_residual = partial(invariant_checks.judge_residual, invariant, case, side)
            yield _judge(empty, baseline, answer, judge_residual)
    for run in invariants.runs:
        if run.holds_for(case.law):
            empty = invariant_checks.blank(run, case.id, contract)
            if plain.value is None:
                yield _unanswered(empty, plain)
                continue
            judge_run = partial(
                run_checks.judge_run,
                run,
                case,
                contract,
                other=answers.runs[case.id, run.run],
            )
            yield _judge(empty, baseline, plain, judge_run)
    yield from _judge_against_reference(
        baseline, invariants, answers, contract, reference=reference
    )


def _in_band(empty: CheckResult, contract: Contract, exact: Exact, record: Run) -> CheckResult:
    """Judge every output of a run of any sequence."""
    return checks.judge_in_band(empty, OUTPUT_NAMES, contract, of_any_sequence(exact), record)


def _by_contract(result: CheckResult, contract: Contract) -> CheckResult:
    decides = (REFERENCE_CONTRACT if result.side == "reference" else contract).decides(
        Klass.CONTRACT
    )
    return replace(result, klass=Klass.CONTRACT, decides=decides)


def _unanswered(empty: CheckResult, answer: Answer[Run]) -> CheckResult:
    """Return the result of a check whose run gave no record.

    One check fails with the reason; the others say that there is nothing to judge.
    """
    if answer.not_applicable is not None or empty.check == FINISHES:
        return replace(empty, failure=answer.failure, not_applicable=answer.not_applicable)
    return replace(empty, not_applicable=f"the run did not end: see {FINISHES}")


def _judge(
    empty: CheckResult,
    baseline: Baseline,
    answer: Answer[Run],
    judge: Callable[[Exact, Run], CheckResult],
) -> CheckResult:
    """Return what `judge` says of a run; without truth or run, `empty` with the reason."""
    exact = baseline.exact
    if exact.value is None:
        return replace(empty, failure=f"the truth cannot be computed: {exact.failure}")
    if answer.value is None:
        return _unanswered(empty, answer)
    return judge(exact.value, answer.value)


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
            result = invariant_checks.judge_agreement(
                invariant, case, check, contract, baseline.exact, records
            )
            yield result
    if reference:
        for order, seen in baseline.orders:
            yield from invariant_checks.judge_order(order, case.id, REFERENCE_CONTRACT, seen)
