"""Curves as other tools make them, of a mass pulled from rest: simulators and the exact motion."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import stickslip_ref
from stickslip_score import Curve, Score, score

Floats = NDArray[np.float64]
Parameters = Mapping[str, float]

QUANTITIES = ("period", "t_stick", "t_slip", "delta_x")
ROUNDING = 1e-11
"""Relative: the reference is right to 4e-14 of mu_s/(mu_s - mu_k) (docs/theory.md (17))."""


def ratios(*scores: Score) -> Floats:
    figures = [getattr(result, name) for result in scores for name in QUANTITIES]
    return np.array([
        max(abs(figure.error) - ROUNDING * abs(figure.exact), 0.0) / figure.resolution
        for figure in figures
        if figure.error is not None
    ])  # fmt: skip


class Made(NamedTuple):
    """Samples of a made motion: time [s], position [m], velocity [m/s], spring force [N]."""

    t: Floats
    x: Floats
    x_dot: Floats
    F: Floats

    def rows(self, chosen: slice) -> "Made":
        return Made(*(column[chosen] for column in self))

    def printed(self, digits: int) -> "Made":
        return Made(*(np.array([float(f"{x:.{digits}g}") for x in column]) for column in self))


def scored(made: Made, p: Parameters, columns: str = "x") -> Score:
    return score(Curve.of(made.t, **{name: getattr(made, name) for name in columns.split()}), p)


def with_defaults(p: Parameters) -> dict[str, float]:
    usual = {"m": 1.0, "g": 9.81, "k": 1000.0, "mu_s": 0.5, "mu_k": 0.3, "v": 0.02, "c": 0.0}
    return {**usual, **p}


def exact(p: Parameters, times: Floats) -> Made:
    run = stickslip_ref.simulate(
        stickslip_ref.Parameters(**p), float(times[-1]), start_time=float(times[0]), times=times
    )
    return Made(run.t, run.x, run.x_dot, run.F)


def adaptive(p: Parameters, times: Floats, rtol: float) -> Made:
    q = with_defaults(p)
    k, v, N = q["k"], q["v"], q["m"] * q["g"]
    states, begin = np.zeros((2, times.size)), q["mu_s"] * N / k / v

    def rate(time: float, state: Floats) -> tuple[float, float]:
        return state[1], (k * (v * time - state[0]) - q["mu_k"] * N) / q["m"]

    def stops(_: float, state: Floats) -> float:
        return float(state[1])

    stops.terminal, stops.direction = True, -1  # type: ignore[attr-defined]
    while begin < times[-1]:
        tight = {"rtol": rtol, "atol": 1e-3 * rtol, "events": stops, "dense_output": True}
        slip = solve_ivp(rate, (begin, times[-1]), [states[0, -1], 0.0], **tight)
        states[:, times > begin] = slip.sol(np.minimum(times[times > begin], slip.t[-1]))
        begin = q["mu_s"] * N / k / v + states[0, -1] / v
    return Made(times, states[0], states[1], k * (v * times - states[0]))


def stepped(p: Parameters, duration: float, h: float) -> Made:
    q = with_defaults(p)
    k, v, N = q["k"], q["v"], q["m"] * q["g"]
    t: Floats = h * np.arange(round(duration / h) + 1, dtype=np.float64)
    x, u = 0.0, 0.0
    rows = [(x, u)]

    def acceleration(time: float, x: float, u: float) -> float:
        return float((k * (v * time - x) - q["mu_k"] * N - q["c"] * u) / q["m"])

    for time in t[:-1]:
        if u > 0.0 or k * (v * time - x) > q["mu_s"] * N:
            before = acceleration(time, x, u)
            x += h * u + 0.5 * h * h * before
            u = max(u + 0.5 * h * (before + acceleration(time + h, x, u)), 0.0)
        rows.append((x, u))
    xs, us = np.array(rows).T
    return Made(t, xs, us, k * (v * t - xs))


def euler_with_the_sign(p: Parameters, duration: float, h: float) -> Made:
    q = with_defaults(p)
    t: Floats = h * np.arange(round(duration / h) + 1, dtype=np.float64)
    x, u = np.zeros(t.size), np.zeros(t.size)
    for n in range(t.size - 1):
        force = q["k"] * (q["v"] * t[n] - x[n])
        mu = q["mu_s"] if abs(u[n]) < 0.05 * q["v"] else q["mu_k"]
        friction = math.copysign(mu * q["m"] * q["g"], u[n] or force)
        u[n + 1] = u[n] + h * (force - friction) / q["m"]
        x[n + 1] = x[n] + h * u[n + 1]
    return Made(t, x, u, q["k"] * (q["v"] * t - x))


def tanh_friction(p: Parameters, times: Floats, v_reg: float, *, peak: bool) -> Made:
    q = with_defaults(p)
    k, m, v, mu_k, N = q["k"], q["m"], q["v"], q["mu_k"], q["m"] * q["g"]
    rise = (q["mu_s"] - q["mu_k"]) if peak else 0.0

    def rate(time: float, state: Floats) -> tuple[float, float]:
        x, u = state
        mu = mu_k + rise * math.exp(-min((u / (20.0 * v_reg)) ** 2, 700.0))
        return u, (k * (v * time - x) - mu * N * math.tanh(u / v_reg) - q["c"] * u) / m

    tight = {"rtol": 1e-8, "atol": 1e-11, "max_step": 0.2 / math.sqrt(k / m)}
    done = solve_ivp(rate, (0.0, times[-1]), [0.0, 0.0], "LSODA", times, **tight)
    x, u = done.y
    return Made(times, x, u, k * (v * times - x))
