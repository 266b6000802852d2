"""Verification cases: data files, read, checked and turned into frozen objects.

A case is one TOML file under `schemas.case`. Everything that can be wrong with it is told
with the file, the field and the reason before anything runs. Tolerances come from the rules in
`tolerances`, but for those that a file states.
"""

import fnmatch
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from stickslip_verification import truth
from stickslip_verification.model.data_file import objection, read_toml, where_is
from stickslip_verification.model.formulas import CYCLE, FORMULAS
from stickslip_verification.model.quantities import GROUPS, OUTPUT_NAMES, QUANTITIES
from stickslip_verification.model.verdict import CaseGroup, Kind, Klass, Measure
from stickslip_verification.suite import schemas
from stickslip_verification.suite.experiment import (
    CaseError,
    CommunicationStep,
    communication_steps,
    points,
)
from stickslip_verification.suite.invariants import invariant_ids
from stickslip_verification.suite.tolerances import Facts, Rules, Tolerance, facts_of
from stickslip_verification.truth.named import COULOMB_NAME
from stickslip_verification.truth.parameters import Parameter, complete

HERE = Path(__file__).parent
CASES_FOLDER = HERE / "cases"
SIDES = ("fmu", "reference")


@dataclass(frozen=True)
class At:
    """Where a check looks: ``kind`` is end, every_point, cycle or event, the last two by number."""

    kind: str
    number: int = 0

    def __str__(self) -> str:
        return f"{self.kind} {self.number}" if self.number else self.kind


@dataclass(frozen=True)
class Truth:
    """Where the expected value comes from.

    ``kind`` is the class of truth, ``source`` the equation number in docs/theory.md, ``formula`` a
    name in `FORMULAS`, or None for the exact motion in high precision.
    """

    kind: Kind
    source: int
    formula: str | None


@dataclass(frozen=True)
class Check:
    """One comparison, judged on each side with that side's tolerance.

    ``measure`` is relative (of the expected value), of_scale (of the largest magnitude that the
    exact motion gives this quantity at any communication point) or absolute (in ``unit``).
    """

    id: str
    quantity: str
    unit: str
    truth: Truth
    at: At
    measure: Measure
    tolerance: Mapping[str, float]
    because: Mapping[str, str]


@dataclass(frozen=True)
class Case:
    """One motion and what is checked on it.

    ``parameters`` holds only what the case sets (SI); everything else stays at the default of
    each side, so that the defaults are verified too. ``klass`` is contract where what happens is
    our convention and not physics, such as the clamp. ``facts`` is what the file states of the
    exact motion, None where it leaves that to the loading. ``law`` is the name of the friction law,
    ``own`` its own parameters; those of Coulomb's law only in a case that names one of them, since
    an FMU need not have them.
    """

    id: str
    title: str
    about: str
    parameters: Mapping[str, float]
    steps: tuple[CommunicationStep, ...]
    checks: tuple[Check, ...]
    file: Path
    klass: Klass = Klass.PHYSICS
    facts: Facts | None = None
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


def load_cases(pattern: str | None = None, folder: Path | None = None) -> list[Case]:
    """Read the cases of a folder, in the order of their names.

    Parameters
    ----------
    pattern
        Shell pattern on the ids (``damped-*``); None takes all.
    folder
        Where the TOML files are; None takes the suite's own.

    Raises
    ------
    CaseError
        A file is broken (also one that the pattern leaves out), two share an id, or none matches.
    """
    folder = CASES_FOLDER if folder is None else folder
    if not folder.is_dir():
        raise CaseError(folder, "", "no such folder of cases")
    cases = [load_case(file) for file in sorted(folder.glob("*.toml"))]
    seen: dict[str, Path] = {}
    for case in cases:
        if case.id in seen:
            raise CaseError(case.file, "id", f"{case.id!r} is taken by {seen[case.id].name}")
        seen[case.id] = case.file
    chosen = [c for c in cases if pattern is None or fnmatch.fnmatchcase(c.id, pattern)]
    if not chosen:
        raise CaseError(folder, "", f"no case matches {pattern or '*.toml'!r}")
    return chosen


