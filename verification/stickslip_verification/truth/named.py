"""A friction law given by its name."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from stickslip_verification.truth.coulomb import COULOMB
from stickslip_verification.truth.law import FrictionLaw
from stickslip_verification.truth.stribeck import STRIBECK

COULOMB_NAME = "coulomb"
"""The name of Coulomb's law."""

BUILT_IN = {COULOMB_NAME: COULOMB, "stribeck": STRIBECK}
"""The laws that come along, by name; any other name is a dotted one."""

_EXAMPLE = "'my_laws.stribeck:STRIBECK'"


def friction_law(name: str) -> FrictionLaw:
    """Return the truth's side of the friction law of this name.

    Parameters
    ----------
    name
        ``"coulomb"``, ``"stribeck"``, or ``"module:NAME"``: an object whose attribute
        ``truth`` is in turn the dotted name of a `FrictionLaw`.

    Raises
    ------
    ValueError
        If the name is not of this form, a module or an attribute is missing, or the object found
        is no `FrictionLaw`; the message gives the reason and an example.
    """
    if name in BUILT_IN:
        return BUILT_IN[name]
    inner = getattr(_found(name), "truth", None)
    if not isinstance(inner, str):
        raise ValueError(
            f"the friction law {name!r} has no attribute 'truth' with the dotted name of "
            "the truth's side, such as 'my_laws.stribeck.truth:LAW'"
        )
    law = _found(inner)
    if not isinstance(law, FrictionLaw):
        raise ValueError(
            f"{inner!r} is a {type(law).__name__}; the truth's side of a friction law is an "
            "object of a subclass of stickslip_verification.truth.FrictionLaw"
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
