"""Descriptions of planted faults: data files, read, checked and turned into frozen objects.

A fault is one TOML file under `schemas.FAULT`: what it replaces, in the packed source of the
FMU or in the calls that the suite makes to it, and which checks must detect it. Adding a fault is
adding a file.
"""

import ast
import fnmatch
import textwrap
import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from stickslip_verification.model.data_file import (
    DataError,
    objection,
    read_text,
    read_toml,
    where_is,
)
from stickslip_verification.suite import schemas
from stickslip_verification.truth import COULOMB_NAME

HERE = Path(__file__).parent
FAULTS_FOLDER = HERE / "faults"
KILLS_NOTHING = HERE / "kills_nothing.toml"

Hook = tuple[str, str]
"""One of `HOOKS`, and Python that defines a function of this name, given ``original``."""

HOOKS = ("get", "set", "step", "reset")
"""Calls of the master that a fault can replace. Variables by the suite's names, values in SI."""

MASTER = "master"
"""In place of a module: the override replaces a call that the suite makes to an instance."""

PYTHON = (3, 8)
"""The oldest Python that loads the FMU, and so every fault."""


# CPython 3.11 counts the depth of its parser for all threads at once, and faults are planted in
# several: without the lock `ast.parse` now and then ends in a SystemError.
_PARSING = threading.Lock()


def parsed(text: str | bytes, **options: Any) -> ast.Module:
    """Return the syntax tree of a Python source; raises as `ast.parse` does."""
    with _PARSING:
        tree: ast.Module = ast.parse(text, **options)
    return tree


class MutantError(DataError):
    """A fault cannot be planted; one line with the file, the line or field, and the reason."""


@dataclass(frozen=True)
class Override:
    """One replacement of what a name stands for.

    Attributes
    ----------
    target
        ``module.name`` or ``module.Class.name`` in the packed source, or ``master.`` and one of
        `HOOKS`. A module is named by the end of its dotted name, as much of it as is unique.
    code
        Python that defines the last name of the target anew, or "".
    value
        A Python expression for its new value, or "". One of the two is given; in both ``original``
        is what they replace.
    """

    target: str
    code: str = ""
    value: str = ""

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
        last = self.path.rpartition(".")[2]
        made = f"{self.code.strip()}\nreturn {last}" if self.code else f"return (\n{self.value}\n)"
        return f"def {name}(original):\n{textwrap.indent(made, '    ')}\n"


@dataclass(frozen=True)
class Substitution:
    """One change of text: ``find`` stands exactly once in ``file`` and gives way to ``replace``.

    ``file`` is the end of a path in the packed source, or ``modelDescription.xml``.
    """

    file: str
    find: str
    replace: str


@dataclass(frozen=True)
class Addition:
    """A module with the path ``file`` and this ``text`` that joins the packed source."""

    file: str
    text: str


@dataclass(frozen=True)
class Mutant:
    """One fault to plant.

    ``detected_by`` names the checks that fit the fault; at least one of them must fail. The
    ``additions`` are made first, then the ``substitutions``, then the ``overrides``, each in their
    order. ``file`` is the description, ``law`` the name of the friction law whose FMU it is for.
    """

    id: str
    about: str
    detected_by: tuple[str, ...]
    substitutions: tuple[Substitution, ...]
    additions: tuple[Addition, ...]
    file: Path
    overrides: tuple[Override, ...] = ()
    law: str = COULOMB_NAME

    @property
    def hooks(self) -> tuple[Hook, ...]:
        """The overrides of calls of the master."""
        return tuple((each.path, each.code) for each in self.overrides if each.module == MASTER)

    @property
    def changes_the_fmu(self) -> bool:
        """Whether the fault lies in the FMU, so that it needs the source which ours carries."""
        return bool(self.substitutions or self.additions) or len(self.hooks) < len(self.overrides)


def load_mutants(pattern: str | None = None, folder: Path | None = None) -> list[Mutant]:
    """Read the descriptions of a folder, in the order of their names.

    Parameters
    ----------
    pattern
        Shell pattern on the ids (``state-*``); None takes all.
    folder
        Where the TOML files are; None takes the suite's own.

    Raises
    ------
    MutantError
        A description is broken (also one that the pattern leaves out), or none matches.
    """
    folder = FAULTS_FOLDER if folder is None else folder
    if not folder.is_dir():
        raise MutantError(folder, "", "no such folder of planted faults")
    mutants = [load_mutant(file) for file in sorted(folder.glob("*.toml"))]
    chosen = [m for m in mutants if pattern is None or fnmatch.fnmatchcase(m.id, pattern)]
    if not chosen:
        raise MutantError(folder, "", f"no planted fault matches {pattern or '*.toml'!r}")
    return chosen


