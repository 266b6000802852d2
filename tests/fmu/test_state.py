"""States: whatever the phase, in this process or another, bit for bit, and without growth."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.fmu.running import inside


@pytest.fixture(scope="module")
def rolled_back(fmu_path: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Return what was shown after a state was taken in each place, and what showed it again."""
    found: dict[str, Any] = inside(
        fmu_path, "states", "rolled_back", None, tmp_path_factory.mktemp("states")
    )
    return found


def test_a_state_restores_every_phase(rolled_back: dict[str, Any]) -> None:
    """Stick, slip, reversed and damped slip and all other phases repeat what follows, any way."""
    assert len(rolled_back) == 15
    for place, found in rolled_back.items():
        missed = [way for way, same in found["again"].items() if not same]
        assert not missed, place
        assert len(found["again"]) == 10


def test_what_follows_a_state_is_worth_comparing(rolled_back: dict[str, Any]) -> None:
    """From each place but the last the outputs move at every step, and from each differently."""
    runs = [found["first"] for place, found in rolled_back.items() if place != "terminated"]
    for run in runs:
        assert all(before != after for before, after in zip(run[-9:], run[-8:], strict=False))
    assert all(a != b for n, a in enumerate(runs) for b in runs[:n])


def test_a_serialized_state_goes_on_in_another_process(
    rolled_back: dict[str, Any], fmu_path: Path, tmp_path: Path
) -> None:
    """Bytes alone make an instance that was never set up go on as the first did, bit for bit."""
    packed = {place: found["data"] for place, found in rolled_back.items()}
    resumed = inside(fmu_path, "states", "resumed", packed, tmp_path)
    for place, shown in resumed.items():
        assert shown == rolled_back[place]["first"], place


def test_states_live_apart(fmu_path: Path, tmp_path: Path) -> None:
    """A hundred and twenty states at once are restored and freed in any order."""
    tried, same = inside(fmu_path, "states", "shuffled", 1, tmp_path)
    assert same == tried > 200


def test_a_spoilt_state_is_refused(fmu_path: Path, tmp_path: Path) -> None:
    """A state with anything but a fitting finite number in any place, or garbage, is refused."""
    tried, refused, by_accident = inside(fmu_path, "spoilt", "tried", None, tmp_path)
    assert refused == tried > 500
    assert by_accident == 0


# The smallest object of Python takes 16 bytes; one lost at every fourth turn would show in a
# million turns, one of 53 bytes at each turn in ten thousand.
LOST_OBJECT = 16


@pytest.mark.parametrize(
    ("what", "times"),
    [
        ("iteration", 1_000_000),
        ("serialization", 100_000),
        ("reset", 100_000),
        ("failure", 100_000),
    ],
)
def test_nothing_grows(
    fmu_path: Path, tmp_path: Path, what: str, times: int, sized: Callable[[int], int]
) -> None:
    """A million iterated steps, and whatever else is done for ever, keep no memory."""
    times = sized(times)
    grown = inside(fmu_path, "growth", "grown", {"what": what, "times": times}, tmp_path)
    # The allocator takes its memory by a quarter of a megabyte.
    assert grown <= max(LOST_OBJECT // 4 * times // 2, 2**18)


def test_a_freed_instance_leaves_nothing_of_ours(fmu_path: Path, tmp_path: Path) -> None:
    """Instances that come and go leave no block, also where a call on them failed."""
    alive, left = inside(fmu_path, "growth", "left", 500, tmp_path)
    assert alive >= 4 * 500
    assert left == 0
    lost = inside(fmu_path, "growth", "grown", {"what": "instance", "times": 4000}, tmp_path)
    # The wrapper loses the code that it compiles from the slave's file, and a list: 1.2 kB.
    assert lost < 2000 * 2000


def test_a_state_that_was_not_given_leaves_a_husk(fmu_path: Path, tmp_path: Path) -> None:
    """An instance asked for its state after a failure is not freed, but its block is."""
    order = {"what": "failure to get", "times": 4000}
    lost = inside(fmu_path, "growth", "grown", order, tmp_path)
    # References in advance keep it; with its block it would be three times as much.
    assert lost < 1500 * 2000
