"""Base of friction laws with a stick: rest test, load-up, transitions. docs/theory.md (4), (6)."""

import math
from typing import Optional, Protocol, Tuple, Union

from ..settings import Settings
from .law import Arc, Motion, Start

# The rest test forgives rounding: 8 units in the last place of the forces it compares.
_SLACK = 8.0 * 2.0**-52


def direction_from_rest(spring: float, external: float, breakaway: float) -> int:
    """Return 0 if the mass stays at rest, or the sign of the slip that starts: (4).

    Parameters
    ----------
    spring, external
        Spring force k z and external force F_ext on the mass [N].
    breakaway
        Break-away force F_s [N].
    """
    force = spring + external
    slack = _SLACK * (abs(spring) + abs(external) + breakaway)
    if abs(force) <= breakaway + slack:
        return 0
    return 1 if force > 0.0 else -1


class StickArc:
    """The mass rests while the pulled end loads the spring up to a constant break-away force.

    Parameters
    ----------
    k
        Stiffness [N/m].
    v
        Pulling velocity [m/s].
    z
        Spring extension at the start [m].
    breakaway
        Break-away force F_s [N].
    external
        External force F_ext [N].
    way
        What the force still lacks of F_s in the direction of the pull [N], where a slip left it
        known better than as a difference; else None.
    age
        Time at rest before this arc [s].
    """

    def __init__(
        self,
        k: float,
        v: float,
        z: float,
        breakaway: float,
        external: float,
        way: Optional[float] = None,
        age: float = 0.0,
    ) -> None:
        self.k = k
        self.v = v
        self.z_start = z
        self.mode = 0
        self.x_dot_start = 0.0
        self.age = age
        self._way = way
        if v == 0.0:
            self.z_end = z
            self.duration = math.inf
        else:
            self.z_end = (math.copysign(breakaway, v) - external) / k
            growth = self.z_end - z if way is None else math.copysign(1.0, v) * way / k
            # A rest that rounding put beyond the threshold breaks away at once.
            self.duration = max(growth / v, 0.0)

    @property
    def start(self) -> Start:
        """Where the arc starts."""
        return Start(0, self.z_start, 0.0, self._way, self.age)

    def state(self, tau: float) -> Motion:
        """Return the motion at `tau`."""
        return self.v * tau, 0.0, 0.0, None

    def end(self) -> Motion:
        """Return the motion at the break-away."""
        return self.z_end - self.z_start, 0.0, 0.0, None

    def own(self, tau: float) -> Tuple[float, ...]:
        """Return the law's own state: none."""
        return ()

    def pull_work(self, tau: float) -> float:
        """Return the work of the pulling end up to `tau` [J]: (15)."""
        return self.k * (self.v * tau) * (self.z_start + 0.5 * self.v * tau)

    def heat(self, tau: float, displacement: float) -> float:
        """Return the heat of friction and damping up to `tau` [J]: none."""
        return 0.0

    def extreme_velocity(self, tau: float) -> float:
        """Return the velocity of the mass [m/s]: none."""
        return 0.0


class SlipOfSticking(Arc, Protocol):
    """A slip that a stick or a reversal follows."""

    v: float

    def way_to_break_away(self, gap: float) -> float:
        """Return what the force lacks of F_s at the end, in the direction of the slip [N]."""


class Sticking:
    """A law whose mass sticks up to a break-away force and slips until it comes to rest.

    A law states `F_s`, `kinetic` and `gap` and makes its slips; a law whose break-away force grows
    with the age of the stick overrides `growth`, `stick` and `varies` too.

    Parameters
    ----------
    settings
        The settings that hold.

    Attributes
    ----------
    F_s, kinetic
        Break-away force of a stick that has just begun, and kinetic friction at standstill [N].
    gap
        Their difference [N], known better than as a difference.
    """

    F_s: float
    kinetic: float
    gap: float
    age_start = 0.0
    varies = False

    def __init__(self, settings: Settings) -> None:
        self.settings = settings

    def hold(self, age: float) -> float:
        """Return the break-away force of a stick of this age [N]."""
        return self.F_s + self.growth(age)

    def growth(self, age: float) -> float:
        """Return what a stick of this age has gained in break-away force [N]."""
        return 0.0

    def begin(
        self, mode: int, z: float, x_dot: float, age: float = 0.0, own: Tuple[float, ...] = ()
    ) -> Arc:
        """Return the stick or slip that begins where the mass stands: (4)."""
        if mode != 0:
            return self.slip_from(mode, z, x_dot)
        settings = self.settings
        mode = direction_from_rest(settings.k * z, settings.F_ext, self.hold(age))
        return self.stick(z, None, age) if mode == 0 else self.slip_from(mode, z, 0.0)

    def after(self, arc: Union[StickArc, SlipOfSticking], z: float) -> Arc:
        """Return what follows a load-up, or a slip that ended at spring extension `z` [m]: (4)."""
        if isinstance(arc, StickArc):
            mode = 1 if arc.v > 0.0 else -1
            gap = self.gap + self.growth(arc.age + arc.duration)
            return self.slip(mode, arc.z_end, 0.0, mode * gap)
        settings = self.settings
        if direction_from_rest(settings.k * z, settings.F_ext, self.F_s) == -arc.mode:
            return self.slip_from(-arc.mode, z, 0.0)
        return self.stick(z, arc.way_to_break_away(self.gap) if arc.mode * arc.v > 0.0 else None)

    def arc(self, start: Start) -> Arc:
        """Return the stick or slip that starts so."""
        mode, z, x_dot, force, age, _ = start
        if mode == 0 or force is None:
            return self.stick(z, force, age)
        return self.slip(mode, z, x_dot, force)

    def slip_from(self, mode: int, z: float, x_dot: float) -> Arc:
        """Return the slip from any state."""
        settings = self.settings
        return self.slip(mode, z, x_dot, settings.k * z + settings.F_ext - mode * self.kinetic)

    def stick(self, z: float, way: Optional[float] = None, age: float = 0.0) -> StickArc:
        """Return the stick that starts so; `way` and `age` as of `StickArc`."""
        settings = self.settings
        return StickArc(settings.k, settings.v, z, self.F_s, settings.F_ext, way, age)

    def slip(self, mode: int, z: float, x_dot: float, net: float) -> Arc:
        """Return the slip that starts so, for the law to define.

        `net` is the force on the mass but for the damping: k z + F_ext - mode kinetic [N].
        """
        raise NotImplementedError
