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
from tests.native.planting import COUNTING, LINK
from tests.needs import ROOT, needs

IN_GATE, IN_SOAK = 20_000, 1_000_000
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


@dataclass
class Played:
    """What came of sequences: the first finding or "", how often a function gave a status."""

    found: str
    counts: Counter[tuple[str, int]]


def play(folder: Path, sources: dict[str, bytes], first: int, count: int) -> Played:
    """Play sequences on the sources, compiled with sanitizers in a folder."""
    binary = folder / "binaries" / fmpy.platform / "StickSlip.so"
    binary.parent.mkdir(parents=True)
    for name, content in sources.items():
        (folder / name).write_bytes(content)
    files = [COUNTING, *(folder / name for name in sources if name.endswith(".c"))]
    _run("gcc", *_FLAGS, *_SANITIZERS, *LINK, *files, "-o", binary, "-lm")
    identity = re.search(rb'"(.*)"', sources["identity.h"])
    assert identity is not None
    words = (folder, identity[1].decode(), str(first), str(count))
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
def test_no_sequence_of_calls_crashes_leaks_or_misleads(
    tmp_path: Path, pytestconfig: pytest.Config, share: int
) -> None:
    """20,000 random lives give the status, values and words that are promised, in sound memory."""
    count = (IN_SOAK if pytestconfig.getoption("soak") else IN_GATE) // SHARES
    played = play(tmp_path, sources_of(2), 1 + share * count, count)
    again = "python -m tests.native.fuzz.player FOLDER IDENTITY SEED 1"
    assert not played.found, f"{played.found}\n{again}"
    assert played.counts.keys() >= MET, MET - played.counts.keys()


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
