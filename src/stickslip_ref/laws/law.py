"""The contract of a friction law: what the simulation asks of it, and nothing else.

docs/theory.md (1), (4).
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..parameters import Bound, Parameters, checked

Floats: TypeAlias = NDArray[np.float64]

State: TypeAlias = tuple[float, ...]
"""Values of a law's own state variables, in the order and the units that the law chooses."""

NO_STATE: State = ()


@dataclass(frozen=True)
class OwnParameter:
    """A parameter that a friction law has beyond the twelve of `Parameters`.

    Attributes
    ----------
    start : float
        Its value where none is given.
    bound : Bound
        Its unit and lower bound.
    tunable : bool
        Whether a `Change` may set it during a run.
    """

    start: float
    bound: Bound
    tunable: bool = True


class FrictionLaw(ABC):
    """Base class of a friction law.

    To add a law, subclass `FrictionLaw` and give `simulate` an object of the subclass, or a dotted
    name that `friction_law` resolves to it. Nothing else is registered anywhere. ``p`` is always a
    `Parameters` of numbers that `complete` has returned. Forces are in newtons.

    A law brings:

    1. Its own parameters in `parameters`, by name. Their values are in ``p.own``; `complete` checks
       them against their bounds. A condition on several values at once is checked in an override
       of `complete`, which raises a `ValueError` with name, value and range.
    2. The break-away force, `break_away_force`, given the age of the stick. If it depends on the
       age under the parameters in force, `ages` says so; it must then be a non-decreasing, concave
       function of the age. At age 0 it is at least the friction at speed 0,
       ``slip_friction(p, 0.0)``. Where their difference is known better than that, `excess` gives
       it. A stick that the run begins with may have an age already: `age_start`.
    3. The friction in slip, `slip_friction`: a magnitude, smooth in the speed. If it is the same
       at every speed, set ``constant_in_slip = True``, which saves evaluations; such a law has no
       own state.
    4. If it has state variables of its own (say the age of the contacts): their values at the
       start of a run, `state_start`; their sizes for the integration's tolerance, `state_scale`;
       their rates in slip, `rates`; and their values after a time at rest, `rested`.
    5. Where the mass never sticks (LuGre, rate and state): ``sticks = False``. Then
       `break_away_force` shows as the output F_s only, and `slip_friction` and `rates` take the
       signed velocity; `slip_friction` returns the signed friction, which opposes a motion along
       +x where it is positive. Both may have a corner at velocity 0. The motion is integrated
       whole, and a maximum of the spring counts as break-away, a minimum as re-stick. The mode of
       a sample is the sign of its velocity, 0 below an own parameter ``v_stick``. `resolution`
       says down to which velocity it is followed, or `coordinate`, `velocity` and
       `coordinate_rate` take something better in its place, such as its logarithm. `changed` is
       the state after a change, `velocity_from` the velocity of a law without inertia, `stored`
       the energy that is no heat yet, `shown` what the law shows of its state.

    A law may assume:

    6. Inputs and parameters are constant along an arc. After a change `rested` starts anew from
       the state at the change, and the age of a stick goes on.
    7. The speed is >= 0 in `slip_friction` and `rates` of a law with a stick.

    A law must leave alone:

    8. The viscous damping ``c``, the spring and F_ext: the simulation adds them.
    9. Events, meter, energies and samples. The law's methods have no side effect, since the
       integrator evaluates trial states.
    """

    parameters: Mapping[str, OwnParameter] = MappingProxyType({})
    """The law's own parameters by name."""

    constant_in_slip: bool = False
    """Whether `slip_friction` is the same at every speed."""

    sticks: bool = True
    """Whether the mass can stick."""

    @abstractmethod
    def break_away_force(self, p: Parameters, age: float = 0.0, state: State = NO_STATE) -> float:
        """Return the largest force [N] that friction holds at rest.

        Parameters
        ----------
        p : Parameters
            Numbers only.
        age : float
            Time [s] since the stick began; 0 in slip, `age_start` at the start of a run.
        state : tuple of float
            The law's own state at that age.
        """

    def mu_k_used(self, p: Parameters) -> float:
        """Return what the output mu_k_used shows [-]; mu_k after the clamp by default."""
        return float(p.mu_k_used)

    @abstractmethod
    def slip_friction(self, p: Parameters, speed: float, state: State = NO_STATE) -> float:
        """Return the dry friction [N] on a mass that slips at ``speed`` [m/s]."""

    def ages(self, p: Parameters) -> bool:
        """Return whether the break-away force depends on the age of the stick; not by default."""
        return False

    def age_start(self, p: Parameters) -> float:
        """Return the age [s] of a stick that the run begins with; 0 by default."""
        return 0.0

    def excess(self, p: Parameters, age: float = 0.0, state: State = NO_STATE) -> float:
        """Return by how much [N] break-away exceeds the friction at speed 0; their difference."""
        return self.break_away_force(p, age, state) - self.slip_friction(p, 0.0, state)

    def knots(self, p: Parameters) -> tuple[float, ...]:
        """Return the speeds [m/s] > 0, rising, at which `slip_friction` has a corner; none."""
        return ()

    def speeds(self, p: Parameters) -> tuple[float, ...]:
        """Return speeds [m/s] > 0 over which the friction changes, beside `knots`; none."""
        return ()

    def slope(self, p: Parameters, speed: float) -> float:
        """Return the rate of `slip_friction` with the speed [N.s/m], by default by a difference.

        Its error is some 1e-10 of the friction over the speed.
        """
        reach = 1e-5 * speed
        above = self.slip_friction(p, speed + reach)
        return (above - self.slip_friction(p, speed - reach)) / (2.0 * reach)

    def friction_at(self, p: Parameters, speeds: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return `slip_friction` [N] at many speeds [m/s]."""
        forces = [self.slip_friction(p, speed) for speed in speeds.ravel().tolist()]
        return np.array(forces, dtype=np.float64).reshape(speeds.shape)

    def state_start(self, p: Parameters) -> State:
        """Return the own state at the start of a run; none by default."""
        return NO_STATE

    def state_scale(self, p: Parameters) -> State:
        """Return a typical size > 0 of each own state variable; required with `state_start`."""
        return NO_STATE

    def rates(self, p: Parameters, speed: float, state: State) -> State:
        """Return the rates [1/s] of the own state at ``speed`` [m/s]; none by default."""
        return NO_STATE

    def rested(self, p: Parameters, duration: float, state: State) -> State:
        """Return the own state after ``duration`` [s] at rest; unchanged by default."""
        return state

    def changed(self, before: Parameters, p: Parameters, state: State) -> State:
        """Return the own state after a change from ``before`` to ``p``; unchanged by default."""
        return state

    def velocity_from(self, p: Parameters, z: float, x_dot: float, state: State) -> float:
        """Return with which velocity [m/s] the motion goes on from there; ``x_dot`` by default."""
        return x_dot

    def method(self, p: Parameters) -> str:
        """Return SciPy's method for a law without a stick, "LSODA" or "Radau"."""
        return "Radau"

    def logarithmic(self, p: Parameters) -> bool:
        """Return whether the `coordinate` is a logarithm, of a size of 1; not by default."""
        return False

    def resolution(self, p: Parameters) -> float:
        """Return the velocity [m/s] that counts as none; rounding of the motion's by default."""
        return 0.0

    def longest_step(self, p: Parameters) -> float:
        """Return how long [s] a step may be while the mass creeps, by default as it likes."""
        return math.inf

    def coordinate(self, p: Parameters, x_dot: float, state: State) -> float:
        """Return what is integrated in place of the velocity, with its sign; it by default."""
        return x_dot

    def velocity(self, p: Parameters, coordinate: float, state: State) -> float:
        """Return the velocity [m/s] from its `coordinate`."""
        return coordinate

    def coordinate_rate(
        self, p: Parameters, x_ddot: float, x_dot: float, coordinate: float, state: State
    ) -> float:
        """Return the rate of the `coordinate` from the acceleration [m/s2] and the velocity."""
        return x_ddot

    def jacobian(
        self, p: Parameters, force: float, coordinate: float, state: State
    ) -> Floats | None:
        """Return the exact derivatives of velocity, `coordinate_rate` and `rates`.

        A row each, by the ``force`` k z + F_ext [N], the coordinate and the state; None, if they
        are not known.
        """
        return None

    def steady_state(self, p: Parameters, v: float) -> State:
        """Return the own state in sliding at a velocity [m/s], not 0; none by default."""
        return NO_STATE

    def no_cycle(self, p: Parameters) -> str:
        """Return why no cycle exists at any velocity; empty where that is not known."""
        return ""

    def stored(self, p: Parameters, state: Floats) -> Floats:
        """Return the energy [J] that the own state holds, (variables, n) given; none by default."""
        return np.zeros(state.shape[1:])

    def shown(self, p: Parameters, x_dot: Floats, state: Floats) -> dict[str, Floats]:
        """Return the law's own outputs by name, at velocities (n,), states (variables, n); none."""
        return {}

    def complete(self, p: Parameters, own: Mapping[str, float]) -> Parameters:
        """Return ``p`` with a value for each own parameter, its start where ``own`` has none.

        Raises
        ------
        ValueError
            If ``own`` names a parameter that the law does not have, or a value is out of range;
            the message has name, value and range.
        """
        for name, value in own.items():
            if name not in self.parameters:
                known = ", ".join(self.parameters) or "none"
                raise ValueError(
                    f"{name} = {value!r} is no parameter of the friction law "
                    f"{type(self).__name__}; its own parameters: {known}"
                )
        return p.with_own(
            {
                name: float(checked(name, own.get(name, each.start), each.bound))
                for name, each in self.parameters.items()
            }
        )
