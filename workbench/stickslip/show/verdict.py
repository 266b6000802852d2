"""The verdict on an FMU at a glance, and as a table.

At a glance: one row per case, the kinds of truth, what failed and what it means. As a table: one
row per check, the FMU and the reference side by side.
"""

from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from typing import Final

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from stickslip.show.tables import Fitted, grid
from stickslip_verification import Case, CheckResult, Meaning, Verdict, margin
from stickslip_verification.model.verdict import SEQUENCE, Kind

_KINDS: Final[dict[str, str]] = {
    Kind.CLOSED_FORM: "exact motion and closed forms",
    Kind.INVARIANT: "samples, pairs of runs, interface",
    Kind.CONVERGENCE: "observed order of the reference",
    Kind.CROSS_CODE: "FMU against reference: the weaker kind, it alone gives no pass",
}
_SIDES: Final = ("fmu", "reference")
_TOLD: Final = 12
"""How many failed checks are printed in full; the report lists all."""


def verdict_summary(verdict: Verdict, meanings: Mapping[str, Meaning]) -> RenderableType:
    """Make the tables of cases and of kinds of truth, the failures, and the count.

    `meanings` say what a failure of a check means.
    """
    return Fitted(
        [_cases(verdict, worst=True), _cases(verdict, worst=False)],
        _kinds(verdict),
        *_failures(verdict, meanings),
        contract(verdict),
        *(Text(each.answer, "green" if each.good else "bold red") for each in verdict.questions),
        counts(verdict),
    )


def contract(verdict: Verdict) -> Text:
    """Say in one line which contract the FMU is held to, and why."""
    return Text(f"contract: {verdict.contract.name} ({verdict.contract.why})")


def counts(verdict: Verdict) -> Text:
    """Say in one line how many checks passed, failed, were noted or did not apply."""
    summary = verdict.summary
    line = f"{summary['passed']} passed, {summary['failed']} failed"
    if summary["noted"]:
        line += f", {summary['noted']} noted (contract: it decides with --strict)"
    if summary["not_applicable"]:
        line += f", {summary['not_applicable']} not applicable"
    if not verdict.passed and not summary["failed"]:
        line += "; NOT GREEN: " + _why(verdict)
    return Text(line, style="bold green" if verdict.passed else "bold red")


def _why(verdict: Verdict) -> str:
    if verdict.proven:
        right = any(each.good for each in verdict.questions[:1])
        return "right, but not as accurate as asked" if right else "it is not what was asked for"
    return "no check of the FMU against the exact solution or an invariant passed"


def _cases(verdict: Verdict, *, worst: bool) -> Table:
    cases: dict[str, list[CheckResult]] = {}
    for result in verdict.checks:
        drawn = result.case.startswith(SEQUENCE)
        cases.setdefault(SEQUENCE if drawn else result.case, []).append(result)
    names = {SEQUENCE: f"{len(verdict.sequences)} random sequences", "": "the FMU itself"}
    rows = []
    for case, results in cases.items():
        nearest = max((r for r in results if r.decides), key=_margin, default=results[0])
        rows.append(
            (
                names.get(case, case),
                *(_holding([r for r in results if r.side == side]) for side in _SIDES),
                f"{_margin(nearest):.2g}",
                *([nearest.check if _margin(nearest) > 0.0 else ""] if worst else []),
                word(results),
            )
        )
    how = ("of tolerance", "nearest to its tolerance") if worst else ("of tol.",)
    head = ("case", "FMU", "reference", *how, "verdict")
    return grid(head, rows, texts=(0, *range(4, len(head))), title="Verification")


def _margin(result: CheckResult) -> float:
    """Return error over tolerance; 0 where the check does not apply."""
    if result.not_applicable is not None:
        return 0.0
    return margin(result.error, result.tolerance)


def _holding(results: Sequence[CheckResult]) -> str:
    applying = [result for result in results if result.not_applicable is None]
    if not applying:
        return "–"
    return f"{sum(result.passed for result in applying)} of {len(applying)}"


def word(results: Sequence[CheckResult]) -> Text:
    """Say in a word what results come to: one failure fails them."""
    words = {result.verdict for result in results}
    styles = {"fail": "bold red", "noted": "yellow", "pass": "green", "not applicable": "dim"}
    said = next(each for each in styles if each in words)
    return Text("FAIL" if said == "fail" else said, style=styles[said])


def _kinds(verdict: Verdict) -> Table:
    rows = (
        (kind, _KINDS[kind], str(of["passed"]), str(of["failed"]))
        for kind, of in verdict.by_kind.items()
    )
    return grid(("kind of truth", "what", "passed", "failed"), rows, texts=(0, 1))


def _failures(verdict: Verdict, meanings: Mapping[str, Meaning]) -> Iterator[Text]:
    failed = [result for result in verdict.checks if result.failed]
    explained: set[str] = set()
    for result in failed[:_TOLD]:
        yield failure(result)
        meaning = meanings.get(result.check)
        # A run without an end is a sign of nothing.
        if meaning is not None and not result.late and result.check not in explained:
            explained.add(result.check)
            yield Text(f"     {meaning.means} Likeliest bug: {meaning.look}")
    if len(failed) > _TOLD:
        yield Text(f"and {len(failed) - _TOLD} more; the report lists them all", "red")


def failure(result: CheckResult, *, because: bool = False) -> Text:
    """Say what failed and by how much, with the reason of the tolerance if `because`."""
    what = result.failure or (
        f"got {result.got!r}, expected {result.expected!r} {result.unit}; "
        f"error {result.error:.2e}, tolerance {result.tolerance:g}"
        + (f": {result.because}" if because else "")
    )
    where = f"{result.case or 'the FMU itself'} / {result.check} ({result.side})"
    return Text(f"FAIL {where}: {what}", "red")


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
            worst = []
            for sides in (("fmu", "both"), ("reference",)):
                ratios = [margin(each.error, each.tolerance) for each in row if each.side in sides]
                worst.append(_number(max(ratios), ".2g") if ratios else "")
            rows.append((f" {check}", *worst, word(row)))
    # Without edges the longest names of checks fit 60 characters.
    return grid(
        ("case\n check", "FMU", "ref.", "verdict"),
        rows,
        texts=(0, 3),
        title="Verification: worst error over tolerance",
        show_edge=False,
        padding=(0, 1, 0, 0),
    )


def case_table(cases: Sequence[Case]) -> RenderableType:
    """Make the list of cases: id, friction law, number of checks and title."""
    rows = ((case.id, case.law, str(len(case.checks)), case.title) for case in cases)
    title = f"{len(cases)} cases"
    names = ("case", "friction law", "checks", "what")
    return Fitted([grid(names, rows, texts=(0, 1, 3), title=title)])


def _number(value: float | None, form: str) -> str:
    if value is None:
        return "–"
    return "0" if value == 0.0 else format(value, form)
