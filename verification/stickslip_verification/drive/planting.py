"""Makes a mutant: the built FMU with one fault planted in the source that it carries.

An override is planted at the end of its module: a function makes the replacement of the original,
and the name is bound to it. Whoever imports the module later gets the replacement.

The FMU is known as a file alone. Python runs one code per module name in a process, so the packed
package gets a name of its own; then a mutant loads beside the original and beside other mutants.
"""

import ast
import hashlib
import re
import zipfile
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from stickslip_verification.model.whole_file import replacing
from stickslip_verification.suite.faults import MASTER, Mutant, MutantError, bindings, parsed

DESCRIPTION = "modelDescription.xml"
RESOURCES = "resources/"

_SLAVE_MODULE = RESOURCES + "slavemodule.txt"
_SLAVE_ENDING = "_slave"
_GUID = re.compile(rb'\bguid="[^"]*"')

MOST_COPIED = 5
"""Most lines that an override may share with the code it replaces. With more it is a copy, which
would miss later changes of the original."""

# The earliest date that an archive can bear.
_ARCHIVE_DATE = (1980, 1, 1, 0, 0, 0)


def plant(fmu: Path, mutant: Mutant, destination: Path) -> Path:
    """Make the FMU with the fault planted; the same bytes at every call.

    A fault in the calls of the master changes no FMU: there `fmu` itself is returned.

    Parameters
    ----------
    fmu
        The FMU without the fault.
    mutant
        The fault.
    destination
        The file to write, ending in .fmu, or the folder that gets ``<id>.fmu``. Folders are made.

    Returns
    -------
    Path
        The file that was written, or `fmu`.

    Raises
    ------
    MutantError
        The FMU carries no packed source, or the fault does not fit it: a file to change is not
        there, a file to add is, a substitution does not match exactly once, what comes out is not
        Python, the target of an override is gone, or its code is a copy of it.
    OSError
        The mutant cannot be written.
    """
    if not mutant.changes_the_fmu:
        return fmu
    target = destination if destination.suffix == ".fmu" else destination / f"{mutant.id}.fmu"
    entries = _read(fmu)
    package = _package(fmu, entries)
    _apply(mutant, entries, f"{RESOURCES}{package}/")
    digest = _digest(entries)
    renamed = _renamed(entries, package, f"{package.rpartition('_')[0]}_{digest}")
    renamed[DESCRIPTION] = _GUID.sub(f'guid="{digest}"'.encode(), renamed[DESCRIPTION], count=1)
    target.parent.mkdir(parents=True, exist_ok=True)
    _write(renamed, target)
    return target


def carries_source(fmu: Path) -> bool:
    """Whether an FMU carries the packed source of the block, so that faults can change it."""
    try:
        _package(fmu, _read(fmu))
    except MutantError:
        return False
    return True


def _read(fmu: Path) -> dict[str, bytes]:
    try:
        with zipfile.ZipFile(fmu) as archive:
            return {name: archive.read(name) for name in archive.namelist()}
    except (OSError, zipfile.BadZipFile) as error:
        raise MutantError(fmu, "", f"cannot be read: {error}") from None


def _package(fmu: Path, entries: Mapping[str, bytes]) -> str:
    """Return the name of the packed package, which the slave's file is called after."""
    slave = entries.get(_SLAVE_MODULE, b"").decode("utf-8", errors="replace").strip()
    package = slave.removesuffix(_SLAVE_ENDING)
    packed = f"{RESOURCES}{package}/__init__.py" in entries
    if package == slave or not packed or not _GUID.search(entries.get(DESCRIPTION, b"")):
        raise MutantError(fmu, "", "carries no packed source of the block to plant a fault in")
    return package


def _apply(mutant: Mutant, entries: dict[str, bytes], folder: str) -> None:
    """Make the additions and substitutions in `entries`; `folder` holds the packed source."""
    for file, source in mutant.additions.items():
        name = folder + file
        if name in entries:
            where = f"{mutant.id}.additions"
            raise MutantError(mutant.file, where, f"{file} is packed already")
        entries[name] = (mutant.file.parent / source).read_bytes()
    changed = {folder + file for file in mutant.additions}
    for n, change in enumerate(mutant.substitutions):
        here = f"{mutant.id}.substitutions[{n}]"
        name = change.file
        if name != DESCRIPTION:
            name = _file_of(mutant, f"{here}.file", entries, folder, name, name)
            changed.add(name)
        found = entries[name].count(change.find.encode())
        if found != 1:
            reason = f"matches {found} times in {change.file}, not once"
            raise MutantError(mutant.file, f"{here}.find", reason)
        entries[name] = entries[name].replace(change.find.encode(), change.replace.encode())
    for module in sorted(changed):
        try:
            parsed(entries[module])
        except SyntaxError as error:
            reason = f"line {error.lineno} is not Python any more: {error.msg}"
            raise MutantError(mutant.file, module.removeprefix(folder), reason) from None
    _replace(mutant, entries, folder)


