"""Experiments of the cases: communication steps, and what changes between them."""

import itertools
import math
import random
from collections.abc import Iterable, Mapping, Sequence
from typing import Annotated, ClassVar

from pydantic import Field
from pydantic.dataclasses import dataclass as model

from stickslip_verification.model.data_file import (
    WRITTEN,
    Count,
    DataFile,
    Number,
    Positive,
    Written,
)
from stickslip_verification.truth import Step

_SAME_POINT = 1e-9  # of the mean step: how far rounding may move the sum of many steps
_SHORTEST_PART = 1e-15  # of the stop time: a drawn step below it would not move the sum of steps
MOST_STEPS = 1_000_000  # more than any case needs, and than the memory holds

CommunicationStep = Step
"""One step of ``h`` [s]; ``changes`` (name to value, SI) are set just before it."""


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


Seconds = Annotated[Positive, Field(description="[s]")]


@model(frozen=True, config=WRITTEN)
class Steps(Written):
    """Steps of one length, of lengths drawn evenly in their logarithm, or one by one."""

    SOME: ClassVar = ("fixed", "seed", "list")
    NEEDS: ClassVar = {"seed": ("shortest", "longest"), "shortest": ("seed",), "longest": ("seed",)}
    EXCLUDES: ClassVar = {"fixed": ("seed", "list"), "seed": ("list",)}

    fixed: Seconds | None = None
    seed: Count | None = None
    shortest: Seconds | None = None
    longest: Seconds | None = None
    list: tuple[Seconds, ...] = ()


@model(frozen=True, config=WRITTEN)
class Change(Written):
    """Values (SI) that are set at a communication point."""

    time: Seconds
    set: Annotated[Mapping[str, Number], Field(min_length=1)]


@model(frozen=True, config=WRITTEN)
class Experiment(Written):
    """What a case runs."""

    stop_time: Seconds
    steps: Steps
    changes: tuple[Change, ...] = ()


def communication_steps(file: DataFile, experiment: Experiment) -> tuple[CommunicationStep, ...]:
    """Lay out the steps of an experiment, with the changes at their communication points.

    Raises
    ------
    DataError
        The steps do not end at the stop time, a change lies between two of them, or they are too
        many.
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


def _lengths(file: DataFile, experiment: Experiment) -> Sequence[float]:
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
