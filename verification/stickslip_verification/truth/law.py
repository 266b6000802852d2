"""The contract of a friction law in the truth."""

from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from typing import Protocol

from .march import Friction, March, NearRest
from .parameters import Context, Number, Numbers, Parameter, used_mu_k
from .series import Series


class Slip(Protocol):
    """What a run asks of a slip; all times count from its start. See `March` for each of these."""

    speed: Number
    duration: Number | None
    end_acceleration: Number | None

    def reach(self, t: Number) -> None:
        """Follow the slip up to the time `t` [s], or to its end if that is earlier."""

    def stays(self, changed: Numbers, t: Number) -> bool:
        """Return whether the slip under way at `t` is the same with `changed` numbers."""

    def decision(self, t: Number) -> Number | None:
        """Return how clearly the slip has ended or gone on up to `t`; None if nothing decided."""

    def motion(self, t: Number) -> tuple[Number, Number]:
        """Return speed s x_dot [m/s] and distance s (x - x_0) [m] at `t`."""

    def dry_friction(self, t: Number) -> Number:
        """Return the friction [N] against the slip at `t`, viscous damping not included."""

    def state(self, t: Number) -> tuple[Number, ...]:
        """Return the friction law's own state at `t`."""

    def work_and_heat(self, t: Number, speed: Number, distance: Number) -> tuple[Number, Number]:
        """Return work done by the pulled end and heat [J] from the start to `t`."""

    def top_speed(self, t: Number) -> Number:
        """Return the largest speed [m/s] between the start and `t`."""


