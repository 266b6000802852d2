"""A side made of the exact motion itself, whole or with a planted fault."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from stickslip_verification.cases import Case, load_cases
from stickslip_verification.record import Record, Series
from stickslip_verification.run import exact_motion, judge_case
from stickslip_verification.verdict import CheckResult

Columns = dict[str, Series]
Fault = Callable[[Columns], None]


def whole(_: Columns) -> None:
    """Plant nothing."""


class StandIn:
    """Gives the exact motion of each case, rounded to double, after `fault` has changed it.

    With `believed` the motion is that of other parameters than the case's.
    """

    def __init__(
        self,
        fault: Fault = whole,
        believed: Mapping[str, float] | None = None,
        name: str = "fmu",
    ) -> None:
        self.name = name
        self._fault = fault
        self._believed = believed or {}

    def run(self, case: Case) -> Record:
        """Give the exact motion with the fault in it."""
        parameters = {**case.parameters, **self._believed}
        record = exact_motion(replace(case, parameters=parameters)).record
        columns = {name: np.array(samples) for name, samples in record.outputs.items()}
        self._fault(columns)
        return Record(record.times, columns, record.initial)


class Crashing:
    """A side that raises on every case."""

    name = "fmu"

    def run(self, case: Case) -> Record:
        """Raise."""
        raise RuntimeError(f"no idea what to do\nwith {case.id}")


def named(case: str) -> Case:
    """Return the suite's case of this id."""
    return load_cases(case)[0]


def failures(case: Case, side: StandIn | Crashing) -> dict[str, CheckResult]:
    """Return the failed checks of a case on one side, by check id."""
    return {result.check: result for result in judge_case(case, [side]) if not result.passed}
