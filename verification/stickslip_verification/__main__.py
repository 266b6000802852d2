"""``python -m stickslip_verification``: what tests the suite itself, for those who work on it.

Its linter finds breaches of rules of the data files beyond their models, and names that are unused.
"""

import argparse
import json
import re
import sys
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from .drive.description import FmuError
from .drive.environments import PROBES
from .drive.exact import Exact, exact_motion, kept, spreads
from .drive.exchange import OPENED
from .drive.other_runs import RUNS
from .drive.solvers import SOLVERS
from .judge.accuracy import DIVERGED, Ruler
from .judge.metrics import METRICS
from .model.data_file import DataError
from .model.quantities import FORMULAS, QUANTITIES
from .model.verdict import KillMatrix, Klass, Measure, Verdict
from .report.html import write_report
from .run.verify import LONGEST_OF_ANY, verify
from .suite.cases import (
    CASES_FOLDER,
    FAMILY,
    Case,
    CaseError,
    CaseFile,
    load_case,
    load_cases,
    long_cases,
    meanings,
)
from .suite.faults import FaultFile, Mutant, MutantError, load_mutants
from .suite.invariants import InvariantError, Invariants, load_invariants
from .suite.sequences import COUNT
from .suite.tolerances import ZERO

THEORY = Path(__file__).parents[2] / "docs" / "theory.md"
"""Where the equations stand, in a working copy; an installed suite does not carry it."""
SHAPES: dict[str, Any] = {"case": CaseFile, "fault": FaultFile, "invariants": Invariants}
"""What the data files hold."""
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
    # The own outputs of laws are read where they are shown.
    quantities |= {name for name, each in QUANTITIES.items() if each.own}
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
    ruler = Ruler(kept(exact_motion, case), kept(spreads, case))
    runs = [solver.run(case) for solver in SOLVERS.values()]
    return [min(ruler.deviation(run).delta, DIVERGED) for run in runs]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; 0 if the suite is sound, 1 if not, 2 for wrong use."""
    parser = argparse.ArgumentParser(prog="python -m stickslip_verification", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    check = commands.add_parser("lint", help="check the data files of the suite")
    check.add_argument("--cases", type=Path, default=CASES_FOLDER, metavar="DIR")
    shown = commands.add_parser("schema", help="print the JSON schema of a data file, for editors")
    shown.add_argument("kind", choices=SHAPES)
    commands.add_parser("family", help="write the accuracy of honest solvers anew: ten minutes")
    tried = commands.add_parser("faults", help="plant faults in an FMU; all must be detected")
    tried.add_argument("fmu", type=Path, help="the FMU, which carries its Python source")
    tried.add_argument("fault", nargs="?", default="*", help="pattern of their ids, or FILE.toml")
    tried.add_argument("--whole", action="store_true", help="on every check, not the named ones")
    tried.add_argument("--cases", metavar="PATTERN", help="on these cases, without sequences")
    tried.add_argument(
        "--interface", choices=OPENED, default="cs", help="co-simulation, model exchange"
    )
    tried.add_argument("--jobs", type=int, help="parallel processes; default: one per processor")
    tried.add_argument("-o", dest="output", type=Path, metavar="DIR", help="folder of the report")
    chosen = parser.parse_args(arguments)
    try:
        if chosen.command == "lint":
            findings = lint(chosen.cases)
            print(*findings, f"{len(findings)} findings", sep="\n")
            return bool(findings)
        if chosen.command == "schema":
            print(json.dumps(TypeAdapter(SHAPES[chosen.kind]).json_schema(), indent=2))
            return 0
        if chosen.command == "family":
            write_family()
            return 0
        verdict = _planted(chosen)
    except (DataError, FmuError) as error:
        print(error, file=sys.stderr)
        return 2
    print(*_lines(verdict), sep="\n")
    return not verdict.passed


def _planted(chosen: argparse.Namespace) -> Verdict:
    cases = load_cases(chosen.cases)
    own = chosen.fault.endswith(".toml")
    verdict = verify(
        chosen.fmu,
        cases,
        interface=chosen.interface,
        jobs=chosen.jobs,
        sequences=0 if chosen.cases else COUNT,
        long_probes=not chosen.cases,
        mutants=load_mutants(files=Path(chosen.fault)) if own else load_mutants(chosen.fault),
        whole_matrix=chosen.whole,
    )
    if chosen.output is not None:
        write_report(verdict, chosen.output, meanings=meanings(cases, load_invariants()))
    return verdict


def _lines(verdict: Verdict) -> Iterator[str]:
    kills = verdict.kills
    assert isinstance(kills, KillMatrix)
    for row in kills.rows:
        if not row.caught:
            why = row.broken or f"failing checks: {', '.join(row.failing) or 'none'}"
            yield f"SURVIVED {row.mutant} (named: {', '.join(row.wanted)}): {why}"
    for check, reason in kills.kills_nothing.items():
        if not reason:
            yield f"UNUSED {check}: it detects no planted fault and has no reason to stay"
    for result in verdict.checks:
        if result.failed:
            yield f"FAIL {result.case or 'the FMU itself'} / {result.check} ({result.side})"
    caught = sum(row.caught for row in kills.rows)
    yield f"{caught} of {len(kills.rows)} planted faults detected by a check named in advance"


if __name__ == "__main__":
    sys.exit(main())
