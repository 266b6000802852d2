"""Writes the documents that are made from the code: run it with ``make docs``.

With ``--check`` it writes nothing, names those that are out of date, and exits 1 if there are any.
"""

import contextlib
import io
import sys
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

from stickslip_fmu.packer import build
from stickslip_fmu.variables import VARIABLES, Variable
from stickslip_verification import CheckResult, load_cases, verify

HERE = Path(__file__).parent


def main() -> None:
    """Write interface.md and verdict.md beside this file, or check them."""
    # What the FMU warns of belongs to its cases.
    with TemporaryDirectory() as folder, contextlib.redirect_stderr(io.StringIO()):
        texts = {
            "interface.md": document(interface()),
            "verdict.md": document(verdict(build(Path(folder)))),
        }
    if sys.argv[1:] == ["--check"]:
        old = [name for name, text in texts.items() if not is_current(HERE / name, text)]
        if old:
            sys.exit(f"out of date, run `make docs`: {', '.join(f'docs/{name}' for name in old)}")
        return
    for name, text in texts.items():
        (HERE / name).write_text(text, encoding="utf-8", newline="\n")


def is_current(file: Path, text: str) -> bool:
    """Tell whether the file is there and holds the text."""
    return file.is_file() and file.read_bytes() == text.encode()


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
    for row in VARIABLES:
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
    """Give the lines of the verdict page: the cases, and how many checks of each hold."""
    cases = load_cases()
    result = verify(fmu, cases)
    counts = result.summary
    yield "# The verdict"
    yield ""
    yield f"**{counts['passed']} passed, {counts['failed']} failed**, in {len(cases)} cases."
    yield ""
    yield "Each check holds the FMU and the reference against the exact solution in high precision."
    yield "`stickslip verify` prints every one with its truth, errors and tolerances; why each"
    yield "tolerance is what it is stands in the case file and in `report/report.json`."
    yield ""
    yield "| case | what | FMU | reference |"
    yield "|---|---|---|---|"
    for case in cases:
        of_case = [each for each in result.checks if each.case == case.id]
        sides = " | ".join(_holding(of_case, side) for side in ("fmu", "reference"))
        yield f"| `{case.id}` | {case.title} | {sides} |"


def _holding(checks: list[CheckResult], side: str) -> str:
    of_side = [each.passed for each in checks if each.side == side]
    return f"{sum(of_side)} of {len(of_side)}"


if __name__ == "__main__":
    main()
