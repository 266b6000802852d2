"""Residuals of the equations of motion, of energy and between outputs, from the samples."""

import inspect

from stickslip_verification.judge.metrics import energy, events, outputs, slip
from stickslip_verification.judge.metrics.course import (
    CheckError,
    Course,
    LackingError,
    Metric,
    Residual,
)
from stickslip_verification.judge.metrics.direct import DIRECT

__all__ = ["METRICS", "CheckError", "Course", "LackingError", "Metric", "Residual"]

METRICS: dict[str, Metric] = {
    f"{module.__name__.rpartition('.')[2]}.{name}": metric
    for module in (slip, events, energy, outputs)
    for name, metric in inspect.getmembers(module, inspect.isfunction)
    if metric.__module__ == module.__name__ and not name.startswith("_")
} | DIRECT
"""What an invariant can name as ``metric``: `DIRECT`, and all public functions of the modules."""
