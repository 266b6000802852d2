"""The motion under a friction law without a stick, integrated whole with SciPy.

Without a stick there are no events: position, velocity and the law's own state follow one smooth
system of equations between two changes of input.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from ..laws import FrictionLaw, State
from ..parameters import Parameters
from .slip import Floats, Samples, Sampling

RTOL = 1e-11
"""Tolerance of a step of the implicit method (Radau): such laws are stiff, and at order 5 it
affords no less."""


def integrate_whole(
    p: Parameters, law: FrictionLaw, z: float, x_dot: float, state: State, duration: float
) -> Sampling:
    """Integrate the motion for a time.

    Parameters
    ----------
    p : Parameters
        Numbers only.
    law : FrictionLaw
        A law without a stick.
    z, x_dot : float
        Spring extension [m] and velocity [m/s] at the beginning.
    state : tuple of float
        The law's own state at the beginning.
    duration : float
        How long [s], >= 0.

    Raises
    ------
    RuntimeError
        If the integration fails; the message gives SciPy's reason.
    """
    m, k, c, v, F_ext = (float(each) for each in (p.m, p.k, p.c, p.v, p.F_ext))

    def rates(t: float, y: Floats) -> list[float]:
        relief, u, _, _, *own = y.tolist()
        extension = z - relief
        dry = law.slip_friction(p, u, tuple(own))
        acceleration = (k * extension + F_ext - dry - c * u) / m
        heating = (dry + c * u) * u
        return [u - v, acceleration, extension, heating, *law.rates(p, u, tuple(own))]

    w = float(p.w)
    length = max(abs(z), abs(v) / w, law.break_away_force(p, 0.0, state) / k, abs(F_ext) / k)
    speed = max(abs(x_dot), abs(v), w * length) or 1.0
    sizes = [speed / w, speed, speed / w / w, k * (speed / w) ** 2, *law.state_scale(p)]
    solution = solve_ivp(
        rates,
        (0.0, duration or 1.0 / w),
        [0.0, x_dot, 0.0, 0.0, *state],
        method="Radau",
        dense_output=True,
        rtol=RTOL,
        atol=[RTOL * size for size in sizes],
    )
    if solution.status < 0:
        raise RuntimeError(f"the integration of the motion failed: {solution.message}")

    def sample(times: Floats) -> Samples:
        y = solution.sol(np.atleast_1d(times))
        return Samples(y[0], y[1], y[2], y[3], y[4:])

    return sample
