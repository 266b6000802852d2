"""Verification cases: data files, read, checked and turned into frozen objects.

A case is one TOML file under `case.schema.json`. Everything that can be wrong with it is told
with the file, the field and the reason before anything runs.
"""

from __future__ import annotations

import fnmatch
import itertools
import math
import random
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from stickslip_verification.data_file import DataError, objection, read_toml, where_is
from stickslip_verification.formulas import FORMULAS
from stickslip_verification.quantities import QUANTITIES

HERE = Path(__file__).parent
CASES_FOLDER = HERE / "cases"
SCHEMA = HERE / "case.schema.json"
SIDES = ("fmu", "reference")

SAME_POINT = 1e-9
"""A change is at a communication point if it is within this fraction of the mean step: the sum of
many steps differs from the number written in the file by rounding, never by that much."""


class CaseError(DataError):
    """A case file cannot be used; one line with the file, the line or field, and the reason."""


@dataclass(frozen=True)
class CommunicationStep:
    """One step of ``h`` [s]; ``changes`` (name to value, SI) are set just before it."""

    h: float
    changes: Mapping[str, float]


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

    kind: str
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
    measure: str
    tolerance: Mapping[str, float]
    because: Mapping[str, str]


@dataclass(frozen=True)
class Case:
    """One motion and what is checked on it.

    ``parameters`` holds only what the case sets (SI); everything else stays at the default of
    each side, so that the defaults are verified too. ``klass`` is contract where what happens is
    our convention and not physics, such as the clamp.
    """

    id: str
    title: str
    about: str
    parameters: Mapping[str, float]
    steps: tuple[CommunicationStep, ...]
    checks: tuple[Check, ...]
    file: Path
    klass: str = "physics"

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
    """Read one case file; `CaseError` names what is wrong with it and where."""
    data = read_toml(file, CaseError)
    _validate(file, data)
    steps = _steps(file, data["experiment"])
    checks = tuple(_check(file, n, entry) for n, entry in enumerate(data["checks"]))
    for n, check in enumerate(checks):
        if any(check.id == other.id for other in checks[:n]):
            raise CaseError(
                file, where_is(file, ("checks", n, "id")), f"{check.id!r} is taken by another check"
            )
    return Case(
        id=data["id"],
        title=data["title"],
        about=data["about"].strip(),
        parameters={name: float(value) for name, value in data.get("parameters", {}).items()},
        steps=steps,
        checks=checks,
        file=file,
        klass=data.get("class", "physics"),
    )


def _validate(file: Path, data: Mapping[str, Any]) -> None:
    found = objection(data, SCHEMA)
    if found is not None:
        raise CaseError(file, where_is(file, found[0]), found[1])
    for path, number in _numbers(data, ()):
        if not math.isfinite(number):
            raise CaseError(file, where_is(file, path), f"{number} is not a finite number")


def _numbers(node: Any, path: tuple[str | int, ...]) -> Iterator[tuple[tuple[str | int, ...], Any]]:
    if isinstance(node, Mapping):
        for key, value in node.items():
            yield from _numbers(value, (*path, key))
    elif isinstance(node, list):
        for n, value in enumerate(node):
            yield from _numbers(value, (*path, n))
    elif isinstance(node, float):
        yield path, node


def points(lengths: Iterable[float]) -> tuple[float, ...]:
    """Partial sums, each correctly rounded (Neumaier's compensation), starting at 0."""
    total = carry = 0.0
    ends = []
    for h in lengths:
        bigger = total + h
        carry += (total - bigger) + h if abs(total) >= abs(h) else (h - bigger) + total
        total = bigger
        ends.append(total + carry)
    return tuple(ends)


def _steps(file: Path, experiment: Mapping[str, Any]) -> tuple[CommunicationStep, ...]:
    stop_time = float(experiment["stop_time"])
    changes = experiment.get("changes", [])
    for n, change in enumerate(changes):
        where = f"experiment.changes[{n}].time"
        if change["time"] >= stop_time:
            raise CaseError(file, where, f"{change['time']} is not before stop_time {stop_time}")
        if n and change["time"] <= changes[n - 1]["time"]:
            raise CaseError(file, where, "the changes are not in the order of time")
    marks = [float(change["time"]) for change in changes]
    lengths = _lengths(file, experiment["steps"], stop_time, marks)
    ends = points(lengths)
    near = SAME_POINT * stop_time / len(lengths)
    if abs(ends[-1] - stop_time) > near:
        reason = f"the steps end at {ends[-1]}, not at stop_time {stop_time}"
        raise CaseError(file, "experiment.steps", reason)
    settings: dict[int, dict[str, float]] = {}
    for n, mark in enumerate(marks):
        index = min(range(len(ends)), key=lambda i: abs(ends[i] - mark))
        if abs(ends[index] - mark) > near:
            reason = f"{mark} is not at a communication point; the nearest is {ends[index]}"
            raise CaseError(file, f"experiment.changes[{n}].time", reason)
        settings[index + 1] = {name: float(value) for name, value in changes[n]["set"].items()}
    return tuple(CommunicationStep(h, settings.get(n, {})) for n, h in enumerate(lengths))


