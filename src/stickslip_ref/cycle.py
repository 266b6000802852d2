"""The steady cycle in closed form, and as designers write it; docs/theory.md (6) to (13)."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .parameters import FloatOrArray, Parameters

_BLOCK = 16384
"""Points evaluated at a time: the dozen arrays in use (8 B each) stay in the second-level cache."""

_ROOT_OF_LARGEST = 1e150
"""Beyond it lambda^2 may overflow, and 1 + lambda, a bound of sqrt(1 + lambda^2), is as good."""

_MAX_ITERATIONS = 100
"""Bisection to the last bit needs about 55; Newton from the undamped root needs 3 to 8."""


@dataclass(frozen=True)
class Cycle:
    """The steady stick-slip cycle; floats, or arrays of the parameters' common shape.

    Where there is no cycle, ``exists`` is False and all but ``F_s``, ``Delta``, ``lambda_`` are
    NaN.

    Attributes
    ----------
    F_s : float or array
        Break-away force [N]; docs/theory.md (6).
    Delta : float or array
        ``(mu_s - mu_k) N / k`` [m]; docs/theory.md (2).
    lambda_ : float or array
        ``w Delta / |v|`` [-]; docs/theory.md (2). Infinite at v = 0.
    spring_drop : float or array
        Relief of the spring in a slip [m], with the sign of ``v``; docs/theory.md (7), (13).
    delta_x : float or array
        Jump of the mass in a slip [m], with the sign of ``v``; docs/theory.md (10).
    t_slip, t_stick : float or array
        Length of a slip and of a stick [s]; docs/theory.md (8), (9), (13).
    T, f : float or array
        Period [s] and frequency [Hz].
    x_dot_peak : float or array
        Extreme velocity of the mass [m/s], with the sign of ``v``; docs/theory.md (11).
    exists : bool or array of bool
        Whether a mass that breaks away from rest re-sticks and repeats; docs/theory.md (13).
    """

    F_s: FloatOrArray
    Delta: FloatOrArray
    lambda_: FloatOrArray
    spring_drop: FloatOrArray
    delta_x: FloatOrArray
    t_slip: FloatOrArray
    t_stick: FloatOrArray
    T: FloatOrArray
    f: FloatOrArray
    x_dot_peak: FloatOrArray
    exists: bool | NDArray[np.bool_]


@dataclass(frozen=True)
class SimplifiedCycle:
    """The cycle as designers write it, without damping; docs/theory.md (12).

    Floats, or arrays of the parameters' common shape; NaN (but ``F_s``) where ``v = 0``.

    Attributes
    ----------
    F_s : float or array
        ``mu_s N`` [N]; exact.
    delta_x : float or array
        ``2 (mu_s - mu_k) N / k`` [m], with the sign of ``v``: exact for the relief of the spring,
        for the jump of the mass only its limit for v -> 0.
    t_stick : float or array
        ``mu_s N / (k |v|)`` [s]: exact for the first load-up of a relaxed spring.
    t_slip : float or array
        ``pi / w`` [s]: the limit for v -> 0.
    T, f : float or array
        Their sum [s], and its inverse [Hz].
    """

    F_s: FloatOrArray
    delta_x: FloatOrArray
    t_stick: FloatOrArray
    t_slip: FloatOrArray
    T: FloatOrArray
    f: FloatOrArray


def steady_cycle(p: Parameters) -> Cycle:
    """Return the exact steady cycle; docs/theory.md (6) to (11), damped (13).

    Parameters
    ----------
    p : Parameters
        Numbers or arrays, which broadcast. ``F_ext`` and the initial state are of no influence,
        ``load`` enters through the normal force.

    Returns
    -------
    Cycle
        Floats where all fields of ``p`` are, else arrays of their common shape. There is no cycle
        at ``v = 0``; with damping, none for ``lambda < lambda_c``, ``zeta >= 1`` or
        ``mu_s = mu_k``.
    """
    operands = (p.m, p.g, p.k, p.c, p.mu_s, p.mu_k_used, p.v, p.load)
    return Cycle(*_evaluate(_cycle, operands, p.shape, [*[np.float64] * 10, np.bool_]))


def simplified(p: Parameters) -> SimplifiedCycle:
    """Return the cycle as designers write it; docs/theory.md (12).

    Parameters
    ----------
    p : Parameters
        Numbers or arrays, which broadcast. ``c``, ``F_ext`` and the initial state are of no
        influence, ``load`` enters through the normal force.

    Returns
    -------
    SimplifiedCycle
        Floats where all fields of ``p`` are, else arrays of their common shape.
    """
    operands = (p.m, p.g, p.k, p.mu_s, p.mu_k_used, p.v, p.load)
    return SimplifiedCycle(*_evaluate(_simplified, operands, p.shape, [np.float64] * 6))


def _cycle(
    out: list[Any], m: Any, g: Any, k: Any, c: Any, mu_s: Any, mu_k: Any, v: Any, load: Any
) -> None:
    """Evaluate one block into arrays in the order of the fields of `Cycle`.

    Results are formed in place, so that the block's working set stays small.
    """
    F_s, Delta, lambda_, spring_drop, delta_x, t_slip, t_stick, T, f, x_dot_peak, exists = out
    forward = np.min(v) > 0.0
    speed = v if forward else np.abs(v)
    N = m * g + load
    w = np.sqrt(k / m)
    np.multiply(mu_s, N, out=F_s)
    np.subtract(mu_s, mu_k, out=Delta)
    np.multiply(Delta, N, out=Delta)
    np.divide(Delta, k, out=Delta)
    np.multiply(Delta, w, out=lambda_)
    np.divide(lambda_, speed, out=lambda_)
    np.greater(speed, 0.0, out=exists)
    if np.any(c):
        _damped(out, c / (2.0 * m * w), w, speed)
    else:
        two_over_w = 2.0 / w
        np.add(Delta, Delta, out=spring_drop)
        np.multiply(lambda_, two_over_w, out=t_stick)
        np.arctan(lambda_, out=t_slip)
        np.subtract(np.pi, t_slip, out=t_slip)
        np.multiply(t_slip, two_over_w, out=t_slip)
        np.multiply(lambda_, lambda_, out=x_dot_peak)
        np.add(x_dot_peak, 1.0, out=x_dot_peak)
        np.sqrt(x_dot_peak, out=x_dot_peak)
        if np.max(lambda_) > _ROOT_OF_LARGEST:
            np.minimum(x_dot_peak, 1.0 + lambda_, out=x_dot_peak)
        np.add(x_dot_peak, 1.0, out=x_dot_peak)
    np.add(t_stick, t_slip, out=T)
    np.divide(1.0, T, out=f)
    np.multiply(v, T, out=delta_x)
    np.multiply(v, x_dot_peak, out=x_dot_peak)
    if not forward:
        np.copysign(spring_drop, v, out=spring_drop)
    if not np.all(exists):
        for result in (spring_drop, delta_x, t_slip, t_stick, T, f, x_dot_peak):
            result[~exists] = np.nan


def _simplified(
    out: list[Any], m: Any, g: Any, k: Any, mu_s: Any, mu_k: Any, v: Any, load: Any
) -> None:
    """Evaluate one block into arrays in the order of the fields of `SimplifiedCycle`."""
    F_s, delta_x, t_stick, t_slip, T, f = out
    N = m * g + load
    F_s[:] = mu_s * N
    delta_x[:] = np.copysign(2.0 * (mu_s - mu_k) * N / k, v)
    t_stick[:] = F_s / (k * np.abs(v))
    t_slip[:] = np.pi * np.sqrt(m / k)
    T[:] = t_stick + t_slip
    f[:] = 1.0 / T
    rests = np.broadcast_to(np.equal(v, 0.0), F_s.shape)
    if np.any(rests):
        for result in (delta_x, t_stick, t_slip, T, f):
            result[rests] = np.nan


def _damped(out: list[Any], zeta: Any, w: Any, speed: Any) -> None:
    """Fill in t_slip, t_stick, relief, peak velocity over v, existence; docs/theory.md (13).

    In units of v and 1 / w the velocity deviation from the pull, ``x_dot / v - 1``, starts at -1
    and is ``-D G(delta)``, ``delta`` being the time left to its minimum, where

        D = sqrt(1 - 2 zeta lambda + lambda^2) exp(-zeta tau_min)
        G(delta) = exp(zeta delta) (cos(nu delta) - (zeta / nu) sin(nu delta))

    and G falls from 1 at the minimum to 0 at nu delta = acos zeta. The slip ends at G = 1 / D.
    """
    _, _, lambda_, spring_drop, _, t_slip, t_stick, _, _, x_dot_peak, exists = out
    zeta = np.broadcast_to(zeta, lambda_.shape)
    light = zeta < 1.0
    zeta = np.where(light, zeta, 0.5)
    nu = np.sqrt((1.0 - zeta) * (1.0 + zeta))
    angle = np.arctan2(lambda_ * nu, 1.0 - zeta * lambda_)
    # ln of the amplitude, from the small side of lambda = 1 and from the large: 1 + L (L - 2 zeta).
    ratio = np.where(lambda_ < 1.0, lambda_, 1.0 / lambda_)
    log_amplitude = 0.5 * np.log1p(ratio * (ratio - 2.0 * zeta)) + np.log(np.maximum(lambda_, 1.0))
    tau_min = (2.0 * np.pi - angle) / nu
    log_D = log_amplitude - zeta * tau_min
    exists &= light & (log_D >= 0.0)
    delta = _time_before_minimum(np.where(exists, log_D, 0.0), zeta, nu)
    t_slip[:] = (tau_min - delta) / w
    # By how much the spring force falls: from the start's acceleration to the end's deceleration.
    deceleration = np.exp(log_D + zeta * delta) * np.sin(nu * delta) / nu
    t_stick[:] = (lambda_ + deceleration) / w
    spring_drop[:] = t_stick * speed
    x_dot_peak[:] = 1.0 + np.exp(log_amplitude - zeta * (np.pi - angle) / nu)


def _time_before_minimum(
    log_D: NDArray[np.float64], zeta: NDArray[np.float64], nu: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Solve G(delta) = 1 / D by Newton on sqrt(1 - G), safeguarded by bisection; theory (13).

    1 - G starts as delta^2 / 2, so its root is the unknown in which the equation is nearly linear.
    """
    target = np.sqrt(-np.expm1(-log_D))
    low = np.zeros_like(log_D)
    high = np.arccos(zeta) / nu
    # The undamped root is arccos(1 / D) = arcsin sqrt(1 - D^-2); the first step puts it right.
    delta = np.minimum(np.arcsin(np.sqrt(-np.expm1(-2.0 * log_D))), high)
    for _ in range(_MAX_ITERATIONS):
        sine, growth = np.sin(nu * delta), np.exp(zeta * delta)
        half = np.sin(0.5 * nu * delta)
        # 1 - G with its leading ones cancelled by hand; what is left is rounded to zeta ulp.
        depth = (
            2.0 * half * half
            + growth * (zeta / nu) * sine
            - np.expm1(zeta * delta) * (1.0 - 2.0 * half * half)
        )
        root = np.sqrt(np.maximum(depth, 0.0))
        excess = root - target
        slope = growth * sine / (2.0 * nu * np.maximum(root, 1e-300))
        high = np.where(excess > 0.0, delta, high)
        low = np.where(excess < 0.0, delta, low)
        newton = delta - excess / np.maximum(slope, 1e-300)
        inside = (newton >= low) & (newton <= high)
        update = np.where(target == 0.0, 0.0, np.where(inside, newton, 0.5 * (low + high)))
        converged = np.abs(update - delta) <= 2e-15 * update
        delta = update
        if np.all(converged):
            break
    return delta


