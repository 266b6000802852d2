"""The steady cycle in closed form, and as designers write it; docs/theory.md (6) to (13)."""

from __future__ import annotations

import warnings
from dataclasses import astuple, dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .blocks import evaluate
from .damped import damped_slip
from .dwell import dwell_cycle
from .laws.coulomb import dwells
from .parameters import FloatOrArray, FrictionClampWarning, Parameters

_ROOT_OF_LARGEST = 1e150
"""Beyond it lambda^2 may overflow, and 1 + lambda, a bound of sqrt(1 + lambda^2), is as good."""


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
    attractors : int or array of int
        Number of attractors with sticks that were found: cycles, sequences of several sticks and
        irregular ones. Where static friction grows at rest there may be several; `dwell_attractors`
        lists them.
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
    attractors: int | NDArray[np.int_]


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
        ``mu_s = mu_k``. Where ``p.own`` lets static friction grow with the time at rest, the cycle
        that a start from rest with a relaxed spring leads to, after ``age_start``; docs/theory.md
        (23).
    """
    if dwells(p) and 0 not in p.shape:
        return Cycle(*_each_alone(p))
    operands = (p.m, p.g, p.k, p.c, p.mu_s, p.mu_k_used, p.v, p.load)
    results = evaluate(_cycle, operands, p.shape, [*[np.float64] * 10, np.bool_])
    results.append(results[-1].astype(int) if p.shape else int(results[-1]))
    return Cycle(*results)


def _each_alone(p: Parameters) -> list[Any]:
    """Return the fields of the cycle with dwell, found point by point."""
    names = [each.name for each in fields(p) if each.name != "own"]
    points = np.broadcast_arrays(*(getattr(p, name) for name in names))
    rows = []
    for values in zip(*(each.flat for each in points), strict=True):
        given: dict[str, Any] = dict(zip(names, map(float, values), strict=True))
        with warnings.catch_warnings():
            # The clamp was warned of where the parameters were made.
            warnings.simplefilter("ignore", FrictionClampWarning)
            point = replace(p, **given).with_own(p.own)
        rows.append(dwell_cycle(point) if dwells(point) else astuple(steady_cycle(point)))
    if not p.shape:
        return list(rows[0])
    return [np.array(column).reshape(p.shape) for column in zip(*rows, strict=True)]


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
    return SimplifiedCycle(*evaluate(_simplified, operands, p.shape, [np.float64] * 6))


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
        zeta = np.broadcast_to(c / (2.0 * m * w), F_s.shape)
        damped = np.flatnonzero(zeta > 0.0)
        if damped.size < zeta.size:
            _undamped(out, w)
        _damped(out, damped, zeta, w, speed)
    else:
        _undamped(out, w)
    np.add(t_stick, t_slip, out=T)
    np.divide(1.0, T, out=f)
    np.multiply(v, T, out=delta_x)
    np.multiply(v, x_dot_peak, out=x_dot_peak)
    if not forward:
        np.copysign(spring_drop, v, out=spring_drop)
    if not np.all(exists):
        absent = ~exists
        for result in (spring_drop, delta_x, t_slip, t_stick, T, f, x_dot_peak):
            np.copyto(result, np.nan, where=absent)


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


def _undamped(out: list[Any], w: Any) -> None:
    """Fill in t_slip, t_stick, relief, peak velocity over v; docs/theory.md (7) to (11)."""
    _, Delta, lambda_, spring_drop, _, t_slip, t_stick, _, _, x_dot_peak, _ = out
    two_over_w = 2.0 / w
    np.add(Delta, Delta, out=spring_drop)
    np.multiply(lambda_, two_over_w, out=t_stick)
    np.arctan(lambda_, out=t_slip)
    np.subtract(np.pi, t_slip, out=t_slip)
    np.multiply(t_slip, two_over_w, out=t_slip)
    np.multiply(lambda_, lambda_, out=x_dot_peak)
    np.add(x_dot_peak, 1.0, out=x_dot_peak)
    np.sqrt(x_dot_peak, out=x_dot_peak)
    # A NaN, of v = 0 without a gap, must not hide the largest.
    if not np.max(lambda_) <= _ROOT_OF_LARGEST:
        np.minimum(x_dot_peak, 1.0 + lambda_, out=x_dot_peak)
    np.add(x_dot_peak, 1.0, out=x_dot_peak)


def _damped(out: list[Any], at: NDArray[np.intp], zeta: Any, w: Any, speed: Any) -> None:
    """Fill in, at these points, the same and whether the cycle exists; docs/theory.md (13)."""
    _, _, lambda_, spring_drop, _, t_slip, t_stick, _, _, x_dot_peak, exists = out
    lambda_, zeta, w, speed = (
        np.broadcast_to(each, exists.shape)[at] for each in (lambda_, zeta, w, speed)
    )
    slip = damped_slip(lambda_, zeta)
    exists[at] &= slip.ends
    t_slip[at] = slip.length / w
    # By how much the spring force falls: from the start's acceleration to the end's deceleration.
    t_stick[at] = (lambda_ + slip.deceleration) / w
    spring_drop[at] = t_stick[at] * speed
    x_dot_peak[at] = slip.peak
