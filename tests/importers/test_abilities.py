"""The tables of docs/importing.md say of each importer what it was seen to do."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable
from functools import cache
from importlib.metadata import version
from pathlib import Path

import pytest

from tests.importers import kinds
from tests.importers.running import IMPORTERS, ImporterError, Said, ask, preload
from tests.needs import NEEDS, each, needs

ROOT = Path(__file__).parents[2]
DOCUMENT = ROOT / "docs" / "importing.md"

COLUMNS = {
    "Real": "Real",
    "Integer": "Integer",
    "Boolean": "Boolean",
    "Enumeration": "Enumeration",
    "String": "String",
    "inputs in the run": "inputs",
    "parameters in the run": "parameters",
    "several blocks": "several",
    "reset": "reset",
    "get and set state": "state",
    "serialize": "serialize",
    "any step": "variable_step",
    "units": "units",
}
"""Columns of the table, and the probe whose finding stands in them as yes or no."""

WARNING = "mu_k is clamped"
REFUSAL = "k = -1.0 N/m is out of range: it must be finite and above 0"

Asked = Callable[[str, str], Said]


@pytest.fixture(scope="module")
def asked(fmu_path: Path, tmp_path_factory: pytest.TempPathFactory) -> Asked:
    """Give what tries an importer, each question once."""
    folder = tmp_path_factory.mktemp("kinds")
    echoes = {
        kind: (str(kinds.build(kind, folder)), kinds.VALUES[kind][1]) for kind in kinds.VALUES
    }

    @cache
    def once(importer: str, what: str) -> Said:
        order = {"importer": importer, "kinds": echoes} if what == "tried" else importer
        own = tmp_path_factory.mktemp(f"{importer}-{what}")
        return ask("abilities", what, fmu_path, own, preload(importer), order)

    return once


def table(heading: str) -> dict[str, dict[str, str]]:
    """Return the first table below a heading of the document, by importer and column."""
    section = DOCUMENT.read_text(encoding="utf-8").split(f"\n## {heading}\n")[1].split("\n## ")[0]
    lines = [line for line in section.splitlines() if line.startswith("|")]
    head, _, *rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    return {
        row[0].strip("`"): {column: cell.strip("*") for column, cell in zip(head, row, strict=True)}
        for row in rows
    }


WHAT_IT_CAN = table("What each importer cannot do")
REFUSED = table("When the block refuses a value")


def test_the_tables_have_every_importer_and_column() -> None:
    """No importer that is tried is left out of a table, and no column is without a probe."""
    assert sorted(WHAT_IT_CAN) == sorted(REFUSED) == list(IMPORTERS)
    columns = {"importer", "any folder", "messages", "a refused start value", *COLUMNS}
    assert all(set(row) == columns for row in WHAT_IT_CAN.values())


@pytest.mark.parametrize("importer", each(IMPORTERS))
def test_what_an_importer_can_do(asked: Asked, importer: str) -> None:
    """Cell by cell, the table says yes where the importer did it and no where it did not."""
    found = asked(importer, "tried").answer
    seen = {column: "yes" if found[probe] else "no" for column, probe in COLUMNS.items()}
    assert seen == {column: WHAT_IT_CAN[importer][column] for column in COLUMNS}


@pytest.mark.parametrize("importer", each(IMPORTERS))
def test_whether_the_folder_matters(fmu_path: Path, tmp_path: Path, importer: str) -> None:
    """Where an importer encodes the address of the FMU's folder, the wrapper cannot read it."""
    folder = tmp_path / "é"
    folder.mkdir()
    try:
        done = ask("abilities", "begin", fmu_path, folder, preload(importer), importer).answer
    except ImporterError as error:
        seen = "crash" if error.code < 0 else str(error)
    else:
        seen = "yes" if done else "no"
    assert seen == WHAT_IT_CAN[importer]["any folder"]


@pytest.mark.parametrize("importer", each(IMPORTERS))
def test_whether_an_importer_shows_messages(asked: Asked, importer: str) -> None:
    """Asked for messages, it shows the block's warning beside what stands on standard error."""
    try:
        said = asked(importer, "log")
    except ImporterError as error:
        seen = "crash" if error.code < 0 else str(error)
    else:
        lines = [line for line in (said.out + said.err).splitlines() if WARNING in line]
        shown = [line for line in lines if not line.startswith("StickSlip: ")]
        seen = "yes" if shown else "no"
        assert (len(lines) > len(shown)) == (importer != "proxyfmu")
    assert seen == WHAT_IT_CAN[importer]["messages"]


@pytest.mark.parametrize("importer", each(IMPORTERS))
def test_what_comes_of_a_refused_value(asked: Asked, importer: str) -> None:
    """At the start and between two steps the importer does what both tables say."""
    outcome = {
        "at the start": _outcome(asked, importer, "refused"),
        "between two steps": _outcome(asked, importer, "refused_later"),
    }
    told = {when: REFUSED[importer][when].replace("`", "") for when in outcome}
    assert outcome == told
    assert WHAT_IT_CAN[importer]["a refused start value"] == _in_a_word(outcome["at the start"])


def test_the_message_in_the_document_is_the_blocks(asked: Asked) -> None:
    """What the document shows of a refusal stands on standard error to the letter."""
    shown = re.findall(
        r"^```text\n(StickSlip: .*)\n```$", DOCUMENT.read_text("utf-8"), re.MULTILINE
    )
    assert len(shown) == 1
    assert shown[0] in asked("fmpy", "refused").err.splitlines()


def _outcome(asked: Asked, importer: str, when: str) -> str:
    """Return what came of a refused value, whose message must be on standard error."""
    try:
        said = asked(importer, when)
    except ImporterError as error:
        outcome, err = "the process is aborted" if error.code == -6 else str(error), error.err
    else:
        outcome, err = said.answer, said.err
    assert (f"StickSlip: {REFUSAL}" in err) == (importer != "proxyfmu")
    return outcome


def _in_a_word(outcome: str) -> str:
    if "aborted" in outcome:
        return "crash"
    return "goes on" if outcome.startswith("goes on") else "stops"


@needs(*(name for name in IMPORTERS if name in NEEDS))
def test_the_versions_are_those_that_were_tried() -> None:
    """The document names the version of FMPy and of each package of the extra `importers`."""
    text = DOCUMENT.read_text(encoding="utf-8")
    named = re.findall(r"`pip install ([\w-]+)`, tried with ([\d.]+\d)", text)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extra = re.findall(r"[\w-]+(?=>=)", " ".join(project["optional-dependencies"]["importers"]))
    assert sorted(named) == sorted((package, version(package)) for package in ["fmpy", *extra])