class FrictionLaw:
    """Base class of a friction law of the truth.

    To add a law, subclass `FrictionLaw` and give `run` an object of the subclass, or a dotted name
    that `friction_law` resolves to it. Nothing else is registered anywhere. ``n`` is always a
    `Numbers`: the parameters in force as exact numbers, the law's own in ``n.own``. Forces are in
    newtons. Results carry the digits that `run` was asked for if the law computes with the numbers
    it is given and with integers only, never with floats.

    A law brings:

    1. Its own parameters in `parameters`, rows as those of the model's own table.
    2. The break-away force, `hold`, given the age of the stick as a series. If it depends on the
       age under the numbers in force, `ages` says so; it must then be a non-decreasing, concave
       function of the age. At age 0 it is at least the friction at speed 0. A stick that the run
       begins with may have an age already: `age_start`.
    3. The friction in slip, `kinetic`: from the series of the speed the series of the friction, an
       analytic function of the speed. It is written as an expression in ``speed`` with the
       operations of `Series`. Instead, a law with a closed form returns a `Slip` of its own from
       `slip`, and from `kinetic` the friction at the value of the series. Where the friction has
       corners, `knots` names their speeds and `kinetic_between` is the expression between two.
       Where it changes from rest as a power of the speed that is not whole, `near_rest` says so.
    4. If it has state variables of its own: their values at the start of a run, `state_start`;
       the series of their rates in slip, `rates`; and their values after a time at rest, `rested`.
    5. Where the mass never sticks: ``sticks = False``. Then `hold` shows as the output F_s only,
       ``speed`` is the signed velocity and `kinetic` the signed friction, analytic through 0 if
       that is no knot. A maximum of the spring counts as break-away, a minimum as re-stick. The
       mode is the sign of the velocity, 0 below an own parameter ``v_stick``. `rates_between` are
       the rates between knots, `changed` is the state after a change, `started` velocity and state
       of a law whose `velocity` follows from the state, `stored` the energy that is no heat yet,
       `shown` what the law shows of its state.

    A law may assume:

    6. Inputs and parameters are constant along an arc. After a change `rested` starts anew from
       the state at the change, and the age of a stick goes on.
    7. The speed is >= 0 in `kinetic` and `rates` of a law with a stick.

    A law must leave alone:

    8. The viscous damping c, the spring and F_ext: the march adds them.
    9. Events, meter, energies and outputs. The law's methods have no side effect.
    """

    parameters: Sequence[Parameter] = ()
    """The law's own parameters."""

    sticks: bool = True
    """Whether the mass can stick."""

    lacks: Sequence[str] = ()
    """Variables of the block that the law has not."""

    digits: int = 50
    """Decimal digits of the runs of the suite; fewer where a slip is marched in hundreds of pieces.
    """

    def check(self, values: Mapping[str, float]) -> None:
        """Raise a ValueError with name, value and range if the values do not go together.

        All parameters of a run, each within its own bounds; any are taken by default.
        """

    def mu_k_used(self, n: Numbers) -> Number | None:
        """Return what the output mu_k_used shows [1]; mu_k after the clamp by default.

        None: there is no such output.
        """
        return n.mu_k

    def coefficient(self, values: Mapping[str, float]) -> float:
        """Return what `mu_k_used` returns [1], in doubles, from all parameters of a run."""
        return used_mu_k(values["mu_s"], values["mu_k"])

    def spread(self, values: Mapping[str, float]) -> float:
        """Return mu_s less the least coefficient in slip [1]: what the relief of a slip comes from.

        From all parameters of a run; mu_s - mu_k after the clamp by default.
        """
        return values["mu_s"] - self.coefficient(values)

    def ages(self, n: Numbers) -> bool:
        """Return whether the break-away force depends on the age of the stick; not by default."""
        return False

    def age_start(self, n: Numbers) -> Number:
        """Return the age [s] of a stick that the run begins with; 0 by default."""
        return 0

    def hold(self, n: Numbers, age: Series, state: Sequence[Number]) -> Series | Number:
        """Return the break-away force [N] at an age of the stick [s]; mu_s N by default."""
        return n.F_s

    def kinetic(self, n: Numbers, speed: Series, state: Sequence[Series]) -> Series:
        """Return the dry friction [N] on a mass that slips at ``speed`` [m/s].

        By default that of the band that the value of the speed is in.
        """
        if type(self).kinetic_between is FrictionLaw.kinetic_between:
            raise NotImplementedError(f"{type(self).__name__} does not say its friction in slip")
        band = bisect_right(self.knots(speed.context, n), speed.term(0))
        return self.kinetic_between(n, band, speed, state)

    def knots(self, context: Context, n: Numbers) -> Sequence[Number]:
        """Return the rising speeds > 0 [m/s] of the corners of the friction; none by default."""
        return ()

    def kinetic_between(
        self, n: Numbers, band: int, speed: Series, state: Sequence[Series]
    ) -> Series:
        """Return the dry friction [N] in band 0, 1, ... between two knots, and a little beyond."""
        return self.kinetic(n, speed, state)

    def near_rest(self, n: Numbers) -> NearRest | None:
        """Return how the friction changes from rest where it has no Taylor series at speed 0."""
        return None

    def gap(self, n: Numbers, hold: Number, sliding: Number) -> Number:
        """Return ``hold - sliding`` [N], exactly 0 where a law makes the two forces equal."""
        return hold - sliding

    def state_start(self, n: Numbers) -> tuple[Number, ...]:
        """Return the own state at the start of a run; none by default."""
        return ()

    def rates(self, n: Numbers, speed: Series, state: Sequence[Series]) -> Sequence[Series]:
        """Return the rates [1/s] of the own state at ``speed`` [m/s]; none by default."""
        return ()

    def rates_between(
        self, n: Numbers, band: int, speed: Series, state: Sequence[Series]
    ) -> Sequence[Series]:
        """Return the rates [1/s] in band 0, 1, ... between two knots; `rates` by default."""
        return self.rates(n, speed, state)

    def changed(self, before: Numbers, n: Numbers, state: tuple[Number, ...]) -> tuple[Number, ...]:
        """Return the own state after a change from ``before`` to ``n``; unchanged by default."""
        return state

    def started(
        self, context: Context, n: Numbers, force: Number, speed: Number, state: tuple[Number, ...]
    ) -> tuple[Number, tuple[Number, ...]]:
        """Return velocity and own state with which the motion goes on under k z + F_ext [N]."""
        return speed, state

    def velocity(self, context: Context, n: Numbers) -> Callable[[Sequence[Series]], Series] | None:
        """Return what gives the velocity [m/s] from the own state; None: the mass has inertia."""
        return None

    def stored(self, n: Numbers, state: Sequence[Number]) -> Number:
        """Return the energy [J] that the own state holds; none by default."""
        return 0

    def shown(
        self, context: Context, n: Numbers, x_dot: Number, state: Sequence[Number]
    ) -> dict[str, Number]:
        """Return the law's own outputs by name; none by default."""
        return {}

    def rested(self, n: Numbers, duration: Number, state: tuple[Number, ...]) -> tuple[Number, ...]:
        """Return the own state after ``duration`` [s] at rest; unchanged by default."""
        return state

    def slip(
        self,
        context: Context,
        n: Numbers,
        direction: int,
        speed: Number,
        acceleration: Number,
        state: tuple[Number, ...],
    ) -> Slip:
        """Return the slip that starts at ``speed`` [m/s] with s x_ddot = ``acceleration`` [m/s2].

        By default it is marched by Taylor series.
        """
        friction = Friction(
            force=lambda u, own, band: self.kinetic_between(n, band, u, own),
            rates=lambda u, own, band: self.rates_between(n, band, u, own),
            signed=not self.sticks,
            knots=self.knots(context, n),
            velocity=self.velocity(context, n),
            near_rest=self.near_rest(n),
        )
        return March(context, n, friction, direction, speed, acceleration, state)