MOST_STEPS = 1_000_000
"""More steps than any case needs; beyond it the memory would go before the patience."""


def _lengths(
    file: Path, steps: Mapping[str, Any], stop_time: float, marks: Sequence[float]
) -> list[float]:
    if "list" in steps:
        return [float(h) for h in steps["list"]]
    if "fixed" in steps:
        h = float(steps["fixed"])
        if stop_time / h > MOST_STEPS:
            raise _too_many(file, stop_time / h)
        return [h] * max(1, round(stop_time / h))
    shortest, longest = float(steps["shortest"]), float(steps["longest"])
    if shortest > longest:
        raise CaseError(file, "experiment.steps.shortest", f"{shortest} is above longest {longest}")
    spread = math.log(longest / shortest)
    mean = (longest - shortest) / spread if spread > 0.0 else longest
    if stop_time / mean > MOST_STEPS:
        raise _too_many(file, stop_time / mean)
    draw = random.Random(steps["seed"])
    lengths = []
    for begin, end in zip((0.0, *marks), (*marks, stop_time), strict=True):
        marked = [begin]
        while (left := end - marked[-1]) > 0.0:
            h = shortest * (longest / shortest) ** draw.random()
            marked.append(end if h >= left else marked[-1] + h)
        lengths += [b - a for a, b in itertools.pairwise(marked)]
    return lengths


def _too_many(file: Path, count: float) -> CaseError:
    return CaseError(file, "experiment.steps", f"{count:.3g} steps; {MOST_STEPS} are too many")


def _check(file: Path, n: int, entry: Mapping[str, Any]) -> Check:
    def here(*path: str) -> str:
        return where_is(file, ("checks", n, *path))

    quantity = QUANTITIES.get(entry["quantity"])
    if quantity is None:
        known = ", ".join(QUANTITIES)
        reason = f"{entry['quantity']!r} is not a known quantity: {known}"
        raise CaseError(file, here("quantity"), reason)
    if entry["unit"] != quantity.unit:
        reason = f"{quantity.name} is in {quantity.unit!r}, not {entry['unit']!r}"
        raise CaseError(file, here("unit"), reason)
    name = entry["truth"].get("formula")
    source = entry["truth"]["source"]
    if name is not None:
        if name not in FORMULAS:
            reason = f"{name!r} is not a known formula: {', '.join(FORMULAS)}"
            raise CaseError(file, here("truth", "formula"), reason)
        formula = FORMULAS[name]
        if source != formula.equation:
            reason = f"{name} is equation ({formula.equation}), not ({source})"
            raise CaseError(file, here("truth", "source"), reason)
        if formula.unit != quantity.unit:
            reason = f"{name} is in {formula.unit!r}, {quantity.name} in {quantity.unit!r}"
            raise CaseError(file, here("truth", "formula"), reason)
    at = entry["at"]
    place = At(at) if isinstance(at, str) else At(*next(iter(at.items())))
    measure = entry["tolerance"]["measure"]
    if measure == "relative" and place.kind == "every_point":
        reason = "relative makes no sense over all points, where a value may cross zero: of_scale"
        raise CaseError(file, here("tolerance", "measure"), reason)
    if quantity.discrete and (
        measure != "absolute" or any(entry["tolerance"][side] != 0 for side in SIDES)
    ):
        reason = f"{quantity.name} is discrete: measure absolute, tolerance 0 on both sides"
        raise CaseError(file, here("tolerance"), reason)
    return Check(
        id=entry["id"],
        quantity=quantity.name,
        unit=quantity.unit,
        truth=Truth(entry["truth"]["kind"], source, name),
        at=place,
        measure=measure,
        tolerance={side: float(entry["tolerance"][side]) for side in SIDES},
        because={side: " ".join(entry["because"][side].split()) for side in SIDES},
    )
