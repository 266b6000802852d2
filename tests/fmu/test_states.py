"""States: from one process to another, many at once, spoilt, and without growth."""

import ctypes

import pytest

from tests.conftest import built, kinds
from tests.driver import Host, play
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


def test_bytes_of_a_state_go_on_in_another_process(host: Host, fresh_host: Host) -> None:
    found = host.call(written, built("python-2"), PLACES)
    expected = [shown for shown, _ in found]
    assert len({str(shown) for shown in expected}) == len(PLACES)
    states = [state for _, state in found]
    assert fresh_host.call(resumed, built("python-2"), states) == expected


@pytest.mark.parametrize("kind", kinds())
def test_a_state_brings_an_instance_back_after_a_refusal(kind: str, host: Host) -> None:
    on = [["step", 0.2], ["get", "x", "x_dot", "t_event", "mu_k_used"]]
    script = [["start", {}], ["step", 0.1], ["save"], *on, ["set", {"k": -1.0}], *on]
    found = host.call(play, built(kind), [*script, ["restore"], *on])
    assert "k = -1.0 N/m is out of range" in found[7]["messages"][-1]
    assert found[10] == found[4]


def test_a_state_that_was_spoilt_in_any_place_is_refused(host: Host) -> None:
    tries, taken = host.call(spoilt, built("python-2"))
    assert tries > 500
    assert not taken


LOST = {
    # The wrapper loses the code that it compiles from the slave's file.
    ("python-2", "instances"): 16,
    # References in advance keep the instance, without its block of thirty.
    ("python-2", "states asked for after a failure"): 12,
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
