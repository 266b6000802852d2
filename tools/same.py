"""Says whether two sets of answers are the same in all but their wording.

``python tools/same.py freeze FOLDER OTHERS`` stores answers of this tree: the ``report.json`` of
verdicts on its own FMUs and on those in OTHERS, the scores of its curves, and the FMUs themselves.
``python tools/same.py compare OLD NEW`` compares two such folders file by file: of JSON every field
that is no wording, numbers within 1e-12 (1e-9 of what a fit gave), of an FMU the files in it.
Exit code 0: the same; 1: different, with the first differences of each file; 2: wrong use.
"""

import argparse
import json
import math
import os
import subprocess
import sys
import zipfile
from collections import Counter
from collections.abc import Iterator
from hashlib import sha256
from pathlib import Path
from typing import Any

WORDING = {"because", "failure", "not_applicable", "provenance", "text", "summary"}
"""Keys whose values may change their words, and what tells the day and the place."""
CLOSED, FITTED = 1e-12, 1e-9
"""Largest part by which a number may be another one."""
SHOWN = 10
"""Differences that are printed of one file."""

Leaves = dict[str, Any]


def leaves(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Give each value of a JSON tree with its path; rows of checks by what names them."""
    if isinstance(value, dict):
        for key in value.keys() - WORDING:
            yield from leaves(value[key], f"{path}/{key}")
    elif isinstance(value, list) and value and isinstance(value[0], dict) and "check" in value[0]:
        seen: Counter[str] = Counter()
        for row in value:
            name = f"{row.get('case')} {row['check']} {row.get('side')}"
            seen[name] += 1
            yield from leaves(row, f"{path}/{name} {seen[name]}")
    elif isinstance(value, list):
        for number, item in enumerate(value):
            yield from leaves(item, f"{path}/{number}")
    else:
        yield path, value


def answers(file: Path) -> Leaves:
    """Return what a file says: the leaves of JSON, or the digest of each file of an FMU."""
    if file.suffix == ".fmu":
        with zipfile.ZipFile(file) as archive:
            return {name: sha256(archive.read(name)).hexdigest() for name in archive.namelist()}
    return dict(leaves(json.loads(file.read_text(encoding="utf-8"))))


def differences(old: Leaves, new: Leaves, within: float) -> Iterator[str]:
    """Give a line for each value that is not in both, and the same."""
    for key in sorted(old.keys() | new.keys()):
        if key not in new or key not in old:
            yield f"{key}: {'gone' if key in old else 'new'}"
        elif not _same(old[key], new[key], within):
            yield f"{key}: {old[key]!r}, now {new[key]!r}"


def _same(old: Any, new: Any, within: float) -> bool:
    if isinstance(old, float) and isinstance(new, int | float):
        return math.isclose(old, new, rel_tol=within, abs_tol=0.0)
    return bool(old == new)


def compare(old: Path, new: Path) -> int:
    """Compare two folders; print the differences and return the exit code."""
    different = 0
    for name in sorted({file.name for folder in (old, new) for file in folder.iterdir()}):
        if not ((old / name).is_file() and (new / name).is_file()):
            found = ["gone" if (old / name).is_file() else "new"]
        else:
            within = FITTED if name.startswith("score") else CLOSED
            found = list(differences(answers(old / name), answers(new / name), within))
        different += len(found)
        print(f"{name}: {len(found)} different" if found else f"{name}: the same")
        for line in found[:SHOWN]:
            print(f"  {line}")
    return 1 if different else 0


def freeze(folder: Path, others: Path) -> None:
    """Store the answers of this tree; `others` holds FMUs (with .toml of names) and curves."""
    folder.mkdir(parents=True, exist_ok=True)
    own = Path("build")
    for fmu in sorted([*own.glob("*.fmu"), *others.glob("*.fmu")]):
        names = fmu.with_suffix(".toml")
        named = ["--names", str(names)] if names.is_file() else []
        out = folder / "reports" / fmu.stem
        ran = _command("verify", "--fmu", str(fmu), *named, "--output", str(out))
        report = out / "report.json"
        if report.is_file():
            found = json.loads(report.read_text(encoding="utf-8")) | {"exit code": ran.returncode}
            (folder / f"verify-{fmu.stem}.json").write_text(json.dumps(found), encoding="utf-8")
        if fmu.parent == own:
            (folder / fmu.name).write_bytes(fmu.read_bytes())
    for curve in sorted(others.glob("*.csv")):
        options = curve.with_suffix(".args")
        given = options.read_text(encoding="utf-8").split() if options.is_file() else []
        ran = _command("score", str(curve), *given, "--json")
        (folder / f"score-{curve.stem}.json").write_text(ran.stdout, encoding="utf-8")


def _command(*words: str) -> subprocess.CompletedProcess[str]:
    print("stickslip", *words, flush=True)
    called = [sys.executable, "-c", "from stickslip.cli import main; main()", *words]
    return subprocess.run(called, capture_output=True, text=True, env=os.environ, check=False)


def main() -> int:
    """Do what the command line says; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    does = parser.add_subparsers(dest="does", required=True)
    stored = does.add_parser("freeze", help="store the answers of this tree")
    stored.add_argument("folder", type=Path)
    stored.add_argument("others", type=Path, help="foreign FMUs and curves")
    compared = does.add_parser("compare", help="compare two stored sets")
    compared.add_argument("old", type=Path)
    compared.add_argument("new", type=Path)
    asked = parser.parse_args()
    if asked.does == "freeze":
        freeze(asked.folder, asked.others)
        return 0
    return compare(asked.old, asked.new)


if __name__ == "__main__":
    sys.exit(main())
