"""Random sequences of calls on every kind of FMU, each call held to the contract."""

import json
import random
from pathlib import Path

import pytest

from tests.conftest import Sized, built, kinds
from tests.driver import DiedError, Host
from tests.fmu.lives.contract import Contract, Expected, objection
from tests.fmu.lives.master import Master
from tests.fmu.lives.player import Call, play

Life = list[tuple[Call, Expected]]

LIVES = {"coulomb": 2000, "stribeck": 300}
"""Number of lives in each share at full size."""
SHARES = [("coulomb", 0), ("coulomb", 1), ("coulomb", 2), ("stribeck", 3), ("stribeck", 4)]

_AT_ONCE = 100
_MODES = ("stick", "forward slip", "backward slip")
_BEFORE = ("instantiated", "initialization")
# Else the lives are tame: calls that each share must have seen taken, and refused.
TAKEN = {(name, where) for name in ("restore", "get", "save") for where in (*_BEFORE, *_MODES)}
TAKEN |= {(name, where) for name in ("set", "step") for where in _MODES}
TAKEN |= {(name, "terminated") for name in ("get", "save", "reset", "free")}
REFUSED = {(n, at) for n in ("set", "get", "step") for at in (*_BEFORE, "stick", "failed")}


def finding(host: Host, path: Path, lives: list[Life]) -> tuple[Life, str] | None:
    try:
        outcomes = host.call(play, path, [[call for call, _ in life] for life in lives])
    except DiedError as died:
        if len(lives) == 1:
            return lives[0], str(died)
        half = len(lives) // 2
        return finding(host, path, lives[:half]) or finding(host, path, lives[half:])
    for life, found in zip(lives, outcomes, strict=True):
        for n, ((_, expected), outcome) in enumerate(zip(life, found, strict=True)):
            if why := objection(expected, outcome):
                return life[: n + 1], why
    return None


def shortest(host: Host, path: Path, kind: str, law: str, life: Life, why: str) -> str:
    for n in reversed(range(len(life) - 1)):
        contract = Contract(kind, law)
        calls = [call for call, _ in life[:n] + life[n + 1 :]]
        if life[n][0][0] == "instantiate":
            continue
        if found := finding(host, path, [[(call, contract.expected(call)) for call in calls]]):
            life, why = found
    return "\n".join([why, *(json.dumps(call) for call, _ in life)])


@pytest.mark.parametrize(("law", "share"), SHARES)
@pytest.mark.parametrize("kind", kinds())
def test_whatever_is_called_an_fmu_lives_on_and_answers_as_promised(
    kind: str, law: str, share: int, host: Host, sized: Sized
) -> None:
    path = built(kind, law)
    first, count = share * LIVES[law], sized(LIVES[law])
    masters = [Master(kind, law, seed) for seed in range(first, first + count)]
    for n in range(0, count, _AT_ONCE):
        if found := finding(host, path, [master.life() for master in masters[n : n + _AT_ONCE]]):
            pytest.fail(shortest(host, path, kind, law, *found))
    if law == "coulomb":
        assert not TAKEN.difference(*(master.taken for master in masters))
        assert not REFUSED.difference(*(master.refused for master in masters))


@pytest.mark.parametrize("kind", kinds())
def test_fifty_lives_at_once_go_as_each_goes_alone(kind: str, host: Host) -> None:
    lives = [Master(kind, "coulomb", seed, mark=10 * seed).life() for seed in range(50)]
    turns = [n for n, life in enumerate(lives) for _ in life]
    random.Random(6).shuffle(turns)
    going = [iter(life) for life in lives]
    assert not finding(host, built(kind), [[next(going[n]) for n in turns]])
