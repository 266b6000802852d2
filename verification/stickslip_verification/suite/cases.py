"""Verification cases: files, read into an experiment and what is checked on it."""

import fnmatch
import itertools
import math
import random
import tomllib
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from functools import cache
from pathlib import Path
from typing import Annotated, Any, ClassVar

from pydantic import BeforeValidator, Field, WithJsonSchema
from pydantic.dataclasses import dataclass as model

from .. import truth
from ..model import data_file as data
from ..model.quantities import (
    ASYMPTOTIC,
    CYCLE,
    FORMULAS,
    GROUPS,
    OUTPUT_NAMES,
    QUANTITIES,
    Quantity,
)
from ..model.verdict import CaseGroup, CommunicationStep, Klass, Measure, points
from ..truth.course import COULOMB_NAME
from ..truth.parameters import PARAMETERS, Parameter, changeable, complete
from .invariants import Invariant, Invariants, invariant_ids
from .tolerances import Facts, Rules, Tolerance, facts_of

_SAME_POINT = 1e-9  # of the mean step: how far rounding may move the sum of many steps
_SHORTEST_PART = 1e-15  # of the stop time: a drawn step below it would not move the sum of steps
MOST_STEPS = 1_000_000  # more than any case needs, and than the memory holds
Seconds = Annotated[data.Positive, Field(description="[s]")]


@model(frozen=True, config=data.WRITTEN)
class Steps(data.Written):
    """Steps of one length, of lengths drawn evenly in their logarithm, or one by one."""

    SOME: ClassVar = ("fixed", "seed", "list")
    NEEDS: ClassVar = {"seed": ("shortest", "longest"), "shortest": ("seed",), "longest": ("seed",)}
    EXCLUDES: ClassVar = {"fixed": ("seed", "list"), "seed": ("list",)}

    fixed: Seconds | None = None
    seed: data.Count | None = None
    shortest: Seconds | None = None
    longest: Seconds | None = None
    list: tuple[Seconds, ...] = ()


@model(frozen=True, config=data.WRITTEN)
class Change(data.Written):
    """Values (SI) that are set at a communication point."""

    time: Seconds
    set: Annotated[Mapping[str, data.Number], Field(min_length=1)]


@model(frozen=True, config=data.WRITTEN)
class Experiment(data.Written):
    """What a case runs."""

    stop_time: Seconds
    steps: Steps
    changes: tuple[Change, ...] = ()


def communication_steps(
    file: data.DataFile, experiment: Experiment
) -> tuple[CommunicationStep, ...]:
    """Lay out the steps of an experiment, with the changes at their communication points.

    `DataError` if the steps do not end at the stop time, a change lies between two of them, or they
    are too many.
    """
    stop_time, changes = experiment.stop_time, experiment.changes
    for n, change in enumerate(changes):
        place = ("experiment", "changes", n, "time")
        if change.time >= stop_time:
            raise file.refusal(f"{change.time} is not before stop_time {stop_time}", *place)
        if n and change.time <= changes[n - 1].time:
            raise file.refusal("the changes are not in the order of time", *place)
    lengths = _lengths(file, experiment)
    ends = points(lengths)
    near = _SAME_POINT * stop_time / len(lengths)
    if abs(ends[-1] - stop_time) > near:
        reason = f"the steps end at {ends[-1]}, not at stop_time {stop_time}"
        raise file.refusal(reason, "experiment", "steps")
    settings: dict[int, Mapping[str, float]] = {}
    for n, change in enumerate(changes):
        index = min(range(len(ends)), key=lambda i: abs(ends[i] - change.time))
        if abs(ends[index] - change.time) > near:
            reason = f"{change.time} is not at a communication point; the nearest is {ends[index]}"
            raise file.refusal(reason, "experiment", "changes", n, "time")
        settings[index + 1] = change.set
    return tuple(CommunicationStep(h, settings.get(n, {})) for n, h in enumerate(lengths))


