"""Makes StickSlip.fmu: the block, its face and the wrapper's binaries in one file.

The wrapper's builder makes the archive, pythonfmu's for FMI 2.0 and pythonfmu3's for FMI 3.0; a
second pass makes it the same, byte for byte, at every build: names sorted, dates fixed, deflated.
`pack` and `write_archive` do so for any slave.
"""

import hashlib
import os
import sys
import tempfile
import zipfile
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Dict, Iterator, Literal, Mapping, NamedTuple, Optional, Tuple

import pythonfmu
import pythonfmu3

from .description import MODEL

_HERE = Path(__file__).parent

# What travels with every face: standard library only.
_SHARED = (
    "__init__.py",
    "arcs.py",
    "block.py",
    "compensated.py",
    "description.py",
    "face.py",
    "friction.py",
    "handles.py",
    "lifetime.py",
    "meter.py",
    "oscillator.py",
    "quadrature.py",
    "quantities.py",
    "references.py",
    "release.py",
    "roots.py",
    "settings.py",
    "state.py",
    "variables.py",
)


class _Face(NamedTuple):
    """One FMI version: what else travels, its wrapper, and the slave's own file."""

    modules: Tuple[str, ...]
    wrapper: str
    builder: Any
    slave: str
    file_name: str


_FACES: Dict[int, _Face] = {
    2: _Face(
        ("description2.py", "fmi2.py"),
        f"pythonfmu {pythonfmu.__version__}",
        pythonfmu.FmuBuilder,
        """\
from {package}.fmi2 import StickSlip
from {package}.lifetime import hold

hold(globals())
""",
        f"{MODEL}.fmu",
    ),
    # pythonfmu3 looks for the class in the text of the file that it is told.
    3: _Face(
        ("description3.py", "fmi3.py"),
        f"pythonfmu3 {pythonfmu3.__version__}",
        pythonfmu3.FmuBuilder,
        """\
from pythonfmu3 import Fmi3Slave

from {package} import fmi3


class StickSlip(fmi3.StickSlip, Fmi3Slave):
    pass
""",
        f"{MODEL}_fmi3.fmu",
    ),
}

# Everything that travels.
PACKED = tuple(sorted({*_SHARED, *(name for face in _FACES.values() for name in face.modules)}))

# The packed package is named by this and its content.
_PACKAGE = "stickslip_fmu_"

# The earliest date that an archive can bear.
_ARCHIVE_DATE = (1980, 1, 1, 0, 0, 0)


def build(
    destination: Path, parts: Optional[Mapping[str, bytes]] = None, face: Literal[2, 3] = 2
) -> Path:
    """Build the FMU.

    Parameters
    ----------
    destination
        The file to write, ending in .fmu, or the folder that gets StickSlip.fmu, and for FMI 3.0
        StickSlip_fmi3.fmu. Folders are made. What was there stays until the new file is whole.
    parts
        Files that travel beside what is built here, such as documentation/index.html, by their
        path in the FMU.
    face
        The major version of FMI.

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
    chosen = _FACES[face]
    target = destination if destination.suffix == ".fmu" else destination / chosen.file_name
    target.parent.mkdir(parents=True, exist_ok=True)
    sources = {name: (_HERE / name).read_bytes() for name in (*_SHARED, *chosen.modules)}
    entries = pack(_PACKAGE, sources, chosen.slave, face)
    write_archive({**entries, **(parts or {})}, target)
    return target


def pack(
    prefix: str, sources: Mapping[str, bytes], slave: str, face: Literal[2, 3] = 2
) -> Dict[str, bytes]:
    """Return the files of an FMU by their path in it, for `write_archive`.

    Parameters
    ----------
    prefix
        What the name of the packed package begins with; the rest tells the content.
    sources
        The modules of the package by file name.
    slave
        Text of the file that imports the slave, with {package} for the name of the package.
    face
        The major version of FMI.
    """
    chosen = _FACES[face]
    # Two FMUs in one process share their modules by name, so the name tells the content.
    package = prefix + _digest(chosen.wrapper, slave, sources)
    with tempfile.TemporaryDirectory(prefix="stickslip-") as folder:
        workshop = Path(folder)
        (workshop / package).mkdir()
        for name, content in sources.items():
            (workshop / package / name).write_bytes(content)
        file = workshop / f"{package}_slave.py"
        file.write_text(slave.format(package=package), encoding="utf-8")
        with _imports_apart(prefix):
            raw = chosen.builder.build_FMU(
                file, workshop / "raw", project_files=[workshop / package]
            )
        return _entries(raw)


def add(fmu: Path, parts: Mapping[str, bytes]) -> None:
    """Put files into an FMU built here, by their path in it; those already there are replaced.

    Raises OSError if it cannot be written; what was there stays then.
    """
    write_archive({**_entries(fmu), **parts}, fmu)


def write_archive(entries: Mapping[str, bytes], target: Path) -> None:
    """Write an archive whose bytes depend on its entries alone, or nothing at all.

    Raises OSError if it cannot be written; what was there stays then.
    """
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
        part.chmod(0o666 & ~_umask())
        part.replace(target)
    except BaseException:
        part.unlink()
        raise


def _umask() -> int:
    # A temporary file is private; what was asked for is not.
    mask = os.umask(0)
    os.umask(mask)
    return mask


def _digest(wrapper: str, slave: str, sources: Mapping[str, bytes]) -> str:
    """Return a name for this content: 16 hexadecimal digits."""
    digest = hashlib.sha256(f"{wrapper}\0{slave}".encode())
    for name in sorted(sources):
        digest.update(f"\0{name}\0{len(sources[name])}\0".encode() + sources[name])
    return digest.hexdigest()[:16]


@contextmanager
def _imports_apart(prefix: str) -> Iterator[None]:
    """Let pythonfmu's builder import what it packs, apart from what this process has loaded.

    It imports the slave by name and leaves it, and its folder, in the import system; and where
    the same FMU runs in this process, that name is taken by files that may be gone.
    """
    path = list(sys.path)
    loaded = {name: module for name, module in sys.modules.items() if name.startswith(prefix)}
    _unload(prefix)
    try:
        yield
    finally:
        sys.path[:] = path
        _unload(prefix)
        sys.modules.update(loaded)


def _unload(prefix: str) -> None:
    for name in [name for name in sys.modules if name.startswith(prefix)]:
        del sys.modules[name]


def _entries(archive: Path) -> Dict[str, bytes]:
    """Return the files of an archive by name, but for sources that nobody could build."""
    with zipfile.ZipFile(archive) as source:
        return {
            name: source.read(name) for name in source.namelist() if not name.startswith("sources/")
        }


def _in_order(entries: Mapping[str, bytes]) -> Iterator[str]:
    """Give the model description first, where readers look for it, then the rest by name."""
    return iter(sorted(entries, key=lambda name: (name != "modelDescription.xml", name)))
