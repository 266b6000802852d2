"""The suite as a whole: an FMU and the reference judged, faults planted, a verdict."""

from collections.abc import Sequence
from pathlib import Path

from stickslip_verification.drive import workers
from stickslip_verification.drive.fmu.archive import FmuFile, require
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.fmu.names import NameMap
from stickslip_verification.drive.stepping import is_ours, require_law
from stickslip_verification.judge.checks import EXACT_CONTRACT, PHYSICS_CONTRACT, STRICT_CONTRACT
from stickslip_verification.judge.second_values import load_accepted
from stickslip_verification.model.verdict import Verdict
from stickslip_verification.report import provenance
from stickslip_verification.run.baseline import Progress, compute
from stickslip_verification.run.judged import ask, judge, motions
from stickslip_verification.run.kill_matrix import How, detect
from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.faults import Mutant
from stickslip_verification.suite.invariants import load_invariants


def verify(
    fmu: Path,
    cases: Sequence[Case],
    progress: Progress | None = None,
    *,
    names: NameMap | None = None,
    strict: bool = False,
    jobs: int | None = None,
    time_limit: float = workers.TIME_LIMIT,
    limits: workers.Limits = workers.USUAL,
    mutants: Sequence[Mutant] = (),
    whole_matrix: bool = True,
    command: str | None = None,
) -> Verdict:
    """Judge an FMU and the reference.

    The FMU runs in processes of its own, so a script that calls this needs the guard
    ``if __name__ == "__main__"``.

    Parameters
    ----------
    fmu
        The ``.fmu`` file, FMI 2.0 or 3.0 for co-simulation.
    cases
        What is tried, from `load_cases`.
    progress
        Called with what is being done, how much of it is done, and out of how much.
    names
        Our names to the FMU's; given, the FMU is judged as foreign.
    strict
        Hold a foreign FMU to the contract and to the tolerances of the exact block too.
    jobs
        How many processes may work at once; None for one per processor.
    time_limit
        Seconds that the FMU may take for one run of a case.
    limits
        What else the FMU may take; each planted fault has a budget of its own.
    mutants
        Faults to plant, to try the suite itself. Those that change the FMU are for ours only.
    whole_matrix
        Whether each fault is tried on every check, or on what it foretells alone.
    command
        What to type to get the same again, for the provenance.

    Raises
    ------
    FmuError
        The file cannot be driven at all, lacks what every case or the friction law of one needs,
        or is to carry planted faults and is not ours; whatever else the FMU does wrong is a failed
        check.
    MutantError
        Faults are to be planted, and no case is short enough.
    """
    _try_to_open(fmu, names, time_limit, limits)
    file = FmuFile(fmu, names)
    try:
        require(file)
        for case in cases:
            require_law(file, case)
        contract = (
            EXACT_CONTRACT if is_ours(file) else STRICT_CONTRACT if strict else PHYSICS_CONTRACT
        )
        inside = next((mutant for mutant in mutants if mutant.changes_the_fmu), None)
        if inside is not None and not contract.ours:
            raise FmuError(f"{fmu}: the fault {inside.id} can be planted in the exact block only")
        origin = provenance.collect(file, command)
    finally:
        file.close()
    invariants = load_invariants().of_laws({case.law for case in cases})
    jobs = workers.jobs_here() if jobs is None else jobs
    baseline = compute(cases, invariants, jobs, progress)
    fresh = file.once_per_process
    with workers.Pool(jobs, time_limit, fmu, names, fresh=fresh, limits=limits) as pool:
        answers = ask(pool, baseline, invariants, progress)
    kills = None
    if mutants:
        how = How(names, contract, fresh=fresh, whole=whole_matrix, limits=limits)
        kills = detect(fmu, mutants, baseline, invariants, jobs, progress, how)
    return Verdict(
        checks=load_accepted().attach(
            judge(baseline, invariants, answers, contract), fmu=contract.ours
        ),
        provenance=origin,
        motions=list(motions(baseline, answers)),
        orders=[
            seen.value for each in baseline for _, seen in each.orders if seen.value is not None
        ],
        kills=kills,
        ours=contract.ours,
    )


def _try_to_open(
    fmu: Path, names: NameMap | None, time_limit: float, limits: workers.Limits
) -> None:
    """Refuse an FMU whose description cannot be read within limits: here there are none."""
    time_limit = max(time_limit, workers.TIME_LIMIT)
    limits = workers.Limits(2.0 * time_limit, limits.memory)
    with workers.Pool(1, time_limit, fmu, names, limits=limits) as pool:
        (opened,) = pool.each(workers.open_fmu, [()])
    if opened.failure is not None:
        raise FmuError(f"{fmu}: its description cannot be read: {opened.failure}")
