"""The baseline that FMUs are judged on: exact motions, the reference's runs, its observed orders.

It is computed once, in several processes, and serves every FMU of a run.
"""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

from stickslip_verification.drive import workers
from stickslip_verification.drive.answer import Answer
from stickslip_verification.drive.exact import Exact
from stickslip_verification.judge.invariant_checks import applies
from stickslip_verification.model.run import Run, Series
from stickslip_verification.model.verdict import ObservedOrder
from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.invariants import (
    Invariants,
    Manner,
    Order,
    ResidualInvariant,
)
from stickslip_verification.suite.sequences import tried

TIME_LIMIT = 180.0
"""Seconds that the truth or the reference may take for one case; the longest takes a few."""

_NO_REFERENCE: Answer[Run] = Answer(not_applicable="the reference is not run here")

Progress = Callable[[str, int, int], None]
"""Called with what is being done, how much of it is done, and out of how much."""


@dataclass(frozen=True)
class Baseline:
    """What one case is judged on.

    ``invariants`` are the invariants on samples that the exact motion has a place for; of a
    numerical solution ``spreads`` and ``changes`` of `drive.nearby` are known, and no reference.
    """

    case: Case
    exact: Answer[Exact]
    reference: Answer[Run]
    invariants: Sequence[ResidualInvariant]
    orders: Sequence[tuple[Order, Answer[ObservedOrder]]]
    spreads: Answer[dict[str, Series]] | None = None
    changes: Answer[dict[str, dict[str, Series]]] | None = None


@dataclass(frozen=True)
class Trial:
    """A random sequence that is run in a manner; of its baseline the exact motion counts alone."""

    baseline: Baseline
    manner: Manner


def compute(
    cases: Sequence[Case],
    invariants: Invariants,
    jobs: int,
    progress: Progress | None = None,
    *,
    numerical: Collection[str] | None = None,
) -> list[Baseline]:
    """Compute the baseline of each case; `progress` counts them.

    `numerical` are the cases that a numerical solution is judged in, by id.
    """
    asked = [
        (case, invariant)
        for case in cases
        for invariant in invariants.orders
        if numerical is None and case.id in invariant.cases and invariant.holds_for(case.law)
    ]
    with workers.Pool(jobs, TIME_LIMIT) as pool:
        # Long runs first, so that no process is left alone with one at the end.
        by_length = sorted(cases, key=lambda case: case.stop_time, reverse=True)
        exacts = pool.each(workers.exact, [(case,) for case in by_length])
        orders = pool.each(workers.observed_order, asked)
        of_numerical = [(case,) for case in by_length if numerical and case.id in numerical]
        spreads = pool.each(workers.spreads, of_numerical)
        changes = pool.each(workers.changes, of_numerical)
        references = pool.each(
            workers.reference, [(case,) for case in by_length if numerical is None]
        )
        found: dict[str, tuple[Answer[Exact], Answer[Run]]] = {}
        for done, case in enumerate(by_length):
            if progress is not None:
                progress(f"exact and reference: {case.id}", done, len(cases))
            found[case.id] = (next(exacts), next(references, _NO_REFERENCE))
        observed = list(zip(asked, orders, strict=True))
        near = {case.id: (next(spreads), next(changes)) for (case,) in of_numerical}
    return [
        Baseline(
            case,
            *found[case.id],
            invariants=_about(case, found[case.id][0], invariants),
            orders=[(invariant, seen) for (of, invariant), seen in observed if of.id == case.id],
            spreads=near.get(case.id, (None, None))[0],
            changes=near.get(case.id, (None, None))[1],
        )
        for case in cases
    ]


def trials(
    cases: Sequence[Case], manners: Sequence[Manner], jobs: int, *, numerical: bool
) -> list[Trial]:
    """Compute the exact motions of random sequences, and pair them with the manners."""
    with workers.Pool(jobs, TIME_LIMIT) as pool:
        exacts = pool.each(workers.exact, [(case,) for case in cases])
        about = pool.each(workers.spreads, [(case,) for case in cases if numerical])
        known = {
            case.id: Baseline(case, exact, _NO_REFERENCE, (), (), next(about, None))
            for case, exact in zip(cases, exacts, strict=True)
        }
    return [Trial(known[case.id], manner) for case, manner in tried(cases, manners)]


def _about(case: Case, exact: Answer[Exact], invariants: Invariants) -> list[ResidualInvariant]:
    holding = [each for each in invariants.residuals if each.holds_for(case.law)]
    if exact.value is None:
        return holding
    return [invariant for invariant in holding if applies(invariant, case, exact.value)]
