"""The checks of a numerical solution.

Only the plain runs meet the exact motion: their deltas are held against those of honest solvers in
the same cases. Every other run is held against the plain one.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np

from stickslip_verification.drive.answer import Answer
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.solvers import SOLVERS, Solver
from stickslip_verification.judge.accuracy import (
    DIVERGED,
    LEAST,
    SATURATED,
    STANDS_OUT,
    Deviation,
    Matched,
    Ruler,
    matched,
    motion_of,
)
from stickslip_verification.judge.checks import compared, judge_probe, of_invariant, same_run
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.model.run import Run
from stickslip_verification.model.verdict import CheckResult, Klass
from stickslip_verification.run.experiment import Baseline, RandomTest
from stickslip_verification.run.runs import Runs
from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.family import load_family
from stickslip_verification.suite.sequences import PLAIN
from stickslip_verification.truth.named import BUILT_IN

OTHER_STEPS: Final = frozenset({"splitting", "time", "forces", "in_pieces", "unread", "busy"})
"""Runs and manners that take other steps, or meet absolute tolerances, and so err otherwise."""

OF_EXACT: Final = frozenset(
    {"step-ends-at-break-away", "step-ends-at-restick", "slips-after-break-away"}
)
"""Probes that ask for the very instant of a transition."""

OF_OWN_LAW: Final = 1e-7
"""Delta that is expected under a friction law that the solvers do not know."""

EXCUSED: Final = 0.1
"""Part of the random sequences in which an honest solver may stand out, since it decides of stick
and slip one step late where others do not: there it may err as in the worst case."""

OF_OUTPUT: Final = 100.0
"""How many times the delta of the motion another output may be off: it may lag by a step."""

TOO_STIFF: Final = "the block is too stiff here for steps so long"

CERTAIN: Final = 3
"""Cases that stand out from which on the model is wrong, whatever else is tried."""

AS_MUCH: Final = 10.0
"""How many times the delta of the plain run the run of other steps may have (measured: up to 5)."""


@dataclass(frozen=True)
class Solution:
    """The plain runs of an FMU in the cases that it can run, by id of the case."""

    cases: Mapping[str, Case]
    rulers: Mapping[str, Ruler]
    runs: Mapping[str, Run]

    @cached_property
    def motion(self) -> Mapping[str, Deviation]:
        """Delta by case, from the motion."""
        return {case: self.rulers[case].deviation(run) for case, run in self.runs.items()}

    @cached_property
    def like(self) -> Matched:
        """The honest solvers that it is like."""
        deltas = {case: deviation.delta for case, deviation in self.motion.items()}
        family = {
            solver: {
                case: of[case] if case in of else self._honest(solver, case) for case in deltas
            }
            for solver, of in load_family(SOLVERS).items()
        }
        return matched(deltas, family)

    @property
    def certain(self) -> bool:
        """Whether the plain runs say that the model is wrong."""
        expected = self.like.expected
        apart = [case for case, of in self.motion.items() if of.delta > STANDS_OUT * expected[case]]
        return len(apart) >= CERTAIN

    def _honest(self, solver: str, case: str) -> float:
        """Return the delta of an honest solver in a case of one's own."""
        if self.cases[case].law not in BUILT_IN:
            return OF_OWN_LAW
        return self.rulers[case].deviation(SOLVERS[solver].run(self.cases[case])).delta


def solution(baseline: Sequence[Baseline], plain: Mapping[str, Answer[Run]]) -> Solution:
    """Return the runs in cases of physics whose truth is known."""
    cases, rulers, runs = {}, {}, {}
    for of in baseline:
        case, run = of.case, plain[of.case.id].value
        if of.exact.value is not None and of.spreads.value is not None and run is not None:
            cases[case.id], runs[case.id] = case, run
            rulers[case.id] = Ruler(of.exact.value, of.spreads.value)
    return Solution(cases, rulers, runs)


