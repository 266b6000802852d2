"""What a curve's own cycles come to, with the resolution that its samples allow."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from stickslip_score.fit import Fit
from stickslip_score.law import Law
from stickslip_score.phases import Event, Stick

QUANTITIES = ("period", "t_stick", "t_slip", "delta_x")

_DEVIATIONS = 3.0
"""Standard deviations within which a figure read off the law is said to be."""


@dataclass(frozen=True)
class Measured:
    """Figures of a curve.

    Attributes
    ----------
    values
        (got, resolution) by name: period, t_stick, t_slip [s], delta_x [m], each positive.
        What the curve does not show is missing.
    cycles
        Complete cycles, from break-away to break-away.
    jumps
        Each jump of the mass between two rests [m], in order; empty where read off the law.
    """

    values: dict[str, tuple[float, float]]
    cycles: int
    jumps: tuple[float, ...] = ()


def from_fit(fit: Fit, end: float, noisy: bool) -> Measured:
    """Read the figures off the law on which all samples lie.

    Parameters
    ----------
    fit
        A fit with D free, and w where it is, on whose law the curve lies.
    end
        Time of the last sample [s]: only cycles and slips that it saw to their end count.
    noisy
        Whether the samples have noise besides their digits.

    Notes
    -----
    The resolution carries the digits of the samples through the least squares, twice: the sum
    that bounds it is linear in D, and a sample may be off by as much as the fit was allowed. With
    noise it carries `_DEVIATIONS` standard deviations of the free numbers besides.
    """
    law = fit.law
    values = law.quantities()
    if math.isnan(values["period"]):
        return Measured({}, 0)
    since = end - fit.t_break
    cycles = max(0, math.floor(since / values["period"] * (1.0 + 1e-12)))
    shown = [
        *(("period", "t_stick") if cycles else ()),
        *(("t_slip", "delta_x") if since >= values["t_slip"] else ()),
    ]
    free = [name for name in fit.spread if name != "t_break"]
    moves = [{name: 2.0 * fit.spread[name]} for name in free]
    by_noise = _independent(fit, free) if noisy else []
    # Digits of the double-precision arithmetic of the fit itself.
    floor = 1e-12
    return Measured(
        {
            name: (
                values[name],
                sum(_reach(law, move, name) for move in moves)
                + math.hypot(*(_reach(law, move, name) for move in by_noise))
                + floor * values["period" if name != "delta_x" else "delta_x"],
            )
            for name in shown
        },
        cycles,
    )


def _independent(fit: Fit, free: Sequence[str]) -> list[dict[str, float]]:
    """Return moves of the free numbers that noise makes independently of each other."""
    at = [list(fit.spread).index(name) for name in free]
    sizes, axes = np.linalg.eigh(fit.covariance[np.ix_(at, at)])
    columns = (axes * (_DEVIATIONS * np.sqrt(np.maximum(sizes, 0.0)))).T
    return [dict(zip(free, column.tolist(), strict=True)) for column in columns]


def _reach(law: Law, move: Mapping[str, float], quantity: str) -> float:
    """Return how far a quantity of the cycle goes when numbers of the law move either way."""
    middle = law.quantities()[quantity]
    moved = []
    for sign in (-1.0, 1.0):
        numbers = {name: getattr(law, name) + sign * by for name, by in move.items()}
        moved.append(replace(law, **{**numbers, "D": max(numbers.get("D", law.D), 0.0)}))
    shown = [each.quantities()[quantity] for each in moved if each.w > 0.0]
    return max((abs(value - middle) for value in shown if not math.isnan(value)), default=math.nan)


def from_sticks(sticks: Sequence[Stick], allowed: float) -> Measured:
    """Take means over the cycles between sticks that can be told, from the bounds of their events.

    Parameters
    ----------
    sticks
        In order of time.
    allowed
        How far a position may be off for its digits [m].
    """
    told = [stick if stick.rests or stick.creep is not None else None for stick in sticks]
    slips = [(a, b) for a, b in pairwise(told) if a and b and a.end and b.begin]
    cycles = [(a, b) for a, b in slips if b.end]
    jumps = tuple(b.level - a.level for a, b in slips)
    values: dict[str, tuple[float, float]] = {}
    if cycles:
        values["period"] = _mean_period(told)
        values["t_stick"] = _mean(_between(b.begin, b.end) for _, b in cycles)
    if slips:
        values["t_slip"] = _mean(_between(a.end, b.begin) for a, b in slips)
        values["delta_x"] = (sum(jumps) / len(jumps), _jump_resolution(slips, allowed))
    return Measured(values, len(cycles), jumps)


def _between(begin: Event | None, end: Event | None) -> tuple[float, float]:
    """Return the middle and half the width of what lies between two events; never below 0."""
    assert begin is not None
    assert end is not None
    least, most = max(end.low - begin.high, 0.0), max(end.high - begin.low, 0.0)
    return 0.5 * (least + most), 0.5 * (most - least)


def _mean(bounds: Iterable[tuple[float, float]]) -> tuple[float, float]:
    every = list(bounds)
    return (
        sum(middle for middle, _ in every) / len(every),
        sum(half for _, half in every) / len(every),
    )


def _mean_period(told: Sequence[Stick | None]) -> tuple[float, float]:
    """Return the mean period: the events inside an unbroken chain of cycles cancel."""
    total = half = 0.0
    count = 0
    chain: list[Event] = []
    for stick in [*told, None]:
        if stick is not None and stick.end is not None:
            chain.append(stick.end)
            continue
        if len(chain) > 1:
            middle, width = _between(chain[0], chain[-1])
            total, half, count = total + middle, half + width, count + len(chain) - 1
        chain = []
    return total / count, half / count


def _jump_resolution(slips: Sequence[tuple[Stick, Stick]], allowed: float) -> float:
    """Return how far a jump may be off: a creeping mass has no level but within half its creep."""
    total = 0.0
    for a, b in slips:
        total += 2.0 * allowed
        for stick in (a, b):
            if not stick.rests and stick.begin and stick.end and stick.creep:
                total += 0.25 * abs(stick.creep) * (stick.end.low - stick.begin.high)
    return total / len(slips)