def _evaluate(
    kernel: Callable[..., None],
    operands: tuple[FloatOrArray, ...],
    shape: tuple[int, ...],
    dtypes: list[type[np.generic]],
) -> list[Any]:
    """Evaluate the kernel in cache-sized blocks of the broadcast operands; numbers stay numbers."""
    size = math.prod(shape)
    outputs = [np.empty(size, dtype) for dtype in dtypes]
    with np.errstate(all="ignore"):
        for block, values in _blocks(operands, shape, size):
            kernel([output[block] for output in outputs], *values)
    if not shape:
        return [output.item() for output in outputs]
    return [output.reshape(shape) for output in outputs]


def _blocks(
    operands: tuple[FloatOrArray, ...], shape: tuple[int, ...], size: int
) -> Iterator[tuple[slice, list[Any]]]:
    flat: list[Any] = []
    for operand in operands:
        array = np.asarray(operand)
        if array.size == 1:
            flat.append(float(array.flat[0]))
        elif array.shape == shape and array.flags.c_contiguous:
            flat.append(array.reshape(-1))
        else:
            # The flat iterator of the broadcast view copies a block at a time, never the whole.
            flat.append(np.broadcast_to(array, shape).flat)
    for start in range(0, size, _BLOCK):
        block = slice(start, min(start + _BLOCK, size))
        yield block, [each if isinstance(each, float) else each[block] for each in flat]
