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

from ..parameters import Bound, Parameters, checked

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
       age, set ``ages = True``; it must then be a non-decreasing, concave function of the age. At
       age 0 it is at least the friction at speed 0, ``slip_friction(p, 0.0)``.
    3. The friction in slip, `slip_friction`: a magnitude, smooth in the speed. If it is the same
       at every speed, set ``constant_in_slip = True``, which saves evaluations; such a law has no
       own state.
    4. Where the law ends at some speed, that speed: `speed_limit`. The simulation evaluates
       `slip_friction` a little beyond the limit, so it must return a smooth continuation there. A
       run that passes the limit is refused with speed and limit.
    5. If it has state variables of its own (say the age of the contacts): their values at the
       start of a run, `state_start`; their sizes for the integration's tolerance, `state_scale`;
       their rates in slip, `rates`; and their values after a time at rest, `rested`.
    6. Where the mass never sticks (LuGre, regularised laws): ``sticks = False``. Then
       `break_away_force` shows as the output F_s only, and `slip_friction` and `rates` take the
       signed velocity; `slip_friction` returns the signed friction, which opposes a motion along
       +x where it is positive. The motion is integrated whole: there are no events, the meter
       stays at its starts, and the mode of a sample is the sign of its velocity.

    A law may assume:

    7. Inputs and parameters are constant along an arc. After a change `rested` starts anew from
       the state at the change, and the age of a stick goes on.
    8. The speed is >= 0 in `slip_friction` and `rates` of a law with a stick.

    A law must leave alone:

    9. The viscous damping ``c``, the spring and F_ext: the simulation adds them.
    10. Events, meter, energies and samples. The law's methods have no side effect, since the
        integrator evaluates trial states.
    """

    parameters: Mapping[str, OwnParameter] = MappingProxyType({})
    """The law's own parameters by name."""

    ages: bool = False
    """Whether the break-away force depends on the age of the stick."""

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
            Time [s] since the stick began; 0 in slip and at the start of a run.
        state : tuple of float
            The law's own state at that age.
        """

    @abstractmethod
    def slip_friction(self, p: Parameters, speed: float, state: State = NO_STATE) -> float:
        """Return the dry friction [N] on a mass that slips at ``speed`` [m/s]."""

    def speed_limit(self, p: Parameters) -> float:
        """Return the speed [m/s] up to which the law holds; infinite by default."""
        return math.inf

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
