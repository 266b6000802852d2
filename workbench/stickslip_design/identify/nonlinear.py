"""Numbers by nonlinear least squares, with intervals that stay true where noise has a memory."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from scipy.signal import fftconvolve
from scipy.stats import t as student

from .model import Floats
from .noise import SURE, Memory, memory_of

_STEP: Final = 1e-3
"""Of a deviation: a step of a difference quotient, where errors of rounding and of curvature are
both small."""
_CURVED: Final = 0.03
"""Relative deviation from which the ends of an interval are those of the profile likelihood."""
_NEAR: Final = 0.02
"""How near to its end a profile is followed, in lengths of the interval."""
_TIGHT: Final = 1e-3
"""Of a deviation: how firmly a number is fixed along its profile."""

_DAMPING, _STUCK, _GAIN = 1e-2, 1e8, 1e-3
_LITTLE: Final = 4.0
_SINGULAR: Final = 1e-13
"""Information, of the largest, that is rounding."""

Columns = Sequence[Floats]
"""Residuals of unbroken runs of even samples, each in units of its noise."""


@dataclass(frozen=True)
class Fitted:
    """Least squares at their minimum, shape (p,) of the numbers.

    `columns` gives the residuals at some numbers, `jacobian` their derivatives, in the same parts.
    """

    columns: Callable[[Floats], Columns]
    jacobian: Callable[[Floats], Columns]
    value: Floats
    profiled: bool = True
    """Whether ends of wide intervals are those of the profile likelihood: it takes many fits."""

    @cached_property
    def residual(self) -> Columns:
        """Residuals at the minimum."""
        return self.columns(self.value)

    @cached_property
    def memory(self) -> list[Memory]:
        """How long the residual of each part knows itself."""
        return [memory_of([part - np.mean(part)]) for part in self.residual]

    @cached_property
    def _information(self) -> tuple[Floats, Floats, Floats]:
        """Lengths of the derivatives; inverse information, scaled by them; its white part's."""
        parts = self.jacobian(self.value)
        whole = np.concatenate(parts)
        scale = np.sqrt(np.sum(whole * whole, axis=0))
        scale[scale == 0.0] = 1.0
        sizes, axes = np.linalg.eigh((whole / scale).T @ (whole / scale))
        # What the record does not tell has no end, and not the end 0 of a pseudo-inverse.
        inverse = (axes / np.maximum(sizes, _SINGULAR)) @ axes.T
        middle = np.zeros_like(inverse)
        for part, memory, r in zip(parts, self.memory, self.residual, strict=True):
            J, power = part / scale, float(np.mean(r * r)) * r.size / self._free(r.size)
            spread = J
            if memory.samples:
                kernel = memory.correlation[: memory.samples]
                both = np.concatenate([kernel[::-1], [1.0], kernel])
                spread = fftconvolve(J, both[:, None], "full", axes=0)[kernel.size :][: len(J)]
            middle += power * 0.5 * (J.T @ spread + spread.T @ J)
        return scale, inverse, inverse @ middle @ inverse

    def _free(self, size: int) -> float:
        count = sum(r.size for r in self.residual)
        return size * max(count - self.value.size, 1) / count

    @cached_property
    def covariance(self) -> Floats:
        """Covariance of the numbers, shape (p, p): of noise, and of a search that has not ended."""
        scale, _, covariance = self._information
        return covariance / np.outer(scale, scale) + np.outer(self.left, self.left)

    @cached_property
    def left(self) -> Floats:
        """What the search has left to go, shape (p,), by a whole step of Gauss and Newton."""
        scale, inverse, _ = self._information
        parts = zip(self.jacobian(self.value), self.residual, strict=True)
        return np.asarray(inverse @ (sum(J.T @ r for J, r in parts) / scale) / scale)

    @property
    def left_is_little(self) -> bool:
        """Whether that is within the noise."""
        scale, inverse, _ = self._information
        white = inverse / np.outer(scale, scale)
        return (
            float(self.left @ np.linalg.pinv(white, hermitian=True) @ self.left)
            < _LITTLE * self.left.size
        )

    @cached_property
    def reach(self) -> float:
        """Deviations in half an interval."""
        seen = [
            r.size / (1.0 + 2.0 * m.samples)
            for r, m in zip(self.residual, self.memory, strict=True)
        ]
        return float(student.ppf(0.5 + 0.5 * SURE, max(sum(seen) - self.value.size, 3.0)))

    def gradient(self, of: Callable[[Floats], float]) -> Floats:
        """Return the derivatives of a number that follows from the numbers, shape (p,)."""
        scale, inverse, _ = self._information
        steps = _STEP * np.sqrt(np.maximum(np.diag(inverse), 1e-30)) / scale
        moves = np.diag(steps)
        return np.array(
            [
                (of(self.value + move) - of(self.value - move)) / (2.0 * step)
                for move, step in zip(moves, steps, strict=True)
            ]
        )

    def deviation(self, of: Callable[[Floats], float]) -> float:
        """Return the standard deviation of a number that follows from the numbers."""
        slope = self.gradient(of)
        return math.sqrt(max(float(slope @ self.covariance @ slope), 0.0))

    def interval(self, of: Callable[[Floats], float]) -> tuple[float, float, float]:
        """Return a number that follows from the numbers, and its interval of 95 %.

        Where its deviation is large the ends are those of the profile likelihood.
        """
        value, half = float(of(self.value)), self.reach * self.deviation(of)
        if not _CURVED * self.reach * abs(value) < half < math.inf:
            return value, value - half, value + half
        if not self.profiled:
            # What scales a motion is as far off by its logarithm.
            share = half / value if value > 0.0 else 0.0
            if not 0.0 < share < 1.0:
                return value, value - half, value + half
            return value, value * math.exp(-share), value * math.exp(share)
        return value, self._end(of, value, -half), self._end(of, value, half)

    def _end(self, of: Callable[[Floats], float], value: float, half: float) -> float:
        """Return where the profile of the squares has risen as at the end of an interval."""
        scale, inverse, _ = self._information
        slope = self.gradient(of)
        white = inverse / np.outer(scale, scale)
        plain = math.sqrt(float(slope @ white @ slope))
        least, at = sum(float(r @ r) for r in self.residual), half
        numbers = self.value
        for _ in range(4):
            start = numbers + white @ slope / plain**2 * (value + at - of(numbers))
            tight, aim = _TIGHT * plain, value + at

            def columns(n: Floats, aim: float = aim, tight: float = tight) -> Columns:
                return [*self.columns(n), np.array([(of(n) - aim) / tight])]

            def jacobian(n: Floats, tight: float = tight) -> Columns:
                return [*self.jacobian(n), slope[None, :] / tight]

            fixed = _minimum(columns, jacobian, start, most=6)
            rise = sum(float(r @ r) for r in self.columns(fixed)) - least
            # In lengths of the interval, on the scale of white noise of size 1.
            share = math.sqrt(max(rise, 0.0)) / (abs(half) / plain)
            if not 0.2 < share < 5.0:
                break
            numbers, at = fixed, at / share
            if abs(share - 1.0) < _NEAR:
                break
        return value + at


