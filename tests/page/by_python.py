"""What Python says of a setting: closed forms in doubles, the motion in high precision."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from mpmath import mp, mpf

from stickslip_ref import (
    Cycle,
    FrictionClampWarning,
    Parameters,
    SimplifiedCycle,
    coulomb_limit,
    simplified,
    steady_cycle,
)
from stickslip_verification import truth
from tests.page.settings import Setting

DIGITS = 30
CYCLES = 3
WITHIN = (1e-6, 0.02, 0.31, 0.5, 0.77, 0.98, 1.0 - 1e-6)
"""Where in each slip and stick the states are compared: its inside, and close to either event."""


@dataclass(frozen=True)
class Expected:
    """What a page should show of one setting.

    Attributes
    ----------
    setting
        As it is typed.
    p
        The same for the reference, with the clamp.
    cycle, simplified, coulomb_limit
        Closed forms in doubles, by the reference.
    exact, exact_critical_velocity
        The cycle in high precision, None where there is none, and the critical velocity.
    distance
        lambda/lambda_c - 1 = v_c/v - 1 of these very doubles; infinite without damping, -1 where
        damping leaves no cycle at any speed.
    times, samples
        Times [s] and what every output is there, in high precision.
    events
        All transitions up to the last of the times, in high precision.
    """

    setting: Setting
    p: Parameters
    cycle: Cycle
    simplified: SimplifiedCycle
    coulomb_limit: float
    exact: Mapping[str, Any] | None
    exact_critical_velocity: Any
    distance: float
    times: Sequence[float]
    samples: Sequence[Mapping[str, Any]]
    events: Sequence[truth.Event]


def expected(setting: Setting) -> Expected:
    """Ask the reference and the truth."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FrictionClampWarning)
        p = Parameters(**setting)
    cycle = steady_cycle(p)
    v_c = exact_critical_velocity(setting, p)
    times = on_a_grid(instants(p, cycle))
    steps = [truth.Step(b - a) for a, b in pairwise([0.0, *times])]
    run = truth.run(setting, steps, digits=DIGITS)
    return Expected(
        setting=setting,
        p=p,
        cycle=cycle,
        simplified=simplified(p),
        coulomb_limit=float(coulomb_limit(p)),
        exact=truth.steady_cycle(setting, digits=DIGITS),
        exact_critical_velocity=v_c,
        distance=float(v_c / setting["v"] - 1),
        times=times,
        samples=run.samples,
        events=run.events,
    )


def instants(p: Parameters, cycle: Cycle) -> list[float]:
    """Give times [s] in the first load-up and in three cycles, or in a slip without end."""
    first = float(p.F_s / (p.k * p.v))
    phases = [(0.0, first)]
    if cycle.exists:
        for n in range(CYCLES):
            begin = first + n * float(cycle.T)
            phases.append((begin, float(cycle.t_slip)))
            phases.append((begin + float(cycle.t_slip), float(cycle.t_stick)))
    else:
        # Three turns, and three times the slower rate's time where damping is strong.
        phases.append((first, 3.0 * (2.0 * math.pi + 2.0 * float(p.zeta)) / float(p.w)))
    times = [begin + part * length for begin, length in phases for part in WITHIN if length > 0.0]
    # The run ends well inside a phase, where nobody can doubt which events it has had.
    return times[:-1]


def on_a_grid(times: Sequence[float]) -> list[float]:
    """Move the times to multiples of one unit, so that their differences are exact doubles."""
    unit = math.ulp(max(times))
    return [n * unit for n in sorted({round(t / unit) for t in times}) if n > 0]


def exact_critical_velocity(setting: Setting, p: Parameters) -> Any:
    """Give the speed [m/s] above which there is no cycle, of the setting as it is in doubles."""
    if p.c == 0.0:
        return mpf("inf")
    with mp.workdps(DIGITS + 10):
        k, m = (mpf(setting[name]) for name in "km")
        N = m * mpf(setting["g"]) + mpf(setting["load"])
        w = mp.sqrt(k / m)
        critical = truth.critical_lambda(mpf(setting["c"]) / (2 * m * w), digits=DIGITS)
        return w * (mpf(setting["mu_s"]) - mpf(float(p.mu_k_used))) * N / k / critical
