"""Packs a model as an FMU: its modules, those of fmi and the wrapper's binaries in one file.

The modules that travel are found by their imports, from the text of a module that defines SPEC:
every module outside the standard library and the wrapper. They stand in one package, named by its
content, each under its own name; imports between them are made relative, so that two FMUs in one
process never share a module.

The wrapper is pythonfmu. An archive is the same, byte for byte, at every build: names sorted, dates
fixed, deflated.
"""

import ast
import hashlib
import sys
import tempfile
import zipfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional
from xml.dom.minidom import parseString
from xml.etree.ElementTree import tostring

import pythonfmu

from .description import Face, identity, model_description
from .model import Spec

_WRAPPER = f"pythonfmu {pythonfmu.__version__}"

# The slave's own file.
_SLAVE = """\
from {package}.fmi.lifetime import hold
from {package}.slave import Packed

hold(globals())
"""

# The module `slave` of the packed package: the text that defines SPEC, then this.
_SLAVE_CLASS = """
from fmi.instance import Instance


class Packed(Instance, spec=SPEC):
    \"""The model as a slave.\"""
"""

# Commands of the wrapper, which an FMU does not need.
_COMMANDS = ("__main__.py", "csvbuilder.py", "deploy.py")

# Modules that a host of the FMU has, or that travel as the wrapper.
_AT_HAND = {*sys.stdlib_module_names, "pythonfmu"}

# The oldest Python that loads the FMU.
_PYTHON = (3, 8)

# The earliest date that an archive can bear.
_ARCHIVE_DATE = (1980, 1, 1, 0, 0, 0)


class PackError(ValueError):
    """A module that cannot travel; the text names it, its line and the reason."""


def build_fmu(
    main: str,
    destination: Path,
    prefix: str,
    parts: Optional[Mapping[str, bytes]] = None,
) -> Path:
    """Build an FMU 2.0 and return its file.

    Parameters
    ----------
    main
        Text of a module that defines SPEC, a `model.Spec`: ``from pendulum import SPEC``. The
        modules that it imports, directly or not, must be importable in this process.
    destination
        As of `write_fmu`.
    prefix
        Beginning of the name of the packed package; the rest is a digest of the content.
    parts
        Files that travel beside the model, such as documentation/index.html, by their path in the
        FMU.

    Raises
    ------
    PackError
        If a module cannot be found or is not Python 3.8.
    OSError
        If the file cannot be written.
    ValueError
        If SOURCE_DATE_EPOCH is set to something else than whole seconds, or the table of the model
        is wrong.
    """
    home = Path(pythonfmu.__file__).parent
    sources = travelling(main)
    # Two FMUs in one process share their modules by name, so the name tells the content.
    package = prefix + digest_of(f"{_WRAPPER}\0{_SLAVE}", sources)[:16]
    spec = _spec_of(main)
    root = model_description(spec, 2, identity(package), _WRAPPER)
    entries = {
        "modelDescription.xml": parseString(tostring(root)).toprettyxml(encoding="UTF-8"),
        "resources/slavemodule.txt": f"{package}_slave".encode(),
        f"resources/{package}_slave.py": _SLAVE.format(package=package).encode(),
    }
    for name, content in sources.items():
        entries[f"resources/{package}/{name}"] = content
    for file in home.glob("*.py"):
        if file.name not in _COMMANDS:
            entries[f"resources/{home.name}/{file.name}"] = file.read_bytes()
    for file in home.glob("resources/binaries/*/*"):
        entries[f"binaries/{file.parent.name}/{spec.name}{file.suffix}"] = file.read_bytes()
    return write_fmu(destination, spec.name, 2, {**entries, **(parts or {})})


def _spec_of(main: str) -> Spec:
    """Return the SPEC that a text defines, whose model must start."""
    scope: Dict[str, Any] = {"__name__": __name__}
    exec(compile(main, "slave", "exec", dont_inherit=True), scope)
    spec: Spec = scope["SPEC"]
    spec.start()
    return spec


def travelling(main: str) -> Dict[str, bytes]:
    """Return the files of the packed package by their path in it; raises PackError.

    Parameters
    ----------
    main
        Text of a module that defines SPEC.
    """
    text = main.rstrip("\n") + "\n" + _SLAVE_CLASS
    first = _Module("slave", Path("slave.py"), text.encode("utf-8"))
    files = {
        "__init__.py": b'"""The model and what makes it an FMU."""\n',
        "slave.py": first.packed(),
    }
    # The wrapper's file imports `lifetime` itself.
    waiting = {"fmi.lifetime": "slave", **dict.fromkeys(first.imported(), "slave")}
    seen = set()
    while waiting:
        name, importer = waiting.popitem()
        seen.add(name)
        if name == first.name:
            raise PackError(f"{importer} imports {name}, which is the name of the FMU's own module")
        file = _file_of(name)
        if file is None:
            raise PackError(
                f"{name}, which {importer} imports, cannot be packed: "
                "no Python source of this name is on the path"
            )
        try:
            module = _Module(name, file, file.read_bytes())
            files[module.path] = module.packed()
            imported = set(module.imported())
        except PackError as error:
            raise PackError(f"{error} ({importer} imports {name})") from None
        waiting.update(dict.fromkeys(sorted(imported - seen, reverse=True), name))
    return files


