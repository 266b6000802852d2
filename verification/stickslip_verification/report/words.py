"""Texts of the report, and sections that its caller adds."""

from typing import Final

from stickslip_verification.model.margins import error_text
from stickslip_verification.model.verdict import CheckResult, Kind, Measure

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

MEASURES: Final[dict[str, str]] = {
    Measure.RELATIVE: "of value",
    Measure.OF_SCALE: "of scale",
    Measure.ABSOLUTE: "",
}
"""What an error is a part of; an absolute one has the unit of its quantity."""


def what_happened(result: CheckResult) -> str:
    """Say in one line why a result is not a plain pass."""
    if result.not_applicable is not None:
        return result.not_applicable
    if result.failure is not None:
        return result.failure
    measure = MEASURES.get(result.measure, "") or (result.unit if result.unit != "1" else "")
    allowed = f"{error_text(result.tolerance)} {measure}".strip()
    return f"error {error_text(result.error)} is above {allowed}"
