"""Whatever is called, in whatever order: the native FMU lives, and answers as it promises."""

import json
import os
import re
import signal
import subprocess
import sys
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import fmpy
import pytest

from stickslip_native.packer import sources_of
from tests.fmu.fuzz.variables import VARIABLES
from tests.native.planting import COUNTING, LINK
from tests.native.suite import Suite
from tests.needs import ROOT, needs

LIVES = {"coulomb": (20_000, 1_000_000), "stribeck": (1_000, 50_000)}
"""How many in the gate and in soak; a slip over the speed costs the block that judges more."""
SHARES = 2

# Any finding of a sanitizer ends the process.
_SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")
_FLAGS = ("-std=c99", "-O1", "-g", "-ffp-contract=off", "-fPIC", "-fno-omit-frame-pointer")

OK, DISCARD, ERROR = 0, 2, 3
# What each function must have given at least once in the set, or it is too tame.
MET = {
    *((name, status) for name in ("enter", "exit", "set_up", "step", "terminate", "get_state",
                                  "set_state", "deserialize") for status in (OK, ERROR)),
    *((f"{verb} {kind}", status) for verb in ("get", "set")
      for kind in ("Real", "Integer", "Boolean", "String") for status in (OK, ERROR)),
    *((name, OK) for name in ("instantiate", "free", "reset", "free_state", "free_again",
                              "serialize", "debug", "version", "status")),
    *((name, ERROR) for name in ("cancel", "derivatives", "set_freed", "set_null")),
    ("status", DISCARD),
}  # fmt: skip
# There is no Boolean and no String to set, only an empty list of them: of these a thousand lives
# may do without.
RARE = {("set Boolean", OK), ("set String", OK)}


@dataclass
class Played:
    """What came of sequences: the first finding or "", how often a function gave a status."""

    found: str
    counts: Counter[tuple[str, int]]


def compiled(
    folder: Path,
    sources: dict[str, bytes],
    compiler: str,
    more: tuple[str, ...] = (),
    law: str = "coulomb",
) -> Path:
    """Compile the library of an unpacked FMU in a folder, and return it."""
    binary: Path = folder / "binaries" / fmpy.platform / f"{VARIABLES[law].spec.name}.so"
    binary.parent.mkdir(parents=True)
    for name, content in sources.items():
        (folder / name).write_bytes(content)
    files = [COUNTING, *(folder / name for name in sources if name.endswith(".c"))]
    _run(compiler, *_FLAGS, *more, *LINK, *files, "-o", binary, "-lm")
    return binary


def _identity(sources: dict[str, bytes]) -> str:
    found = re.search(rb'"(.*)"', sources["identity.h"])
    assert found is not None
    return found[1].decode()


def play(
    folder: Path, sources: dict[str, bytes], first: int, count: int, law: str = "coulomb"
) -> Played:
    """Play sequences on the sources, compiled with sanitizers in a folder."""
    compiled(folder, sources, "gcc", _SANITIZERS, law)
    words = (folder, _identity(sources), law, str(first), str(count))
    done = subprocess.run(
        [sys.executable, "-m", "tests.native.fuzz.player", *words],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
        env={
            **os.environ,
            # The interpreter is not compiled with sanitizers, so their runtime is loaded before it.
            # What Python itself keeps till its end is no leak of the FMU: its blocks are counted.
            "LD_PRELOAD": _run("gcc", "-print-file-name=libasan.so").strip(),
            "ASAN_OPTIONS": "detect_leaks=0",
            "UBSAN_OPTIONS": "print_stacktrace=1",
        },
    )
    if done.returncode != 0:
        seed = (folder / "seed").read_text().strip()
        why = re.search(r"^.*(ERROR: AddressSanitizer|runtime error).*$", done.stderr, re.MULTILINE)
        end = signal.Signals(-done.returncode).name if done.returncode < 0 else done.returncode
        said = why[0] if why else done.stderr[-500:]
        return Played(f"seed {seed}: the process ends by {end}: {said}", Counter())
    told = json.loads(done.stdout)
    counts = Counter({(name, status): number for name, status, number in told["counts"]})
    return Played("".join(told["found"]), counts)


def _run(*command: str | Path) -> str:
    return subprocess.run(
        list(map(str, command)), check=True, stdout=subprocess.PIPE, text=True
    ).stdout


