"""Lines and branches of the C sources that the suite and the tests run.

``python -m tests.native.coverage`` compiles the native FMU with gcc's counters, tries it on the
cases and random sequences of the suite, on random calls, damaged states and the sequences of the
bits, and prints what gcov counted. It exits with 1 where block and friction law stay below 95 %.
"""

import gzip
import json
import re
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import fmpy

from fmukit.model import Spec
from stickslip_fmu.spec import SPEC
from stickslip_native.named import HOME, native_law
from stickslip_native.packer import build, sources_of
from stickslip_native.table import table_files
from stickslip_verification import load_cases, verify
from stickslip_verification.suite.sequences import COUNT
from tests.native.bits import STRIBECK, draw_stribeck, sequence
from tests.native.core import ACCEPTED, CORE, Core
from tests.native.fuzz.damage import taken
from tests.native.fuzz.player import findings, opened
from tests.native.planting import pack
from tests.native.suite import Suite
from tests.native.test_native_limits import (
    MOST_SLIPS,
    beyond_the_numbers,
    refused_of_itself,
    shown_after_a_long_step,
    slips_after_the_most,
)

LEAST = 95.0
"""Part of the lines and of the branches of block and friction law that must be run [%]."""

_FLAGS = ("-std=c99", "-O0", "--coverage", "-ffp-contract=off", "-fPIC")
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

    def add(self, other: "Counts") -> None:
        """Add the counts of another run."""
        self.lines.update(other.lines)
        self.branches.update(other.branches)


def _run(*command: str | Path, cwd: Path) -> None:
    subprocess.run(list(map(str, command)), cwd=cwd, check=True, stdout=subprocess.DEVNULL)


def _instrumented(folder: Path, sources: Mapping[str, bytes]) -> Path:
    """Compile sources in a folder, as that of an unpacked FMU; return the library."""
    binary: Path = folder / "binaries" / fmpy.platform / "StickSlip.so"
    binary.parent.mkdir(parents=True)
    helpers = {"write.c": _WRITE}
    link = ["--coverage", "-shared", "-Wl,-Bsymbolic"]
    if "instance.c" in sources:
        helpers["at_end.c"] = _WRITE_AT_END
        link.append("-Wl,--wrap=instance_free")
    for name, content in sources.items():
        (folder / name).write_bytes(content)
    for name in sources:
        if name.endswith(".c"):
            _run("gcc", *_FLAGS, "-c", name, cwd=folder)
    for name, text in helpers.items():
        (folder / name).write_text(text)
        _run("gcc", "-std=c99", "-fPIC", "-c", name, cwd=folder)
    _run("gcc", *link, *sorted(folder.glob("*.o")), "-o", binary, "-lm", cwd=folder)
    return binary


def _core(spec: Spec, law: Iterable[Path]) -> dict[str, bytes]:
    """Return the sources of the block without faces, with the files of a law."""
    files = [*CORE.glob("*.[ch]"), *law]
    made = {name: text.encode() for name, text in table_files(spec).items()}
    return made | {file.name: file.read_bytes() for file in files}


def _counted(folder: Path) -> dict[str, Counts]:
    """Return the counts by source."""
    found: dict[str, Counts] = {}
    for data in sorted(folder.glob("*.gcda")):
        _run("gcov", "--json-format", "--branch-probabilities", data.name, cwd=folder)
    for file in folder.glob("*.gcov.json.gz"):
        for source in json.loads(gzip.decompress(file.read_bytes()))["files"]:
            counts = found.setdefault(source["file"], Counts())
            for line in source["lines"]:
                number = line["line_number"]
                counts.lines[number] += line["count"]
                for n, branch in enumerate(line["branches"]):
                    counts.branches[number, n] += branch["count"]
    return found


def _try_suite(folder: Path, library: Path) -> None:
    fmu = pack(build(folder, this_machine=True), library, folder / "counting.fmu")
    verdict = verify(fmu, load_cases(), sequences=COUNT)
    assert verdict.passed, "the FMU with counters fails the suite"


def _try_calls(folder: Path) -> None:
    identity = re.search(r'"(.*)"', (folder / "identity.h").read_text())
    assert identity is not None
    raw = opened(folder, identity[1])
    assert not findings(raw, range(1_000), Counter())
    assert not taken(raw)
    assert slips_after_the_most(raw) == MOST_SLIPS
    shown_after_a_long_step(raw)
    beyond_the_numbers(raw)


def _try_bits(library: Path, spec: Spec, count: int, *how: Any) -> None:
    core = Core(library, spec)
    for seed in range(count):
        for _ in sequence(core, spec, seed, *how):
            pass
    core.calls.write_counters()


def _run_all() -> dict[str, Counts]:
    """Run everything; return the counts by source."""
    together: dict[str, Counts] = {}
    with tempfile.TemporaryDirectory(prefix="coverage-") as name:
        folder = Path(name, "fmu")
        library = _instrumented(folder, sources_of(2))
        _try_suite(folder, library)
        _try_calls(folder)
        assert refused_of_itself(Core(library, SPEC)) != ACCEPTED
        _try_bits(library, SPEC, 3_000)
        # In FMI 3.0 the first step tells the start time.
        folder = Path(name, "fmi3")
        library = _instrumented(folder, sources_of(3))
        fmu = pack(build(folder, face=3, this_machine=True), library, folder / "counting.fmu")
        with Suite() as suite:
            assert not suite.failing(fmu, "starts-at-start-time", "")
        spec, files = native_law("stribeck")
        library = _instrumented(Path(name, "stribeck"), _core(spec, files))
        _try_bits(library, spec, 2_000, draw_stribeck, STRIBECK)
        for folder in Path(name).iterdir():
            for source, counts in _counted(folder).items():
                together.setdefault(source, Counts()).add(counts)
    return together


def main(say: Callable[[str], None] = print) -> int:
    """Run everything and print the table; return 1 where too little is run."""
    together = _run_all()
    rooms = {file.name: file.parent for file in HOME.rglob("*.c")}
    total, lacking = Counter[str](), []
    say(f"{'source':28}{'lines':>12}{'branches':>14}")
    for source in sorted(together, key=lambda each: (str(rooms.get(each, "")), each)):
        if source not in rooms:
            continue
        counts = together[source]
        parts = {
            "lines": list(counts.lines.values()),
            "branches": list(counts.branches.values()),
        }
        told = [f"{sum(map(bool, part)):5} of {len(part):3}" for part in parts.values()]
        say(f"{rooms[source].name + '/' + source:28}{told[0]:>12}{told[1]:>14}")
        if rooms[source].name == "face":
            continue
        for what, part in parts.items():
            total[f"{what} run"] += sum(map(bool, part))
            total[what] += len(part)
        code = rooms[source].joinpath(source).read_text().splitlines()
        missed = {line for line, times in counts.lines.items() if not times}
        missed |= {line for (line, _), times in counts.branches.items() if not times}
        lacking += [f"{source}:{line}: {code[line - 1].strip()}" for line in sorted(missed)]
    say("\nNot run whole, of block and friction law:")
    for line in lacking:
        say(f"  {line}")
    enough = True
    for what in ("lines", "branches"):
        percent = 100.0 * total[f"{what} run"] / total[what]
        enough = enough and percent >= LEAST
        say(f"{percent:.1f} % of {total[what]} {what}")
    return 0 if enough else 1


if __name__ == "__main__":
    sys.exit(main())
