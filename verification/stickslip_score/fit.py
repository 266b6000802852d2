"""Whether a curve lies on the law of the block, with which gap, and how surely."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from stickslip_score.curve import Floats
from stickslip_score.law import Law

ON_THE_LAW = 1.25
"""Excess up to which a curve lies on the law: its digits once, and once more because the least
squares share them out."""

_ENOUGH = 3000
"""Samples that the search looks at; the result is checked on all of them."""

_STEPS = 60
_FEW = 150
_FROM_EACH = 16
"""Samples up to which the search starts anew from so many places."""

_SEEDS = 41
_MOST_SEEDS = 4000
_WIDE = 0.6
"""Radians of the oscillation between two places to search from: within it the search finds its way
by itself, as long as some samples are in slips."""
_FINE = 0.02
"""The same where a single sample at the very beginning or end of a slip may be all there is."""


@dataclass(frozen=True)
class Fit:
    """The law that comes nearest to a curve.

    Attributes
    ----------
    law
        With the free numbers as found.
    t_break
        First break-away [s].
    offset
        Position of the mass before it [m].
    excess
        Largest distance of a sample from the law, in units of what its digits allow: up to 1 the
        curve lies on the law.
    worst
        The same in metres.
    spread
        How far each free number may be off for the digits of the samples, by name: t_break [s],
        D [m], w [rad/s].
    """

    law: Law
    t_break: float
    offset: float
    excess: float
    worst: float
    spread: dict[str, float]


def fit(
    t: Floats,
    y: Floats,
    allowed: Floats,
    law: Law,
    window: tuple[float, float],
    free: Sequence[str],
) -> Fit:
    """Fit break-away, offset and the numbers of `law` named in `free` by least squares.

    Parameters
    ----------
    t, y
        Samples from about the first break-away on [s, m], shape (n,).
    allowed
        How far each may be from the truth for its digits [m], shape (n,), > 0.
    law
        Where the search starts.
    window
        Times between which the first break-away is [s].
    free
        Of D, w.
    """
    stride = -(-t.size // _ENOUGH)
    some = (t[::stride], y[::stride], allowed[::stride])
    found: Fit | None = None
    for begin in _starts(*some[:2], law, window, fine=not free and t.size <= _FEW):
        numbers = {"t_break": begin, **{name: float(getattr(law, name)) for name in free}}
        numbers = _gauss_newton(*some, law, numbers, _STEPS)
        tried = _account(*some, law, numbers)
        if found is None or tried.excess < found.excess:
            found, best = tried, numbers
        if found.excess <= ON_THE_LAW:
            break
    assert found is not None
    if stride == 1 or found.excess > ON_THE_LAW:
        return found
    return _account(t, y, allowed, law, _gauss_newton(t, y, allowed, law, best, 3))


def _applied(law: Law, numbers: dict[str, float]) -> Law:
    return replace(law, D=numbers.get("D", law.D), w=numbers.get("w", law.w))


def _residual(t: Floats, y: Floats, law: Law, numbers: dict[str, float]) -> Floats:
    r = y - _applied(law, numbers).position(t - numbers["t_break"])
    return np.asarray(r - np.mean(r))


def _starts(t: Floats, y: Floats, law: Law, window: tuple[float, float], fine: bool) -> list[float]:
    """Return the break-aways from which to search, the most promising first.

    Few samples that mostly rest tell a break-away by those in a slip alone, and the search does
    not find its way from one of them to another.
    """
    apart = _FINE if fine else _WIDE
    count = max(_SEEDS, math.ceil((window[1] - window[0]) * law.w / apart))
    candidates = np.linspace(*window, min(count, _MOST_SEEDS))
    cost = np.array(
        [np.sum(_residual(t, y, law, {"t_break": float(begin)}) ** 2) for begin in candidates]
    )
    beside = np.concatenate([[np.inf], cost, [np.inf]])
    valleys = np.flatnonzero((cost < beside[:-2]) & (cost <= beside[2:]))
    best = valleys[np.argsort(cost[valleys], kind="stable")]
    return [float(begin) for begin in candidates[best[: _FROM_EACH if t.size <= _FEW else 1]]]


def _derivatives(
    t: Floats, y: Floats, law: Law, numbers: dict[str, float]
) -> tuple[Floats, Floats]:
    """Return the residual and its derivatives, shape (n, number of free numbers)."""
    r = _residual(t, y, law, numbers)
    columns = []
    for name in numbers:
        step = _step(name, law)
        up = _residual(t, y, law, {**numbers, name: numbers[name] + step})
        down = _residual(t, y, law, {**numbers, name: numbers[name] - step})
        columns.append((up - down) / (2.0 * step))
    return r, np.stack(columns, axis=1)


def _step(name: str, law: Law) -> float:
    """Return a step for a derivative: small against the number, large against rounding."""
    return {
        "t_break": 1e-6 / law.w,
        "D": 1e-6 * (abs(law.D) + law.v / law.w),
        "w": 1e-7 * law.w,
    }[name]


def _gauss_newton(
    t: Floats, y: Floats, allowed: Floats, law: Law, numbers: dict[str, float], steps: int
) -> dict[str, float]:
    """Levenberg's damped least squares; stops when a step no longer moves the curve."""
    names = list(numbers)
    damping = 1e-3
    r, J = _derivatives(t, y, law, numbers)
    cost = float(r @ r)
    for _ in range(steps):
        scale = np.sqrt(np.sum(J * J, axis=0)) + 1e-300
        normal = (J / scale).T @ (J / scale)
        for _attempt in range(8):
            move = (
                -np.linalg.solve(normal + damping * np.eye(len(names)), (J / scale).T @ r) / scale
            )
            tried = {name: numbers[name] + float(d) for name, d in zip(names, move, strict=True)}
            if _sensible(tried, law):
                tried_r = _residual(t, y, law, tried)
                tried_cost = float(tried_r @ tried_r)
                if tried_cost <= cost:
                    break
            damping = min(damping * 10.0, 1e6)
        else:
            return numbers
        moved = float(np.max(np.abs(J @ move))) * (1.0 + damping)
        small = moved < 1e-3 * float(np.min(allowed))
        numbers, cost, damping = tried, tried_cost, max(damping * 0.1, 1e-12)
        if small:
            return numbers
        r, J = _derivatives(t, y, law, numbers)
    return numbers


