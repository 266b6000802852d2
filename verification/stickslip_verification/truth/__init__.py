"""The truth: the exact solution of the model in high precision, for the very numbers given.

It is written from docs/theory.md alone, and imports mpmath and nothing else of ours or of others.
`run` follows any sequence of steps and changes under any friction law. `steady_cycle` gives
Coulomb's cycle in closed form (damped: with one root), `critical_lambda` the edge of its existence.
"""

from stickslip_verification.truth.coulomb import COULOMB, Coulomb
from stickslip_verification.truth.course import Run, Step, run
from stickslip_verification.truth.cycle import critical_lambda, steady_cycle
from stickslip_verification.truth.law import FrictionLaw, Slip
from stickslip_verification.truth.motion import Event
from stickslip_verification.truth.named import COULOMB_NAME, friction_law
from stickslip_verification.truth.parameters import (
    CHANGEABLE,
    PARAMETERS,
    START_VALUES,
    Kind,
    Number,
    Numbers,
    Parameter,
    complete,
)
from stickslip_verification.truth.series import Series
from stickslip_verification.truth.stribeck import STRIBECK, Shape, Stribeck

__all__ = [
    "CHANGEABLE",
    "COULOMB",
    "COULOMB_NAME",
    "PARAMETERS",
    "START_VALUES",
    "STRIBECK",
    "Coulomb",
    "Event",
    "FrictionLaw",
    "Kind",
    "Number",
    "Numbers",
    "Parameter",
    "Run",
    "Series",
    "Shape",
    "Slip",
    "Step",
    "Stribeck",
    "complete",
    "critical_lambda",
    "friction_law",
    "run",
    "steady_cycle",
]
