"""What an FMU is tried on: exact motions, the reference's runs and its observed orders.

It is computed once, in several processes, and serves every FMU of a verification.
"""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from typing import Any

from stickslip_verification.drive import workers
from stickslip_verification.drive.answer import Answer
from stickslip_verification.drive.exact import Exact
from stickslip_verification.judge.checks import applies
from stickslip_verification.judge.contract import Contract
from stickslip_verification.model.run import Run, Series
from stickslip_verification.model.verdict import ObservedOrder
from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.invariants import Invariants, Manner, Order, ResidualInvariant
from stickslip_verification.suite.sequences import PLAIN, tried

TIME_LIMIT = 180.0
"""Seconds that the truth or the reference may take for one case; the longest takes a few."""

Progress = Callable[[str, int, int], None]
"""Called with what is being done, how much of it is done, and out of how much."""


_NO_REFERENCE: Answer[Run] = Answer(not_applicable="the reference is not run here")
_UNKNOWN: Answer[Any] = Answer()


@dataclass(frozen=True)
class Baseline:
    """What one case is judged on.

    ``invariants`` are those on samples that the exact motion has a place for; of a numerical
    solution ``spreads`` and ``changes`` of `drive.exact` are known, and no reference.
    """

    case: Case
    exact: Answer[Exact]
    reference: Answer[Run] = _NO_REFERENCE
    invariants: Sequence[ResidualInvariant] = ()
    orders: Sequence[tuple[Order, Answer[ObservedOrder]]] = ()
    spreads: Answer[dict[str, Series]] = _UNKNOWN
    changes: Answer[dict[str, dict[str, Series]]] = _UNKNOWN


@dataclass(frozen=True)
class RandomTest:
    """A random sequence that is run in a manner; of its baseline the exact motion counts alone."""

    baseline: Baseline
    manner: Manner

    @property
    def plain(self) -> bool:
        """Whether it is run without any manner."""
        return self.manner.manner == PLAIN


@dataclass(frozen=True)
class Experiment:
    """All that an FMU is tried on, and how it is judged."""

    baseline: Sequence[Baseline]
    invariants: Invariants
    contract: Contract
    random: Sequence[RandomTest] = ()


def compute(
    cases: Sequence[Case],
    invariants: Invariants | None,
    jobs: int,
    progress: Progress | None = None,
    *,
    numerical: Collection[str] | None = None,
) -> list[Baseline]:
    """Compute the baseline of each case; `progress` counts them.

    `numerical` are the cases that a numerical solution is judged in, by id. Without `invariants` it
    is the exact motion and what is near it.
    """
    # Long runs first, so that no process is left alone with one at the end.
    by_length = sorted(cases, key=lambda case: case.stop_time, reverse=True)
    near = [case for case in by_length if case.id in (numerical or ())]
    tasks: dict[str, tuple[Callable[..., Any], list[Case]]] = {
        "exact": (workers.exact, by_length),
        "spreads": (workers.spreads, near),
        "changes": (workers.changes, near if invariants is not None else []),
        "reference": (workers.reference, by_length if numerical is None else []),
    }
    ordered = [
        (case, order)
        for case in by_length
        for order in (invariants.orders if invariants is not None else ())
        if numerical is None and case.id in order.cases and order.holds_for(case.law)
    ]
    baselines: dict[str, Baseline] = {}
    with workers.Pool(jobs, TIME_LIMIT) as pool:
        answers = {
            name: pool.each(task, [(case,) for case in of]) for name, (task, of) in tasks.items()
        }
        orders = pool.each(workers.observed_order, ordered)
        for done, case in enumerate(by_length):
            if progress is not None:
                progress(f"exact and reference: {case.id}", done, len(cases))
            known: dict[str, Any] = {
                name: next(answers[name]) for name, (_, of) in tasks.items() if case in of
            }
            known["invariants"] = _about(case, known["exact"].value, invariants)
            known["orders"] = [(order, next(orders)) for of, order in ordered if of is case]
            baselines[case.id] = Baseline(case, **known)
    return [baselines[case.id] for case in cases]


def random_tests(
    cases: Sequence[Case], manners: Sequence[Manner], jobs: int, *, numerical: bool
) -> list[RandomTest]:
    """Compute the exact motions of random sequences, and pair them with the manners."""
    near = [case.id for case in cases if numerical]
    known = {of.case.id: of for of in compute(cases, None, jobs, numerical=near)}
    return [RandomTest(known[case.id], manner) for case, manner in tried(cases, manners)]


def _about(case: Case, exact: Exact | None, of: Invariants | None) -> list[ResidualInvariant]:
    return [
        residual
        for residual in (of.residuals if of is not None else ())
        if residual.holds_for(case.law) and (exact is None or applies(residual, case, exact))
    ]
