"""The verdict as a table: one row per check, the FMU and the reference side by side."""

from collections.abc import Iterator, Sequence
from itertools import groupby

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from stickslip.show.fitted import Fitted, grid
from stickslip.show.verdict_summary import contract, counts, failure, word
from stickslip_verification import Case, CheckResult, Verdict, margin


def verdict_table(verdict: Verdict) -> RenderableType:
    """Make the table of all checks, what the failed ones mean, and the count.

    Where the line cannot hold all columns, each check has one line with the worst error of each
    side in units of its tolerance.
    """
    return Fitted(
        [_full_table(verdict.checks), _short_table(verdict.checks)],
        *(failure(result, because=True) for result in verdict.checks if result.failed),
        contract(verdict),
        counts(verdict),
    )


def _full_table(results: Sequence[CheckResult]) -> Table:
    # The sides share a row where their truth is one number: a check that looks at many places shows
    # each side at its own worst one.
    shared: dict[tuple[str, str, float | None], list[CheckResult]] = {}
    for result in results:
        shared.setdefault((result.case, result.check, result.expected), []).append(result)
    rows = []
    case = check = ""
    for row in shared.values():
        first = row[0]
        same_check = (first.case, first.check) == (case, check)
        quantity = first.quantity if first.unit == "1" else f"{first.quantity} [{first.unit}]"
        names = ("", "") if same_check else (first.check, quantity)
        rows.append(("" if first.case == case else first.case, *names, *_cells(row), word(row)))
        case, check = first.case, first.check
    pairs = ("error\nFMU", "error\nref.", "tol.\nFMU", "tol.\nref.")
    head = ("case", "check", "quantity", "truth", "FMU", "reference", *pairs, "verdict")
    return grid(head, rows, texts=(0, 1, 2, len(head) - 1), title="Verification")


def _cells(row: Sequence[CheckResult]) -> Iterator[str]:
    by_side = {result.side: result for result in row}
    pair = [by_side.get("fmu") or by_side.get("both"), by_side.get("reference")]
    yield _number(row[0].expected, ".6g")
    for name, form in (("got", ".6g"), ("error", ".1e"), ("tolerance", ".0e")):
        for result in pair:
            yield _number(getattr(result, name), form) if result else ""


def _short_table(results: Sequence[CheckResult]) -> Table:
    rows: list[tuple[Text | str, ...]] = []
    for case, of_case in groupby(results, lambda result: result.case):
        rows.append((Text(case, style="bold"),))
        checks: dict[str, list[CheckResult]] = {}
        for result in of_case:
            checks.setdefault(result.check, []).append(result)
        for check, row in checks.items():
            sides = (("fmu", "both"), ("reference",))
            ratios = (_worst([result for result in row if result.side in side]) for side in sides)
            rows.append((f" {check}", *ratios, word(row)))
    # Without edges the longest names of checks fit 60 characters.
    return grid(
        ("case\n check", "FMU", "ref.", "verdict"),
        rows,
        texts=(0, 3),
        title="Verification: worst error over tolerance",
        show_edge=False,
        padding=(0, 1, 0, 0),
    )


def _worst(row: Sequence[CheckResult]) -> str:
    """Write the largest error in units of its tolerance."""
    ratios = [margin(result.error, result.tolerance) for result in row]
    return _number(max(ratios), ".2g") if ratios else ""


def case_table(cases: Sequence[Case]) -> RenderableType:
    """Make the list of cases: id, number of checks and title."""
    rows = ((case.id, str(len(case.checks)), case.title) for case in cases)
    title = f"{len(cases)} cases"
    return Fitted([grid(("case", "checks", "what"), rows, texts=(0, 2), title=title)])


def _number(value: float | None, form: str) -> str:
    if value is None:
        return "–"
    return "0" if value == 0.0 else format(value, form)
