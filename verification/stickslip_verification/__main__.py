"""``python -m stickslip_verification``: what tests the suite itself, for those who work on it."""

import argparse
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from stickslip_verification.drive.fmu.description import FmuError
from stickslip_verification.model.data_file import DataError
from stickslip_verification.model.verdict import KillMatrix, Verdict
from stickslip_verification.report.html import write_report
from stickslip_verification.run.lint import lint, write_family
from stickslip_verification.run.verify import verify
from stickslip_verification.suite.cases import CASES_FOLDER, load_cases, meanings
from stickslip_verification.suite.faults import load_mutants
from stickslip_verification.suite.invariants import load_invariants
from stickslip_verification.suite.sequences import COUNT


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; 0 if the suite is sound, 1 if not, 2 for wrong use."""
    parser = argparse.ArgumentParser(prog="python -m stickslip_verification", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    check = commands.add_parser("lint", help="check the data files of the suite")
    check.add_argument("--cases", type=Path, default=CASES_FOLDER, metavar="DIR")
    commands.add_parser("family", help="write the accuracy of honest solvers anew: ten minutes")
    tried = commands.add_parser("faults", help="plant faults in an FMU; all must be detected")
    tried.add_argument("fmu", type=Path, help="the FMU, which carries its Python source")
    tried.add_argument("fault", nargs="?", default="*", help="pattern of their ids, or FILE.toml")
    tried.add_argument("--whole", action="store_true", help="on every check, not the named ones")
    tried.add_argument("--cases", metavar="PATTERN", help="on these cases, without sequences")
    tried.add_argument("--jobs", type=int, help="parallel processes; default: one per processor")
    tried.add_argument("-o", dest="output", type=Path, metavar="DIR", help="folder of the report")
    chosen = parser.parse_args(arguments)
    try:
        if chosen.command == "lint":
            findings = lint(chosen.cases)
            print(*findings, f"{len(findings)} findings", sep="\n")
            return bool(findings)
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
