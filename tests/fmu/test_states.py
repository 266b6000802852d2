"""States: from one process to another, many at once, spoilt, and without growth."""

import ctypes

import pytest

from tests.conftest import built, kinds
from tests.driver import Host
from tests.fmu.acts import TURNS, lost, resumed, spoilt, written

# A spring beyond F_s on both sides slips forward until 0.1 s, then backward.
PLACES: list[tuple[dict[str, float], float]] = [
    ({}, 0.1),
    ({"z_start": 0.02, "x_start": 1.0}, 0.15),
    ({"x_dot_start": -0.3, "c": 2.0}, 0.005),
    ({"z_start": 0.02, "c": 100.0}, 0.05),
    ({"tau_s": 0.1, "B": 0.02, "age_start": 2.0}, 0.1),
    ({"mu_k": 0.9}, 0.3),
]
"""Values, and the time of the state [s]."""


@pytest.mark.parametrize(("first", "second"), [("python-2", "python-3"), ("python-3", "python-2")])
def test_bytes_of_a_state_go_on_in_another_process_and_fmi_version(
    first: str, second: str, host: Host, fresh_host: Host
) -> None:
    found = host.call(written, built(first), PLACES)
    expected = [shown for shown, _ in found]
    assert len({str(shown) for shown in expected}) == len(PLACES)
    for kind in (first, second):
        assert fresh_host.call(resumed, built(kind), [state for _, state in found]) == expected


@pytest.mark.parametrize("kind", ["python-2", "python-3"])
def test_a_state_that_was_spoilt_in_any_place_is_refused(kind: str, host: Host) -> None:
    tries, taken = host.call(spoilt, built(kind))
    assert tries > 500
    assert not taken


LOST = {
    # The wrapper loses the code that it compiles from the slave's file.
    ("python-2", "instances"): 16,
    # References in advance keep the instance, without its block of thirty.
    ("python-2", "states asked for after a failure"): 12,
    ("python-3", "states asked for after a failure"): 14,
    # Wrapper of FMI 3.0: one at each refused step and each instance.
    ("python-3", "failures and resets"): 1,
    ("python-3", "instances"): 1,
}
"""Known losses of blocks of memory a turn; else not even one in two turns."""


@pytest.mark.skipif(not hasattr(ctypes.CDLL(None), "mallinfo2"), reason="C library without counts")
@pytest.mark.parametrize("what", TURNS)
@pytest.mark.parametrize("kind", kinds())
def test_what_is_done_for_ever_keeps_no_memory(kind: str, what: str, host: Host) -> None:
    blocks, grown = host.call(lost, built(kind), what, 1024)
    assert blocks < LOST.get((kind, what), 0) + 0.5
    # The smallest allocation takes 16; an arena once in all turns is no loss.
    assert grown < 16.0
