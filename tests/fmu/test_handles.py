"""States inside the FMU: frozen without a copy, behind handles that outlive careless freeing."""

import ctypes
import random

from stickslip_fmu import handles
from stickslip_fmu.handles import Handle, held
from stickslip_fmu.settings import Settings
from stickslip_fmu.state import State, from_bytes

from .blocks import make_block, outputs

# More than stay, so that every handle of a test is let go in the end.
MANY = 2000


def release(address: int) -> None:
    """Count one reference down, as the wrapper does where a state is freed."""
    ctypes.pythonapi.Py_DecRef(ctypes.c_void_p(address))


def state_of_some_block() -> State:
    """Return the state of a block at the start."""
    settings = Settings.at_start()
    return State(make_block().freeze(), settings, 0.0, "stepping", True)


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
        state = State(block.freeze(), block.wanted, 0.5, "stepping", True)
        again = from_bytes(state.to_bytes())
        assert again is not None
        assert again.to_bytes() == state.to_bytes()
    assert from_bytes(b"{}") is None


def test_a_freed_handle_is_known() -> None:
    """It holds its state until it is freed, and nothing else ever does."""
    handle = Handle(state_of_some_block())
    address = id(handle)
    assert held(handle) is not None
    del handle
    found = [grave[0] for grave in handles._graves if id(grave[0]) == address]
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
    assert len(handles._graves) < MANY
    assert all(handles._count(grave) == handles._WHOLE for grave in handles._graves)
