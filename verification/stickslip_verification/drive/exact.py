"""The exact motion of a case, in high precision and rounded once, and the motions near it.

A numerical solution is good if it is the exact motion of a block whose data differ a little. So the
exact motions of such blocks say how far it may be off, point by point: where an event lies near a
communication point, where a shallow re-stick magnifies an error, where a tie decides the course.
"""

from __future__ import annotations

import contextlib
import hashlib
import itertools
import math
import os
import pickle
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from .. import truth
from ..model.data_file import write_whole
from ..model.quantities import OUTPUT_NAMES
from ..model.verdict import Event, ObservedOrder, Run, Series, Transition
from ..suite.cases import Case, follow
from ..suite.invariants import Order
from ..suite.tolerances import Facts, facts_of
from ..truth.course import BUILT_IN, COULOMB_NAME

if TYPE_CHECKING:
    import stickslip_ref

OFF = tuple(10.0**decade for decade in range(-9, 0))
"""By how much the data are off, as a part of each."""
MOTIONS, FEW = 8, 3
"""How many motions near the exact one are followed for each; and how many of a friction law that is
marched by series, which takes a hundred times as long, for each second of the parts."""
PART = 1e-4  # by how much a parameter is larger for its changes


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
    names = [n for n in OUTPUT_NAMES if n in run.initial]
    return Run(
        times=np.array(case.times),
        outputs={n: np.array([float(sample[n]) for sample in run.samples]) for n in names},
        initial={n: float(run.initial[n]) for n in names},
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
    for row in range(0, len(OFF), 2 if marched else 1):
        for n in range(FEW if marched else MOTIONS):
            run = _follow(case, *_off(case, Random(f"{case.id} {n}"), OFF[row], force, speed))
            for name, widest in widest_of.items():
                off = np.abs(run.outputs[name] - plain.outputs[name])
                widest[row] = np.fmax(widest[row], off)
    return {name: np.maximum.accumulate(widest, axis=0) for name, widest in widest_of.items()}


def changes(case: Case) -> dict[str, dict[str, Series]]:
    """Return what each parameter that a case gives a value moves of `MOTION`, for a part of it."""
    plain = shifted(case, "", 0.0)
    settings = [*(step.changes for step in case.steps), case.start]
    chosen = {each.name for each in case.own if each.chosen}
    moved = {}
    for name in dict.fromkeys(name for values in settings for name in values):
        is_zero = not any(values.get(name) for values in settings)
        if not (is_zero or name in chosen or name.endswith("_start")):
            with contextlib.suppress(ValueError):
                run = shifted(case, name, PART)
                moved[name] = {
                    n: (run.outputs[n] - plain.outputs[n]) / PART for n in ("x", "x_dot", "F")
                }
    return moved


def shifted(case: Case, name: str, part: float) -> Run:
    """Follow a case exactly with one of its numbers larger by a part, at the start and later."""

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
        before = now
        if step.changes:
            now = lawful({**now, **step.changes, **about(step.changes)})
        changes.append({name: value for name, value in now.items() if value != before[name]})
    return start, changes


def _follow(
    case: Case, parameters: Mapping[str, float], changes: Sequence[Mapping[str, float]]
) -> Run:
    steps = [truth.Step(step.h, dict(new)) for step, new in zip(case.steps, changes, strict=True)]
    return record_of(case, truth.run(parameters, steps, digits=None, law=case.law))


def run_reference(case: Case) -> Run:
    """Run a case with the reference, sampled at its communication points; warnings are messages."""
    times = np.array((0.0, *case.times))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        trajectory = simulate_reference(case)
    columns = {name: np.asarray(getattr(trajectory, name), np.float64) for name in OUTPUT_NAMES}
    return Run(
        times=times[1:],
        outputs={name: samples[1:] for name, samples in columns.items()},
        initial={name: float(samples[0]) for name, samples in columns.items()},
        messages=tuple(str(warning.message) for warning in caught),
    )


def simulate_reference(case: Case, rtol: float | None = None) -> stickslip_ref.Trajectory:
    """Simulate a case with the reference; `rtol` is the tolerance of a step, its own if None."""
    import stickslip_ref

    base, own = _split(case, case.parameters)
    changes = [
        stickslip_ref.Change(time, *_split(case, step.changes))
        for step, time in zip(case.steps, (0.0, *case.times), strict=False)
        if step.changes
    ]
    return stickslip_ref.simulate(
        stickslip_ref.Parameters(**base),
        case.stop_time,
        changes=changes,
        times=np.array((0.0, *case.times)),
        rtol=stickslip_ref.RTOL if rtol is None else rtol,
        law=case.law,
        own=own,
    )


def _split(case: Case, values: Mapping[str, float]) -> tuple[dict[str, float], dict[str, float]]:
    names = {each.name for each in case.own}
    own = {name: value for name, value in values.items() if name in names}
    return {name: value for name, value in values.items() if name not in names}, own


def observe(case: Case, invariant: Order) -> ObservedOrder:
    """Run the reference on a case at each tolerance of an invariant.

    The error is the root mean square over the communication points, over the quantity's largest
    value in the exact motion.
    """
    expected = exact_motion(case).record.outputs[invariant.quantity]
    scale = float(np.max(np.abs(expected)))
    tolerances = np.geomspace(invariant.coarsest, invariant.finest, invariant.levels).tolist()
    errors = []
    for tolerance in tolerances:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            got = getattr(simulate_reference(case, tolerance), invariant.quantity)[1:]
        errors.append(float(np.sqrt(np.mean((got - expected) ** 2))) / scale)
    pairs = itertools.pairwise(zip(tolerances, errors, strict=True))
    return ObservedOrder(
        case=case.id,
        quantity=invariant.quantity,
        tolerances=tolerances,
        errors=errors,
        orders=[slope(*zip(*pair, strict=True)) for pair in pairs],
        expected=invariant.order,
    )


def slope(tolerances: Sequence[float], errors: Sequence[float]) -> float:
    """Fit the slope of log error over log tolerance; NaN where an error is zero or not finite."""
    if not all(0.0 < error < math.inf for error in errors):
        return math.nan
    return float(np.polyfit(np.log(tolerances), np.log(errors), 1)[0])


FOLDER = "STICKSLIP_KEPT"
"""The environment variable that names the folder: one's own, for its files are pickles, and new in
each session, for they do not say from what code they come."""

T = TypeVar("T")


def kept(function: Callable[..., T], case: Case, *arguments: Any) -> T:
    """Return `function(case, *arguments)`, or its result from earlier in this session.

    Of a friction law from elsewhere, whose source is not looked at, nothing is kept.
    """
    folder = os.environ.get(FOLDER)
    if not folder or case.law not in BUILT_IN:
        return function(case, *arguments)
    asked = repr((function.__qualname__, case.id, case.law, case.parameters, case.steps, arguments))
    file = Path(folder) / f"{hashlib.sha256(asked.encode()).hexdigest()}.pickle"
    # A file that cannot be read or written costs the time to compute, and nothing else.
    with contextlib.suppress(OSError, EOFError, pickle.UnpicklingError):
        earlier: T = pickle.loads(file.read_bytes())
        return earlier
    result = function(case, *arguments)
    with contextlib.suppress(OSError):
        write_whole(file, pickle.dumps(result))
    return result