def _lengths(file: data.DataFile, experiment: Experiment) -> Sequence[float]:
    steps, stop_time = experiment.steps, experiment.stop_time
    if steps.list:
        return steps.list
    shortest, longest = steps.shortest or steps.fixed, steps.longest or steps.fixed
    assert shortest is not None
    assert longest is not None
    ratio = longest / shortest
    place = ("experiment", "steps", "shortest")
    if ratio < 1.0:
        raise file.refusal(f"{shortest} is above longest {longest}", *place)
    if steps.fixed is None and not (shortest > _SHORTEST_PART * stop_time and ratio < math.inf):
        reason = f"{shortest} is lost beside stop_time {stop_time} or longest {longest}"
        raise file.refusal(reason, *place)
    spread = math.log(ratio)
    count = stop_time / ((longest - shortest) / spread if spread else shortest)
    if count > MOST_STEPS:
        raise file.refusal(f"{count:.3g} steps; {MOST_STEPS} are too many", "experiment", "steps")
    if steps.fixed is not None:
        return [shortest] * max(1, round(count))
    draw = random.Random(steps.seed)
    marks = (0.0, *(change.time for change in experiment.changes), stop_time)
    lengths: list[float] = []
    for begin, end in itertools.pairwise(marks):
        marked = [begin]
        while (left := end - marked[-1]) > 0.0:
            h = shortest * ratio ** draw.random()
            marked.append(end if h >= left else marked[-1] + h)
        lengths += [b - a for a, b in itertools.pairwise(marked)]
    return lengths


@dataclass(frozen=True)
class At:
    """Where a check looks: ``kind`` is end, every_point, cycle or event, the last two by number.

    cycle: the first communication point in the stick that follows slip number n; event: the first
    one after transition number n, counted from 1.
    """

    kind: str
    number: int = 0


@dataclass(frozen=True)
class Check(Tolerance):
    """One comparison, judged on each side with that side's tolerance."""

    id: str
    quantity: str
    formula: str  # a name in `FORMULAS`, or "" for the exact motion in high precision
    at: At

    @property
    def unit(self) -> str:
        """The SI unit of the quantity."""
        return QUANTITIES[self.quantity].unit

    @property
    def source(self) -> int:
        """Number of the equation in docs/theory.md."""
        return (FORMULAS[self.formula] if self.formula else QUANTITIES[self.quantity]).equation


@dataclass(frozen=True)
class Case:
    """One motion and what is checked on it.

    ``own`` are the friction law's own parameters; those of Coulomb's law only in a case that names
    one of them, since an FMU need not have them.
    """

    id: str
    title: str
    about: str
    parameters: Mapping[str, float]  # set by the case [SI]; the others verify the defaults
    steps: tuple[CommunicationStep, ...]
    checks: tuple[Check, ...]
    file: Path
    klass: Klass = Klass.PHYSICS  # contract where what happens is a convention, as the clamp
    facts: Facts | None = None  # as the file states them; None: the exact motion is followed
    law: str = COULOMB_NAME
    own: tuple[Parameter, ...] = ()

    @property
    def start(self) -> Mapping[str, float]:
        """Every value at the start, the defaults included (SI)."""
        return complete(self.parameters, self.own)

    @property
    def group(self) -> CaseGroup:
        """The group of cases it belongs to, by what it sets."""
        if self.klass == Klass.CONTRACT:
            return CaseGroup.CONVENTIONS
        if self.law != COULOMB_NAME:
            return CaseGroup.LAWS
        if self.own:
            return CaseGroup.DWELL
        if any(step.changes for step in self.steps):
            return CaseGroup.CHANGES
        if any(name.endswith("_start") for name in self.parameters):
            return CaseGroup.STARTS
        if self.parameters.get("c"):
            return CaseGroup.DAMPING
        return CaseGroup.SETTINGS if self.parameters else CaseGroup.DEFAULT

    @property
    def times(self) -> tuple[float, ...]:
        """Communication points after the start [s]: each the correctly rounded sum of steps."""
        return points(step.h for step in self.steps)

    @property
    def stop_time(self) -> float:
        """The last communication point [s]."""
        return self.times[-1]


def follow(
    parameters: Mapping[str, float],
    steps: Sequence[CommunicationStep],
    law: str = COULOMB_NAME,
    *,
    in_doubles: bool = False,
) -> truth.Run:
    """Follow the exact motion through communication steps; in doubles for planning alone."""
    friction = truth.friction_law(law)
    digits = None if in_doubles else friction.digits
    return truth.run(parameters, steps, law=friction, digits=digits)


CASES_FOLDER = Path(__file__).parent / "cases"


class CaseError(data.DataError):
    """A case file cannot be used."""


def _at(entry: Any) -> Any:
    if entry in ("end", "every_point"):
        return At(entry)
    if isinstance(entry, dict) and len(entry) == 1:
        ((kind, number),) = entry.items()
        if kind in ("cycle", "event") and type(number) is int and number > 0:
            return At(kind, number)
    raise ValueError('it is "end", "every_point", { cycle = n } or { event = n }, n from 1')


Where = Annotated[At, BeforeValidator(_at), WithJsonSchema({"type": ["string", "object"]})]


