"""The kill matrix: each planted fault must fail a check that was named in advance."""

import tempfile
from collections import Counter
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from stickslip_verification.drive import workers
from stickslip_verification.drive.planting import plant
from stickslip_verification.model.verdict import Detection, KillMatrix
from stickslip_verification.run.comparisons import compare
from stickslip_verification.run.experiment import Experiment, Progress, run_all, silent
from stickslip_verification.suite.faults import FAULTS_FOLDER, Mutant, MutantError

LONGEST = 100.0
"""Cases of more simulated time [s] are left out: a mutant that integrates would take minutes."""
_AT_ONCE = 40  # random sequences that a mutant is tried on before it is seen whether one detects it
TIME_LIMIT = 20.0  # seconds that a mutant may take for one run of a case


def detect(
    fmu: Path,
    mutants: Sequence[Mutant],
    experiment: Experiment,
    jobs: int,
    progress: Progress = silent,
    *,
    whole: bool = True,
    **opened: Any,
) -> KillMatrix:
    """Plant each fault in the FMU, verify the mutant, and collect the checks that it fails.

    Checks that fail only by the time limit do not count. A mutant that does not finish a case for
    another reason fails the check of that alone, since nothing was compared. Cases of more than
    `LONGEST` are left out; `MutantError` if no case is short enough. `jobs` mutants are tried at
    once, each in a process of its own; `progress` counts them. ``opened`` are further arguments of
    `workers.Pool`.

    Each mutant is tried on every check where the matrix is to be `whole`; else on what its
    description foretells, part by part up to the first such check that fails, and on everything
    only if none of them detects it. Idle checks are not known then.
    """
    short = [each for each in experiment.baseline if each.case.stop_time <= LONGEST]
    if not short:
        raise MutantError(
            FAULTS_FOLDER, "", f"no case is short enough to plant faults in: {LONGEST:g} s at most"
        )
    experiment = replace(experiment, baseline=short)
    rows: list[Detection] = []
    with (
        tempfile.TemporaryDirectory(prefix="stickslip-mutants-") as folder,
        ThreadPoolExecutor(workers.allowed(jobs)) as threads,
    ):
        fixed = (fmu, experiment, Path(folder), opened, whole)
        for row in threads.map(partial(_try, *fixed), mutants):
            rows.append(row)
            progress(f"planted fault: {row.mutant}", len(rows), len(mutants))
    columns = _columns(experiment)
    killing = {check for row in rows for check in row.failing}
    reasons = {invariant.id: invariant.stays for invariant in experiment.invariants}
    idle = {check: reasons.get(check, "") for check in columns if check not in killing}
    return KillMatrix(columns, rows, kills_nothing=idle if whole else {}, whole=whole)


def _try(
    fmu: Path,
    experiment: Experiment,
    folder: Path,
    opened: Mapping[str, Any],
    whole: bool,
    mutant: Mutant,
) -> Detection:
    wanted, contract = mutant.detected_by, experiment.contract
    failing: Mapping[str, int] = {}
    broken = None
    try:
        # A numerical solution is judged over all cases, by what no fault names in advance.
        parts = [] if whole or contract.numerical else _foretold(mutant, experiment)
        how = {"hooks": mutant.hooks, "own_starts": contract.interface, **opened}
        with workers.Pool(1, TIME_LIMIT, plant(fmu, mutant, folder), **how) as pool:
            for part in (*parts, experiment):
                runs = run_all(pool, part)
                # What fails for the time it took does not count.
                failures = [
                    of for of in compare(runs, reference=False) if of.failed and not of.late
                ]
                checks = [failure.check for failure in failures]
                plain = list(runs.plain.values())
                late = next((answer for answer in plain if answer.late), None)
                if part is experiment:
                    failing = Counter(checks)
                    if all(answer.value is None for answer in plain):
                        broken = f"it finished no case: {plain[0].failure}"
                elif failing := Counter(check for check in checks if check in wanted):
                    break
                elif late is not None:
                    broken = f"it takes too long: {late.failure}"
                    break
    except MutantError as error:
        broken = str(error)
    return Detection(
        mutant=mutant.id,
        about=mutant.about,
        wanted=wanted,
        failing=dict(failing),
        caught=any(contract.numerical or check in wanted for check in failing),
        broken=broken,
    )


def _foretold(mutant: Mutant, experiment: Experiment) -> list[Experiment]:
    """Split what a fault is foretold to fail into single cases and some sequences each.

    The probes, about no case, are asked with the first one.
    """
    wanted = mutant.detected_by
    if not set(wanted) & set(_columns(experiment)):
        reason = f"none of {', '.join(wanted)} is a check of these cases or of all runs"
        raise MutantError(mutant.file, mutant.id, reason)
    few = experiment.invariants.only(wanted)
    every_case = few.residuals or few.runs or few.agreements
    parts: list[dict[str, Any]] = [
        {"baseline": [replace(of, invariants=[i for i in of.invariants if i in few.residuals])]}
        for of in sorted(experiment.baseline, key=lambda baseline: len(baseline.case.steps))
        if every_case or any(check.id in wanted for check in of.case.checks)
    ]
    random = [test for test in experiment.random if test.manner in few.sequences]
    parts += [{"random": random[n : n + _AT_ONCE]} for n in range(0, len(random), _AT_ONCE)]
    nothing: dict[str, Any] = {"baseline": (), "random": ()}
    return [
        replace(experiment, invariants=replace(few, probes=() if n else few.probes), **nothing | of)
        for n, of in enumerate(parts or [nothing])
    ]


def _columns(experiment: Experiment) -> list[str]:
    """Return the checks that an FMU can fail, each once, in the order of the suite."""
    of_cases = (check.id for each in experiment.baseline for check in each.case.checks)
    of = experiment.invariants
    families = (of.residuals, of.runs, of.sequences, of.agreements, of.probes)
    of_invariants = (invariant.id for family in families for invariant in family)
    return list(dict.fromkeys((*of_cases, *of_invariants)))
