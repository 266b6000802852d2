"""States as plain data: dictionaries, lists, numbers, truth values, texts and None.

Plain data come from outside the process, so they are checked before they are used.
"""

import math
from typing import Any, Dict, Type, TypeVar

from .model import ModelError
from .table import Values

_Record = TypeVar("_Record", bound=Values)


def check(value: Any, pattern: Any) -> None:
    """Raise ModelError unless a value has the structure and types of a pattern, numbers finite.

    A tuple in the pattern stands for alternatives: ``(0.0, None)`` allows a float or None.
    """
    if not _fits(value, pattern):
        raise ModelError("the saved state has not the structure of a state")


def values(kind: Type[_Record], plain: Dict[str, float]) -> _Record:
    """Return the record of `kind` that `Values.as_dict` gave.

    Raises ModelError where a name is missing or unknown, a type differs or a value is out of range.
    """
    check(plain, kind.table.start_values())
    for name, value in plain.items():
        objection = kind.table.by_name[name].objection(value)
        if objection is not None:
            raise ModelError(objection)
    return kind(plain)


def _fits(value: Any, pattern: Any) -> bool:
    if isinstance(pattern, tuple):
        return any(_fits(value, choice) for choice in pattern)
    if type(value) is not type(pattern):
        return False
    if isinstance(value, dict):
        return value.keys() == pattern.keys() and all(
            _fits(value[key], pattern[key]) for key in value
        )
    if isinstance(value, list):
        return len(value) == len(pattern) and all(map(_fits, value, pattern))
    return not isinstance(value, float) or math.isfinite(value)
