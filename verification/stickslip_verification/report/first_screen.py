"""The first screen of the report: one sentence, why the FMU fails, its contract, and one curve."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Final

from stickslip_verification.model.margins import error_text
from stickslip_verification.model.verdict import (
    LIKELIEST,
    SEQUENCE,
    CheckResult,
    Kind,
    Measure,
    Outcome,
    Verdict,
)
from stickslip_verification.report.view import FailedCheck

CONTRACTS: Final = {
    "exact": "Physics and contract checks decide, at the tolerances of the exact block.",
    "strict": "Physics and contract checks decide, at the tolerances of the exact block.",
    "physics": "Physics checks decide. Contract checks, on what the exact block promises beyond "
    "the physics, are noted and do not decide.",
}
"""What each contract holds an FMU to."""

CAUSES: Final = 3
"""How many failed checks the first screen names."""


@dataclass(frozen=True)
class Cause:
    """A failed check in short: ``where`` it fails, and what that ``means`` in one sentence."""

    check: str
    where: str
    means: str


def sentence(verdict: Verdict) -> str:
    """Say what came out: how near the exact motion the FMU is, or where it fails."""
    if verdict.questions:
        return verdict.questions[0].answer
    failed = {result.case for result in verdict.checks if result.failed}
    if failed:
        return f"Fails in {_and(_of_all(verdict, failed))}."
    compared = _compared(verdict)
    if not compared:
        return "No output was compared with the exact motion."
    largest = max(result.error or 0.0 for result in compared)
    near = f"Within {error_text(largest)} of" if largest else "Equal to the last bit to"
    where = _of_all(verdict, {result.case for result in compared}, short=True)
    return f"{near} the exact motion in {_and(where)}."


def farthest(verdict: Verdict) -> CheckResult | None:
    """Return the comparison of an output of the FMU with the exact motion that is farthest off."""
    return max(_compared(verdict), key=lambda result: result.error or 0.0, default=None)


def reasons(verdict: Verdict) -> list[str]:
    """Say why a verdict fails beside its failed checks."""
    found = [each.answer for each in verdict.questions[1:] if each.asked != LIKELIEST]
    if verdict.passed:
        return found
    if not verdict.checks:
        found.append("Nothing was compared, so nothing is verified.")
    elif not verdict.proven:
        found.append("No comparison of the FMU with a closed form or an invariant passed.")
    if verdict.kills is not None and not verdict.kills.passed:
        found.append("A planted fault survived, or an idle check has no reason to stay.")
    return found


def likeliest(verdict: Verdict, failures: Sequence[FailedCheck]) -> str:
    """Return the likeliest cause of a failure, from the runs or else the first failed check."""
    for each in verdict.questions:
        if each.asked == LIKELIEST:
            return each.answer
    meaning = failures[0].meaning if failures else None
    return "" if meaning is None or not meaning.look else f"Likeliest cause: {meaning.look}"


def shown_case(drawn: Collection[str], failures: Sequence[FailedCheck]) -> str | None:
    """Return the case whose curve is shown, or None where none is drawn.

    It is one of the likeliest cause, the default one before any other.
    """
    failed = [
        case for each in failures for case in sorted(each.cases, key=lambda case: case != "default")
    ]
    return next((case for case in (*failed, "default", *drawn) if case in drawn), None)


def causes(failures: Sequence[FailedCheck]) -> list[Cause]:
    """Return the first failures in short: check, where it fails, and the first of what it means."""
    return [
        Cause(
            each.check,
            "for the reference, not for the FMU"
            if each.of_reference
            else f"in {_and(_of_what(set(each.cases)))}",
            "" if each.meaning is None else each.meaning.means.split(". ")[0].rstrip(".") + ".",
        )
        for each in failures[:CAUSES]
    ]


def _compared(verdict: Verdict) -> list[CheckResult]:
    """Return what compares an output of the FMU with the exact motion, in parts of its scale."""
    return [
        result
        for result in verdict.checks
        if result.side == "fmu"
        and result.truth == Kind.CLOSED_FORM
        and result.measure == Measure.OF_SCALE
        and result.verdict == Outcome.PASS
    ]


def _of_all(verdict: Verdict, found: set[str], *, short: bool = False) -> list[str]:
    """Say which part of the cases and random sequences was found; `short` leaves out a whole."""
    places = []
    for of, name in ((verdict.cases, "case"), (verdict.sequences, "random sequence")):
        part, whole = len(found.intersection(of)), _many(len(of), name)
        if part:
            places.append(whole if short and part == len(of) else f"{part} of {whole}")
    if "" in found:
        places.append(f"{'in ' if places else ''}what the FMU declares, refuses and promises")
    return places


def _of_what(cases: set[str]) -> list[str]:
    """Count cases and random sequences in words."""
    sequences = sum(case.startswith(SEQUENCE) for case in cases)
    named = (len(cases - {""}) - sequences, "case"), (sequences, "random sequence")
    itself = ["the FMU itself"] if "" in cases else []
    return [_many(number, name) for number, name in named if number] + itself


def _many(number: int, name: str) -> str:
    return f"{number} {name}" if number == 1 else f"{number} {name}s"


def _and(parts: Sequence[str]) -> str:
    return f"{', '.join(parts[:-1])} and {parts[-1]}" if len(parts) > 1 else "".join(parts)
