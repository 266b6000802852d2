"""What a master may do wrong with lists, texts, categories and statuses."""

import ctypes as c
from typing import Any

from tests.fmu.inside.probing import HUGE, alive, probe
from tests.fmu.inside.raw import Raw


@probe("Nothing is got and set, by NULL lists")
def _nothing_by_null_lists(raw: Raw) -> Any:
    instance = raw.started()
    seen = [
        getattr(raw, f"{verb}{kind}")(instance, None, 0, None)
        for verb in ("Get", "Set")
        for kind in ("Real", "Integer", "Boolean", "String")
    ]
    return [max(seen), alive(raw, instance)]


@probe("One value is got by a NULL list of references")
def _one_by_null_list(raw: Raw) -> Any:
    return raw.GetReal(raw.started(), None, 1, (c.c_double * 1)())


@probe("One value is got into a NULL list")
def _one_to_null_list(raw: Raw) -> Any:
    return raw.GetReal(raw.started(), (c.c_uint * 1)(0), 1, None)


@probe("More values are got than there is memory")
def _count_beyond_memory(raw: Raw) -> Any:
    return raw.GetReal(raw.started(), (c.c_uint * 1)(0), HUGE, (c.c_double * 1)())


@probe("A NULL text is set")
def _text_null(raw: Raw) -> Any:
    instance = raw.started()
    return [raw.write(instance, "String", [0], [None]), alive(raw, instance)]


@probe("A text is set that is not UTF-8")
def _text_not_utf8(raw: Raw) -> Any:
    instance = raw.started()
    return [raw.write(instance, "String", [0], [b"\xff"]), alive(raw, instance)]


@probe("An unknown log category is switched on")
def _category_unknown(raw: Raw) -> Any:
    instance = raw.started()
    seen = raw.SetDebugLogging(instance, 1, 1, (c.c_char_p * 1)(b"nonsense"))
    return [seen, alive(raw, instance)]


@probe("A NULL log category is switched on")
def _category_null(raw: Raw) -> Any:
    return raw.SetDebugLogging(raw.started(), 1, 1, (c.c_char_p * 1)(None))


@probe("More log categories are switched on than there is memory")
def _categories_beyond_memory(raw: Raw) -> Any:
    return raw.SetDebugLogging(raw.started(), 1, HUGE, (c.c_char_p * 1)(b"a"))


@probe("A status of an unknown kind is asked for")
def _status_of_unknown_kinds(raw: Raw) -> Any:
    instance = raw.started()
    kinds = ("", "Real", "Integer", "Boolean", "String")
    seen = [getattr(raw, f"Get{each}Status")(instance, 99, None) for each in kinds]
    return [*seen, alive(raw, instance)]


@probe("The last successful time is asked for, into NULL")
def _status_to_null(raw: Raw) -> Any:
    return raw.GetRealStatus(raw.started(), 2, None)


@probe("A step is cancelled, derivatives are got and set: none is offered")
def _what_is_not_offered(raw: Raw) -> Any:
    instance = raw.started()
    seen = [
        raw.CancelStep(instance),
        raw.GetDirectionalDerivative(instance, None, 0, None, 0, None, None),
        raw.SetRealInputDerivatives(instance, None, 0, None, None),
        raw.GetRealOutputDerivatives(instance, None, 0, None, None),
    ]
    # The wrapper answers by itself: the block does not hear of it and goes on.
    return [*seen, raw.DoStep(instance, 0.0, 0.1, 0), alive(raw, instance)]
