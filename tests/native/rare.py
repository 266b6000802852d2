"""Settings that random sequences do not draw, and moves: `compared` in bits.py."""

from math import nextafter
from typing import Any

# Forces are sums of few powers of 2, so that they balance to the bit.
_ROUND = {"m": 1.0, "g": 8.0, "k": 8.0, "mu_s": 0.5, "mu_k": 0.25}
_AGEING = _ROUND | {"B": 0.25, "t_0": 1.0}
_HYPERBOLIC = _ROUND | {"shape": 2}
_CURVE = _ROUND | {"shape": 3, "n_points": 2, "u_2": 0.125, "mu_1": 0.5, "mu_2": 0.25}
_STIFF = _CURVE | {"k": 8192.0, "v": 0.0625, "z_start": 3 / 8192}
_CREEP = {"k": 1e-300, "c": 1e20, "F_ext": 1e10, "v": -1.0, "x_dot_start": 1e-10}
_ABOVE, _BELOW = nextafter(0.125, 1.0), nextafter(0.125, 0.0)

RARE: dict[str, list[tuple[Any, ...]]] = {"coulomb": [
    # Beyond the numbers: rates, ageing, aged force, work, time to break away, time to stop.
    ({"k": 1e-200, "m": 1e200}, 1.0),
    ({"mu_s": 0.0, "B": 1e300, "g": 1e300}, 1.0),
    (_AGEING | {"g": 1.5e307, "mu_s": 1.0, "t_0": 1e-300}, 1.0),
    ({"g": 1e300, "k": 1e300, "mu_s": 1e5, "z_start": 1e5, "v": 0.0}, 1.0, {"k": 9e299}, 1.0),
    (_AGEING | {"v": 1e-310}, 1.0),
    (_CREEP, 1.0),
    # By a rounding: rest above break-away, pull slower than ageing, ageing, end before break-away.
    (_AGEING | {"v": 0.25, "z_start": nextafter(0.5, 1.0)}, 1.0),
    (_AGEING | {"v": nextafter(0.25, 0.0), "z_start": 0.5}, 10.0),
    (_ROUND | {"v": 0.1, "B": 0.1, "t_0": 3e16}, 1.0),
    (_ROUND | {"v": 0.25, "z_start": 0.4375}, 0.2, 0.25 - 0.2 - 2.0**-57, 1.0),
], "stribeck": [
    # Beyond the numbers: force, slope of a line, time to stop, slope and end of steady sliding.
    (_CURVE | {"g": 1e308, "mu_s": 1e3}, 1.0),
    (_CURVE | {"k": 1e-180, "u_2": 1e-149, "x_dot_start": 5e-150}, 1.0),
    (_CURVE | _CREEP, 1.0),
    *((_HYPERBOLIC | dict.fromkeys(("v_s", "v", "x_dot_start"), v) | {"k": k, "z_start": 3 / k},
       0.5) for v, k in ((2.0**-650, 8.0), (2.0**-1022, 2.0**-60))),
    # Starts at a point of the curve: slower, as it is, towards the pull, faster.
    *((_CURVE | {"x_dot_start": 0.125, "v": v, "z_start": z}, 0.5)
      for z, v in ((0.2, 0.2), (0.25, 0.125), (0.25, 0.2), (0.3, 0.2))),
    # On a falling line: steady, a swing that grows, no damping in all.
    (_STIFF | {"x_dot_start": 0.0625}, 100.0, {"v": 0.06}, 1.0),
    (_STIFF | {"x_dot_start": 0.0625, "z_start": nextafter(3 / 8192, 1.0)}, 100.0),
    (_STIFF | {"x_dot_start": 0.0625001}, 5.0),
    (_STIFF | {"c": 16.0, "x_dot_start": 0.03125}, 0.5, 10.0),
    # By a rounding: a pull above a line's end, changes before the end of a slip.
    (_STIFF | {"c": 32.0, "v": _ABOVE, "x_dot_start": _BELOW, "z_start": 6 / 8192}, 20.0),
    (_CURVE | {"v": -0.2, "z_start": 0.51, "c": 20.0}, 0.09357888806990373, {"v": -0.3}, 0.1),
    ({"k": 1922.6, "shape": 2, "v_s": 0.3, "v": 0.3, "z_start": 0.00281},
     0.13025902050735005, 1.9081958235744875e-17, {"k": 1000.0}, 1.0),
    # A speed that dips to 0.02 mm/s and rises.
    ({"k": 3844.0, "delta": 3.0, "v_s": 0.03, "v": 0.1, "x_dot_start": 0.027, "z_start": 8.6e-4},
     0.5),
    # Near the least numbers: pull at an exponent of 1.5, slip from rest, way of a slip.
    (_ROUND | {"delta": 1.5, "v": 1e-310, "z_start": 0.5}, 0.5),
    (_HYPERBOLIC | {"g": 8e-304, "v_s": 1.5e-306, "v": 3e-306, "z_start": 5e-305}, 0.5),
    (_HYPERBOLIC | dict.fromkeys(("v_s", "x_dot_start"), 0.125)
     | {"v": 0.0, "c": 2.0**400, "F_ext": 2.0**397}, 0.5),
]}  # fmt: skip
