"""The exact motion of a case, in high precision and rounded once, and the motions near it.

A numerical solution is good if it is the exact motion of a block whose data differ a little. So the
exact motions of such blocks say how far it may be off, point by point: where an event lies near a
communication point, where a shallow re-stick magnifies an error, where a tie decides the course.
"""

import contextlib
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from random import Random

import numpy as np

from stickslip_verification import truth
from stickslip_verification.model.events import Event, Transition
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.model.run import Run, Series
from stickslip_verification.suite.cases import Case, follow
from stickslip_verification.suite.tolerances import Facts, facts_of
from stickslip_verification.truth.named import COULOMB_NAME

OFF = tuple(10.0**decade for decade in range(-9, 0))
"""By how much the data are off, as a part of each."""

MOTIONS, FEW = 8, 3
"""How many motions near the exact one are followed for each; and how many of a friction law that is
marched by series, which takes a hundred times as long, for each second of the parts."""

PART = 1e-4
"""By how much a parameter is larger for its changes."""


@dataclass(frozen=True)
class Exact:
    """The exact motion of a case: its samples, rounded to double once, and its transitions.

    ``start`` has every value at the start (SI), ``facts`` is what the tolerances take from it.
    """

    record: Run
    start: Mapping[str, float]
    events: Sequence[Event]
    facts: Facts

    @property
    def event_times(self) -> Sequence[float]:
        """Times of the transitions [s]."""
        return [event.time for event in self.events]


def exact_motion(case: Case) -> Exact:
    """Compute the exact motion of a case in high precision, rounded to double once."""
    run = follow(case.parameters, case.steps, case.law)
    return Exact(
        record=record_of(case, run),
        start=case.start,
        events=[
            Event(float(e.time), Transition(e.kind), e.mode, float(e.x), float(e.z))
            for e in run.events
        ],
        facts=facts_of(run),
    )


def record_of(case: Case, run: truth.Run) -> Run:
    """Return the samples of an exact run of a case, rounded to double."""
    return Run(
        times=np.array(case.times),
        outputs={n: np.array([float(sample[n]) for sample in run.samples]) for n in OUTPUT_NAMES},
        initial={n: float(run.initial[n]) for n in OUTPUT_NAMES},
    )


def spreads(case: Case) -> dict[str, Series]:
    """Return how far each output lies from the exact motion when the data are off by `OFF`.

    Shape ``(len(OFF), n)`` each, in the unit of the output; the largest of a few motions whose data
    are off up or down, and of those with data less off. A force is added to F_ext, a speed to a
    pull at rest, and a damper to none, so that neither a balance of forces nor a velocity that just
    touches zero is met exactly.
    """
    plain = _follow(case, case.start, [step.changes for step in case.steps])
    force = max(float(np.max(np.abs(plain.outputs[name]))) for name in ("F", "F_s"))
    speed = float(np.max(np.abs(plain.outputs["x_dot"])))
    marched = case.law != COULOMB_NAME
    widest_of = {
        name: np.zeros((len(OFF), samples.size)) for name, samples in plain.outputs.items()
    }
    for row, part in enumerate(OFF):
        for n in range(FEW if marched else MOTIONS):
            if marched and row % 2:
                break
            run = _follow(case, *_off(case, Random(f"{case.id} {n}"), part, force, speed))
            for name, widest in widest_of.items():
                off = np.abs(run.outputs[name] - plain.outputs[name])
                widest[row] = np.fmax(widest[row], off)
    return {name: np.maximum.accumulate(widest, axis=0) for name, widest in widest_of.items()}


def changes(case: Case) -> dict[str, dict[str, Series]]:
    """Return what each parameter that a case gives a value moves of `MOTION`, for a part of it."""
    plain = _shifted(case, "", 0.0)
    values = {**{n: 0.0 for step in case.steps for n in step.changes}, **case.start}
    chosen = {each.name for each in case.own if each.chosen}
    moved = {}
    for name in values:
        all_values = [values[name], *(step.changes.get(name, 0.0) for step in case.steps)]
        if any(all_values) and name not in chosen and not name.endswith("_start"):
            with contextlib.suppress(ValueError):
                run = _shifted(case, name, PART)
                moved[name] = {
                    n: (run.outputs[n] - plain.outputs[n]) / PART for n in ("x", "x_dot", "F")
                }
    return moved


def _shifted(case: Case, name: str, part: float) -> Run:
    """Follow a case with one of its numbers larger by a part, at the start and at every change."""

    def larger(values: Mapping[str, float]) -> dict[str, float]:
        return {n: value * (1.0 + part) if n == name else value for n, value in values.items()}

    return _follow(case, larger(case.start), [larger(step.changes) for step in case.steps])


def _off(
    case: Case, draw: Random, part: float, force: float, speed: float
) -> tuple[Mapping[str, float], Sequence[Mapping[str, float]]]:
    """Return the parameters of a case and the changes before each step, all of them off."""

    def about(names: Iterable[str]) -> dict[str, float]:
        new = {
            name: values[name] * (1.0 + draw.choice((-part, part)))
            for name in names
            if name not in chosen
        }
        if "F_ext" in new:
            new["F_ext"] += draw.choice((-part, part)) * force
        if "c" in new:
            new["c"] += draw.choice((0.0, part)) * math.sqrt(values["k"] * values["m"])
        if new.get("v") == 0.0:
            new["v"] = draw.choice((-part, part)) * speed
        if "load" in new:
            new["load"] += draw.choice((-part, part)) * values["m"] * values["g"]
        return new

    def lawful(off: dict[str, float]) -> dict[str, float]:
        off["load"] = max(off["load"], -off["m"] * off["g"])
        if values["mu_k"] <= values["mu_s"]:
            off["mu_k"] = min(off["mu_k"], off["mu_s"])
        if values.get("mu_1", math.inf) <= values["mu_s"]:
            off["mu_s"] = max(off["mu_s"], off["mu_1"])
        return off

    chosen = {each.name for each in case.own if each.chosen}
    values = dict(case.start)
    start = now = lawful({**values, **about(values)})
    changes = []
    for step in case.steps:
        values |= step.changes
        before, now = now, lawful({**now, **step.changes, **about(step.changes)})
        changes.append({name: value for name, value in now.items() if value != before[name]})
    return start, changes


def _follow(
    case: Case, parameters: Mapping[str, float], changes: Sequence[Mapping[str, float]]
) -> Run:
    """Follow a case with other values, in doubles."""
    steps = [truth.Step(step.h, dict(new)) for step, new in zip(case.steps, changes, strict=True)]
    return record_of(case, truth.run(parameters, steps, digits=None, law=case.law))
