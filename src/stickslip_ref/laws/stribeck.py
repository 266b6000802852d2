"""Friction that falls with speed: Stribeck's, the hyperbolic and the measured curve.

docs/theory.md (26).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from enum import IntEnum
from itertools import pairwise
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from ..parameters import Bound, Parameters
from .law import NO_STATE, FrictionLaw, OwnParameter, State

MAX_POINTS = 12
"""Most points of a measured curve."""


class Shape(IntEnum):
    """How the dry friction depends on the speed u [m/s] of slip.

    STRIBECK ``mu_k + (mu_s - mu_k) exp(-(u / v_s)^delta)``; HYPERBOLIC
    ``mu_k + (mu_s - mu_k) / (1 + u / v_s)``; CURVE straight between the measured points
    ``(0, mu_1), (u_2, mu_2) ...``, constant beyond the last.
    """

    STRIBECK = 1
    HYPERBOLIC = 2
    CURVE = 3


def _rows() -> dict[str, OwnParameter]:
    coefficient, speed = Bound("", 0.0), Bound("m/s", 0.0, strict=True)
    rows = {
        "shape": OwnParameter(1.0, Bound("", 1.0), tunable=False),
        "v_s": OwnParameter(0.01, speed),
        "delta": OwnParameter(2.0, Bound("", 1.0)),
        "n_points": OwnParameter(2.0, Bound("", 2.0), tunable=False),
        "mu_1": OwnParameter(0.5, coefficient, tunable=False),
    }
    for number in range(2, MAX_POINTS + 1):
        rows[f"u_{number}"] = OwnParameter((number - 1) / 10, speed, tunable=False)
        rows[f"mu_{number}"] = OwnParameter(0.3, coefficient, tunable=False)
    return rows


class Stribeck(FrictionLaw):
    """Break-away force ``mu_s N`` at any age, and a friction in slip of one of three shapes."""

    parameters = MappingProxyType(_rows())

    def complete(self, p: Parameters, own: Mapping[str, float]) -> Parameters:
        """Return ``p`` with a value for each own parameter.

        Raises
        ------
        ValueError
            Also if shape or n_points is no whole number in range, and for a curve whose speeds do
            not rise or whose mu_1 exceeds mu_s.
        """
        result = super().complete(p, own)
        values = result.own
        for name, low, high in (("shape", 1, len(Shape)), ("n_points", 2, MAX_POINTS)):
            if values[name] not in range(low, high + 1):
                raise ValueError(
                    f"{name} = {values[name]!r} is out of range; it must be a whole number from "
                    f"{low} to {high}"
                )
        if values["shape"] == Shape.CURVE:
            _check_curve(values, float(p.mu_s))
        return result

    def mu_k_used(self, p: Parameters) -> float:
        """Return mu_k after the clamp; for a curve the coefficient of its last point."""
        return curve(p)[-1][1] if shape_of(p) is Shape.CURVE else float(p.mu_k_used)

    def break_away_force(self, p: Parameters, age: float = 0.0, state: State = NO_STATE) -> float:
        """Return ``mu_s N`` [N] at any age of the stick."""
        return float(p.F_s)

    def slip_friction(self, p: Parameters, speed: float, state: State = NO_STATE) -> float:
        """Return the dry friction [N] at a speed [m/s] >= 0."""
        N = float(p.N)
        shape = shape_of(p)
        if shape is Shape.CURVE:
            return N * _on_curve(curve(p), speed)
        mu_s, mu_k = float(p.mu_s), float(p.mu_k_used)
        ratio = speed / p.own["v_s"]
        if shape is Shape.HYPERBOLIC:
            return N * (mu_k + (mu_s - mu_k) / (1.0 + ratio))
        return N * (mu_k + (mu_s - mu_k) * math.exp(-_power(ratio, p.own["delta"])))

    def knots(self, p: Parameters) -> tuple[float, ...]:
        """Return the speeds of a curve's points [m/s] but for the first."""
        return tuple(u for u, _ in curve(p)[1:]) if shape_of(p) is Shape.CURVE else ()

    def speeds(self, p: Parameters) -> tuple[float, ...]:
        """Return v_s [m/s], of a curve nothing."""
        return () if shape_of(p) is Shape.CURVE else (p.own["v_s"],)

    def slope(self, p: Parameters, speed: float) -> float:
        """Return the rate of the friction with the speed [N.s/m]; beside corners."""
        N = float(p.N)
        if shape_of(p) is Shape.CURVE:
            for (u, mu), (u_next, mu_next) in pairwise(curve(p)):
                if speed < u_next:
                    return N * (mu_next - mu) / (u_next - u)
            return 0.0
        fall, v_s = N * float(p.mu_s - p.mu_k_used), p.own["v_s"]
        ratio = speed / v_s
        if shape_of(p) is Shape.HYPERBOLIC:
            return -fall / v_s / (1.0 + ratio) ** 2
        delta = p.own["delta"]
        left = math.exp(-_power(ratio, delta))
        return -fall / v_s * delta * _power(ratio, delta - 1.0) * left if left > 0.0 else 0.0

    def friction_at(self, p: Parameters, speeds: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the dry friction [N] at many speeds [m/s] >= 0."""
        N = float(p.N)
        if shape_of(p) is Shape.CURVE:
            knots, coefficients = zip(*curve(p), strict=True)
            on_curve: NDArray[np.float64] = N * np.interp(speeds, knots, coefficients)
            return on_curve
        mu_s, mu_k = float(p.mu_s), float(p.mu_k_used)
        ratio = speeds / p.own["v_s"]
        if shape_of(p) is Shape.HYPERBOLIC:
            return N * (mu_k + (mu_s - mu_k) / (1.0 + ratio))
        with np.errstate(over="ignore"):
            return N * (mu_k + (mu_s - mu_k) * np.exp(-(ratio ** p.own["delta"])))


def shape_of(p: Parameters) -> Shape:
    """Return the shape that ``p`` asks for."""
    return Shape(int(p.own["shape"]))


def curve(p: Parameters) -> tuple[tuple[float, float], ...]:
    """Return the points of the measured curve: speed [m/s] and coefficient, by rising speed."""
    own = p.own
    others = range(2, int(own["n_points"]) + 1)
    return ((0.0, own["mu_1"]), *((own[f"u_{i}"], own[f"mu_{i}"]) for i in others))


def _on_curve(points: tuple[tuple[float, float], ...], speed: float) -> float:
    """Return the coefficient at a speed [m/s] >= 0."""
    for (u, mu), (u_next, mu_next) in pairwise(points):
        if speed < u_next:
            return mu + (mu_next - mu) * (speed - u) / (u_next - u)
    return points[-1][1]


def _power(ratio: float, exponent: float) -> float:
    """Return a power, infinity beyond the range."""
    try:
        return float(ratio**exponent)
    except OverflowError:
        return math.inf


def _check_curve(values: Mapping[str, float], mu_s: float) -> None:
    if values["mu_1"] > mu_s:
        raise ValueError(
            f"mu_1 = {values['mu_1']!r} is out of range; it must be <= mu_s = {mu_s!r}, the "
            "break-away coefficient"
        )
    before = 0.0
    for number in range(2, int(values["n_points"]) + 1):
        speed = values[f"u_{number}"]
        if not speed > before:
            raise ValueError(
                f"u_{number} = {speed!r} m/s is out of range; it must be > {before!r} m/s, the "
                "speed of the point before it"
            )
        before = speed


STRIBECK = Stribeck()
