"""Experiments of the cases: communication steps, and what changes between them."""

import itertools
import math
import random
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from stickslip_verification.model.data_file import DataError

SAME_POINT = 1e-9
"""A change is at a communication point if it is within this fraction of the mean step: the sum of
many steps differs from the number written in the file by rounding, never by that much."""


SHORTEST_PART = 1e-15
"""A drawn step below this part of the whole would not move the sum of the steps."""

MOST_STEPS = 1_000_000
"""More steps than any case needs; beyond it the memory would go before the patience."""


class CaseError(DataError):
    """A case file cannot be used; one line with the file, the line or field, and the reason."""


@dataclass(frozen=True)
class CommunicationStep:
    """One step of ``h`` [s]; ``changes`` (name to value, SI) are set just before it."""

    h: float
    changes: Mapping[str, float]


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


def communication_steps(file: Path, experiment: Mapping[str, Any]) -> tuple[CommunicationStep, ...]:
    """Lay out the steps of an experiment, with the changes at their communication points.

    Raises
    ------
    CaseError
        The steps do not end at the stop time, a change lies between two of them, or they are too
        many.
    """
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
    if not (shortest > SHORTEST_PART * stop_time and longest / shortest < math.inf):
        reason = f"{shortest} is lost beside stop_time {stop_time} or longest {longest}"
        raise CaseError(file, "experiment.steps.shortest", reason)
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
