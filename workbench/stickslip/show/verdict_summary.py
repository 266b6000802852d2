"""The verdict at a glance: one row per case, the kinds of truth, what failed and what it means."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from stickslip.show.fitted import Fitted, grid
from stickslip_verification import CheckResult, Meaning, Verdict, margin
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
