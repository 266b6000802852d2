"""A judge of blocks that shares nothing with the code it judges: what the native FMU does for long.

Each block is started 20 times and run until what happens repeats. The outputs of the FMU say what
it is: its cycle meter at break-aways, its velocity in between. All 1,000 cost 8 CPU minutes.
"""

from __future__ import annotations

import math
from collections import deque, namedtuple
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from tests.conftest import built
from tests.driver import Instance, loaded
from tests.judge.block_draws import Setting, starts

ROUNDS = 12
"""Looks at a motion; between them 8, 16, 32 ... periods, 16,000 before the last."""
STICKS = 16
"""Break-aways in one look: a motion of up to 8 sticks is seen to repeat."""
SAME = 1e-6
"""Difference of two periods of one motion, relative."""
LEAST_STICK = 1e-9
"""A shorter stick, as a part of the period, only touches rest."""
EVEN = 1e-5
"""A swing by less than this part of the pull has died away."""
LASTS = 64
"""A swing that keeps its size over so many periods, to SAME per period, lasts."""


@dataclass(frozen=True)
class Seen:
    """What a motion settled to: "unsettled" where nothing repeated up to the last look.

    A swing without stick has an amplitude, half the range of the velocity over the pull, and a
    frequency [Hz]; sticks and slips have a jump from stick to stick [m], a period [s], a mean
    length of stick [s], and a number of sticks after which they repeat, 0 where they never do.
    """

    kind: Literal["even", "swings", "sticks", "unsettled"]
    amplitude: float = math.nan
    frequency: float = math.nan
    jump: float = math.nan
    period: float = math.nan
    t_stick: float = math.nan
    reverses: bool = False
    sticks: int = 0

    def like(self, other: Seen) -> bool:
        if (self.kind, self.sticks) != (other.kind, other.sticks):
            return False
        if self.kind == "swings":
            return abs(self.amplitude - other.amplitude) < 1e-3 * self.amplitude
        return self.kind != "sticks" or not self.sticks or _near(self.period, other.period, 1e-4)


def judged(drawn: Setting) -> list[tuple[Seen, int]]:
    ends = [seen(drawn, start) for start in starts(drawn)]
    different: list[Seen] = []
    for end in ends:
        if not any(end.like(motion) for motion in different):
            different.append(end)
    return [(motion, sum(end.like(motion) for end in ends)) for motion in different]


def seen(drawn: Setting, start: dict[str, float]) -> Seen:
    instance = loaded(built("native-2", drawn.law)).started(**drawn.values, **start)
    try:
        return _Watch(instance, drawn).settled()
    finally:
        instance.free()


_Sample = namedtuple("_Sample", "F F_s T t_stick t_event t_slip mode n_slips")


class _Watch:
    def __init__(self, instance: Instance, drawn: Setting) -> None:
        self.instance, self.v, self.k = instance, drawn.values["v"], drawn.values["k"]
        self.period = 2.0 * math.pi / drawn.w
        self.events: deque[float] = deque(maxlen=8)

    def settled(self) -> Seen:
        before, wait, irregular = Seen("unsettled"), 8, 0
        for _ in range(ROUNDS):
            now = self._look()
            irregular += now.kind == "sticks" and not now.sticks
            lasts = now.kind == "swings" == before.kind and wait > LASTS
            if lasts and _near(now.amplitude, before.amplitude, SAME * wait / 2):
                return now
            repeats = now.sticks and now.like(before) and _near(now.period, before.period, SAME)
            if repeats or now.kind == "even":
                return now
            self.instance.step(wait * (now.period if now.kind == "sticks" else self.period))
            before, wait = now, 2 * wait
        return replace(before, sticks=0) if irregular > ROUNDS / 2 else Seen("unsettled")

    def _look(self) -> Seen:
        self.now, slipping = self._sample(), 0
        broken: list[_Sample] = []
        while len(broken) <= STICKS and slipping < 50:
            if self._breaks_away():
                broken.append(self.now)
                slipping = 0
            slipping += self.now.mode != 0
        rested = [sample for sample in broken if sample.t_stick > LEAST_STICK * sample.T]
        return _sticks(rested, self.v) if len(rested) > STICKS else self._swing()

    def _sample(self) -> _Sample:
        return _Sample(*self.instance.get(*_Sample._fields))

    def _breaks_away(self) -> bool:
        before, h = self.now, self.period / 4.0
        if before.mode == 0:
            # What holds never falls while the mass rests.
            h = max(h, 0.999 * (before.F_s - before.F) / (self.k * self.v))
        self.instance.step(h)
        self.now = now = self._sample()
        if now.mode <= 0 or now.t_event == before.t_event:
            return False
        # A slip along the pull has begun: after a stick, or after a slip against the pull.
        apart = [now.t_event - event - now.T for event in self.events]
        self.events.append(now.t_event)
        if before.mode == 0 or (now.T, now.t_stick) != (before.T, before.t_stick):
            return True
        # A stick shorter than the step and as long as the last: a period after another event.
        slack = 1e-9 * (now.T + 1e-6 * now.t_event)
        return now.T > 0.0 and any(abs(gap) < slack for gap in apart)

    def _swing(self) -> Seen:
        h, u = self.period / 48.0, []
        for _ in range(192):
            self.instance.step(h)
            u.append(self.instance.get("x_dot")[0] / self.v - 1.0)
        rises, low, high = [], min(u), max(u)
        for n, (before, now, after) in enumerate(zip(u, u[1:], u[2:], strict=False)):
            bend = before - 2.0 * now + after
            if (now - before) * (after - now) <= 0.0 and bend:
                top = now - 0.125 * (after - before) ** 2 / bend
                low, high = min(low, top), max(high, top)
            if now < 0.0 <= after:
                rises.append(n + now / (now - after))
        amplitude = 0.5 * (high - low)
        frequency = (len(rises) - 1) / (h * (rises[-1] - rises[0])) if rises[1:] else math.nan
        swings = Seen("swings", amplitude, frequency, reverses=low < -1.0)
        return Seen("even") if amplitude < EVEN else swings


def _sticks(broken: Sequence[_Sample], v: float) -> Seen:
    def same(a: _Sample, b: _Sample) -> bool:
        return _near(a.T, b.T, SAME) and _near(a.t_stick, b.t_stick, SAME)

    most = STICKS // 2
    counts = (n for n in range(1, most + 1) if all(map(same, broken[-n:], broken[-2 * n : -n])))
    repeats = next(counts, 0)
    n = repeats or most
    period = sum(sample.T for sample in broken[-n:]) / n
    t_stick = sum(sample.t_stick for sample in broken[-n:]) / n
    reverses = broken[-1].n_slips - broken[-1 - n].n_slips > n
    return Seen("sticks", math.nan, math.nan, v * period, period, t_stick, reverses, repeats)


def _near(a: float, b: float, share: float) -> bool:
    return abs(a - b) <= share * abs(a)
