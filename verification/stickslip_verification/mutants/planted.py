"""Descriptions of planted faults: data files, read, checked and turned into frozen objects.

A fault is one TOML file under `mutant.schema.json`: what is substituted in the packed source of
the FMU, and which checks must convict it. Adding a fault is adding a file.
"""

from __future__ import annotations

import fnmatch
import json
import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import jsonschema

HERE = Path(__file__).parent
FAULTS_FOLDER = HERE / "faults"


class MutantError(ValueError):
    """A fault cannot be planted; one line with the file, the line or field, and the reason."""

    def __init__(self, file: Path, where: str, reason: str) -> None:
        self.file = file
        self.where = where
        self.reason = reason
        super().__init__(": ".join(part for part in (str(file), where, reason) if part))


@dataclass(frozen=True)
class Substitution:
    """One change of text: ``find`` stands exactly once in ``file`` and gives way to ``replace``.

    ``file`` is a module of the packed source or ``modelDescription.xml``.
    """

    file: str
    find: str
    replace: str


@dataclass(frozen=True)
class Addition:
    """A module ``file`` with this ``text`` that joins the packed source."""

    file: str
    text: str


@dataclass(frozen=True)
class Mutant:
    """One fault to plant.

    ``convicted_by`` names the checks that fit the fault; at least one of them must fail.
    ``substitutions`` are made in their order, after the ``additions``. ``file`` is the description.
    """

    id: str
    about: str
    convicted_by: tuple[str, ...]
    substitutions: tuple[Substitution, ...]
    additions: tuple[Addition, ...]
    file: Path


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
    try:
        data = tomllib.loads(_text(file))
    except tomllib.TOMLDecodeError as error:
        raise MutantError(file, *_line_and_reason(str(error))) from None
    fault = jsonschema.exceptions.best_match(_validator().iter_errors(data))
    if fault is not None:
        raise MutantError(file, _field(fault.absolute_path), fault.message)
    if data["id"] != file.stem:
        raise MutantError(file, "id", f"{data['id']!r} is not the name of the file")
    return Mutant(
        id=data["id"],
        about=" ".join(data["about"].split()),
        convicted_by=tuple(data["convicted_by"]),
        substitutions=tuple(
            _substitution(file, f"substitutions[{n}]", entry)
            for n, entry in enumerate(data["substitutions"])
        ),
        additions=tuple(
            _addition(file, f"additions[{n}]", entry)
            for n, entry in enumerate(data.get("additions", []))
        ),
        file=file,
    )


def _text(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8")
    except OSError as error:
        raise MutantError(file, "", error.strerror or str(error)) from None
    except UnicodeDecodeError as error:
        raise MutantError(file, "", f"is not UTF-8: {error.reason}") from None


def _substitution(file: Path, here: str, entry: Mapping[str, str]) -> Substitution:
    substitution = Substitution(**entry)
    if substitution.find == substitution.replace:
        raise MutantError(file, f"{here}.replace", "is what it replaces")
    return substitution


def _addition(file: Path, here: str, entry: Mapping[str, str]) -> Addition:
    if "text" in entry:
        return Addition(entry["file"], entry["text"])
    try:
        text = _text(file.parent / entry["source"])
    except MutantError as error:
        raise MutantError(file, f"{here}.source", f"{entry['source']}: {error.reason}") from None
    return Addition(entry["file"], text)


def _line_and_reason(message: str) -> tuple[str, str]:
    place = re.search(r" \(at (line \d+)[^)]*\)$", message)
    return (place[1], message[: place.start()]) if place else ("", message)


@cache
def _validator() -> Any:
    schema = json.loads((HERE / "mutant.schema.json").read_text(encoding="utf-8"))
    return jsonschema.Draft202012Validator(schema)


def _field(path: Sequence[str | int]) -> str:
    text = ""
    for part in path:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else str(part)
    return text
