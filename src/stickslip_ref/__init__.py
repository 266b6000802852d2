"""The independent reference of the stick-slip block: the model of docs/theory.md on SciPy.

`steady_cycle`, `simplified` and the critical velocity are closed forms and take arrays;
`simulate` integrates the motion numerically. SI units throughout.
"""

from .critical import critical_lambda, critical_velocity
from .cycle import Cycle, SimplifiedCycle, simplified, steady_cycle
from .laws import COULOMB, Coulomb, FrictionLaw, OwnParameter, State, friction_law
from .parameters import Bound, FloatOrArray, FrictionClampWarning, Parameters
from .simulation import RTOL, Change, simulate
from .trajectory import Event, MeasuredCycle, Trajectory

__all__ = [
    "COULOMB",
    "RTOL",
    "Bound",
    "Change",
    "Coulomb",
    "Cycle",
    "Event",
    "FloatOrArray",
    "FrictionClampWarning",
    "FrictionLaw",
    "MeasuredCycle",
    "OwnParameter",
    "Parameters",
    "SimplifiedCycle",
    "State",
    "Trajectory",
    "critical_lambda",
    "critical_velocity",
    "friction_law",
    "simplified",
    "simulate",
    "steady_cycle",
]
