"""The cycle meter: what the block says of its last stick, slip and cycle. docs/theory.md (16)."""

from typing import Any, Dict

from .compensated import CompensatedSum

# What an FMI Integer holds; the count of slips stays there.
MOST_SLIPS = 2**31 - 1


class CycleMeter:
    """Quantities of the last completed stick, slip and cycle.

    Break-away means stick to slip. Durations are added up arc by arc and never taken as
    differences of times, so they stay exact however long the run.

    Attributes
    ----------
    t_stick, t_slip, T
        Length of the last completed stick, slip, and between the last two break-aways [s].
    delta_x, spring_drop
        Displacement of the mass in the last completed slip, and fall of z over it [m], signed.
    x_dot_peak
        Velocity of largest magnitude in the last completed slip [m/s], signed.
    n_slips
        Completed slips, up to MOST_SLIPS.
    t_event
        Time of the last transition [s].
    """

    __slots__ = (
        "T",
        "_cycle",
        "_displacement",
        "_peak",
        "_phase",
        "_relief",
        "_seen_break_away",
        "delta_x",
        "n_slips",
        "spring_drop",
        "t_event",
        "t_slip",
        "t_stick",
        "x_dot_peak",
    )

    def __init__(self, start_time: float) -> None:
        self.delta_x = 0.0
        self.spring_drop = 0.0
        self.t_stick = 0.0
        self.t_slip = 0.0
        self.T = 0.0
        self.x_dot_peak = 0.0
        self.n_slips = 0
        self.t_event = start_time
        self._phase = CompensatedSum()
        self._cycle = CompensatedSum()
        self._seen_break_away = False
        self._peak = 0.0
        self._displacement = CompensatedSum()
        self._relief = CompensatedSum()

    @property
    def f(self) -> float:
        """Frequency of the last cycle [Hz], 0 before there is one."""
        return 1.0 / self.T if self.T > 0.0 else 0.0

    def pass_stick(self, duration: float) -> None:
        """Count `duration` [s] of rest."""
        self._phase.add(duration)
        self._cycle.add(duration)

    def pass_slip(
        self, duration: float, displacement: float, relief: float, extreme_velocity: float
    ) -> None:
        """Count `duration` [s] of slip with what it brought.

        Displacement of the mass and relief of the spring [m], extreme velocity [m/s].
        """
        self._phase.add(duration)
        self._cycle.add(duration)
        self._displacement.add(displacement)
        self._relief.add(relief)
        if abs(extreme_velocity) > abs(self._peak):
            self._peak = extreme_velocity

    def break_away(self, time: float) -> None:
        """Close the stick and open a slip at `time` [s]."""
        self.t_stick = self._phase.high
        if self._seen_break_away:
            self.T = self._cycle.high
        self._seen_break_away = True
        self._cycle.clear()
        self.t_event = time
        self._open_slip()

    def end_slip(self, time: float) -> None:
        """Close the slip at `time` [s]; the next phase follows."""
        self.t_slip = self._phase.high
        self.delta_x = self._displacement.high
        self.spring_drop = self._relief.high
        self.x_dot_peak = self._peak
        self.n_slips = min(self.n_slips + 1, MOST_SLIPS)
        self.t_event = time
        self._open_slip()

    def _open_slip(self) -> None:
        self._phase.clear()
        self._displacement.clear()
        self._relief.clear()
        self._peak = 0.0

    def copy(self) -> "CycleMeter":
        """Return a meter that shows the same and counts on by itself."""
        twin = CycleMeter(self.t_event)
        for name in self.__slots__:
            value = getattr(self, name)
            setattr(twin, name, value.copy() if isinstance(value, CompensatedSum) else value)
        return twin

    def save(self) -> Dict[str, Any]:
        """Return the whole meter as plain numbers and lists, for `restore`."""
        return {
            name: value.save() if isinstance(value, CompensatedSum) else value
            for name in self.__slots__
            for value in [getattr(self, name)]
        }

    def restore(self, saved: Dict[str, Any]) -> None:
        """Take up a meter that `save` returned."""
        for name in self.__slots__:
            value = getattr(self, name)
            if isinstance(value, CompensatedSum):
                value.restore(saved[name])
            else:
                setattr(self, name, saved[name])
