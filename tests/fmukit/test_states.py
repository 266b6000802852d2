"""States of an instance: as bytes, and behind handles that outlive careless freeing."""

import ctypes
import random

import pytest

from fmukit import states
from fmukit.model import ModelError
from fmukit.states import Handle, State, from_bytes, held
from stickslip_fmu.spec import SPEC
from tests.fmu.blocks import make_block, outputs

# More than stay, so that every handle of a test is let go in the end.
MANY = 2000


def release(address: int) -> None:
    """Count one reference down, as the wrapper does where a state is freed."""
    ctypes.pythonapi.Py_DecRef(ctypes.c_void_p(address))


def state_of_some_block() -> State:
    """Return the state of a block at the start."""
    settings = SPEC.values.at_start()
    return State(SPEC.model, make_block().freeze(), settings, 0.0, "stepping", True)


def test_a_frozen_block_is_never_written_to() -> None:
    """Whatever block goes on from it, and whenever, what follows is the same to the last bit."""
    generator = random.Random(8)
    block, other = make_block(c=0.5), make_block()
    for _ in range(60):
        frozen = block.freeze()
        steps = [(generator.uniform(-0.02, 0.1), 10.0 ** generator.uniform(-5, 0)) for _ in "1234"]
        shown = []
        for goes_on in (block, other, block, other):
            goes_on.thaw(frozen)
            shown.append([outputs(goes_on)])
            for v, h in steps:
                goes_on.set("v", v)
                goes_on.advance(0.0, h)
                shown[-1].append(outputs(goes_on))
        assert all(each == shown[0] for each in shown)


def test_bytes_hold_the_whole_state() -> None:
    """A state that went through bytes gives the same bytes again, and other bytes give none."""
    block = make_block(c=0.5)
    for _ in range(40):
        block.advance(0.0, 0.0173)
        state = State(SPEC.model, block.freeze(), block.wanted, 0.5, "stepping", True)
        again = from_bytes(SPEC, state.to_bytes())
        assert again.to_bytes() == state.to_bytes()
    for content in (b"{}", b"[]", b"null", b"0.5"):
        with pytest.raises(ModelError):
            from_bytes(SPEC, content)


def test_a_freed_handle_is_known() -> None:
    """It holds its state until it is freed, and nothing else ever does."""
    handle = Handle(state_of_some_block())
    address = id(handle)
    assert held(handle) is not None
    del handle
    found = [kept[0] for kept in states._freed if id(kept[0]) == address]
    assert len(found) == 1
    assert held(found[0]) is None
    assert held(None) is None
    assert held(state_of_some_block()) is None


def test_handles_may_be_freed_again() -> None:
    """Handles freed twice and thrice are let go like others, and leave nothing behind."""
    for times in (1, 2, 3):
        addresses = []
        for _ in range(100):
            handle = Handle(None)
            addresses.append(id(handle))
            del handle
            for _ in range(times - 1):
                release(addresses[-1])
    for _ in range(MANY):
        Handle(None)
    assert len(states._freed) < MANY
    assert all(states._count(kept) == states._WHOLE for kept in states._freed)
