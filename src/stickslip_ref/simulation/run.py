"""A run of the block: parameters and changes in, trajectory out."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import ArrayLike

from ..laws import COULOMB, FrictionLaw, friction_law
from ..parameters import Parameters
from ..trajectory import Trajectory
from .inputs import Change, segments
from .meter import Reading, measured_cycles, readings
from .motion import Motion
from .sampling import Sampler

RTOL = 3e-14
"""Default tolerance of a step: near the least that SciPy takes; a slip then costs 2 to 3 ms."""

_LEAST_RTOL = 100.0 * float(np.finfo(float).eps)
"""SciPy's own limit, below which it would warn and take this one."""

_LARGEST_RTOL = 1e-3

_METER = ("delta_x", "spring_drop", "x_dot_peak", "t_stick", "t_slip", "T", "f", "t_event")


def simulate(
    p: Parameters,
    stop_time: float,
    *,
    start_time: float = 0.0,
    changes: Iterable[Change] = (),
    times: ArrayLike | None = None,
    rtol: float = RTOL,
    law: FrictionLaw | str = COULOMB,
    own: Mapping[str, float] | None = None,
    max_events: int = 1_000_000,
) -> Trajectory:
    """Simulate the block with SciPy; docs/theory.md (1), (3) to (5), (15), (16).

    Stick is linear and evaluated as such. Each slip is an initial value problem of its own
    (`scipy.integrate.solve_ivp`, DOP853, in scaled variables) with its events.

    Parameters
    ----------
    p : Parameters
        Parameters, inputs and initial state; numbers, not arrays.
    stop_time, start_time : float
        End and beginning of the run [s].
    changes : iterable of Change, optional
        New values of inputs and tunable parameters, each acting from its time on.
    times : array, shape (n,), optional
        Sample times [s], not decreasing, within the run. Default: the events, 1000 equal
        intervals of the run and 32 of each slip.
    rtol : float, optional
        Relative tolerance of an integration step, 2.3e-14 to 1e-3.
    law : FrictionLaw or str, optional
        The friction law, or its name as `friction_law` takes it; Coulomb's by default.
    own : mapping of str to float, optional
        Values of the law's own parameters by name, SI; what is missing takes the law's start value.
    max_events : int, optional
        How many events to allow.

    Returns
    -------
    Trajectory
        Samples, events and measured cycles.

    Raises
    ------
    ValueError
        If ``p`` holds arrays, a time or tolerance is out of range, a change is not allowed, or the
        law or one of its own parameters is not usable.
    RuntimeError
        If there are more than ``max_events`` events, more than 100 at one time, the integration of
        a slip fails, or the mass slips faster than the friction law holds; the message gives the
        numbers and the reason.

    Notes
    -----
    A slip is not lost however shallow the crossing of x_dot = 0 at its end: its turning points are
    located and tested (docs/theory.md (5)). With the default tolerance and without damping T,
    delta_x and x_dot_peak of a cycle are right to 3e-13 mu_s / (mu_s - mu_k) (measured: below
    4e-14 of it), t_slip to (1 + 1 / lambda), t_stick and spring_drop to (1 + 1 / lambda^2) times
    that; near lambda_c each to 1 / sqrt(lambda / lambda_c - 1) times more; docs/theory.md (17).
    A law without a stick (LuGre, rate and state) is integrated whole, by LSODA or Radau, anew from
    each reversal and each extreme of the spring; events and cycles are right to 1e-9 of their
    scale. Bristles with hardly any damping are followed swing by swing, however long.
    From a damping ratio of 30 on slips are integrated by an implicit method (Radau), to about
    1e-11.
    """
    _check_run(p, start_time, stop_time, rtol)
    law = friction_law(law) if isinstance(law, str) else law
    parts = segments(law.complete(p, own or {}), changes, start_time, stop_time, law)
    sampler = Sampler(parts[0].p, law, start_time, stop_time, times)
    motion = Motion(parts[0].p, law, start_time, rtol, max_events)
    for number, part in enumerate(parts):
        if number:
            motion.change(part.p)
        for arc in motion.arcs(part):
            sampler.take(arc)
    return _trajectory(motion, sampler, start_time)


def _check_run(p: Parameters, start_time: float, stop_time: float, rtol: float) -> None:
    if p.shape:
        raise ValueError(
            f"simulate takes one set of parameters, but the fields broadcast to {p.shape}; "
            "call it once per point"
        )
    for name, time in (("start_time", start_time), ("stop_time", stop_time)):
        if not math.isfinite(time):
            raise ValueError(f"{name} = {time!r} s is out of range; it must be finite")
    if stop_time < start_time:
        raise ValueError(
            f"stop_time = {stop_time!r} s is out of range; it must be >= start_time = "
            f"{start_time!r} s"
        )
    if not _LEAST_RTOL <= rtol <= _LARGEST_RTOL:
        raise ValueError(
            f"rtol = {rtol!r} is out of range; it must be from {_LEAST_RTOL:.2g} to {_LARGEST_RTOL}"
        )


def _trajectory(motion: Motion, sampler: Sampler, start_time: float) -> Trajectory:
    columns = sampler.columns()
    elapsed = columns.pop("elapsed")
    which = columns.pop("n_events").astype(np.int64)
    mode = columns.pop("mode").astype(np.int64)
    own = {name: columns.pop(name) for name in sampler.own}
    shown = readings(motion.phases, start_time)
    meter = {name: _column(shown, name)[which] for name in _METER}
    n_slips = np.array([reading.n_slips for reading in shown], dtype=np.int64)[which]
    return Trajectory(
        t=start_time + elapsed if sampler.t is None else sampler.t,
        mode=mode,
        n_slips=n_slips,
        events=tuple(motion.events),
        cycles=measured_cycles(motion.phases, shown),
        own=own,
        **columns,
        **meter,
    )


def _column(shown: list[Reading], name: str) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return np.array([getattr(reading, name) for reading in shown], dtype=np.float64)
