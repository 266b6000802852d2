"""Friction laws: the contract of a law, the built-in ones, and how a law is found by its name."""

from .coulomb import COULOMB, Coulomb
from .law import FrictionLaw, OwnParameter, State
from .lugre import LUGRE, LuGre
from .named import friction_law
from .rate_state import RATE_STATE, RateState
from .stribeck import STRIBECK, Shape, Stribeck

__all__ = [
    "COULOMB",
    "LUGRE",
    "RATE_STATE",
    "STRIBECK",
    "Coulomb",
    "FrictionLaw",
    "LuGre",
    "OwnParameter",
    "RateState",
    "Shape",
    "State",
    "Stribeck",
    "friction_law",
]