def _file_of(
    mutant: Mutant, field: str, entries: Mapping[str, bytes], folder: str, end: str, named: str
) -> str:
    """Return the one entry of the packed source whose path ends so; errors tell what was named."""
    found = [name for name in entries if name.startswith(folder) and f"/{name}".endswith(f"/{end}")]
    if not found:
        raise MutantError(mutant.file, field, f"no {named} in the FMU")
    if len(found) > 1:
        paths = ", ".join(sorted(name.removeprefix(folder) for name in found))
        raise MutantError(mutant.file, field, f"{named} may be in {paths}")
    return found[0]


def _replace(mutant: Mutant, entries: dict[str, bytes], folder: str) -> None:
    """Append the overrides to their modules."""
    source = _Source(entries)
    planted: dict[str, str] = {}
    for n, override in enumerate(mutant.overrides):
        if override.module == MASTER:
            continue
        here = f"{mutant.id}.overrides"
        end = override.module.replace(".", "/") + ".py"
        file = _file_of(mutant, here, entries, folder, end, override.target)
        found = source.find(file, override.path.split("."))
        if found is None:
            raise MutantError(mutant.file, here, f"no {override.target} in the FMU")
        copied = _lines(override.function("planted")) & found
        if copied.total() > MOST_COPIED:
            reason = f"copies {copied.total()} lines of {override.target}; {MOST_COPIED} at most"
            raise MutantError(mutant.file, here, reason)
        name = f"_planted_{n}"
        text = f"\n\n{override.function(name)}\n\n{override.path} = {name}({override.path})\n"
        planted[file] = planted.get(file, "") + text
    for file, text in planted.items():
        entries[file] += text.encode()


class _Source:
    """The packed modules, read as syntax trees when they are asked for."""

    def __init__(self, entries: Mapping[str, bytes]) -> None:
        self._entries = entries

    def find(self, file: str, names: Sequence[str]) -> Counter[str] | None:
        """Return the lines that define a name of a module or of its class; None if there are none.

        Names are followed through imports from packed modules and through base classes.
        """
        if file not in self._entries:
            return None
        text = self._entries[file].decode()
        first, *inner = names
        found = bindings(parsed(text).body).get(first)
        if isinstance(found, ast.ImportFrom) and found.level:
            name = next(each.name for each in found.names if first in (each.asname, each.name))
            module = "/".join(file.split("/")[: -found.level]) + f"/{found.module or ''}"
            return self.find(f"{module.replace('.', '/')}.py", [name, *inner])
        if not inner:
            return None if found is None else _lines(text, found)
        if not isinstance(found, ast.ClassDef):
            return None
        own = bindings(found.body).get(inner[0])
        if own is not None:
            return _lines(text, own)
        bases = (base.id for base in found.bases if isinstance(base, ast.Name))
        inherited = (self.find(file, [base, *inner]) for base in bases)
        return next((each for each in inherited if each is not None), None)


def _lines(text: str, part: ast.stmt | None = None) -> Counter[str]:
    """Count the lines of a text, or of a part: without blanks, comments, docstrings, signatures."""
    tree = parsed(text) if part is None else part
    lines = text.splitlines()
    first, last = (1, len(lines)) if part is None else (part.lineno, part.end_lineno or part.lineno)
    left = set(range(first, last + 1))
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            above = [node.lineno, *(each.lineno for each in node.decorator_list)]
            left -= set(range(min(above), node.body[0].lineno))
            if ast.get_docstring(node) is not None:
                left -= set(range(node.body[0].lineno, (node.body[0].end_lineno or 0) + 1))
    stripped = (lines[n - 1].strip() for n in left)
    return Counter(line for line in stripped if line and not line.startswith("#"))


def _digest(entries: Mapping[str, bytes]) -> str:
    """Return a name for this content: 16 hexadecimal digits."""
    digest = hashlib.sha256()
    for name in sorted(entries):
        digest.update(f"\0{name}\0{len(entries[name])}\0".encode() + entries[name])
    return digest.hexdigest()[:16]


def _renamed(entries: Mapping[str, bytes], old: str, new: str) -> dict[str, bytes]:
    """Return the entries with another package name, in their names and in their texts."""
    return {
        name.replace(old, new): content.replace(old.encode(), new.encode())
        if name.startswith(RESOURCES)
        else content
        for name, content in entries.items()
    }


def _write(entries: Mapping[str, bytes], target: Path) -> None:
    """Write an archive whose bytes depend on its entries alone, or nothing at all."""
    with replacing(target) as stream, zipfile.ZipFile(stream, "w") as archive:
        for entry in _in_order(entries):
            info = zipfile.ZipInfo(entry, _ARCHIVE_DATE)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.external_attr = 0o644 << 16
            # Unix, as the permissions above are meant.
            info.create_system = 3
            # A mutant is made, run and thrown away, so speed counts and size does not.
            archive.writestr(info, entries[entry], compresslevel=1)


def _in_order(names: Iterable[str]) -> list[str]:
    """Return the model description first, where readers look for it, then the rest by name."""
    return sorted(names, key=lambda name: (name != DESCRIPTION, name))
