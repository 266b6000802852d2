"""Planted faults, read from data files, and mutants: the built FMU with one fault planted.

A file is a group of faults: tables whose names are the ids. A fault says what it replaces, in the
packed source of the FMU or in the calls that the suite makes to it, and which checks must detect
it.

An override is planted at the end of its module: a function makes the replacement of the original,
and the name is bound to it. Python runs one code per module name in a process, so the packed
package gets a name of its own, by which a mutant loads beside the original and other mutants.
"""

import ast
import fnmatch
import hashlib
import re
import symtable
import textwrap
import threading
import zipfile
from collections.abc import Mapping
from dataclasses import field, replace
from pathlib import Path
from typing import Annotated, Any, ClassVar

from pydantic import Field
from pydantic.dataclasses import dataclass

from ..model import data_file as data
from ..truth import COULOMB_NAME

FAULTS_FOLDER = Path(__file__).parent / "faults"

Hook = tuple[str, str]
"""One of `HOOKS`, and Python that defines a function of this name, given ``original``."""
HOOKS = ("get", "set", "step", "reset")
"""Calls of the master that a fault can replace. Variables by the suite's names, values in SI."""
MASTER = "master"  # in place of a module: the override replaces a call to an instance
_PYTHON = (3, 8)  # the oldest that loads the FMU, and so every fault

# CPython 3.11 counts the depth of its parser for all threads at once, and faults are planted in
# several: without the lock `ast.parse` now and then ends in a SystemError.
_PARSING = threading.Lock()


def parsed(text: str | bytes, **options: Any) -> ast.Module:
    """Return the syntax tree of a Python source; raises as `ast.parse` does."""
    with _PARSING:
        tree: ast.Module = ast.parse(text, **options)
    return tree


class MutantError(data.DataError):
    """A fault cannot be planted; one line with the file, the line or field, and the reason."""


_PART = "[a-z_][a-z0-9_]*"
_MODULE = rf"{_PART}(/{_PART})*\.py"
_TARGET = rf"^{_PART}(\.{_PART})*(\._?[A-Z][A-Za-z0-9_]*)?(\.[A-Za-z_][A-Za-z0-9_]*)$"


@dataclass(frozen=True, config=data.WRITTEN)
class Override(data.Written):
    """One replacement of what a name stands for.

    ``target`` is ``module.name`` or ``module.Class.name`` in the packed source, a module by the end
    of its dotted name, or ``master.`` and one of `HOOKS`. ``code`` is Python that defines the last
    name of the target anew; ``original`` is what it replaces.
    """

    target: Annotated[str, Field(pattern=_TARGET)]
    code: str

    def __post_init__(self) -> None:
        if self.module == MASTER and self.path not in HOOKS:
            raise ValueError(f"no such call of the master; there are {', '.join(HOOKS)}")
        try:
            parsed(self.code, feature_version=_PYTHON)
            # What a syntax tree may hold, and a module or a function may not.
            for text in (self.code, self.function("made")):
                compile(text, self.target, "exec")
        except SyntaxError as error:
            raise ValueError(f"line {error.lineno or 1} is not Python 3.8: {error.msg}") from None
        last = self.path.rpartition(".")[2]
        bound = symtable.symtable(self.code, self.target, "exec").get_symbols()
        if not any(s.get_name() == last and (s.is_assigned() or s.is_imported()) for s in bound):
            raise ValueError(f"does not define {last}")

    @property
    def module(self) -> str:
        """The module of the target, or `MASTER`."""
        return self.target.removesuffix(self.path)[:-1]

    @property
    def path(self) -> str:
        """The target as its module spells it: ``name`` or ``Class.name``."""
        *_, owner, name = self.target.split(".")
        return f"{owner}.{name}" if owner.lstrip("_")[:1].isupper() else name

    def function(self, name: str) -> str:
        """Return the text of a function of this name from ``original`` to what replaces it."""
        made = f"{self.code.strip()}\nreturn {self.path.rpartition('.')[2]}"
        return f"def {name}(original):\n{textwrap.indent(made, '    ')}\n"