def load_case(file: Path) -> Case:
    """Read one case file; `CaseError` names what is wrong with it and where.

    A file that states nothing of the exact motion (``motion``) costs the time to follow it.
    """
    data = read_toml(file, CaseError)
    law = data.get("law", COULOMB_NAME)
    own = _own_parameters(file, law)
    _validate(file, data, own)
    parameters = {name: float(value) for name, value in data.get("parameters", {}).items()}
    steps = communication_steps(file, data["experiment"])
    if law == COULOMB_NAME and not _names(own, parameters, steps):
        own = ()
    values = _values(file, parameters, steps, own)
    stated = _stated(file, data)
    facts = facts_of(follow(parameters, steps, law)) if stated is None else stated
    rules = _own(
        file, Rules(values, facts, law=truth.friction_law(law)), data.get("tolerances", {})
    )
    return Case(
        id=data["id"],
        title=data["title"],
        about=data["about"].strip(),
        parameters=parameters,
        steps=steps,
        checks=_checks(file, data, rules),
        file=file,
        klass=Klass(data.get("class", Klass.PHYSICS)),
        facts=stated,
        law=law,
        own=own,
    )


def _names(
    own: Iterable[Parameter], parameters: Mapping[str, float], steps: Iterable[CommunicationStep]
) -> bool:
    """Return whether a case gives one of these parameters a value."""
    named = {*parameters, *(name for step in steps for name in step.changes)}
    return any(each.name in named for each in own)


def follow(
    parameters: Mapping[str, float],
    steps: Iterable[CommunicationStep],
    law: str = COULOMB_NAME,
    *,
    in_doubles: bool = False,
) -> truth.Run:
    """Follow the exact motion under a friction law through communication steps.

    Quick and `in_doubles` where it is for planning alone.
    """
    taken = [truth.Step(step.h, dict(step.changes)) for step in steps]
    friction = truth.friction_law(law)
    digits = None if in_doubles else friction.digits
    return truth.run(parameters, taken, law=friction, digits=digits)


def _own_parameters(file: Path, law: Any) -> tuple[Parameter, ...]:
    """Return the own parameters of a case's friction law."""
    try:
        return tuple(truth.friction_law(str(law)).parameters)
    except ValueError as error:
        raise CaseError(file, where_is(file, ("law",)), str(error)) from None


def _validate(file: Path, data: Mapping[str, Any], own: Sequence[Parameter]) -> None:
    found = objection(data, schemas.case(own))
    if found is not None:
        raise CaseError(file, where_is(file, found[0]), found[1])
    for path, number in _numbers(data, ()):
        if not abs(number) <= sys.float_info.max:
            raise CaseError(file, where_is(file, path), f"{number} is not a finite number")


def _numbers(node: Any, path: tuple[str | int, ...]) -> Iterator[tuple[tuple[str | int, ...], Any]]:
    if isinstance(node, Mapping):
        for key, value in node.items():
            yield from _numbers(value, (*path, key))
    elif isinstance(node, list):
        for n, value in enumerate(node):
            yield from _numbers(value, (*path, n))
    elif isinstance(node, int | float):
        yield path, node


def _values(
    file: Path,
    parameters: Mapping[str, float],
    steps: Iterable[CommunicationStep],
    own: Sequence[Parameter],
) -> tuple[Mapping[str, float], ...]:
    """Return all values in force at the start and after each change."""
    where = "parameters"
    try:
        values = [complete(parameters, own)]
        for n, step in enumerate(step for step in steps if step.changes):
            where = f"experiment.changes[{n}].set"
            values.append(complete({**values[-1], **step.changes}, own))
    except ValueError as error:
        raise CaseError(file, where, str(error)) from None
    return tuple(values)


def _stated(file: Path, data: Mapping[str, Any]) -> Facts | None:
    """Return what the file states of the exact motion."""
    if "motion" not in data:
        return None
    motion = data["motion"]
    zero = motion.get("zero", [])
    courses = _courses(file, data)
    for n, name in enumerate(zero):
        if name not in courses:
            reason = f"{name!r} is none of the courses: {', '.join(courses)}"
            raise CaseError(file, where_is(file, ("motion", "zero", n)), reason)
    return Facts(motion["slips"], motion.get("reversals", 0), frozenset(zero))


