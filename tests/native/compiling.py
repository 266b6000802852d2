"""The native FMU of other sources, or compiled by other flags."""

import subprocess
import zipfile
from collections.abc import Mapping
from pathlib import Path

FLAGS = ("-std=c99", "-D_GNU_SOURCE", "-O1", "-ffp-contract=off", "-fPIC")


def run(*command: object, cwd: Path | None = None) -> str:
    words = [str(each) for each in command]
    done = subprocess.run(words, capture_output=True, text=True, check=False, cwd=cwd)
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout


def written(sources: Mapping[str, bytes], folder: Path) -> list[Path]:
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in sources.items():
        (folder / name).write_bytes(content)
    return [folder / name for name in sorted(sources) if name.endswith(".c")]


def with_library(healthy: Path, library: Path, target: Path) -> Path:
    with zipfile.ZipFile(healthy) as source, zipfile.ZipFile(target, "w") as archive:
        for name in source.namelist():
            if name.startswith("binaries/"):
                archive.write(library, name)
            else:
                archive.writestr(name, source.read(name))
    return target
