"""The verdict as JSON that any program reads, written whole or not at all."""

import json
import math
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from stickslip_verification.model.verdict import CheckResult, KillMatrix, Verdict
from stickslip_verification.model.whole_file import write_whole

KEYS = {
    "case": "case",
    "check": "check",
    "quantity": "quantity",
    "unit": "unit",
    "truth": "truth",
    "class": "klass",
    "side": "side",
    "measure": "measure",
    "expected": "expected",
    "got": "got",
    "error": "error",
    "tolerance": "tolerance",
    "because": "because",
    "passed": "passed",
    "decides": "decides",
    "verdict": "verdict",
    "failure": "failure",
    "not_applicable": "not_applicable",
}
"""The keys of a check and the names in `CheckResult` that they stand for."""


def as_json(verdict: Verdict) -> dict[str, Any]:
    """Return the verdict as plain JSON values: summary, by_kind, checks and what is beside them.

    A number that is not finite becomes null. A check without anything to compare has null for
    ``got`` and ``error``, and its ``because`` starts with what happened.
    """
    return {
        "summary": dict(verdict.summary),
        "passed": verdict.passed,
        "by_kind": verdict.by_kind,
        "checks": [_row(result) for result in verdict.checks],
        "orders": [_plain(asdict(order)) for order in verdict.orders],
        "kills": None if verdict.kills is None else _kills(verdict.kills),
        "contract": asdict(verdict.contract),
        "tables": [_plain(asdict(table)) for table in verdict.tables],
        "provenance": _plain(verdict.provenance),
    }


def json_text(verdict: Verdict) -> str:
    """Return `as_json` as the text of a file."""
    return json.dumps(as_json(verdict), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def write_json(verdict: Verdict, path: Path) -> None:
    """Write `as_json` to `path`, making its folder; an interrupted write leaves the old file."""
    write_whole(path, json_text(verdict))


def _row(result: CheckResult) -> dict[str, Any]:
    row = {key: _plain(getattr(result, name)) for key, name in KEYS.items()}
    if result.failure is not None:
        row["because"] = f"{result.failure} (the tolerance: {result.because})"
    return row


def _kills(kills: KillMatrix) -> dict[str, Any]:
    return {"passed": kills.passed, **_plain(asdict(kills))}


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
