"""The suite as a whole: an FMU and the reference judged, faults planted, a verdict.

The kill matrix says of each planted fault whether a check that was named in advance fails, the
provenance where a verdict comes from: the FMU's bytes, versions, platform, revision of the source.
"""

import hashlib
import math
import platform
import subprocess
import tempfile
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, suppress
from dataclasses import replace
from datetime import UTC, datetime
from functools import partial
from importlib import metadata
from pathlib import Path
from typing import Any

from ..drive import exchange, processes
from ..drive.description import FmuError, NameMap, content_digest
from ..drive.environments import LONG_PROBES, OF_NUMERICAL
from ..drive.exact import Exact
from ..drive.instance import FmuFile, require
from ..drive.masters import NotApplicableError, fitting, law_of, may_change, require_law, setting_of
from ..judge import checks
from ..model.verdict import (
    CheckResult,
    ChosenContract,
    Detection,
    KillMatrix,
    Klass,
    Motion,
    Question,
    Table,
    Verdict,
)
from ..suite import sequences as drawing
from ..suite.cases import Case, long_cases
from ..suite.faults import FAULTS_FOLDER, Mutant, MutantError, carries_source, plant
from ..suite.invariants import Invariants, Manner, load_invariants
from ..truth import COULOMB, COULOMB_NAME, friction_law
from ..truth.parameters import CHANGEABLE, START_VALUES
from .comparisons import compare, compare_numerical, solution
from .experiment import (
    Baseline,
    Experiment,
    Progress,
    Runs,
    compute,
    random_tests,
    repeat_failed,
    run_all,
    silent,
)
from .questions import questions

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
    opener: Callable[..., FmuFile] = FmuFile,
    **limited: Any,
) -> KillMatrix:
    """Plant each fault in the FMU, verify the mutant, and collect the checks that it fails.

    Checks that fail only by the time limit do not count. A mutant that does not finish a case for
    another reason fails the check of that alone, since nothing was compared. Cases of more than
    `LONGEST` are left out; `MutantError` if no case is short enough. `jobs` mutants are tried at
    once, each in a process of its own; `progress` counts them. ``limited`` are further arguments of
    `processes.Pool`.

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
        ThreadPoolExecutor(processes.allowed(jobs)) as threads,
    ):

        def pool_of(mutant: Mutant) -> processes.Pool:
            planted, own = plant(fmu, mutant, Path(folder)), experiment.contract.interface
            opened = partial(opener, planted, hooks=mutant.hooks, own_starts=own)
            return processes.Pool(1, TIME_LIMIT, opened, **limited)

        for row in threads.map(lambda each: _try(each, experiment, pool_of, whole), mutants):
            rows.append(row)
            progress(f"planted fault: {row.mutant}", len(rows), len(mutants))
    columns = _columns(experiment)
    killing = {check for row in rows for check in row.failing}
    reasons = {invariant.id: invariant.stays for invariant in experiment.invariants}
    idle = {check: reasons.get(check, "") for check in columns if check not in killing}
    return KillMatrix(columns, rows, kills_nothing=idle if whole else {}, whole=whole)


def _try(
    mutant: Mutant, experiment: Experiment, pool_of: Callable[[Mutant], processes.Pool], whole: bool
) -> Detection:
    wanted, contract = mutant.detected_by, experiment.contract
    failing: Mapping[str, int] = {}
    broken = None
    try:
        # A numerical solution is judged over all cases, by what no fault names in advance.
        parts = [] if whole or contract.numerical else _foretold(mutant, experiment)
        with pool_of(mutant) as pool:
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


def gaps(
    sequences: Sequence[drawing.RandomSequence],
    scope: drawing.Scope,
    contract: checks.Contract,
    manners: Sequence[Manner],
) -> Iterator[CheckResult]:
    """Yield a failure of the suite where sequences that should fill the table leave cells empty."""
    empty = drawing.empty_cells(sequences, scope)
    if len(sequences) >= drawing.COUNT and empty and manners:
        cells = "; ".join(", ".join(cell) for cell in empty)
        failure = f"the suite itself: its random sequences have no {cells}"
        yield checks.of_invariant(manners[0], "", contract, failure=failure)


WITHIN = 1e-6  # what a numerical solution has to be within where nothing else is asked for
QUICK_SEQUENCES = 32  # random sequences where not everything is asked for
MOST_PERIODS = 2.0  # longest step of the cases that any FMU is tried on, in periods of the spring
OF_DIGITS = frozenset({"beyond-by-a-millionth", "just-above-critical"})
"""Cases that hang on digits which no numerical solution has."""
LONGEST_OF_ANY = 60.0
"""Simulated time [s] of the cases that any FMU is tried on; longer ones are for exact blocks, which
do not integrate, or are chosen by themselves."""


ASKED = (
    *("any-sequence", "mirror", "forces-scale", "time-scales", "shifted", "continued"),
    *("parameters-in-any-order", "load-before-mass", "coefficients-in-any-order"),
)
"""Invariants that are asked through model exchange too: those of the model. The others are about
communication steps, states and resets, or expect the same steps of a solver."""


def verify(
    fmu: Path,
    cases: Sequence[Case],
    progress: Progress = silent,
    *,
    names: NameMap | None = None,
    interface: exchange.Interface = "cs",
    contract: checks.Wanted | None = None,
    strict: bool = False,
    jobs: int | None = None,
    time_limit: float = processes.TIME_LIMIT,
    sequences: int = 0,
    seed: int = drawing.SEED,
    long_probes: bool = True,
    limits: processes.Limits = processes.USUAL,
    mutants: Sequence[Mutant] = (),
    whole_matrix: bool = True,
    within: float | None = None,
    full: bool = False,
    command: str | None = None,
) -> Verdict:
    """Judge an FMU, 2.0 or 3.0, and the reference.

    The FMU runs in processes of its own, so a script that calls this needs the guard ``if __name__
    == "__main__"``. `names` are our names to its, `cases` are tried as far as they are of its
    friction law, `progress` is called with what is being done, how much of it is done, and out of
    how much. For `contract` and `strict` see `chosen_contract`; it is that of physics, and `ASKED`
    is asked, through model exchange. `jobs` processes may work at once, None for one per processor.
    The FMU may take `time_limit` seconds for one run of a case, and `limits`.

    As many random `sequences` of a `seed` are tried as well; `suite.sequences.COUNT` fill the table
    of what can happen. Without `long_probes` the FMU does not meet those that take long: of memory,
    of a serialized state and of the environment in fresh processes, and a long run. `mutants` are
    faults to plant, as far as they are of the FMU's friction law, on every check with
    `whole_matrix` or on what they foretell; those that change the FMU need its Python source.

    Under the physics contract a quantity of the cycle may be off by the part `within` in any case,
    and an FMU meets everything if it is `full`, else what tells most: without the cases of a
    friction law that take long, and `QUICK_SEQUENCES` at most. `command` is for the provenance.

    `FmuError` if the file cannot be driven at all, lacks what every case or the friction law of one
    needs, or has no source for the faults; whatever else is wrong with the FMU is a failed check.
    `MutantError` if no fault is of the FMU's friction law, or no case is short enough.
    """
    if interface == "me" and (strict or contract == "exact"):
        raise ValueError("an FMU that is solved through model exchange meets the physics contract")
    opener = partial(exchange.OPENED[interface], names=names)
    _try_to_open(opener, fmu, time_limit, limits)
    with closing(opener(fmu)) as file:
        law = law_of(file)
        require(file, friction_law(law).lacks)
        cases = fitting(file, cases)
        for case in cases:
            require_law(file, case)
        mutants = _plantable(fmu, mutants, law)
        chosen = checks.chosen_contract(file, contract, strict=strict)
        if interface == "me":
            chosen = ChosenContract("physics", exchange.HOW)
        file.look_for(COULOMB.parameters, optional=True)
        grows = all(file.has(each.name) for each in COULOMB.parameters)
        origin = provenance(file, command)
        applying: set[str] = set()  # cases that it has all for
        for case in cases:
            with suppress(NotApplicableError):
                setting_of(file, case)
                applying.add(case.id)
        scope = drawing.Scope(
            frozenset(name for name in START_VALUES if file.has(name)),
            frozenset(name for name in CHANGEABLE if file.has(name) and may_change(file, name)),
        )
    held_to = replace(checks.CONTRACTS[chosen.name], solved=interface == "me")
    if held_to.numerical:
        cases = [case for case in cases if _of_any(case)] or cases
        if not full:
            cases = [case for case in cases if case.id not in long_cases()] or cases
            sequences = min(sequences, QUICK_SEQUENCES)
    invariants, laws = load_invariants(), {case.law for case in cases}
    invariants = invariants.only({i.id for i in invariants if any(map(i.holds_for, laws))})
    if held_to.numerical:
        # Deltas stand for what the samples say, and a run meets its like, not another to the bit.
        invariants = replace(invariants, residuals=[], agreements=[])
    else:
        invariants = _without(invariants, OF_NUMERICAL)
    if held_to.solved:
        invariants = invariants.only(ASKED)
    tried = of_faults = invariants
    if not long_probes:
        foretold = {check for mutant in mutants for check in mutant.detected_by}
        tried = _without(invariants, LONG_PROBES)
        of_faults = _without(invariants, LONG_PROBES, but=foretold)
    jobs = processes.jobs_here() if jobs is None else jobs
    apply_to = applying if held_to.numerical else None
    baseline = compute(cases, invariants, jobs, progress, numerical=apply_to)
    drawn = drawing.draw_sequences(seed, sequences if invariants.sequences else 0, scope)
    of_sequences = [each.case for each in drawn]
    if law != COULOMB_NAME:
        of_sequences, drawn = drawing.under_law(of_sequences, law, seed), []
    elif grows:
        of_sequences += drawing.with_dwell(of_sequences, seed)
    if held_to.numerical:
        # Their first changes become start values: which act at 0 s is a convention.
        for n, case in enumerate(of_sequences):
            first, *others = case.steps
            steps = (replace(first, changes={}), *others)
            parameters = {**case.parameters, **first.changes}
            of_sequences[n] = replace(case, parameters=parameters, steps=steps)
    random = random_tests(of_sequences, invariants.sequences, jobs, numerical=held_to.numerical)
    experiment = Experiment(baseline, tried, held_to, random)
    opened = partial(opener, fmu, own_starts=held_to.interface)
    limited: dict[str, Any] = {"fresh": file.once_per_process, "limits": limits}
    quick = held_to.numerical and not full
    enough = (lambda plain: solution(baseline, plain, held_to).certain) if quick else None
    with processes.Pool(jobs, time_limit, opened, **limited) as pool:
        runs = run_all(pool, experiment, progress, enough)
    with processes.Pool(1, time_limit, opened, **limited | {"fresh": True}) as pool:
        runs = repeat_failed(pool, runs)
    kills = None
    if mutants:
        experiment = replace(experiment, invariants=of_faults)
        how = limited | {"opener": opener, "whole": whole_matrix}
        kills = detect(fmu, mutants, experiment, jobs, progress, **how)
    tables: list[Table] = []
    answered: list[Question] = []
    if held_to.numerical:
        solved = solution(baseline, runs.plain, held_to)
        results = list(compare_numerical(runs, solved))
        answered, errors = questions(
            solved, results, runs, within or (exchange.WITHIN if held_to.solved else WITHIN)
        )
        tables.append(errors)
    else:
        results = list(compare(runs))
    results += gaps(drawn, scope, held_to, invariants.sequences)
    tables += [drawing.coverage_table(drawn, seed, scope)] if drawn else []
    return Verdict(
        checks=results,
        provenance=origin,
        motions=[_motion(runs, of, of.exact.value) for of in baseline if of.exact.value],
        orders=[of.value for each in baseline for _, of in each.orders if of.value is not None],
        kills=kills,
        contract=chosen,
        tables=tables,
        questions=answered,
    )


def _motion(runs: Runs, baseline: Baseline, exact: Exact) -> Motion:
    case = baseline.case
    sides = {"fmu": runs.plain[case.id].value, "reference": baseline.reference.value}
    ran = {name: run for name, run in sides.items() if run is not None}
    shown = (case.id, case.title, case.about, exact.record, exact.events)
    return Motion(*shown, records=ran, group=case.group)


def _plantable(fmu: Path, mutants: Sequence[Mutant], law: str) -> Sequence[Mutant]:
    """Return the faults of a friction law; refuse an FMU in which none can be planted."""
    of_law = [mutant for mutant in mutants if mutant.law == law]
    if mutants and not of_law:
        named = ", ".join(dict.fromkeys(mutant.law for mutant in mutants))
        reason = f"the fault is one of {named}; this FMU's law is {law}"
        raise MutantError(mutants[0].file, "law", reason)
    inside = next((mutant for mutant in of_law if mutant.changes_the_fmu), None)
    if inside is not None and not carries_source(fmu):
        raise FmuError(
            f"{fmu}: the fault {inside.id} changes the Python source of the block, which this "
            "FMU does not carry; faults in the calls can be planted in any FMU"
        )
    return of_law


def _of_any(case: Case) -> bool:
    """Whether a case is one for any solver: physics, not too long, in steps that can be cut."""
    period = 2.0 * math.pi * math.sqrt(case.start["m"] / case.start["k"])
    short = max(step.h for step in case.steps) <= MOST_PERIODS * period
    of_physics = case.klass == Klass.PHYSICS and case.id not in OF_DIGITS
    return of_physics and case.stop_time <= LONGEST_OF_ANY and short


def _without(
    invariants: Invariants, probes: Collection[str], but: Collection[str] = ()
) -> Invariants:
    kept = [each for each in invariants.probes if each.probe not in probes or each.id in but]
    return replace(invariants, probes=kept)


def _try_to_open(
    opener: Callable[..., FmuFile], fmu: Path, time_limit: float, limits: processes.Limits
) -> None:
    """Refuse an FMU whose description cannot be read within limits: here there are none."""
    time_limit = max(time_limit, processes.TIME_LIMIT)
    limits = processes.Limits(2.0 * time_limit, limits.memory)
    with processes.Pool(1, time_limit, partial(opener, fmu), limits=limits) as pool:
        (opened,) = pool.each(processes.open_fmu, [()])
    # What `FmuFile` refuses, it refuses here too.
    if opened.failure is not None and not opened.failure.startswith(FmuError.__name__):
        raise FmuError(f"{fmu}: its description cannot be read: {opened.failure}")


TRUST = (
    "The FMU ran in processes of the suite, and shares them with the code that drives it. One that "
    "means to deceive, a Python FMU above all, can rewrite what that code reports: this report "
    "finds errors, not fraud."
)
"""What a verdict is worth if an FMU is not honest."""

PACKAGES = ("stickslip", "numpy", "scipy", "mpmath", "fmpy", "pythonfmu")


def provenance(fmu: FmuFile, command: str | None = None) -> dict[str, Any]:
    """Gather the provenance of a run on `fmu`, as JSON values.

    ``command`` is what to type to get the same again, ``trust`` a sentence for the reader. ``git``
    is ``{"revision", "dirty"}`` of the working copy this package stands in, or None where there is
    none; a version is None where the package is not installed.
    """
    names = fmu.names.file
    with fmu.path.open("rb") as stream:
        sha256 = hashlib.file_digest(stream, "sha256").hexdigest()
    return {
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "fmu": {
            "file": fmu.path.name,
            "content": content_digest(fmu.path),
            "sha256": sha256,
            "fmi_version": fmu.fmi_version,
            "contract": fmu.stated.told,
            "names": None if names is None else names.name,
            "problems": list(fmu.problems),
        },
        "command": command,
        "trust": TRUST,
        "versions": {"python": platform.python_version()} | {p: _version(p) for p in PACKAGES},
        "platform": platform.platform(),
        "git": _git(Path(__file__).resolve().parents[2]),
    }


def _version(package: str) -> str | None:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def _git(parent: Path) -> dict[str, Any] | None:
    root = parent.parent
    # An installed copy may lie inside the working copy of some other project.
    if parent.name != "verification" or not (root / ".git").exists():
        return None
    command = ["git", "-C", str(root), "status", "--porcelain=v2", "--branch"]
    try:
        said = subprocess.run(command, capture_output=True, text=True, timeout=10, check=True)
    except (OSError, subprocess.SubprocessError):
        return None
    head, *others = said.stdout.splitlines()
    return {"revision": head.split()[-1], "dirty": any(line[0] != "#" for line in others)}
