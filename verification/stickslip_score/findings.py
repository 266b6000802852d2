"""What is worth saying of a curve beside its cause."""

import math

import numpy as np

from stickslip_score.evidence import Evidence
from stickslip_score.slide import rests_of
from stickslip_score.words import force, length, speed, time


def findings(e: Evidence) -> list[str]:
    """Return what else was seen, one sentence each."""
    found = []
    if e.exact is None:
        found.append("no steady cycle exists at these parameters")
    if not e.measured.cycles:
        found.append("the curve shows no complete cycle, from one break-away to the next")
    elif e.measured.cycles == 1:
        found.append("the figures come from one cycle only")
    if e.exact is not None:
        step = float(np.max(np.diff(e.motion.t)))
        if 2.0 * step > e.exact["t_slip"]:
            doubt = ": is t in ms?" if step > e.exact["period"] else ""
            found.append(
                f"coarse samples: up to {time(step)} apart, where a slip takes "
                f"{time(e.exact['t_slip'])}{doubt}"
            )
    if e.motion.drift:
        found.append(
            f"F drifts by {force(e.motion.drift)} against k (v t - x): the zero of its sensor, or "
            "k or v a little off"
        )
    found += [
        f"{name} has a noise of {unit(size)} rms"
        for name, size, unit in (
            ("x", e.motion.noises.get("x", 0.0), length),
            ("F", e.p["k"] * e.motion.noises.get("F", 0.0), force),
        )
        if size
    ]
    if e.motion.shared and e.motion.noise:
        found.append("x and F share their noise: one was made from the other")
    if e.motion.x_dot is not None:
        found += _moving_at_rest(e)
    return found


def _rests(e: Evidence) -> list[tuple[float, float]]:
    """Return begin and end of each rest that is beyond doubt [s]."""
    t = e.motion.t
    if math.isinf(e.law.t_slip):
        rest = rests_of(e.motion)[0]
        window = rest.window(e.motion, e.law)
        return [(float(t[0]), float(t[-1]) if window is None else window[0])]
    return [
        (
            float(t[0]) if stick.begin is None else stick.begin.high,
            float(t[-1]) if stick.end is None else stick.end.low,
        )
        for stick in e.phases.sticks
        if stick.rests
    ]


def _moving_at_rest(e: Evidence) -> list[str]:
    """Tell of a velocity column that is not 0 where the position rests."""
    t, x_dot = e.motion.t, e.motion.x_dot
    assert x_dot is not None
    inner = np.zeros(t.size, dtype=bool)
    for begin, end in _rests(e):
        inner |= (t > begin) & (t < end)
    if not inner.any():
        return []
    moving = float(np.median(np.abs(x_dot[inner])))
    if moving <= 1e-6 * e.law.v + 2.0 * e.motion.x_dot_allowed:
        return []
    return [f"the velocity column shows {speed(moving)} where the position rests"]
