"""The two answers on a numerical solution: is the model right, and how accurate is it.

What a wrong model is likeliest to do instead is done, and compared with it: a cause is named only
if its motion is the FMU's in every failed run that is tried, but for a tenth of the deviation, and
in no other run another one; else there is none that explains it alone.
"""

import math
import tomllib
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import takewhile
from pathlib import Path
from typing import Final

import numpy as np

from ..drive.processes import NOT_MADE
from ..drive.solvers import SHARES, SOLVERS, Acceleration, Slider, Solver
from ..judge import accuracy
from ..judge.accuracy import Plain
from ..model.verdict import LIKELIEST, SEQUENCE, CheckResult, Kind, Question, Series, Table
from ..suite.cases import Case
from ..suite.invariants import load_invariants
from ..truth.course import BUILT_IN
from .comparisons import FEW, Solution, as_large, place_of
from .experiment import Runs

_TABLES: Final = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
EXPLAINS: Final = 0.1  # most of the mean deviation that a cause may leave
WORST: Final = 3  # how many failed runs are tried
OTHERS: Final = 15
"""How many runs in which the FMU is right are compared with a cause, the shortest ones."""

_SOLVER: Final = Solver(rtol=1e-7, adapts="LSODA")
_EVEN: Final = 0.3
"""Distance of the quartiles over the median of a creep that is in proportion to the force."""
_ALSO: Final = 3.0
"""How many times farther off a cause may be where the FMU is right, and `_PART` of the motion."""
_PART: Final = 0.01

Values = Mapping[str, float]
Model = Callable[[Case], Slider]
Distance = tuple[float, float, float]
"""Of an output: its mean deviation, what a cause leaves of it, and its mean size."""


def cause(failures: Sequence[Plain], others: Sequence[Plain]) -> str | None:
    """Return in words the one cause that explains all failed runs, if there is one.

    ``others`` are the runs in which the FMU is right.
    """
    if not failures:
        return None
    for words, instead in _OUTPUTS.items():
        if all(_left([_of_output(shown, instead)]) <= EXPLAINS for shown in failures):
            return f"{', '.join(dict.fromkeys(shown.output for shown in failures))} {words}"
    if any(shown.output not in SHARES for shown in failures):
        return None
    creeps = [creep for shown in failures if (creep := _creep(shown)) is not None]
    if creeps and all(creeps):
        return (
            "friction is regularised: in stick the mass creeps at "
            f"{1e6 * float(np.median(creeps)):.2g} um/s per newton"
        )
    failures = sorted(failures, key=lambda shown: shown.run.times[-1])
    others = sorted(others, key=lambda shown: shown.run.times[-1])[:OTHERS]
    models: dict[str, Model] = {
        words: partial(_delayed if "acts" in entry else _valued, **entry)
        for words, entry in _TABLES["causes"].items()
    }
    models |= {words: partial(Slider, _SOLVER, acceleration=a) for words, a in STRUCTURES.items()}
    left = {}
    for words, model in models.items():
        parts = (_left(_of_motion(shown, model)) for shown in failures)
        explained = list(takewhile(lambda part: part <= EXPLAINS, parts))
        # Nor may it move otherwise than an FMU that is right.
        if len(explained) == len(failures) and not any(
            rest > _ALSO * off + _PART * size
            for of in others
            for off, rest, size in _of_motion(of, model)
        ):
            left[words] = max(explained)
    # Of those that explain about as much, the first is the simplest.
    least = min(left.values(), default=0.0)
    return next((words for words, part in left.items() if part <= 2.0 * least), None)


def _left(distances: Sequence[Distance]) -> float:
    """Return what a cause leaves of the deviation, where most is left."""
    parts = [rest / min(off, size) for off, rest, size in distances if off > 0.0 and size > 0.0]
    return max(parts, default=1.0) if np.all(np.isfinite(parts)) else 1.0


