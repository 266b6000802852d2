"""What the pages of the report say in words, and where they take templates and style from."""

import math
from collections.abc import Collection, Iterable
from pathlib import Path
from typing import Final

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from stickslip_verification.model.verdict import (
    LIKELIEST,
    SEQUENCE,
    CheckResult,
    Kind,
    Measure,
    Outcome,
    Verdict,
    count,
    error_text,
    margin_of,
    value_text,
)

KINDS: Final[dict[str, str]] = {
    Kind.CLOSED_FORM: "closed form",
    Kind.INVARIANT: "invariant",
    Kind.CONVERGENCE: "convergence",
    Kind.CROSS_CODE: "cross-code",
}

WORTH: Final[dict[str, str]] = {
    Kind.CLOSED_FORM: "Code verification against the exact solution of the equations, by a formula "
    "or in high precision. Its code is independent of FMU and reference. The strongest kind.",
    Kind.INVARIANT: "Code verification against what every exact motion satisfies, such as the "
    "energy balance or the mirror. It needs no solution, so it also judges motions without a "
    "formula.",
    Kind.CONVERGENCE: "Solution verification: the numerical error must fall with the tolerance or "
    "the step at the order that the method promises.",
    Kind.CROSS_CODE: "Two programs compared with each other. The weaker kind: both may be wrong "
    "alike, so it alone gives no pass.",
}
"""What each kind of truth is worth; in the terms of ASME V&V 10."""

SIDES: Final = {"fmu": "FMU", "reference": "reference", "both": "both"}

MEASURES: Final[dict[str, str]] = {Measure.RELATIVE: "of value", Measure.OF_SCALE: "of scale"}
"""What an error is a part of; an absolute one has the unit of its quantity."""


def measure(result: CheckResult) -> str:
    """Say what the error of a result is a part of, or in which unit it is."""
    return MEASURES.get(result.measure, result.unit if result.unit != "1" else "")


def story(result: CheckResult) -> str:
    """Say in one line why a result is not a plain pass; "" where it is one."""
    if result.verdict == Outcome.PASS:
        return ""
    if result.not_applicable is not None:
        return result.not_applicable
    if result.failure is not None:
        return result.failure
    allowed = f"{error_text(result.tolerance)} {measure(result)}".strip()
    return f"error {error_text(result.error)} is above {allowed}"


def sentence(verdict: Verdict) -> str:
    """Say what came out: how near the exact motion the FMU is, or where it fails."""
    if verdict.questions:
        return verdict.questions[0].answer
    failed = {result.case for result in verdict.checks if result.failed}
    if failed:
        return f"Fails in {_of_all(verdict, failed)}."
    compared = with_exact_motion(verdict)
    if not compared:
        return "No output was compared with the exact motion."
    largest = max(result.error or 0.0 for result in compared)
    near = f"Within {error_text(largest)} of" if largest else "Equal to the last bit to"
    where = _of_all(verdict, {result.case for result in compared}, short=True)
    return f"{near} the exact motion in {where}."


def reasons(verdict: Verdict) -> list[str]:
    """Say why a verdict fails apart from its failed checks."""
    said = [each.answer for each in verdict.questions[1:] if each.asked != LIKELIEST]
    if verdict.passed:
        return said
    if not verdict.checks:
        said.append("Nothing was compared, so nothing is verified.")
    elif not verdict.proven:
        said.append("No comparison of the FMU with a closed form or an invariant passed.")
    if verdict.kills is not None and not verdict.kills.passed:
        said.append("A planted fault survived, or an idle check has no reason to stay.")
    return said


def with_exact_motion(verdict: Verdict) -> list[CheckResult]:
    """Return what compares an output of the FMU with the exact motion, in parts of its scale."""
    return [
        result
        for result in verdict.checks
        if result.side == "fmu"
        and result.truth == Kind.CLOSED_FORM
        and result.measure == Measure.OF_SCALE
        and result.verdict == Outcome.PASS
    ]


def places(cases: Collection[str]) -> str:
    """Count cases and random sequences in words."""
    sequences = sum(case.startswith(SEQUENCE) for case in cases)
    named = (len(set(cases) - {""}) - sequences, "case"), (sequences, "random sequence")
    counted = [_many(number, name) for number, name in named if number]
    return _and([*counted, "the FMU itself"] if "" in cases else counted)


def _of_all(verdict: Verdict, cases: set[str], *, short: bool = False) -> str:
    """Say which part of the cases and random sequences these are; `short` leaves out a whole."""
    parts = []
    for of, name in ((verdict.cases, "case"), (verdict.sequences, "random sequence")):
        part, whole = len(cases.intersection(of)), _many(len(of), name)
        if part:
            parts.append(whole if short and part == len(of) else f"{part} of {whole}")
    if "" in cases:
        parts.append(f"{'in ' if parts else ''}what the FMU declares, refuses and promises")
    return _and(parts)


def _many(number: int, name: str) -> str:
    return f"{number} {name}" if number == 1 else f"{number} {name}s"


def _and(parts: Iterable[str]) -> str:
    *first, last = parts
    return f"{', '.join(first)} and {last}" if first else last


_TEMPLATES: Final = Path(__file__).parent / "templates"


def environment(folder: Path = _TEMPLATES) -> Environment:
    """Return what renders the templates of a folder.

    A name that is missing is an error, text is escaped.
    """
    made = Environment(
        loader=FileSystemLoader(folder),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    made.filters |= {
        "slug": lambda word: "-".join(str(word).lower().split()),
        "value": value_text,
        "error": error_text,
        "margin": lambda result: error_text(margin_of(result)),
        "farthest": lambda results: max(results, key=used, default=None),
        "counts": count,
        "measure": measure,
        "story": story,
        "places": places,
        "slope": lambda slope: f"{slope:.2f}".replace("-", "\N{MINUS SIGN}"),
    }
    made.tests["finite"] = math.isfinite
    made.globals |= {"kinds": KINDS, "worth": WORTH, "sides": SIDES}
    return made


def used(result: CheckResult) -> float:
    """Return how much of its tolerance a result uses; 0 where its check does not apply."""
    return margin_of(result) or 0.0


def text_of(name: str, folder: Path = _TEMPLATES) -> Markup:
    """Return a script that stands in a page as it is, or a style behind that of all documents."""
    files = [_TEMPLATES / "document.css"] * name.endswith(".css") + [folder / name]
    return Markup("".join(file.read_text(encoding="utf-8") for file in files))
