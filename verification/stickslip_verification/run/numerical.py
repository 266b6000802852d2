"""The verdict on a numerical solution: is the model right, and how accurate is it.

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
from stickslip_verification.drive.solvers import SOLVERS, Solver
from stickslip_verification.drive.workers import NOT_MADE
from stickslip_verification.judge.accuracy import (
    DIVERGED,
    LEAST,
    SATURATED,
    STANDS_OUT,
    Deviation,
    Matched,
    Ruler,
    WrongParameter,
    matched,
    motion_of,
    wrong_parameter,
)
from stickslip_verification.judge.checks import Contract
from stickslip_verification.judge.invariant_checks import blank, judge_probe
from stickslip_verification.judge.run_checks import same_run
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.model.run import Run
from stickslip_verification.model.verdict import (
    LIKELIEST,
    SEQUENCE,
    CheckResult,
    Kind,
    Klass,
    Question,
    Table,
)
from stickslip_verification.run.baseline import Baseline, Trial
from stickslip_verification.run.causes import WORST, Shown, cause
from stickslip_verification.run.judged import Answers
from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.family import load_family
from stickslip_verification.suite.invariants import Invariants
from stickslip_verification.suite.sequences import PLAIN
from stickslip_verification.truth.named import BUILT_IN

OTHER_STEPS: Final = frozenset({"splitting", "time", "in_pieces", "unread", "busy"})
"""Runs and manners that take other steps, and so make other errors."""

OF_EXACT: Final = frozenset(
    {"step-ends-at-break-away", "step-ends-at-restick", "slips-after-break-away"}
)
"""Probes that ask for the very instant of a transition."""

FEW: Final = 5
"""In fewer cases a free factor explains anything."""

TOO_ROUGH: Final = 0.03
"""Delta in the middle case from which on nothing can be told."""

OF_OWN_LAW: Final = 1e-7
"""Delta that is expected under a friction law that the solvers do not know."""

EXCUSED: Final = 0.1
"""Part of the random sequences in which an honest solver may stand out, since it decides of stick
and slip one step late where others do not: there it may err as in the worst case."""

OF_OUTPUT: Final = 100.0
"""How many times the delta of the motion another output may be off: it may lag by a step."""

AS_MUCH: Final = 10.0
"""How many times the delta of the plain run the run of other steps may have (measured: up to 5)."""

CYCLE: Final[Mapping[str, str]] = {
    "jump": "delta_x",
    "stick": "t_stick",
    "slip": "t_slip",
    "period": "T",
    "force": "F",
}
"""What a cycle is described by, and the outputs that show it; of the force the largest."""

MOST_ASKED: Final = 50.0
"""Above it [%] no error is one of the steps."""

_EXACT: Final = 1e-11
"""A solution whose middle delta is below this one is exact."""


@dataclass(frozen=True)
class Judged:
    """The plain runs of an FMU in the cases that it can run.

    Attributes
    ----------
    cases, rulers, runs
        By id of the case.
    """

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
        deltas = {case: each.delta for case, each in self.motion.items()}
        family = {
            solver: {
                case: of[case] if case in of else self._honest(solver, case) for case in deltas
            }
            for solver, of in load_family().items()
        }
        return matched(deltas, family)

    def _honest(self, solver: str, case: str) -> float:
        """Return the delta of an honest solver in a case of one's own."""
        if self.cases[case].law not in BUILT_IN:
            return OF_OWN_LAW
        return self.rulers[case].deviation(SOLVERS[solver].run(self.cases[case])).delta


def judged(baseline: Sequence[Baseline], answers: Answers) -> Judged:
    """Return the runs in cases of physics whose truth is known."""
    cases, rulers, runs = {}, {}, {}
    for each in baseline:
        run = answers.plain[each.case.id].value
        if each.exact.value is not None and each.spreads is not None and run is not None:
            assert each.spreads.value is not None
            cases[each.case.id] = each.case
            rulers[each.case.id] = Ruler(each.exact.value, each.spreads.value)
            runs[each.case.id] = run
    return Judged(cases, rulers, runs)


