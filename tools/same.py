"""Says whether two reports, or two FMUs, are the same in all that must not change.

`python tools/same.py OLD NEW` takes two ``report.json`` or two ``.fmu``. Reports are compared row
by row: expected and found value, tolerance, verdict, and the kill matrix where both have one. FMUs
are compared by model description, value references, and the bits of all outputs on random
sequences. Differences are printed. Exit code 0: the same; 1: not; 2: wrong use.

Digests, dates and versions are left out: they tell that something changed, not what.
"""

from __future__ import annotations

import argparse
import json
import struct
import sys
import zipfile
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from random import Random
from typing import Any
from xml.etree import ElementTree

from stickslip_verification.drive.fmu.archive import FmuFile, available
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.fmu.instance import FmuInstance
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.random_sets import draws

COMPARED = (
    *("quantity", "truth", "class", "measure", "expected", "got", "tolerance"),
    *("verdict", "decides"),
)
"""What a row of a report is compared by."""

KILLS = "planted faults"

LEFT_OUT = ("guid", "generationTool", "generationDateAndTime", "version", "instantiationToken")
"""Attributes of a model description that are new at every change."""

PIECES = 3
"""Steps that an interval of a random sequence is cut into."""

MOST_SHOWN = 20
"""Differences that are printed."""

Rows = Mapping[str, Any]