def _of_motion(shown: Plain, model: Model) -> list[Distance]:
    """Return the distances of the motion from a model; nothing where that cannot be set so."""
    try:
        instead = model(shown.case).run().outputs
    except ValueError:
        return []
    got, exact = shown.run.outputs, shown.exact.outputs
    rows = [(got[n] - exact[n], got[n] - instead[n], exact[n]) for n in SHARES if n in got]
    return [(_mean(off), _mean(rest), _mean(size)) for off, rest, size in rows]


def _of_output(shown: Plain, instead: Callable[[Series, Plain], Series]) -> Distance:
    """Return the distances of an output from what would be right if it showed another one."""
    got, exact = (run.outputs[shown.output] for run in (shown.run, shown.exact))
    meant = np.isfinite(got) & np.isfinite(exact)
    off, rest, size = got - exact, instead(got, shown) - exact, exact
    return _mean(off[meant]), _mean(rest[meant]), _mean(size[meant])


def _mean(samples: Series) -> float:
    return float(np.mean(np.abs(samples))) if samples.size else 0.0


def _creep(shown: Plain) -> float | None:
    """Return the speed over the force [m/(N s)] at which a mass creeps that should stick.

    0 where it does not creep in proportion to the force, None where it should hardly stick.
    """
    got, exact = shown.run.outputs, shown.exact.outputs
    if not {"x_dot", "F"} <= set(got):
        return None
    sticks = (exact["mode"] == 0.0) & (got["F"] != 0.0)
    sticks &= np.abs(got["x_dot"]) <= 0.1 * np.max(np.abs(exact["x_dot"]), initial=0.0)
    if np.sum(sticks) < 8:
        return None
    rates = got["x_dot"][sticks] / got["F"][sticks]
    low, middle, high = np.quantile(rates, (0.25, 0.5, 0.75))
    return float(middle) if middle > 0.0 and high - low <= _EVEN * middle else 0.0


def _valued(case: Case, name: str, factor: float = 1.0, of: str = "") -> Slider:
    """Return a slider on which a value acts as a factor times itself, or times that `of` another.

    That of "1" is 1.
    """
    now = {"1": 1.0}

    def acting(new: Values) -> Values:
        now.update(new)
        return {**new, name: factor * now[of or name]} if name in now else new

    parameters = acting(case.start)
    steps = tuple(replace(step, changes=acting(step.changes)) for step in case.steps)
    return Slider(_SOLVER, replace(case, parameters=parameters, steps=steps))


def _delayed(case: Case, name: str, *, acts: bool) -> Slider:
    """Return a slider on which changes of a value act one step late, or never."""
    steps = []
    late: Values = {}
    for step in case.steps:
        others = {n: value for n, value in step.changes.items() if n != name}
        steps.append(replace(step, changes={**others, **late}))
        late = {name: step.changes[name]} if acts and name in step.changes else {}
    return Slider(_SOLVER, replace(case, steps=tuple(steps)))


def _slip(
    damping: Callable[[Values, float], float] = lambda p, u: p["c"] * u,
    push: float = 1.0,
    direction: int = 0,
) -> Acceleration:
    """Return another equation of slip: damping force, factor on F_ext, direction of friction."""
    return lambda p, s, friction: (
        lambda z, u: (
            (p["k"] * z + push * p["F_ext"] - (direction or s) * friction(u) - damping(p, u))
            / p["m"]
        )
    )


STRUCTURES: Final[Mapping[str, Acceleration]] = {
    "damping acts forwards only": _slip(lambda p, u: p["c"] * max(u, 0.0)),
    "damping acts on the speed relative to the pull": _slip(lambda p, u: p["c"] * (u - p["v"])),
    "damping has the other sign": _slip(lambda p, u: -p["c"] * u),
    "c is a rate, and acts as c m": _slip(lambda p, u: p["c"] * p["m"] * u),
    "friction points backwards whichever way the mass moves": _slip(direction=1),
    "F_ext is ignored in slip": _slip(push=0.0),
    "F_ext has the other sign in slip": _slip(push=-1.0),
}
"""What models make of the equation of motion in slip."""