def judge_numerical(
    found: Judged,
    baseline: Sequence[Baseline],
    invariants: Invariants,
    answers: Answers,
    contract: Contract,
    trials: Sequence[Trial],
) -> Iterator[CheckResult]:
    """Yield the result of each case, other run, random sequence and probe."""
    plainly = next((each for each in invariants.sequences if each.manner == PLAIN), None)
    restless = SOLVERS[found.like.solver].rtol > 0.0
    for each in baseline:
        case = each.case.id
        plain = answers.plain[case]
        empty = None if plainly is None else blank(plainly, case, contract)
        if case not in found.runs:
            if empty is not None:
                yield _no_run(empty, plain)
            continue
        expected = found.like.expected[case]
        if empty is not None:
            yield _of_motion(
                empty, found.rulers[case], found.runs[case], found.like.solver, expected
            )
        allowed = _of_other_steps(found.motion[case].delta, expected)
        for run in invariants.runs:
            if run.klass == Klass.PHYSICS and run.holds_for(each.case.law):
                yield _of_other(
                    blank(run, case, contract),
                    answers.runs[case, run.run],
                    found.runs[case],
                    found.rulers[case],
                    allowed if restless or run.run in OTHER_STEPS else 0.0,
                )
    yield from _of_sequences(found, answers, contract, trials, restless=restless)
    for invariant in invariants.probes:
        if invariant.id not in OF_EXACT:
            yield judge_probe(invariant, contract, answers.probes[invariant.id])


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


def _of_sequences(
    found: Judged, answers: Answers, contract: Contract, trials: Sequence[Trial], *, restless: bool
) -> Iterator[CheckResult]:
    plain = _drawn(found, answers, trials)
    counted = [name for name, each in plain.items() if not each.beyond]
    apart = sorted(counted, key=lambda each: plain[each].delta / plain[each].expected, reverse=True)
    excused = set(apart[: int(EXCUSED * len(apart))])
    least = max(found.like.expected.values(), default=LEAST)
    for trial, answer in zip(trials, answers.sequences, strict=True):
        case, manner = trial.baseline.case.id, trial.manner
        empty = blank(manner, case, contract)
        if case not in plain or answer.value is None:
            yield _no_run(empty, answer)
            continue
        drawn = plain[case]
        expected = max(drawn.expected, least) if case in excused else drawn.expected
        if drawn.beyond:
            yield replace(empty, not_applicable="the block is too stiff here for steps so long")
        elif manner.manner == PLAIN:
            yield _of_motion(empty, drawn.ruler, drawn.run, found.like.solver, expected)
        else:
            allowed = _of_other_steps(drawn.delta, expected)
            may = allowed if restless or manner.manner in OTHER_STEPS else 0.0
            yield _of_other(empty, answer, drawn.run, drawn.ruler, may)


def _drawn(found: Judged, answers: Answers, trials: Sequence[Trial]) -> dict[str, _Drawn]:
    """Return the plain runs of the random sequences whose truth is known, by id."""
    plain = {}
    for trial, answer in zip(trials, answers.sequences, strict=True):
        each, exact, run = trial.baseline, trial.baseline.exact.value, answer.value
        spreads = None if each.spreads is None else each.spreads.value
        if trial.manner.manner != PLAIN or exact is None or spreads is None or run is None:
            continue
        ruler = Ruler(exact, spreads)
        solved = [
            factor * min(ruler.deviation(solver.run(each.case)).delta, DIVERGED)
            for solver, factor in _honest(found.like)
            if each.case.law in BUILT_IN
        ]
        expected = solved or [*found.like.expected.values()]
        delta = ruler.deviation(run).delta
        too_stiff = max(solved, default=0.0) >= DIVERGED or _stiff(each.case, found.like)
        # No sequence is held to more than the best case.
        least = min(found.like.expected.values(), default=LEAST)
        plain[each.case.id] = _Drawn(run, ruler, delta, max(least, *expected), too_stiff)
    return plain


def _honest(like: Matched) -> Iterator[tuple[Solver, float]]:
    """Yield the solvers matched, with the factors of their deltas.

    One that is rougher than one of the family takes longer steps, which may diverge.
    """
    for name, factor in like.alike.items():
        solver = SOLVERS[name]
        yield solver, factor
        if solver.step and factor > 1.0:
            yield replace(solver, step=solver.step * factor), 1.0


