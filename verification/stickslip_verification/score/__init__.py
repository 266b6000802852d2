"""Anybody's curve: a time series of the block from any tool, measured against the exact cycle.

`read_curve` reads a CSV file, `score` judges a curve, `as_json` gives the verdict to machines.
Names are resolved when they are first used, so that importing this package costs nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from stickslip_verification.lazy import face

if TYPE_CHECKING:
    from stickslip_verification.score.csv_file import read_curve
    from stickslip_verification.score.curve import Curve, CurveError
    from stickslip_verification.score.judge import score
    from stickslip_verification.score.result import Cause, Compared, Score, as_json

_HOME = {
    "Cause": "result",
    "Compared": "result",
    "Curve": "curve",
    "CurveError": "curve",
    "Score": "result",
    "as_json": "result",
    "read_curve": "csv_file",
    "score": "judge",
}

__all__ = [
    "Cause",
    "Compared",
    "Curve",
    "CurveError",
    "Score",
    "as_json",
    "read_curve",
    "score",
]

__getattr__, __dir__ = face(__name__, _HOME)
