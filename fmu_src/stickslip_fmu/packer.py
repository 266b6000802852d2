"""Makes StickSlip.fmu: the block, its FMI 2.0 face and pythonfmu's binaries in one file.

pythonfmu builds the archive; a second pass makes it the same, byte for byte, at every build:
names sorted, dates fixed, deflated.
"""

import hashlib
import os
import sys
import tempfile
import zipfile
from contextlib import contextmanager
from pathlib import Path
from typing import Dict, Iterator, Mapping, Optional

from pythonfmu import __version__ as wrapper_version
from pythonfmu.builder import FmuBuilder

from .description import MODEL

_HERE = Path(__file__).parent

# What travels: everything the face needs. Standard library and pythonfmu only.
PACKED = (
    "__init__.py",
    "arcs.py",
    "block.py",
    "compensated.py",
    "description.py",
    "fmi2.py",
    "friction.py",
    "lifetime.py",
    "meter.py",
    "oscillator.py",
    "quadrature.py",
    "release.py",
    "roots.py",
    "settings.py",
    "variables.py",
)

# The packed package is named by this and its content.
_PACKAGE = "stickslip_fmu_"

# The earliest date that an archive can bear.
_ARCHIVE_DATE = (1980, 1, 1, 0, 0, 0)

_SLAVE = """\
from {package}.fmi2 import StickSlip
from {package}.lifetime import hold

hold(globals())
"""


def build(destination: Path, parts: Optional[Mapping[str, bytes]] = None) -> Path:
    """Build the FMU.

    Parameters
    ----------
    destination
        The file to write, ending in .fmu, or the folder that gets StickSlip.fmu. Folders are
        made. What was there stays until the new file is whole.
    parts
        Files that travel beside what is built here, such as documentation/index.html, by their
        path in the FMU.

    Returns
    -------
    Path
        The file that was written.

    Raises
    ------
    OSError
        If it cannot be written.
    ValueError
        If SOURCE_DATE_EPOCH is set to something else than whole seconds.
    """
    target = destination if destination.suffix == ".fmu" else destination / f"{MODEL}.fmu"
    target.parent.mkdir(parents=True, exist_ok=True)
    sources = {name: (_HERE / name).read_bytes() for name in PACKED}
    # Two FMUs in one process share their modules by name, so the name tells the content.
    package = _PACKAGE + _digest(sources)
    with tempfile.TemporaryDirectory(prefix="stickslip-") as folder:
        workshop = Path(folder)
        (workshop / package).mkdir()
        for name, content in sources.items():
            (workshop / package / name).write_bytes(content)
        slave = workshop / f"{package}_slave.py"
        slave.write_text(_SLAVE.format(package=package), encoding="utf-8")
        raw = workshop / "raw.fmu"
        with _imports_apart():
            FmuBuilder.build_FMU(slave, raw, project_files=[workshop / package])
        entries = _entries(raw)
    entries.update(parts or {})
    _write(entries, target)
    return target


def _digest(sources: Mapping[str, bytes]) -> str:
    """Return a name for this content: 16 hexadecimal digits."""
    digest = hashlib.sha256(wrapper_version.encode())
    for name in sorted(sources):
        digest.update(f"\0{name}\0{len(sources[name])}\0".encode() + sources[name])
    return digest.hexdigest()[:16]


@contextmanager
def _imports_apart() -> Iterator[None]:
    """Let pythonfmu's builder import what it packs, apart from what this process has loaded.

    It imports the slave by name and leaves it, and its folder, in the import system; and where
    the same FMU runs in this process, that name is taken by files that may be gone.
    """
    path = list(sys.path)
    loaded = {name: module for name, module in sys.modules.items() if name.startswith(_PACKAGE)}
    _unload()
    try:
        yield
    finally:
        sys.path[:] = path
        _unload()
        sys.modules.update(loaded)


def _unload() -> None:
    for name in [name for name in sys.modules if name.startswith(_PACKAGE)]:
        del sys.modules[name]


def _entries(archive: Path) -> Dict[str, bytes]:
    """Return the files of an archive by name."""
    with zipfile.ZipFile(archive) as source:
        return {name: source.read(name) for name in source.namelist()}


def _write(entries: Mapping[str, bytes], target: Path) -> None:
    """Write an archive whose bytes depend on its entries alone, or nothing at all."""
    handle, name = tempfile.mkstemp(dir=target.parent, prefix=".", suffix=".part")
    part = Path(name)
    try:
        with os.fdopen(handle, "wb") as stream, zipfile.ZipFile(stream, "w") as archive:
            for entry in _in_order(entries):
                info = zipfile.ZipInfo(entry, _ARCHIVE_DATE)
                info.compress_type = zipfile.ZIP_DEFLATED
                info.external_attr = 0o644 << 16
                info.create_system = 3
                archive.writestr(info, entries[entry], compresslevel=9)
        part.chmod(0o644)
        part.replace(target)
    except BaseException:
        part.unlink()
        raise


def _in_order(entries: Mapping[str, bytes]) -> Iterator[str]:
    """Give the model description first, where readers look for it, then the rest by name."""
    return iter(sorted(entries, key=lambda name: (name != "modelDescription.xml", name)))
