"""A friction law given by its name: the block's side of it."""

from importlib import import_module
from typing import Any, NamedTuple

from .law import Law

COULOMB_NAME = "coulomb"
"""The name of Coulomb's law, which is the default."""

BUILT_IN = {
    COULOMB_NAME: "stickslip_fmu.laws.coulomb.law:COULOMB",
    "stribeck": "stickslip_fmu.laws.stribeck.law:STRIBECK",
    "lugre": "stickslip_fmu.laws.lugre.law:LUGRE",
    "rate_state": "stickslip_fmu.laws.rate_state.law:RATE_STATE",
}
"""Dotted names of the block's side of the friction laws of this package, by name."""

_EXAMPLE = "'my_laws.stribeck:STRIBECK'"


class NamedLaw(NamedTuple):
    """The block's side of a friction law: module, name of the law there, and the law."""

    module: str
    name: str
    law: Law


def friction_law(name: str) -> NamedLaw:
    """Return the block's side of a friction law.

    Parameters
    ----------
    name
        A name in BUILT_IN, or ``"module:NAME"``, an object whose attribute ``block`` is in turn the
        dotted name of a `laws.law.Law`.

    Raises
    ------
    ValueError
        If the name is none of these, a module or an attribute is missing, or the object found is no
        friction law; the message gives the reason, the built-in names and an example.
    """
    inner = BUILT_IN.get(name) or getattr(_found(name), "block", None)
    if not isinstance(inner, str):
        raise ValueError(
            f"the friction law {name!r} has no attribute 'block' with the dotted name of the "
            "block's side, such as 'my_laws.stribeck.block:LAW'"
        )
    law = _found(inner)
    if not (hasattr(law, "interface") and hasattr(law, "under")):
        raise ValueError(
            f"{inner!r} is a {type(law).__name__}; the block's side of a friction law has the "
            "attributes of stickslip_fmu.laws.law.Law"
        )
    module, _, attribute = inner.partition(":")
    return NamedLaw(module, attribute, law)


def _found(name: str) -> Any:
    module, _, attribute = name.partition(":")
    if not (module and attribute.isidentifier()):
        built_in = ", ".join(map(repr, BUILT_IN))
        raise ValueError(
            f"{name!r} is no friction law: {built_in}, or a dotted name module:NAME such as "
            f"{_EXAMPLE}"
        )
    try:
        return getattr(import_module(module), attribute)
    except Exception as error:  # whatever a module of somebody else raises
        raise ValueError(
            f"the friction law {name!r} was not found ({error}); expected module:NAME, such as "
            f"{_EXAMPLE}, of a module that Python can import"
        ) from None