def load_mutant(file: Path) -> Mutant:
    """Read one description; `MutantError` names what is wrong with it and where."""
    data = read_toml(file, MutantError)
    found = objection(data, schemas.FAULT)
    if found is not None:
        raise MutantError(file, where_is(file, found[0]), found[1])
    if data["id"] != file.stem:
        raise MutantError(file, "id", f"{data['id']!r} is not the name of the file")
    if not {"overrides", "substitutions"} & data.keys():
        raise MutantError(file, "", "plants nothing: there are neither overrides nor substitutions")
    return Mutant(
        id=data["id"],
        about=" ".join(data["about"].split()),
        detected_by=tuple(data["detected_by"]),
        substitutions=tuple(
            _substitution(file, f"substitutions[{n}]", entry)
            for n, entry in enumerate(data.get("substitutions", []))
        ),
        additions=tuple(
            _addition(file, f"additions[{n}]", entry)
            for n, entry in enumerate(data.get("additions", []))
        ),
        file=file,
        overrides=tuple(
            _override(file, f"overrides[{n}]", entry)
            for n, entry in enumerate(data.get("overrides", []))
        ),
        law=data.get("law", COULOMB_NAME),
    )


@cache
def reasons_to_stay(file: Path = KILLS_NOTHING) -> Mapping[str, str]:
    """Read why checks that detect no fault stay, by check."""
    reasons: dict[str, str] = read_toml(file, MutantError)["kills_nothing"]
    return reasons


def _override(file: Path, here: str, entry: Mapping[str, str]) -> Override:
    override = Override(**entry)
    if len(entry) != 2:
        which = "both code and value" if len(entry) > 2 else "neither code nor value"
        raise MutantError(file, here, f"has {which}")
    field = f"{here}.code" if override.code else f"{here}.value"
    if override.module == MASTER:
        if override.path not in HOOKS:
            reason = f"no such call of the master: {override.target}; there are {', '.join(HOOKS)}"
            raise MutantError(file, f"{here}.target", reason)
        if not override.code:
            raise MutantError(file, field, "a call of the master is replaced by code")
    text, mode = (override.code, "exec") if override.code else (f"({override.value}\n)", "eval")
    try:
        tree = parsed(text, mode=mode, feature_version=PYTHON)
        # What a syntax tree may hold, and a module or a function may not.
        for whole, how in ((text, mode), (override.function("made"), "exec")):
            compile(whole, here, how)
    except SyntaxError as error:
        # A value ends in a line of its own, which the file does not have.
        line = min(error.lineno or 1, max(1, len((override.code or override.value).splitlines())))
        reason = f"line {line} is not Python 3.8: {error.msg}"
        raise MutantError(file, field, reason) from None
    except ValueError as error:
        raise MutantError(file, field, str(error)) from None
    last = override.path.rpartition(".")[2]
    if isinstance(tree, ast.Module) and last not in bindings(tree.body):
        raise MutantError(file, field, f"does not define {last}")
    return override


def bindings(body: Sequence[ast.stmt]) -> dict[str, ast.stmt]:
    """Return the names that statements bind, with the statement that binds each first."""
    found: dict[str, ast.stmt] = {}
    for statement in body:
        names: list[str] = []
        match statement:
            case ast.FunctionDef(name=name) | ast.ClassDef(name=name):
                names = [name]
            case ast.Assign(targets=targets):
                nodes = [node for target in targets for node in ast.walk(target)]
                stored = [
                    node for node in nodes if isinstance(getattr(node, "ctx", None), ast.Store)
                ]
                names = [node.id for node in stored if isinstance(node, ast.Name)]
            case ast.AnnAssign(target=ast.Name(id=name), value=ast.expr()):
                names = [name]
            case ast.Import(names=aliases) | ast.ImportFrom(names=aliases):
                names = [alias.asname or alias.name for alias in aliases]
        for name in names:
            found.setdefault(name, statement)
    return found


def _substitution(file: Path, here: str, entry: Mapping[str, str]) -> Substitution:
    substitution = Substitution(**entry)
    if substitution.find == substitution.replace:
        raise MutantError(file, f"{here}.replace", "is what it replaces")
    return substitution


def _addition(file: Path, here: str, entry: Mapping[str, str]) -> Addition:
    if "text" in entry:
        return Addition(entry["file"], entry["text"])
    try:
        text = read_text(file.parent / entry["source"], MutantError)
    except MutantError as error:
        raise MutantError(file, f"{here}.source", f"{entry['source']}: {error.reason}") from None
    return Addition(entry["file"], text)
