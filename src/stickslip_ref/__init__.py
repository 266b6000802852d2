"""The independent reference of the stick-slip block: the model of docs/theory.md on SciPy.

`steady_cycle`, `simplified` and the critical velocity are closed forms and take arrays;
`simulate` integrates the motion numerically. SI units throughout.
"""

from .critical import critical_lambda, critical_velocity
from .cycle import Cycle, SimplifiedCycle, simplified, steady_cycle
from .friction import COULOMB, Coulomb, FrictionLaw
from .inputs import Change
from .parameters import FloatOrArray, FrictionClampWarning, Parameters
from .simulation import RTOL, simulate
from .trajectory import Event, MeasuredCycle, Trajectory

__all__ = [
    "COULOMB",
    "RTOL",
    "Change",
    "Coulomb",
    "Cycle",
    "Event",
    "FloatOrArray",
    "FrictionClampWarning",
    "FrictionLaw",
    "MeasuredCycle",
    "Parameters",
    "SimplifiedCycle",
    "Trajectory",
    "critical_lambda",
    "critical_velocity",
    "simplified",
    "simulate",
    "steady_cycle",
]
