"""Descriptions of planted faults: data files, read, checked and turned into frozen objects.

A fault is one TOML file under `mutant.schema.json`: what is substituted in the packed source of
the FMU, and which checks must convict it. Adding a fault is adding a file.
"""

from __future__ import annotations

import fnmatch
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from stickslip_verification.data_file import DataError, objection, read_text, read_toml, where_is

HERE = Path(__file__).parent
FAULTS_FOLDER = HERE / "faults"
SCHEMA = HERE / "mutant.schema.json"
IDLE = HERE / "idle.toml"


class MutantError(DataError):
    """A fault cannot be planted; one line with the file, the line or field, and the reason."""


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
    data = read_toml(file, MutantError)
    found = objection(data, SCHEMA)
    if found is not None:
        raise MutantError(file, where_is(file, found[0]), found[1])
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


@cache
def idle_reasons(file: Path = IDLE) -> Mapping[str, str]:
    """Read why checks that convict no fault stay, by check."""
    reasons: dict[str, str] = read_toml(file, MutantError)["idle"]
    return reasons


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
