"""Says whether two sets of answers are the same in all but their wording.

``python tools/same.py freeze FOLDER OTHERS`` stores answers of this tree: the ``report.json`` of
verdicts on its own FMUs and on those in OTHERS, the scores of its curves, and the FMUs themselves.
``python tools/same.py studies FOLDER`` stores what the workbench gives: runs, limits, maps,
designs, scatter, sweeps. ``python tools/same.py compare OLD NEW`` compares two such folders file
by file: of JSON every field that is no wording, of datasets every number, within 1e-12 (1e-9 of
what a fit gave), of an FMU the files in it.
Exit code 0: the same; 1: different, with the first differences of each file; 2: wrong use.
"""

import argparse
import json
import math
import os
import shlex
import subprocess
import sys
import zipfile
from collections import Counter
from collections.abc import Iterator
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

WORDING = {"because", "failure", "not_applicable", "provenance", "text", "summary"}
"""Keys whose values may change their words, and what tells the day and the place."""
CLOSED, FITTED = 1e-12, 1e-9
"""Largest part by which a number may be another one."""
AXIS = "examples/axes/lined_guide.toml"
STRIBECK = "--law stribeck --law-parameter v_s=1mm/s"
STUDIES = {
    "fmu.csv": "simulate --c 2 --stop-time 5 --output-file",
    "reference.csv": "simulate --engine reference --tau-s 100ms --stop-time 3 --output-file",
    "stribeck.csv": f"simulate {STRIBECK} --stop-time 3 --output-file",
    "critical.txt": "critical --c 2 --v 20mm/s",
    "critical-ageing.txt": "critical --tau-s 100ms --c 5",
    "critical-stribeck.txt": f"critical {STRIBECK} --c 2",
    "lined.json": f"design {AXIS} -o {{out}}/lined.html --json",
    "hydrostatic.json": "design examples/axes/hydrostatic_guide.toml -o {out}/hydro.html --json",
    "score.txt": "score {out}/fmu.csv --c 2 --json",
    "map": "map --over 'v=1..200 mm/s log 12' --over 'k=0.1..10 kN/m log 8' --c 2 -o",
    "map-ageing": "map --over 'v=1..50 mm/s log 6' --over 'tau_s=0.05..1 s 3' --c 5 -o",
    "map-axis": f"map {AXIS} --over 'feed=0.05..5 mm/s log 5' --over 'axis.mass=100..900 kg 3' -o",
    "scatter": f"scatter {AXIS} --seed 1 --samples 20 --feed 1mm/s --vary 'axis.mass=± 10 %' -o",
    "sweep": "sweep {out}/StickSlip.fmu {out}/plan.toml -o",
}
"""What the workbench is asked: where the answer goes, by its name, and the words of the command."""
PLAN = """stop_time = "2 s"
[parameters]
mu_s = [0.4, 0.5]
k = "500..2000 N/m 3"
[outputs]
x = ["jump", "period", "max"]
n_slips = ["last"]
"""
SHOWN = 10
"""Differences that are printed of one file."""

Leaves = dict[Any, Any]


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
    if file.suffix == ".txt":
        return dict(enumerate(file.read_text(encoding="utf-8").split()))
    if file.suffix == ".csv":
        table = np.genfromtxt(file, delimiter=",", names=True)
        return {name: table[name] for name in table.dtype.names or ()}
    if file.suffix == ".zarr":
        import xarray

        found = xarray.open_zarr(file, consolidated=False)
        return {str(name): found[name].values for name in found.variables}
    if file.suffix == ".parquet":
        import pandas

        columns = pandas.read_parquet(file)
        return {str(name): columns[name].to_numpy() for name in columns}
    return dict(leaves(json.loads(file.read_text(encoding="utf-8"))))


def differences(old: Leaves, new: Leaves, within: float) -> Iterator[str]:
    """Give a line for each value that is not in both, and the same."""
    for key in sorted(old.keys() | new.keys()):
        if key not in new or key not in old:
            yield f"{key}: {'gone' if key in old else 'new'}"
        elif not _same(old[key], new[key], within):
            yield f"{key}: {old[key]!r}, now {new[key]!r}"


def _same(old: Any, new: Any, within: float) -> bool:
    if isinstance(old, np.ndarray) and old.dtype.kind == "f":
        same_shape = np.shape(new) == old.shape
        return same_shape and np.allclose(old, new, rtol=within, atol=0.0, equal_nan=True)
    if isinstance(old, np.ndarray):
        return np.array_equal(old, new)
    if isinstance(old, float) and isinstance(new, int | float):
        return math.isclose(old, new, rel_tol=within, abs_tol=0.0)
    return bool(old == new)


def compare(old: Path, new: Path) -> int:
    """Compare two folders; print the differences and return the exit code."""
    different = 0
    for name in sorted({name for folder in (old, new) for name in _names(folder)}):
        if not ((old / name).exists() and (new / name).exists()):
            found = ["gone" if (old / name).exists() else "new"]
        else:
            within = FITTED if name.startswith("score") else CLOSED
            found = list(differences(answers(old / name), answers(new / name), within))
        different += len(found)
        print(f"{name}: {len(found)} different" if found else f"{name}: the same")
        for line in found[:SHOWN]:
            print(f"  {line}")
    return 1 if different else 0


def _names(folder: Path) -> Iterator[str]:
    """Give the files with answers in a folder and those below it."""
    for kind in ("*.fmu", "*.json", "*.txt", "*.csv", "*.zarr", "*/*.zarr", "*/*.parquet"):
        yield from (str(file.relative_to(folder)) for file in folder.glob(kind))


def studies(folder: Path) -> None:
    """Store what the workbench of this tree gives."""
    folder.mkdir(parents=True, exist_ok=True)
    _command("build", "--bare", "-o", str(folder))
    (folder / "plan.toml").write_text(PLAN, encoding="utf-8")
    for name, asked in STUDIES.items():
        words = shlex.split(asked.format(out=folder))
        printed = name.endswith(".txt")
        ran = _command(*words, *([] if printed else [str(folder / name)]))
        if ran.returncode:
            print(ran.stderr, end="")
        if printed:
            (folder / name).write_text(ran.stdout, encoding="utf-8")


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
    workbench = does.add_parser("studies", help="store what the workbench of this tree gives")
    workbench.add_argument("folder", type=Path)
    compared = does.add_parser("compare", help="compare two stored sets")
    compared.add_argument("old", type=Path)
    compared.add_argument("new", type=Path)
    asked = parser.parse_args()
    if asked.does == "freeze":
        freeze(asked.folder, asked.others)
        return 0
    if asked.does == "studies":
        studies(asked.folder)
        return 0
    return compare(asked.old, asked.new)


if __name__ == "__main__":
    sys.exit(main())
