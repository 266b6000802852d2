"""What an FMU is tried on, and its runs through that.

Exact motions, the reference's runs and its observed orders are computed once, in several processes,
and serve every FMU of a verification.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

from ..drive import exact as motions
from ..drive.environments import asked
from ..drive.masters import run_case
from ..drive.other_runs import other_run
from ..drive.processes import PROBE_LIMIT, Answer, Pool
from ..judge.checks import Contract, applies
from ..model.verdict import Klass, ObservedOrder, Run, Series
from ..suite.cases import Case
from ..suite.invariants import Invariants, Manner, Order, ResidualInvariant, RunInvariant
from ..suite.sequences import PLAIN, tried

TIME_LIMIT = 180.0
"""Seconds that the truth or the reference may take for one case; the longest takes a few."""
Progress = Callable[[str, int, int], None]
"""Called with what is being done, how much of it is done, and out of how much."""


def silent(what: str, done: int, of: int) -> None:
    """Show no progress."""


_NO_REFERENCE: Answer[Run] = Answer(not_applicable="the reference is not run here")
_UNKNOWN: Answer[Any] = Answer()


@dataclass(frozen=True)
class Baseline:
    """What one case is judged on.

    ``invariants`` are those on samples that the exact motion has a place for; of a numerical
    solution ``spreads`` and ``changes`` of `drive.exact` are known, and no reference.
    """

    case: Case
    exact: Answer[motions.Exact]
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

    @property
    def runs(self) -> Sequence[RunInvariant]:
        """The other runs: of a numerical solution those of physics, of an exact block no others."""
        if self.contract.numerical:
            return [run for run in self.invariants.runs if run.klass == Klass.PHYSICS]
        return [run for run in self.invariants.runs if not run.numerical]


def compute(
    cases: Sequence[Case],
    invariants: Invariants | None,
    jobs: int,
    progress: Progress = silent,
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
        "exact": (motions.exact_motion, by_length),
        "spreads": (motions.spreads, near),
        "changes": (motions.changes, near if invariants is not None else []),
        "reference": (motions.run_reference, by_length if numerical is None else []),
    }
    ordered = [
        (motions.observe, case, order)
        for case in by_length
        for order in (invariants.orders if invariants is not None else ())
        if numerical is None and case.id in order.cases and order.holds_for(case.law)
    ]
    baselines: dict[str, Baseline] = {}
    with Pool(jobs, TIME_LIMIT) as pool:
        answers = {
            name: pool.each(motions.kept, [(task, case) for case in of])
            for name, (task, of) in tasks.items()
        }
        orders = pool.each(motions.kept, ordered)
        for done, case in enumerate(by_length):
            progress(f"exact and reference: {case.id}", done, len(cases))
            known: dict[str, Any] = {
                name: next(answers[name]) for name, (_, of) in tasks.items() if case in of
            }
            exact = known["exact"].value
            known["invariants"] = [
                residual
                for residual in (invariants.residuals if invariants is not None else ())
                if residual.holds_for(case.law)
                and (exact is None or applies(residual, case, exact))
            ]
            known["orders"] = [(order, next(orders)) for _, of, order in ordered if of is case]
            baselines[case.id] = Baseline(case, **known)
    return [baselines[case.id] for case in cases]


def random_tests(
    cases: Sequence[Case], manners: Sequence[Manner], jobs: int, *, numerical: bool
) -> list[RandomTest]:
    """Compute the exact motions of random sequences, and pair them with the manners."""
    near = [case.id for case in cases if numerical]
    known = {of.case.id: of for of in compute(cases, None, jobs, numerical=near)}
    return [RandomTest(known[case.id], manner) for case, manner in tried(cases, manners)]


UNTRIED: Answer[Any] = Answer(
    not_applicable="not tried, for the model is wrong in its plain runs; --full tries it"
)

MOST_REPEATED = 4
"""Runs of cases, and of sequences, that are repeated; an FMU that often fails fails."""


@dataclass(frozen=True)
class Runs:
    """Results of an FMU in an experiment.

    The plain run and the other runs of each case, the complaints of the probes, and the run of each
    random test, in their order.
    """

    experiment: Experiment
    plain: Mapping[str, Answer[Run]]
    others: Mapping[tuple[str, str], Answer[Run]]
    probes: Mapping[str, Answer[list[str]]]
    random: Sequence[Answer[Run]]


def run_all(
    pool: Pool,
    experiment: Experiment,
    progress: Progress = silent,
    enough: Callable[[Mapping[str, Answer[Run]]], bool] | None = None,
) -> Runs:
    """Run the FMU of a pool through an experiment.

    Where the plain runs are `enough`, only those of the sequences follow.
    """
    cases = [each.case for each in experiment.baseline]
    kinds = list(dict.fromkeys(invariant.run for invariant in experiment.runs))
    in_other_ways = list(product(cases, kinds))
    answers = pool.each(run_case, [(case,) for case in cases])
    plain: dict[str, Answer[Run]] = {}
    for done, case in enumerate(cases):
        progress(f"FMU: {case.id}", done, len(cases))
        plain[case.id] = next(answers)
    ends = enough is not None and enough(plain)
    random = {n: each for n, each in enumerate(experiment.random) if each.plain or not ends}
    questions = [] if ends else [(invariant,) for invariant in experiment.invariants.probes]
    runs = pool.each(other_run, [] if ends else in_other_ways)
    probes = pool.each(asked, questions, most=PROBE_LIMIT)
    drawn = [(each.baseline.case, each.manner.manner) for each in random.values()]
    in_manners = pool.each(run_case, drawn)
    others: dict[tuple[str, str], Answer[Run]] = {}
    for done, (case, kind) in enumerate(in_other_ways):
        progress(f"FMU in other runs: {case.id}", done // len(kinds), len(cases))
        others[case.id, kind] = next(runs, UNTRIED)
    complaints = {each.id: next(probes, UNTRIED) for each in experiment.invariants.probes}
    progress("FMU in random sequences", len(cases), len(cases))
    ran = [next(in_manners) if n in random else UNTRIED for n in range(len(experiment.random))]
    return Runs(experiment, plain, others, complaints, ran)


def repeat_failed(pool: Pool, runs: Runs) -> Runs:
    """Repeat a few runs that had no end, one by one: the second result decides."""
    plain, random = dict(runs.plain), list(runs.random)
    failed = [b.case for b in runs.experiment.baseline if plain[b.case.id].failure is not None]
    for case in failed[:MOST_REPEATED]:
        (plain[case.id],) = pool.each(run_case, [(case,)])
    broken = [n for n, answer in enumerate(random) if answer.failure is not None]
    for n in broken[:MOST_REPEATED]:
        test = runs.experiment.random[n]
        (random[n],) = pool.each(run_case, [(test.baseline.case, test.manner.manner)])
    return replace(runs, plain=plain, random=random)