def _stiff(case: Case, like: Matched) -> bool:
    """Whether steps as long as an FMU seems to take are longer than a time constant of a case."""
    name, factor = _as_large(like)
    solver = SOLVERS[name]
    now, rate = dict(case.start), 0.0
    for step in case.steps:
        now.update(step.changes)
        h = step.h / solver.parts if solver.parts else min(solver.step * factor, step.h)
        rate = max(rate, h * now["c"] / now["m"], h * math.sqrt(now["k"] / now["m"]))
    return rate > 1.0


def _as_large(like: Matched) -> tuple[str, float]:
    """Return the nearest solver, with errors about as large if there is one, and its factor."""
    alike = list(like.alike.items())
    return next((each for each in alike if abs(math.log10(each[1])) <= 1.0), alike[0])


def _of_other_steps(delta: float, expected: float) -> float:
    """Return the delta that a run of other steps may have."""
    return max(AS_MUCH * delta, STANDS_OUT * expected)


def _of_motion(
    empty: CheckResult, ruler: Ruler, run: Run, solver: str, expected: float
) -> CheckResult:
    """Judge a plain run: its motion against honest solvers, the rest against its motion."""
    tolerance = STANDS_OUT * expected
    worst = ruler.deviation(run)
    if worst.delta <= tolerance:
        rest = ruler.deviation(run, [name for name in OUTPUT_NAMES if name not in motion_of(run)])
        allowed = OF_OUTPUT * max(worst.delta, expected, LEAST)
        allowed = allowed if allowed <= SATURATED else DIVERGED
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
        because=f"{STANDS_OUT:g} times what {solver} has there; {OF_OUTPUT:g} of other outputs",
        passed=worst.delta <= tolerance,
        failure=None if finite else f"{worst.output} is no finite number at t = {worst.time:.6g} s",
    )


def _off(worst: Deviation) -> str:
    return f"data off, by {worst.output} at t = {worst.time:.6g} s"


def _output_of(result: CheckResult) -> str:
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
    return replace(
        empty,
        quantity=_off(worst),
        expected=allowed / AS_MUCH,
        got=worst.delta,
        error=worst.delta,
        tolerance=allowed,
        because=f"{AS_MUCH:g} times the plain run's, or what it may have itself",
        passed=worst.delta <= allowed,
    )


def _no_run(empty: CheckResult, answer: Answer[Run]) -> CheckResult:
    unknown = (
        "its plain run is lacking, or what is near the exact one"
        if answer.value is not None
        else None
    )
    lacking = answer.not_applicable or unknown
    return replace(empty, failure=answer.failure, not_applicable=lacking)


@dataclass(frozen=True)
class Errors:
    """How far a quantity of the cycle is off: by case, as a part of its largest exact value."""

    quantity: str
    by_case: Mapping[str, float]

    @property
    def middle(self) -> float:
        """The error in the middle case."""
        return float(np.median(list(self.by_case.values())))

    @property
    def worst(self) -> str:
        """The case of the largest error."""
        return max(self.by_case, key=self.by_case.__getitem__)

    @property
    def largest(self) -> float:
        """The largest error."""
        return self.by_case[self.worst]


def cycle_errors(found: Judged) -> list[Errors]:
    """Return how far off jump, stick, slip, period and spring force are.

    Where the FMU has the output it is compared; elsewhere the error is what delta makes of it.
    """
    errors = []
    for quantity, output in CYCLE.items():
        by_case = {}
        for case, run in found.runs.items():
            ruler, delta = found.rulers[case], found.motion[case].delta
            exact = ruler.exact.record.outputs
            if quantity == "force" and output in run.outputs:
                largest, got = (np.max(np.abs(each[output])) for each in (exact, run.outputs))
                by_case[case] = float(abs(got / largest - 1.0)) if largest else 0.0
                continue
            where = ruler.band.judged(output) & ruler.decided & (exact[output] != 0.0)
            if output in run.outputs:
                same = run.outputs.get("n_slips", exact["n_slips"]) == exact["n_slips"]
                where = where & same & (run.outputs[output] != 0.0)
                off = np.abs(run.outputs[output] - exact[output])
            else:
                off = ruler.moved(output, delta)
                where = where & np.isfinite(off)
            if where.any():
                typical = np.max if output in run.outputs else np.median
                largest = float(np.max(np.abs(exact[output][where])))
                by_case[case] = float(typical(off[where])) / largest
        if by_case:
            errors.append(Errors(quantity, by_case))
    return errors


