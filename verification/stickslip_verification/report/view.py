"""The verdict as the page shows it: cases in order, rows as text, reasons as numbered notes."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from stickslip_verification.model.margins import error_text, margin_of, value_text
from stickslip_verification.model.verdict import CheckResult, Kind, Motion, Outcome, Verdict, count
from stickslip_verification.report.words import KINDS, MEASURES, SIDES, what_happened
from stickslip_verification.suite.catalogue import Meaning

NEAREST = 10
"""How many margins page one names."""

SHOWN_PER_CASE = 16
"""Beside what failed, how many comparisons of a case the compact form shows."""

SHOWN_PER_CHECK = 5
"""How many of the cases in which a check failed page one names."""


@dataclass(frozen=True)
class Row:
    """One comparison as text; ``note`` is the number of its reason, ``anchor`` "" if unlinked."""

    anchor: str
    check: str
    side: str
    quantity: str
    expected: str
    got: str
    error: str
    tolerance: str
    measure: str
    margin: str
    note: int
    verdict: str
    story: str


@dataclass(frozen=True)
class Group:
    """The comparisons of a case with one kind of truth; ``rows`` may show fewer than ``total``."""

    kind: str
    name: str
    rows: Sequence[Row]
    total: int


@dataclass(frozen=True)
class CaseView:
    """One case: its rows by kind of truth, the reasons of its tolerances, its plot or ""."""

    anchor: str
    id: str
    title: str
    about: str
    counts: Mapping[str, int]
    worst: str
    groups: Sequence[Group]
    notes: Sequence[str]
    plot: str

    @property
    def failed(self) -> bool:
        """Whether anything in it failed."""
        return self.counts["failed"] > 0


@dataclass(frozen=True)
class TableView:
    """A table as text; ``numbers`` tells of each column whether it holds numbers alone."""

    anchor: str
    title: str
    about: str
    head: Sequence[str]
    numbers: Sequence[bool]
    rows: Sequence[Sequence[str]]
    note: str


@dataclass(frozen=True)
class Place:
    """A result to be pointed at: where it is, and what is said of it."""

    anchor: str
    case: str
    check: str
    side: str
    text: str


@dataclass(frozen=True)
class FailedCheck:
    """A check that failed somewhere: what that means, the worst places, how many there are."""

    check: str
    kind_name: str
    meaning: Meaning | None
    places: Sequence[Place]
    total: int
    noted: bool


def case_views(
    verdict: Verdict, plots: Mapping[str, str], linked: frozenset[int], *, compact: bool = False
) -> list[CaseView]:
    """Return the cases, those with failures first, else in the order of the run.

    ``linked`` has the numbers of the results that something on the page points at. In the
    ``compact`` form a case shows, beside what failed or is noted or linked, only the comparison of
    each quantity that is nearest to its tolerance, and `SHOWN_PER_CASE` of them at most.
    """
    motions = {motion.case: motion for motion in verdict.motions}
    cases: dict[str, list[tuple[int, CheckResult]]] = {}
    for number, result in enumerate(verdict.checks):
        cases.setdefault(result.case, []).append((number, result))
    views = [
        _case_view(
            case,
            results,
            motions.get(case),
            plots.get(case, ""),
            linked,
            _chosen(results, linked) if compact else {number for number, _ in results},
        )
        for case, results in cases.items()
    ]
    return sorted(views, key=lambda view: not view.failed)


def failed_checks(
    verdict: Verdict,
    meanings: Mapping[str, Meaning],
    words: Sequence[str] = (Outcome.FAIL, Outcome.DRIFT),
) -> list[tuple[FailedCheck, list[int]]]:
    """Return each check with a verdict among `words`, the most frequent first.

    With each come the numbers of the results that it names.
    """
    checks: dict[str, list[tuple[int, CheckResult]]] = {}
    for number, result in enumerate(verdict.checks):
        if result.verdict in words:
            checks.setdefault(result.check, []).append((number, result))
    views = []
    for check, found in checks.items():
        worst = sorted(found, key=lambda each: -(margin_of(each[1]) or 0.0))[:SHOWN_PER_CHECK]
        first = found[0][1]
        view = FailedCheck(
            check=check,
            kind_name=KINDS.get(first.truth, first.truth),
            meaning=meanings.get(check),
            places=[_place(number, result, what_happened(result)) for number, result in worst],
            total=len(found),
            noted=first.verdict == Outcome.NOTED,
        )
        views.append((view, [number for number, _ in worst]))
    return sorted(views, key=lambda each: -each[0].total)


def nearest(verdict: Verdict) -> list[tuple[Place, int]]:
    """Return the passed results that use most of their tolerance, and their numbers."""
    passed = [(n, r) for n, r in enumerate(verdict.checks) if r.verdict == Outcome.PASS]
    worst = sorted(passed, key=lambda each: -(margin_of(each[1]) or 0.0))[:NEAREST]
    return [
        (_place(n, r, error_text(margin_of(r))), n) for n, r in worst if (margin_of(r) or 0.0) > 0.0
    ]


def second_values(verdict: Verdict) -> dict[str, int]:
    """Count the second values: held and drifted."""
    seconds = [result.second for result in verdict.checks if result.second is not None]
    drifted = sum(second.drifted for second in seconds)
    return {"held": len(seconds) - drifted, "drifted": drifted}


def table_views(verdict: Verdict) -> list[TableView]:
    """Return the tables of a verdict as text; a column is of numbers where all its cells are."""
    return [
        TableView(
            anchor=f"table-{number}",
            title=table.title,
            about=table.about,
            head=table.head,
            numbers=[
                all(isinstance(row[column], int | float) for row in table.rows)
                for column in range(len(table.head))
            ],
            rows=[[_cell(cell) for cell in row] for row in table.rows],
            note=table.note,
        )
        for number, table in enumerate(verdict.tables)
    ]


def _cell(cell: str | float) -> str:
    return cell if isinstance(cell, str) else value_text(cell)


def case_name(case: str) -> str:
    """Name a case; the empty one holds what is checked on the FMU and not on a motion."""
    return case or "the FMU itself"


def _place(number: int, result: CheckResult, text: str) -> Place:
    side = SIDES.get(result.side, result.side)
    return Place(f"r{number}", case_name(result.case), result.check, side, text)


def _case_view(
    case: str,
    results: Sequence[tuple[int, CheckResult]],
    motion: Motion | None,
    plot: str,
    linked: frozenset[int],
    chosen: set[int],
) -> CaseView:
    notes: dict[str, int] = {}
    groups: dict[str, list[Row]] = {}
    totals: Counter[str] = Counter(result.truth for _, result in results)
    for number, result in sorted(results, key=lambda each: _rank(each[1].truth)):
        if number not in chosen:
            continue
        note = notes.setdefault(result.because, len(notes) + 1)
        row = _row(result, note, f"r{number}" if number in linked else "")
        groups.setdefault(result.truth, []).append(row)
    return CaseView(
        anchor=f"case-{case or 'fmu'}",
        id=case_name(case),
        title=motion.title if motion else "" if case else "what it promises, whatever it moves",
        about=" ".join(motion.about.split()) if motion else "",
        counts=count([result for _, result in results]),
        worst=_worst([result for _, result in results]),
        groups=[
            Group(kind, _group_name(kind), rows, totals[kind]) for kind, rows in groups.items()
        ],
        notes=list(notes),
        plot=plot,
    )


def _chosen(results: Sequence[tuple[int, CheckResult]], linked: frozenset[int]) -> set[int]:
    """Return the numbers of the results that the compact form shows."""
    nearest: dict[str, tuple[float, int]] = {}
    chosen = set()
    for number, result in results:
        if result.verdict in (Outcome.FAIL, Outcome.DRIFT, Outcome.NOTED) or number in linked:
            chosen.add(number)
        used = margin_of(result)
        if used is not None:
            nearest[result.quantity] = max(
                nearest.get(result.quantity, (-1.0, 0)), (used, number), key=lambda each: each[0]
            )
    worst = sorted(nearest.values(), key=lambda each: -each[0])[:SHOWN_PER_CASE]
    return chosen | {number for _, number in worst}


def _rank(kind: str) -> int:
    """Order the kinds of truth, the strongest first."""
    return list(KINDS).index(kind) if kind in KINDS else len(KINDS)


def _group_name(kind: str) -> str:
    return KINDS.get(kind, kind) + (" (the weaker class)" if kind == Kind.CROSS_CODE else "")


def _worst(results: Sequence[CheckResult]) -> str:
    """Say which comparison uses most of its tolerance."""
    margins = [(margin_of(result) or 0.0, result) for result in results]
    most = max((value for value, _ in margins), default=0.0)
    if most == 0.0:
        return "all exact"
    worst = next(result for value, result in margins if value == most)
    side = SIDES.get(worst.side, worst.side)
    return f"worst margin {error_text(most)} ({worst.check}, {side})"


def _row(result: CheckResult, note: int, anchor: str) -> Row:
    plain = result.verdict == Outcome.PASS
    unit = "" if result.unit in ("", "1") else result.unit
    return Row(
        anchor=anchor,
        check=result.check,
        side=SIDES.get(result.side, result.side),
        quantity=result.quantity
        if result.unit in ("", "1")
        else f"{result.quantity} [{result.unit}]",
        expected=value_text(result.expected),
        got=value_text(result.got),
        error=error_text(result.error),
        tolerance=error_text(result.tolerance),
        measure=MEASURES.get(result.measure, "") or unit,
        margin=error_text(margin_of(result)),
        note=note,
        verdict=result.verdict,
        story="" if plain else what_happened(result),
    )
