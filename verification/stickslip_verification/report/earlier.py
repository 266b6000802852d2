"""Comparison of a verdict with an earlier report: margins that moved, verdicts that changed."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from stickslip_verification.model.margins import margin
from stickslip_verification.model.verdict import Outcome, Verdict

Key = tuple[str, str, str]
"""Case, check and side."""

FACTOR = 2.0
"""A margin that changed by less than this has not moved."""

FLOOR = 1e-3
"""Margins below this count as this: a thousandth of a tolerance is rounding, and rounding moves."""


class EarlierReportError(ValueError):
    """An earlier report cannot be used; one line that says which and why."""


@dataclass(frozen=True)
class Entry:
    """One check of a report: its margin (error over tolerance), tolerance and verdict.

    The margin is infinite where nothing could be compared.
    """

    margin: float
    tolerance: float
    verdict: str


@dataclass(frozen=True)
class EarlierReport:
    """An earlier report; ``created`` and ``sha256`` (of its FMU) are None where it does not say."""

    file: Path
    created: str | None
    sha256: str | None
    entries: Mapping[Key, Entry]


@dataclass(frozen=True)
class Move:
    """A check of both reports, with its entry in each."""

    case: str
    check: str
    side: str
    before: Entry
    now: Entry

    @property
    def factor(self) -> float:
        """Margin now over margin then, both at least `FLOOR`."""
        before, now = max(self.before.margin, FLOOR), max(self.now.margin, FLOOR)
        if math.isinf(before) and math.isinf(now):
            return 1.0
        return now / before


@dataclass(frozen=True)
class Moves:
    """Differences between an earlier report and a verdict.

    Attributes
    ----------
    baseline
        The earlier report.
    grew, shrank
        Checks whose margin moved by more than `FACTOR`, the furthest first.
    changed
        Checks whose verdict changed, whatever their margin did.
    new, gone
        Checks of only one of the two reports.
    compared
        Number of checks in both.
    """

    baseline: EarlierReport
    grew: Sequence[Move]
    shrank: Sequence[Move]
    changed: Sequence[Move]
    new: Sequence[Key]
    gone: Sequence[Key]
    compared: int


def read_earlier_report(path: Path) -> EarlierReport:
    """Read an earlier ``report.json``.

    Raises
    ------
    EarlierReportError
        There is no such file, or it is not such a report.
    """
    try:
        report = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise EarlierReportError(f"{path}: {(error.strerror or str(error)).lower()}") from None
    except UnicodeDecodeError:
        raise EarlierReportError(f"{path}: is not a report: not UTF-8") from None
    except (json.JSONDecodeError, RecursionError) as error:
        raise EarlierReportError(f"{path}: is not a report: not JSON: {error}") from None
    rows = report.get("checks") if isinstance(report, dict) else None
    if not isinstance(rows, list):
        raise EarlierReportError(f"{path}: is not a report: it has no list of checks")
    entries: dict[Key, Entry] = {}
    for number, row in enumerate(rows):
        try:
            entries[row["case"], row["check"], row["side"]] = _entry(row)
        except (KeyError, TypeError, ValueError, AttributeError, OverflowError) as error:
            reason = f"checks[{number}]: {type(error).__name__}: {error}"
            raise EarlierReportError(f"{path}: is not a report: {reason}") from None
    provenance = report.get("provenance")
    told = provenance if isinstance(provenance, dict) else {}
    fmu = told.get("fmu")
    return EarlierReport(
        path, told.get("created"), fmu.get("sha256") if isinstance(fmu, dict) else None, entries
    )


def compare(baseline: EarlierReport, verdict: Verdict) -> Moves:
    """Return how the checks of a verdict differ from those of an earlier report."""
    now = {
        (each.case, each.check, each.side): Entry(
            margin(each.error, each.tolerance), each.tolerance, each.verdict
        )
        for each in verdict.checks
    }
    both = [Move(*key, baseline.entries[key], now[key]) for key in now if key in baseline.entries]
    applied = [
        move
        for move in both
        if Outcome.NOT_APPLICABLE not in (move.before.verdict, move.now.verdict)
    ]
    return Moves(
        baseline,
        grew=sorted((m for m in applied if m.factor > FACTOR), key=lambda m: -m.factor),
        shrank=sorted((m for m in applied if m.factor < 1.0 / FACTOR), key=lambda m: m.factor),
        changed=[move for move in both if move.before.verdict != move.now.verdict],
        new=[key for key in now if key not in baseline.entries],
        gone=[key for key in baseline.entries if key not in now],
        compared=len(both),
    )


def _entry(row: Mapping[str, Any]) -> Entry:
    error, tolerance = row["error"], float(row["tolerance"])
    # A report from before there were verdicts tells only whether a check passed.
    verdict = str(row.get("verdict", Outcome.PASS if row["passed"] else Outcome.FAIL))
    return Entry(margin(None if error is None else float(error), tolerance), tolerance, verdict)
