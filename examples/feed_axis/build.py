"""Packs ServoDrive.fmu: what stands in `servo_drive`, named by its content."""

import contextlib
import hashlib
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from pythonfmu.builder import FmuBuilder

import stickslip_fmu.lifetime

HERE: Final = Path(__file__).parent

_PACKAGE: Final = "servo_drive_"

_SLAVE: Final = """\
from {package}.slave import ServoDrive
from {package}.lifetime import hold

hold(globals())
"""


def build_drive(folder: Path) -> Path:
    """Build ServoDrive.fmu in a folder and return its path."""
    target = folder / "ServoDrive.fmu"
    sources = {file.name: file.read_bytes() for file in (HERE / "servo_drive").glob("*.py")}
    # What the wrapper releases without owning it, the block's FMU has solved.
    sources["lifetime.py"] = Path(stickslip_fmu.lifetime.__file__).read_bytes()
    # Two FMUs in one process share their modules by name, so the name tells the content.
    package = _PACKAGE + _digest(sources)
    with tempfile.TemporaryDirectory(prefix="feed-axis-") as workshop:
        source = Path(workshop) / package
        source.mkdir()
        for name, content in sources.items():
            (source / name).write_bytes(content)
        slave = source.with_name(f"{package}_slave.py")
        slave.write_text(_SLAVE.format(package=package), encoding="utf-8")
        with _imports_apart():
            FmuBuilder.build_FMU(slave, target, project_files=[source])
    return target


def _digest(sources: dict[str, bytes]) -> str:
    digest = hashlib.sha256()
    for name in sorted(sources):
        digest.update(f"{name}\0{len(sources[name])}\0".encode() + sources[name])
    return digest.hexdigest()[:16]


@contextlib.contextmanager
def _imports_apart() -> Iterator[None]:
    """Undo what pythonfmu's builder leaves in the import system: the slave and its folder."""
    path, loaded = list(sys.path), set(sys.modules)
    try:
        yield
    finally:
        sys.path[:] = path
        for name in [name for name in sys.modules if name.startswith(_PACKAGE)]:
            if name not in loaded:
                del sys.modules[name]