def compare_numerical(runs: Runs, solved: Solution) -> Iterator[CheckResult]:
    """Yield the result of each case, other run, random sequence and probe."""
    invariants, contract = runs.experiment.invariants, runs.experiment.contract
    plainly = [each for each in invariants.sequences if each.manner == PLAIN][:1]
    restless = SOLVERS[solved.like.solver].rtol > 0.0
    for baseline in runs.experiment.baseline:
        case = baseline.case.id
        if case not in solved.runs:
            for invariant in plainly:
                yield _no_run(of_invariant(invariant, case, contract), runs.plain[case])
            continue
        ruler, plain = solved.rulers[case], solved.runs[case]
        expected = solved.like.expected[case]
        for invariant in plainly:
            empty = of_invariant(invariant, case, contract)
            yield _of_motion(empty, ruler, plain, solved.like, baseline.case, expected)
        allowed = _of_other_steps(solved.motion[case].delta, expected)
        for run in invariants.runs:
            if run.klass == Klass.PHYSICS and run.holds_for(baseline.case.law):
                empty = of_invariant(run, case, contract)
                may = allowed if restless or run.run in OTHER_STEPS else 0.0
                yield _of_other(empty, runs.others[case, run.run], plain, ruler, may)
    yield from _of_sequences(runs, solved, restless=restless)
    for probe in invariants.probes:
        if probe.id not in OF_EXACT:
            yield judge_probe(probe, contract, runs.probes[probe.id])


@dataclass(frozen=True)
class _Drawn:
    """The plain run of a random sequence, with the delta that is expected there."""

    run: Run
    ruler: Ruler
    delta: float
    expected: float
    too_stiff: bool

    @property
    def beyond(self) -> bool:
        """Whether the run leaves all numbers since the block is too stiff for its steps."""
        return self.too_stiff and not np.isfinite(self.delta)


def _of_sequences(runs: Runs, solved: Solution, *, restless: bool) -> Iterator[CheckResult]:
    tests = list(zip(runs.experiment.random, runs.random, strict=True))
    plain = {
        test.baseline.case.id: drawn
        for test, answer in tests
        if test.plain and (drawn := _drawn(test, answer.value, solved.like)) is not None
    }
    counted = [name for name, drawn in plain.items() if not drawn.beyond]
    apart = sorted(counted, key=lambda name: plain[name].delta / plain[name].expected, reverse=True)
    excused = set(apart[: int(EXCUSED * len(apart))])
    least = max(solved.like.expected.values(), default=LEAST)
    for test, answer in tests:
        case = test.baseline.case
        empty = of_invariant(test.manner, case.id, runs.experiment.contract)
        if case.id not in plain or answer.value is None:
            raised = (answer.failure or "").startswith(FmuError.__name__)
            if raised and _stiff(case, solved.like):
                answer = Answer(not_applicable=TOO_STIFF)
            yield _no_run(empty, answer)
            continue
        drawn = plain[case.id]
        expected = max(drawn.expected, least) if case.id in excused else drawn.expected
        if drawn.beyond:
            yield replace(empty, not_applicable=TOO_STIFF)
        elif test.plain:
            yield _of_motion(empty, drawn.ruler, drawn.run, solved.like, case, expected)
        else:
            allowed = _of_other_steps(drawn.delta, expected)
            may = allowed if restless or test.manner.manner in OTHER_STEPS else 0.0
            yield _of_other(empty, answer, drawn.run, drawn.ruler, may)


def _drawn(test: RandomTest, run: Run | None, like: Matched) -> _Drawn | None:
    """Return the plain run of a random sequence whose truth is known."""
    case, exact, spreads = (
        test.baseline.case,
        test.baseline.exact.value,
        test.baseline.spreads.value,
    )
    if exact is None or spreads is None or run is None:
        return None
    ruler = Ruler(exact, spreads)
    solved = [
        factor * min(ruler.deviation(solver.run(case)).delta, DIVERGED)
        for solver, factor in _honest(like)
        if case.law in BUILT_IN
    ]
    expected = solved or [*like.expected.values()]
    too_stiff = max(solved, default=0.0) >= DIVERGED or _stiff(case, like)
    # No sequence is held to more than the best case.
    least = min(like.expected.values(), default=LEAST)
    delta = ruler.deviation(run).delta
    return _Drawn(run, ruler, delta, max(least, *expected), too_stiff)