@needs("sanitizers")
@pytest.mark.parametrize("share", range(SHARES))
@pytest.mark.parametrize("law", VARIABLES)
def test_no_sequence_of_calls_crashes_leaks_or_misleads(
    tmp_path: Path, pytestconfig: pytest.Config, law: str, share: int
) -> None:
    """Random lives give the status, values and words that are promised, in sound memory."""
    in_gate, in_soak = LIVES[law]
    count = (in_soak if pytestconfig.getoption("soak") else in_gate) // SHARES
    played = play(tmp_path, sources_of(2, law), 1 + share * count, count, law)
    again = f"python -m tests.native.fuzz.player FOLDER IDENTITY {law} SEED 1"
    assert not played.found, f"{played.found}\n{again}"
    missed = MET - played.counts.keys()
    assert missed <= (RARE if count <= LIVES["stribeck"][0] else set()), missed


FAULTS = {
    "reads beyond the table": (
        ("instance.c", b"return reference < VARIABLES && ", b"return "),
        "runtime error: index|AddressSanitizer",
    ),
    "writes beyond the bytes": (
        ("bytes.c", b"return stream.at + HASH_SIZE;", b"return stream.at;"),
        "AddressSanitizer: heap-buffer-overflow",
    ),
    "uses a state that was freed": (
        ("instance.c", b"state->mark = ~it->mark;\n", b"free(state);\n        return true;\n"),
        "AddressSanitizer: heap-use-after-free",
    ),
    "leaks freed states": (
        ("instance.c", b"        free(state);\n", b""),
        "blocks of memory are left",
    ),
    "hangs": (
        ("block.c", b"if (block->changed) {", b"while (step == 2.0) block->stale = true;\n    {"),
        "SIGPROF",
    ),
}


@needs("sanitizers")
@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_of_memory_is_found(tmp_path: Path, fault: str) -> None:
    """Sources that leave their memory, leak or hang are found out within 300 sequences."""
    (name, sound, faulty), reason = FAULTS[fault]
    sources = sources_of(2)
    assert sources[name].count(sound) == 1
    sources[name] = sources[name].replace(sound, faulty)
    assert re.search(reason, play(tmp_path, sources, 1, 300).found)


HARNESS = Path(__file__).parent / "fuzz" / "states.c"
# With fewer transitions in a step an input takes milliseconds and not seconds.
_LONG, _SHORT = b"MOST_TRANSITIONS = 1 << 24", b"MOST_TRANSITIONS = 1 << 13"


def fuzz_states(folder: Path, sources: dict[str, bytes], runs: int) -> str:
    """Try bytes as states, beginning with those of real runs; return what libFuzzer found."""
    corpus = folder / "corpus"
    corpus.mkdir()
    binary = compiled(folder, sources, "cc")
    with Suite() as suite:
        states = suite.states(binary.parents[2], _identity(sources), 300)
    for n, state in enumerate(states):
        # The harness makes head and checksum.
        (corpus / f"state{n}").write_bytes(state[24:-8])
    assert sources["block.h"].count(_LONG) == 1
    (folder / "block.h").write_bytes(sources["block.h"].replace(_LONG, _SHORT))
    files = [HARNESS, *(folder / name for name in sources if name.endswith(".c"))]
    fuzzer = folder / "fuzzer"
    sanitizers = ("-fsanitize=fuzzer,address,undefined", "-fno-sanitize-recover=all")
    _run("clang", *_FLAGS, *sanitizers, f"-I{folder}", *files, "-o", fuzzer, "-lm")
    done = subprocess.run(
        [fuzzer, "-seed=1", f"-runs={runs}", "-max_len=900", "-timeout=60", corpus],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    return "" if done.returncode == 0 else done.stderr


# Whether the phase of a state is one, at the end of a switch.
_SOUND, _FAULTY = b"default: return false;", b"default: return true;"


@pytest.mark.soak
@needs("libfuzzer")
def test_no_bytes_of_a_state_do_harm(tmp_path: Path) -> None:
    """Of 200,000 inputs none that is taken as a state leaves the memory, hangs or is not kept."""
    assert fuzz_states(tmp_path, sources_of(2), 200_000) == ""


@pytest.mark.soak
@needs("libfuzzer")
def test_a_state_that_is_not_checked_is_found(tmp_path: Path) -> None:
    """A phase that no instance has is an index out of range: libFuzzer comes upon it."""
    sources = sources_of(2)
    assert sources["bytes.c"].count(_SOUND) == 1
    sources["bytes.c"] = sources["bytes.c"].replace(_SOUND, _FAULTY)
    assert "runtime error: index" in fuzz_states(tmp_path, sources, 100_000)
