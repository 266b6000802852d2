"""What was given with a curve, held against its size: the way of the pull, and units."""

import math
from collections.abc import Mapping

import numpy as np

from stickslip_score.curve import Curve, CurveError, Floats
from stickslip_score.words import speed

_SURE = 0.25
"""Part of the way of the pulled end, and of the friction force, from which on a sign is one."""

_NEAR = 2.0
"""Factor about a power of 1000 within which a unit is the likeliest reason."""


def pulled_as(curve: Curve, p: Mapping[str, float]) -> float:
    """Return v [m/s] with the sign with which the curve shows the pull; as given where none shows.

    The mass advances with the pulled end, and the spring drags it forward.
    """
    v = p["v"]
    if curve.x is not None:
        way, due = _advance(curve.x), v * _last_less_first(curve.t)
    elif curve.F is not None:
        way = float(np.mean(curve.F)) + p["F_ext"]
        due = math.copysign(p["mu_s"] * max(p["m"] * p["g"] + p["load"], 0.0), v)
    else:
        return v
    return -v if way * due < 0.0 and abs(way) > _SURE * abs(due) else v


def check_units(curve: Curve, p: Mapping[str, float], exact: Mapping[str, float] | None) -> None:
    """Refuse a position that advances a power of 1000 faster or slower than the pulled end.

    Raises
    ------
    CurveError
        The message names the speeds and the units that are likely meant.
    """
    if curve.x is None or exact is None or curve.t[-1] - curve.t[0] < 1.5 * exact["period"]:
        return
    seen = abs(_advance(curve.x)) / _last_less_first(curve.t)
    due = abs(p["v"])
    for power, likely in (
        (1e3, "x in mm or t in ks"),
        (1e6, "x in um"),
        (1e9, "x in nm"),
        (1e-3, "t in ms or x in km"),
        (1e-6, "t in us"),
    ):
        if power / _NEAR < seen / due < power * _NEAR:
            raise CurveError(
                f"x advances at {speed(seen)} on average, {power:g} times the v of {speed(due)}: "
                f"{likely}? State the unit in the header or with the column's name, 'x [mm]'"
            )


def _advance(x: Floats) -> float:
    """Return the way from the first tenth of the samples to the last, over nine tenths of them."""
    tenth = max(x.size // 10, 1)
    return float(np.mean(x[-tenth:]) - np.mean(x[:tenth])) / (1.0 - tenth / x.size)


def _last_less_first(t: Floats) -> float:
    return float(t[-1] - t[0])
