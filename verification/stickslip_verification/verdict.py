"""What came out: one result per check and side, their count, and where they come from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class CheckResult:
    """One check on one side.

    ``expected`` and ``got`` are in ``unit``, at the worst place where a check looks at many.
    ``error`` is in the measure of the check, as ``tolerance`` is. ``got`` and ``error`` are None
    where the side gave nothing that can be compared; ``failure`` then says why, else it is None.
    ``truth`` is the kind of truth, ``side`` fmu or reference.
    """

    case: str
    check: str
    quantity: str
    unit: str
    truth: str
    side: str
    expected: float | None
    got: float | None
    error: float | None
    tolerance: float
    because: str
    passed: bool
    failure: str | None = None


@dataclass(frozen=True)
class Verdict:
    """All results of a run and its provenance; `run.verify` makes it."""

    checks: Sequence[CheckResult]
    provenance: Mapping[str, Any] = field(default_factory=dict)

    @property
    def summary(self) -> dict[str, int]:
        """How many checks passed and failed: ``{"passed": n, "failed": n}``."""
        passed = sum(result.passed for result in self.checks)
        return {"passed": passed, "failed": len(self.checks) - passed}

    @property
    def passed(self) -> bool:
        """Whether there are checks and every one passed."""
        return bool(self.checks) and all(result.passed for result in self.checks)
