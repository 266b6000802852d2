"""Where a verdict comes from: the FMU's bytes, versions, platform, revision of the source."""

import hashlib
import platform
import subprocess
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import Any

from stickslip_verification.drive.fmu.description import content_digest
from stickslip_verification.drive.fmu.instance import FmuFile

TRUST = (
    "The FMU ran in processes of the suite, and shares them with the code that drives it. One that "
    "means to deceive, a Python FMU above all, can rewrite what that code reports: this report "
    "finds errors, not fraud."
)
"""What a verdict is worth if an FMU is not honest."""

PACKAGES = ("stickslip", "numpy", "scipy", "mpmath", "fmpy", "pythonfmu", "pythonfmu3")


def collect(fmu: FmuFile, command: str | None = None) -> dict[str, Any]:
    """Gather the provenance of a run on `fmu`, as JSON values.

    ``command`` is what to type to get the same again, ``trust`` a sentence for the reader. ``git``
    is ``{"revision", "dirty"}`` of the working copy this package stands in, or None where there is
    none; a version is None where the package is not installed.
    """
    names = fmu.names.file
    with fmu.path.open("rb") as stream:
        sha256 = hashlib.file_digest(stream, "sha256").hexdigest()
    return {
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "fmu": {
            "file": fmu.path.name,
            "content": content_digest(fmu.path),
            "sha256": sha256,
            "fmi_version": fmu.fmi_version,
            "contract": fmu.stated.told,
            "names": None if names is None else names.name,
            "problems": list(fmu.problems),
        },
        "command": command,
        "trust": TRUST,
        "versions": {"python": platform.python_version()} | {p: _version(p) for p in PACKAGES},
        "platform": platform.platform(),
        "git": _git(Path(__file__).resolve().parents[2]),
    }


def _version(package: str) -> str | None:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def _git(parent: Path) -> dict[str, Any] | None:
    root = parent.parent
    # An installed copy may lie inside the working copy of some other project.
    if parent.name != "verification" or not (root / ".git").exists():
        return None
    command = ["git", "-C", str(root), "status", "--porcelain=v2", "--branch"]
    try:
        said = subprocess.run(command, capture_output=True, text=True, timeout=10, check=True)
    except (OSError, subprocess.SubprocessError):
        return None
    head, *others = said.stdout.splitlines()
    return {"revision": head.split()[-1], "dirty": any(line[0] != "#" for line in others)}
