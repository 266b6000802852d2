"""A side made of the exact motion itself, whole or with a planted fault."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from stickslip_verification.drive.exact import Exact, exact_motion
from stickslip_verification.drive.sides import Side
from stickslip_verification.judge.checks import EXACT_CONTRACT, REFERENCE_CONTRACT, judge
from stickslip_verification.model.run import Run, Series
from stickslip_verification.model.verdict import CheckResult
from stickslip_verification.suite.cases import Case, load_cases

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

    def run(self, case: Case) -> Run:
        """Give the exact motion with the fault in it."""
        parameters = {**case.parameters, **self._believed}
        other = replace(case, parameters=parameters)
        record = exact_motion(other).record if self._believed else exact_of(case.id).record
        columns = {name: np.array(samples) for name, samples in record.outputs.items()}
        self._fault(columns)
        return Run(record.times, columns, record.initial)


def named(case: str) -> Case:
    """Return the suite's case of this id."""
    return load_cases(case)[0]


@cache
def exact_of(case: str) -> Exact:
    """Return the exact motion of a case of the suite, computed once."""
    return exact_motion(named(case))


def judge_case(case: Case, sides: Sequence[Side]) -> list[CheckResult]:
    """Return the result of every check of a case on every side."""
    results = []
    for side in sides:
        contract = EXACT_CONTRACT if side.name == "fmu" else REFERENCE_CONTRACT
        record = side.run(case)
        results += [
            judge(case, check, contract, exact_of(case.id), record) for check in case.checks
        ]
    return results


def failures(case: Case, side: Side) -> dict[str, CheckResult]:
    """Return the failed checks of a case on one side, by check id."""
    return {result.check: result for result in judge_case(case, [side]) if not result.passed}
