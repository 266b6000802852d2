"""Comparisons of the runs of an FMU, and of the reference: every check, invariant and probe.

Of a numerical solution only the plain runs meet the exact motion: their deltas are held against
those of honest solvers in the same cases. Every other run is held against the plain one.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import product
from typing import Final

import numpy as np

from ..drive.description import FmuError
from ..drive.exact import Exact
from ..drive.processes import Answer
from ..drive.solvers import SOLVERS, Solver
from ..judge import accuracy, checks
from ..judge.accuracy import Plain
from ..model.quantities import OUTPUT_NAMES
from ..model.verdict import CheckResult, Run
from ..suite.cases import Case, load_family
from ..suite.sequences import PLAIN
from ..truth.course import BUILT_IN
from .experiment import Baseline, Runs

OTHER_STEPS: Final = frozenset(
    {"splitting", "time", "forces", "in_pieces", "unread", "busy", "shifted", "continued"}
)
"""Runs and manners that take other steps, or meet absolute tolerances, and so err otherwise."""

OF_EXACT: Final = ("step-ends-at-break-away", "step-ends-at-restick", "slips-after-break-away")
"""Probes that ask for the very instant of a transition."""

OF_OWN_LAW: Final = 1e-7  # delta that is expected under a friction law that the solvers do not know
EXCUSED: Final = 0.1
"""Part of the random sequences in which an honest solver may stand out, since it decides of stick
and slip one step late where others do not: there it may err as in the worst case."""
MANY: Final = 20
"""Cases of which an honest solver without its kin stands out in one, by up to 36 (measured)."""
FEW: Final = 5  # in fewer cases nothing is said of all of them
ROUND: Final[Mapping[str, float]] = {"shifted": EXCUSED, "continued": 0.0}
"""Runs that steps of the same length make alike but for rounding, and the part of the cases in
which that may end a stick a step earlier or later."""
MOSTLY: Final = 0.75
"""Part of the cases in which such runs agree to rounding where the steps are of the same length."""
APART: Final = 1e-6  # part of the largest value that two runs differ by where it is no rounding
OF_OUTPUT: Final = 100.0
"""How many times the delta of the motion another output may be off: it may lag by a step."""

TOO_STIFF: Final = "the block is too stiff here for steps so long"

CERTAIN: Final = 3  # cases that stand out from which on the model is wrong, whatever else is tried
AS_MUCH: Final = 10.0
"""How many times the delta of the plain run the run of other steps may have (measured: up to 5)."""


@dataclass(frozen=True)
class Solution:
    """The plain runs of an FMU in the cases that it can run, by id of the case.

    ``solved``: through model exchange, by a solver that adapts its steps and locates events.
    """

    plain: Mapping[str, Plain]
    solved: bool = False

    @cached_property
    def like(self) -> accuracy.Matched:
        """The honest solvers that it is like."""
        family = {
            solver: {
                case: of[case] if case in of else self._honest(solver, case) for case in self.plain
            }
            for solver, of in load_family(SOLVERS).items()
        }
        deltas = {case: plain.motion.delta for case, plain in self.plain.items()}
        like = accuracy.matched(deltas, family)
        return replace(like, adapts=self.solved or SOLVERS[like.solver].rtol > 0.0)

    @cached_property
    def expected(self) -> Mapping[str, float]:
        """Delta that is expected by case; of `MANY` the farthest may be off twice as much."""
        expected = dict(self.like.expected)
        if len(expected) >= MANY:
            worst = max(expected, key=lambda case: self.plain[case].motion.delta / expected[case])
            expected[worst] *= 2.0
        return expected

    @property
    def certain(self) -> bool:
        """Whether the plain runs say that the model is wrong."""
        allowed = {case: accuracy.STANDS_OUT * delta for case, delta in self.like.expected.items()}
        return sum(of.motion.delta > allowed[case] for case, of in self.plain.items()) >= CERTAIN

    @cached_property
    def mismatched(self) -> bool:
        """Whether x_dot is not the velocity of x: in the middle case it is far less accurate."""
        both = [of for of in self.plain.values() if {"x", "x_dot"} <= of.run.outputs.keys()]
        parts = [of.of("x_dot") / of.of("x") for of in both]
        return len(parts) >= FEW and float(np.median(parts)) > OF_OUTPUT

    def _honest(self, solver: str, case: str) -> float:
        """Return the delta of an honest solver in a case of one's own."""
        plain = self.plain[case]
        if plain.case.law not in BUILT_IN:
            return OF_OWN_LAW
        return plain.ruler.deviation(SOLVERS[solver].run(plain.case)).delta