def _honest(like: Matched) -> Iterator[tuple[Solver, float]]:
    """Yield the solvers matched, with the factors of their deltas.

    One that is rougher than one of the family takes longer steps, which may diverge.
    """
    for name, factor in like.alike.items():
        solver = SOLVERS[name]
        yield solver, factor
        if solver.step and factor > 1.0:
            yield replace(solver, step=solver.step * factor), 1.0


def _steps(case: Case, like: Matched) -> Sequence[float]:
    """Return how long the steps are that an FMU seems to take in each of a case [s]."""
    name, factor = as_large(like)
    solver = SOLVERS[name]
    return [
        step.h / solver.parts if solver.parts else min(solver.step * factor, step.h)
        for step in case.steps
    ]


def _stiff(case: Case, like: Matched) -> bool:
    """Whether steps as long as an FMU seems to take are longer than a time constant of a case."""
    now, rate = dict(case.start), 0.0
    for step, h in zip(case.steps, _steps(case, like), strict=True):
        now.update(step.changes)
        rate = max(rate, h * now["c"] / now["m"], h * math.sqrt(now["k"] / now["m"]))
    return rate > 1.0


def as_large(like: Matched) -> tuple[str, float]:
    """Return the nearest solver, with errors about as large if there is one, and its factor."""
    alike = list(like.alike.items())
    return next((each for each in alike if abs(math.log10(each[1])) <= 1.0), alike[0])


def _of_other_steps(delta: float, expected: float) -> float:
    """Return the delta that a run of other steps may have."""
    return max(AS_MUCH * delta, STANDS_OUT * expected)


def _of_motion(
    empty: CheckResult, ruler: Ruler, run: Run, like: Matched, case: Case, expected: float
) -> CheckResult:
    """Judge a plain run: its motion against honest solvers, the rest against its motion."""
    tolerance = STANDS_OUT * expected
    worst = ruler.deviation(run)
    if worst.delta <= tolerance:
        others = [name for name in OUTPUT_NAMES if name not in motion_of(run)]
        # An event is told a step late at most, and a time between two of them.
        rest = ruler.deviation(run, others, 2.0 * max(_steps(case, like)))
        allowed = OF_OUTPUT * max(worst.delta, expected, LEAST)
        # Where more is allowed, the motion itself may be off throughout.
        if allowed <= SATURATED and (off := ruler.throughout(run, allowed)):
            rest = off
        if rest.delta > allowed:
            worst, tolerance = rest, allowed
    finite = np.isfinite(worst.delta)
    return replace(
        empty,
        quantity=_off(worst),
        expected=expected,
        got=worst.delta if finite else None,
        error=worst.delta if finite else None,
        tolerance=tolerance,
        because=f"{STANDS_OUT:g} times that of {like.solver} there; {OF_OUTPUT:g} of other outputs",
        passed=worst.delta <= tolerance,
        failure=None if finite else f"{worst.output} is no finite number at t = {worst.time:.6g} s",
    )


def _off(worst: Deviation) -> str:
    return f"data off, by {worst.output} at t = {worst.time:.6g} s"


def output_of(result: CheckResult) -> str:
    """Return the output that a plain run is off by."""
    return result.quantity.split()[3]


def _of_other(
    empty: CheckResult, answer: Answer[Run], plain: Run, ruler: Ruler, allowed: float
) -> CheckResult:
    """Judge another run: equal to the plain one, or as accurate up to `allowed`."""
    if answer.value is None:
        return _no_run(empty, answer)
    result = same_run(empty, plain, answer.value, ruler.band)
    if result.passed or not allowed:
        return result
    worst = ruler.deviation(answer.value)
    because = f"{AS_MUCH:g} times the plain run's, or what it may have itself"
    empty = replace(empty, quantity=_off(worst), tolerance=allowed, because=because)
    return compared(empty, allowed / AS_MUCH, worst.delta, worst.delta)


def _no_run(empty: CheckResult, answer: Answer[Run]) -> CheckResult:
    unknown = "its plain run is lacking, or what is near the exact one" if answer.value else None
    lacking = answer.not_applicable or unknown
    return replace(empty, failure=answer.failure, not_applicable=lacking)
