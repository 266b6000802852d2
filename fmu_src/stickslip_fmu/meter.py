"""The cycle meter: quantities of the last stick, slip and cycle. docs/theory.md (16)."""

from .numerics.compensated import ZERO, Sum, add
from .record import Record

# What an FMI Integer holds; the count of slips stays there.
MOST_SLIPS = 2**31 - 1


class CycleMeter(Record):
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

    T: float
    _cycle: Sum
    _displacement: Sum
    _peak: float
    _phase: Sum
    _relief: Sum
    _seen_break_away: bool
    delta_x: float
    n_slips: int
    spring_drop: float
    t_event: float
    t_slip: float
    t_stick: float
    x_dot_peak: float

    def __init__(self, start_time: float) -> None:
        self.delta_x = 0.0
        self.spring_drop = 0.0
        self.t_stick = 0.0
        self.t_slip = 0.0
        self.T = 0.0
        self.x_dot_peak = 0.0
        self.n_slips = 0
        self.t_event = start_time
        self._phase = ZERO
        self._cycle = ZERO
        self._seen_break_away = False
        self._peak = 0.0
        self._displacement = ZERO
        self._relief = ZERO

    @property
    def f(self) -> float:
        """Frequency of the last cycle [Hz], 0 before there is one."""
        return 1.0 / self.T if self.T > 0.0 else 0.0

    def pass_stick(self, duration: float) -> None:
        """Count `duration` [s] of rest."""
        self._phase = add(self._phase, duration)
        self._cycle = add(self._cycle, duration)

    def pass_slip(
        self, duration: float, displacement: float, relief: float, extreme_velocity: float
    ) -> None:
        """Count `duration` [s] of slip with what it brought.

        Displacement of the mass and relief of the spring [m], extreme velocity [m/s].
        """
        self._phase = add(self._phase, duration)
        self._cycle = add(self._cycle, duration)
        self._displacement = add(self._displacement, displacement)
        self._relief = add(self._relief, relief)
        if abs(extreme_velocity) > abs(self._peak):
            self._peak = extreme_velocity

    def break_away(self, time: float) -> None:
        """Close the stick and open a slip at `time` [s]."""
        self.t_stick = self._phase[0]
        if self._seen_break_away:
            self.T = self._cycle[0]
        self._seen_break_away = True
        self._cycle = ZERO
        self.t_event = time
        self._open_slip()

    def end_slip(self, time: float) -> None:
        """Close the slip at `time` [s]; the next phase follows."""
        self.t_slip = self._phase[0]
        self.delta_x = self._displacement[0]
        self.spring_drop = self._relief[0]
        self.x_dot_peak = self._peak
        self.n_slips = min(self.n_slips + 1, MOST_SLIPS)
        self.t_event = time
        self._open_slip()

    def _open_slip(self) -> None:
        self._phase = ZERO
        self._displacement = ZERO
        self._relief = ZERO
        self._peak = 0.0
