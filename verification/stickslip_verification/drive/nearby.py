"""Motions near the exact one: what a numerical solution cannot be told apart from.

A numerical solution is good if it is the exact motion of a block whose data differ a little. So the
exact motions of such blocks say how far it may be off, point by point: where an event lies near a
communication point, where a shallow re-stick magnifies an error, where a tie decides the course.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from random import Random

import numpy as np

from stickslip_verification import truth
from stickslip_verification.drive.exact import sampled
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.model.run import Run
from stickslip_verification.suite.cases import Case

OFF = 1e-8
"""By how much the data are off, as a part of each."""

MOTIONS = 8
"""How many motions near the exact one are followed."""


def nearby_motions(case: Case) -> tuple[Run, ...]:
    """Follow motions of a case, each with data that are off by `OFF` up or down.

    At every change the new values are off anew. A force of `OFF` times the largest one in play is
    added to F_ext, a speed to a pull at rest, and a damper to none, so that neither a balance of
    forces nor a velocity that just touches zero is met exactly.
    """
    plain = _follow(case, case.start, [step.changes for step in case.steps])
    force = max(float(np.max(np.abs(plain.outputs[name]))) for name in ("F", "F_s"))
    speed = float(np.max(np.abs(plain.outputs["x_dot"])))
    return tuple(
        _follow(case, *_off(case, Random(f"{case.id} {n}"), force, speed)) for n in range(MOTIONS)
    )


def _off(
    case: Case, draw: Random, force: float, speed: float
) -> tuple[Mapping[str, float], Sequence[Mapping[str, float]]]:
    """Return the parameters of a case and the changes before each step, all of them off."""

    def about(names: Iterable[str]) -> dict[str, float]:
        new = {
            name: values[name] * (1.0 + draw.choice((-OFF, OFF)))
            for name in names
            if name not in chosen
        }
        if "F_ext" in new:
            new["F_ext"] += draw.choice((-OFF, OFF)) * force
        if "c" in new:
            new["c"] += draw.choice((0.0, OFF)) * math.sqrt(values["k"] * values["m"])
        if new.get("v") == 0.0:
            new["v"] = draw.choice((-OFF, OFF)) * speed
        if "load" in new:
            new["load"] += draw.choice((-OFF, OFF)) * values["m"] * values["g"]
        return new

    def lawful(off: dict[str, float]) -> dict[str, float]:
        off["load"] = max(off["load"], -off["m"] * off["g"])
        if values["mu_k"] <= values["mu_s"]:
            off["mu_k"] = min(off["mu_k"], off["mu_s"])
        if values.get("mu_1", math.inf) <= values["mu_s"]:
            off["mu_1"] = min(off["mu_1"], off["mu_s"])
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
    run = truth.run(parameters, steps, digits=None, law=case.law)
    return Run(
        times=np.array(case.times),
        outputs=sampled(run),
        initial={name: float(run.initial[name]) for name in OUTPUT_NAMES},
    )
