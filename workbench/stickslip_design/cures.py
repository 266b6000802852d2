"""What suppresses a stick-slip cycle: each parameter alone, in numbers; docs/theory.md (6) to (14).

`cures` says for a block what spring, damping, speed, friction, normal force or mass would halve the
jump of the mass or end the cycle.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

from scipy.optimize import brentq

from stickslip_ref import Parameters, coulomb_limit, critical_lambda, steady_cycle

Parameter = Literal["k", "c", "v", "mu_k", "load", "m"]

_XTOL, _RTOL = 1e-300, 4.0 * 2.0**-52
"""brentq to the last digits: relative accuracy alone counts, and this is the least it takes."""

_DIPS = 60
"""Steps of the search for a mass at which v_c is smallest; it gains a digit in two of them."""


@dataclass(frozen=True)
class Cure:
    """One parameter changed in one direction, all others held.

    Attributes
    ----------
    name : str
        ``stiffer``, ``softer``, ``damping``, ``slower``, ``faster``, ``gap``, ``normal force`` or
        ``lighter``.
    parameter : str
        The field of `Parameters` that it changes. The gap is changed by ``mu_k`` and the normal
        force by ``load``; the mass changes with ``load`` held, so the weight goes with it.
    now : float
        The value in use, SI.
    halve : float or None
        The value at which the jump is half of what it is now, SI. None where there is none.
    end : float or None
        The limit of the cycle, SI: at any value beyond it there is no cycle. For ``lighter``,
        where ``load`` > 0 may bring the cycle back at a still smaller mass: just beyond it. None
        where no value ends the cycle.
    least : float
        The smallest jump on this way, over the jump now [-]: at the limit of the cycle, or where
        the parameter comes to the end of its range. 1 where the jump grows.
    """

    name: str
    parameter: Parameter
    now: float
    halve: float | None
    end: float | None
    least: float


@dataclass(frozen=True)
class Cures:
    """What suppresses the cycle of a block.

    Attributes
    ----------
    jump : float
        Jump of the mass now [m]; NaN where there is no cycle.
    v_c : float
        Critical velocity [m/s]; infinite without damping, docs/theory.md (14).
    cures : tuple of Cure
        Each cure alone; empty where there is no cycle and nothing to suppress.
    """

    jump: float
    v_c: float
    cures: tuple[Cure, ...]


def cures(p: Parameters) -> Cures:
    """Return what would halve the jump of a block, and what would end its cycle.

    Parameters
    ----------
    p : Parameters
        Numbers, no arrays. ``F_ext`` and the initial state are of no influence.

    Returns
    -------
    Cures
        Each parameter alone, the others held.

    Raises
    ------
    ValueError
        If a field of ``p`` is an array.

    Notes
    -----
    Jump and critical velocity are monotone between now and the limit of the cycle:

    - Jump: it rises with ``v``, the gap, the normal force and ``m``, and falls with ``k`` and
      ``c``, wherever the cycle exists. In the plain units of v and w it is T(lambda, zeta), the
      period; its slope in lambda is the step response of the oscillator at the end of the slip,
      which is positive.
    - Damping never halves the jump. At the limit of the cycle the plain period is above
      lambda + pi, and at most twice lambda + pi - atan(lambda) without damping.
    - Critical velocity over ``k``: it has one maximum, at zeta = 0.1814, docs/theory.md (14). So a
      stiffer spring and a softer one each have a limit.
    - Critical velocity over ``m``: with load = 0 it rises. With load > 0 it may have a minimum and
      a maximum; the limit is then the first one on the way to smaller masses.
    """
    if p.shape:
        raise ValueError(f"cures needs one block, not parameters of shape {p.shape}")
    now = steady_cycle(p)
    v_c = float(coulomb_limit(p))
    if not now.exists:
        return Cures(math.nan, v_c, ())
    block = replace(p, mu_k=p.mu_k_used)
    found = (
        _stiffer(block),
        _softer(block),
        _damping(block),
        _slower(block),
        _faster(block, v_c),
        _gap(block),
        _normal_force(block),
        _lighter(block),
    )
    return Cures(_jump(block), v_c, found)


def _stiffer(p: Parameters) -> Cure:
    """Return the stiffer spring: its limit lies where v_c falls with k."""
    k, zeta = float(p.k), float(p.zeta)
    end, least = None, 0.0
    if zeta > 0.0:
        q = _quotient(p)
        # With the first order of lambda_c, sqrt(4 pi zeta), which is too low: (14).
        low = math.pi * q * q
        ratio = _root(lambda z: _part(z) - q, low, zeta)
        end = k * (zeta / ratio) ** 2
        least = _grazing_jump(replace(p, k=end)) / _jump(p)
    # Without damping four times the stiffness leaves a half at most.
    halve = _halved(p, lambda r: replace(p, k=k * r), end / k if end else 4.0, least)
    return Cure("stiffer", "k", k, None if halve is None else k * halve, end, least)


def _softer(p: Parameters) -> Cure:
    """Return the softer spring, which ends the cycle by strong damping of the slip."""
    k, zeta = float(p.k), float(p.zeta)
    end = None
    if zeta > 0.0:
        q = _quotient(p)
        ratio = _root(lambda z: _part(z) - q, zeta, 1.0)
        end = k * (zeta / ratio) ** 2
    return Cure("softer", "k", k, None, end, 1.0)


def _damping(p: Parameters) -> Cure:
    """Return more damping: lambda_c rises with zeta and reaches lambda at the limit."""
    lambda_ = float(p.lambda_)
    critical = 2.0 * math.sqrt(float(p.k) * float(p.m))
    # lambda_c is above sqrt(4 pi zeta).
    most = min(lambda_ * lambda_ / (4.0 * math.pi), 1.0)
    zeta = _root(lambda z: lambda_ - float(critical_lambda(z)), float(p.zeta), most)
    end = critical * zeta
    least = _grazing_jump(replace(p, c=end)) / _jump(p)
    return Cure("damping", "c", float(p.c), None, end, least)


def _slower(p: Parameters) -> Cure:
    """Return the slower pull: the jump falls towards Delta (1 + exp(-pi zeta/nu))."""
    v = float(p.v)
    nu = math.sqrt(1.0 - float(p.zeta) ** 2)
    least = float(p.Delta) * (1.0 + math.exp(-math.pi * float(p.zeta) / nu)) / _jump(p)
    halve = _halved(p, lambda r: replace(p, v=v * r), 0.0, least)
    return Cure("slower", "v", v, None if halve is None else v * halve, None, least)


def _faster(p: Parameters, v_c: float) -> Cure:
    v = float(p.v)
    return Cure("faster", "v", v, None, math.copysign(v_c, v) if v_c < math.inf else None, 1.0)


def _gap(p: Parameters) -> Cure:
    """Return the kinetic coefficient that leaves less of the gap."""
    mu_s, mu_k = float(p.mu_s), float(p.mu_k)
    halve, end, least = _smaller_gap(p, lambda r: replace(p, mu_k=mu_s - (mu_s - mu_k) * r))
    halve, end = (None if r is None else mu_s - (mu_s - mu_k) * r for r in (halve, end))
    return Cure("gap", "mu_k", mu_k, halve, end, least)


def _normal_force(p: Parameters) -> Cure:
    """Return the load that leaves less of the normal force; it may be a lift, below 0."""
    weight, N = float(p.m) * float(p.g), float(p.N)
    halve, end, least = _smaller_gap(p, lambda r: replace(p, load=N * r - weight))
    halve, end = (None if r is None else N * r - weight for r in (halve, end))
    return Cure("normal force", "load", float(p.load), halve, end, least)


def _smaller_gap(
    p: Parameters, changed: Callable[[float], Parameters]
) -> tuple[float | None, float | None, float]:
    """Return halving factor, limit and least jump where the gap of the forces shrinks in place."""
    lambda_, zeta = float(p.lambda_), float(p.zeta)
    if lambda_ == 0.0:
        return None, None, 1.0
    if zeta > 0.0:
        end = float(critical_lambda(zeta)) / lambda_
        least = abs(float(p.v)) / float(p.w) * _grazing_period(end * lambda_, zeta) / _jump(p)
        return _halved(p, changed, end, least), end, least
    # Without a gap an undamped block swings about the pull and touches rest: v t = 2 pi v/w.
    least = 2.0 * math.pi * abs(float(p.v)) / float(p.w) / _jump(p)
    return _halved(p, changed, 0.0, least), None, least


def _lighter(p: Parameters) -> Cure:
    """Return the smaller mass, the load held."""
    m, zeta, load = float(p.m), float(p.zeta), float(p.load)
    # A lift leaves no normal force at a mass above 0.
    lightest = max(-load / (float(p.g) * m), 0.0)
    end = None
    if zeta > 0.0:
        factor = _lightest_with_cycle(p, lightest)
        end = m * factor
        least = _grazing_jump(_with_mass(p, end)) / _jump(p)
        halve = _halved(p, lambda r: _with_mass(p, m * r), factor, least)
    else:
        # Towards m = 0 the slip takes no time; without normal force it is a swing.
        swing = 2.0 * math.pi * abs(float(p.v)) / float(p.w) * math.sqrt(lightest)
        relief = 2.0 * (float(p.mu_s) - float(p.mu_k)) * max(load, 0.0) / float(p.k)
        least = (relief + swing) / _jump(p)
        halve = _halved(p, lambda r: _with_mass(p, m * r), lightest, least)
    return Cure("lighter", "m", m, None if halve is None else m * halve, end, least)


def _lightest_with_cycle(p: Parameters, lightest: float) -> float:
    """Return the factor on the mass at which v_c first falls to the speed."""
    v, m, zeta = abs(float(p.v)), float(p.m), float(p.zeta)

    def excess(log_factor: float) -> float:
        v_c = float(coulomb_limit(_with_mass(p, m * math.exp(log_factor))))
        return math.log(v_c / v) if v_c > 0.0 else -math.inf

    dip = _factor_of_dip(p)
    if dip is not None and excess(math.log(dip)) < 0.0:
        return math.exp(_root(excess, 0.0, math.log(dip)))
    # At zeta = 1, or without normal force, there is no cycle.
    bottom = max(zeta * zeta, lightest)
    return math.exp(_root(excess, min(math.log(dip), 0.0) if dip else 0.0, math.log(bottom)))


def _with_mass(p: Parameters, m: float) -> Parameters:
    """Return the block with another mass; rounding must not lift it off the way."""
    return replace(p, m=m, load=max(float(p.load), -m * float(p.g)))


def _factor_of_dip(p: Parameters) -> float | None:
    """Return the factor on the mass, below 1, at which v_c has a minimum; None without one.

    There e(zeta) = 2/(1 + X), where e is the logarithmic slope of v_c c/Delta_F over zeta and X the
    load over the weight. As e falls with zeta, X rises from 3 to its first solution.
    """
    load, weight, zeta = float(p.load), float(p.m) * float(p.g), float(p.zeta)
    if not load > 0.0:
        return None
    X = 3.0
    for _ in range(_DIPS):
        factor = load / (weight * X)
        here = zeta / math.sqrt(factor)
        slope = _slope(here) if here < 1.0 else 0.0
        if slope <= 0.0:
            return None
        X = 2.0 / slope - 1.0
    return factor if factor < 1.0 else None


def _quotient(p: Parameters) -> float:
    """Return c |v|/Delta_F [-], which v_c c/Delta_F must reach for a cycle; docs/theory.md (14)."""
    return 2.0 * float(p.zeta) / float(p.lambda_)


def _part(zeta: float) -> float:
    """Return v_c c/Delta_F = 2 zeta/lambda_c(zeta) [-]; docs/theory.md (14)."""
    return 2.0 * zeta / float(critical_lambda(zeta)) if 0.0 < zeta < 1.0 else 0.0


def _slope(zeta: float) -> float:
    """Return the logarithmic slope of `_part` over zeta [-], from the derivatives of (13)."""
    nu = math.sqrt((1.0 - zeta) * (1.0 + zeta))
    L = float(critical_lambda(zeta))
    theta = math.atan2(nu * L, 1.0 - zeta * L)
    turn = 2.0 * math.pi - theta + math.sin(theta) * math.cos(theta)
    return 1.0 - zeta * turn * ((1.0 - zeta / L) ** 2 + (nu / L) ** 2) / nu**3


def _jump(p: Parameters) -> float:
    return abs(float(steady_cycle(p).delta_x))


def _grazing_jump(p: Parameters) -> float:
    """Return the jump [m] of a block at the limit of its cycle."""
    return abs(float(p.v)) / float(p.w) * _grazing_period(float(p.lambda_), float(p.zeta))


def _grazing_period(lambda_: float, zeta: float) -> float:
    """Return the period times w [-] at the limit, where the mass only touches rest; (13).

    There the slip lasts up to the minimum of the velocity, and the spring relief is Delta.
    """
    nu = math.sqrt((1.0 - zeta) * (1.0 + zeta))
    theta = math.atan2(nu * lambda_, 1.0 - zeta * lambda_)
    return lambda_ + (2.0 * math.pi - theta) / nu


def _halved(
    p: Parameters, changed: Callable[[float], Parameters], last: float, least: float
) -> float | None:
    """Return the factor on a parameter at which the jump is half of what it is.

    Parameters
    ----------
    p
        The block now.
    changed
        The block with the parameter times a factor.
    last
        Factor to which the cycle exists or its range goes; 0 stands for a range down to 0.
    least
        The jump there over the jump now [-].
    """
    if least > 0.5:
        return None
    whole = _jump(p)

    def excess(factor: float) -> float:
        part = _jump(changed(factor)) / whole
        # At the limit itself rounding decides whether there is a cycle.
        return math.log(2.0 * (least if math.isnan(part) else part))

    if last > 0.0:
        return _root(excess, 1.0, last)
    low = 0.25
    while excess(low) > 0.0:
        low *= 0.25
    return _root(excess, 1.0, low)


def _root(f: Callable[[float], float], a: float, b: float) -> float:
    """Return the zero between two points, or the one where rounding has put it."""
    f_a, f_b = f(a), f(b)
    if f_a * f_b > 0.0:
        return a if abs(f_a) < abs(f_b) else b

    def bounded(x: float) -> float:
        return max(min(f(x), 1e9), -1e9)

    return float(brentq(bounded, a, b, xtol=_XTOL, rtol=_RTOL, maxiter=400))
