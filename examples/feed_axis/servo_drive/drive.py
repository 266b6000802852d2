"""The drive's inertia, moved by the controller's force against the spring force of the table.

The simulator lets both sides step over the same interval, each with what the other gave at its
start. A drive that held the spring force over its step, and gave its speed of now for the next
one, would lag by a whole step: forward Euler, which feeds energy into the oscillation of drive
and table. So this one

- follows the spring within its step: of `F = k (x_pull - x)` it knows its own end and k, and lets
  the table go on as it went in the last step;
- gives as output the mean speed of the step to come: a copy of it, controller and all, goes one
  step ahead.

The output is integrated as the block integrates it, and what one prediction missed the next output
makes good, so that pulled end and motor never drift apart.
"""

from __future__ import annotations

import math

from .controller import Controller

# Terms of the Taylor series of a speed, and how long a sample may be for them, in units of 1 / r
# (`objection`). Since |v^(n)| <= C r^(n-1), with C the larger of |v'| and |v''| / r, what is left
# out over a time h is below C h (r h)^12 / 13! / (1 - r h / 14) = 4.1e-14 C h at r h = 0.5.
_TERMS = 12
_LONGEST = 0.5


def inertia_at_slide(J: float, pitch: float) -> float:
    """Return the inertia [kg] that J [kg.m2] is at the slide, with `pitch` [m] a turn.

    It is J (2 pi / pitch)^2, docs/feed-axis.md (1); 0 or infinity where no double holds it.
    """
    per_metre = 2.0 * math.pi / pitch
    return J * per_metre * per_metre


def objection(m_d: float, d: float, k: float, T_s: float) -> str | None:
    """Return why the motion cannot be told over a sample, with name, value and range; else None.

    Parameters
    ----------
    m_d, d, k, T_s
        As of `Drive`.

    Notes
    -----
    Between samples m_d v'' + d v' + k v is constant, so from one derivative to the next v grows
    by r = delta + sqrt(delta^2 + k/m_d) at most, with delta = d / (2 m_d): the root of
    r^2 = 2 delta r + k/m_d.
    """
    if not 0.0 < m_d < math.inf:
        return f"m_d = {m_d!r} kg is out of range: J (2 pi / pitch)^2 must be finite, above 0"
    delta = 0.5 * d / m_d
    r = delta + math.hypot(delta, math.sqrt(k / m_d))
    if r * T_s <= _LONGEST:
        return None
    return (
        f"T_s = {T_s!r} s is out of range: it must be at most {_LONGEST / r:.3g} s "
        f"with k = {k:g} N/m, d = {d:g} N.s/m and m_d = {m_d:.4g} kg"
    )


# The numbers that the motion goes on from, beside those of the controller.
_MEMORY = (
    *("x", "v", "F_motor", "output", "_time", "_samples"),
    *("_x_pull", "_seen", "_seen_at", "_speed", "_last_step"),
)


class Drive:
    """The drive; SI units, positions and forces at the slide.

    Parameters
    ----------
    m_d
        Inertia of the drive, seen at the slide [kg].
    d
        Viscous friction of the drive [N.s/m].
    k
        Stiffness of the spring that it pulls [N/m]; 0: the spring force is held over a step.
    T_s
        Sample time of the controller [s].
    controller
        The controller, sampled at 0, T_s, 2 T_s, ...

    Raises
    ------
    ValueError
        If T_s is too long for its motion; the message names values and range.
    """

    def __init__(self, m_d: float, d: float, k: float, T_s: float, controller: Controller) -> None:
        refused = objection(m_d, d, k, T_s)
        if refused is not None:
            raise ValueError(refused)
        self._m_d, self._d, self._k, self._T_s = m_d, d, k, T_s
        self._controller = controller
        self.x = 0.0
        self.v = 0.0
        self.F_motor = 0.0
        self.output = 0.0
        self._time = 0.0
        self._samples = 0
        # Where the block has its pulled end; where and when the table was seen last.
        self._x_pull = 0.0
        self._seen = self._seen_at = self._speed = 0.0
        self._last_step = 0.0
        # The shortest time [s] over which a difference of positions says a speed.
        self._shortest = 1e-3 * T_s

    @property
    def memory(self) -> tuple[float, ...]:
        """Everything that the next step depends on, the controller's memory included."""
        return (*(getattr(self, name) for name in _MEMORY), *self._controller.memory)

    @memory.setter
    def memory(self, memory: tuple[float, ...]) -> None:
        *motion, integral, error, last_motor = memory
        for position, name in enumerate(_MEMORY):
            setattr(self, name, motion[position])
        self._controller.memory = integral, error, last_motor

    def advance(self, h: float, F: float, table: float) -> None:
        """Go one communication step.

        Parameters
        ----------
        h
            Its length [s].
        F, table
            Spring force [N] and position of the table [m] at its start.
        """
        speed = self._speed_of(table)
        # The force that belongs to the pulled end at 0.
        at_zero = F - self._k * self._x_pull
        self._run(h, at_zero, table, speed)
        self._x_pull += h * self.output
        # The step to come is taken to be as long as the longer of the last two: after the
        # short rest that ends a row of steps, a whole one follows.
        length = max(h, self._last_step, self._shortest)
        self._last_step = h
        x, here = self.x, self._state()
        self._run(length, at_zero - self._k * speed * h, table + speed * h, speed)
        coming = (self.x - x) / length
        self._restore(here)
        missed = x - self._x_pull
        self.output = coming + missed / max(length, 0.25 * self._T_s)

    def _speed_of(self, table: float) -> float:
        """Return how fast the table went in the last step [m/s], given where it is [m]."""
        passed = self._time - self._seen_at
        # Over a shorter time it would be the rounding of a position.
        if passed > self._shortest:
            self._speed = (table - self._seen) / passed
            self._seen, self._seen_at = table, self._time
        return self._speed

    def _run(self, h: float, at_zero: float, table: float, speed: float) -> None:
        """Go on by h [s], with the table at `table` [m] and moving at `speed` [m/s]."""
        # A sample that falls on the end, to rounding, belongs to the next step.
        slack = 1e-6 * self._T_s
        start, end = self._time, self._time + h
        while True:
            due = self._samples * self._T_s
            if due <= self._time + slack:
                at = table + speed * (self._time - start)
                self.F_motor = self._controller.sample(due, self.x, at)
                self._samples += 1
                continue
            stop = due if due < end - slack else end
            passed = self._time - start
            self._move(stop - self._time, at_zero - self._k * speed * passed, speed)
            self._time = stop
            if stop == end:
                return

    def _move(self, h: float, at_zero: float, speed: float) -> None:
        """Solve m_d dv/dt = F_motor - F - d v over h [s], T_s at most, by its Taylor series."""
        force = self.F_motor - at_zero - self._k * self.x - self._d * self.v
        derivative = force / self._m_d
        following = (self._k * (speed - self.v) - self._d * derivative) / self._m_d
        x, v = self.x + h * self.v, self.v
        power = h
        for order in range(2, _TERMS + 2):
            v += power * derivative
            power *= h / order
            x += power * derivative
            derivative, following = (
                following,
                -(self._k * derivative + self._d * following) / self._m_d,
            )
        self.x, self.v = x, v

    def _state(self) -> tuple[object, ...]:
        motion = (self.x, self.v, self.F_motor, self._time, self._samples)
        return (*motion, self._controller.memory)

    def _restore(self, state: tuple[object, ...]) -> None:
        (
            self.x,
            self.v,
            self.F_motor,
            self._time,
            self._samples,
            self._controller.memory,
        ) = state  # type: ignore[assignment]
