"""The two answers on a numerical solution: is the model right, and how accurate is it."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from stickslip_verification.drive.solvers import SOLVERS
from stickslip_verification.drive.workers import NOT_MADE
from stickslip_verification.judge.accuracy import (
    LEAST,
    STANDS_OUT,
    Matched,
    WrongParameter,
    wrong_parameter,
)
from stickslip_verification.model.verdict import (
    LIKELIEST,
    SEQUENCE,
    CheckResult,
    Kind,
    Question,
    Table,
)
from stickslip_verification.run.causes import WORST, Shown, cause
from stickslip_verification.run.numerical import Solution, as_large, output_of
from stickslip_verification.run.runs import Runs
from stickslip_verification.suite.cases import Case
from stickslip_verification.truth.named import BUILT_IN

FEW: Final = 5
"""In fewer cases a free factor explains anything."""

TOO_ROUGH: Final = 0.03
"""Delta in the middle case from which on nothing can be told."""

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


def cycle_errors(found: Solution) -> list[Errors]:
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
    found: Solution, results: Sequence[CheckResult], runs: Runs, within: float
) -> tuple[list[Question], Table]:
    """Answer whether the model is right and how accurate it is, and give the errors as a table."""
    changes = {
        (each.case.id, name): moved
        for each in runs.experiment.baseline
        for name, moved in (each.changes.value or {}).items()
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
    likeliest = _likeliest(found, failed, wrong, runs)
    answered = [Question(LIKELIEST, good=False, answer=likeliest)] if likeliest else []
    return [model, accuracy, *answered], table


def _tells(wrong: WrongParameter | None) -> bool:
    """Whether a wrong parameter is more than the error of the solver."""
    return wrong is not None and abs(wrong.part) > max(LEAST * STANDS_OUT, 1e-9)


def _model(
    found: Solution, failed: Sequence[CheckResult], wrong: WrongParameter | None, middle: float
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
    # A motion that is off tells more than two runs that differ.
    worst = max(
        made, key=lambda each: (_plain(each), (each.error or 0.0) / (each.tolerance or 1.0))
    )
    honest = f" against the {worst.expected or 0.0:.0e} of an honest solver"
    why = f"Most in {worst.case or 'the FMU itself'} ({worst.check}): " + (
        worst.failure
        or f"{worst.quantity}, {worst.error or 0.0:.0e}"
        + (honest if _plain(worst) else " from its plain run")
    )
    if len(made) < len(failed):
        why += f". {len(failed) - len(made)} checks were not made, since runs did not end"
    places = {each.case for each in made}
    cases, drawn = places & set(found.runs), {each for each in places if each.startswith(SEQUENCE)}
    where = [f"{len(cases)} of {tried}"] if cases else []
    where += [f"{len(drawn)} of the random sequences"] if drawn else []
    where += ["what it does with calls"] if "" in places else []
    return f"The model is wrong in {' and '.join(where)}. {why}."


def _plain(result: CheckResult) -> bool:
    """Whether a check holds a plain run against the exact motion."""
    return result.truth == Kind.CLOSED_FORM


def _likeliest(
    found: Solution, failed: Sequence[CheckResult], wrong: WrongParameter | None, runs: Runs
) -> str:
    """Name the one cause of the runs that are farthest off, if it explains them all."""
    shown = {
        case: Shown(found.cases[case], found.rulers[case].exact.record, run)
        for case, run in found.runs.items()
    }
    for test, answer in zip(runs.experiment.random, runs.random, strict=True):
        case, exact = test.baseline.case, test.baseline.exact.value
        if test.plain and exact is not None and answer.value is not None:
            shown[case.id] = Shown(case, exact.record, answer.value)
    plain = [
        each
        for each in failed
        if _plain(each) and each.case in shown and shown[each.case].case.law in BUILT_IN
    ]
    if wrong is not None or not plain:
        return ""
    plain.sort(key=lambda each: (each.error or math.inf) / (each.tolerance or 1.0), reverse=True)
    worst = [replace(shown[each.case], output=output_of(each)) for each in plain[:WORST]]
    others = [shown[case] for case in found.runs if case not in {each.case for each in failed}]
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


def _accuracy(found: Solution, errors: Sequence[Errors], within: float) -> str:
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
    name, factor = as_large(like)
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
