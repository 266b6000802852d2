"""The truth: the exact solution of the model in high precision, for the very numbers given.

It is written from docs/theory.md alone, and imports mpmath and nothing else of ours or of others.
`run` follows any sequence of steps and changes under any friction law. `steady_cycle` gives
Coulomb's cycle in closed form (damped: with one root), `critical_lambda` the edge of its existence.
"""

from .coulomb import COULOMB as COULOMB
from .coulomb import critical_lambda as critical_lambda
from .coulomb import steady_cycle as steady_cycle
from .course import COULOMB_NAME as COULOMB_NAME
from .course import Run as Run
from .course import Step as Step
from .course import friction_law as friction_law
from .course import run as run
from .law import FrictionLaw as FrictionLaw
from .law import Slip as Slip
from .lugre import LUGRE as LUGRE
from .parameters import PARAMETERS as PARAMETERS
from .parameters import START_VALUES as START_VALUES
from .parameters import Kind as Kind
from .parameters import Number as Number
from .parameters import Numbers as Numbers
from .parameters import Parameter as Parameter
from .rate_state import RATE_STATE as RATE_STATE
from .series import Series as Series
from .stribeck import STRIBECK as STRIBECK
