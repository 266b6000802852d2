"""Lint of the suite: rules of its data files beyond their schemas, and names that are unused."""

import json
import re
import sys
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from stickslip_verification.drive import workers
from stickslip_verification.drive.exact import Exact, exact_motion, kept
from stickslip_verification.drive.other_runs import RUNS
from stickslip_verification.drive.probes.environments import PROBES
from stickslip_verification.drive.solvers import SOLVERS
from stickslip_verification.judge.accuracy import DIVERGED, Ruler
from stickslip_verification.judge.metrics import METRICS
from stickslip_verification.model.formulas import FORMULAS
from stickslip_verification.model.quantities import QUANTITIES
from stickslip_verification.model.verdict import Klass, Measure
from stickslip_verification.run.verify import LONGEST_OF_ANY
from stickslip_verification.suite.cases import (
    CASES_FOLDER,
    FAMILY,
    Case,
    CaseError,
    load_case,
    load_cases,
    long_cases,
)
from stickslip_verification.suite.faults import Mutant, MutantError, load_mutants
from stickslip_verification.suite.invariants import InvariantError, Invariants, load_invariants
from stickslip_verification.suite.tolerances import ZERO

THEORY = Path(__file__).parents[3] / "docs" / "theory.md"
"""Where the equations stand, in a working copy; an installed suite does not carry it."""
VAGUE = ("somehow", "good enough", "seems", "for now", "should work", "empirical", "tuned", "magic")
"""Words that are no reason."""
SHORTEST = 20  # characters below which a reason says nothing


def lint(folder: Path = CASES_FOLDER) -> list[str]:
    """Return the findings, one line each; none if the suite is sound.

    `folder` holds the cases; invariants and planted faults are those of the suite.
    """
    findings: list[str] = []
    cases = []
    for file in sorted(folder.glob("*.toml")):
        try:
            cases.append(load_case(file))
        except CaseError as error:
            findings.append(str(error))
    try:
        invariants, mutants = load_invariants(), load_mutants()
    except (InvariantError, MutantError) as error:
        return [*findings, str(error)]
    of_cases = (finding for case in cases for finding in _motion(case, kept(exact_motion, case)))
    of_names = _names(cases, invariants, mutants)
    return [*findings, *_ids(cases), *of_cases, *_reasons(cases, invariants), *of_names]


def _ids(cases: Sequence[Case]) -> Iterator[str]:
    counted = Counter(case.id for case in cases)
    yield from (f"{name}: {n} cases have this id" for name, n in counted.items() if n > 1)
    for case in cases:
        if case.file.stem != case.id:
            yield f"{case.file.name}: its id is {case.id!r}, not the name of the file"
    titles = Counter(case.title for case in cases)
    yield from (f"{n} cases have the title {name!r}" for name, n in titles.items() if n > 1)


def _motion(case: Case, exact: Exact) -> Iterator[str]:
    stated, happens = case.facts, exact.facts
    if stated is None:
        zero = {check.quantity for check in case.checks if check.because["fmu"] == ZERO}
        reversals = f", reversals = {happens.reversals}" if happens.reversals else ""
        zeros = f", zero = {json.dumps(sorted(zero))}" if zero else ""
        yield (
            f"{case.id}: motion is missing, so the exact motion is followed at each loading; "
            f"write motion = {{ slips = {happens.slips}{reversals}{zeros} }}"
        )
        return
    looked_at = {check.quantity for check in case.checks if check.measure == Measure.OF_SCALE}
    under_way = int(exact.record.outputs["mode"][-1] != 0)
    if not 0 <= stated.slips - happens.slips <= under_way:
        or_more = f" or {happens.slips + 1}" if under_way else ""
        yield f"{case.id}: motion.slips = {stated.slips}; it is {happens.slips}{or_more}"
    if stated.reversals != happens.reversals:
        yield f"{case.id}: motion.reversals = {stated.reversals}; it is {happens.reversals}"
    for name in sorted(stated.zero - happens.zero):
        yield f"{case.id}: motion.zero: {name} is not zero throughout"
    for name in sorted(happens.zero & looked_at):
        yield f"{case.id}: motion.zero: {name} is zero throughout and not named"


