"""Where stick-slip ends, for every friction law: stable sliding and cycles, over the velocity."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from ..critical import coulomb_limit
from ..dwell import critical_speed
from ..dwell import cycle_ranges as dwell_ranges
from ..laws import COULOMB, FrictionLaw, friction_law
from ..laws.coulomb import dwells
from ..parameters import Parameters
from ..ranges import CriticalVelocity, Interval
from ..trajectory import MeasuredCycle
from .memory import cycle_ranges as memory_ranges
from .memory import limit_cycle
from .memoryless import GRAZING, NONE, cycle_ranges
from .sliding import unstable_ranges

_BELOW, _ABOVE = 1e-3, 10.0
"""How far the range that is searched reaches beyond the velocities of the problem."""


def critical_velocity(
    p: Parameters,
    law: FrictionLaw | str = COULOMB,
    own: Mapping[str, float] | None = None,
    between: tuple[float | None, float | None] = (None, None),
) -> CriticalVelocity:
    """Return where stick-slip ends: docs/theory.md (14), (22), (29), (30).

    Parameters
    ----------
    p : Parameters
        Numbers only; ``v``, ``F_ext`` and the initial state are of no influence.
    law : FrictionLaw or str
        The friction law, or its name as `friction_law` takes it.
    own : mapping of str to float, optional
        Values of the friction law's own parameters, beside those in ``p.own``.
    between : tuple of two floats or None
        The range of pulling velocities searched [m/s], > 0. Where None is given it reaches from a
        thousandth of the least velocity of the problem to ten times the largest: knots and v_s of
        the friction, ``F_s / sqrt(k m)``, and the limit of Coulomb's law, with growth or without.

    Returns
    -------
    CriticalVelocity
        Under Coulomb's law with constant coefficients in closed form, at all velocities. Under
        friction with a memory, ``cycle`` is where the least velocity is below 1 % of the pull's,
        its ends to 1 %; it takes 2 to 20 s.

    Raises
    ------
    ValueError
        If the range is empty or not above 0, ``p`` has arrays, or the friction law has both a stick
        and a state of its own.
    RuntimeError
        If a slip cannot be followed: a damping ratio of some ten that a steep friction overcomes.
    """
    law = friction_law(law) if isinstance(law, str) else law
    if p.shape:
        raise ValueError("critical_velocity takes numbers, no arrays; coulomb_limit takes arrays")
    p = law.complete(p, {**p.own, **(own or {})})
    if law.sticks and law.state_start(p):
        raise ValueError("critical_velocity needs a friction law without state, or without a stick")
    closed = law is COULOMB and not dwells(p)
    usual = (0.0, math.inf) if closed else _velocities(p, law)
    low, high = (
        given if given is not None else default
        for given, default in zip(between, usual, strict=True)
    )
    if not (low > 0.0 or (closed and low == 0.0)) or not low < high:
        raise ValueError(
            f"the range of velocities is {low:g} to {high:g} m/s; it must rise and be > 0"
        )
    if closed:
        return _coulomb(p, (low, high))
    if reason := law.no_cycle(p):
        return CriticalVelocity((), (), (low, high), True, reason)
    if _force(p, law) == 0.0:
        return CriticalVelocity(unstable_ranges(p, law, (low, high)), (), (low, high), False)
    if law is COULOMB:
        return CriticalVelocity((), dwell_ranges(p, (low, high)), (low, high), False)
    unstable = unstable_ranges(p, law, (low, high))
    if not law.sticks:
        # A start from rest far below the upper end may lead to other swings.
        parts = (0.1, 0.5)
        speeds = [e.high * (e.low / e.high) ** part for e in reversed(unstable) for part in parts]
        # A range that is asked for may begin beyond all unstable sliding, among cycles.
        speeds += [low] if between[0] is not None else []
        cycles = memory_ranges(replace(p, F_ext=0.0).with_own(p.own), law, speeds, (low, high))
        return CriticalVelocity(unstable, cycles, (low, high), False)
    return CriticalVelocity(unstable, cycle_ranges(p, law, (low, high)), (low, high), False)


def memory_cycle(
    p: Parameters, law: FrictionLaw | str, own: Mapping[str, float] | None = None
) -> MeasuredCycle | None:
    """Return the steady cycle at ``p.v`` under friction with a memory; None: none was found.

    Parameters
    ----------
    p : Parameters
        Numbers only, ``v`` not 0; ``F_ext`` and the initial state are of no influence.
    law : FrictionLaw or str
        A friction law without a stick, or its name: lugre, rate_state.
    own : mapping of str to float, optional
        Values of the friction law's own parameters, beside those in ``p.own``.

    Raises
    ------
    ValueError
        If ``v`` is 0, the law has a stick, or no cycle exists at any velocity; the message says
        why.
    """
    law = friction_law(law) if isinstance(law, str) else law
    p = law.complete(p, {**p.own, **(own or {})})
    if p.shape or law.sticks or not p.v:
        raise ValueError("memory_cycle takes numbers, v not 0, and a friction law without a stick")
    if reason := law.no_cycle(p):
        raise ValueError(reason)
    found = limit_cycle(replace(p, v=abs(float(p.v)), F_ext=0.0).with_own(p.own), law)
    if found is None:
        return None
    cycle, s = found.cycle, math.copysign(1.0, float(p.v))
    signed = ("delta_x", "spring_drop", "x_dot_peak")
    return replace(cycle, **{name: s * abs(getattr(cycle, name)) for name in signed})


def _coulomb(p: Parameters, between: tuple[float, float]) -> CriticalVelocity:
    """Return the limit of Coulomb's law; sliding is stable, without damping neutrally."""
    low, high = between
    top = float(coulomb_limit(p))
    kind = GRAZING if top <= high and top < math.inf else NONE
    exists = Interval(low, min(top, high), NONE, kind)
    return CriticalVelocity((), (exists,) if top > low else (), between, True)


def _velocities(p: Parameters, law: FrictionLaw) -> tuple[float, float]:
    """Return the range of velocities in which something may happen [m/s]."""
    k, m, zeta = float(p.k), float(p.m), float(p.zeta)
    force = _force(p, law)
    scales = [*law.knots(p), *law.speeds(p)]
    if force > 0.0:
        scales.append(force / math.sqrt(k * m))
    if force > 0.0 and 0.0 < zeta < 1.0:
        scales.append(force / math.sqrt(4.0 * math.pi * zeta * k * m))
    if law is COULOMB and force > 0.0:
        scales += [top for top in [critical_speed(p)] if 0.0 < top < math.inf]
    return _BELOW * min(scales, default=1.0), _ABOVE * max(scales, default=1.0)


def _force(p: Parameters, law: FrictionLaw) -> float:
    """Return the break-away force [N]; one that is nothing at first, at the age of 1 s."""
    return law.break_away_force(p) or law.break_away_force(p, 1.0)
