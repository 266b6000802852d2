"""Numbers by nonlinear least squares, with intervals that stay true where noise has a memory."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import fftconvolve
from scipy.stats import t as student

from .model import Floats
from .noise import SURE, Memory, memory_of

_STEP: Final = 1e-3
"""Of a deviation: a step of a difference quotient, where errors of rounding and of curvature are
both small."""
_CURVED: Final = 0.03
"""Relative deviation from which an interval is one of the logarithm: numbers scale a motion."""
_GAIN: Final = 1e-9
"""Of the squares and the numbers: what a step gains at the end of a search."""
_LITTLE: Final = 4.0
"""Of the squares, for each number: what a search may have left."""
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

    def gradient(self, of: Callable[[Floats], float | Floats]) -> Floats:
        """Return the derivatives of what follows from the numbers, shape (p,) or (p, values)."""
        scale, inverse, _ = self._information
        steps = _STEP * np.sqrt(np.maximum(np.diag(inverse), 1e-30)) / scale
        sides = [[of(self.value + side * move) for move in np.diag(steps)] for side in (1.0, -1.0)]
        return np.asarray((np.array(sides[0]) - np.array(sides[1])).T / (2.0 * steps)).T

    def deviation(self, of: Callable[[Floats], float]) -> float:
        """Return the standard deviation of a number that follows from the numbers."""
        slope = self.gradient(of)
        return math.sqrt(max(float(slope @ self.covariance @ slope), 0.0))

    def interval(self, of: Callable[[Floats], float]) -> tuple[float, float, float]:
        """Return a number that follows from the numbers, and its interval of 95 %."""
        return self.ends(float(of(self.value)), self.deviation(of))

    def ends(self, value: float, deviation: float) -> tuple[float, float, float]:
        """Return a value, and its interval of 95 % of a standard deviation."""
        half = self.reach * deviation
        share = half / value if value > 0.0 else math.inf
        if not _CURVED * self.reach < share < 1.0:
            return value, value - half, value + half
        return value, value * math.exp(-share), value * math.exp(share)


def fit(
    columns: Callable[[Floats], Columns],
    jacobian: Callable[[Floats], Columns],
    start: Floats,
    most: int = 80,
) -> Fitted:
    """Return the least squares that are reached from a start, shape (p,), in so many trials."""
    best = least_squares(
        lambda n: np.concatenate(columns(n)), start, lambda n: np.concatenate(jacobian(n)),
        method="lm", x_scale="jac", ftol=_GAIN, xtol=_GAIN, gtol=_GAIN, max_nfev=most,
    )  # fmt: skip
    return Fitted(columns, jacobian, np.asarray(best.x))