def _own(file: Path, rules: Rules, own: Mapping[str, Any]) -> Rules:
    """Put what the file states in place of the rules."""
    conditioning = own.get("conditioning")
    if conditioning is not None and conditioning > rules.narrowest * (1.0 + 1e-9):
        where = where_is(file, ("tolerances", "conditioning"))
        reason = f"{conditioning} is above that of the narrowest gap, {rules.narrowest:.3g}"
        raise CaseError(file, where, reason)
    rules = replace(rules, own_conditioning=conditioning)
    if "fmu" not in own:
        return rules
    fmu, rule = float(own["fmu"]), rules.fmu_course()[0]
    because = " ".join(own.get("because", "").split())
    if not because and fmu > rule:
        where = where_is(file, ("tolerances", "fmu"))
        reason = f"{fmu} is looser than the rules' {rule} and needs a reason: because"
        raise CaseError(file, where, reason)
    return replace(rules, own_fmu=(fmu, because or rules.tighter(fmu)))


def _courses(file: Path, data: Mapping[str, Any]) -> list[str]:
    """Return the outputs that are held against the exact motion at every point, groups resolved."""
    found: list[str] = []
    for n, name in enumerate(data.get("courses", GROUPS)):
        where = where_is(file, ("courses", n))
        if name not in GROUPS and name not in OUTPUT_NAMES:
            known = f"groups {', '.join(GROUPS)}; outputs {', '.join(OUTPUT_NAMES)}"
            raise CaseError(file, where, f"{name!r} is not a known output or group: {known}")
        for output in GROUPS.get(name, (name,)):
            if output in found:
                raise CaseError(file, where, f"{output!r} is named twice")
            found.append(output)
    return found


def _checks(file: Path, data: Mapping[str, Any], rules: Rules) -> tuple[Check, ...]:
    """Return the checks of a case: formulas of the cycle, courses, and those written out."""
    checks = []
    _check_formulas(file, data, rules)
    for quantity, formula, at in _cycle(file, data, rules):
        tolerance = rules.formula(formula)
        assert tolerance is not None, formula
        checks.append(_check(f"{quantity}-exact", quantity, formula, at, tolerance))
    at = At(data.get("courses_at", "every_point"))
    for quantity in _courses(file, data):
        tolerance = rules.course(quantity)
        checks.append(_check(f"{quantity}-course", quantity, None, at, tolerance))
    for n, entry in enumerate(data.get("checks", [])):
        check = _written(file, n, entry, rules)
        taken = "another check" if any(check.id == other.id for other in checks) else None
        taken = "an invariant" if check.id in invariant_ids() else taken
        if taken is not None:
            where = where_is(file, ("checks", n, "id"))
            raise CaseError(file, where, f"{check.id!r} is taken by {taken}")
        checks.append(check)
    if not checks:
        raise CaseError(file, "", "it checks nothing: no courses, no cycle, no checks")
    return tuple(checks)


def _check_formulas(file: Path, data: Mapping[str, Any], rules: Rules) -> None:
    """Refuse formulas, which are those of Coulomb's law with constant coefficients."""
    if data.get("law", COULOMB_NAME) == COULOMB_NAME and not rules.grows:
        return
    paths: list[tuple[str | int, ...]] = [("cycle",)] if "cycle" in data else []
    paths += [
        ("checks", n, "formula")
        for n, entry in enumerate(data.get("checks", []))
        if "formula" in entry
    ]
    if paths:
        reason = (
            "the formulas are those of Coulomb's law with constant coefficients; without one the "
            "exact motion counts"
        )
        raise CaseError(file, where_is(file, paths[0]), reason)


def _check(name: str, quantity: str, formula: str | None, at: At, tolerance: Tolerance) -> Check:
    equation = (QUANTITIES[quantity] if formula is None else FORMULAS[formula]).equation
    return Check(
        id=name,
        quantity=quantity,
        unit=QUANTITIES[quantity].unit,
        truth=Truth(Kind.CLOSED_FORM, equation, formula),
        at=at,
        measure=tolerance.measure,
        tolerance=tolerance.allowed,
        because=tolerance.because,
    )


