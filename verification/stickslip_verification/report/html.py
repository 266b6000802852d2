"""The report as one page that asks for nothing outside itself, and the files with it."""

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

from ..drive.exact import slope
from ..model.data_file import write_all
from ..model.verdict import (
    LIKELIEST,
    SEQUENCE,
    CaseGroup,
    CheckResult,
    Kind,
    Klass,
    Motion,
    Outcome,
    Verdict,
)
from ..suite.cases import Meaning
from . import files, plots

NO_MEANINGS: Mapping[str, Meaning] = MappingProxyType({})

ITSELF = "The FMU itself"  # the group of what is checked on the FMU and not on a motion
SEQUENCES = "Random sequences"
"""The group of the random sequences, of which the page shows those that did not pass."""
Numbered = tuple[int, CheckResult]  # a result and its number in the verdict
_FIRST = {Outcome.FAIL: 0, Outcome.NOTED: 1}  # the place of results in a case; the others follow


class FailedCheck(NamedTuple):
    """A check that failed somewhere, and its failures, the farthest from the tolerance first."""

    check: str
    results: Sequence[Numbered]
    cases: Sequence[str]

    @property
    def of_reference(self) -> bool:
        """Whether the reference alone fails it."""
        return all(result.side == "reference" for _, result in self.results)


class CaseResults(NamedTuple):
    """A case with its results, what did not pass first; the motion is None where there is none."""

    id: str
    motion: Motion | None
    results: Sequence[Numbered]
    failed: bool


def render(
    verdict: Verdict, *, meanings: Mapping[str, Meaning] = NO_MEANINGS, full: bool = False
) -> str:
    """Return the report as HTML; the same but for its last block for the same results.

    `meanings` say what a failure of a check means. Unless it is `full`, a case that passed is
    printed as one line.
    """
    failures = failed_checks(verdict, (Outcome.FAIL,))
    pictures = plots.draw_cases(verdict)
    failed = [case for check in failures for case in sorted(check.cases, key="default".__ne__)]
    return files.environment().get_template("index.html.j2").render(
        verdict=verdict,
        asked_last=LIKELIEST,
        likeliest=_likeliest(verdict, failures, meanings),
        farthest=max(files.with_exact_motion(verdict), key=lambda r: r.error or 0.0, default=None),
        meanings=meanings,
        failures=failures,
        noted=failed_checks(verdict, (Outcome.NOTED,)),
        pictures=pictures,
        size=plots.SIZE,
        orders=[
            (order, slope(order.tolerances, order.errors), plots.draw_order(order, n))
            for n, order in enumerate(verdict.orders)
        ],
        # On the first screen: of the likeliest cause, the default one before any other.
        shown=next((case for case in (*failed, "default", *pictures) if case in pictures), None),
        groups=_groups(verdict),
        sequences=SEQUENCES,
        numbered=list(enumerate(verdict.checks)),
        full=full,
        style=files.text_of("style.css"),
        script=files.text_of("filter.js"),
    )  # fmt: skip


def write_report(
    verdict: Verdict,
    folder: Path,
    *,
    meanings: Mapping[str, Meaning] = NO_MEANINGS,
    full: bool = False,
) -> None:
    """Write index.html, report.json and junit.xml into `folder`, all or none.

    Everything is made before the first file is touched. The arguments are those of `render`.
    """
    page = render(verdict, meanings=meanings, full=full)
    data = {folder / "report.json": files.json_text(verdict)}
    write_all(data | {folder / "junit.xml": files.as_junit(verdict), folder / "index.html": page})


def failed_checks(verdict: Verdict, outcomes: Collection[Outcome]) -> list[FailedCheck]:
    """Return each check with one of these outcomes, that of the likeliest cause first.

    What the FMU fails comes before what the reference alone fails, what is compared with a truth
    before what is compared with another program, and what fails in more cases before what fails in
    fewer. Of two that fail equally often physics comes before contract, and an invariant first: it
    looks at single samples, so it names the equation that is broken, while the exact motion is
    missed after any fault.
    """
    checks: dict[str, list[Numbered]] = {}
    for number, result in enumerate(verdict.checks):
        if result.verdict in outcomes:
            checks.setdefault(result.check, []).append((number, result))
    failed = [
        FailedCheck(
            check,
            sorted(results, key=lambda numbered: -(numbered[1].margin or 0.0)),
            list(dict.fromkeys(result.case for _, result in results)),
        )
        for check, results in checks.items()
    ]

    def rank(check: FailedCheck) -> tuple[bool, bool, int, bool, bool]:
        first = verdict.checks[min(number for number, _ in check.results)]
        return (
            check.of_reference,
            first.truth not in (Kind.CLOSED_FORM, Kind.INVARIANT),
            -len(check.cases),
            first.klass == Klass.CONTRACT,
            first.truth != Kind.INVARIANT,
        )

    return sorted(failed, key=rank)


def _likeliest(
    verdict: Verdict, failures: Sequence[FailedCheck], meanings: Mapping[str, Meaning]
) -> str:
    for question in verdict.questions:
        if question.asked == LIKELIEST:
            return question.answer
    # What was not made, since a run did not end, is a sign of nothing.
    made = [each.check for each in failures if not all(result.late for _, result in each.results)]
    meaning = meanings.get(made[0]) if made else None
    return "" if meaning is None or not meaning.look else f"Likeliest cause: {meaning.look}"


def _groups(verdict: Verdict) -> dict[str, list[CaseResults]]:
    """Return the cases in their groups, the default one first, then those that failed."""
    motions = {motion.case: motion for motion in verdict.motions}
    results: dict[str, list[Numbered]] = {}
    for number, result in enumerate(verdict.checks):
        results.setdefault(result.case, []).append((number, result))
    groups: dict[str, list[CaseResults]] = {name: [] for name in (*CaseGroup, SEQUENCES, ITSELF)}
    for case, of_case in results.items():
        motion = motions.get(case)
        group = CaseGroup.SETTINGS if motion is None else motion.group
        name = SEQUENCES if case.startswith(SEQUENCE) else group if case else ITSELF
        failed = any(result.failed for _, result in of_case)
        ordered = sorted(of_case, key=lambda numbered: _FIRST.get(numbered[1].verdict, 2))
        groups[name].append(CaseResults(case, motion, ordered, failed))
    for cases in groups.values():
        cases.sort(key=lambda case: (case.id != "default", not case.failed))
    return groups


SHOWN = "default"
"""The case that the page shows comparison by comparison: it is the one that runs as it comes."""
_NAMES = {"2.0": "StickSlip.fmu", "3.0": "StickSlip_native_fmi3.fmu"}
"""However the file is called now: that is no part of what it holds."""


def packed_report(verdict: Verdict) -> str:
    """Return the report that goes into the FMU it judges, our own.

    It names the FMU by the digest of its content without extra/, so that it can be put there, and
    carries neither date nor place: the same FMU and the same suite give the same bytes.
    """
    cases: dict[str, list[CheckResult]] = {SHOWN: []}
    for result in verdict.checks:
        drawn = result.case.startswith(SEQUENCE)
        name = "random sequences" if drawn else result.case or "the FMU itself"
        cases.setdefault(name, []).append(result)
    return files.environment().get_template("packed.html.j2").render(
        verdict=verdict,
        name=_NAMES[verdict.provenance["fmu"]["fmi_version"]],
        cases={name: results for name, results in cases.items() if results},
        titles={motion.case: motion.title for motion in verdict.motions},
        shown=[(n, r) for n, r in enumerate(cases[SHOWN]) if r.side == "fmu"],
        style=files.text_of("style.css"),
    )  # fmt: skip
