"""The fitness of an FMU over the cases, as tables of the verdict."""

from collections.abc import Sequence

from stickslip_verification.drive import workers
from stickslip_verification.judge.fitness import Fit, fits_of, tables_of, without_run
from stickslip_verification.model.verdict import Klass, Table
from stickslip_verification.run.baseline import Baseline, Progress
from stickslip_verification.run.judged import Answers


def fitness(
    baseline: Sequence[Baseline],
    answers: Answers,
    within: float,
    jobs: int,
    progress: Progress | None = None,
) -> list[Table]:
    """Compare what an FMU did in each case with the exact motion; see `judge.fitness`.

    Cases of conventions of the interface are left out.

    Parameters
    ----------
    baseline
        Of the cases.
    answers
        What the FMU did in them.
    within
        Part of the largest value of a case by which a quantity may be off.
    jobs
        How many processes may work at once.
    progress
        Counts the cases.
    """
    physics = [each for each in baseline if each.case.klass == Klass.PHYSICS]
    plain = {each.case.id: answers.plain[each.case.id] for each in physics}
    asked = [
        (each.case, each.exact.value, run)
        for each in physics
        if each.exact.value is not None and (run := plain[each.case.id].value) is not None
    ]
    found: list[Fit] = []
    for each in physics:
        answer = plain[each.case.id]
        if answer.value is None:
            found += without_run(each.case.id, answer)
    with workers.Pool(jobs) as pool:
        matched = pool.each(workers.matched, asked)
        for done, (case, exact, run) in enumerate(asked):
            if progress is not None:
                progress(f"fitness: {case.id}", done, len(asked))
            found += fits_of(case.id, exact, run, next(matched), within)
    return tables_of(found, within)