def main() -> int:
    """Compare what the command line names; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("old", type=Path)
    parser.add_argument("new", type=Path)
    parser.add_argument("--sequences", type=int, default=200, help="random sequences for FMUs")
    parser.add_argument("--seed", type=int, default=1, help="names the random sequences")
    asked = parser.parse_args()
    files = (asked.old, asked.new)
    for file in files:
        if not file.is_file():
            parser.error(f"{file}: no such file")
    kinds = {file.suffix for file in files}
    try:
        return _compare(files, kinds, asked.seed, asked.sequences)
    except (OSError, ValueError, KeyError, TypeError, FmuError, zipfile.BadZipFile) as error:
        parser.error(f"cannot be compared: {type(error).__name__}: {error}")


def _compare(files: tuple[Path, Path], kinds: set[str], seed: int, sequences: int) -> int:
    """Compare two files of these kinds, print what differs, and return the exit code."""
    if kinds == {".json"}:
        parts = {"rows": report_rows, KILLS: report_kills}
        sides: list[dict[str, Rows]] = [
            {what: part(_report(file)) for what, part in parts.items()} for file in files
        ]
    elif kinds == {".fmu"}:
        sides = _of_fmus(files, seed, sequences)
    else:
        raise ValueError("give two report.json or two .fmu")
    different = 0
    for what in sides[0]:
        old, new = (side[what] for side in sides)
        if what == KILLS and not (old and new):
            print(f"{what}: no whole kill matrix in both, so not compared")
            continue
        found = list(differences(old, new))
        different += len(found)
        print(f"{what}: {len(old)} and {len(new)}, {len(found)} different")
        for line in found[:MOST_SHOWN]:
            print(f"  {line}")
        if len(found) > MOST_SHOWN:
            print(f"  and {len(found) - MOST_SHOWN} more")
    print("different" if different else "the same")
    return 1 if different else 0


def differences(old: Rows, new: Rows) -> Iterator[str]:
    """Give one line for each key that is not in both with the same value."""
    for key in sorted(old.keys() | new.keys()):
        if key not in new:
            yield f"{key}: gone"
        elif key not in old:
            yield f"{key}: new"
        elif old[key] != new[key]:
            yield f"{key}: {_apart(old[key], new[key])}"


def _apart(old: Any, new: Any) -> str:
    """Say how two values differ: of two lists of samples, the first that is another one."""
    if isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        number = next(n for n, pair in enumerate(zip(old, new, strict=True)) if pair[0] != pair[1])
        old, new = old[number], new[number]
        return f"sample {number} is {old}, now {new}: apart by {abs(old - new):.3g}"
    return f"{old!r}, now {new!r}"


def report_rows(report: Mapping[str, Any]) -> dict[str, Any]:
    """Give what each check of a report compared and found, by case, check and side."""
    found: dict[str, Any] = {"the whole passed": report["passed"]}
    seen: Counter[str] = Counter()
    for row in report["checks"]:
        name = f"{row['case'] or 'the FMU itself'} / {row['check']} ({row['side']})"
        seen[name] += 1
        again = f", row {seen[name]} of this name" if seen[name] > 1 else ""
        found[name + again] = {each: row[each] for each in COMPARED}
    return found


def report_kills(report: Mapping[str, Any]) -> dict[str, Any]:
    """Give what detected each planted fault, by fault, where the report has a whole kill matrix."""
    kills = report["kills"]
    if kills is None or not kills.get("whole", True):
        return {}
    told = ("wanted", "caught", "broken")
    return {
        row["mutant"]: {
            **{name: row[name] for name in told},
            "failing": dict(sorted(row["failing"].items())),
        }
        for row in kills["rows"]
    } | {"checks that kill nothing": kills["kills_nothing"]}


def description(fmu: Path) -> dict[str, Any]:
    """Give the attributes of each element of the model description, by its path in it."""
    with zipfile.ZipFile(fmu) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    for name in LEFT_OUT:
        root.attrib.pop(name, None)
    return dict(_elements(root, root.tag))


def _elements(element: ElementTree.Element, path: str) -> Iterator[tuple[str, Any]]:
    """Give an element and all below it; order tells, for ModelStructure counts the variables."""
    yield path, dict(element.attrib)
    for number, each in enumerate(element):
        yield from _elements(each, f"{path} / {each.tag} {number}")


def motions(fmu: Path, seed: int, count: int) -> dict[str, Any]:
    """Give the outputs of an FMU on random sequences: samples by sequence and output.

    Inputs and parameters change on the way; half of the sequences go back to a state and repeat
    an interval. A refusal counts as what the FMU said.
    """
    found: dict[str, Any] = {}
    file = FmuFile(fmu)
    names = available(file, OUTPUT_NAMES)
    try:
        for number in range(count):
            draw = Random(f"same {number} of {seed}")
            with file.instantiate() as instance:
                try:
                    samples = _motion(instance, names, draw)
                except FmuError as error:
                    found[f"sequence {number}"] = str(error).removeprefix(f"{fmu.name}: ")
                    continue
                for place, name in enumerate(names):
                    found[f"sequence {number}, {name}"] = samples[place :: len(names)]
    finally:
        file.close()
    return found


class Bits(float):
    """A number that equals those of the same bits only: -0.0 is not 0.0, NaN is itself."""

    def __eq__(self, other: object) -> bool:
        return isinstance(other, float) and struct.pack("d", self) == struct.pack("d", other)

    def __hash__(self) -> int:
        return hash(struct.pack("d", self))


def _motion(instance: FmuInstance, names: Sequence[str], draw: Random) -> list[Bits]:
    sequence = draws.sequence(draw, tunable=True)
    back = instance.file.can_get_and_set_state and draw.random() < 0.5
    instance.start(sequence.parameters)
    read = instance.reader(names)
    samples = [*read()]
    time = 0.0
    for interval in sequence.intervals:
        steps = draws.split(draw, interval.h, PIECES)
        instance.set(interval.changes)
        state = instance.get_state() if back else None
        for repetition in range(2 if back else 1):
            if repetition:
                assert state is not None
                instance.set_state(state)
                time -= interval.h
            for h in steps:
                instance.step(time, h)
                time += h
                samples += read()
        if state is not None:
            instance.free_state(state)
    return [Bits(sample) for sample in samples]


def _of_fmus(files: tuple[Path, Path], seed: int, count: int) -> list[dict[str, Rows]]:
    # A process each: one FMU must not lend its code to the other.
    with ProcessPoolExecutor(1, get_context("spawn"), max_tasks_per_child=1) as pool:
        ran = [pool.submit(motions, file, seed, count) for file in files]
        return [
            {"elements of the description": description(file), "random sequences": each.result()}
            for file, each in zip(files, ran, strict=True)
        ]


def _report(file: Path) -> Mapping[str, Any]:
    report: Mapping[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    return report


if __name__ == "__main__":
    sys.exit(main())