def _minimum(
    columns: Callable[[Floats], Columns],
    jacobian: Callable[[Floats], Columns],
    start: Floats,
    most: int = 80,
) -> Floats:
    """Return where the squares are least, by Levenberg's and Marquardt's damped steps.

    It ends where a step would gain no more than `_GAIN` of the noise of one sample.
    """
    numbers, r, damping = start, np.concatenate(columns(start)), _DAMPING
    for _ in range(most):
        J = np.concatenate(jacobian(numbers))
        scale = np.sqrt(np.sum(J * J, axis=0))
        scale[~(scale > 0.0)] = 1.0
        square, slope = float(r @ r), (J / scale).T @ r
        normal = (J / scale).T @ (J / scale)
        while True:
            step = -np.linalg.solve(normal + damping * np.eye(start.size), slope)
            trial = numbers + step / scale
            new = np.concatenate(columns(trial))
            if float(new @ new) < square:
                break
            damping *= 8.0
            if damping > _STUCK:
                return numbers
        gain = square - float(new @ new)
        numbers, r = trial, new
        if gain < _GAIN * square / r.size and damping < _DAMPING:
            break
        damping = max(0.1 * damping, 1e-12)
    return numbers


def fit(
    columns: Callable[[Floats], Columns],
    jacobian: Callable[[Floats], Columns],
    start: Floats,
    most: int = 80,
    profiled: bool = True,
) -> Fitted:
    """Return the least squares that are reached from a start, shape (p,)."""
    return Fitted(columns, jacobian, _minimum(columns, jacobian, start, most), profiled)
