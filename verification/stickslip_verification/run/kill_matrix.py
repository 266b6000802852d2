"""The kill matrix: each planted fault must fail a check that was named in advance."""

import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from stickslip_verification.drive import workers
from stickslip_verification.drive.planting import plant
from stickslip_verification.model.verdict import CheckResult, Detection, KillMatrix
from stickslip_verification.run.comparisons import compare
from stickslip_verification.run.experiment import Experiment, Progress
from stickslip_verification.run.runs import Runs, run_all
from stickslip_verification.suite.faults import FAULTS_FOLDER, Mutant, MutantError

LONGEST = 100.0
"""Cases of more simulated time [s] are left out: a mutant that integrates would take minutes."""

_AT_ONCE = 40
"""Random sequences that a mutant is tried on before it is seen whether one detects it."""

TIME_LIMIT = 20.0
"""Seconds that a mutant may take for one run of a case."""


def detect(
    fmu: Path,
    mutants: Sequence[Mutant],
    experiment: Experiment,
    jobs: int,
    progress: Progress | None = None,
    *,
    whole: bool = True,
    **opened: Any,
) -> KillMatrix:
    """Plant each fault in the FMU, verify the mutant, and collect the checks that it fails.

    Checks that fail only by the time limit do not count. A mutant that does not finish a case for
    another reason fails the check of that alone, since nothing was compared. Cases of more than
    `LONGEST` are left out. `jobs` mutants are tried at once, each in a process of its own;
    `progress` counts them. ``opened`` are further arguments of `workers.Pool`.

    Each mutant is tried on every check where the matrix is to be `whole`; else on what its
    description foretells, case after case, and no further than the first such check that fails, and
    on everything only if none of them detects it. Idle checks are not known then.

    Raises
    ------
    MutantError
        No case is short enough.
    """
    short = [each for each in experiment.baseline if each.case.stop_time <= LONGEST]
    if not short:
        raise MutantError(
            FAULTS_FOLDER, "", f"no case is short enough to plant faults in: {LONGEST:g} s at most"
        )
    experiment = replace(experiment, baseline=short)
    rows: dict[str, Detection] = {}
    with (
        tempfile.TemporaryDirectory(prefix="stickslip-mutants-") as folder,
        ThreadPoolExecutor(workers.allowed(jobs)) as threads,
    ):
        futures = [
            threads.submit(_try, fmu, mutant, experiment, Path(folder), opened, whole=whole)
            for mutant in mutants
        ]
        try:
            for done, future in enumerate(as_completed(futures)):
                row = future.result()
                rows[row.mutant] = row
                if progress is not None:
                    progress(f"planted fault: {row.mutant}", done + 1, len(mutants))
        except BaseException:
            threads.shutdown(wait=False, cancel_futures=True)
            raise
    columns = list(_columns(experiment))
    killing = {check for row in rows.values() for check in row.failing}
    reasons = {invariant.id: invariant.stays for invariant in experiment.invariants}
    idle = {check: reasons.get(check, "") for check in columns if check not in killing}
    return KillMatrix(
        checks=columns,
        rows=[rows[mutant.id] for mutant in mutants],
        kills_nothing=idle if whole else {},
        whole=whole,
    )


def _try(
    fmu: Path,
    mutant: Mutant,
    experiment: Experiment,
    folder: Path,
    opened: Mapping[str, Any],
    *,
    whole: bool,
) -> Detection:
    failing: Mapping[str, int] = {}
    broken = None
    contract, wanted = experiment.contract, tuple(mutant.detected_by)
    try:
        planted = plant(fmu, mutant, folder)
    except MutantError as error:
        broken = str(error)
    else:
        pool = partial(
            workers.Pool,
            *(1, TIME_LIMIT, planted),
            hooks=mutant.hooks,
            own_starts=contract.interface,
            **opened,
        )
        # A numerical solution is judged over all cases, by what no fault names in advance.
        if not whole and not contract.numerical:
            with pool() as processes:
                failing, broken = _first_foretold(processes, wanted, experiment)
        if not failing and broken is None:
            with pool() as processes:
                runs = run_all(processes, experiment)
            failing = Counter(result.check for result in _failures(runs))
            if all(answer.value is None for answer in runs.plain.values()):
                first = next(iter(runs.plain.values()))
                broken = f"it finished no case: {first.failure}"
    return Detection(
        mutant=mutant.id,
        about=mutant.about,
        wanted=wanted,
        failing=dict(failing),
        caught=any(contract.numerical or check in wanted for check in failing),
        broken=broken,
    )


def _first_foretold(
    pool: workers.Pool, wanted: Sequence[str], experiment: Experiment
) -> tuple[Mapping[str, int], str | None]:
    """Return what fails first of the checks `wanted`: in one case, some sequences, or as a whole.

    The second value says why the mutant cannot be judged, or is None.
    """
    if not set(wanted) & set(_columns(experiment)):
        return {}, f"none of {', '.join(wanted)} is a check of these cases or of all runs"
    few = experiment.invariants.only(wanted)
    every_case = few.residuals or few.runs or few.agreements
    parts = [
        replace(
            experiment,
            baseline=[
                replace(each, invariants=[of for of in each.invariants if of in few.residuals])
            ],
            random=(),
        )
        for each in sorted(experiment.baseline, key=lambda each: len(each.case.steps))
        if every_case or any(check.id in wanted for check in each.case.checks)
    ]
    random = [test for test in experiment.random if test.manner in few.sequences]
    parts += [
        replace(experiment, baseline=(), random=random[n : n + _AT_ONCE])
        for n in range(0, len(random), _AT_ONCE)
    ]
    # The probes, about no case, are asked with the first one.
    for part in parts or [replace(experiment, baseline=(), random=())]:
        runs = run_all(pool, replace(part, invariants=few))
        failing = Counter(result.check for result in _failures(runs) if result.check in wanted)
        if failing:
            return failing, None
        late = next((answer for answer in runs.plain.values() if answer.late), None)
        if late is not None:
            return {}, f"it takes too long: {late.failure}"
        few = replace(few, probes=())
    return {}, None


def _failures(runs: Runs) -> Iterator[CheckResult]:
    """Yield the checks that failed for what the FMU did, and not for the time it took."""
    late = set(_late(runs))
    for result in compare(runs, reference=False):
        if result.failed and not late & {(result.case, ""), (result.case, result.check)}:
            yield result


def _late(runs: Runs) -> Iterator[tuple[str, str]]:
    """Yield what took too long: a case, and the invariant that asked for the run or ""."""
    yield from ((case, "") for case, answer in runs.plain.items() if answer.late)
    yield from (("", probe) for probe, answer in runs.probes.items() if answer.late)
    for invariant in runs.experiment.invariants.runs:
        for (case, run), answer in runs.others.items():
            if answer.late and invariant.run == run:
                yield case, invariant.id
    for test, answer in zip(runs.experiment.random, runs.random, strict=True):
        if answer.late:
            yield test.baseline.case.id, test.manner.id


def _columns(experiment: Experiment) -> Iterable[str]:
    """Return the checks that an FMU can fail, each once, in the order of the suite."""
    of_cases = (check.id for each in experiment.baseline for check in each.case.checks)
    of = experiment.invariants
    families = (of.residuals, of.runs, of.sequences, of.agreements, of.probes)
    of_invariants = (invariant.id for family in families for invariant in family)
    return dict.fromkeys((*of_cases, *of_invariants))
