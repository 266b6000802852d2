"""The ground that FMUs are judged on: exact motions, the reference's runs, its observed orders.

It is computed once, in several processes, and serves every FMU of a run.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from stickslip_verification.drive import workers
from stickslip_verification.drive.answer import Answer
from stickslip_verification.drive.exact import Exact
from stickslip_verification.judge.invariant_checks import applies
from stickslip_verification.model.record import Record
from stickslip_verification.model.verdict import ObservedOrder
from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.invariants import Laws, Order, ResidualLaw

TIME_LIMIT = 180.0
"""Seconds that the truth or the reference may take for one case; the longest takes a few."""

Progress = Callable[[str, int, int], None]
"""Called with what is being done, how much of it is done, and out of how much."""


@dataclass(frozen=True)
class Ground:
    """What one case is judged on.

    ``laws`` are the laws on samples that the exact motion has a place for.
    """

    case: Case
    exact: Answer[Exact]
    reference: Answer[Record]
    laws: Sequence[ResidualLaw]
    orders: Sequence[tuple[Order, Answer[ObservedOrder]]]


def lay(
    cases: Sequence[Case], laws: Laws, jobs: int, progress: Progress | None = None
) -> list[Ground]:
    """Compute the ground of each case; `progress` counts the cases."""
    asked = [(case, law) for case in cases for law in laws.orders if case.id in law.cases]
    with workers.Pool(jobs, TIME_LIMIT) as pool:
        # Long runs first, so that no process is left alone with one at the end.
        by_length = sorted(cases, key=lambda case: case.stop_time, reverse=True)
        exacts = pool.each(workers.exact, [(case,) for case in by_length])
        references = pool.each(workers.reference, [(case,) for case in by_length])
        orders = pool.each(workers.observed_order, asked)
        found: dict[str, tuple[Answer[Exact], Answer[Record]]] = {}
        for done, case in enumerate(by_length):
            if progress is not None:
                progress(f"exact and reference: {case.id}", done, len(cases))
            found[case.id] = (next(exacts), next(references))
        observed = list(zip(asked, orders, strict=True))
    return [
        Ground(
            case,
            *found[case.id],
            laws=_about(case, found[case.id][0], laws),
            orders=[(law, seen) for (of, law), seen in observed if of.id == case.id],
        )
        for case in cases
    ]


def _about(case: Case, exact: Answer[Exact], laws: Laws) -> list[ResidualLaw]:
    if exact.value is None:
        return list(laws.residuals)
    return [law for law in laws.residuals if applies(law, case, exact.value)]
