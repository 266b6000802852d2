"""Whatever is called, in whatever order, the native FMU keeps to its memory."""

import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Literal

import pytest

from stickslip_native.packer import sources_of
from tests.conftest import Sized, built
from tests.driver import Host
from tests.fmu.lives.master import Master
from tests.fmu.lives.test_lives import finding
from tests.native.compiling import run, with_library, written
from tests.native.eventful import differences
from tests.native.heard import live_blocks
from tests.native.test_native_states import running
from tests.needs import needs

FUZZ = Path(__file__).parent / "fuzz"
FIRST = 1_000_000
"""Seed of the first life: none of those of tests/fmu/lives."""
LIVES = {"coulomb": 8_000, "stribeck": 2_000}
"""Number of lives at full size."""

# Any finding of a sanitizer ends the process.
SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")
FLAGS = ("-std=c99", "-O1", "-g", "-ffp-contract=off", "-fPIC", "-fno-omit-frame-pointer")
# The library counts its blocks of memory: what Python itself keeps is no leak of the FMU.
COUNTING = ("-shared", "-Wl,-Bsymbolic", "-Wl,--wrap=malloc,--wrap=calloc,--wrap=free")


@pytest.fixture(scope="module")
def guarded() -> Iterator[Host]:
    """Give a process with the runtime of the sanitizers, which must be there before Python."""
    runtime = run("gcc", "-print-file-name=libasan.so").strip()
    host = Host(
        LD_PRELOAD=runtime, ASAN_OPTIONS="detect_leaks=0", UBSAN_OPTIONS="print_stacktrace=1"
    )
    yield host
    host.end()


def sanitized(version: Literal[2, 3], law: str, folder: Path) -> Path:
    files = [*written(sources_of(version, law), folder), FUZZ / "counting.c"]
    library = folder / "sanitized.so"
    run("gcc", *FLAGS, *SANITIZERS, *COUNTING, *files, "-o", library, "-lm")
    return with_library(built(f"native-{version}", law), library, folder / "sanitized.fmu")


@needs("sanitizers")
@pytest.mark.parametrize(("version", "law"), [(2, "coulomb"), (3, "stribeck")])
def test_no_life_leaves_its_memory_leaks_or_misleads(
    version: Literal[2, 3], law: str, guarded: Host, tmp_path: Path, sized: Sized
) -> None:
    fmu = sanitized(version, law, tmp_path)
    for first in range(FIRST, FIRST + sized(LIVES[law]), 100):
        masters = [Master(f"native-{version}", law, seed) for seed in range(first, first + 100)]
        assert finding(guarded, fmu, [master.life() for master in masters]) is None
        assert guarded.call(live_blocks, fmu) == 0
    for seed in range(sized(100) if version == 3 else 0):
        assert not guarded.call(differences, fmu, seed)


# With fewer transitions in a step an input takes milliseconds and not seconds.
LONG, SHORT = b"MOST_TRANSITIONS = 1 << 24", b"MOST_TRANSITIONS = 1 << 13"


@pytest.mark.soak
@needs("libfuzzer")
def test_no_bytes_that_are_taken_for_a_state_do_harm(tmp_path: Path) -> None:
    corpus = tmp_path / "corpus"
    corpus.mkdir()
    for n in range(40):
        # The harness makes head and checksum.
        state = running("coulomb", n).pack()[24:-8]
        (corpus / f"state{n}").write_bytes(state)
    sources = sources_of(2)
    assert sources["block.h"].count(LONG) == 1
    sources["block.h"] = sources["block.h"].replace(LONG, SHORT)
    files = [*written(sources, tmp_path / "sources"), FUZZ / "states.c"]
    fuzzer = tmp_path / "fuzzer"
    sanitizers = ("-fsanitize=fuzzer,address,undefined", "-fno-sanitize-recover=all")
    run("clang", *FLAGS, *sanitizers, f"-I{tmp_path}/sources", *files, "-o", fuzzer, "-lm")
    done = subprocess.run(
        [fuzzer, "-seed=1", "-runs=200000", "-max_len=900", "-timeout=60", corpus],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-3000:]
