"""An exact run of the block: steps and changes in, every output out."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any

from stickslip_verification.truth.coulomb import COULOMB
from stickslip_verification.truth.law import FrictionLaw
from stickslip_verification.truth.motion import Event, Motion
from stickslip_verification.truth.parameters import (
    CHANGEABLE,
    Number,
    changeable,
    complete,
    doubles,
    high_precision,
)
from stickslip_verification.truth.stribeck import STRIBECK

COULOMB_NAME = "coulomb"  # the name of Coulomb's law
BUILT_IN = {COULOMB_NAME: COULOMB, "stribeck": STRIBECK}
"""The laws that come along, by name; any other name is a dotted one."""

_EXAMPLE = "'my_laws.stribeck:STRIBECK'"


def friction_law(name: str) -> FrictionLaw:
    """Return the truth's side of the friction law of a name.

    That is ``"coulomb"``, ``"stribeck"``, or ``"module:NAME"``: an object whose attribute ``truth``
    is in turn the dotted name of a `FrictionLaw`. `ValueError`, with the reason and an example, if
    the name is not of this form, a module or an attribute is missing, or the object is no
    `FrictionLaw`.
    """
    if name in BUILT_IN:
        return BUILT_IN[name]
    inner = getattr(_found(name), "truth", None)
    if not isinstance(inner, str):
        raise ValueError(
            f"the friction law {name!r} has no attribute 'truth' with the dotted name of "
            "the truth's side, such as 'my_laws.stribeck.truth:LAW'"
        )
    law = _found(inner)
    if not isinstance(law, FrictionLaw):
        raise ValueError(
            f"{inner!r} is a {type(law).__name__}; the truth's side of a friction law is an "
            "object of a subclass of stickslip_verification.truth.FrictionLaw"
        )
    return law


def _found(name: str) -> Any:
    module, colon, attribute = name.partition(":")
    if not (module and colon and attribute):
        known = ", ".join(map(repr, BUILT_IN))
        raise ValueError(f"{name!r} is no friction law: {known}, or module:NAME such as {_EXAMPLE}")
    try:
        return getattr(import_module(module), attribute)
    except Exception as error:  # whatever a module of somebody else raises
        raise ValueError(
            f"the friction law {name!r} was not found ({error}); expected module:NAME, such as "
            f"{_EXAMPLE}, of a module that Python can import"
        ) from None


@dataclass(frozen=True)
class Step:
    """One communication step; inputs and tunable parameters act from its start on."""

    h: float  # [s], > 0
    changes: Mapping[str, float] = field(default_factory=dict)  # by name [SI]


@dataclass(frozen=True)
class Run:
    """The exact course of a run, in high-precision numbers, SI.

    ``initial`` has every output at the start, after the rest test there, by name; ``samples`` at
    the end of each step, mode and n_slips being int and sticking bool, at ``times`` [s], start_time
    plus the exact sum of the steps. ``events`` are all transitions in order of time.

    ``margin`` says how near the run came to another course, relative, +inf if no number decided
    anything. It is the smallest of: | |k z + F_ext| - F_s | over |k z| + |F_ext| + F_s at each rest
    test (at the end of a slip: the distance from F_s on the far side, the only one in question),
    exact ties to within 2^-52 left out since the slack of the test decides them; and |x_dot| / (|v|
    + |x_dot - v|) at each least speed of a slip that was stopped at, or passed by, left out where
    structure decides (undamped from rest with nothing changed on the way, undamped or under-damped
    against the pull). With over-damping and v = 0 the second is instead the share of the slow part
    in the start of the slip. A marched slip measures its end as `March.decision` says. Times of
    events near the ends of steps are not in it.
    """

    initial: Mapping[str, Number]
    samples: tuple[Mapping[str, Number], ...]
    times: tuple[Number, ...]
    events: tuple[Event, ...]
    margin: Number


def run(
    parameters: Mapping[str, float],
    steps: Iterable[Step],
    *,
    digits: int | None = 50,
    start_time: float = 0.0,
    law: FrictionLaw | str = COULOMB,
) -> Run:
    """Return the exact course of the block through `steps`, docs/theory.md (1) to (6), (15), (16).

    `parameters` are m g k c mu_s mu_k v load F_ext x_start x_dot_start z_start and the friction
    law's own, SI, as the exact binary numbers they are; what is missing takes its start value. The
    results carry `digits` decimal digits. None computes in doubles: some twenty times as fast, for
    planning a run and for how far nearby runs lie apart, never for a verdict. `start_time` is in s;
    `law` is the friction law, or its name as `friction_law` takes it.

    `ValueError`, with the parameter, its value and its range, for an unknown name; NaN or infinity;
    m, g or k not positive; c, mu_s or mu_k negative; load below -m g; h not positive; a change of
    what is fixed. Also if the friction law is not found, or the mass slips faster than it holds.
    """
    context = doubles() if digits is None else high_precision(digits)
    law = friction_law(law) if isinstance(law, str) else law
    values = complete(parameters, law.parameters)
    law.check(values)
    may_change = CHANGEABLE | changeable(law.parameters)
    if not math.isfinite(start_time):
        raise ValueError(f"start_time = {start_time} is not a finite number")
    motion = Motion(context, values, start_time, law)
    initial = motion.outputs()
    samples: list[Mapping[str, Number]] = []
    times: list[Number] = []
    for step in steps:
        if not (math.isfinite(step.h) and step.h > 0.0):
            raise ValueError(f"h = {step.h} is outside h > 0")
        if step.changes:
            if fixed := sorted(set(step.changes) - may_change):
                names = ", ".join(fixed)
                raise ValueError(f"{names} cannot change in a run; {sorted(may_change)} can")
            values = complete({**values, **step.changes}, law.parameters)
            law.check(values)
            motion.change({name: values[name] for name in step.changes})
        motion.advance(step.h)
        samples.append(motion.outputs())
        times.append(motion.time)
    return Run(initial, tuple(samples), tuple(times), tuple(motion.events), motion.margin)
