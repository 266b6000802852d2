"""The independent reference of the stick-slip block: the model of docs/theory.md on SciPy.

`steady_cycle`, `simplified` and the critical velocity are closed forms and take arrays;
`simulate` integrates the motion numerically. SI units throughout.
"""

from .critical import coulomb_limit, critical_lambda
from .cycle import Cycle, SimplifiedCycle, simplified, steady_cycle
from .dwell import Attractor, Attractors, dwell_attractors
from .laws import (
    COULOMB,
    LUGRE,
    RATE_STATE,
    STRIBECK,
    Coulomb,
    FrictionLaw,
    LuGre,
    OwnParameter,
    RateState,
    Shape,
    State,
    Stribeck,
    friction_law,
)
from .limits import critical_velocity, memory_cycle
from .parameters import Bound, FloatOrArray, FrictionClampWarning, Parameters
from .ranges import EVEN, STICKS, SWINGS, CriticalVelocity, Interval, merged
from .regime import SETTLED, Kind, Regime, StickSlip, Swinging, regime
from .simulation import RTOL, Change, simulate
from .trajectory import Event, MeasuredCycle, Trajectory

__all__ = [
    "COULOMB",
    "EVEN",
    "LUGRE",
    "RATE_STATE",
    "RTOL",
    "SETTLED",
    "STICKS",
    "STRIBECK",
    "SWINGS",
    "Attractor",
    "Attractors",
    "Bound",
    "Change",
    "Coulomb",
    "CriticalVelocity",
    "Cycle",
    "Event",
    "FloatOrArray",
    "FrictionClampWarning",
    "FrictionLaw",
    "Interval",
    "Kind",
    "LuGre",
    "MeasuredCycle",
    "OwnParameter",
    "Parameters",
    "RateState",
    "Regime",
    "Shape",
    "SimplifiedCycle",
    "State",
    "StickSlip",
    "Stribeck",
    "Swinging",
    "Trajectory",
    "coulomb_limit",
    "critical_lambda",
    "critical_velocity",
    "dwell_attractors",
    "friction_law",
    "memory_cycle",
    "merged",
    "regime",
    "simplified",
    "simulate",
    "steady_cycle",
]