class _Module:
    """One module that travels: its dotted name, its file and its text."""

    def __init__(self, name: str, file: Path, source: bytes) -> None:
        self.name = name
        self.source = source
        self._is_package = file.name == "__init__.py"
        try:
            self._tree = ast.parse(source, str(file), feature_version=_PYTHON)
        except SyntaxError as error:
            reason = f"line {error.lineno} is not Python 3.8: {error.msg}"
            raise PackError(f"{name} cannot be packed: {reason}") from None

    @property
    def path(self) -> str:
        """Path in the packed package."""
        stem = self.name.replace(".", "/")
        return f"{stem}/__init__.py" if self._is_package else f"{stem}.py"

    def imported(self) -> List[str]:
        """Return the modules that have to travel with this one, and their packages."""
        modules = []
        for node in ast.walk(self._tree):
            if isinstance(node, ast.Import):
                for alias in node.names:
                    if not _at_hand(alias.name):
                        raise PackError(
                            f"{self.name} cannot be packed: line {node.lineno} imports "
                            f"{alias.name}, which is not in Python's standard library; a module "
                            "that travels is imported as from ... import ..."
                        )
            elif isinstance(node, ast.ImportFrom):
                base = self._base(node)
                if base is None:
                    continue
                inner = (f"{base}.{alias.name}" for alias in node.names)
                for name in (base, *(one for one in inner if _file_of(one) is not None)):
                    parts = name.split(".")
                    modules += [".".join(parts[:n]) for n in range(1, len(parts) + 1)]
        return modules

    def packed(self) -> bytes:
        """Return the source with absolute imports of travelling modules made relative."""
        lines = self.source.splitlines(keepends=True)
        level = self.name.count(".") + (2 if self._is_package else 1)
        nodes = [
            node
            for node in ast.walk(self._tree)
            if isinstance(node, ast.ImportFrom) and not node.level and self._base(node) is not None
        ]
        for node in sorted(nodes, key=lambda node: (node.lineno, node.col_offset), reverse=True):
            line = lines[node.lineno - 1]
            written = f"from {node.module} ".encode()
            rest = line[node.col_offset :]
            if not rest.startswith(written):
                raise PackError(
                    f"{self.name} cannot be packed: line {node.lineno} is not written "
                    f"{written.decode()}import ..."
                )
            relative = f"from {'.' * level}{node.module} ".encode()
            lines[node.lineno - 1] = line[: node.col_offset] + relative + rest[len(written) :]
        return b"".join(lines)

    def _base(self, node: ast.ImportFrom) -> Optional[str]:
        """Return the module that names are imported from; None if it does not travel."""
        if not node.level:
            return None if _at_hand(node.module or "") else node.module
        package = self.name.split(".") + ([""] if self._is_package else [])
        parents = package[: len(package) - node.level]
        return ".".join([*parents, *([node.module] if node.module else [])])


def _at_hand(name: str) -> bool:
    return name.partition(".")[0] in _AT_HAND


def _file_of(name: str) -> Optional[Path]:
    """Return the source of a module without importing it, or None."""
    top, *inner = name.split(".")
    spec = find_spec(top)
    if spec is None:
        return None
    if not inner:
        file = Path(spec.origin or "")
        return file if file.suffix == ".py" else None
    for folder in spec.submodule_search_locations or ():
        stem = Path(folder, *inner)
        for file in (stem / "__init__.py", stem.with_name(f"{stem.name}.py")):
            if file.is_file():
                return file
    return None


def add(fmu: Path, parts: Mapping[str, bytes]) -> None:
    """Put files into an FMU built here, by their path in it; files of the same path are replaced.

    Raises OSError if it cannot be written; an old file stays then.
    """
    with zipfile.ZipFile(fmu) as archive:
        entries = {name: archive.read(name) for name in archive.namelist()}
    write_archive({**entries, **parts}, fmu)


def write_fmu(destination: Path, name: str, face: Face, entries: Mapping[str, bytes]) -> Path:
    """Write an FMU and return its file.

    Parameters
    ----------
    destination
        The file, ending in .fmu, or the folder that gets ``<name>.fmu``, and for FMI 3.0
        ``<name>_fmi3.fmu``. Folders are made. An old file stays until the new one is whole.
    name, face
        What names the file in a folder.
    entries
        Files of the FMU by their path in it.
    """
    target = destination
    if destination.suffix != ".fmu":
        target = destination / (f"{name}.fmu" if face == 2 else f"{name}_fmi3.fmu")
    target.parent.mkdir(parents=True, exist_ok=True)
    write_archive(entries, target)
    return target


def write_archive(entries: Mapping[str, bytes], target: Path) -> None:
    """Write an archive whose bytes depend on its entries alone, or nothing at all.

    Raises OSError if it cannot be written; an old file stays then.
    """
    with tempfile.TemporaryDirectory(dir=target.parent, prefix=".") as folder:
        part = Path(folder, target.name)
        with zipfile.ZipFile(part, "w") as archive:
            # Readers look for the description first.
            for entry in sorted(entries, key=lambda name: (name != "modelDescription.xml", name)):
                info = zipfile.ZipInfo(entry, _ARCHIVE_DATE)
                info.compress_type = zipfile.ZIP_DEFLATED
                info.external_attr = 0o644 << 16
                info.create_system = 3
                archive.writestr(info, entries[entry], compresslevel=9)
        part.replace(target)


def digest_of(head: str, files: Mapping[str, bytes]) -> str:
    """Return the SHA-256 of a text and of files by name, in hexadecimal digits."""
    digest = hashlib.sha256(head.encode())
    for name in sorted(files):
        digest.update(f"\0{name}\0{len(files[name])}\0".encode() + files[name])
    return digest.hexdigest()