def solution(
    baseline: Sequence[Baseline], plain: Mapping[str, Answer[Run]], contract: checks.Contract
) -> Solution:
    """Return the runs in cases of physics whose truth is known."""
    known = (_plain(of, plain[of.case.id]) for of in baseline)
    return Solution({of.case.id: of for of in known if of is not None}, contract.solved)


def _plain(baseline: Baseline, answer: Answer[Run]) -> Plain | None:
    exact, spreads = baseline.exact.value, baseline.spreads.value
    if exact is None or spreads is None or answer.value is None:
        return None
    return Plain(baseline.case, accuracy.Ruler(exact, spreads), answer.value)


def compare_numerical(runs: Runs, solved: Solution) -> Iterator[CheckResult]:
    """Yield the result of each case, other run, random sequence and probe."""
    invariants, contract = runs.experiment.invariants, runs.experiment.contract
    not_round = _not_round(runs, solved)
    plainly = [each for each in invariants.sequences if each.manner == PLAIN][:1]
    for baseline in runs.experiment.baseline:
        case = baseline.case.id
        plain, expected = solved.plain.get(case), solved.expected.get(case, 0.0)
        if plain is not None and solved.mismatched:
            expected = min(expected, OF_OUTPUT / accuracy.STANDS_OUT * plain.of("x"))
        for invariant in plainly:
            empty = checks.of_invariant(invariant, case, contract)
            yield _judge(empty, PLAIN, runs.plain[case], plain, solved.like, expected)
        for run in runs.experiment.runs if plain is not None else ():
            if run.holds_for(baseline.case.law):
                empty, other = checks.of_invariant(run, case, contract), runs.others[case, run.run]
                row = not_round.get((case, run.run))
                yield row or _judge(empty, run.run, other, plain, solved.like, expected)
    yield from _of_sequences(runs, solved.like)
    for probe in invariants.probes:
        if probe.id not in OF_EXACT:
            yield checks.judge_probe(probe, contract, runs.probes[probe.id])


def _not_round(runs: Runs, solved: Solution) -> dict[tuple[str, str], CheckResult]:
    """Return the results, by case and run, of the few that are off by more than rounding."""
    rows: dict[tuple[str, str], CheckResult] = {}
    if solved.like.adapts:
        return rows
    for run in runs.experiment.runs:
        if run.run not in ROUND:
            continue
        alike = {}
        for case, plain in solved.plain.items():
            empty = checks.of_invariant(run, case, runs.experiment.contract)
            other = runs.others[case, run.run].value
            if other is not None and plain.motion.delta < accuracy.SATURATED:
                alike[case, run.run] = checks.same_run(empty, plain.run, other, plain.ruler.band)
        rounded = sum(row.passed for row in alike.values())
        off = {place: row for place, row in alike.items() if (row.error or 0.0) > APART}
        if rounded >= MOSTLY * len(alike) and len(off) > ROUND[run.run] * len(alike):
            rows |= off
    return rows


def _of_sequences(runs: Runs, like: accuracy.Matched) -> Iterator[CheckResult]:
    tests = list(zip(runs.experiment.random, runs.random, strict=True))
    ran_plainly = (_plain(test.baseline, answer) for test, answer in tests if test.plain)
    drawn = {of.case.id: of for of in ran_plainly if of is not None}
    expected, too_stiff = {}, set()
    for name, plain in drawn.items():
        expected[name], stiff = _expected(plain, like)
        if stiff and not np.isfinite(plain.motion.delta):
            too_stiff.add(name)
    counted = [name for name in drawn if name not in too_stiff]
    apart = sorted(
        counted, key=lambda name: drawn[name].motion.delta / expected[name], reverse=True
    )
    least = max(like.expected.values(), default=accuracy.LEAST)
    for name in apart[: int(EXCUSED * len(apart))]:
        expected[name] = max(expected[name], least)
    for test, answer in tests:
        case, name = test.baseline.case, test.baseline.case.id
        empty = checks.of_invariant(test.manner, name, runs.experiment.contract)
        ran = name in drawn and answer.value is not None
        raised = (answer.failure or "").startswith(FmuError.__name__)
        if name in too_stiff if ran else raised and like.alike and _stiff(case, like):
            yield replace(empty, not_applicable=TOO_STIFF)
        else:
            of, known = test.manner.manner, drawn.get(name)
            row = _judge(empty, of, answer, known, like, expected.get(name, 0.0))
            if row.failed and known and known.motion.delta <= accuracy.STANDS_OUT * expected[name]:
                # Not all honest solvers were run there.
                most = max(expected[name], _expected(known, like, whole=True)[0])
                row = _judge(empty, of, answer, known, like, most)
            yield row


