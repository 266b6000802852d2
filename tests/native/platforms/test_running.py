"""The native FMU on Linux ARM64 and on Windows does what it does on Linux x86-64."""

import random
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from itertools import chain

import pytest

from tests.fmu.blocks import log_uniform
from tests.native.platforms.conftest import for_all
from tests.native.platforms.running import (
    ARM,
    LINUX,
    READ,
    WINDOWS,
    Answer,
    Machine,
    differences,
    line,
    machine,
    neighbour,
    sequence,
    set_values,
    start,
    wine,
)
from tests.needs import needs

pytestmark = needs("zig")

NEEDS = {ARM: needs("qemu"), WINDOWS: needs("wine")}
others = pytest.mark.parametrize("name", [pytest.param(n, marks=need) for n, need in NEEDS.items()])
PAIRS = [
    pytest.param(one, other, marks=[NEEDS[each] for each in {one, other} - {LINUX}])
    for one in (LINUX, ARM, WINDOWS)
    for other in (LINUX, ARM, WINDOWS)
]
SEQUENCES = {2: 5_000, 3: 500}
"""Of the FMU 2.0, and of the FMU 3.0, which differs in its face alone."""
versions = pytest.mark.parametrize("version", SEQUENCES)
TRAVELS = 200
NEIGHBOURS = 8

On = Callable[[str, int], Machine]


@pytest.fixture(scope="session")
def windows(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, str]]:
    with wine(tmp_path_factory.mktemp("windows") / "wine") as variables:
        yield variables


@pytest.fixture(scope="session")
def on(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> On:
    """Give the machine of a platform and FMI version, made when it is first asked for."""

    @cache
    def machine_of(name: str, version: int) -> Machine:
        variables = request.getfixturevalue("windows") if name == WINDOWS else {}
        folder = tmp_path_factory.mktemp(f"(x86) a+b {name}")
        return machine(name, for_all(3 if version == 3 else 2), folder, variables)

    return machine_of


def answers(scripts: Sequence[list[str]], machine: Machine) -> list[list[Answer]]:
    """Run sequences of calls one after the other in one instance."""
    found = iter(machine.answers(list(chain.from_iterable(scripts))))
    return [[next(found) for _ in script] for script in scripts]


def at_a_tie(script: list[str], ours: list[Answer], linux: Machine) -> bool:
    """Whether the last digits of start state and steps decide, as for a mass at rest in balance."""
    chance = random.Random(1)
    moved = answers([neighbour(script, chance) for _ in range(NEIGHBOURS)], linux)
    return any(not differences(script, ours, each).small for each in moved)


@versions
@others
def test_the_same_happens_as_on_linux(name: str, version: int, on: On) -> None:
    # Statuses, messages, events are the same, values within the tolerance; ties alone differ.
    count = SEQUENCES[version]
    scripts = [list(chain.from_iterable(sequence(seed))) for seed in range(count)]
    linux = on(LINUX, version)
    expected, given = answers(scripts, linux), answers(scripts, on(name, version))
    values = ties = 0
    for number, (script, ours, theirs) in enumerate(zip(scripts, expected, given, strict=True)):
        found = differences(script, ours, theirs)
        if found.small:
            assert found.same_messages, number
            values += found.values
        else:
            assert at_a_tie(script, ours, linux), (number, found)
            ties += 1
    assert values > 200 * count
    # One sequence in a hundred is at a tie.
    assert ties <= count // 100


def some_number(chance: random.Random) -> float:
    """Return a number of any size, with few digits or many."""
    size = chance.choice((1.0, 1e-5, 1e16, 1e22, 5e-324, 2.0 ** chance.randint(-1074, 1023)))
    wide = log_uniform(chance, 1e-300, 1e300)
    return chance.choice((size, wide, float(f"{wide:.3g}"), float(chance.randint(1, 10**6))))


def refusals(count: int) -> tuple[list[str], set[str]]:
    """Return calls of which some are refused, and texts of which each is in a message."""
    chance = random.Random(1)
    calls, texts = [], {"nan", "inf"}
    for _ in range(count):
        number = some_number(chance)
        begin = start({}, 0.0)
        calls += chance.choice(
            (
                [*begin, set_values({"k": -number}), *READ],
                [*begin, line("step", 0.0, -number), "save"],
                ["reset", set_values({"mu_s": -number}), "setup 0x0p+0"],
            )
        )
        texts.add(repr(-number))
    for value in ("nan", "inf", "-inf"):
        calls += ["reset", f"set 2 {value}", "reset", f"setup {value}", "enter"]
    calls += ["reset", "exit", "reset", "step 0x0p+0 0x1p+0", "reset", "set 12 0x1p+0"]
    calls += ["reset", "integer 2", "reset", "real 99", "reset", "read 00", "terminate", "enter"]
    return calls, texts


@versions
@others
def test_statuses_and_messages_of_refused_calls_are_the_same(
    name: str, version: int, on: On
) -> None:
    calls, texts = refusals(2_000)
    ours, theirs = (on(each, version).answers(calls) for each in (LINUX, name))
    said = {message for answer in ours for message in answer.messages}
    assert len(said) > 1_000
    assert all(any(text in message for message in said) for text in texts)
    assert ours == theirs


@pytest.mark.parametrize(("writer", "reader"), PAIRS)
def test_a_state_travels_as_bytes(writer: str, reader: str, on: On) -> None:
    # What one platform writes another one reads, writes again alike, and goes on from.
    parts = [sequence(seed) for seed in range(TRAVELS)]
    befores = [[*chain(*each[:7]), "write"] for each in parts]
    afters = [[*READ, *chain(*each[7:])] for each in parts]
    whole = [[*one, "write", *other] for one, other in zip(befores, afters, strict=True)]
    written = answers(whole, on(writer, 2))
    sound = [n for n in range(TRAVELS) if written[n][len(befores[n]) - 1].status == 0]
    assert len(sound) > 0.9 * TRAVELS
    bytes_of = {n: written[n][len(befores[n]) - 1].read for n in sound}
    scripts = [["reset", line("read", *bytes_of[n]), "write", *afters[n]] for n in sound]
    for n, (_, _, again, *given) in zip(sound, answers(scripts, on(reader, 2)), strict=True):
        once, *expected = written[n][len(befores[n]) :]
        assert again == once, n
        found = differences(afters[n], expected, given)
        assert found.small, (n, found)
        assert writer != reader or found.largest == 0.0, n
