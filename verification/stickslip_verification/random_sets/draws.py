"""The random sets: steady cycles, damped cycles, input sequences, step splittings.

Every set is made by a `random.Random` that the caller seeds, so a seed names a set for ever.
All values SI.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from random import Random

GRAVITY = 9.81
SHORTEST_STEP = 1e-13
"""[s]; importers hand over such steps when rounding leaves them a last crumb of an interval."""

Values = Mapping[str, float]


@dataclass(frozen=True)
class Interval:
    """A time `h` [s] during which nothing changes, and the values set at its start."""

    h: float
    changes: Values


@dataclass(frozen=True)
class Sequence:
    """A motion under inputs that change: values at the start, then interval after interval."""

    parameters: Values
    intervals: tuple[Interval, ...]


def log_uniform(draw: Random, lowest: float, highest: float) -> float:
    """Draw between two positive bounds, each decade alike."""
    return math.exp(draw.uniform(math.log(lowest), math.log(highest)))


def oscillator(draw: Random) -> dict[str, float]:
    """Draw k 10..1e8 N/m, m 1e-2..1e4 kg, mu_s 0.01..1.5 and the gap 1e-3..1 of mu_s."""
    mu_s = log_uniform(draw, 0.01, 1.5)
    return {
        "k": log_uniform(draw, 10.0, 1e8),
        "m": log_uniform(draw, 1e-2, 1e4),
        "g": GRAVITY,
        "mu_s": mu_s,
        "mu_k": mu_s * (1.0 - log_uniform(draw, 1e-3, 1.0)),
    }


def w_of(p: Values) -> float:
    """Angular frequency sqrt(k/m) [rad/s], for choosing magnitudes only."""
    return math.sqrt(p["k"] / p["m"])


def gap_of(p: Values) -> float:
    """Delta = (mu_s - mu_k) m g/k [m], for choosing magnitudes only."""
    return (p["mu_s"] - p["mu_k"]) * p["m"] * p["g"] / p["k"]


def steady_cycle(draw: Random) -> dict[str, float]:
    """Draw an undamped cycle with v 1e-6..10 m/s, starting half a stick before break-away."""
    return _near_break_away({**oscillator(draw), "v": log_uniform(draw, 1e-6, 10.0)})


def shallow_cycle(draw: Random) -> dict[str, float]:
    """Draw an undamped cycle with lambda 1e-3..1e-1, where the re-stick nearly grazes."""
    p = oscillator(draw)
    p["v"] = w_of(p) * gap_of(p) / log_uniform(draw, 1e-3, 1e-1)
    return _near_break_away(p)


def damped_oscillator(draw: Random) -> tuple[dict[str, float], float]:
    """Draw an oscillator with zeta 1e-4..3; the second value is that zeta."""
    p = oscillator(draw)
    zeta = log_uniform(draw, 1e-4, 3.0)
    p["c"] = 2.0 * zeta * math.sqrt(p["k"] * p["m"])
    return p, zeta


def with_lambda(p: Values, lambda_: float) -> dict[str, float]:
    """Return the same oscillator pulled at the speed that makes lambda, near break-away."""
    return _near_break_away({**p, "v": w_of(p) * gap_of(p) / lambda_})


def signed_distance(draw: Random) -> float:
    """Draw d = lambda/lambda_c - 1 with magnitude 1e-9..1 (0.9 below), either sign."""
    size = log_uniform(draw, 2e-9, 0.9)
    return size if draw.random() < 0.5 else -size


def sequence(draw: Random, *, tunable: bool) -> Sequence:
    """Draw a motion of 3 to 8 intervals with v, load and F_ext changing, of either sign.

    Half of them are damped. Most start within a stick of breaking away, some relaxed, moving, or
    beyond the break-away force; the changes are of the size of the gap of the forces, where they
    decide most, or as large as the forces themselves. With `tunable` the parameters k, c, mu_s
    and mu_k change as well.
    """
    p = oscillator(draw)
    w = w_of(p)
    lambda_ = log_uniform(draw, 1e-5, 1e3)
    speed = w * gap_of(p) / lambda_
    period = 2.0 * (math.pi + lambda_) / w
    weight = p["m"] * p["g"]
    reach = p["mu_s"] * weight / p["k"]
    way = draw.choice((1.0, -1.0))
    near = way * (reach - 2.0 * gap_of(p) * draw.random())
    if draw.random() < 0.5:
        p["c"] = 2.0 * log_uniform(draw, 1e-3, 2.0) * math.sqrt(p["k"] * p["m"])
    p["v"] = speed * way
    p["z_start"] = draw.choice((near, near, near, near, 0.0, reach * draw.uniform(-1.3, 1.3)))
    p["x_start"] = reach * draw.choice((0.0, draw.uniform(-1.0, 1.0)))
    p["x_dot_start"] = speed * draw.choice((0.0, 0.0, draw.uniform(-3.0, 3.0)))
    gap = (p["mu_s"] - p["mu_k"]) / p["mu_s"]
    intervals = []
    for n in range(draw.randint(3, 8)):
        changes: dict[str, float] = {}
        if n:
            kind = draw.choice(("v", "load", "F_ext", "all", "nothing"))
            size = draw.choice((gap, gap, 1.0))
            if kind in ("v", "all"):
                ahead = way * draw.uniform(0.2, 3.0)
                changes["v"] = speed * draw.choice((0.0, ahead, ahead, draw.uniform(-3.0, 3.0)))
            if kind in ("load", "all"):
                changes["load"] = weight * draw.choice((0.0, size * draw.uniform(-0.8, 2.0)))
            if kind in ("F_ext", "all"):
                push = p["mu_s"] * weight * size * draw.uniform(-1.5, 1.5)
                changes["F_ext"] = draw.choice((0.0, push))
            if tunable:
                changes |= _tuning(draw, p)
        intervals.append(Interval(period * log_uniform(draw, 0.05, 5.0), changes))
    return Sequence(p, tuple(intervals))


def split(draw: Random, h: float, pieces: int | None = None) -> list[float]:
    """Cut `h` into uneven steps whose exact sum is `h`, the shortest about 1e-13 s.

    The cuts lie on multiples of the last place of `h`, so that every step is a double and no
    rounding is hidden in the cutting. With `pieces`, about that many; else each length is drawn
    log-uniformly and there are a few dozen.
    """
    unit = math.ulp(h)
    whole = round(h / unit)
    least = max(1, math.ceil(SHORTEST_STEP / unit))
    if pieces is not None:
        cuts = sorted({draw.randrange(1, whole) for _ in range(pieces - 1)})
        return [(b - a) * unit for a, b in zip([0, *cuts], [*cuts, whole], strict=True)]
    steps = []
    left = whole
    while left:
        size = min(left, max(1, round(log_uniform(draw, least, max(whole, least + 1)))))
        steps.append(size * unit)
        left -= size
    draw.shuffle(steps)
    return steps


def uneven_steps(draw: Random, shortest: float, longest: float, duration: float) -> list[float]:
    """Draw steps log-uniformly until their sum reaches `duration` [s]."""
    steps: list[float] = []
    elapsed = 0.0
    while elapsed < duration:
        steps.append(log_uniform(draw, shortest, longest))
        elapsed += steps[-1]
    return steps


def _near_break_away(p: dict[str, float]) -> dict[str, float]:
    midway = 0.5 * (p["mu_s"] + p["mu_k"])
    return {**p, "z_start": midway * p["m"] * p["g"] / p["k"]}


def _tuning(draw: Random, p: Values) -> dict[str, float]:
    changes = {}
    if draw.random() < 0.4:
        changes["k"] = p["k"] * draw.uniform(0.5, 2.0)
    if draw.random() < 0.3:
        changes["c"] = 2.0 * draw.uniform(0.0, 0.5) * math.sqrt(p["k"] * p["m"])
    if draw.random() < 0.3:
        changes["mu_s"] = p["mu_s"] * draw.uniform(1.0, 1.5)
    if draw.random() < 0.3:
        changes["mu_k"] = p["mu_k"] * draw.uniform(0.3, 1.0)
    return changes
