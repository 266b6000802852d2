"""The protocol of a friction law: the questions of the block, and the rules for the answers."""

from typing import Any, NamedTuple, Optional, Protocol, Tuple

from ..interface import Own
from ..settings import Settings

Motion = Tuple[float, float, float, Optional[float]]
"""At a time along an arc: growth of the spring [m], velocity [m/s] and displacement [m] of the
mass, friction on the mass with its viscous part [N]; None where friction balances spring and
external force, that is at rest."""


class Start(NamedTuple):
    """Where an arc starts. With the settings it determines the arc.

    Attributes
    ----------
    mode
        -1 slips backward, 0 sticks, +1 slips forward.
    z
        Spring extension [m].
    x_dot
        Velocity of the mass [m/s].
    force
        A force [N] that the law knows here better than as a difference of large forces, or None.
    age
        Time that the mass has been at rest before [s], 0 in a slip.
    own
        The law's own state, such as the deflection of bristles; empty where the law has none.
    """

    mode: int
    z: float
    x_dot: float
    force: Optional[float] = None
    age: float = 0.0
    own: Tuple[float, ...] = ()


class Arc(Protocol):
    """The motion from one event or change of settings to the next event.

    Methods take the time `tau` since the start of the arc [s], 0 to `duration`. An arc is made
    once and then only read: states share it.

    Attributes
    ----------
    mode
        -1 slips backward, 0 sticks, +1 slips forward.
    duration
        Length of the arc [s], infinity where it has no end.
    z_start, x_dot_start
        Spring extension [m] and velocity of the mass [m/s] at the start.
    age
        Time that the mass has been at rest at the start [s], 0 in a slip.
    start
        From which `Friction.arc` makes the same arc again.
    """

    mode: int
    duration: float
    z_start: float
    x_dot_start: float
    age: float

    @property
    def start(self) -> Start: ...  # noqa: D102 - an attribute above

    def state(self, tau: float) -> Motion:
        """Return the motion at `tau`."""

    def end(self) -> Motion:
        """Return the motion at `duration`, with what is known there exactly."""

    def own(self, tau: float) -> Tuple[float, ...]:
        """Return the law's own state at `tau`."""

    def pull_work(self, tau: float) -> float:
        """Return the work of the pulling end up to `tau` [J]."""

    def heat(self, tau: float, displacement: float) -> float:
        """Return the heat of friction and damping up to `tau` [J], for its displacement [m]."""

    def extreme_velocity(self, tau: float) -> float:
        """Return the velocity of largest magnitude up to `tau` [m/s]; asked in slips only."""


class Friction(Protocol):
    """A friction law under given settings; the block makes one at every change of a setting.

    Attributes
    ----------
    F_s
        Break-away force of a stick that has just begun [N].
    age_start
        Age of a mass that is at rest when the run starts [s].
    varies
        Whether break-away force or own state change along an arc. Where False, the block takes
        `F_s` for all ages and does not ask for `own` at every output.
    """

    F_s: float
    age_start: float
    varies: bool

    def hold(self, age: float) -> float:
        """Return the break-away force of a stick of this age [N]."""

    def begin(
        self, mode: int, z: float, x_dot: float, age: float = 0.0, own: Tuple[float, ...] = ()
    ) -> Arc:
        """Return the arc that begins where the mass stands.

        Parameters
        ----------
        mode
            Mode of the motion so far, 0 for a mass at rest: a law with a stick applies the rest
            test (4) then.
        z, x_dot
            Spring extension [m] and velocity of the mass [m/s].
        age
            Time that the mass has been at rest [s].
        own
            The law's own state; empty at the start of a run.
        """

    def after(self, arc: Any, z: float) -> Arc:
        """Return the arc that follows the end of `arc`, at spring extension `z` [m].

        `arc` was made by this law, maybe under other settings with the same slip terms.
        """

    def arc(self, start: Start) -> Arc:
        """Return the arc that starts so: the same bits as the arc that `start` was read from."""

    def slip_terms(self) -> Tuple[float, ...]:
        """Return what the equation of slip is made of, beside mass and direction."""


class Law(Protocol):
    """A friction law.

    An implementer does the following:

    1. Name the model, and the law's parameters and outputs as rows of the table: `interface.Own`.
    2. Answer for given settings, as `Friction` asks: what a stick of a given age holds; where the
       mass stands at rest or in motion, which arc begins; which arc follows the end of an arc.
       `sticking.Sticking` answers for every law whose mass sticks, breaks away at a force and
       comes to rest; such a law states its forces and makes its arcs.
    3. Give the arcs, as `Arc` asks. A stick says how long it lasts. A slip says when it ends and
       gives its state, work and heat at any time. A slip may be a chain of arcs in the same
       direction: `after` then returns the mode of the arc that ended. A law without a stick
       describes its motion whole in such arcs; mode 0 is what it calls sticking.
    4. Keep a state of its own, if it has one, in `Start.own` and `Arc.own`. It is saved and
       restored with the block's state.

    An implementer may assume

    5. that settings are constant along an arc, and that arcs are passed in the order of time;
    6. that an arc is asked up to its duration and not beyond;
    7. that the block has checked each value against the bounds of its row.

    An implementer leaves alone

    8. the meter: the block reports a break-away where an arc of mode 0 is followed by one of
       another mode, and the end of a slip where the mode of a slip changes;
    9. the sums of displacement, work and heat, which the block adds up arc by arc;
    10. the faces, the steps of the simulator, and any object that was made before: all are shared.
    """

    @property
    def interface(self) -> Own:
        """What the law adds to the interface of the block."""

    def warning(self, settings: Settings) -> Optional[str]:
        """Return what is unusual about these settings, or None."""

    def under(self, settings: Settings, before: Optional[Friction] = None) -> Friction:
        """Return the law under these settings; `before` is what held until now, to take over from.

        Raises ModelError if the settings are beyond their range together.
        """
