"""The verdict as a file: JSON that any program reads, written whole or not at all."""

from __future__ import annotations

import json
import math
import os
import tempfile
from pathlib import Path
from typing import Any

from stickslip_verification.verdict import CheckResult, Verdict

KEYS = (
    "case",
    "check",
    "quantity",
    "unit",
    "truth",
    "side",
    "expected",
    "got",
    "error",
    "tolerance",
    "because",
    "passed",
)


def as_json(verdict: Verdict) -> dict[str, Any]:
    """Give ``summary``, ``checks`` and ``provenance`` as plain JSON values.

    A number that is not finite becomes null. A check without anything to compare has null for
    ``got`` and ``error``, and its ``because`` starts with what happened.
    """
    return {
        "summary": dict(verdict.summary),
        "checks": [_row(result) for result in verdict.checks],
        "provenance": _plain(dict(verdict.provenance)),
    }


def write_json(verdict: Verdict, path: Path) -> None:
    """Write `as_json` to `path`, making its folder; an interrupted write leaves the old file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps(as_json(verdict), indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=path.name, suffix=".part")
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
        Path(name).chmod(0o644)
        Path(name).replace(path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def _row(result: CheckResult) -> dict[str, Any]:
    row = {key: _plain(getattr(result, key)) for key in KEYS}
    if result.failure is not None:
        row["because"] = f"{result.failure} (the tolerance: {result.because})"
    return row


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
