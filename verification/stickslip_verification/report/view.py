"""The verdict as the page shows it: cases in groups, rows and tables as text."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from stickslip_verification.model.margins import error_text, margin_of, value_text
from stickslip_verification.model.verdict import (
    SEQUENCE,
    CaseGroup,
    CheckResult,
    Kind,
    Klass,
    Motion,
    Outcome,
    Table,
    Verdict,
    count,
)
from stickslip_verification.report.words import KINDS, MEASURES, SIDES, what_happened
from stickslip_verification.suite.catalogue import Meaning

NEAREST = 10
"""How many margins the page names."""

SHOWN_PER_CHECK = 5
"""How many of the cases in which a check failed the list of failures names."""

PRINTED_WHOLE = 5
"""How many failed cases are printed with every comparison; every other case is one line."""

ITSELF = "The FMU itself"
"""The group of what is checked on the FMU and not on a motion."""

SEQUENCES = "Random sequences"
"""The group of the random sequences, of which the page shows those that did not pass."""


@dataclass(frozen=True)
class Row:
    """One comparison as text; ``anchor`` is "" if nothing on the page points at it."""

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
    because: str
    verdict: str
    story: str


@dataclass(frozen=True)
class KindOfRows:
    """The comparisons of a case with one kind of truth, what did not pass first."""

    kind: str
    name: str
    rows: Sequence[Row]


@dataclass(frozen=True)
class CaseView:
    """One case: its rows by kind of truth, its plot or "", and whether all of it is printed."""

    anchor: str
    id: str
    title: str
    about: str
    counts: Mapping[str, int]
    worst: str
    worst_of: str
    kinds: Sequence[KindOfRows]
    plot: str
    whole: bool = False

    @property
    def failed(self) -> bool:
        """Whether anything in it failed."""
        return self.counts["failed"] > 0


@dataclass(frozen=True)
class GroupView:
    """Cases under one heading; ``total`` counts those that are not shown too."""

    name: str
    cases: Sequence[CaseView]
    total: int
    failed: int


@dataclass(frozen=True)
class TableView:
    """A table as text; each heading and cell with whether it is of numbers."""

    anchor: str
    title: str
    about: str
    head: Sequence[tuple[str, bool]]
    rows: Sequence[Sequence[tuple[str, bool]]]
    note: str


@dataclass(frozen=True)
class Place:
    """A result to be pointed at, and what is said of it; ``anchor`` is "" if it is not shown."""

    anchor: str
    case: str
    check: str
    side: str
    text: str


@dataclass(frozen=True)
class FailedCheck:
    """A check that failed somewhere: what that means, the worst places, how many there are.

    ``cases`` are those of its ``total`` results; ``numbers`` are those of the results that
    ``places`` names, the worst first. ``of_reference`` tells whether the FMU
    passed it everywhere, and the reference alone failed.
    """

    check: str
    kind: Kind
    klass: Klass
    meaning: Meaning | None
    places: Sequence[Place]
    numbers: Sequence[int]
    total: int
    cases: Sequence[str]
    of_reference: bool
    noted: bool


def case_groups(
    verdict: Verdict, plots: Mapping[str, str], linked: frozenset[int]
) -> list[GroupView]:
    """Return the cases in their groups, the default ones first, in a group those that failed first.

    Of the random sequences only those that failed are shown.

    Parameters
    ----------
    verdict
        What came out.
    plots
        For a case, its plot.
    linked
        Numbers of the results that something on the page points at.
    """
    motions = {motion.case: motion for motion in verdict.motions}
    results: dict[str, list[tuple[int, CheckResult]]] = {}
    for number, result in enumerate(verdict.checks):
        results.setdefault(result.case, []).append((number, result))
    groups: dict[str, list[str]] = {name: [] for name in (*CaseGroup, SEQUENCES, ITSELF)}
    for case in results:
        groups[_group_of(case, motions.get(case))].append(case)
    failed = {case for case, found in results.items() if any(r.failed for _, r in found)}
    printed = 0
    views = []
    for name, cases in groups.items():
        here = []
        for case in sorted(cases, key=lambda case: (case != "default", case not in failed)):
            if name == SEQUENCES and case not in failed:
                continue
            printed += case in failed
            whole = case in failed and printed <= PRINTED_WHOLE
            worst, worst_of = _worst([result for _, result in results[case]])
            here.append(
                CaseView(
                    anchor=f"case-{case or 'fmu'}",
                    id=case_name(case),
                    title=_title(case, motions.get(case)),
                    about=" ".join(motions[case].about.split()) if case in motions else "",
                    counts=count([result for _, result in results[case]]),
                    worst=worst,
                    worst_of=worst_of,
                    kinds=list(_kinds(results[case], linked)),
                    plot=plots.get(case, ""),
                    whole=whole,
                )
            )
        if cases:
            views.append(GroupView(name, here, len(cases), len(failed.intersection(cases))))
    return views


def rows_of(results: Sequence[CheckResult]) -> list[KindOfRows]:
    """Return results as rows by kind of truth, without anything that points at them."""
    return list(_kinds(list(enumerate(results)), frozenset()))


def failed_checks(
    verdict: Verdict,
    meanings: Mapping[str, Meaning],
    words: Sequence[str] = (Outcome.FAIL,),
) -> list[FailedCheck]:
    """Return each check with a verdict among `words`, that of the likeliest cause first.

    What the FMU fails comes before what the reference alone fails, what is held against a truth
    before what is held against another program, and what fails in more cases before what fails in
    fewer. Of two that fail equally often physics comes before contract, and an invariant first: it
    looks at single samples, so it names the equation that is broken, while the exact motion is
    missed after any fault.
    """
    checks: dict[str, list[tuple[int, CheckResult]]] = {}
    for number, result in enumerate(verdict.checks):
        if result.verdict in words:
            checks.setdefault(result.check, []).append((number, result))
    views = []
    for check, found in checks.items():
        worst = sorted(found, key=lambda each: -(margin_of(each[1]) or 0.0))[:SHOWN_PER_CHECK]
        results = [result for _, result in found]
        views.append(
            FailedCheck(
                check=check,
                kind=results[0].truth,
                klass=results[0].klass,
                meaning=meanings.get(check),
                places=[_place(number, result, what_happened(result)) for number, result in worst],
                numbers=[number for number, _ in worst],
                total=len(found),
                cases=list(dict.fromkeys(result.case for result in results)),
                of_reference=all(result.side == "reference" for result in results),
                noted=results[0].verdict == Outcome.NOTED,
            )
        )
    return sorted(
        views,
        key=lambda each: (
            each.of_reference,
            each.kind not in (Kind.CLOSED_FORM, Kind.INVARIANT),
            -len(each.cases),
            each.klass == Klass.CONTRACT,
            each.kind != Kind.INVARIANT,
        ),
    )


def nearest(verdict: Verdict) -> list[tuple[Place, int]]:
    """Return the passed results that use most of their tolerance, and their numbers."""
    passed = [(n, r) for n, r in enumerate(verdict.checks) if r.verdict == Outcome.PASS]
    worst = sorted(passed, key=lambda each: -(margin_of(each[1]) or 0.0))[:NEAREST]
    shown = {r.case for r in verdict.checks if r.failed or not r.case.startswith(SEQUENCE)}
    return [
        (_place(n, r, error_text(margin_of(r)), shown=r.case in shown), n)
        for n, r in worst
        if (margin_of(r) or 0.0) > 0.0
    ]


def table_view(table: Table, anchor: str = "") -> TableView:
    """Return a table as text; the heading of a column with a number in it is that of numbers."""
    rows = [[_cell(cell) for cell in row] for row in table.rows]
    return TableView(
        anchor=anchor,
        title=table.title,
        about=table.about,
        head=[
            (heading, any(row[column][1] for row in rows))
            for column, heading in enumerate(table.head)
        ],
        rows=rows,
        note=table.note,
    )


def _cell(cell: str | float) -> tuple[str, bool]:
    return (cell, False) if isinstance(cell, str) else (value_text(cell), True)


def case_name(case: str) -> str:
    """Name a case; the empty one holds what is checked on the FMU and not on a motion."""
    return case or "the FMU itself"


def _place(number: int, result: CheckResult, text: str, *, shown: bool = True) -> Place:
    side = SIDES.get(result.side, result.side)
    anchor = f"r{number}" if shown else ""
    return Place(anchor, case_name(result.case), result.check, side, text)


def _group_of(case: str, motion: Motion | None) -> str:
    if not case:
        return ITSELF
    if case.startswith(SEQUENCE):
        return SEQUENCES
    return CaseGroup.SETTINGS if motion is None else motion.group


def _title(case: str, motion: Motion | None) -> str:
    if motion is not None:
        return motion.title
    return "" if case else "What it declares, refuses and promises"


def _kinds(
    results: Sequence[tuple[int, CheckResult]], linked: frozenset[int]
) -> Iterator[KindOfRows]:
    """Yield the comparisons of each kind of truth, the strongest first; what failed leads."""
    kinds: dict[str, list[tuple[int, CheckResult]]] = {}
    for number, result in sorted(results, key=lambda each: _order(each[1])):
        kinds.setdefault(result.truth, []).append((number, result))
    for kind, found in kinds.items():
        rows = [_row(result, f"r{n}" if n in linked else "") for n, result in found]
        yield KindOfRows(kind, _name_of_kind(kind), rows)


def _order(result: CheckResult) -> tuple[int, int]:
    """Order by kind of truth, then failures, what is noted, and the rest as it ran."""
    later = 0 if result.failed else 1 if result.verdict == Outcome.NOTED else 2
    return _rank(result.truth), later


def _rank(kind: str) -> int:
    """Order the kinds of truth, the strongest first."""
    return list(KINDS).index(kind) if kind in KINDS else len(KINDS)


def _name_of_kind(kind: str) -> str:
    return KINDS.get(kind, kind) + (" (the weaker class)" if kind == Kind.CROSS_CODE else "")


def _worst(results: Sequence[CheckResult]) -> tuple[str, str]:
    """Say how much of its tolerance the worst comparison uses, and which one it is."""
    margins = [(margin_of(result) or 0.0, result) for result in results]
    most, worst = max(margins, key=lambda each: each[0])
    if most == 0.0:
        return "all exact", ""
    return f"worst margin {error_text(most)}", f"{worst.check}, {SIDES.get(worst.side, worst.side)}"


def _row(result: CheckResult, anchor: str) -> Row:
    plain = result.verdict == Outcome.PASS
    unit = "" if result.unit in ("", "1") else result.unit
    return Row(
        anchor=anchor,
        check=result.check,
        side=SIDES.get(result.side, result.side),
        quantity=f"{result.quantity} [{unit}]" if unit else result.quantity,
        expected=value_text(result.expected),
        got=value_text(result.got),
        error=error_text(result.error),
        tolerance=error_text(result.tolerance),
        measure=MEASURES.get(result.measure, "") or unit,
        margin=error_text(margin_of(result)),
        because=result.because,
        verdict=result.verdict,
        story="" if plain else what_happened(result),
    )