@model(frozen=True, config=data.WRITTEN)
class CycleEntry(data.Written):
    """The outputs of the steady cycle, held against their closed forms; ``only`` names some."""

    at: Where
    only: tuple[data.Text, ...] | None = None


@model(frozen=True, config=data.WRITTEN)
class OwnTolerances(data.Written):
    """What a case is held to instead of the rules."""

    NEEDS: ClassVar = {"because": ("fmu",)}

    conditioning: data.Number | None = Field(
        default=None, ge=1.0, description="below that of the narrowest gap"
    )
    fmu: data.Amount | None = Field(
        default=None, description="of the exact block's courses, of scale"
    )
    because: data.Prose | None = Field(
        default=None, description="the reason, where it is looser than the rules"
    )


@model(frozen=True, config=data.WRITTEN)
class OwnTolerance(data.Written):
    """What the rules do not give a check, or give otherwise."""

    fmu: data.Amount
    reference: data.Amount
    measure: Measure | None = None


@model(frozen=True, config=data.WRITTEN)
class CheckEntry(data.Written):
    """A check that a case spells out; its tolerance comes from the rules where it has no own."""

    NEEDS: ClassVar = {"tolerance": ("because",), "because": ("tolerance",)}

    id: data.Id
    quantity: Annotated[str, data.known("quantity", QUANTITIES)]
    at: Where
    formula: Annotated[
        str,
        data.known("formula", FORMULAS),
        Field(description="absent: the exact motion at 50 digits"),
    ] = ""
    tolerance: OwnTolerance | None = None
    because: Annotated[
        Mapping[str, data.Prose],
        data.keyed("fmu", "reference"),
        Field(description="of its own tolerance"),
    ] = field(default_factory=dict)


Courses = Annotated[
    tuple[Annotated[str, data.known("output or group", [*GROUPS, *OUTPUT_NAMES])], ...],
    Field(description="compared with the exact motion at every communication point; groups too"),
]


@model(frozen=True, kw_only=True, config=data.WRITTEN)
class CaseFile(data.Written):
    """A verification case of the stick-slip block."""

    id: Annotated[data.Id, Field(description="absent: the name of the file")] = ""
    title: data.Text
    about: data.Prose
    experiment: Experiment
    law: Annotated[data.Text, Field(description="the friction law, module:NAME")] = COULOMB_NAME
    klass: Annotated[
        Klass,
        Field(validation_alias="class", description="contract where the result is a convention"),
    ] = Klass.PHYSICS
    parameters: Annotated[
        Mapping[str, data.Number], Field(description="set before the start; absent: the default")
    ] = field(default_factory=dict)
    courses: Courses = tuple(GROUPS)
    courses_at: Annotated[Where, Field(description="end; absent: every_point")] = At("every_point")
    cycle: CycleEntry | None = None
    motion: Annotated[
        Facts | None, Field(description="of the exact motion; absent: it is followed at loading")
    ] = None
    tolerances: OwnTolerances = field(default_factory=OwnTolerances)
    checks: tuple[CheckEntry, ...] = ()


def load_cases(pattern: str | None = None, folder: Path | None = None) -> list[Case]:
    """Read the cases of a folder, by default the suite's own, in the order of their names.

    `pattern` has shell patterns on the ids (``damped-*,default``). `CaseError` if a file is broken
    (also one that is left out), two share an id, or a pattern matches none.
    """
    folder = CASES_FOLDER if folder is None else folder
    if not folder.is_dir():
        raise CaseError(folder, "", "no such folder of cases")
    cases: dict[str, Case] = {}
    for case in map(load_case, sorted(folder.glob("*.toml"))):
        if (other := cases.setdefault(case.id, case)) is not case:
            raise CaseError(case.file, "id", f"{case.id!r} is taken by {other.file.name}")
    chosen: dict[str, Case] = {}
    for wanted in (pattern or "*").split(","):
        matching = {name: cases[name] for name in fnmatch.filter(cases, wanted.strip())}
        if not matching:
            near = ", ".join(get_close_matches(wanted.strip(), cases, n=3))
            reason = f"no case matches {wanted if pattern else '*.toml'!r}"
            raise CaseError(folder, "", f"{reason}; nearest: {near}" if near else reason)
        chosen |= matching
    return [case for case in cases.values() if case.id in chosen]


