"""Lines and branches of the C sources that the suite and the tests run.

``python -m tests.native.coverage`` compiles the native FMU with gcc's counters, tries it on the
cases and random sequences of the suite, on the tests of calls, messages, states and lives, and on
what is compared by bits, and prints what gcov counted. It exits with 1 where block and friction
law stay below 95 %.
"""

import gzip
import json
import sys
import tempfile
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Literal

import pytest

from stickslip_native.named import HOME
from stickslip_native.packer import build, sources_of
from stickslip_verification import load_cases, verify
from stickslip_verification.suite.sequences import COUNT
from tests import driver
from tests.native.bits import comparisons
from tests.native.compiling import run, with_library, written
from tests.native.core import Core, sources
from tests.sharing import made_once

LEAST = 95.0
"""Part of the lines and of the branches of block and friction law that must be run [%]."""
SEQUENCES = {"coulomb": 3_000, "stribeck": 2_000}
TESTS = (
    *(f"tests/native/test_native_{name}.py" for name in ("calls", "messages", "states")),
    "tests/fmu/lives",
)

_FLAGS = ("-std=c99", "-O0", "--coverage", "-ffp-contract=off", "-fPIC")
_LINK = ("--coverage", "-shared", "-Wl,-Bsymbolic")
_WRITE = """\
void __gcov_dump(void);
void __gcov_reset(void);
void write_counters(void);

void write_counters(void)
{
    __gcov_dump();
    __gcov_reset();
}
"""
_WRITE_AT_END = """\
/* Writes the counters at the end of each instance: workers end without the end of a program. */
void write_counters(void);
void __real_instance_free(void *it);
void __wrap_instance_free(void *it);

void __wrap_instance_free(void *it)
{
    __real_instance_free(it);
    write_counters();
}
"""


@dataclass
class Counts:
    """What was run of one source: times by line, and by branch of a line."""

    lines: Counter[int] = field(default_factory=Counter)
    branches: Counter[tuple[int, int]] = field(default_factory=Counter)


def counting(folder: Path, texts: dict[str, bytes]) -> Path:
    """Compile sources in a folder with counters; return the library."""
    for file in written(texts, folder):
        run("gcc", *_FLAGS, "-c", file, "-o", file.with_suffix(".o"))
    helpers, link = {"write.c": _WRITE}, list(_LINK)
    if "instance.c" in texts:
        helpers["at_end.c"] = _WRITE_AT_END
        link.append("-Wl,--wrap=instance_free")
    for file in written({name: text.encode() for name, text in helpers.items()}, folder):
        run("gcc", "-std=c99", "-fPIC", "-c", file, "-o", file.with_suffix(".o"))
    run("gcc", *link, *sorted(folder.glob("*.o")), "-o", folder / "counting.so", "-lm")
    return folder / "counting.so"


class Instrumented:
    """A plugin of pytest: the native FMUs of this run have counters."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def pytest_sessionstart(self) -> None:
        """Make the FMUs before a test asks for them."""
        # Not of tests.conftest, which pytest must be the first to import.
        for kind in ("native-2", "native-3"):
            for law in SEQUENCES:
                made_once(f"{kind}-{law}", partial(self.pack, kind, law))

    def pytest_sessionfinish(self) -> None:
        """Write the counters of the FMUs in this process, whose instances are not freed."""
        for fmu in (each for each in driver._LOADED.values() if each.is_native):
            fmu.library.write_counters()

    def pack(self, kind: str, law: str, target: Path) -> None:
        """Build an FMU with counters into a folder."""
        version: Literal[2, 3] = 3 if kind == "native-3" else 2
        with tempfile.TemporaryDirectory() as name:
            sound = build(Path(name), face=version, this_machine=True, law=law)
            library = counting(self.folder / f"{kind}-{law}", sources_of(version, law))
            with_library(sound, library, target / sound.name)


def try_core(folder: Path, law: str) -> None:
    """Run the rare settings and the sequences of the bits."""
    core = Core(counting(folder, sources(law)), law)
    for _, pairs in comparisons(core, law, SEQUENCES[law]):
        for _ in pairs:
            pass
    core.calls.write_counters()


def counted(folder: Path, found: dict[str, Counts]) -> None:
    """Add what was run of the sources in a folder."""
    for data in sorted(folder.glob("*.gcda")):
        run("gcov", "--json-format", "--branch-probabilities", data.name, cwd=folder)
    for file in folder.glob("*.gcov.json.gz"):
        for source in json.loads(gzip.decompress(file.read_bytes()))["files"]:
            counts = found.setdefault(Path(source["file"]).name, Counts())
            for line in source["lines"]:
                number = line["line_number"]
                counts.lines[number] += line["count"]
                for n, branch in enumerate(line["branches"]):
                    counts.branches[number, n] += branch["count"]


def run_all() -> dict[str, Counts]:
    """Run everything; return the counts by source."""
    together: dict[str, Counts] = {}
    with tempfile.TemporaryDirectory(prefix="coverage-") as name:
        folder = Path(name)
        for law in SEQUENCES:
            try_core(folder / f"core-{law}", law)
        plugin = Instrumented(folder)
        for version in (2, 3):
            plugin.pack(f"native-{version}", "coulomb", folder)
        cases = load_cases()
        for fmu, some, count in (
            ("StickSlip_native.fmu", cases, COUNT),
            ("StickSlip_native_fmi3.fmu", cases[:1], 0),
        ):
            # The reference, which may be late on a busy machine, is not counted here.
            checks = verify(folder / fmu, some, sequences=count).checks
            assert not [each for each in checks if each.failed and each.side != "reference"]
        options = ["--gate", "-q", "-p", "no:cacheprovider", "-k", "native"]
        assert pytest.main([*options, *TESTS], plugins=[plugin]) == 0
        for place in folder.iterdir():
            counted(place, together)
    return together


def main(say: Callable[[str], None] = print) -> int:
    """Run everything and print the table; return 1 where too little is run."""
    together = run_all()
    total, lacking = Counter[str](), []
    for file in sorted(each for each in HOME.rglob("*.c") if each.name in together):
        counts, code = together[file.name], file.read_text().splitlines()
        parts = {"lines": counts.lines.values(), "branches": counts.branches.values()}
        say(f"{file.parent.name}/{file.name}: " + ", ".join(
            f"{sum(map(bool, part))} of {len(part)} {what}" for what, part in parts.items()
        ))  # fmt: skip
        if file.parent.name == "face":
            continue
        for what, part in parts.items():
            total[f"{what} run"] += sum(map(bool, part))
            total[what] += len(part)
        missed = {line for line, times in counts.lines.items() if not times}
        missed |= {line for (line, _), times in counts.branches.items() if not times}
        lacking += [f"{file.name}:{line}: {code[line - 1].strip()}" for line in sorted(missed)]
    say("\n  ".join(["\nNot run whole, of block and friction law:", *lacking]))
    percents = {what: 100.0 * total[f"{what} run"] / total[what] for what in ("lines", "branches")}
    for what, percent in percents.items():
        say(f"{percent:.1f} % of {total[what]} {what}")
    return 0 if min(percents.values()) >= LEAST else 1


if __name__ == "__main__":
    sys.exit(main())
