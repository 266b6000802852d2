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

from .controller import Controller
from .motion import Inertia, Place, Pull, objection

# The numbers that the motion goes on from, beside those of the controller.
_MEMORY = (
    *("x", "v", "F_motor", "output", "_time", "_samples"),
    *("_x_pull", "_seen", "_seen_at", "_speed", "_last_step"),
    *("_command", "_acted"),
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
    lag
        Time constant of the current loop [s]; 0: the motor's force is the command at once.
    dead_time
        Time from a sample to when its command acts [s].
    dry
        Dry friction of motor and nut [N].

    Raises
    ------
    ValueError
        If T_s is too long for its motion; the message names values and range.
    """

    def __init__(
        self,
        m_d: float,
        d: float,
        k: float,
        T_s: float,
        controller: Controller,
        lag: float = 0.0,
        dead_time: float = 0.0,
        dry: float = 0.0,
    ) -> None:
        refused = objection(m_d, d, k, T_s)
        if refused is not None:
            raise ValueError(refused)
        self._k, self._T_s, self._lag, self._dead_time = k, T_s, lag, dead_time
        self._inertia = Inertia(m_d, d, k, lag, dry)
        self._controller = controller
        self.x = 0.0
        self.v = 0.0
        self.F_motor = 0.0
        self.output = 0.0
        self._time = 0.0
        # Samples taken; commands that have acted, the last of them, and the newest commands.
        self._samples = self._acted = 0
        self._command = 0.0
        self._waiting = (0.0,) * (int(dead_time / T_s) + 2)
        # Where the block has its pulled end; where and when the table was seen last.
        self._x_pull = 0.0
        self._seen = self._seen_at = self._speed = 0.0
        self._last_step = 0.0
        # The shortest time [s] over which a difference of positions says a speed.
        self._shortest = 1e-3 * T_s

    @property
    def memory(self) -> tuple[float, ...]:
        """Everything that the next step depends on, the controller's memory included."""
        motion = (getattr(self, name) for name in _MEMORY)
        return (*motion, *self._waiting, *self._controller.memory)

    @memory.setter
    def memory(self, memory: tuple[float, ...]) -> None:
        for position, name in enumerate(_MEMORY):
            setattr(self, name, memory[position])
        rest = len(_MEMORY) + len(self._waiting)
        self._waiting = memory[len(_MEMORY) : rest]
        self._controller.memory = memory[rest:]

    def advance(self, h: float, F: float, table: float, second: float = 0.0) -> None:
        """Go one communication step.

        Parameters
        ----------
        h
            Its length [s].
        F, table
            Spring force [N] and position of the table [m] at its start.
        second
            Spring force of a second table [N].
        """
        F += second
        # Of two tables the springs tell where both are on average.
        speed = self._speed_of(self._x_pull - F / self._k if second and self._k else table)
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
        # A sample, or a command, that falls on the end, to rounding, belongs to the next step.
        slack = 1e-6 * self._T_s
        start, end = self._time, self._time + h
        while True:
            due = self._samples * self._T_s
            if due <= self._time + slack:
                at = table + speed * (self._time - start)
                force = self._controller.sample(due, self.x, at)
                self._waiting = (*self._waiting[1:], force)
                self._samples += 1
                continue
            acts = self._acted * self._T_s + self._dead_time
            if acts <= self._time + slack:
                self._command = self._waiting[self._acted - self._samples]
                self._acted += 1
                if self._lag <= 0.0:
                    self.F_motor = self._command
                continue
            due = min(due, acts)
            stop = due if due < end - slack else end
            passed = self._time - start
            pull = Pull(self._command, at_zero - self._k * speed * passed, speed)
            place = Place(self.x, self.v, self.F_motor)
            self.x, self.v, self.F_motor = self._inertia.moved(stop - self._time, place, pull)
            self._time = stop
            if stop == end:
                return

    def _state(self) -> tuple[object, ...]:
        motion = (self.x, self.v, self.F_motor, self._time, self._samples)
        return (*motion, self._command, self._acted, self._waiting, self._controller.memory)

    def _restore(self, state: tuple[object, ...]) -> None:
        (
            self.x,
            self.v,
            self.F_motor,
            self._time,
            self._samples,
            self._command,
            self._acted,
            self._waiting,
            self._controller.memory,
        ) = state  # type: ignore[assignment]