def _judge(
    empty: CheckResult,
    manner: str,
    answer: Answer[Run],
    plain: Plain | None,
    like: accuracy.Matched,
    expected: float,
) -> CheckResult:
    if answer.value is None:
        return checks.without(empty, answer)
    if plain is None:
        lacking = "its plain run is lacking, or what is near the exact one"
        return replace(empty, not_applicable=lacking)
    if manner == PLAIN:
        return _of_motion(empty, plain, like, expected)
    result = checks.same_run(empty, plain.run, answer.value, plain.ruler.band)
    if result.passed or not (manner in OTHER_STEPS or like.adapts):
        return result
    worst = plain.ruler.deviation(answer.value)
    allowed = max(AS_MUCH * plain.motion.delta, accuracy.STANDS_OUT * expected)
    if worst.delta <= allowed and manner not in OTHER_STEPS:
        step = 2.0 * max(_steps(plain.case, like))
        rest, own = (
            plain.ruler.deviation(run, set(run.outputs) - set(accuracy.motion_of(run)), step)
            for run in (answer.value, plain.run)
        )
        most = max(AS_MUCH * own.delta, OF_OUTPUT / AS_MUCH * allowed)
        worst, allowed = (rest, most) if rest.delta > most else (worst, allowed)
    because = f"{AS_MUCH:g} times the plain run's, or what it may have itself"
    empty = replace(empty, quantity=_off(worst), tolerance=allowed, because=because)
    return checks.compared(empty, allowed / AS_MUCH, worst.delta, worst.delta)


def _expected(plain: Plain, like: accuracy.Matched, *, whole: bool = False) -> tuple[float, bool]:
    """Return the delta that is expected in a sequence, and whether the block is too stiff there.

    Unless it is asked for `whole`, honest solvers are run until one errs enough for the FMU not to
    stand out.
    """
    case, delta = plain.case, plain.motion.delta
    # No sequence is held to more than the best case.
    least = min(like.expected.values(), default=accuracy.LEAST)
    solved = [] if case.law in BUILT_IN else [*like.expected.values()]
    for solver, factor in _honest(like) if case.law in BUILT_IN else ():
        if not whole and delta <= accuracy.STANDS_OUT * max([least, *solved]):
            break
        honest = plain.ruler.deviation(solver.run(case)).delta
        solved.append(factor * min(honest, accuracy.DIVERGED))
    # An FMU that answers in no case is like no solver.
    longer = bool(like.alike) and _stiff(case, like)
    too_stiff = max(solved, default=0.0) >= accuracy.DIVERGED or longer
    return max([least, *solved]), too_stiff


def _honest(like: accuracy.Matched) -> Iterator[tuple[Solver, float]]:
    """Yield the solvers matched, with the factors of their deltas.

    One that is rougher than one of the family takes longer steps, which may diverge.
    """
    for name, factor in like.alike.items():
        solver = SOLVERS[name]
        yield solver, factor
        if solver.step and factor > 1.0:
            yield replace(solver, step=solver.step * factor), 1.0


def _steps(case: Case, like: accuracy.Matched) -> Sequence[float]:
    """Return how long the steps are that an FMU seems to take in each of a case [s]."""
    name, factor = as_large(like)
    solver = SOLVERS[name]
    return [
        step.h / solver.parts if solver.parts else min(solver.step * factor, step.h)
        for step in case.steps
    ]


def _stiff(case: Case, like: accuracy.Matched) -> bool:
    """Whether steps as long as an FMU seems to take are longer than a time constant of a case."""
    now, rate = dict(case.start), 0.0
    for step, h in zip(case.steps, _steps(case, like), strict=True):
        now.update(step.changes)
        rate = max(rate, h * now["c"] / now["m"], h * math.sqrt(now["k"] / now["m"]))
    return rate > 1.0


def as_large(like: accuracy.Matched) -> tuple[str, float]:
    """Return the nearest solver, with errors about as large if there is one, and its factor."""
    alike = list(like.alike.items())
    return next((each for each in alike if abs(math.log10(each[1])) <= 1.0), alike[0])


