"""Friction laws: the contract of a law, the built-in ones, and how a law is found by its name."""

from .coulomb import COULOMB, Coulomb
from .law import FrictionLaw, OwnParameter, State
from .named import friction_law
from .stribeck import STRIBECK, Shape, Stribeck

__all__ = [
    "COULOMB",
    "STRIBECK",
    "Coulomb",
    "FrictionLaw",
    "OwnParameter",
    "Shape",
    "State",
    "Stribeck",
    "friction_law",
]
