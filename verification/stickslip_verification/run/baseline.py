"""The baseline that FMUs are judged on: exact motions, the reference's runs, its observed orders.

It is computed once, in several processes, and serves every FMU of a run.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from stickslip_verification.drive import workers
from stickslip_verification.drive.answer import Answer
from stickslip_verification.drive.exact import Exact
from stickslip_verification.judge.invariant_checks import applies
from stickslip_verification.model.run import Run
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

Progress = Callable[[str, int, int], None]
"""Called with what is being done, how much of it is done, and out of how much."""


@dataclass(frozen=True)
class Baseline:
    """What one case is judged on.

    ``invariants`` are the invariants on samples that the exact motion has a place for, ``nearby``
    the motions near the exact one, None where no FMU is held to a band.
    """

    case: Case
    exact: Answer[Exact]
    reference: Answer[Run]
    invariants: Sequence[ResidualInvariant]
    orders: Sequence[tuple[Order, Answer[ObservedOrder]]]
    nearby: Answer[tuple[Run, ...]] | None = None


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
    nearby: bool = False,
) -> list[Baseline]:
    """Compute the baseline of each case; `progress` counts the cases.

    With `nearby` the motions near the exact ones are followed too.
    """
    asked = [
        (case, invariant)
        for case in cases
        for invariant in invariants.orders
        if case.id in invariant.cases and invariant.holds_for(case.law)
    ]
    with workers.Pool(jobs, TIME_LIMIT) as pool:
        # Long runs first, so that no process is left alone with one at the end.
        by_length = sorted(cases, key=lambda case: case.stop_time, reverse=True)
        exacts = pool.each(workers.exact, [(case,) for case in by_length])
        references = pool.each(workers.reference, [(case,) for case in by_length])
        orders = pool.each(workers.observed_order, asked)
        about = pool.each(workers.nearby, [(case,) for case in cases if nearby])
        found: dict[str, tuple[Answer[Exact], Answer[Run]]] = {}
        for done, case in enumerate(by_length):
            if progress is not None:
                progress(f"exact and reference: {case.id}", done, len(cases))
            found[case.id] = (next(exacts), next(references))
        observed = list(zip(asked, orders, strict=True))
        near = dict(zip((case.id for case in cases if nearby), about, strict=True))
    return [
        Baseline(
            case,
            *found[case.id],
            invariants=_about(case, found[case.id][0], invariants),
            orders=[(invariant, seen) for (of, invariant), seen in observed if of.id == case.id],
            nearby=near.get(case.id),
        )
        for case in cases
    ]


def trials(
    cases: Sequence[Case], manners: Sequence[Manner], jobs: int, *, nearby: bool
) -> list[Trial]:
    """Compute the exact motions of random sequences, and pair them with the manners."""
    no_reference: Answer[Run] = Answer(not_applicable="the FMU alone is run on random sequences")
    with workers.Pool(jobs, TIME_LIMIT) as pool:
        exacts = pool.each(workers.exact, [(case,) for case in cases])
        about = pool.each(workers.nearby, [(case,) for case in cases if nearby])
        known = {
            case.id: Baseline(case, exact, no_reference, (), (), next(about, None))
            for case, exact in zip(cases, exacts, strict=True)
        }
    return [Trial(known[case.id], manner) for case, manner in tried(cases, manners)]


def _about(case: Case, exact: Answer[Exact], invariants: Invariants) -> list[ResidualInvariant]:
    holding = [each for each in invariants.residuals if each.holds_for(case.law)]
    if exact.value is None:
        return holding
    return [invariant for invariant in holding if applies(invariant, case, exact.value)]
