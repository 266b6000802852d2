"""Comparisons of the runs of an FMU, and of the reference: every check, invariant and probe."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from itertools import product

from stickslip_verification.drive.answer import Answer
from stickslip_verification.drive.exact import Exact
from stickslip_verification.judge import checks
from stickslip_verification.judge.contract import REFERENCE_CONTRACT
from stickslip_verification.model.run import Run
from stickslip_verification.model.verdict import CheckResult
from stickslip_verification.run.experiment import Baseline
from stickslip_verification.run.numerical import compare_numerical, solution
from stickslip_verification.run.runs import Runs

FINISHES = "runs-to-the-end"
"""The check that a run which does not finish fails; for the others nothing is there to judge."""


def compare(runs: Runs, *, reference: bool = True) -> Iterator[CheckResult]:
    """Yield the result of every check, case by case, then of every random test and probe.

    Without `reference` only what the FMU did is judged.
    """
    contract = runs.experiment.contract
    if contract.numerical:
        yield from compare_numerical(runs, solution(runs.experiment.baseline, runs.plain))
        return
    for baseline in runs.experiment.baseline:
        yield from _compare_case(runs, baseline, reference=reference)
    for test, answer in zip(runs.experiment.random, runs.random, strict=True):
        empty = checks.of_invariant(test.manner, test.baseline.case.id, contract)
        yield _result(empty, test.baseline, answer, partial(checks.judge_sequence, empty, contract))
    for probe in runs.experiment.invariants.probes:
        yield checks.judge_probe(probe, contract, runs.probes[probe.id])


def _compare_case(runs: Runs, baseline: Baseline, *, reference: bool) -> Iterator[CheckResult]:
    case, plain = baseline.case, runs.plain[baseline.case.id]
    invariants, contract = runs.experiment.invariants, runs.experiment.contract
    sides = [(contract, plain)] + ([(REFERENCE_CONTRACT, baseline.reference)] if reference else [])
    for check, (side, answer) in product(case.checks, sides):
        empty = checks.of_check(case, check, side)
        yield _result(empty, baseline, answer, partial(checks.judge, case, check, side))
    for residual, (side, answer) in product(baseline.invariants, sides):
        empty = checks.of_invariant(residual, case, side)
        judge = partial(checks.judge_residual, residual, case, side)
        yield _result(empty, baseline, answer, judge)
    for run in invariants.runs:
        if run.holds_for(case.law):
            empty = checks.of_invariant(run, case, contract)
            other = runs.others[case.id, run.run]
            judge = partial(checks.judge_run, run, case, contract, other=other)
            yield _result(empty, baseline, plain, judge)
    for agreement in invariants.agreements:
        agreed = checks.agreeing(agreement, case)
        if agreed is not None and agreement.holds_for(case.law):
            answers = (baseline.exact, plain, baseline.reference)
            yield checks.judge_agreement(agreement, case, agreed, contract, *answers)
    for order, seen in baseline.orders if reference else ():
        yield from checks.judge_order(order, case, REFERENCE_CONTRACT, seen)


def _result(
    empty: CheckResult,
    baseline: Baseline,
    answer: Answer[Run],
    judge: Callable[[Exact, Run], CheckResult],
) -> CheckResult:
    """Return what `judge` makes of a run; without truth or run, `empty` with the reason.

    Of the checks whose run did not end one fails; the others say that there is nothing to judge.
    """
    exact, run = baseline.exact, answer.value
    if exact.value is None:
        return replace(empty, failure=f"the truth cannot be computed: {exact.failure}")
    if run is not None:
        return judge(exact.value, run)
    if answer.not_applicable is not None or empty.check == FINISHES:
        return checks.without(empty, answer)
    return replace(empty, not_applicable=f"the run did not end: see {FINISHES}")
