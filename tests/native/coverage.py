"""Lines and branches of the C sources that the tests run.

``python -m tests.native.coverage`` compiles the native core and FMU with gcc's counters, tries them
on what is compared by bits and on random lives, and prints what gcov counted. It exits with 1 where
block and friction law stay below 95 %.
"""

import contextlib
import gzip
import json
import math
import sys
import tempfile
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from stickslip_native.named import HOME
from stickslip_native.packer import build, sources_of
from tests.driver import Refused, loaded
from tests.fmu.lives.master import Master
from tests.fmu.lives.player import play
from tests.native.bits import comparisons
from tests.native.compiling import run, with_library, written
from tests.native.core import Core, sources
from tests.native.eventful import differences
from tests.native.saved import changed
from tests.native.test_native_model_exchange import of_random_settings, retuned
from tests.native.test_native_ramps import INPUTS, REST, drawn, moving, ramped
from tests.native.test_native_states import BELOW_ZERO, IMPOSSIBLE, table_of

LEAST = 95.0
"""Part of the lines and of the branches of block and friction law that must be run [%]."""
SEQUENCES = {"coulomb": 3_000, "stribeck": 2_000}
LIVES = 1_000
EVENTFUL = 20
RAMPS = 400

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


@dataclass
class Counts:
    lines: Counter[int] = field(default_factory=Counter)
    branches: Counter[tuple[int, int]] = field(default_factory=Counter)


def counting(folder: Path, texts: dict[str, bytes]) -> Path:
    for file in written(texts, folder):
        run("gcc", *_FLAGS, "-c", file, "-o", file.with_suffix(".o"))
    for file in written({"write.c": _WRITE.encode()}, folder):
        run("gcc", "-std=c99", "-fPIC", "-c", file, "-o", file.with_suffix(".o"))
    run("gcc", *_LINK, *sorted(folder.glob("*.o")), "-o", folder / "counting.so", "-lm")
    return folder / "counting.so"


def try_core(folder: Path, law: str) -> None:
    core = Core(counting(folder, sources(law)), law)
    for _, pairs in comparisons(core, law, SEQUENCES[law]):
        for _ in pairs:
            pass
    core.calls.write_counters()


def try_fmu(folder: Path, law: str) -> None:
    library = counting(folder, sources_of(2, law))
    sound = build(folder / "sound", this_machine=True, law=law)
    fmu = with_library(sound, library, folder / "counting.fmu")
    masters = [Master("native-2", law, seed) for seed in range(LIVES)]
    play(str(fmu), [[call for call, _ in master.life()] for master in masters])
    for seed in range(RAMPS):
        start, given = drawn(law, seed)
        if law == "coulomb":
            start["tau_s"] = (seed % 3) * 0.01
        for times, more in ((1, {}), (3, {"c": 3e4}), (2, {"mu_s": 0.0, "mu_k": 0.0, "mu_1": 0.0})):
            known = {name: value for name, value in more.items() if name in loaded(fmu).references}
            with contextlib.suppress(Refused):
                ramped(loaded(fmu), *given, pieces=times, **start | known)
    for step, rate in ((-1.0, 1.0), (1.0, -1e6), (1.0, 1e308), (1e4, 1e-3)):
        with contextlib.suppress(Refused):
            ramped(loaded(fmu), step, REST, dict.fromkeys(INPUTS, rate), k=1e8, m=1e-4)
    for time in (math.inf, 1e308):
        instance = loaded(fmu).started(k=1e300)
        moving(instance, {"v": 1.0})
        instance.status("DoStep", time, 1e300, 1)
    forged = [(name, value) for name, values in IMPOSSIBLE.items() for value in values]
    forged += [*((name, -1.0) for name in BELOW_ZERO), ("x_start.low", 1.0), ("wanted.m", 5.0)]
    for name, value in [*forged, ("mode", 1)]:
        instance = loaded(fmu).started()
        with contextlib.suppress(Refused):
            instance.unpack(changed(instance.pack(), table_of(law), {name: value}))
    loaded(fmu).library.write_counters()


def try_events(folder: Path, law: str) -> None:
    library = counting(folder, sources_of(3, law))
    sound = build(folder / "sound", this_machine=True, law=law, face=3)
    fmu = with_library(sound, library, folder / "counting.fmu")
    for seed in range(EVENTFUL):
        differences(str(fmu), seed)
        of_random_settings(fmu, fmu, seed)
    retuned(fmu, 1000.0, 2000.0, 1000.0)
    loaded(fmu).library.write_counters()


def counted(folder: Path, found: dict[str, Counts]) -> None:
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
    together: dict[str, Counts] = {}
    with tempfile.TemporaryDirectory(prefix="coverage-") as name:
        folder = Path(name)
        for law in SEQUENCES:
            try_core(folder / f"core-{law}", law)
            try_fmu(folder / f"fmu-{law}", law)
            try_events(folder / f"events-{law}", law)
        for place in folder.iterdir():
            counted(place, together)
    return together


def main() -> int:
    together = run_all()
    total, lacking = Counter[str](), []
    files = (each for each in HOME.rglob("*.c") if each.name in together)
    for file in sorted(each for each in files if each.parent.name != "face"):
        counts, code = together[file.name], file.read_text().splitlines()
        parts = {"lines": counts.lines.values(), "branches": counts.branches.values()}
        print(f"{file.parent.name}/{file.name}: " + ", ".join(
            f"{sum(map(bool, part))} of {len(part)} {what}" for what, part in parts.items()
        ))  # fmt: skip
        for what, part in parts.items():
            total[f"{what} run"] += sum(map(bool, part))
            total[what] += len(part)
        missed = {line for line, times in counts.lines.items() if not times}
        missed |= {line for (line, _), times in counts.branches.items() if not times}
        lacking += [f"{file.name}:{line}: {code[line - 1].strip()}" for line in sorted(missed)]
    print("\n  ".join(["\nNot run whole, of block and friction law:", *lacking]))
    percents = {what: 100.0 * total[f"{what} run"] / total[what] for what in ("lines", "branches")}
    for what, percent in percents.items():
        print(f"{percent:.1f} % of {total[what]} {what}")
    return 0 if min(percents.values()) >= LEAST else 1


if __name__ == "__main__":
    sys.exit(main())
