"""The verdict as a table: one row per check, the FMU and the reference side by side."""

from collections.abc import Iterator, Sequence
from typing import Final

from rich.box import SIMPLE_HEAD
from rich.console import RenderableType
from rich.constrain import Constrain
from rich.table import Table
from rich.text import Text

from stickslip.show.fitted import Fitted
from stickslip.show.verdict_summary import contract, counts
from stickslip_verification import Case, CheckResult, Verdict, margin

_PAIRS: Final = ("error\nFMU", "error\nref.", "tol.\nFMU", "tol.\nref.")


def verdict_table(verdict: Verdict, width: int | None = None) -> RenderableType:
    """Make the table of all checks, what the failed ones mean, and the count.

    Where the line cannot hold all columns, each check has one line with the worst error of each
    side in units of its tolerance.

    Parameters
    ----------
    verdict
        What came out.
    width
        Characters in a line; those of the console if None.
    """
    fitted = Fitted(
        [_full_table(verdict.checks), _short_table(verdict.checks)],
        *_failures(verdict.checks),
        contract(verdict),
        counts(verdict),
    )
    return fitted if width is None else Constrain(fitted, width)


def _full_table(results: Sequence[CheckResult]) -> Table:
    table = Table(title="Verification", title_justify="left", title_style="bold", box=SIMPLE_HEAD)
    for heading in ("case", "check", "quantity"):
        table.add_column(heading, no_wrap=True)
    for heading in ("truth", "FMU", "reference", *_PAIRS):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("verdict", no_wrap=True)
    case = check = ""
    for row in _rows(results):
        first = row[0]
        same_check = (first.case, first.check) == (case, check)
        quantity = first.quantity if first.unit == "1" else f"{first.quantity} [{first.unit}]"
        table.add_row(
            "" if first.case == case else first.case,
            *(("", "") if same_check else (first.check, quantity)),
            *_cells(row),
        )
        case, check = first.case, first.check
    return table


def _short_table(results: Sequence[CheckResult]) -> Table:
    # Without edges the longest names of checks fit 60 characters.
    table = Table(
        title="Verification: worst error over tolerance",
        title_justify="left",
        title_style="bold",
        box=SIMPLE_HEAD,
        show_edge=False,
        padding=(0, 1, 0, 0),
    )
    table.add_column("case\n check", overflow="fold")
    for heading in ("FMU", "ref."):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("verdict", no_wrap=True)
    checks: dict[tuple[str, str], list[CheckResult]] = {}
    for result in results:
        checks.setdefault((result.case, result.check), []).append(result)
    shown = ""
    for (case, check), row in checks.items():
        if case != shown:
            table.add_row(Text(case, style="bold"))
            shown = case
        sides = (("fmu", "both"), ("reference",))
        ratios = (_worst([r for r in row if r.side in each]) for each in sides)
        table.add_row(Text(f" {check}"), *ratios, _passed(row))
    return table


def _worst(row: Sequence[CheckResult]) -> str:
    """Write the largest error in units of its tolerance."""
    ratios = [margin(result.error, result.tolerance) for result in row]
    return _number(max(ratios), ".2g") if ratios else ""


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
    return Fitted([table])


def _rows(results: Sequence[CheckResult]) -> Iterator[list[CheckResult]]:
    """Yield the results that share a row: the sides of a check, where their truth is one number.

    A check that looks at many places shows each side at its own worst one.
    """
    rows: dict[tuple[str, str, float | None], list[CheckResult]] = {}
    for result in results:
        rows.setdefault((result.case, result.check, result.expected), []).append(result)
    yield from rows.values()


def _cells(row: list[CheckResult]) -> Iterator[str | Text]:
    by_side = {result.side: result for result in row}
    pair = [by_side.get("fmu") or by_side.get("both"), by_side.get("reference")]
    yield _number(row[0].expected, ".6g")
    for result in pair:
        yield _number(result.got, ".6g") if result else ""
    for result in pair:
        yield _number(result.error, ".1e") if result else ""
    for result in pair:
        yield _number(result.tolerance, ".0e") if result else ""
    yield _passed(row)


def _passed(row: Sequence[CheckResult]) -> Text:
    words = {result.verdict for result in row}
    if "fail" in words:
        return Text("FAIL", style="bold red")
    if "pass" in words:
        return Text("pass", style="green")
    return Text("noted" if "noted" in words else "n/a", style="yellow")


def _failures(results: Sequence[CheckResult]) -> Iterator[Text]:
    for result in results:
        if result.failed:
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