def load_case(path: Path) -> Case:
    """Read one case file; `CaseError` names what is wrong with it and where.

    A file that states nothing of the exact motion (``motion``) costs the time to follow it.
    """
    file = data.DataFile(path, CaseError)
    file.data.setdefault("id", path.stem)
    written: CaseFile = file.read(CaseFile)
    own = _own_parameters(file, written)
    steps = communication_steps(file, written.experiment)
    values = _values(file, written, own)
    courses = _courses(file, written)
    for unknown in sorted(written.motion.zero - set(courses)) if written.motion else ():
        raise file.refusal(f"{unknown!r} is none of the courses", "motion", "zero")
    facts = written.motion or facts_of(follow(written.parameters, steps, written.law))
    rules = Rules(values, facts, law=truth.friction_law(written.law))
    return Case(
        id=written.id,
        title=written.title,
        about=written.about,
        parameters=written.parameters,
        steps=steps,
        checks=_checks(file, written, courses, _with_own(file, rules, written.tolerances)),
        file=path,
        klass=written.klass,
        facts=written.motion,
        law=written.law,
        own=own,
    )


def _own_parameters(file: data.DataFile, written: CaseFile) -> tuple[Parameter, ...]:
    try:
        own = tuple(truth.friction_law(written.law).parameters)
    except ValueError as error:
        raise file.refusal(str(error), "law") from None
    named = {*written.parameters, *(name for c in written.experiment.changes for name in c.set)}
    # An FMU need not have those of Coulomb's law.
    return () if written.law == COULOMB_NAME and not named & {each.name for each in own} else own


def _values(
    file: data.DataFile, written: CaseFile, own: Sequence[Parameter]
) -> tuple[Mapping[str, float], ...]:
    """Return all values in force at the start and after each change."""
    table = {each.name: each for each in (*PARAMETERS, *own)}
    moving = changeable(own)
    values: list[Mapping[str, float]] = []
    changes = (change.set for change in written.experiment.changes)
    for n, setting in enumerate((written.parameters, *changes)):
        place = ("experiment", "changes", n - 1, "set") if n else ("parameters",)
        allowed = moving if n else table.keys()
        for name, value in setting.items():
            if name not in allowed:
                raise file.refusal(f"cannot be set; there are {', '.join(allowed)}", *place, name)
            try:
                table[name].check(value)
            except ValueError as error:
                raise file.refusal(str(error), *place, name) from None
        try:
            values.append(complete({**(values[-1] if values else {}), **setting}, own))
        except ValueError as error:
            raise file.refusal(str(error), *place) from None
    return tuple(values)


def _with_own(file: data.DataFile, rules: Rules, own: OwnTolerances) -> Rules:
    if (own.conditioning or 0.0) > rules.narrowest * (1.0 + 1e-9):
        reason = f"{own.conditioning} is above that of the narrowest gap, {rules.narrowest:.3g}"
        raise file.refusal(reason, "tolerances", "conditioning")
    rules = replace(rules, own_conditioning=own.conditioning)
    if own.fmu is None:
        return rules
    rule, because = rules.fmu_course()
    if own.because is None and own.fmu > rule:
        reason = f"{own.fmu} is looser than the rules' {rule} and needs a reason: because"
        raise file.refusal(reason, "tolerances", "fmu")
    tighter = f"{own.fmu:g}, tighter than the rules' {rule:g}: {because}"
    return replace(rules, own_fmu=(own.fmu, own.because or tighter))


def _courses(file: data.DataFile, written: CaseFile) -> list[str]:
    """Return the outputs that are held against the exact motion at every point, groups resolved."""
    outputs: list[str] = []
    for n, name in enumerate(written.courses):
        for output in GROUPS.get(name, (name,)):
            if output in outputs:
                raise file.refusal(f"{output!r} is named twice", "courses", n)
            outputs.append(output)
    return outputs


def _checks(
    file: data.DataFile, written: CaseFile, courses: Sequence[str], rules: Rules
) -> tuple[Check, ...]:
    if written.law != COULOMB_NAME or rules.grows:
        places: list[data.Place] = [("cycle",)] if written.cycle else []
        places += [("checks", n, "formula") for n, c in enumerate(written.checks) if c.formula]
        for place in places:
            reason = "the formulas are those of Coulomb's law with constant coefficients; without "
            raise file.refusal(f"{reason}one the exact motion counts", *place)
    checks = list(_cycle(file, written.cycle, rules)) if written.cycle else []
    at = written.courses_at
    checks += [_check(f"{name}-course", name, "", at, rules.course(name)) for name in courses]
    for n, entry in enumerate(written.checks):
        if entry.id in invariant_ids() | {check.id for check in checks}:
            reason = f"{entry.id!r} is taken by another check or an invariant"
            raise file.refusal(reason, "checks", n, "id")
        tolerance = _tolerance(file, n, entry, rules)
        checks.append(_check(entry.id, entry.quantity, entry.formula, entry.at, tolerance))
    if not checks:
        raise file.refusal("it checks nothing: no courses, no cycle, no checks")
    return tuple(checks)


