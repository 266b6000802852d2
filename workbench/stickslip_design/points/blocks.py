"""The steady motion of many blocks: jump, period, regime, and where it changes.

Coulomb's friction has closed forms (docs/theory.md (7) to (14)). Friction that falls with the speed
and friction that grows at rest are followed from event to event by the exact block: `slips`.
"""

from __future__ import annotations

import warnings
from contextlib import suppress
from functools import cache
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from fmi.table import Table
from stickslip_fmu.interface import table_of
from stickslip_fmu.laws.named import COULOMB_NAME, friction_law
from stickslip_ref import (
    FrictionClampWarning,
    Parameters,
    coulomb_limit,
    critical_velocity,
    steady_cycle,
)
from stickslip_ref import friction_law as reference_law

from . import dwelling, falling
from .columns import Floats, Regime
from .falling import CURVE, last_coefficient
from .slips import BESIDE, LEAST_STICK, Motion, Values, first_slips

WITHOUT_INFLUENCE: Final = ("F_ext", "x_start", "x_dot_start", "z_start", "age_start")
"""Parameters and inputs that the steady motion does not depend on."""


_LAWS: Final = (COULOMB_NAME, "stribeck", "lugre", "rate_state")
_WITH_MEMORY: Final = _LAWS[2:]


@cache
def table_of_law(law: str) -> Table:
    """Return the variable table of the block; ValueError for a friction law that has no map."""
    if law not in _LAWS:
        raise ValueError(f"{law!r} has no map; the friction laws with one: {', '.join(_LAWS)}")
    return table_of(friction_law(law).law.interface)


def block_points(
    values: Values, law: str = COULOMB_NAME, *, limit: bool = True
) -> dict[str, NDArray[Any]]:
    """Return the steady motion of many blocks under a built-in friction law.

    `values` are parameters and inputs of the block by name [SI]: numbers, and arrays that
    broadcast. What is not named has its start value; `WITHOUT_INFLUENCE` are not looked at. With
    `limit` the critical velocity is among the columns; `critical_speeds` says what it costs.

    Returns
    -------
    dict
        `columns.BLOCK` by name, of the common shape of the arrays, read-only. ``regime`` (int8) is
        a `Regime`, ``at_limit`` a bool. Where the mass never sticks ``delta_x`` and ``stick_share``
        are 0, and what has no value is NaN: also where, with friction that grows at rest, the mass
        sticks and the sticks do not settle to one length.

    Raises
    ------
    ValueError
        If a name is unknown or a value out of range, alone or together with others.
    """
    given = _checked(values, law)
    shape = np.broadcast_shapes(*(np.shape(each) for each in values.values()))
    motion = _coulomb(given) if has_closed_form(given, law) else _followed(given, law)
    columns = _columns(given, law, motion)
    if limit:
        without = {name: each for name, each in values.items() if name != "v"}
        columns["v_c"] = critical_speeds(without, law)
    return {name: np.broadcast_to(each, shape) for name, each in columns.items()}


def critical_speeds(values: Values, law: str = COULOMB_NAME) -> Floats:
    """Return the highest pulling velocities [m/s] at which a cycle with a stick exists.

    Arguments are as of `block_points`; ``v`` is of no influence. Infinite where stick-slip has no
    end, NaN under friction with a memory and where the search of `stickslip_ref.critical_velocity`
    fails. Closed under Coulomb's law with constant coefficients, else 10 to 100 ms a point.
    """
    given = _checked({**values, "v": 1.0}, law)
    if has_closed_form(given, law):
        return np.asarray(coulomb_limit(_parameters(given)))
    arrays = np.broadcast_arrays(*(np.asarray(each, float) for each in given.values()))
    found = np.full(arrays[0].shape, np.nan)
    if law in _WITH_MEMORY:
        # Seconds a point.
        return found
    friction = reference_law(law)
    for place in np.ndindex(found.shape):
        point = {name: float(each[place]) for name, each in zip(given, arrays, strict=True)}
        own = {name: point[name] for name in friction.parameters if name in point}
        with suppress(RuntimeError):
            limit = critical_velocity(_parameters(point), friction, own)
            # The search ends somewhere; a cycle that exists up to there has no end that is known.
            endless = limit.cycle and limit.highest >= limit.between[1]
            found[place] = np.inf if endless else limit.highest
    return found


def _checked(values: Values, law: str) -> dict[str, float | Floats]:
    """Return a value for everything that has influence."""
    table = table_of_law(law)
    start = table.start_values()
    for name, each in values.items():
        if name not in start:
            raise ValueError(f"{name!r} is no parameter or input of the block")
        if np.size(each) == 0:
            continue
        for extreme in (np.min(each), np.max(each)):
            objection = table.by_name[name].objection(float(extreme))
            if objection is not None:
                raise ValueError(objection)
    given = {**start, **values}
    found = {name: each for name, each in given.items() if name not in WITHOUT_INFLUENCE}
    return {**found, "mu_k": _parameters(found).mu_k_used} if "mu_k" in found else found