_OUTPUTS: Final[Mapping[str, Callable[[Series, Plain], Series]]] = {
    "has the other sign": lambda got, _: -got,
    "has the other sign in backward motion": lambda got, of: np.where(
        of.exact.outputs["x_dot"] < 0.0, -got, got
    ),
    "is 1000 times too large": lambda got, _: 1e-3 * got,
    "is 1000 times too small": lambda got, _: 1e3 * got,
    "is that of the step before": lambda got, _: np.append(got[1:], got[-1]),
    "lacks the damping force": lambda got, of: got - _damping(of),
    "has a constant added": lambda got, of: got - np.median(got - of.exact.outputs[of.output]),
}
"""What would be right, from an output that shows something else."""


def _damping(shown: Plain) -> Series:
    now, forces = dict(shown.case.start), []
    for step, speed in zip(shown.case.steps, shown.exact.outputs["x_dot"], strict=True):
        now.update(step.changes)
        forces.append(now["c"] * float(speed))
    return np.array(forces)


TOO_ROUGH: Final = 0.03  # delta in the middle case from which on nothing can be told
ROUGH_CYCLE: Final = 0.05
"""Error of jump or period in the middle case from which on nothing can be told."""

SHARPER: Final = 0.1
"""Part of both through model exchange: the solver is accurate, and what is so rough is the FMU."""

MOST_ASKED: Final = 50.0  # above it [%] no error is one of the steps
_EXACT: Final = 1e-11  # a solution whose middle delta is below this one is exact


@dataclass(frozen=True)
class Errors:
    """How far a quantity of the cycle is off, as a part of its largest exact value in a case."""

    quantity: str
    middle: float
    largest: float
    worst: str


def cycle_errors(solved: Solution) -> list[Errors]:
    """Return how far off jump, stick, slip, period and spring force are."""
    errors = []
    for quantity, output in _TABLES["cycle"].items():
        of_cases = {case: _error(plain, output) for case, plain in solved.plain.items()}
        known = {case: error for case, error in of_cases.items() if error is not None}
        if known:
            worst = max(known, key=known.__getitem__)
            middle = float(np.median(list(known.values())))
            errors.append(Errors(quantity, middle, known[worst], worst))
    return errors


def _error(plain: Plain, output: str) -> float | None:
    """Return the error of an output; of one that the FMU lacks what delta makes of it."""
    ruler, got = plain.ruler, plain.run.outputs
    exact = ruler.exact.record.outputs
    if output == "F" and output in got:
        size, seen = (float(np.max(np.abs(samples[output]))) for samples in (exact, got))
        return abs(seen / size - 1.0) if size else 0.0
    where = ruler.band.judged(output) & ruler.decided & (exact[output] != 0.0)
    if output in got:
        same = got.get("n_slips", exact["n_slips"]) == exact["n_slips"]
        where = where & same & (got[output] != 0.0)
        off = np.abs(got[output] - exact[output])
    else:
        off = ruler.moved(output, plain.motion.delta)
        where = where & np.isfinite(off)
    if not where.any():
        return None
    typical = float((np.max if output in got else np.median)(off[where]))
    return typical / float(np.max(np.abs(exact[output][where])))