def _of_motion(
    empty: CheckResult, plain: Plain, like: accuracy.Matched, expected: float
) -> CheckResult:
    ruler, run, tolerance = plain.ruler, plain.run, accuracy.STANDS_OUT * expected
    worst = plain.motion
    if worst.delta <= tolerance:
        others = [name for name in OUTPUT_NAMES if name not in accuracy.motion_of(run)]
        # An event is told a step late at most, and a time between two of them.
        rest = ruler.deviation(run, others, 2.0 * max(_steps(plain.case, like)))
        allowed = OF_OUTPUT * max(worst.delta, expected, accuracy.LEAST)
        # Where more is allowed, the motion itself may be off throughout.
        if allowed <= accuracy.SATURATED and (off := ruler.throughout(run, allowed)):
            rest = off
        if rest.delta > allowed:
            worst, tolerance = rest, allowed
        elif (creep := ruler.creep(run, worst.delta)).delta > accuracy.STILL:
            worst, tolerance = creep, accuracy.STILL
    error, at = worst.delta if np.isfinite(worst.delta) else None, f"at t = {worst.time:.6g} s"
    said = f"{worst.output} is no finite number {at}" if error is None else None
    if error is not None and worst.output == accuracy.IN_STICK and error > tolerance:
        said = f"the mass moves in stick {at}, {100.0 * error:.2g} % of the pull's way"
    return replace(
        empty,
        quantity=_off(worst),
        expected=expected,
        got=error,
        error=error,
        tolerance=tolerance,
        because=f"{accuracy.STANDS_OUT:g} times that of {like.solver} there; "
        f"{OF_OUTPUT:g} of other outputs",
        passed=worst.delta <= tolerance,
        failure=said,
    )


def _off(worst: accuracy.Deviation) -> str:
    return f"data off, by {worst.output} at t = {worst.time:.6g} s"


def place_of(result: CheckResult) -> str:
    """Return the output and the time at which a run is farthest off in its data, else nothing."""
    return result.quantity.partition("data off, by ")[2]


FINISHES = "runs-to-the-end"
"""The check that a run which does not finish fails; for the others nothing is there to judge."""


def compare(runs: Runs, *, reference: bool = True) -> Iterator[CheckResult]:
    """Yield the result of every check, case by case, then of every random test and probe.

    Without `reference` only what the FMU did is judged.
    """
    contract = runs.experiment.contract
    if contract.numerical:
        yield from compare_numerical(runs, solution(runs.experiment.baseline, runs.plain, contract))
        return
    for baseline in runs.experiment.baseline:
        yield from _compare_case(runs, baseline, reference=reference)
    for test, answer in zip(runs.experiment.random, runs.random, strict=True):
        empty = checks.of_invariant(test.manner, test.baseline.case.id, contract)
        yield _result(empty, test.baseline, answer, partial(checks.judge_sequence, empty, contract))
    for probe in runs.experiment.invariants.probes:
        yield checks.judge_probe(probe, contract, runs.probes[probe.id])


def _compare_case(runs: Runs, baseline: Baseline, *, reference: bool) -> Iterator[CheckResult]:
    case, plain = baseline.case, runs.plain[baseline.case.id]
    invariants, contract = runs.experiment.invariants, runs.experiment.contract
    sides = [(contract, plain), (checks.REFERENCE_CONTRACT, baseline.reference)]
    sides = sides if reference else sides[:1]
    for check, (side, answer) in product(case.checks, sides):
        empty = checks.of_check(case, check, side)
        yield _result(empty, baseline, answer, partial(checks.judge, case, check, side))
    for residual, (side, answer) in product(baseline.invariants, sides):
        empty = checks.of_invariant(residual, case, side)
        judge = partial(checks.judge_residual, residual, case, side)
        yield _result(empty, baseline, answer, judge)
    for run in runs.experiment.runs:
        if run.holds_for(case.law):
            empty = checks.of_invariant(run, case, contract)
            other = runs.others[case.id, run.run]
            judge = partial(checks.judge_run, run, case, contract, other=other)
            yield _result(empty, baseline, plain, judge)
    for agreement in invariants.agreements:
        agreed = checks.agreeing(agreement, case)
        if agreed is not None and agreement.holds_for(case.law):
            answers = (baseline.exact, plain, baseline.reference)
            yield checks.judge_agreement(agreement, case, agreed, contract, *answers)
    for order, seen in baseline.orders if reference else ():
        yield from checks.judge_order(order, case, checks.REFERENCE_CONTRACT, seen)


def _result(
    empty: CheckResult,
    baseline: Baseline,
    answer: Answer[Run],
    judge: Callable[[Exact, Run], CheckResult],
) -> CheckResult:
    """Return what `judge` makes of a run; without truth or run, `empty` with the reason.

    Of the checks whose run did not end one fails; the others say that there is nothing to judge.
    """
    exact, run = baseline.exact, answer.value
    if exact.value is None:
        return replace(empty, failure=f"the truth cannot be computed: {exact.failure}")
    if run is not None:
        return judge(exact.value, run)
    if answer.not_applicable is not None or empty.check == FINISHES:
        return checks.without(empty, answer)
    return replace(empty, not_applicable=f"the run did not end: see {FINISHES}")
