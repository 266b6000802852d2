"""Changed and random axes, and the last jump of the whole loop as the feed rises."""

import math
import random
from typing import Any

import numpy as np

from examples.feed_axis.axis import Axis, critically_damped
from examples.feed_axis.designed import designed
from examples.feed_axis.monolithic import solve
from stickslip_design.loop.stability import is_stable

EXACT = {"resolution_motor": 0.0, "resolution_table": 0.0}


def velocity_loop(omega_v: float) -> dict[str, Any]:
    """Return the changes that make a velocity loop of this bandwidth [rad/s]."""
    return {"omega_v": omega_v, "T_n": critically_damped(omega_v)}


def last_jump(axis: Axis, limit: float, duration: float, share: float) -> float:
    """Return the feed [m/s] at the last jump of the whole loop solved as one.

    Parameters
    ----------
    axis
        The axis.
    limit
        The feed [m/s] about which the feed rises.
    duration
        How long it rises [s].
    share
        It rises from 1 - share to 1 + share, relative to the limit. Up to there it comes from a
        tenth of the limit, since from rest a higher feed may be reached without a jump.
    """
    low, high = (1.0 - share) * limit, (1.0 + share) * limit
    slow = 0.1 * limit
    # The spring is loaded, and the table jumps twice.
    began = 3.0 * axis.F_s / (axis.k * slow)
    reached = began + 0.4 * duration
    course = [(0.0, 0.0), (0.1, slow), (began, slow), (reached, low), (reached + duration, high)]
    last, _ = solve(axis, course[-1][0], course).jumps[-1]
    return float(np.interp(last, *np.array(course).T))


def random_axis(seed: int) -> Axis:
    """Return a random stable axis, of numbers that are usual for machine tools."""
    generator = random.Random(seed)
    while True:
        try:
            axis = _drawn(generator)
        except ValueError:
            # Its sample is too long for its motion.
            continue
        if is_stable(designed(axis)):
            return axis


def _drawn(generator: random.Random) -> Axis:
    even, choice = generator.uniform, generator.choice

    def over(low: float, high: float) -> float:
        return math.exp(even(math.log(low), math.log(high)))

    m, w = over(100.0, 3000.0), 2.0 * math.pi * over(25.0, 120.0)
    pitch, m_d = choice([0.005, 0.01, 0.016, 0.02]), m * over(0.4, 5.0)
    T_s = choice([62.5e-6, 125e-6, 250e-6, 500e-6, 1e-3])
    omega_v, mu_k = over(120.0, 700.0), even(0.05, 0.2)
    values: dict[str, Any] = {
        "m": m,
        "k": m * w * w,
        "c": 2.0 * over(0.003, 0.06) * m * w,
        "mu_s": mu_k * (1.0 + even(0.08, 0.4)),
        "mu_k": mu_k,
        "J": m_d / (2.0 * math.pi / pitch) ** 2,
        "pitch": pitch,
        "d": m_d * even(0.0, 5.0),
        "T_s": T_s,
        "K_v": over(12.0, 60.0),
        "omega_v": omega_v,
        "T_n": critically_damped(omega_v) * over(0.6, 2.5),
        "on_table": choice([False, True]),
        "velocity_feedforward": choice([1.0, 1.0, 0.9, 0.0]),
        "F_max": 1e9,
        "lag": choice([0.0, even(1e-4, 1e-3)]),
        "dead_time": choice([0.0, T_s, even(0.0, 2.5) * T_s]),
        **EXACT,
    }
    if choice([False, True]):
        values["low_pass"] = min(over(150.0, 2000.0), 0.3 / T_s)
        values["low_pass_damping"] = choice([0.0, 0.7, 0.9])
    if choice([False, True]):
        values["notch"] = min(over(100.0, 800.0), 0.3 / T_s)
        values["notch_damping"], values["notch_depth"] = even(0.2, 0.8), even(0.0, 0.4)
    return Axis(**values)