def questions(
    solved: Solution, results: Sequence[CheckResult], runs: Runs, within: float
) -> tuple[list[Question], Table]:
    """Answer whether the model is right and how accurate it is, and give the errors as a table."""
    changes = {
        (each.case.id, name): moved
        for each in runs.experiment.baseline
        for name, moved in (each.changes.value or {}).items()
    }
    middle = float(np.median([of.motion.delta for of in solved.plain.values()] or [0.0]))
    wrong = accuracy.wrong_parameter(solved.plain, changes)
    # So near to the exact motion an FMU has no parameter that is so far off.
    if wrong is None and middle > accuracy.LARGE / accuracy.STANDS_OUT:
        wrong = accuracy.large_offset(solved.plain, changes)
    if wrong is not None and abs(wrong.part) <= max(accuracy.LEAST * accuracy.STANDS_OUT, 1e-9):
        # It is no more than the error of the solver.
        wrong = None
    failed = [each for each in results if each.failed]
    errors = cycle_errors(solved)
    cycle = max((of.middle for of in errors if of.quantity in ("jump", "period")), default=0.0)
    sharper = SHARPER if solved.solved else 1.0
    rough = max(middle / TOO_ROUGH, cycle / ROUGH_CYCLE) > sharper
    off = max(middle, cycle) if rough else 0.0
    right = not failed and wrong is None and not rough
    good = all(each.largest <= within for each in errors)
    answers = [
        Question("Is the model right?", right, _model(solved, failed, wrong, off)),
        Question("How accurate is it?", good, _accuracy(solved, errors, within, middle, wrong)),
    ]
    if wrong is not None:
        likeliest = f"Next: look where {wrong.name} is set and used; what else fails may follow."
    else:
        likeliest = _likeliest(solved, failed, runs)
    if likeliest:
        answers.append(Question(LIKELIEST, good=False, answer=likeliest))
    rows = []
    for of in errors:
        inside = "yes" if of.largest <= within else "no"
        rows.append((of.quantity, _percent(of.middle), _percent(of.largest), of.worst, inside))
    table = Table(
        title="Accuracy",
        about="Error of a cycle as a part of its exact value. What the FMU has no output for is "
        "estimated from its motion.",
        head=("quantity", "middle case [%]", "worst case [%]", "where", "within"),
        rows=rows,
        note=f"Asked for is {100.0 * within:g} % in every case; --within says otherwise.",
    )
    return answers, table


def _model(
    solved: Solution,
    failed: Sequence[CheckResult],
    wrong: accuracy.WrongParameter | None,
    off: float,
) -> str:
    count = len(solved.plain)
    tried = f"{count} cases" if count != 1 else "1 case"
    if wrong is not None:
        sense = "larger" if wrong.part > 0.0 else "smaller"
        return (
            f"The model is wrong: {wrong.name} acts as if it were {_percent(abs(wrong.part)):g} % "
            f"{sense} than what is set, alike in all cases."
        )
    if not failed and not count:
        return "Nothing is known of the model: no case could be run."
    if not failed and off:
        tells = "Smaller steps tell: what is left is no error of the steps."
        if solved.solved:
            tells = (
                "The solver is not: events are found late or never, or nominal states are large."
            )
        return (
            "It is too far off to tell a wrong model from a rough solver: by "
            f"{_percent(off):g} % in the middle case. {tells}"
        )
    if not failed and count < FEW:
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
    off, honest = (_percent(part or 0.0) for part in (worst.error, worst.expected))
    why = worst.failure or f"{worst.quantity} is {off:g} % of its scale from its plain run"
    if not worst.failure and (place := place_of(worst)):
        far = f"is off as if the data were by {off:g} %, an honest solver {honest:g} %"
        run = f"is as far from the plain run as if the data were off by {off:g} %"
        why = f"{place} {far if _plain(worst) else run}"
    if len(made) < len(failed):
        why += f". {len(failed) - len(made)} checks were not made, since runs did not end"
    places = {each.case for each in made}
    cases, drawn = len(places & set(solved.plain)), sum(of.startswith(SEQUENCE) for of in places)
    where = [f"{cases} of {tried}"] if cases else []
    where += [f"{drawn} of the random sequences"] if drawn else []
    where += ["what it does with calls"] if "" in places else []
    most = f"Most in {worst.case or 'the FMU itself'} ({worst.check}): {why}."
    there = " and ".join(where) or "runs without an end"
    if all(each.late for each in made):
        return (
            f"The FMU is too slow or hangs in {there}; what it does there is not known. Give it "
            f"longer, by --time-limit, to tell a slow one from one that hangs. {most}"
        )
    return f"The model is wrong in {there}. {most}"


