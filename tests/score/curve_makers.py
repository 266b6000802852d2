"""Curves as other tools make them: small simulators of their own, and the exact motion.

Every maker takes parameters (SI, by name), a duration [s] and steps, and gives times, positions,
velocities and spring forces of a mass that starts at rest with a relaxed spring, pulled forward.
"""

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import stickslip_ref

Floats = NDArray[np.float64]
Parameters = Mapping[str, float]
Friction = Callable[[float], float]


class Made(NamedTuple):
    """Samples of a made motion: time [s], position [m], velocity [m/s], spring force [N]."""

    t: Floats
    x: Floats
    x_dot: Floats
    F: Floats

    def every(self, count: int) -> "Made":
        """Keep each `count`-th sample."""
        return Made(*(column[::count] for column in self))

    def printed(self, digits: int) -> "Made":
        """Print the numbers to so many digits."""
        return Made(
            *(np.array([float(f"{number:.{digits}g}") for number in column]) for column in self)
        )


def with_defaults(p: Parameters) -> dict[str, float]:
    """Complete the parameters."""
    return {"m": 1.0, "g": 9.81, "k": 1000.0, "mu_s": 0.5, "mu_k": 0.3, "v": 0.02} | dict(p)


def exact(p: Parameters, times: Floats) -> Made:
    """Give the block's motion by the reference."""
    run = stickslip_ref.simulate(
        stickslip_ref.Parameters(**p), float(times[-1]), start_time=float(times[0]), times=times
    )
    return Made(run.t, run.x, run.x_dot, run.F)


def verlet(p: Parameters, duration: float, h: float) -> Made:
    """Step by velocity Verlet; rest and break-away are decided at the ends of steps."""
    q = with_defaults(p)
    N = q["m"] * q["g"]

    def acceleration(z: float) -> float:
        return (q["k"] * z - q["mu_k"] * N) / q["m"]

    def step(x: float, u: float, time: float, slipping: bool) -> tuple[float, float, bool]:
        z = q["v"] * time - x
        if not slipping:
            if q["k"] * z <= q["mu_s"] * N:
                return x, 0.0, False
            u = 0.0
        a = acceleration(z)
        x += h * u + 0.5 * h * h * a
        u += 0.5 * h * (a + acceleration(q["v"] * (time + h) - x))
        return (x, 0.0, False) if u <= 0.0 else (x, u, True)

    return _stepped(q, duration, h, step)


def semi_implicit_euler(p: Parameters, duration: float, h: float) -> Made:
    """Step by semi-implicit Euler; rest and break-away are decided at the ends of steps."""
    q = with_defaults(p)
    N = q["m"] * q["g"]

    def step(x: float, u: float, time: float, slipping: bool) -> tuple[float, float, bool]:
        force = q["k"] * (q["v"] * time - x)
        if not slipping and force <= q["mu_s"] * N:
            return x, 0.0, False
        u += h * (force - q["mu_k"] * N) / q["m"]
        return (x, 0.0, False) if u <= 0.0 else (x + h * u, u, True)

    return _stepped(q, duration, h, step)


def runge_kutta(p: Parameters, duration: float, h: float) -> Made:
    """Step a slip by the classical Runge-Kutta method; events are decided at the ends of steps."""
    q = with_defaults(p)
    N = q["m"] * q["g"]

    def acceleration(time: float, x: float, u: float) -> float:
        return (q["k"] * (q["v"] * time - x) - q["mu_k"] * N) / q["m"]

    def step(x: float, u: float, time: float, slipping: bool) -> tuple[float, float, bool]:
        if not slipping and q["k"] * (q["v"] * time - x) <= q["mu_s"] * N:
            return x, 0.0, False
        x, u = _classical_step(acceleration, time, x, u, h)
        return (x, 0.0, False) if u <= 0.0 else (x, u, True)

    return _stepped(q, duration, h, step)


def tanh_friction(
    p: Parameters, times: Floats, v_reg: float, *, peak: bool, v_stribeck: float | None = None
) -> Made:
    """Integrate friction smoothed with tanh(x_dot/v_reg), with the static peak or without it.

    The peak decays with exp(-(x_dot/v_stribeck)^2), by default 20 v_reg. It is stiff, by
    mu_s g/v_reg, and so is the method.
    """
    q = with_defaults(p)
    k, m, v, mu_k, N = q["k"], q["m"], q["v"], q["mu_k"], q["m"] * q["g"]
    width = 20.0 * v_reg if v_stribeck is None else v_stribeck
    rise = (q["mu_s"] - q["mu_k"]) if peak else 0.0

    def rate(time: float, state: Floats) -> tuple[float, float]:
        x, u = state
        mu = (mu_k + rise * math.exp(-min((u / width) ** 2, 700.0))) * math.tanh(u / v_reg)
        return u, (k * (v * time - x) - mu * N) / m

    done = solve_ivp(
        rate, (0.0, times[-1]), [0.0, 0.0], "LSODA", times, rtol=1e-8, atol=1e-11,
        max_step=0.2 / math.sqrt(k / m),
    )  # fmt: skip
    x, u = done.y
    return Made(times, x, u, k * (v * times - x))


def _classical_step(
    acceleration: Callable[[float, float, float], float], time: float, x: float, u: float, h: float
) -> tuple[float, float]:
    half = 0.5 * h
    a1 = acceleration(time, x, u)
    u2 = u + half * a1
    a2 = acceleration(time + half, x + half * u, u2)
    u3 = u + half * a2
    a3 = acceleration(time + half, x + half * u2, u3)
    u4 = u + h * a3
    a4 = acceleration(time + h, x + h * u3, u4)
    return x + h * (u + 2 * u2 + 2 * u3 + u4) / 6, u + h * (a1 + 2 * a2 + 2 * a3 + a4) / 6


def _stepped(
    q: Parameters,
    duration: float,
    h: float,
    step: Callable[[float, float, float, bool], tuple[float, float, bool]],
) -> Made:
    count = round(duration / h)
    x, u, slipping = 0.0, 0.0, False
    positions, velocities = [x], [u]
    for number in range(count):
        x, u, slipping = step(x, u, number * h, slipping)
        positions.append(x)
        velocities.append(u)
    t: Floats = h * np.arange(count + 1, dtype=np.float64)
    at = np.array(positions)
    return Made(t, at, np.array(velocities), q["k"] * (q["v"] * t - at))


def euler_with_the_sign(p: Parameters, duration: float, h: float) -> Made:
    """Step by semi-implicit Euler with friction by the sign of the velocity, and never at rest."""
    q = with_defaults(p)
    N = q["m"] * q["g"]

    def step(x: float, u: float, time: float, _: bool) -> tuple[float, float, bool]:
        force = q["k"] * (q["v"] * time - x)
        mu = q["mu_s"] if abs(u) < 0.05 * q["v"] else q["mu_k"]
        u += h * (force - math.copysign(mu * N, u or force)) / q["m"]
        return x + h * u, u, True

    return _stepped(q, duration, h, step)
