"""Writes the documents that are made from the code: run it with ``make docs``.

With ``--check`` it writes nothing, names those that are out of date, and exits 1 if there are any.
"""

import contextlib
import io
import json
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from fmukit.table import Variable
from stickslip_design.claims import pages
from stickslip_fmu.packer import build
from stickslip_fmu.spec import TABLE
from stickslip_verification import (
    CheckResult,
    Meaning,
    load_cases,
    load_invariants,
    load_mutants,
    meanings,
    verify,
)
from stickslip_verification.model.verdict import Kind
from stickslip_verification.report.svg import differences
from stickslip_verification.suite.schemas import FILES

HERE = Path(__file__).parent

KINDS = {
    Kind.CLOSED_FORM: "the exact motion in high precision, and named closed forms",
    Kind.INVARIANT: "on the samples, energy, mirror, scaling, splitting, rollback, interface",
    Kind.CONVERGENCE: "the observed order of the reference, in its asymptotic range",
    Kind.CROSS_CODE: "the FMU against the reference: the weaker kind, alone it makes nothing green",
}


def main() -> None:
    """Write the documents beside this file, or check them."""
    # What the FMU warns of belongs to its cases.
    with TemporaryDirectory() as folder, contextlib.redirect_stderr(io.StringIO()):
        texts = {
            "interface.md": document(interface()),
            "verdict.md": document(verdict(build(Path(folder)))),
            "checks.md": document(checks()),
            **{f"schemas/{name}": text_of(schema) for name, schema in FILES.items()},
            **pages(),
        }
    if sys.argv[1:] == ["--check"]:
        if old := outdated(HERE, texts):
            sys.exit("\n".join(("out of date, run `make docs`:", *old)))
        return
    for name, text in texts.items():
        (HERE / name).parent.mkdir(exist_ok=True)
        (HERE / name).write_text(text, encoding="utf-8", newline="\n")


def outdated(folder: Path, texts: Mapping[str, str]) -> list[str]:
    """Return which files of a folder are missing or hold another text or picture, and where.

    Plots are compared by what they show: rounding may differ from machine to machine.
    """
    old = []
    for name, text in texts.items():
        file = folder / name
        if file.suffix == ".svg":
            old += differences(file, text)
        elif not file.is_file() or file.read_bytes() != text.encode():
            old.append(f"{file} holds another text")
    return old


def text_of(schema: Mapping[str, Any]) -> str:
    """Return a JSON schema as text."""
    return json.dumps(schema, indent=2) + "\n"


def document(lines: Iterator[str]) -> str:
    """Give the text of one document."""
    return "<!-- Made by `make docs`; do not edit. -->\n" + "\n".join(lines) + "\n"


def interface() -> Iterator[str]:
    """Give the lines of the interface page: the variable table."""
    yield "# The FMU's interface"
    yield ""
    yield "FMI 2.0 co-simulation, model identifier `StickSlip`. SI units; tools may show mm, mm/s"
    yield "and N/mm instead. Fixed parameters are set before the start, tunable ones and inputs at"
    yield "any time: they act from the next step on."
    yield ""
    yield "| variable | type | unit | causality | variability | start | range | what it is |"
    yield "|---|---|---|---|---|---|---|---|"
    for row in TABLE.rows:
        start = "" if row.start is None else f"{row.start:g}"
        cells = (
            f"`{row.name}`",
            row.kind,
            row.unit,
            row.causality,
            row.variability,
            start,
            _range(row),
            row.description,
        )
        yield "| " + " | ".join(cells) + " |"


def _range(row: Variable) -> str:
    if row.minimum is None:
        return ""
    if row.maximum is not None:
        return f"{row.minimum} … {row.maximum}"
    return "> 0" if row.minimum > 0 else "≥ 0"


