"""The report as one page that asks for nothing outside itself, and the files beside it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

from markupsafe import Markup

from stickslip_verification.drive import convergence
from stickslip_verification.model.margins import error_text
from stickslip_verification.model.verdict import ObservedOrder, Outcome, Verdict
from stickslip_verification.model.whole_file import write_all
from stickslip_verification.report import earlier as baseline
from stickslip_verification.report import kill_view, order_plot, plots, svg, view
from stickslip_verification.report.environment import environment, text_of
from stickslip_verification.report.json_file import json_text
from stickslip_verification.report.junit import as_junit
from stickslip_verification.report.words import KINDS, SIDES, WORTH, ClaimSection
from stickslip_verification.suite.catalogue import Meaning

NO_MEANINGS: Mapping[str, Meaning] = MappingProxyType({})

NAMELESS = {
    "file": "the FMU",
    "sha256": "unknown",
    "content": "",
    "fmi_version": "",
    "names": "",
    "problems": "",
}
"""What page one has of an FMU, where the provenance does not say."""

LABELS = {
    "created": "made",
    "fmu.file": "FMU",
    "fmu.content": "SHA-256 of what is in it, without extra/",
    "fmu.sha256": "SHA-256 of the FMU, as judged",
    "fmu.fmi_version": "FMI version",
    "fmu.names": "names of its variables",
    "fmu.problems": "odd in the file",
    "git": "revision",
    "git.revision": "revision",
    "git.dirty": "uncommitted changes",
    "command": "to reproduce",
    "trust": "if the FMU is not honest",
}
"""What the parts of the provenance are called; others go by their own names."""


def render(
    verdict: Verdict,
    *,
    claims: Sequence[ClaimSection] = (),
    meanings: Mapping[str, Meaning] = NO_MEANINGS,
    margins: baseline.Moves | None = None,
    drawn: Mapping[str, str] | None = None,
    compact: bool = False,
) -> str:
    """Return the report as HTML; the same but for its last block for the same results.

    Parameters
    ----------
    verdict
        What came out.
    claims
        Claims about the model, in the order in which they are shown.
    meanings
        For a check, what its failure means.
    margins
        How margins moved since an earlier report, where there is one.
    drawn
        For a case, its plot as `draw_case` gives it; cases that are missing are drawn here.
    compact
        The form for `write_pdf`: per case what failed and, for each quantity, the comparison
        nearest to its tolerance, up to a number. The page says so.
    """
    failures = view.failed_checks(verdict, meanings)
    noted = view.failed_checks(verdict, meanings, (Outcome.NOTED,))
    nearest = view.nearest(verdict)
    linked = frozenset(
        [number for _, numbers in (*failures, *noted) for number in numbers]
        + [number for _, number in nearest]
    )
    return environment().get_template("index.html.j2").render(
        word="pass" if verdict.passed else "fail",
        reasons=_reasons(verdict),
        fmu=NAMELESS | dict(verdict.provenance.get("fmu") or {}),
        ours=verdict.ours,
        strict=verdict.contract_decides,
        compact=compact,
        most=view.SHOWN_PER_CASE,
        checks=verdict.checks,
        tried=len({result.case for result in verdict.checks} - {""}),
        summary=verdict.summary,
        kinds=_kinds(verdict),
        seconds=view.second_values(verdict),
        failures=[found for found, _ in failures],
        noted=[found for found, _ in noted],
        nearest=[place for place, _ in nearest],
        cases=view.case_views(verdict, _drawn(verdict, drawn or {}), linked, compact=compact),
        kills=None if verdict.kills is None else kill_view.of(verdict.kills),
        orders=[_order(order, number) for number, order in enumerate(verdict.orders)],
        claims=[_claim(claim, number) for number, claim in enumerate(claims)],
        moves=None if margins is None else _moves(margins),
        provenance=list(_told(_dated(verdict, margins))),
        style=text_of("style.css"),
        script=text_of("filter.js"),
    )  # fmt: skip


def write_report(
    verdict: Verdict,
    folder: Path,
    *,
    claims: Sequence[ClaimSection] = (),
    meanings: Mapping[str, Meaning] = NO_MEANINGS,
    margins: baseline.Moves | None = None,
    drawn: Mapping[str, str] | None = None,
) -> None:
    """Write index.html, report.json and junit.xml into `folder`, all or none.

    Everything is made before the first file is touched. The arguments are those of `render`.
    """
    page = render(verdict, claims=claims, meanings=meanings, margins=margins, drawn=drawn)
    files = {"report.json": json_text(verdict), "junit.xml": as_junit(verdict), "index.html": page}
    write_all({folder / name: text for name, text in files.items()})


def _reasons(verdict: Verdict) -> list[str]:
    """Say why a verdict fails."""
    reasons: list[str] = []
    if verdict.passed:
        return reasons
    if not verdict.checks:
        reasons.append("Nothing was compared, so nothing is verified.")
    elif not verdict.proven:
        reasons.append("No comparison of the FMU with a closed form or an invariant passed.")
    if verdict.kills is not None and not verdict.kills.passed:
        reasons.append("A planted fault survived, or an idle check has no reason to stay.")
    return reasons


def _kinds(verdict: Verdict) -> list[dict[str, Any]]:
    nothing = {"passed": 0, "failed": 0, "noted": 0, "not_applicable": 0}
    return [
        {
            "key": kind,
            "name": name,
            "numbers": [
                (label.replace("_", " "), number)
                for label, number in (nothing | verdict.by_kind.get(kind, {})).items()
            ],
            "worth": WORTH[kind],
        }
        for kind, name in KINDS.items()
    ]


def _drawn(verdict: Verdict, drawn: Mapping[str, str]) -> dict[str, str]:
    return {
        motion.case: Markup(
            drawn[motion.case]
            if motion.case in drawn
            else plots.draw_case(motion, plots.course_tolerances(verdict.checks, motion.case))
        )
        for motion in verdict.motions
    }


def _order(order: ObservedOrder, number: int) -> dict[str, Any]:
    between = [slope for slope in order.orders if math.isfinite(slope)]
    ends = sorted(zip(order.tolerances, order.errors, strict=True))
    return {
        "case": order.case,
        "quantity": order.quantity,
        "expected": f"{order.expected:.2g}",
        "observed": _slope(convergence.slope(list(order.tolerances), list(order.errors))),
        "between": f"{_slope(min(between))} to {_slope(max(between))}" if between else "–",
        "levels": len(order.tolerances),
        "coarsest": f"{error_text(ends[-1][1])} at {error_text(ends[-1][0])}",
        "finest": f"{error_text(ends[0][1])} at {error_text(ends[0][0])}",
        "plot": Markup(order_plot.draw_order(order, number)),
    }


def _slope(slope: float) -> str:
    return f"{slope:.2f}".replace("-", "\N{MINUS SIGN}") if math.isfinite(slope) else "–"


def _claim(claim: ClaimSection, number: int) -> ClaimSection:
    if not claim.svg:
        return claim
    drawn = svg.tidy(claim.svg, f"plot-claim-{number}", claim.title)
    return replace(claim, svg=Markup(drawn))


def _moves(moves: baseline.Moves) -> dict[str, Any]:
    def rows(found: Sequence[baseline.Move]) -> list[dict[str, str]]:
        return [
            {
                "case": view.case_name(move.case),
                "check": move.check,
                "side": SIDES.get(move.side, move.side),
                "before": _margin(move.before),
                "now": _margin(move.now),
                "verdict_before": move.before.verdict,
                "verdict_now": move.now.verdict,
            }
            for move in found
        ]

    def names(keys: Sequence[baseline.Key]) -> list[str]:
        return [
            f"{view.case_name(case)} / {check} ({SIDES.get(side, side)})"
            for case, check, side in keys
        ]

    return {
        "compared": moves.compared,
        "factor": f"{baseline.FACTOR:g}",
        "floor": f"{baseline.FLOOR:g}",
        "grew": moves.grew,
        "shrank": moves.shrank,
        "changed": moves.changed,
        "tables": [
            ("Verdicts that changed", rows(moves.changed)),
            ("Margins that grew", rows(moves.grew)),
            ("Margins that shrank", rows(moves.shrank)),
        ],
        "new": names(moves.new),
        "gone": names(moves.gone),
    }


def _margin(entry: baseline.Entry) -> str:
    return "–" if entry.verdict == Outcome.NOT_APPLICABLE else error_text(entry.margin)


def _dated(verdict: Verdict, moves: baseline.Moves | None) -> dict[str, Any]:
    told = dict(verdict.provenance)
    if moves is not None:
        told["earlier report"] = {
            "file": str(moves.baseline.file),
            "made": moves.baseline.created,
            "SHA-256 of its FMU": moves.baseline.sha256,
        }
    return told


def _told(provenance: Mapping[str, Any], path: str = "") -> list[tuple[str, str]]:
    """Return the provenance as pairs of label and text, nested tables flattened."""
    lines: list[tuple[str, str]] = []
    for key, value in provenance.items():
        name = f"{path}.{key}" if path else str(key)
        label = LABELS.get(name, f"version of {key}" if path == "versions" else name)
        if isinstance(value, Mapping):
            lines += _told(value, name)
        elif isinstance(value, bool):
            lines.append((label, "yes" if value else "no"))
        elif isinstance(value, list | tuple):
            lines.append((label, "; ".join(map(str, value)) or "none"))
        else:
            lines.append((label, "unknown" if value is None else str(value)))
    return lines
