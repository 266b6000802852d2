"""What was given with a curve, held against its size: the way of the pull, and units."""

import math
from collections.abc import Mapping

import numpy as np

from stickslip_score.read import Curve, CurveError, Floats
from stickslip_score.words import force, length, speed

_SURE = 0.25
"""Part of the way of the pulled end, and of the friction force, from which on a sign is one."""

_NEAR = 4.0
"""Factor about a power of 1000 within which a unit is the likeliest reason."""

_LIKELY = {
    1e3: "x in mm or t in ks",
    1e6: "x in um",
    1e9: "x in nm",
    1e-3: "t in ms or x in km",
    1e-6: "t in us",
}
_FORCES = {1e3: "mN", 1e-3: "kN", 1e-6: "MN"}
"""What a column may be in whose numbers are this factor too large."""


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
    """Refuse x or F whose size is a power of 1000 off: their unit is not the one that was read.

    Raises
    ------
    CurveError
        The message names the sizes and the units that are likely meant.
    """
    if exact is None or curve.t[-1] - curve.t[0] < 1.5 * exact["period"]:
        return
    if curve.x is not None:
        seen = abs(_advance(curve.x)) / _last_less_first(curve.t)
        if power := _power(seen / abs(p["v"])):
            raise CurveError(
                f"x advances at {speed(seen)} on average, {power:g} times the v of "
                f"{speed(abs(p['v']))}: {_LIKELY[power]}? State the unit in the header or with the "
                "column's name, 'x [mm]'"
            )
    elif curve.F is not None:
        # The way of the mass in a slip is the spring's and a little more.
        seen, due = float(np.ptp(curve.F)), p["k"] * exact["delta_x"]
        if power := _power(seen / due):
            raise CurveError(
                f"F varies by {force(seen)}, {power:g} times about what a jump of "
                f"{length(exact['delta_x'])} does at this k: is F in {_FORCES.get(power, 'N')}? "
                "State the unit in the header or with the column's name, 'F [kN]'"
            )


def _power(ratio: float) -> float:
    """Return the power of 1000, other than 1, that a ratio is near to; 0 where it is none."""
    return next((power for power in _LIKELY if power / _NEAR < ratio < power * _NEAR), 0.0)


def _advance(x: Floats) -> float:
    """Return the way from the first tenth of the samples to the last, over nine tenths of them."""
    tenth = max(x.size // 10, 1)
    return float(np.mean(x[-tenth:]) - np.mean(x[:tenth])) / (1.0 - tenth / x.size)


def _last_less_first(t: Floats) -> float:
    return float(t[-1] - t[0])