@dataclass(frozen=True, config=data.WRITTEN)
class Substitution(data.Written):
    """One change of text: ``find`` stands exactly once in ``file`` and gives way to ``replace``.

    ``file`` is the end of a path in the packed source, or ``modelDescription.xml``.
    """

    file: Annotated[str, Field(pattern=rf"^({_MODULE}|modelDescription\.xml)$")]
    find: data.Text
    replace: str

    def __post_init__(self) -> None:
        if self.find == self.replace:
            raise ValueError("replace is what it replaces")


@dataclass(frozen=True, kw_only=True, config=data.WRITTEN)
class Mutant(data.Written):
    """A fault to plant in the stick-slip FMU; at least one check of ``detected_by`` must fail.

    ``additions`` are modules that join the packed source, each from a file in the folder of the
    description. They are made first, then the ``substitutions``, then the ``overrides``.
    """

    SOME: ClassVar = ("overrides", "substitutions")

    id: data.Id = ""
    about: Annotated[data.Prose, Field(description="what is wrong, and where people make it")]
    law: Annotated[data.Text, Field(description="name of the FMU's friction law")] = COULOMB_NAME
    detected_by: Annotated[tuple[data.Text, ...], Field(min_length=1)]
    additions: Mapping[Annotated[str, Field(pattern=f"^{_MODULE}$")], data.Text] = field(
        default_factory=dict
    )
    substitutions: tuple[Substitution, ...] = ()
    overrides: Annotated[tuple[Override, ...], data.listed("target", short="code")] = ()
    file: Path = Path()

    @property
    def hooks(self) -> tuple[Hook, ...]:
        """The overrides of calls of the master."""
        return tuple((each.path, each.code) for each in self.overrides if each.module == MASTER)

    @property
    def changes_the_fmu(self) -> bool:
        """Whether the fault lies in the FMU, so that it needs the source which ours carries."""
        return bool(self.substitutions or self.additions) or len(self.hooks) < len(self.overrides)


FaultFile = data.ById[Mutant]  # faults to plant in the stick-slip FMU, by their ids


def load_mutants(pattern: str | None = None, files: Path = FAULTS_FOLDER) -> list[Mutant]:
    """Read planted faults from a TOML file or a folder of them, in the order of their ids.

    `pattern` is a shell pattern on the ids (``state-*``). `MutantError` if a description is broken
    (also one that the pattern leaves out), two have one id, or none matches.
    """
    mutants: dict[str, Mutant] = {}
    for path in sorted(files.glob("*.toml")) if files.is_dir() else [files]:
        file = data.DataFile(path, MutantError)
        for mutant in file.read(FaultFile):
            if other := mutants.get(mutant.id):
                raise file.refusal(f"{other.file.name} has a fault of this id", mutant.id)
            for module, source in mutant.additions.items():
                if not (path.parent / source).is_file():
                    raise file.refusal(f"{source}: no such file", mutant.id, "additions", module)
            mutants[mutant.id] = replace(mutant, file=path)
    chosen = [m for m in mutants.values() if pattern is None or fnmatch.fnmatchcase(m.id, pattern)]
    if not chosen:
        raise MutantError(files, "", f"no planted fault matches {pattern or '*'!r}")
    return sorted(chosen, key=lambda mutant: mutant.id)


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
    digest = hashlib.sha256(repr(sorted(entries.items())).encode()).hexdigest()[:16]
    new = f"{package.rpartition('_')[0]}_{digest}"
    renamed = {
        name.replace(package, new): text.replace(package.encode(), new.encode())
        if name.startswith(RESOURCES)
        else text
        for name, text in entries.items()
    }
    renamed[DESCRIPTION] = _GUID.sub(f'guid="{digest}"'.encode(), renamed[DESCRIPTION], count=1)
    target.parent.mkdir(parents=True, exist_ok=True)
    with data.replacing(target) as stream, zipfile.ZipFile(stream, "w") as archive:
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
