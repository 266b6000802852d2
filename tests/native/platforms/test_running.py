"""The native FMU on Linux ARM64 and on Windows does what it does on Linux x86-64."""

import random
import subprocess
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from itertools import chain

import pytest

from tests.native.bits import spread
from tests.native.platforms.running import (
    ARM,
    LINUX,
    READ,
    REALS,
    WINDOWS,
    Answer,
    Differences,
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
from tests.needs import ARM_LIBRARIES, WINE, needs

pytestmark = needs("zig")

NEEDS = {ARM: needs("qemu"), WINDOWS: needs("wine")}
OTHERS = [pytest.param(name, marks=need) for name, need in NEEDS.items()]
PAIRS = [
    pytest.param(one, other, marks=[NEEDS[each] for each in {one, other} - {LINUX}])
    for one in (LINUX, ARM, WINDOWS)
    for other in (LINUX, ARM, WINDOWS)
]
# Of the FMU 2.0, and of the FMU 3.0, which differs in its face alone.
SEQUENCES = {2: 5_000, 3: 500}
TRAVELS = 200
NEIGHBOURS = 8

On = Callable[[str, int], Machine]
Runs = list[tuple[list[str], list[Answer]]]


@pytest.fixture(scope="session")
def windows(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Mapping[str, str]]:
    """Give the variables of a Windows of these tests' own."""
    with wine(tmp_path_factory.mktemp("windows") / "wine") as variables:
        yield variables


@pytest.fixture(scope="session")
def on(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> On:
    """Give the machine of a platform and FMI version, made when it is first asked for."""

    @cache
    def machine_of(name: str, face: int) -> Machine:
        variables = request.getfixturevalue("windows") if name == WINDOWS else {}
        fmu = request.getfixturevalue("all_path" if face == 2 else "all3_path")
        return machine(name, fmu, tmp_path_factory.mktemp(f"(x86) a+b {name}"), variables)

    return machine_of


def runs(scripts: Sequence[list[str]], machine: Machine) -> Runs:
    """Run sequences of calls one after the other in one instance."""
    answers = iter(machine.answers(list(chain.from_iterable(scripts))))
    return [(script, [next(answers) for _ in script]) for script in scripts]


def at_a_tie(script: list[str], answers: list[Answer], linux: Machine) -> bool:
    """Whether the last digit of the start state or of a step decides what happens in a sequence.

    So it is where the mass has come to rest in balance, and rounding alone is left to move it.
    """
    random_ = random.Random(1)
    moved = [neighbour(script, random_) for _ in range(NEIGHBOURS)]
    return any(not differences(script, answers, each).small for _, each in runs(moved, linux))


def table(found: Sequence[Differences]) -> list[str]:
    """Return a line for each output with a difference: how many values, and the largest part."""
    lines = []
    for name in (row.name for row in REALS):
        count = sum(each.differing[name] for each in found)
        largest = max(each.largest[name] for each in found)
        if count:
            lines.append(
                f"    {name:12} {count:6} values differ, by {largest:.1e} of scale at most"
            )
    return lines


@pytest.mark.parametrize("face", SEQUENCES)
@pytest.mark.parametrize("name", OTHERS)
def test_the_same_happens_as_on_linux(name: str, face: int, on: On, report: list[str]) -> None:
    """Statuses, messages, events are the same, values within the tolerance; ties alone differ."""
    count = SEQUENCES[face]
    scripts = [list(chain.from_iterable(sequence(seed))) for seed in range(count)]
    linux = on(LINUX, face)
    expected, given = runs(scripts, linux), runs(scripts, on(name, face))
    found, ties = [], []
    for number, ((script, ours), (_, theirs)) in enumerate(zip(expected, given, strict=True)):
        difference = differences(script, ours, theirs)
        if difference.small:
            assert difference.same_messages, number
            found.append(difference)
        else:
            assert at_a_tie(script, ours, linux), (number, difference)
            ties.append(number)
    values = sum(each.values for each in found)
    same = values - sum(sum(each.differing.values()) for each in found)
    assert values > 200 * count
    # One sequence in a hundred is at a tie.
    assert len(ties) <= count // 100
    report.append(
        f"{name}, FMI {face}.0, {count} sequences: {same} of {values} values have the bits of "
        f"{LINUX}; sequences that differ at a tie: {len(ties)}"
    )
    report.extend(table(found))


def some_number(random_: random.Random) -> float:
    """Return a number of any size, with few digits or many."""
    size = random_.choice((1.0, 1e-5, 1e16, 1e22, 5e-324, 2.0 ** random_.randint(-1074, 1023)))
    wide = spread(random_, 1e-300, 1e300)
    return random_.choice((size, wide, float(f"{wide:.3g}"), float(random_.randint(1, 10**6))))


def refusals(count: int) -> tuple[list[str], list[str]]:
    """Return calls of which some are refused, and a text that is in a message of each block."""
    random_ = random.Random(1)
    calls, texts = [], []
    for _ in range(count):
        number = some_number(random_)
        text = repr(-number)
        begin = start({}, 0.0)
        calls += random_.choice(
            (
                [*begin, set_values({"k": -number}), *READ],
                [*begin, line("step", 0.0, -number), "save"],
                ["reset", set_values({"mu_s": -number}), "setup 0x0p+0"],
            )
        )
        texts.append(text)
    return calls, texts


@pytest.mark.parametrize("face", SEQUENCES)
@pytest.mark.parametrize("name", OTHERS)
def test_messages_are_the_same(name: str, face: int, on: On) -> None:
    """Refused values, steps, phases and references have the same status and text everywhere."""
    calls, texts = refusals(2_000)
    for value in ("nan", "inf", "-inf"):
        calls += ["reset", f"set 2 {value}", "reset", f"setup {value}", "enter"]
        texts += [value.removeprefix("-")] * 2
    calls += ["reset", "exit", "reset", "step 0x0p+0 0x1p+0", "reset", "set 12 0x1p+0"]
    calls += ["reset", "integer 2", "reset", "real 99", "reset", "read 00", "terminate", "enter"]
    ours, theirs = (on(each, face).answers(calls) for each in (LINUX, name))
    said = [message for answer in ours for message in answer.messages]
    assert len(set(said)) > 1_000
    assert all(any(text in message for message in said) for text in set(texts))
    assert ours == theirs


def blocks(count: int) -> Iterator[tuple[list[str], list[str]]]:
    """Give the calls of sequences before and after a point in their middle."""
    for seed in range(count):
        parts = sequence(seed)
        yield [*chain(*parts[:7]), "write"], ["write", *READ, *chain(*parts[7:])]


@pytest.mark.parametrize(("writer", "reader"), PAIRS)
def test_a_state_travels_as_bytes(writer: str, reader: str, on: On) -> None:
    """What one platform writes another one reads, writes again alike, and goes on from."""
    befores, afters = zip(*blocks(TRAVELS), strict=True)
    written = runs([[*one, *other] for one, other in blocks(TRAVELS)], on(writer, 2))
    bytes_of = [answers[len(one) - 1] for one, (_, answers) in zip(befores, written, strict=True)]
    kept = [n for n, answer in enumerate(bytes_of) if answer.status == 0]
    assert len(kept) > 0.9 * TRAVELS
    again = runs(
        [["reset", line("read", *bytes_of[n].read), *afters[n]] for n in kept], on(reader, 2)
    )
    for n, (_, answers) in zip(kept, again, strict=True):
        expected = written[n][1][len(befores[n]) :]
        given = answers[2:]
        assert given[0] == expected[0], n
        found = differences(afters[n][1:], expected[1:], given[1:])
        assert found.small, (n, found)
        assert writer != reader or not any(found.differing.values()), n


@pytest.mark.parametrize("name", OTHERS)
def test_a_state_before_the_motion_is_the_same_bytes(name: str, on: On) -> None:
    """The format knows neither the order of bytes nor the size of types of a platform."""
    calls = list(chain.from_iterable([*sequence(seed, 0)[0], "write"] for seed in range(TRAVELS)))
    ours, theirs = (on(each, 2).answers(calls) for each in (LINUX, name))
    for call, one, other in zip(calls, ours, theirs, strict=True):
        if call == "write":
            assert one == other
    assert len({answer.read for answer in ours}) > TRAVELS


def said_by(*command: str) -> str:
    """Return the first line that a program says."""
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return done.stdout.splitlines()[0]


@pytest.mark.parametrize("name", OTHERS)
def test_the_versions_are_reported(name: str, report: list[str]) -> None:
    """The report of this run says with what the platform was tried."""
    if name == ARM:
        loader = f"{ARM_LIBRARIES}/lib/ld-linux-aarch64.so.1"
        said = said_by("qemu-aarch64", "--version")
        said += f"; {said_by('qemu-aarch64', '-L', ARM_LIBRARIES, loader, '--version')}"
    else:
        said = said_by(WINE, "--version")
    report.append(f"{name} was run by {said}")