def _plain(result: CheckResult) -> bool:
    return result.truth == Kind.CLOSED_FORM


def _telling(failed: Sequence[CheckResult]) -> str:
    """Say which check fails most often, where the bug is likely then, and what is farthest off."""
    ((check, count),) = Counter(each.check for each in failed).most_common(1)
    look = next((each.look for each in load_invariants() if each.id == check), "")
    rows = dict.fromkeys(f"{each.case or 'the FMU itself'} ({each.check})" for each in failed)
    times = f"{count} times" if count > 1 else "once"
    return f"{check} fails {times}. Look for: {look} Farthest off: {', '.join([*rows][:WORST])}."


def _likeliest(solved: Solution, failed: Sequence[CheckResult], runs: Runs) -> str:
    shown = dict(solved.plain)
    failing = {each.case for each in failed}
    others = [of for case, of in shown.items() if case not in failing]
    for test, answer in zip(runs.experiment.random, runs.random, strict=True):
        case, exact = test.baseline.case, test.baseline.exact.value
        if test.plain and exact is not None and answer.value is not None:
            shown[case.id] = Plain(case, accuracy.Ruler(exact, {}), answer.value)
    known = {name for name, of in shown.items() if of.case.law in BUILT_IN}
    ended = [
        each for each in failed if each.error is not None or (_plain(each) and each.case in shown)
    ]
    ended.sort(key=lambda each: (each.error or math.inf) / (each.tolerance or 1.0), reverse=True)
    plain = [each for each in ended if _plain(each) and each.case in known]
    if not plain:
        return _telling(ended) if ended else ""
    worst = [
        replace(shown[each.case], output=place_of(each).partition(" ")[0]) for each in plain[:WORST]
    ]
    said = cause(worst, others)
    drawn = _set(worst[0].case) if worst[0].case.id.startswith(SEQUENCE) else ""
    if said is None:
        return f"No single cause explains it. {_telling(ended)}{drawn}"
    of = "it" if len(plain) == 1 else f"the {len(worst)} runs that are farthest off"
    return f"Likeliest, {said}: that explains {of}.{drawn}"


def _set(case: Case) -> str:
    values = ", ".join(f"{name} = {value:.4g}" for name, value in case.parameters.items())
    changed = ", ".join(dict.fromkeys(name for step in case.steps for name in step.changes))
    return f" {case.id} sets {values} (SI)" + (f" and changes {changed}." if changed else ".")


def _accuracy(
    solved: Solution,
    errors: Sequence[Errors],
    within: float,
    middle: float,
    wrong: accuracy.WrongParameter | None,
) -> str:
    if not errors:
        return "Nothing is known of its accuracy: no cycle was compared."
    said = [
        f"{each.quantity} within {_percent(each.middle):g} % in the middle case and "
        f"{_percent(each.largest):g} % in the worst ({each.worst})"
        for each in errors
        if each.quantity in ("jump", "period")
    ]
    if wrong is not None:
        solver = f"How accurate its solver is shows once {wrong.name} is right."
        return f"As it is: {', '.join(said)}. {solver}"
    outside = [
        f"{each.quantity} ({_percent(each.largest):g} % in {each.worst})"
        for each in errors
        if each.largest > within
    ]
    asked = f"within the {_percent(within):g} % asked for"
    if outside:
        needed = math.ceil(1000.0 * max(each.largest for each in errors)) / 10.0
        finer = "state smaller nominal values" if solved.solved else "take smaller steps"
        advice = f": {finer}, or --within {needed}%" if needed < MOST_ASKED else ""
        asked = f"not {asked} in {', '.join(outside)}{advice}"
    return (
        f"It is as accurate as {_class(solved.like, middle)}: {', '.join(said)}; {asked}. A fault "
        "could hide in that which moves the motion like data off by "
        f"{accuracy.STANDS_OUT * middle:.0e}."
    )


def _class(like: accuracy.Matched, middle: float) -> str:
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
