"""The verdict as a table: one row per check, the FMU and the reference side by side."""

from collections.abc import Iterator, Sequence
from typing import Final

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from stickslip_verification import Case, CheckResult, Verdict

_WIDE: Final = 140
"""Characters in a line that hold all columns."""

_PAIRS: Final = ("error\nFMU", "error\nref.", "tol.\nFMU", "tol.\nref.")


def verdict_table(verdict: Verdict, width: int) -> RenderableType:
    """Make the table of all checks, what the failed ones mean, and the count.

    Parameters
    ----------
    verdict
        What came out.
    width
        Characters in a line; where they are few, the names of the checks are left out.
    """
    table = Table(title="Verification", title_justify="left", title_style="bold", box=SIMPLE_HEAD)
    named = width >= _WIDE
    for heading in ("case", "check", "quantity") if named else ("case", "quantity"):
        table.add_column(heading, overflow="fold")
    for heading in ("truth", "FMU", "reference", *_PAIRS):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("verdict", no_wrap=True)
    case = check = ""
    for row in _rows(verdict.checks):
        first = row[0]
        same_check = (first.case, first.check) == (case, check)
        quantity = first.quantity if first.unit == "1" else f"{first.quantity} [{first.unit}]"
        names = (first.check, quantity) if named else (quantity,)
        table.add_row(
            "" if first.case == case else first.case,
            *(("",) * len(names) if same_check else names),
            *_cells(row),
        )
        case, check = first.case, first.check
    summary = verdict.summary
    count = f"{summary['passed']} passed, {summary['failed']} failed"
    style = "bold green" if verdict.passed else "bold red"
    return Group(table, *_failures(verdict.checks), Text(count, style=style))


def case_table(cases: Sequence[Case]) -> RenderableType:
    """Make the list of cases: id, number of checks and title."""
    table = Table(
        title=f"{len(cases)} cases", title_justify="left", title_style="bold", box=SIMPLE_HEAD
    )
    table.add_column("case", no_wrap=True)
    table.add_column("checks", justify="right")
    table.add_column("what")
    for case in cases:
        table.add_row(case.id, str(len(case.checks)), case.title)
    return table


def _rows(results: Sequence[CheckResult]) -> Iterator[list[CheckResult]]:
    """Give the results that share a row: the sides of a check, where their truth is one number.

    A check that looks at many places shows each side at its own worst one.
    """
    rows: dict[tuple[str, str, float | None], list[CheckResult]] = {}
    for result in results:
        rows.setdefault((result.case, result.check, result.expected), []).append(result)
    yield from rows.values()


def _cells(row: list[CheckResult]) -> Iterator[str | Text]:
    by_side = {result.side: result for result in row}
    pair = [by_side.get("fmu"), by_side.get("reference")]
    yield _number(row[0].expected, ".6g")
    for result in pair:
        yield _number(result.got, ".6g") if result else ""
    for result in pair:
        yield _number(result.error, ".1e") if result else ""
    for result in pair:
        yield _number(result.tolerance, ".0e") if result else ""
    passed = all(result.passed for result in row)
    yield Text("pass", style="green") if passed else Text("FAIL", style="bold red")


def _failures(results: Sequence[CheckResult]) -> Iterator[Text]:
    for result in results:
        if not result.passed:
            reason = result.failure or (
                f"got {result.got!r}, expected {result.expected!r} {result.unit}; "
                f"error {_number(result.error, '.2e')}, tolerance {result.tolerance:g}: "
                f"{result.because}"
            )
            yield Text(f"FAIL {result.case} / {result.check} ({result.side}): {reason}", "red")


def _number(value: float | None, form: str) -> str:
    if value is None:
        return "–"
    return "0" if value == 0.0 else format(value, form)
