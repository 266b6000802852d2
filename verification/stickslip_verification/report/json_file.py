"""The verdict as JSON that any program reads, written whole or not at all."""

import json
import math
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from stickslip_verification.model.verdict import CheckResult, Verdict
from stickslip_verification.model.whole_file import write_whole


def as_json(verdict: Verdict) -> dict[str, Any]:
    """Return the verdict as plain JSON values: summary, by_kind, checks and what is with them.

    A number that is not finite becomes null. A check without anything to compare has null for
    ``got`` and ``error``, and its ``because`` starts with what happened.
    """
    kills = verdict.kills
    values = {
        "summary": verdict.summary,
        "passed": verdict.passed,
        "by_kind": verdict.by_kind,
        "checks": [_row(result) for result in verdict.checks],
        "orders": [asdict(order) for order in verdict.orders],
        "kills": None if kills is None else {"passed": kills.passed, **asdict(kills)},
        "contract": asdict(verdict.contract),
        "tables": [asdict(table) for table in verdict.tables],
        "provenance": verdict.provenance,
    }
    return {key: _plain(value) for key, value in values.items()}


def json_text(verdict: Verdict) -> str:
    """Return `as_json` as the text of a file."""
    return json.dumps(as_json(verdict), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def write_json(verdict: Verdict, path: Path) -> None:
    """Write `as_json` to `path`, making its folder; an interrupted write leaves the old file."""
    write_whole(path, json_text(verdict))


def _row(result: CheckResult) -> dict[str, Any]:
    row = vars(result) | {"class": result.klass, "verdict": result.verdict}
    if result.failure is not None:
        row["because"] = f"{result.failure} (the tolerance: {result.because})"
    return {key: value for key, value in row.items() if key not in ("klass", "late")}


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