def _check(name: str, quantity: str, formula: str, at: At, tolerance: Tolerance) -> Check:
    return Check(**vars(tolerance), id=name, quantity=quantity, formula=formula, at=at)


def _cycle(file: data.DataFile, cycle: CycleEntry, rules: Rules) -> Iterator[Check]:
    if cycle.at.kind == "every_point":
        reason = "a cycle has no value at every point: end, { cycle = n } or { event = n }"
        raise file.refusal(reason, "cycle", "at")
    if not rules.lambda_:
        raise file.refusal("without a gap and a pull there is no cycle", "cycle")
    damped = rules.values[0]["c"] > 0.0
    formulas = {name: pair[damped] for name, pair in CYCLE.items() if len(pair) > damped}
    for n, name in enumerate(formulas if cycle.only is None else cycle.only):
        if name not in formulas:
            reason = f"{name!r} has no formula in the {'damped' if damped else 'undamped'} cycle; "
            there = f"these have: {', '.join(formulas)}"
            raise file.refusal(reason + there, "cycle", "only", n)
        tolerance = rules.formula(formulas[name])
        assert tolerance is not None, name
        yield _check(f"{name}-exact", name, formulas[name], cycle.at, tolerance)


def _tolerance(file: data.DataFile, n: int, entry: CheckEntry, rules: Rules) -> Tolerance:
    quantity, own = QUANTITIES[entry.quantity], entry.tolerance
    if entry.formula and (unit := FORMULAS[entry.formula].unit) != quantity.unit:
        reason = f"{entry.formula} is in {unit!r}, {quantity.name} in {quantity.unit!r}"
        raise file.refusal(reason, "checks", n, "formula")
    rule = rules.formula(entry.formula) if entry.formula else None
    if not entry.formula and quantity.name in OUTPUT_NAMES:
        rule = rules.course(quantity.name)
    if own is not None:
        measure = own.measure or (Measure.RELATIVE if rule is None else rule.measure)
        rule = Tolerance(measure, {"fmu": own.fmu, "reference": own.reference}, entry.because)
    if rule is None:
        of = f"no rule gives {entry.formula or quantity.name} a tolerance"
        reason = f"{of}: state it here, and the reasons in because"
        raise file.refusal(reason, "checks", n)
    if rule.measure == Measure.RELATIVE and entry.at.kind == "every_point":
        reason = "relative makes no sense over all points, where a value may cross zero: of_scale"
        raise file.refusal(reason, "checks", n, "tolerance", "measure")
    if quantity.discrete and (rule.measure != Measure.ABSOLUTE or any(rule.tolerance.values())):
        reason = f"{quantity.name} is discrete: measure absolute, tolerance 0 on both sides"
        raise file.refusal(reason, "checks", n, "tolerance")
    return rule


@dataclass(frozen=True)
class Meaning:
    """The consequence of a check's failure for a user of the FMU, and the likeliest bug."""

    means: str
    look: str


def meanings(cases: Iterable[Case], invariants: Invariants) -> dict[str, Meaning]:
    """Return the meaning of every check by its id, those of cases first."""
    about: dict[str, Quantity | Invariant] = {
        check.id: QUANTITIES[check.quantity] for case in cases for check in case.checks
    }
    about |= {invariant.id: invariant for invariant in invariants}
    found = {name: Meaning(of.means, of.look) for name, of in about.items()}
    asymptotic = Meaning(**ASYMPTOTIC)
    return found | {f"{invariant.id}-asymptotic": asymptotic for invariant in invariants.orders}


FAMILY = Path(__file__).with_name("family.toml")


@cache
def _data() -> Mapping[str, Any]:
    return tomllib.loads(FAMILY.read_text("utf-8"))


def long_cases() -> Collection[str]:
    """Return the cases whose nearby motions take seconds, and tell little that others do not."""
    return frozenset(_data()["long"])


def load_family(solvers: Iterable[str]) -> Mapping[str, Mapping[str, float]]:
    """Return delta by solver, of the names in order, and case; see `judge.accuracy`."""
    deltas: Mapping[str, list[float]] = _data()["deltas"]
    columns = zip(solvers, zip(*deltas.values(), strict=True), strict=True)
    return {solver: dict(zip(deltas, column, strict=True)) for solver, column in columns}
