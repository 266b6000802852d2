"""Random sequences of another friction law: those of Coulomb's law, with parameters of its own.

Changes come at the moments that were drawn along Coulomb's motion, and so in any phase of the
motion under the other law. Static friction that grows at rest is one in this sense.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from random import Random

from stickslip_verification import truth
from stickslip_verification.suite.cases import Case, follow
from stickslip_verification.suite.sequences import well_decided

SHARE = 8
"""Of the sequences of Coulomb's law every eighth is tried under another one, whose exact motion is
marched and not in closed form."""

_MOST_POINTS = 5  # of a drawn friction curve
_ATTEMPTS = 10  # draws of growing friction for one sequence, until rounding decides no event


def under_law(cases: Sequence[Case], law: str, seed: int) -> list[Case]:
    """Return every `SHARE`th of these cases under the friction law of this name."""
    own = tuple(truth.friction_law(law).parameters)
    drawn = (
        (case, _DRAWS[law](Random(f"{law} {seed} {case.id}"), case)) for case in cases[::SHARE]
    )
    return [
        replace(case, parameters={**case.parameters, **new}, law=law, own=own)
        for case, new in drawn
    ]


def with_dwell(cases: Sequence[Case], seed: int) -> list[Case]:
    """Return every `SHARE`th of these cases of Coulomb's law with a friction that grows at rest."""
    found = []
    for case in cases[::SHARE]:
        for attempt in range(_ATTEMPTS):
            drawn = _growing(Random(f"dwell {seed} {case.id} {attempt}"), case)
            if well_decided(follow(drawn.parameters, drawn.steps, in_doubles=True)):
                found.append(drawn)
                break
    return found


def _growing(draw: Random, case: Case) -> Case:
    """Draw a growth as quick as the swing, within two decades; it changes at one of the steps."""
    start = case.start
    w, gap = math.sqrt(start["k"] / start["m"]), start["mu_s"] - start["mu_k"]

    def growth() -> dict[str, float]:
        return {
            "tau_s": draw.choice((0.0, 1.0, 1.0)) * 10.0 ** draw.uniform(-2.0, 2.0) / w,
            "B": draw.choice((0.0, 1.0, 1.0)) * gap * 10.0 ** draw.uniform(-2.0, 0.0),
            "t_0": 10.0 ** draw.uniform(-2.0, 1.0) / w,
        }

    old = {"age_start": draw.choice((0.0, 10.0 ** draw.uniform(-1.0, 3.0) / w))}
    changed = draw.choice([n for n, step in enumerate(case.steps) if n == 0 or step.changes])
    steps = [
        replace(step, changes={**step.changes, **growth()}) if n == changed and n else step
        for n, step in enumerate(case.steps)
    ]
    return replace(
        case,
        id=f"{case.id}-dwell",
        title=f"{case.title}, static friction grows at rest",
        parameters={**case.parameters, **growth(), **old},
        steps=tuple(steps),
        own=tuple(truth.COULOMB.parameters),
    )


def _stribeck(draw: Random, case: Case) -> Mapping[str, float]:
    """Draw a shape, its speeds about those of the pull, and a curve below every mu_s to come."""
    settings = [case.start, *(step.changes for step in case.steps)]
    pull = max(abs(values["v"]) for values in settings if "v" in values)
    rest = min(values["mu_s"] for values in settings if "mu_s" in values)
    count = draw.randint(2, _MOST_POINTS)
    drawn = {
        "shape": float(draw.randint(1, 3)),
        "v_s": pull * 10.0 ** draw.uniform(-1.5, 1.0),
        "delta": draw.choice((1.0, 2.0, 3.0, draw.uniform(1.0, 3.0))),
        "n_points": float(count),
        "mu_1": rest * draw.choice((1.0, draw.uniform(0.6, 1.0))),
    }
    speed = 0.0
    for number in range(2, count + 1):
        speed += pull * 10.0 ** draw.uniform(-1.5, 0.5)
        drawn |= {f"u_{number}": speed, f"mu_{number}": rest * draw.uniform(0.3, 1.0)}
    return drawn


_DRAWS: Mapping[str, Callable[[Random, Case], Mapping[str, float]]] = {"stribeck": _stribeck}
