"""The verdict at a glance: one row per case, the kinds of truth, what failed and what it means."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from rich.box import SIMPLE_HEAD
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from stickslip.show.fitted import Fitted
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

    Parameters
    ----------
    verdict
        What came out.
    meanings
        For a check, what its failure means.
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
    table = Table(title="Verification", title_justify="left", title_style="bold", box=SIMPLE_HEAD)
    table.add_column("case", no_wrap=True)
    for heading in ("FMU", "reference"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("of tolerance" if worst else "of tol.", justify="right", no_wrap=True)
    if worst:
        table.add_column("nearest to its tolerance", no_wrap=True)
    table.add_column("verdict", no_wrap=True)
    cases: dict[str, list[CheckResult]] = {}
    for result in verdict.checks:
        drawn = result.case.startswith(SEQUENCE)
        cases.setdefault(SEQUENCE if drawn else result.case, []).append(result)
    sequences = f"{len(verdict.sequences)} random sequences"
    for case, results in cases.items():
        nearest = max((r for r in results if r.decides), key=_margin, default=results[0])
        table.add_row(
            sequences if case == SEQUENCE else case or "the FMU itself",
            *(_holding([r for r in results if r.side == side]) for side in _SIDES),
            f"{_margin(nearest):.2g}",
            *([nearest.check if _margin(nearest) > 0.0 else ""] if worst else []),
            _word(results),
        )
    return table


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


def _word(results: Sequence[CheckResult]) -> Text:
    words = {result.verdict for result in results}
    if "fail" in words:
        return Text("FAIL", style="bold red")
    if words == {"not applicable"}:
        return Text("not applicable", style="dim")
    return Text("noted", style="yellow") if "noted" in words else Text("pass", style="green")


def _kinds(verdict: Verdict) -> Table:
    table = Table(box=SIMPLE_HEAD)
    for heading in ("kind of truth", "what"):
        table.add_column(heading, overflow="fold")
    for heading in ("passed", "failed"):
        table.add_column(heading, justify="right", no_wrap=True)
    for kind, of_kind in verdict.by_kind.items():
        table.add_row(kind, _KINDS[kind], str(of_kind["passed"]), str(of_kind["failed"]))
    return table


def _failures(verdict: Verdict, meanings: Mapping[str, Meaning]) -> Iterator[Text]:
    failed = [result for result in verdict.checks if result.failed]
    told: set[str] = set()
    for result in failed[:_TOLD]:
        yield Text(f"FAIL {_name(result)}: {_what(result)}", "red")
        meaning = meanings.get(result.check)
        if meaning is not None and result.check not in told:
            told.add(result.check)
            yield Text(f"     {meaning.means} Likeliest bug: {meaning.look}")
    if len(failed) > _TOLD:
        yield Text(f"and {len(failed) - _TOLD} more; the report lists them all", "red")


def _name(result: CheckResult) -> str:
    return f"{result.case or 'the FMU itself'} / {result.check} ({result.side})"


def _what(result: CheckResult) -> str:
    if result.failure is not None:
        return result.failure
    return (
        f"got {result.got!r}, expected {result.expected!r} {result.unit}; "
        f"error {result.error:.2e}, tolerance {result.tolerance:g}"
    )
