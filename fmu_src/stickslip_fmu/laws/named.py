"""A friction law given by one dotted name: the block's side of it."""

from importlib import import_module
from typing import Any, NamedTuple

from .law import Law

_EXAMPLE = "'my_laws.stribeck:STRIBECK'"


class NamedLaw(NamedTuple):
    """The block's side of a friction law: module, name of the law there, and the law."""

    module: str
    name: str
    law: Law


def friction_law(name: str) -> NamedLaw:
    """Return the block's side of the friction law that a dotted name gives.

    Parameters
    ----------
    name
        ``"module:NAME"``, an object whose attribute ``block`` is in turn the dotted name of a
        `laws.law.Law`.

    Raises
    ------
    ValueError
        If the name is not of this form, a module or an attribute is missing, or the object found
        is no friction law; the message gives the reason and an example.
    """
    inner = getattr(_found(name), "block", None)
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
        raise ValueError(f"{name!r} is no dotted name module:NAME, such as {_EXAMPLE}")
    try:
        return getattr(import_module(module), attribute)
    except Exception as error:  # whatever a module of somebody else raises
        raise ValueError(
            f"the friction law {name!r} was not found ({error}); expected module:NAME, such as "
            f"{_EXAMPLE}, of a module that Python can import"
        ) from None
