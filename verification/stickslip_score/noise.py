"""Noise of a sampled signal, from how neighbouring samples scatter.

A third divided difference vanishes for a parabola, so that a motion which the samples resolve
leaves little in it, while independent noise leaves all of itself. Rest and creep leave nothing;
the quiet windows of a record are therefore those in stick, and they tell its noise.
"""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from stickslip_score.read import Floats

_LENGTH = 4
"""Third differences in a window: enough for a mean square, and short against a stick."""

_WINDOWS = 2000
"""Windows that are looked at, spread evenly over the record."""

_LEAST_WINDOWS = 3

_QUIET_PART, _QUARTILE_OF_NOISE, _OUTLIER = 0.25, 0.31, 8.0
"""Part of the windows taken for quiet at first; the mean square that this part of the windows of
independent noise stays below, of the noise's own; and the mean square, in units of the quiet
windows' mean, above which a window holds motion."""

_TURNS = (0.35, 0.95)
"""Share of neighbouring third differences of opposite sign in noise. Independent noise has
acos(-3/4)/pi = 0.77, a smooth motion hardly any, one that alternates from sample to sample 1."""

_SPREAD = 0.2
"""Least share of third differences that lie between a quarter and three quarters of the largest
twentieth. Gaussian noise has 0.48; the acceleration of a solver that chatters has two values, and
its differences three, of two sizes."""

_PAIRS = 20
"""Neighbouring differences below which signs tell nothing."""


def noise_of(t: Floats, s: Floats, digits: float, strides: Iterable[int] = (1,)) -> float:
    """Return the standard deviation of the noise of a signal, in its unit; 0 where none is seen.

    Parameters
    ----------
    t, s
        Times, increasing, and signal, shape (n,).
    digits
        How far the signal may be off for the digits of its samples: scatter of their size is the
        digits' and no noise.
    strides
        Each `stride`-th sample is looked at, for noise that neighbouring samples share.

    Notes
    -----
    Only what has the signs and sizes of noise is noise. Noise much smaller than what third
    differences hold of the motion, where the samples are coarse, is not seen.
    """
    return max(_noise_at(t[::stride], s[::stride], digits) for stride in strides)


def scatter_of(t: Floats, s: Floats) -> float:
    """Return the standard deviation of the scatter from sample to sample, whatever it comes from.

    NaN where the samples are too few.
    """
    d = _third_differences(t, s)
    return float(np.sqrt(np.mean(d[_quiet(d)] ** 2))) if len(d) >= _LEAST_WINDOWS else np.nan


def _noise_at(t: Floats, s: Floats, digits: float) -> float:
    d = _third_differences(t, s)
    if len(d) < _LEAST_WINDOWS:
        return 0.0
    quiet = d[_quiet(d)]
    sigma = float(np.sqrt(np.mean(quiet**2)))
    # Rounding alone scatters by 1/sqrt(3) of half a unit.
    if sigma <= 0.7 * digits:
        return 0.0
    seen = (quiet[:, 1:] != 0.0) & (quiet[:, :-1] != 0.0)
    if np.count_nonzero(seen) < _PAIRS:
        return 0.0
    turns = np.mean((quiet[:, 1:] * quiet[:, :-1])[seen] < 0.0)
    size = np.abs(quiet)
    large = np.quantile(size, 0.95)
    spread = np.mean((size > 0.25 * large) & (size < 0.75 * large))
    return sigma if _TURNS[0] < turns < _TURNS[1] and spread > _SPREAD else 0.0


def _third_differences(t: Floats, s: Floats) -> Floats:
    """Return third divided differences by window, each of the variance of the noise.

    Shape (windows, `_LENGTH`).
    """
    last = t.size - _LENGTH - 3
    if last < 0:
        return np.empty((0, _LENGTH))
    count = min(_WINDOWS, 1 + last // 2)
    starts = np.linspace(0, last, count).astype(np.int64)
    index = starts[:, None] + np.arange(_LENGTH + 3)
    at, value = t[index], s[index] - s[starts][:, None]
    nodes = np.stack([at[:, i : i + _LENGTH] for i in range(4)])
    apart = nodes[:, None] - nodes[None]
    apart[range(4), range(4)] = 1.0
    weights = 1.0 / np.prod(apart, axis=1)
    weights /= np.sqrt(np.sum(weights**2, axis=0))
    values = np.stack([value[:, i : i + _LENGTH] for i in range(4)])
    return np.asarray((weights * values).sum(axis=0))


def _quiet(d: Floats) -> NDArray[np.bool_]:
    """Return which windows hold no motion that stands out of the noise."""
    power = np.mean(d**2, axis=1)
    level = float(np.quantile(power, _QUIET_PART)) / _QUARTILE_OF_NOISE
    quiet = power <= _OUTLIER * level
    for _ in range(3):
        quiet = power <= _OUTLIER * float(np.mean(power[quiet]))
    return np.asarray(quiet)