def _cycle(file: Path, data: Mapping[str, Any], rules: Rules) -> Iterator[tuple[str, str, At]]:
    """Yield the outputs of the steady cycle that are held against their formulas."""
    if "cycle" not in data:
        return
    cycle = data["cycle"]
    at = _at(cycle["at"])
    if at.kind == "every_point":
        reason = "a cycle has no value at every point: end, { cycle = n } or { event = n }"
        raise CaseError(file, where_is(file, ("cycle", "at")), reason)
    if not rules.lambda_:
        reason = "without a gap and a pull there is no cycle"
        raise CaseError(file, where_is(file, ("cycle",)), reason)
    damped = rules.values[0]["c"] > 0.0
    formulas = {name: pair[damped] for name, pair in CYCLE.items()}
    there = {name: formula for name, formula in formulas.items() if formula is not None}
    for n, name in enumerate(cycle.get("only", there)):
        if name not in there:
            reason = f"{name!r} has no formula in the {'damped' if damped else 'undamped'} cycle; "
            where = where_is(file, ("cycle", "only", n))
            raise CaseError(file, where, f"{reason}these have: {', '.join(there)}")
        yield name, there[name], at


def _at(entry: str | Mapping[str, int]) -> At:
    return At(entry) if isinstance(entry, str) else At(*next(iter(entry.items())))


def _written(file: Path, n: int, entry: Mapping[str, Any], rules: Rules) -> Check:
    """Build a check that a case spells out; fields that it leaves out come from the rules."""

    def refuse(reason: str, *path: str) -> CaseError:
        return CaseError(file, where_is(file, ("checks", n, *path)), reason)

    quantity, name = QUANTITIES.get(entry["quantity"]), entry.get("formula")
    if quantity is None:
        known = ", ".join(QUANTITIES)
        raise refuse(f"{entry['quantity']!r} is not a known quantity: {known}", "quantity")
    if name is not None:
        if name not in FORMULAS:
            reason = f"{name!r} is not a known formula: {', '.join(FORMULAS)}"
            raise refuse(reason, "formula")
        if FORMULAS[name].unit != quantity.unit:
            unit = FORMULAS[name].unit
            raise refuse(f"{name} is in {unit!r}, {quantity.name} in {quantity.unit!r}", "formula")
    at = _at(entry["at"])
    own, because = entry.get("tolerance", {}), entry.get("because", {})
    rule = rules.formula(name) if name is not None else None
    if name is None and quantity.name in OUTPUT_NAMES:
        rule = rules.course(quantity.name)
    measure = Measure(own.get("measure", Measure.RELATIVE if rule is None else rule.measure))
    if measure == Measure.RELATIVE and at.kind == "every_point":
        reason = "relative makes no sense over all points, where a value may cross zero: of_scale"
        raise refuse(reason, "tolerance", "measure")
    if quantity.discrete and (
        measure != Measure.ABSOLUTE or any(own.get(side, 0.0) != 0.0 for side in SIDES)
    ):
        reason = f"{quantity.name} is discrete: measure absolute, tolerance 0 on both sides"
        raise refuse(reason, "tolerance")
    allowed, reasons = {}, {}
    for side in SIDES:
        if side in own and side not in because:
            raise refuse(f"it needs a reason: because.{side}", "tolerance", side)
        if side in because and side not in own:
            raise refuse(f"a reason without a tolerance.{side}", "because", side)
        if side in own:
            allowed[side], reasons[side] = float(own[side]), " ".join(because[side].split())
        elif rule is not None and rule.measure == measure:
            allowed[side], reasons[side] = rule.allowed[side], rule.because[side]
        else:
            of = name or quantity.name
            reason = f"no rule gives {of} a tolerance ({measure})"
            raise refuse(f"{reason}: state {side} here and its reason in because", "tolerance")
    return _check(entry["id"], quantity.name, name, at, Tolerance(measure, allowed, reasons))
