"""Runs of an FMU through an experiment: plain, in other ways, in random sequences; its probes."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from stickslip_verification.drive import workers
from stickslip_verification.drive.answer import Answer
from stickslip_verification.model.run import Run
from stickslip_verification.run.experiment import Experiment, Progress
from stickslip_verification.suite.sequences import PLAIN

UNTRIED: Answer[Run] = Answer(
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
    pool: workers.Pool,
    experiment: Experiment,
    progress: Progress | None = None,
    enough: Callable[[Mapping[str, Answer[Run]]], bool] | None = None,
) -> Runs:
    """Run the FMU of a pool through an experiment.

    Where the plain runs are `enough`, only those of the sequences follow.
    """
    cases = [each.case for each in experiment.baseline]
    invariants, random = experiment.invariants, experiment.random
    kinds = list(dict.fromkeys(invariant.run for invariant in invariants.runs))
    in_other_ways = [(case, kind) for case in cases for kind in kinds]
    answers = pool.each(workers.plain_run, [(case,) for case in cases])
    plain: dict[str, Answer[Run]] = {}
    for done, case in enumerate(cases):
        if progress is not None:
            progress(f"FMU: {case.id}", done, len(cases))
        plain[case.id] = next(answers)
    if enough is not None and enough(plain):
        ran = pool.each(
            workers.in_manner, [(each.baseline.case, PLAIN) for each in random if each.plain]
        )
        return Runs(
            experiment,
            plain,
            dict.fromkeys(((case.id, kind) for case, kind in in_other_ways), UNTRIED),
            {each.id: Answer(not_applicable=UNTRIED.not_applicable) for each in invariants.probes},
            [next(ran) if each.plain else UNTRIED for each in random],
        )
    runs = pool.each(workers.other_run, in_other_ways)
    probes = pool.each(
        workers.probe, [(invariant,) for invariant in invariants.probes], most=workers.PROBE_LIMIT
    )
    in_manners = pool.each(
        workers.in_manner, [(each.baseline.case, each.manner.manner) for each in random]
    )
    others: dict[tuple[str, str], Answer[Run]] = {}
    for done, (case, kind) in enumerate(in_other_ways):
        if progress is not None and done % len(kinds) == 0:
            progress(f"FMU in other runs: {case.id}", done // len(kinds), len(cases))
        others[case.id, kind] = next(runs)
    complaints = {invariant.id: next(probes) for invariant in invariants.probes}
    if progress is not None and random:
        progress("FMU in random sequences", len(cases), len(cases))
    return Runs(experiment, plain, others, complaints, list(in_manners))


def repeat_failed(pool: workers.Pool, runs: Runs) -> Runs:
    """Repeat a few runs that had no end, one by one: the second result decides."""
    plain, random = dict(runs.plain), list(runs.random)
    failed = [b.case for b in runs.experiment.baseline if plain[b.case.id].failure is not None]
    for case in failed[:MOST_REPEATED]:
        (plain[case.id],) = pool.each(workers.plain_run, [(case,)])
    broken = [n for n, answer in enumerate(random) if answer.failure is not None]
    for n in broken[:MOST_REPEATED]:
        test = runs.experiment.random[n]
        (random[n],) = pool.each(workers.in_manner, [(test.baseline.case, test.manner.manner)])
    return replace(runs, plain=plain, random=random)