def questions(
    found: Judged,
    results: Sequence[CheckResult],
    baseline: Sequence[Baseline],
    answers: Answers,
    trials: Sequence[Trial],
    within: float,
) -> tuple[list[Question], Table]:
    """Answer whether the model is right and how accurate it is, and give the errors as a table."""
    changes = {
        (each.case.id, name): moved
        for each in baseline
        if each.changes is not None and each.changes.value is not None
        for name, moved in each.changes.value.items()
    }
    wrong = wrong_parameter(found.rulers, found.runs, changes)
    failed = [each for each in results if each.failed]
    errors = cycle_errors(found)
    wrong = wrong if _tells(wrong) else None
    middle = float(np.median([each.delta for each in found.motion.values()] or [0.0]))
    model = Question(
        "Is the model right?",
        not failed and wrong is None and middle <= TOO_ROUGH,
        _model(found, failed, wrong, middle),
    )
    good = all(each.largest <= within for each in errors)
    accuracy = Question("How accurate is it?", good, _accuracy(found, errors, within))
    table = Table(
        title="Accuracy",
        about="Error of a cycle as a part of its exact value. What the FMU has no output for is "
        "estimated from its motion.",
        head=("quantity", "middle case [%]", "worst case [%]", "where", "within"),
        rows=[
            (
                each.quantity,
                _percent(each.middle),
                _percent(each.largest),
                each.worst,
                "yes" if each.largest <= within else "no",
            )
            for each in errors
        ],
        note=f"Asked for is {100.0 * within:g} % in every case; --within says otherwise.",
    )
    likeliest = _likeliest(found, failed, wrong, answers, trials)
    answered = [Question(LIKELIEST, good=False, answer=likeliest)] if likeliest else []
    return [model, accuracy, *answered], table


def _tells(wrong: WrongParameter | None) -> bool:
    """Whether a wrong parameter is more than the error of the solver."""
    return wrong is not None and abs(wrong.part) > max(LEAST * STANDS_OUT, 1e-9)


def _model(
    found: Judged, failed: Sequence[CheckResult], wrong: WrongParameter | None, middle: float
) -> str:
    tried = f"{len(found.runs)} cases" if len(found.runs) != 1 else "1 case"
    if wrong is not None:
        sense = "larger" if wrong.part > 0.0 else "smaller"
        return (
            f"The model is wrong: {wrong.name} acts as if it were {_percent(abs(wrong.part)):g} % "
            f"{sense} than what is set, alike in all cases."
        )
    if not failed and not found.runs:
        return "Nothing is known of the model: no case could be run."
    if not failed and middle > TOO_ROUGH:
        return (
            "It is too far off to tell a wrong model from a rough solver: in the middle case as if "
            f"its data were off by {_percent(middle):g} %."
        )
    if not failed and len(found.runs) < FEW:
        return (
            f"Nothing is wrong in {tried}, too few to tell a wrong model from a rough solver; "
            "without --cases there are more."
        )
    if not failed:
        return f"The model is right: in {tried} it errs no more than honest solvers do."
    made = [each for each in failed if not (each.failure or "").startswith(NOT_MADE)] or failed
    worst = max(made, key=lambda each: (each.error or 0.0) / (each.tolerance or 1.0))
    why = f"Most in {worst.case or 'the FMU itself'} ({worst.check}): " + (
        worst.failure
        or f"{worst.quantity}, {worst.error or 0.0:.0e} against the {worst.expected or 0.0:.0e} of "
        "an honest solver"
    )
    if len(made) < len(failed):
        why += f". {len(failed) - len(made)} checks were not made, since runs did not end"
    places = {each.case for each in made}
    cases, drawn = places & set(found.runs), {each for each in places if each.startswith(SEQUENCE)}
    where = [f"{len(cases)} of {tried}"] if cases else []
    where += [f"{len(drawn)} of the random sequences"] if drawn else []
    where += ["what it does with calls"] if "" in places else []
    return f"The model is wrong in {' and '.join(where)}. {why}."


