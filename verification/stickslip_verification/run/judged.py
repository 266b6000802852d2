"""The run of an FMU: everything it is asked, and the result of every check, law and probe."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from stickslip_verification.drive import workers
from stickslip_verification.drive.answer import Answer
from stickslip_verification.judge import checks, run_checks
from stickslip_verification.judge import invariant_checks as law_checks
from stickslip_verification.judge.checks import REFERENCE, Trial
from stickslip_verification.model.record import Record
from stickslip_verification.model.verdict import CheckResult, Motion
from stickslip_verification.run.baseline import Ground, Progress
from stickslip_verification.suite.cases import Check
from stickslip_verification.suite.invariants import Laws, ResidualLaw, RunLaw

FINISHES = "runs-to-the-end"
"""The check that a run which does not finish fails; for the others nothing is there to judge."""


@dataclass(frozen=True)
class Trials:
    """What an FMU did: its plain run and its other runs of each case, and the probes' answers."""

    plain: Mapping[str, Answer[Record]]
    runs: Mapping[tuple[str, str], Answer[Record]]
    probes: Mapping[str, Answer[list[str]]]


def ask(
    pool: workers.Pool,
    ground: Sequence[Ground],
    laws: Laws,
    progress: Progress | None = None,
) -> Trials:
    """Let the FMU of a pool do all that it is judged by on this ground and by these laws."""
    cases = [each.case for each in ground]
    kinds = list(dict.fromkeys(law.run for law in laws.runs))
    asked = [(case, kind) for case in cases for kind in kinds]
    plain = pool.each(workers.plain_run, [(case,) for case in cases])
    runs = pool.each(workers.other_run, asked)
    probes = pool.each(workers.probe, [(law,) for law in laws.probes], most=workers.PROBE_LIMIT)
    found: dict[str, Answer[Record]] = {}
    others: dict[tuple[str, str], Answer[Record]] = {}
    for done, case in enumerate(cases):
        if progress is not None:
            progress(f"FMU: {case.id}", done, len(cases))
        found[case.id] = next(plain)
    for done, (case, kind) in enumerate(asked):
        if progress is not None and done % len(kinds) == 0:
            progress(f"FMU in other runs: {case.id}", done // len(kinds), len(cases))
        others[case.id, kind] = next(runs)
    return Trials(found, others, {law.id: next(probes) for law in laws.probes})


def judge(
    ground: Sequence[Ground], laws: Laws, trials: Trials, trial: Trial, *, reference: bool = True
) -> Iterator[CheckResult]:
    """Give the result of every check, case by case, then those of the FMU as a whole.

    Without `reference` only what the FMU did is judged.
    """
    for each in ground:
        results = _judge_case(each, laws, trials, trial, reference=reference)
        if each.case.klass == "contract":
            # Whatever is said of a convention is no more than a convention.
            results = (_by_contract(result, trial) for result in results)
        yield from results
    for law in laws.probes:
        yield law_checks.judge_probe(law, trial, trials.probes[law.id])


def motions(ground: Sequence[Ground], trials: Trials) -> Iterator[Motion]:
    """Give what each case looked like on the sides that ran."""
    for each in ground:
        if each.exact.value is None:
            continue
        sides = {"fmu": trials.plain[each.case.id].value, "reference": each.reference.value}
        yield Motion(
            case=each.case.id,
            title=each.case.title,
            about=each.case.about,
            exact=each.exact.value.record,
            event_times=each.exact.value.event_times,
            records={name: record for name, record in sides.items() if record is not None},
        )


def _judge_case(
    ground: Ground, laws: Laws, trials: Trials, trial: Trial, *, reference: bool
) -> Iterator[CheckResult]:
    case = ground.case
    plain = trials.plain[case.id]
    sides = [(trial, plain)] + ([(REFERENCE, ground.reference)] if reference else [])
    for check in case.checks:
        for side, answer in sides:
            yield _judge_side(checks.blank(case, check, side), ground, answer, check, side)
    for law in ground.laws:
        for side, answer in sides:
            yield _judge_law(ground, law, answer, side)
    for run in laws.runs:
        yield _judge_run(ground, run, trials, trial)
    yield from _judge_against_reference(ground, laws, trials, trial, reference=reference)


def _by_contract(result: CheckResult, trial: Trial) -> CheckResult:
    decides = (REFERENCE if result.side == "reference" else trial).decides("contract")
    return replace(result, klass="contract", decides=decides)


def _unanswered(empty: CheckResult, answer: Answer[Record]) -> CheckResult:
    """Give the result where a run gave no record.

    One check fails with the reason; the others say that there is nothing to judge.
    """
    if answer.not_applicable is not None or empty.check == FINISHES:
        return replace(empty, failure=answer.failure, not_applicable=answer.not_applicable)
    return replace(empty, not_applicable=f"the run did not end: see {FINISHES}")


def _judge_side(
    empty: CheckResult, ground: Ground, answer: Answer[Record], check: Check, side: Trial
) -> CheckResult:
    if ground.exact.value is None:
        return replace(empty, failure=f"the truth cannot be computed: {ground.exact.failure}")
    if answer.value is None:
        return _unanswered(empty, answer)
    return checks.judge(ground.case, check, side, ground.exact.value, answer.value)


def _judge_law(
    ground: Ground, law: ResidualLaw, answer: Answer[Record], side: Trial
) -> CheckResult:
    empty = law_checks.blank(law, ground.case.id, side)
    if ground.exact.value is None:
        return replace(empty, failure=f"the truth cannot be computed: {ground.exact.failure}")
    if answer.value is None:
        return _unanswered(empty, answer)
    return law_checks.judge_residual(law, ground.case, side, ground.exact.value, answer.value)


def _judge_run(ground: Ground, law: RunLaw, trials: Trials, trial: Trial) -> CheckResult:
    plain = trials.plain[ground.case.id]
    empty = law_checks.blank(law, ground.case.id, trial)
    if plain.value is None:
        return _unanswered(empty, plain)
    if ground.exact.value is None:
        return replace(empty, failure=f"the truth cannot be computed: {ground.exact.failure}")
    other = trials.runs[ground.case.id, law.run]
    exact = ground.exact.value
    return run_checks.judge_run(law, ground.case, trial, exact, plain.value, other)


def _judge_against_reference(
    ground: Ground, laws: Laws, trials: Trials, trial: Trial, *, reference: bool
) -> Iterator[CheckResult]:
    case = ground.case
    records = {"fmu": trials.plain[case.id], "reference": ground.reference}
    for law in laws.agreements:
        check = law_checks.agreeing(law, case)
        if check is not None:
            yield law_checks.judge_agreement(law, case, check, trial, ground.exact, records)
    if reference:
        for order, seen in ground.orders:
            yield from law_checks.judge_order(order, case.id, REFERENCE, seen)