def has_closed_form(values: Values, law: str) -> bool:
    """Tell whether friction is Coulomb's and grows nowhere at rest: docs/theory.md (19)."""
    return law == COULOMB_NAME and not any(np.any(values.get(each, 0.0)) for each in ("tau_s", "B"))


def _parameters(given: Values) -> Parameters:
    """Return the values that all friction laws share as the reference takes them."""
    names = ("m", "g", "k", "c", "mu_s", "mu_k", "v", "load")
    with warnings.catch_warnings():
        # A map may cross the line where the two are equal.
        warnings.simplefilter("ignore", FrictionClampWarning)
        return Parameters(**{name: given[name] for name in names if name in given})


def _coulomb(given: Values) -> Motion:
    """Return the closed form, each quantity on the shape of what it depends on."""
    p = _parameters(given)
    cycle = steady_cycle(p)
    limit = np.asarray(coulomb_limit(_parameters({**given, "v": 1.0})))
    with np.errstate(divide="ignore", invalid="ignore"):
        at_limit = np.abs(np.abs(p.v) / limit - 1.0) <= BESIDE
    t_stick = np.asarray(cycle.t_stick)
    sticks = np.asarray(cycle.exists) & (t_stick * p.w >= LEAST_STICK)
    # Steady sliding under constant friction is stable, without damping neutrally.
    even = np.zeros((), bool)
    return Motion(sticks, t_stick, np.asarray(cycle.t_slip), even, np.asarray(at_limit))


def _followed(given: Values, law: str) -> Motion:
    """Return motions that are followed from event to event, of a list of blocks."""
    shape = np.broadcast_shapes(*(np.shape(each) for each in given.values()))
    flat = {
        name: np.broadcast_to(each, shape).ravel() if np.ndim(each) else float(each)
        for name, each in given.items()
    }
    # A pull backward is the mirror image of one forward.
    flat["v"] = np.broadcast_to(np.abs(given["v"]), shape).ravel()
    if law == COULOMB_NAME:
        found = dwelling.motion(flat)
    elif law in _WITH_MEMORY:
        slips = first_slips(flat, law)
        cycles = np.isfinite(slips.t_stick)
        swings, none = np.isfinite(slips.t_slip) & ~cycles, np.zeros(cycles.shape, bool)
        found = Motion(cycles, slips.t_stick, slips.t_slip, swings, none)
    else:
        v = np.abs(given["v"])
        others = [each for name, each in given.items() if name != "v"]
        # Whether v, and nothing else, changes along the last dimension.
        last = np.shape(v)[-1:] == shape[-1:] == (np.size(v),)
        last = last and not any(np.shape(each)[-1:] == shape[-1:] for each in others)
        row = v.size if last and np.all(np.diff(v.ravel()) > 0.0) else 1
        found = falling.motion(flat, law, row)
    return Motion(**{name: each.reshape(shape) for name, each in found._asdict().items()})


def _columns(given: Values, law: str, motion: Motion) -> dict[str, NDArray[Any]]:
    """Return the columns, each on the shape of what it depends on."""
    v = np.asarray(given["v"])
    nothing = np.where(motion.sticks, 0.0, np.nan)
    t_stick, t_slip = motion.t_stick + nothing, motion.t_slip + nothing
    T = t_stick + t_slip
    delta_x = np.where(motion.sticks, v * T, 0.0)
    regime = np.where(
        motion.sticks, Regime.STICKS, np.where(motion.swings, Regime.SWINGS, Regime.EVEN)
    )
    p = _parameters(given)
    mu_k = np.asarray(p.mu_k if "mu_k" in given else np.nan)
    if "shape" in given:
        # Of a measured curve that of its last point.
        mu_k = np.where(np.equal(given["shape"], CURVE), last_coefficient(given), mu_k)
    with np.errstate(divide="ignore", invalid="ignore"):
        simplified = np.copysign(2.0 * (p.mu_s - mu_k) * p.N / p.k, v)
        return {
            "delta_x": delta_x,
            "T": T,
            "f": 1.0 / T,
            "t_stick": t_stick,
            "t_slip": t_slip,
            "stick_share": np.where(motion.sticks, t_stick / T, 0.0),
            "regime": regime.astype(np.int8),
            "at_limit": motion.at_limit,
            "delta_x_simplified": simplified,
            "simplified_error": simplified / (v * T) - 1.0,
        }