def _likeliest(
    found: Judged,
    failed: Sequence[CheckResult],
    wrong: WrongParameter | None,
    answers: Answers,
    trials: Sequence[Trial],
) -> str:
    """Name the one cause of the runs that are farthest off, if it explains them all."""
    runs = {
        case: Shown(found.cases[case], found.rulers[case].exact.record, run)
        for case, run in found.runs.items()
    }
    for trial, answer in zip(trials, answers.sequences, strict=True):
        exact = trial.baseline.exact.value
        if trial.manner.manner == PLAIN and exact is not None and answer.value is not None:
            case = trial.baseline.case
            runs[case.id] = Shown(case, exact.record, answer.value)
    plain = [
        each
        for each in failed
        if each.truth == Kind.CLOSED_FORM
        and each.case in runs
        and runs[each.case].case.law in BUILT_IN
    ]
    if wrong is not None or not plain:
        return ""
    plain.sort(key=lambda each: (each.error or math.inf) / (each.tolerance or 1.0), reverse=True)
    worst = [replace(runs[each.case], output=_output_of(each)) for each in plain[:WORST]]
    others = [runs[case] for case in found.runs if case not in {each.case for each in failed}]
    said = cause(worst, others)
    drawn = "".join(_set(each.case) for each in worst[:1] if each.case.id.startswith(SEQUENCE))
    if said is None:
        return f"No single cause explains it.{drawn}"
    of = "it" if len(plain) == 1 else f"the {len(worst)} runs that are farthest off"
    return f"Likeliest, {said}: that explains {of}.{drawn}"


def _set(case: Case) -> str:
    """Say what a random sequence sets and changes."""
    values = ", ".join(f"{name} = {value:.4g}" for name, value in case.parameters.items())
    changed = ", ".join(dict.fromkeys(name for step in case.steps for name in step.changes))
    return f" {case.id} sets {values} (SI)" + (f" and changes {changed}." if changed else ".")


def _accuracy(found: Judged, errors: Sequence[Errors], within: float) -> str:
    deltas = [each.delta for each in found.motion.values()]
    middle = float(np.median(deltas)) if deltas else 0.0
    if not errors:
        return "Nothing is known of its accuracy: no cycle was compared."
    said = [
        f"{each.quantity} within {_percent(each.middle):g} % in the middle case and "
        f"{_percent(each.largest):g} % in the worst"
        for each in errors
        if each.quantity in ("jump", "period")
    ]
    outside = [each.quantity for each in errors if each.largest > within]
    asked = f"within the {_percent(within):g} % asked for"
    if outside:
        needed = math.ceil(1000.0 * max(each.largest for each in errors)) / 10.0
        advice = f": take smaller steps, or --within {needed}%" if needed < MOST_ASKED else ""
        verdict = f"not {asked} in {', '.join(outside)}{advice}"
    else:
        verdict = asked
    hidden = STANDS_OUT * middle
    return (
        f"It is as accurate as {_class(found.like, middle)}: {', '.join(said)}; {verdict}. "
        f"A fault could hide in that which moves the motion like data off by {hidden:.0e}."
    )


def _class(like: Matched, middle: float) -> str:
    """Name how accurate a solver is in the words of its users."""
    if middle < _EXACT:
        return "the exact motion, to rounding"
    name, factor = _as_large(like)
    solver = SOLVERS[name]
    if abs(math.log10(factor)) > 1.0:
        return f"a motion whose data are off by {middle:.0e}"
    if solver.rtol:
        return f"a solver of tolerance {solver.rtol * factor:.0e}"
    if solver.step:
        return f"fixed steps of about {1e3 * solver.step * factor:.1g} ms"
    return f"a fixed number of steps in each communication step (like {name})"


def _percent(part: float) -> float:
    return float(f"{100.0 * part:.2g}")
