"""Which sticks go on for ever: the attractors of the map from stick to stick; docs/theory.md (23).

Without reversals there is one stable cycle at most, that of `Family`. With them the map rises and
falls, and jumps where a slip reverses once more or does not end: several cycles, sequences of
several sticks, and irregular ones may exist side by side.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from ..parameters import Parameters
from .family import LEAST_STICK, Family
from .sticks import EPS, Floats, Sticks

FORCES, FOLLOWED = 256, 64
"""Forces of the scan, from what holds backward to what holds forward, equally spaced; and how many
of their sticks are followed."""

MOST_CYCLES = 200
"""Sticks after which a sequence that has not settled is irregular."""

MOST_STICKS = 16
"""Longest period of a regular sequence."""

_FEW = 8
"""Sequences of the scan that are followed to MOST_CYCLES, after a fifth of it."""

_SAME = 1e-7
"""Two sticks of one length, relative: where neighbours hardly come nearer, roundings add up."""

_REACHES = (0.1, 0.01, 1e-3, 1e-4, 1e-5, 1e-6)
"""How near to a cycle, relative, sticks are tried whether they come nearer."""


class Attractor(NamedTuple):
    """Sticks and slips that go on for ever.

    Attributes
    ----------
    t_stick : tuple of float
        The sticks of one period [s], the shortest first; of an irregular sequence the shortest and
        the longest that were seen.
    regular : bool
        Whether the sticks repeat.
    reverses : bool
        Whether a slip reverses.
    """

    t_stick: tuple[float, ...]
    regular: bool
    reverses: bool


class Attractors(NamedTuple):
    """What goes on at one pulling speed.

    Attributes
    ----------
    attractors : tuple of Attractor
        All that were found, the shortest sticks first.
    from_rest : Attractor or None
        The one that a start from rest with a relaxed spring leads to, after ``age_start`` at rest;
        None where it leads to sliding.
    resolution : float
        Distance of the spring forces at the begin of a stick, from -F_s to F_s of a fresh stick,
        from which was started [N]. 0 where nothing reverses: then nothing else exists.
    """

    attractors: tuple[Attractor, ...]
    from_rest: Attractor | None
    resolution: float


def dwell_attractors(p: Parameters) -> Attractors:
    """Return all sequences of sticks that go on for ever, as a scan finds them; theory (23).

    The scan has sticks of 256 ages over all that can occur. Where the next stick is the longer one
    at one age and the shorter one at the age beside, a cycle is solved for; every fourth stick is
    followed for up to 200 others. An attractor that draws in only ages between two of these may be
    missed; one of more than 16 sticks is called irregular, as is one that ends after more than 200.

    Parameters
    ----------
    p : Parameters
        Numbers only, with a static friction that grows at rest in ``own``; ``|v|`` counts.

    Raises
    ------
    ValueError
        If ``v`` is 0, or ``p`` has arrays.
    """
    if p.shape or p.v == 0.0:
        raise ValueError(f"v = {p.v!r} m/s is out of range; it must be a number other than 0")
    return Scan(p, abs(float(p.v))).result()


def last_break_away(p: Parameters) -> float:
    """Return the spring extension [m] from which a start from rest slips for ever.

    Parameters
    ----------
    p : Parameters
        As for `dwell_attractors`, whose ``from_rest`` is None.
    """
    scan = Scan(p, abs(float(p.v)))
    age = scan.first
    for _ in range(MOST_CYCLES):
        following = scan.sticks.next_stick(age, scan.v)
        if not scan.sticks.w * following > LEAST_STICK:
            break
        age = following
    return scan.sticks.kinetic + float(scan.sticks.excess(age))


class Scan:
    """The search for attractors of one block at the speed ``v`` [m/s]."""

    def __init__(self, p: Parameters, v: float) -> None:
        self.v, self.sticks = v, Sticks(p)
        self.family = Family(self.sticks)
        age = p.own.get("age_start", 0.0)
        self.first = age + float(self.sticks.stick(0.0, v, age))
        self.lambda_ = self._family_cycle()
        self.cycles: dict[float, float] = {}
        """How near to the sticks of each cycle, by their age, sticks come nearer [s]."""

    def result(self) -> Attractors:
        """Return the attractors."""
        holds = self.sticks.holds
        longest = float(self.sticks.stick(-holds, self.v))
        _, slips = self.sticks.follow(np.array([self.first, longest]), self.v)
        if not np.any(slips > 1):
            return self._monotonic()
        ages = self.sticks.ages(FORCES, self.v)
        self._solve(ages)
        ends = self._run(np.concatenate([[self.first], ages[:: FORCES // FOLLOWED]]))
        reached = {age: self._attractor(np.array([age])) for age in self.cycles}
        reached |= {age: self._repeated(age) for age in ends.values() if age not in reached}
        different: list[Attractor] = []
        for attractor in sorted(reached.values(), key=lambda attractor: attractor.regular):
            if not any(_same(attractor, known) for known in different):
                different.append(attractor)
        from_rest = None
        if 0 in ends:
            from_rest = next(known for known in different if _same(reached[ends[0]], known))
        spacing = 2.0 * holds * self.sticks.k / FORCES
        return Attractors(tuple(sorted(different)), from_rest, spacing)

    def _family_cycle(self) -> float | None:
        """Return lambda of the stable cycle without reversals."""
        lambda_ = self.family.at(self.v)
        if lambda_ is None or self.family.reverses(self.v, lambda_):
            return None
        short = self.sticks.w * self.family.t_stick(lambda_) < LEAST_STICK
        return None if short or math.isnan(self.family.slip(lambda_).length) else lambda_

    def _monotonic(self) -> Attractors:
        """Return the one cycle without reversals, which draws in all longer sticks."""
        if self.lambda_ is None:
            return Attractors((), None, 0.0)
        t = self.family.t_stick(self.lambda_)
        cycle = Attractor((t,), True, False)
        comes = self.first >= t or self.sticks.next_stick(self.first, self.v) > self.first
        return Attractors((cycle,), cycle if comes else None, 0.0)

    def _solve(self, ages: Floats) -> None:
        """Find the cycles between two ages of the scan, and the one of the family."""
        after, slips = self.sticks.follow(ages, self.v)
        longer = after - ages
        falls = (longer[:-1] > 0.0) & (longer[1:] <= 0.0)
        falls &= (slips[:-1] == slips[1:]) & (slips[:-1] > 1)
        found = [self._root(ages[n], ages[n + 1]) for n in np.flatnonzero(falls)]
        if self.lambda_ is not None:
            found.append(self.family.t_stick(self.lambda_))
        for age in found:
            self._add(age)

    def _root(self, low: float, high: float) -> float:
        def longer(age: float) -> float:
            return self.sticks.next_stick(age, self.v) - age

        return float(brentq(longer, low, high, xtol=1e-300, rtol=4.0 * EPS))

    def _add(self, age: float) -> None:
        """Add a cycle if sticks beside it come nearer to it."""
        for share in _REACHES:
            reach = share * age
            beside = np.array([age - reach, age, age + reach])
            after, slips = self.sticks.follow(beside, self.v)
            second, slips_after = self.sticks.follow(after, self.v)
            # Slips of one number are one branch of the map, which rises or falls all along: two
            # steps rise.
            if np.all(np.abs(second - age) < reach) and len({*slips, *slips_after}) == 1:
                self.cycles[age] = reach
                return

    def _run(self, ages: Floats) -> dict[int, float]:
        """Follow sticks until each has come to a cycle, slid on, or gone on for long.

        Return, by the number of the start, the age of the cycle or of the last stick.
        """
        ends: dict[int, float] = {}
        number, before = np.arange(ages.size), ages
        for count in range(MOST_CYCLES):
            ages = self.sticks.follow(ages, self.v)[0]
            on = self.sticks.w * ages > LEAST_STICK
            for age, reach in self.cycles.items():
                near = on & (np.abs(ages - age) <= reach)
                ends |= dict.fromkeys(number[near].tolist(), age)
                on &= ~near
            repeats = on & (np.abs(ages - before) <= _SAME * ages)
            if repeats.any():
                age = float(ages[repeats][0])
                alike = repeats & (np.abs(ages - age) <= _SAME * age)
                ends |= dict.fromkeys(number[alike].tolist(), age)
                on &= ~alike
            if count == MOST_CYCLES // 5:
                on &= np.cumsum(on) <= _FEW
            ages, number, before = ages[on], number[on], before[on]
            # A sequence of any period comes back to the one of these in which it has settled.
            if (count + 1).bit_count() == 1:
                before = ages
            if not ages.size:
                break
        return ends | dict(zip(number.tolist(), ages.tolist(), strict=True))

    def _repeated(self, age: float) -> Attractor:
        """Return what the sticks from this one on repeat."""
        tail = np.array([age] * (2 * MOST_STICKS))
        for n in range(1, tail.size):
            tail[n] = self.sticks.next_stick(tail[n - 1], self.v)
        for count in range(1, MOST_STICKS + 1):
            last = tail[-count:]
            if np.all(np.abs(last - tail[-2 * count : -count]) <= _SAME * last):
                return self._attractor(np.roll(last, -int(np.argmin(last))))
        return self._attractor(np.array([tail.min(), tail.max()]), regular=False)

    def _attractor(self, ages: Floats, regular: bool = True) -> Attractor:
        _, slips = self.sticks.follow(ages, self.v)
        return Attractor(tuple(ages.tolist()), regular, bool(np.any(slips > 1)))


def _same(a: Attractor, b: Attractor) -> bool:
    """Tell whether two attractors are one: irregular ones are if their sticks overlap.

    A regular sequence within an irregular one is that one in passing, unless it is a cycle.
    """
    if a.regular and b.regular:
        near = abs(a.t_stick[0] - b.t_stick[0]) <= 1e-6 * a.t_stick[0]
        return len(a.t_stick) == len(b.t_stick) and near
    overlap = min(a.t_stick) <= max(b.t_stick) and min(b.t_stick) <= max(a.t_stick)
    return overlap and len(a.t_stick) > 1 and len(b.t_stick) > 1
