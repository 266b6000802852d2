"""Planted faults, read from data files.

A file is a group of faults: tables whose names are the ids. A fault says what it replaces, in the
packed source of the FMU or in the calls that the suite makes to it, and which checks must detect
it.
"""

import ast
import fnmatch
import symtable
import textwrap
import threading
from collections.abc import Mapping
from dataclasses import field, replace
from pathlib import Path
from typing import Annotated, Any, ClassVar

from pydantic import Field
from pydantic.dataclasses import dataclass

from stickslip_verification.model import data_file as data
from stickslip_verification.truth import COULOMB_NAME

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