def verdict(fmu: Path) -> Iterator[str]:
    """Give the lines of the verdict page: kinds of truth, cases, how many checks of each hold."""
    cases = load_cases()
    result = verify(fmu, cases)
    counts = result.summary
    yield "# The verdict"
    yield ""
    yield f"**{counts['passed']} passed, {counts['failed']} failed**, in {len(cases)} cases."
    yield ""
    yield "Code and solution verification, in the terms of ASME V&V 10: that the FMU and the"
    yield "reference solve the equations of [theory.md](theory.md), and how exactly. Whether these"
    yield "equations describe a machine is validation: it needs experiments and is not done here."
    yield ""
    yield "| kind of truth | what it is | passed | failed |"
    yield "|---|---|---|---|"
    for kind, of_kind in result.by_kind.items():
        yield f"| `{kind}` | {KINDS[kind]} | {of_kind['passed']} | {of_kind['failed']} |"
    yield ""
    yield "What each check means when it fails stands in [checks.md](checks.md). `stickslip verify`"
    yield "writes every comparison with its truth, error, tolerance and reason to"
    yield "`report/index.html`; `stickslip verify --mutants` tries the suite itself on"
    yield f"{len(load_mutants())} planted faults, each of which must fail a check named in advance."
    yield ""
    yield "| case | what | FMU | reference |"
    yield "|---|---|---|---|"
    for case in cases:
        of_case = [each for each in result.checks if each.case == case.id]
        sides = " | ".join(_holding(of_case, side) for side in ("fmu", "reference"))
        yield f"| `{case.id}` | {case.title} | {sides} |"
    of_fmu = [each for each in result.checks if not each.case]
    yield f"| | the FMU itself: what it declares, refuses and says | {_holding(of_fmu, 'fmu')} | |"


def checks() -> Iterator[str]:
    """Give the lines of the catalogue: what each check is, means, and where to look."""
    cases, invariants, faults = load_cases(), load_invariants(), load_mutants()
    known = meanings(cases, invariants)
    detected: dict[str, int] = {}
    for fault in faults:
        for check in fault.detected_by:
            detected[check] = detected.get(check, 0) + 1
    yield "# The checks"
    yield ""
    yield "What the failure of a check means, and where to look then. Checks of class `physics`"
    yield "have a tolerance and decide for every FMU; those of class `contract` decide for ours,"
    yield "and for a foreign one with `--strict`. The last column counts the planted faults that"
    yield "name the check as one which detects them."
    yield ""
    yield "## Invariants, tried on every case"
    yield ""
    yield "| check | statement | kind, class | (eq.) | it fails: this means | look at | faults |"
    yield "|---|---|---|---|---|---|---|"
    for invariant in invariants:
        cells = (
            f"`{invariant.id}`",
            invariant.title,
            f"{invariant.kind}, {invariant.klass}",
            f"({invariant.source})",
            invariant.means,
            invariant.look,
            str(detected.get(invariant.id, "")),
        )
        yield "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
    yield ""
    yield "## Checks of single cases"
    yield ""
    yield "Each holds one quantity against the exact motion (`-course`, at every communication"
    yield "point), or against a closed form."
    yield ""
    yield "| check | cases | it fails: this means | look at | faults |"
    yield "|---|---|---|---|---|"
    counted: dict[str, int] = {}
    for case in cases:
        for each in case.checks:
            counted[each.id] = counted.get(each.id, 0) + 1
    for check in sorted(counted):
        yield _catalogued(check, counted[check], known[check], detected.get(check))


def _catalogued(check: str, cases: int, meaning: Meaning, faults: int | None) -> str:
    cells = (f"`{check}`", str(cases), meaning.means, meaning.look, str(faults or ""))
    return "| " + " | ".join(cells) + " |"


def _holding(checks: list[CheckResult], side: str) -> str:
    of_side = [each.passed for each in checks if each.side == side]
    return f"{sum(of_side)} of {len(of_side)}"


if __name__ == "__main__":
    main()
