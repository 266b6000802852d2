"""A friction law given by its name."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from .coulomb import COULOMB
from .law import FrictionLaw
from .lugre import LUGRE
from .rate_state import RATE_STATE
from .stribeck import STRIBECK

BUILT_IN: dict[str, FrictionLaw] = {
    "coulomb": COULOMB,
    "stribeck": STRIBECK,
    "lugre": LUGRE,
    "rate_state": RATE_STATE,
}
"""The laws that come along, by name; any other name is a dotted one."""

_EXAMPLE = "'my_laws.stribeck:STRIBECK'"


def friction_law(name: str) -> FrictionLaw:
    """Return the reference's side of the friction law of this name.

    Parameters
    ----------
    name : str
        ``"coulomb"``, ``"stribeck"``, ``"lugre"``, ``"rate_state"``, or ``"module:NAME"``: an
        object whose attribute ``reference`` is in turn the dotted name of a `FrictionLaw`.

    Raises
    ------
    ValueError
        If the name is not of this form, a module or an attribute is missing, or the object found
        is no `FrictionLaw`; the message gives the reason and an example.
    """
    if name in BUILT_IN:
        return BUILT_IN[name]
    inner = getattr(_found(name), "reference", None)
    if not isinstance(inner, str):
        raise ValueError(
            f"the friction law {name!r} has no attribute 'reference' with the dotted name of "
            "the reference's side, such as 'my_laws.stribeck.reference:LAW'"
        )
    law = _found(inner)
    if not isinstance(law, FrictionLaw):
        raise ValueError(
            f"{inner!r} is a {type(law).__name__}; the reference's side of a friction law is an "
            "object of a subclass of stickslip_ref.FrictionLaw"
        )
    return law


def _found(name: str) -> Any:
    module, colon, attribute = name.partition(":")
    if not (module and colon and attribute):
        known = ", ".join(map(repr, BUILT_IN))
        raise ValueError(f"{name!r} is no friction law: {known}, or module:NAME such as {_EXAMPLE}")
    try:
        return getattr(import_module(module), attribute)
    except Exception as error:  # whatever a module of somebody else raises
        raise ValueError(
            f"the friction law {name!r} was not found ({error}); expected module:NAME, such as "
            f"{_EXAMPLE}, of a module that Python can import"
        ) from None
