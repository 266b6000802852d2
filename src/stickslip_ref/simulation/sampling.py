"""Samples of a motion: at given times, or at the events and on a fine grid."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..laws import FrictionLaw
from ..parameters import Parameters
from .motion import Arc, shown_mode
from .slip import Samples

Floats = NDArray[np.float64]

RUN_INTERVALS = 1000
"""Intervals of the default grid over a run."""

SLIP_INTERVALS = 32
"""Intervals of the default grid over each slip; a stick is straight and needs none."""

COLUMNS = (
    *("elapsed", "x", "x_dot", "x_pull", "z", "F", "F_friction", "F_s", "mode", "mu_k_used"),
    *("W_pull", "W_k", "W_ext", "Q_friction", "n_events"),
)


class Sampler:
    """Collects samples arc by arc; docs/theory.md (1), (15).

    Parameters
    ----------
    p : Parameters
        At the start of the run.
    law : FrictionLaw
        The friction law, for the force it exerts.
    start_time, stop_time : float
        The run [s].
    times : array, shape (n,), or None
        Sample times [s], not decreasing, within the run; None for the default grid.

    Raises
    ------
    ValueError
        If ``times`` is not one-dimensional, decreases or leaves the run.
    """

    def __init__(
        self,
        p: Parameters,
        law: FrictionLaw,
        start_time: float,
        stop_time: float,
        times: ArrayLike | None,
    ) -> None:
        self._law = law
        self.own = tuple(law.shown(p, np.empty(0), np.empty((len(law.state_start(p)), 0))))
        """Names of the law's own outputs."""
        self._given = times is not None
        if times is None:
            wanted = np.linspace(0.0, stop_time - start_time, RUN_INTERVALS + 1)
            self.t: Floats | None = None
        else:
            self.t = np.array(times, dtype=np.float64)
            _check_times(self.t, start_time, stop_time)
            wanted = self.t - start_time
        self._wanted = wanted
        self._taken = 0
        self._last = -1.0
        self._tables: list[Floats] = []

    def take(self, arc: Arc) -> None:
        """Sample an arc from its beginning on.

        Its end belongs to it if it is closed, and if it is a stick: a stick ends when time passes
        its end, a slip when time reaches it; docs/theory.md (4).
        """
        side: Literal["left", "right"] = "right" if arc.closed or arc.mode == 0 else "left"
        upto = int(np.searchsorted(self._wanted, arc.end, side=side))
        elapsed = self._wanted[self._taken : upto]
        self._taken = max(upto, self._taken)
        if not self._given:
            elapsed = self._refined(elapsed, arc)
        if elapsed.size:
            self._tables.append(self._table(arc, elapsed))

    def columns(self) -> dict[str, Floats]:
        """Return what was sampled, by name."""
        names = (*COLUMNS, *self.own)
        table = np.concatenate([np.empty((len(names), 0)), *self._tables], axis=1)
        return dict(zip(names, table, strict=True))

    def _refined(self, elapsed: Floats, arc: Arc) -> Floats:
        own = np.linspace(arc.begin, arc.end, (SLIP_INTERVALS if arc.mode else 1) + 1)
        points = np.union1d(elapsed, own if arc.closed else own[:-1])
        points = points[points > self._last]
        if points.size:
            self._last = points[-1]
        return points

    def _table(self, arc: Arc, elapsed: Floats) -> Floats:
        p, account = arc.p, arc.account
        k, v, F_ext = float(p.k), float(p.v), float(p.F_ext)
        # At the end of the arc its own duration counts, which the difference may miss by rounding.
        local = np.where(
            elapsed < arc.end, np.clip(elapsed - arc.begin, 0.0, arc.duration), arc.duration
        )
        motion = arc.sample(local)
        z = arc.z - motion.relief
        step = np.zeros_like(local) if arc.mode == 0 else v * local + motion.relief
        x = arc.x + step
        # Subtracted from 0.0, no force at all is 0.0 and not -0.0.
        friction = 0.0 - (k * z + F_ext if arc.mode == 0 else self._resistance(arc, motion))
        rows = (
            *(elapsed, x, motion.x_dot, x + z, z, k * z, friction),
            self._hold(arc, local, motion),
            shown_mode(p, motion.x_dot) if arc.mode is None else arc.mode,
            self._law.mu_k_used(p),
            account.W_pull + k * v * motion.integral_z,
            account.W_k,
            account.W_ext + F_ext * step,
            account.Q_friction + motion.heat,
            arc.n_events,
            *self._law.shown(p, motion.x_dot, motion.state).values(),
        )
        return np.stack([np.broadcast_to(np.asarray(row, float), elapsed.shape) for row in rows])

    def _hold(self, arc: Arc, local: Floats, motion: Samples) -> Floats | float:
        """Return the break-away force [N], in slip that of a stick at age 0."""
        law, sticks = self._law, arc.mode == 0
        if not (sticks and law.ages(arc.p)) and not motion.state.size:
            return law.break_away_force(arc.p, arc.age)
        ages = arc.age + local if sticks else np.zeros_like(local)
        states = motion.state.T.tolist() if motion.state.size else [()] * local.size
        return np.array(
            [
                law.break_away_force(arc.p, age, tuple(state))
                for age, state in zip(ages.tolist(), states, strict=True)
            ]
        )

    def _resistance(self, arc: Arc, motion: Samples) -> Floats:
        """Return friction and damping of the moving mass [N], along x."""
        law, x_dot = self._law, motion.x_dot
        if law.constant_in_slip:
            dry = np.full_like(x_dot, law.slip_friction(arc.p, 0.0))
        else:
            speeds = (x_dot if arc.mode is None else np.abs(x_dot)).tolist()
            states = motion.state.T.tolist() if motion.state.size else [()] * len(speeds)
            dry = np.array(
                [
                    law.slip_friction(arc.p, speed, tuple(state))
                    for speed, state in zip(speeds, states, strict=True)
                ]
            )
        return (1 if arc.mode is None else arc.mode) * dry + float(arc.p.c) * x_dot


def _check_times(times: Floats, start_time: float, stop_time: float) -> None:
    if times.ndim != 1:
        raise ValueError(f"times has the shape {times.shape}; it must be one-dimensional")
    if not np.all(np.diff(times) >= 0.0):
        where = int(np.argmin(np.diff(times) >= 0.0)) + 1
        raise ValueError(
            f"times[{where}] = {float(times[where])!r} s is less than the sample time before it; "
            "sample times must not decrease"
        )
    if times.size and not (times[0] >= start_time and times[-1] <= stop_time):
        raise ValueError(
            f"times from {float(times[0])!r} to {float(times[-1])!r} s are out of range; "
            f"they must lie within the run, {start_time!r} to {stop_time!r} s"
        )
