"""The kill matrix: each planted fault must fail a check that was named in advance."""

import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, replace
from pathlib import Path

from stickslip_verification.drive import workers
from stickslip_verification.drive.fmu.names import NameMap
from stickslip_verification.drive.planting import plant
from stickslip_verification.judge.checks import EXACT_CONTRACT, Contract
from stickslip_verification.model.verdict import CheckResult, Detection, KillMatrix
from stickslip_verification.run.baseline import Baseline, Progress, Trial
from stickslip_verification.run.judged import Answers, ask, judge
from stickslip_verification.run.numerical import judge_numerical, judged
from stickslip_verification.suite.faults import FAULTS_FOLDER, Mutant, MutantError
from stickslip_verification.suite.invariants import Invariants

LONGEST = 100.0
"""Cases of more simulated time [s] are left out: a mutant that integrates would take minutes."""

_AT_ONCE = 40
"""Random sequences that a mutant is tried on before it is seen whether one detects it."""

TIME_LIMIT = 20.0
"""Seconds that a mutant may take for one run of a case."""


@dataclass(frozen=True)
class How:
    """How mutants are run and judged; the defaults are for our own FMU.

    Attributes
    ----------
    names, contract, fresh
        For a foreign FMU: the map to its names, how it is judged, and whether it lives only once in
        a process. What can be planted in it are faults in the calls of the master.
    whole
        Whether every mutant is tried on every check. Else it is tried on what its description
        foretells, case after case, and no further than the first such check that fails; only one
        that none of them detects is tried on everything. Idle checks are not known then.
    limits
        What each mutant may take.
    """

    names: NameMap | None = None
    contract: Contract = EXACT_CONTRACT
    fresh: bool = False
    whole: bool = True
    limits: workers.Limits = workers.USUAL


def detect(
    fmu: Path,
    mutants: Sequence[Mutant],
    baseline: Sequence[Baseline],
    invariants: Invariants,
    jobs: int,
    progress: Progress | None = None,
    how: How = How(),
    trials: Sequence[Trial] = (),
) -> KillMatrix:
    """Plant each fault in the FMU, verify the mutant, and collect the checks that it fails.

    Checks that fail only by the time limit do not count. A mutant that does not finish a case for
    another reason fails the check of that alone, since nothing was compared.

    Parameters
    ----------
    fmu
        The FMU without faults.
    mutants
        What to plant.
    baseline
        Of the cases to try; those of more than `LONGEST` are left out.
    invariants
        Of the suite.
    jobs
        How many mutants are tried at once, each in a process of its own.
    progress
        Counts the mutants.
    how
        How they are run and judged.
    trials
        Random sequences, each in its manner.

    Raises
    ------
    MutantError
        No case is short enough.
    """
    short = [each for each in baseline if each.case.stop_time <= LONGEST]
    if not short:
        raise MutantError(
            FAULTS_FOLDER, "", f"no case is short enough to plant faults in: {LONGEST:g} s at most"
        )
    rows: dict[str, Detection] = {}
    with (
        tempfile.TemporaryDirectory(prefix="stickslip-mutants-") as folder,
        ThreadPoolExecutor(workers.allowed(jobs)) as threads,
    ):
        futures = {
            threads.submit(_try, fmu, mutant, short, invariants, Path(folder), how, trials): mutant
            for mutant in mutants
        }
        try:
            for done, future in enumerate(as_completed(futures)):
                row = future.result()
                rows[row.mutant] = row
                if progress is not None:
                    progress(f"planted fault: {row.mutant}", done + 1, len(mutants))
        except BaseException:
            threads.shutdown(wait=False, cancel_futures=True)
            raise
    in_order = [rows[mutant.id] for mutant in mutants]
    columns = list(_columns(short, invariants))
    killing = {check for row in in_order for check in row.failing}
    reasons = {invariant.id: invariant.stays for invariant in invariants}
    kills_nothing = {check: reasons.get(check, "") for check in columns if check not in killing}
    return KillMatrix(
        checks=columns,
        rows=in_order,
        kills_nothing=kills_nothing if how.whole else {},
        whole=how.whole,
    )


