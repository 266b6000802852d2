"""Friction laws: the contract of a law, Coulomb's law, and how a law is found by its name."""

from .coulomb import COULOMB, Coulomb
from .law import FrictionLaw, OwnParameter, State
from .named import friction_law

__all__ = ["COULOMB", "Coulomb", "FrictionLaw", "OwnParameter", "State", "friction_law"]
