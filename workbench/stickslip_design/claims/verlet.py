"""Stick-slip as a script marches it: velocity Verlet with a fixed step, events seen at step ends.

This is the method that a claim is about, not a truth. Only sums, products and one comparison enter,
so its numbers are the same on every machine.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Marched:
    """What a script reads off its run; times are those of step ends.

    Attributes
    ----------
    break_away
        Time of the first break-away [s], shape (blocks,).
    T, t_slip, t_stick, delta_x
        Period between two break-aways, lengths of the slip and of the stick between them [s], and
        the jump of the slip [m], shape (blocks, cycles); NaN where the run did not come so far.
    skipped
        How many sticks had no length: at the end of the step in which the mass stopped, the spring
        was beyond break-away already; shape (blocks,).
    """

    break_away: Array
    T: Array
    t_slip: Array
    t_stick: Array
    delta_x: Array
    skipped: npt.NDArray[np.int64]


class _Log:
    """Times and places of the transitions, by block and number."""

    def __init__(self, blocks: int, cycles: int) -> None:
        self.starts = np.full((blocks, cycles + 1), np.nan)
        self.ends = np.full((blocks, cycles + 1), np.nan)
        self.start_x = np.full((blocks, cycles + 1), np.nan)
        self.end_x = np.full((blocks, cycles + 1), np.nan)
        self.skipped = np.zeros(blocks, dtype=np.int64)
        self.count = np.zeros(blocks, dtype=np.int64)


def march(
    k: Array, v: Array, *, h: float, block: Mapping[str, float], cycles: int, longest: Array
) -> Marched:
    """March blocks from a relaxed spring at rest until each has shown its cycles.

    A step moves the pulled end by ``v h``. A mass in slip goes on by
    ``x += x_dot h + a h^2/2``, the acceleration is taken anew from the spring, and
    ``x_dot += (a + a_new) h/2``. Then, at the end of the step: a velocity that has reached zero or
    changed its sign is set to zero, and a mass at rest sticks if ``|k z| <= mu_s m g``, else slips
    in the direction of ``k z``.

    Parameters
    ----------
    k, v
        Stiffness [N/m] and pulling velocity [m/s] > 0 of each block, shape (blocks,).
    h
        The step [s].
    block
        m [kg], g [m/s2], mu_s and mu_k [1], the same for all.
    cycles
        How many cycles are looked at, from the first break-away on.
    longest
        Time after which a block is given up [s], shape (blocks,).
    """
    m = block["m"]
    F_s, F_k = (block[name] * m * block["g"] for name in ("mu_s", "mu_k"))
    log = _Log(k.size, cycles)
    which = np.arange(k.size)
    x, x_dot, a, s = (np.zeros(k.size) for _ in range(4))
    step = 0
    while which.size:
        step += 1
        t = step * h
        x += (x_dot + 0.5 * h * a) * h
        force = k * (v * t - x)
        new_a = np.where(s == 0.0, 0.0, (force - s * F_k) / m)
        x_dot += 0.5 * h * (a + new_a)
        a = new_a
        stops = s * x_dot <= 0.0
        ends = stops & (s != 0.0)
        breaks = stops & (np.abs(force) > F_s)
        if ends.any():
            at = which[ends]
            log.ends[at, log.count[at] - 1] = t
            log.end_x[at, log.count[at] - 1] = x[ends]
            log.skipped[which[ends & breaks]] += 1
            x_dot[stops], a[stops], s[stops] = 0.0, 0.0, 0.0
        if breaks.any():
            s[breaks] = np.sign(force[breaks])
            a[breaks] = (force[breaks] - s[breaks] * F_k) / m
            at = which[breaks]
            log.starts[at, log.count[at]] = t
            log.start_x[at, log.count[at]] = x[breaks]
            log.count[at] += 1
        if breaks.any() or step % 1000 == 0:
            keep = (log.count[which] <= cycles) & (t < longest[which])
            if not keep.all():
                which, k, v = which[keep], k[keep], v[keep]
                x, x_dot, a, s = x[keep], x_dot[keep], a[keep], s[keep]
    starts, ends, starts_x, ends_x = log.starts, log.ends, log.start_x, log.end_x
    return Marched(
        break_away=starts[:, 0],
        T=starts[:, 1:] - starts[:, :-1],
        t_slip=(ends - starts)[:, :-1],
        t_stick=starts[:, 1:] - ends[:, :-1],
        delta_x=(ends_x - starts_x)[:, :-1],
        skipped=log.skipped,
    )