def _sensible(numbers: dict[str, float], law: Law) -> bool:
    # Static friction is not the smaller one; a slip from mu_s = mu_k begins at minus the drag.
    least = -2.0 * law.zeta * law.v / law.w * (1.0 + 1e-12)
    return numbers.get("D", 0.0) >= least and 0.2 < numbers.get("w", law.w) / law.w < 5.0


def _account(t: Floats, y: Floats, allowed: Floats, law: Law, numbers: dict[str, float]) -> Fit:
    r, J = _derivatives(t, y, law, numbers)
    r = r - 0.5 * (np.max(r) + np.min(r))
    found = _applied(law, numbers)
    position = found.position(t - numbers["t_break"])
    # Least squares is linear in the samples: each moves the result by its row of the inverse.
    with np.errstate(all="ignore"):
        inverse = np.linalg.pinv(J)
    reach = np.abs(inverse) @ allowed
    # Samples that all rest say of a break-away only between which two it is.
    unseen = np.max(np.abs(J), axis=0) * float(np.max(np.diff(t))) < allowed[0]
    if unseen[0]:
        reach[0] = float(np.max(np.diff(t)))
    return Fit(
        law=found,
        t_break=numbers["t_break"],
        offset=float(np.mean(y - position)),
        excess=float(np.max(np.abs(r) / allowed)),
        worst=float(np.max(np.abs(r))),
        spread={name: float(d) for name, d in zip(numbers, reach, strict=True)},
    )


def reach(law: Law, spread: float, quantity: str) -> float:
    """Return how far a quantity of the cycle moves when D moves by `spread` either way."""
    middle = law.quantities()[quantity]
    moved = [law.with_gap(max(law.D + d, 0.0)).quantities()[quantity] for d in (-spread, spread)]
    return max((abs(value - middle) for value in moved if not math.isnan(value)), default=math.nan)