def _try(
    fmu: Path,
    mutant: Mutant,
    baseline: Sequence[Baseline],
    invariants: Invariants,
    folder: Path,
    how: How,
    trials: Sequence[Trial],
) -> Detection:
    failing: Mapping[str, int] = {}
    broken = None
    wanted = tuple(mutant.detected_by)
    try:
        planted = plant(fmu, mutant, folder)
    except MutantError as error:
        broken = str(error)
    else:
        # A numerical solution is judged over all cases, by what no fault names in advance.
        if not how.whole and not how.contract.numerical:
            with _pool(planted, mutant, how) as pool:
                failing, broken = _first_foretold(
                    pool, wanted, baseline, invariants, how.contract, trials
                )
        if not failing and broken is None:
            with _pool(planted, mutant, how) as pool:
                answers = ask(pool, baseline, invariants, trials=trials)
            failing = _count(_failures(baseline, invariants, answers, how.contract, trials))
            if all(answer.value is None for answer in answers.plain.values()):
                first = next(iter(answers.plain.values()))
                broken = f"it finished no case: {first.failure}"
    return Detection(
        mutant=mutant.id,
        about=mutant.about,
        wanted=wanted,
        failing=failing,
        caught=any(how.contract.numerical or check in wanted for check in failing),
        broken=broken,
    )


def _pool(planted: Path, mutant: Mutant, how: How) -> workers.Pool:
    return workers.Pool(
        1,
        TIME_LIMIT,
        planted,
        how.names,
        fresh=how.fresh,
        hooks=mutant.hooks,
        own_starts=how.contract.interface,
        limits=how.limits,
    )


def _first_foretold(
    pool: workers.Pool,
    wanted: Sequence[str],
    baseline: Sequence[Baseline],
    invariants: Invariants,
    contract: Contract,
    trials: Sequence[Trial],
) -> tuple[Mapping[str, int], str | None]:
    """Return what fails first of the checks `wanted`: in one case, some sequences, or as a whole.

    The second value says why the mutant cannot be judged, or is None.
    """
    if not set(wanted) & set(_columns(baseline, invariants)):
        return {}, f"none of {', '.join(wanted)} is a check of these cases or of all runs"
    few = invariants.only(wanted)
    every_case = few.residuals or few.runs or few.agreements
    places: list[Sequence[Baseline]] = [
        [
            replace(
                each,
                invariants=[
                    invariant for invariant in each.invariants if invariant in few.residuals
                ],
            )
        ]
        for each in sorted(baseline, key=lambda each: len(each.case.steps))
        if every_case or any(check.id in wanted for check in each.case.checks)
    ]
    foretold = [trial for trial in trials if trial.manner in few.sequences]
    some: list[Sequence[Trial]] = [
        foretold[n : n + _AT_ONCE] for n in range(0, len(foretold), _AT_ONCE)
    ]
    # The probes, about no case, are asked beside the first one.
    for here, of_these in [*((place, ()) for place in places), *(([], part) for part in some)] or [
        ([], ())
    ]:
        answers = ask(pool, here, few, trials=of_these)
        found = _failures(here, few, answers, contract, of_these)
        failing = _count(result for result in found if result.check in wanted)
        if failing:
            return failing, None
        late = next((answer for answer in answers.plain.values() if answer.late), None)
        if late is not None:
            return {}, f"it takes too long: {late.failure}"
        few = replace(few, probes=())
    return {}, None


def _failures(
    baseline: Sequence[Baseline],
    invariants: Invariants,
    answers: Answers,
    contract: Contract,
    trials: Sequence[Trial],
) -> Iterator[CheckResult]:
    """Yield the checks that failed for what the FMU did, and not for the time it took."""
    late = set(_late(answers, invariants))
    late |= {
        (trial.baseline.case.id, trial.manner.id)
        for trial, answer in zip(trials, answers.sequences, strict=True)
        if answer.late
    }
    if contract.numerical:
        of_runs = judged(baseline, answers.plain)
        results = judge_numerical(of_runs, baseline, invariants, answers, contract, trials)
    else:
        results = judge(baseline, invariants, answers, contract, trials, reference=False)
    for result in results:
        if result.failed and not late & {(result.case, ""), (result.case, result.check)}:
            yield result


def _late(answers: Answers, invariants: Invariants) -> Iterator[tuple[str, str]]:
    """Yield what took too long: a case, and the invariant that asked for the run or ""."""
    yield from ((case, "") for case, answer in answers.plain.items() if answer.late)
    for (case, run), answer in answers.runs.items():
        if answer.late:
            yield from (
                (case, invariant.id) for invariant in invariants.runs if invariant.run == run
            )
    yield from (("", invariant) for invariant, answer in answers.probes.items() if answer.late)


def _count(results: Iterable[CheckResult]) -> Mapping[str, int]:
    return dict(Counter(result.check for result in results))


def _columns(baseline: Sequence[Baseline], invariants: Invariants) -> Iterable[str]:
    """Return the checks that an FMU can fail, each once, in the order of the suite."""
    of_cases = (check.id for each in baseline for check in each.case.checks)
    families = (
        invariants.residuals,
        invariants.runs,
        invariants.sequences,
        invariants.agreements,
        invariants.probes,
    )
    of_invariants = (invariant.id for family in families for invariant in family)
    return dict.fromkeys((*of_cases, *of_invariants))