def _reasons(cases: Sequence[Case], invariants: Invariants) -> Iterator[str]:
    texts = {
        f"{case.id} / {check.id}: because.{side}": text
        for case in cases
        for check in case.checks
        for side, text in check.because.items()
    }
    for invariant in invariants:
        because = getattr(invariant, "because", {})
        sides = {"": because} if isinstance(because, str) else because
        texts |= {f"{invariant.id}: because {side}".rstrip(): text for side, text in sides.items()}
        names = ("means", "look", "stays") if invariant.stays else ("means", "look")
        texts |= {f"{invariant.id}: {name}": getattr(invariant, name) for name in names}
    for where, text in texts.items():
        if len(text) < SHORTEST:
            yield f"{where}: {text!r} says too little"
        for word in VAGUE:
            if re.search(rf"\b{word}\b", text, re.IGNORECASE):
                yield f"{where}: {word!r} is no reason"


def _names(
    cases: Sequence[Case], invariants: Invariants, mutants: Sequence[Mutant]
) -> Iterator[str]:
    """Yield names that nothing uses, and those that are used of what there is not."""
    checks = [check for case in cases for check in case.checks]
    quantities = {check.quantity for check in checks}
    quantities |= {agreement.quantity for agreement in invariants.agreements}
    quantities |= {order.quantity for order in invariants.orders}
    # What the designers' slip time is held against is the difference, not the formula itself.
    formulas = {check.formula for check in checks if check.formula} | {"half_period"}
    families: tuple[tuple[str, Collection[str], set[str]], ...] = (
        ("quantity", QUANTITIES, quantities),
        ("formula", FORMULAS, formulas),
        ("metric", METRICS, {invariant.metric for invariant in invariants.residuals}),
        ("run", RUNS, {invariant.run for invariant in invariants.runs}),
        ("probe", PROBES, {invariant.probe for invariant in invariants.probes}),
    )
    for what, known, used in families:
        yield from (f"{what} {name}: nothing uses it" for name in sorted(set(known) - used))
        yield from (f"{what} {name}: there is no such {what}" for name in sorted(used - set(known)))
    ids = {check.id for check in checks} | {invariant.id for invariant in invariants}
    of_cases = {case.id for case in cases}
    uses = [(order.id, "case", order.cases, of_cases) for order in invariants.orders]
    uses += [(f"planted fault {fault.id}", "check", fault.detected_by, ids) for fault in mutants]
    for user, what, names, there in uses:
        yield from (f"{user}: there is no {what} {name}" for name in names if name not in there)
    if THEORY.is_file():
        numbers = set(map(int, re.findall(r"\\tag\{(\d+)\}", THEORY.read_text(encoding="utf-8"))))
        sources = [(f"{case.id} / {of.id}", of.source) for case in cases for of in case.checks]
        sources += [(invariant.id, invariant.source) for invariant in invariants]
        for name, source in sources:
            if source not in numbers:
                yield f"{name}: docs/theory.md has no equation ({source})"


def write_family() -> None:
    """Write how accurate honest solvers are in each case; it takes ten minutes of a processor."""
    physics = [case for case in load_cases() if case.klass == Klass.PHYSICS]
    cases = [case for case in physics if case.stop_time <= LONGEST_OF_ANY]
    made = "`python -m stickslip_verification family` made it"
    lines = [
        f"# Delta of honest solvers in each case, for judge/accuracy.py; {made}.",
        "long = [",
        *(f'    "{name}",' for name in sorted(long_cases())),
        "]",
    ]
    lines += ["", "# A column for each of drive/solvers.py.", "[deltas]"]
    with ProcessPoolExecutor() as pool:
        for case, deltas in zip(cases, pool.map(_deltas, cases), strict=True):
            lines.append(f'"{case.id}" = [{", ".join(f"{delta:.1e}" for delta in deltas)}]')
            print(lines[-1], file=sys.stderr, flush=True)
    FAMILY.write_text("\n".join(lines) + "\n", "utf-8")


def _deltas(case: Case) -> list[float]:
    ruler = Ruler(workers.exact(case), workers.spreads(case))
    runs = [solver.run(case) for solver in SOLVERS.values()]
    return [min(ruler.deviation(run).delta, DIVERGED) for run in runs]
