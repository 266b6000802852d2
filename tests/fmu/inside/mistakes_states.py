"""What a master may do wrong with states and their bytes."""

import ctypes as c
from typing import Any

from tests.fmu.inside.probing import HUGE, alive, probe
from tests.fmu.inside.raw import Raw


@probe("A state is set on another instance, its own being gone")
def _state_of_another_instance(raw: Raw) -> Any:
    instance, other = raw.started(), raw.instance()
    state = raw.save(instance)
    raw.FreeInstance(instance)
    seen = [raw.SetFMUstate(other, state), raw.FreeFMUstate(other, c.byref(state))]
    return [*seen, alive(raw, other)]


@probe("A state that is NULL is freed")
def _free_null_state(raw: Raw) -> Any:
    instance = raw.started()
    return [raw.FreeFMUstate(instance, c.byref(c.c_void_p())), alive(raw, instance)]


@probe("NULL is given for the pointer to a state")
def _free_state_by_null_pointer(raw: Raw) -> Any:
    return raw.FreeFMUstate(raw.started(), None)


@probe("A state is freed twice: the wrapper leaves the pointer as it was")
def _free_state_twice(raw: Raw) -> Any:
    instance = raw.started()
    states = [raw.save(instance) for _ in range(20)]
    seen = [raw.FreeFMUstate(instance, c.byref(state)) for state in states * 2]
    states = [raw.save(instance) for _ in range(300)]
    for state in states:
        assert raw.SetFMUstate(instance, state) == 0
        raw.forget(instance, state)
    return [max(seen), alive(raw, instance)]


@probe("A state is set that was freed")
def _set_freed_state(raw: Raw) -> Any:
    instance = raw.started()
    state = raw.save(instance)
    raw.forget(instance, state)
    return [raw.SetFMUstate(instance, state), alive(raw, instance)]


@probe("A NULL state is set that no failure made")
def _set_null_state(raw: Raw) -> Any:
    instance = raw.started()
    return [raw.SetFMUstate(instance, None), alive(raw, instance)]


@probe("A NULL state is serialized that no failure made")
def _serialize_null_state(raw: Raw) -> Any:
    instance, size = raw.started(), c.c_size_t()
    return [raw.SerializedFMUstateSize(instance, None, c.byref(size)), alive(raw, instance)]


@probe("A state is set and serialized that a failed get left NULL")
def _set_state_that_a_failed_get_left_null(raw: Raw) -> Any:
    instance, state, size = raw.started(), c.c_void_p(), c.c_size_t()
    raw.DoStep(instance, 0.0, -1.0, 0)
    seen = []
    for _ in range(50):
        seen.append(raw.GetFMUstate(instance, c.byref(state)))
        seen.append(raw.SetFMUstate(instance, state))
        seen.append(raw.SerializedFMUstateSize(instance, state, c.byref(size)))
        seen.append(raw.SerializeFMUstate(instance, state, c.create_string_buffer(9), 9))
        assert raw.FreeFMUstate(instance, c.byref(state)) == 0
    return [min(seen), max(seen), alive(raw, instance)]


@probe("A number is set for a state")
def _state_that_is_no_pointer(raw: Raw) -> Any:
    return raw.SetFMUstate(raw.started(), 0x1234)


@probe("A buffer for bytes is smaller than their size")
def _bytes_too_few(raw: Raw) -> Any:
    instance = raw.started()
    state, data = raw.save(instance), c.create_string_buffer(10)
    seen = raw.SerializeFMUstate(instance, state, data, 9)
    copy = raw.unpack(instance, data.raw[:9])
    return [seen, raw.SetFMUstate(instance, copy), alive(raw, instance)]


@probe("A buffer for bytes is larger than their size by far")
def _bytes_far_too_many(raw: Raw) -> Any:
    instance = raw.started()
    state, data = raw.save(instance), c.create_string_buffer(2**28)
    return raw.SerializeFMUstate(instance, state, data, 2**28)


@probe("A buffer for bytes is NULL")
def _bytes_to_null(raw: Raw) -> Any:
    instance = raw.started()
    return raw.SerializeFMUstate(instance, raw.save(instance), None, 10)


@probe("A state is made of no bytes")
def _no_bytes(raw: Raw) -> Any:
    instance = raw.started()
    return [raw.SetFMUstate(instance, raw.unpack(instance, b"")), alive(raw, instance)]


@probe("A state is made of other bytes")
def _bytes_of_nonsense(raw: Raw) -> Any:
    instance = raw.started()
    copy = raw.unpack(instance, bytes(range(256)) * 100)
    return [raw.SetFMUstate(instance, copy), alive(raw, instance)]


@probe("A state is made of more bytes than there is memory")
def _bytes_beyond_memory(raw: Raw) -> Any:
    instance, state = raw.started(), c.c_void_p()
    data = c.create_string_buffer(10)
    return [raw.DeSerializeFMUstate(instance, data, HUGE, c.byref(state)), alive(raw, instance)]
