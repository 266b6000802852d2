"""Makes a mutant: the built FMU with one fault planted in the source that it carries.

An override is planted at the end of its module: a function makes the replacement of the original,
and the name is bound to it. Python runs one code per module name in a process, so the packed
package gets a name of its own, by which a mutant loads beside the original and other mutants.
"""

import hashlib
import re
import zipfile
from collections.abc import Mapping
from pathlib import Path

from stickslip_verification.model.data_file import replacing
from stickslip_verification.suite.faults import MASTER, Mutant, MutantError, parsed

DESCRIPTION = "modelDescription.xml"
RESOURCES = "resources/"

_SLAVE_MODULE = RESOURCES + "slavemodule.txt"
_SLAVE_ENDING = "_slave"
_GUID = re.compile(rb'\bguid="[^"]*"')


def plant(fmu: Path, mutant: Mutant, destination: Path) -> Path:
    """Make the FMU with the fault planted, the same bytes at every call, and return its file.

    That is `destination` if it ends in .fmu, or ``<id>.fmu`` in it; a fault in the calls of the
    master changes no FMU, and `fmu` itself is returned. `MutantError` if the FMU carries no packed
    source, or the fault does not fit it; that the target of an override is gone shows when the FMU
    is loaded. `OSError` if the mutant cannot be written.
    """
    if not mutant.changes_the_fmu:
        return fmu
    target = destination if destination.suffix == ".fmu" else destination / f"{mutant.id}.fmu"
    entries = _read(fmu)
    package = _package(fmu, entries)
    _apply(mutant, entries, f"{RESOURCES}{package}/")
    content = hashlib.sha256()
    for name in sorted(entries):
        content.update(f"\0{name}\0{len(entries[name])}\0".encode() + entries[name])
    digest = content.hexdigest()[:16]
    new = f"{package.rpartition('_')[0]}_{digest}"
    renamed = {
        name.replace(package, new): text.replace(package.encode(), new.encode())
        if name.startswith(RESOURCES)
        else text
        for name, text in entries.items()
    }
    renamed[DESCRIPTION] = _GUID.sub(f'guid="{digest}"'.encode(), renamed[DESCRIPTION], count=1)
    target.parent.mkdir(parents=True, exist_ok=True)
    with replacing(target) as stream, zipfile.ZipFile(stream, "w") as archive:
        # The model description comes first, where readers look for it.
        for entry in sorted(renamed, key=lambda name: (name != DESCRIPTION, name)):
            # A mutant is made, run and thrown away, so speed counts and size does not.
            archive.writestr(zipfile.ZipInfo(entry), renamed[entry], zipfile.ZIP_DEFLATED, 1)
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
    slave = entries.get(_SLAVE_MODULE, b"").decode("utf-8", errors="replace").strip()
    package = slave.removesuffix(_SLAVE_ENDING)
    packed = f"{RESOURCES}{package}/__init__.py" in entries
    if package == slave or not packed or not _GUID.search(entries.get(DESCRIPTION, b"")):
        raise MutantError(fmu, "", "carries no packed source of the block to plant a fault in")
    return package


def _apply(mutant: Mutant, entries: dict[str, bytes], folder: str) -> None:
    """Make the changes of a fault in `entries`, whose `folder` holds the packed source."""

    def refused(where: str, reason: str) -> MutantError:
        return MutantError(mutant.file, where, reason)

    def file_of(field: str, end: str, named: str) -> str:
        files = [name for name in entries if name.startswith(folder) and f"/{name}".endswith(end)]
        if len(files) == 1:
            return files[0]
        paths = ", ".join(sorted(name.removeprefix(folder) for name in files))
        lacks = f"no {named} in the FMU"
        raise refused(f"{mutant.id}.{field}", f"{named} may be in {paths}" if files else lacks)

    changed = {folder + file for file in mutant.additions}
    for file, source in mutant.additions.items():
        if folder + file in entries:
            raise refused(f"{mutant.id}.additions", f"{file} is packed already")
        entries[folder + file] = (mutant.file.parent / source).read_bytes()
    for n, change in enumerate(mutant.substitutions):
        name, where = change.file, f"substitutions[{n}]"
        if name != DESCRIPTION:
            name = file_of(f"{where}.file", f"/{name}", name)
            changed.add(name)
        count = entries[name].count(change.find.encode())
        if count != 1:
            reason = f"matches {count} times in {change.file}, not once"
            raise refused(f"{mutant.id}.{where}.find", reason)
        entries[name] = entries[name].replace(change.find.encode(), change.replace.encode())
    for module in sorted(changed):
        try:
            parsed(entries[module])
        except SyntaxError as error:
            reason = f"line {error.lineno} is not Python any more: {error.msg}"
            raise refused(module.removeprefix(folder), reason) from None
    for n, override in enumerate(mutant.overrides):
        if override.module != MASTER:
            end = f"/{override.module.replace('.', '/')}.py"
            name = f"_planted_{n}"
            text = f"\n\n{override.function(name)}\n\n{override.path} = {name}({override.path})\n"
            entries[file_of("overrides", end, override.target)] += text.encode()
