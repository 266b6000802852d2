"""The truth: the exact solution of the model in high precision, for the very numbers given.

Written from docs/theory.md alone. It knows neither the block nor the reference, so it can
contradict both. `run` follows any sequence of steps and changes, `steady_cycle` gives the cycle in
closed form (damped: with one root), `critical_lambda` the edge of its existence.
"""

from stickslip_verification.truth.course import Run, Step, run
from stickslip_verification.truth.cycle import critical_lambda, steady_cycle
from stickslip_verification.truth.motion import Event
from stickslip_verification.truth.parameters import CHANGEABLE, START_VALUES

__all__ = [
    "CHANGEABLE",
    "START_VALUES",
    "Event",
    "Run",
    "Step",
    "critical_lambda",
    "run",
    "steady_cycle",
]
