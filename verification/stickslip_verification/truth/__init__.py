"""The truth: the exact solution of the model in high precision, for the very numbers given.

It is written from docs/theory.md alone, and imports mpmath and nothing else of ours or of others.
`run` follows any sequence of steps and changes under any friction law. `steady_cycle` gives
Coulomb's cycle in closed form (damped: with one root), `critical_lambda` the edge of its existence.
"""

from stickslip_verification.truth.coulomb import COULOMB as COULOMB
from stickslip_verification.truth.coulomb import critical_lambda as critical_lambda
from stickslip_verification.truth.coulomb import steady_cycle as steady_cycle
from stickslip_verification.truth.course import COULOMB_NAME as COULOMB_NAME
from stickslip_verification.truth.course import Run as Run
from stickslip_verification.truth.course import Step as Step
from stickslip_verification.truth.course import friction_law as friction_law
from stickslip_verification.truth.course import run as run
from stickslip_verification.truth.law import FrictionLaw as FrictionLaw
from stickslip_verification.truth.law import Slip as Slip
from stickslip_verification.truth.parameters import PARAMETERS as PARAMETERS
from stickslip_verification.truth.parameters import START_VALUES as START_VALUES
from stickslip_verification.truth.parameters import Kind as Kind
from stickslip_verification.truth.parameters import Number as Number
from stickslip_verification.truth.parameters import Numbers as Numbers
from stickslip_verification.truth.parameters import Parameter as Parameter
from stickslip_verification.truth.series import Series as Series
from stickslip_verification.truth.stribeck import STRIBECK as STRIBECK
