"""The report as one page that asks for nothing outside itself, and the files beside it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

from markupsafe import Markup

from stickslip_verification.drive import convergence
from stickslip_verification.model.margins import error_text
from stickslip_verification.model.verdict import ObservedOrder, Outcome, Table, Verdict
from stickslip_verification.model.whole_file import write_all
from stickslip_verification.report import earlier as baseline
from stickslip_verification.report import first_screen, kill_view, order_plot, plots, view
from stickslip_verification.report.environment import environment, text_of
from stickslip_verification.report.json_file import json_text
from stickslip_verification.report.junit import as_junit
from stickslip_verification.report.words import KINDS, SIDES, WORTH
from stickslip_verification.suite.catalogue import Meaning

NO_MEANINGS: Mapping[str, Meaning] = MappingProxyType({})

CURVE = "curve"
"""The id of the picture on the first screen."""

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
    "fmu.contract": "contract in its description",
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
    meanings: Mapping[str, Meaning] = NO_MEANINGS,
    margins: baseline.Moves | None = None,
    drawn: Mapping[str, str] | None = None,
    full: bool = False,
) -> str:
    """Return the report as HTML; the same but for its last block for the same results.

    Parameters
    ----------
    verdict
        What came out.
    meanings
        For a check, what its failure means.
    margins
        How margins moved since an earlier report, where there is one.
    drawn
        The plots as `draw_cases` gives them; drawn here where they are not given.
    full
        Whether every comparison is printed; else a case that passed is printed as one line.
    """
    failures = view.failed_checks(verdict, meanings)
    noted = view.failed_checks(verdict, meanings, (Outcome.NOTED,))
    nearest = view.nearest(verdict)
    linked = frozenset(
        [number for found in (*failures, *noted) for number in found.numbers]
        + [number for _, number in nearest]
    )
    pictures = dict(plots.draw_cases(verdict) if drawn is None else drawn)
    shown = first_screen.shown_case(pictures, failures)
    curve = ""
    if shown is not None:
        curve = pictures[shown].replace("<svg", f'<svg id="{CURVE}"', 1)
        pictures[shown] = _again(pictures[shown])
    return environment().get_template("index.html.j2").render(
        word="pass" if verdict.passed else "fail",
        sentence=first_screen.sentence(verdict),
        reasons=first_screen.reasons(verdict),
        causes=first_screen.causes(failures),
        likeliest=first_screen.likeliest(verdict, failures),
        farthest=first_screen.farthest(verdict),
        contract=verdict.contract,
        contracts=first_screen.CONTRACTS,
        curve=Markup(curve),
        shown=shown,
        fmu=NAMELESS | dict(verdict.provenance.get("fmu") or {}),
        full=full,
        whole=view.PRINTED_WHOLE,
        checks=verdict.checks,
        summary=verdict.summary,
        kinds=view.table_view(_kinds(verdict)),
        kind_names=KINDS,
        failures=failures,
        noted=noted,
        nearest=[place for place, _ in nearest],
        tables=[view.table_view(t, f"table-{n}") for n, t in enumerate(verdict.tables)],
        groups=view.case_groups(verdict, pictures, linked),
        kills=None if verdict.kills is None else kill_view.of(verdict.kills),
        orders=[_drawn_order(order, number) for number, order in enumerate(verdict.orders)],
        order_table=view.table_view(_orders(verdict.orders)),
        moves=None if margins is None else _moves(margins),
        provenance=list(_told(_dated(verdict, margins))),
        style=text_of("style.css"),
        script=text_of("filter.js"),
    )  # fmt: skip


def write_report(
    verdict: Verdict,
    folder: Path,
    *,
    meanings: Mapping[str, Meaning] = NO_MEANINGS,
    margins: baseline.Moves | None = None,
    drawn: Mapping[str, str] | None = None,
    full: bool = False,
) -> None:
    """Write index.html, report.json and junit.xml into `folder`, all or none.

    Everything is made before the first file is touched. The arguments are those of `render`.
    """
    page = render(verdict, meanings=meanings, margins=margins, drawn=drawn, full=full)
    files = {"report.json": json_text(verdict), "junit.xml": as_junit(verdict), "index.html": page}
    write_all({folder / name: text for name, text in files.items()})


def _kinds(verdict: Verdict) -> Table:
    columns = ("passed", "failed", "noted", "not_applicable")
    nothing = dict.fromkeys(columns, 0)
    rows: list[Sequence[str | int]] = []
    for kind, name in KINDS.items():
        counts = nothing | verdict.by_kind.get(kind, {})
        rows.append([name, *(counts[column] for column in columns), WORTH[kind]])
    head = [column.replace("_", " ") for column in columns]
    return Table("Kinds of truth", "", ["kind of truth", *head, "what it is worth"], rows)


def _again(picture: str) -> str:
    """Return what shows the picture of the first screen a second time, without its lines."""
    return picture[: picture.index(">") + 1] + f'<use href="#{CURVE}"/></svg>'


def _orders(orders: Sequence[ObservedOrder]) -> Table:
    head = ("case", "quantity", "promised", "observed", "from level to level", "levels",
            "error at the coarsest tolerance", "at the finest")  # fmt: skip
    rows: list[Sequence[str | int]] = []
    for order in orders:
        between = [slope for slope in order.orders if math.isfinite(slope)]
        (finest, at_finest), *_, (coarsest, at_coarsest) = sorted(
            zip(order.tolerances, order.errors, strict=True)
        )
        rows.append(
            [
                order.case,
                order.quantity,
                f"{order.expected:.2g}",
                _slope(convergence.slope(list(order.tolerances), list(order.errors))),
                f"{_slope(min(between))} to {_slope(max(between))}" if between else "–",
                len(order.tolerances),
                f"{error_text(at_coarsest)} at {error_text(coarsest)}",
                f"{error_text(at_finest)} at {error_text(finest)}",
            ]
        )
    return Table("Observed orders", "", head, rows)


def _drawn_order(order: ObservedOrder, number: int) -> dict[str, Any]:
    return {
        "case": order.case,
        "quantity": order.quantity,
        "plot": Markup(order_plot.draw_order(order, number)),
    }


def _slope(slope: float) -> str:
    return f"{slope:.2f}".replace("-", "\N{MINUS SIGN}") if math.isfinite(slope) else "–"


def _moves(moves: baseline.Moves) -> dict[str, Any]:
    head = ("case", "check", "side", "margin then", "now", "verdict then", "now")

    def table(title: str, found: Sequence[baseline.Move]) -> view.TableView:
        rows = [
            [
                view.case_name(move.case),
                move.check,
                SIDES.get(move.side, move.side),
                _margin(move.before),
                _margin(move.now),
                move.before.verdict,
                move.now.verdict,
            ]
            for move in found
        ]
        return view.table_view(Table(title, "", head, rows))

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
            table("Verdicts that changed", moves.changed),
            table("Margins that grew", moves.grew),
            table("Margins that shrank", moves.shrank),
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
