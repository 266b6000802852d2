"""The tables of docs/importing.md say of each importer what it was seen to do."""

import re
from pathlib import Path
from typing import Any

import pytest

from tests.conftest import built
from tests.driver import DiedError, Host
from tests.importers.running import IMPORTERS, NOT_PYTHON, ask, preload
from tests.needs import each

ROOT = Path(__file__).parents[2]
pytestmark = pytest.mark.gate
DOCUMENT = (ROOT / "docs" / "importing.md").read_text(encoding="utf-8")
COLUMNS = {
    "inputs in the run": "inputs",
    "parameters in the run": "parameters",
    "several blocks": "several",
    "reset": "resets",
    "get and set state": "state",
    "serialize": "serialize",
    "any step": "any_step",
    "units": "units",
}
"""Columns of the table, and the probe whose finding stands in them as yes or no."""


def table(heading: str) -> dict[str, dict[str, str]]:
    section = DOCUMENT.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    lines = [
        re.sub("[*`]|exception: ", "", line) for line in re.findall(r"^\|(.*)\|$", section, re.M)
    ]
    head, _, *rows = [[cell.strip() for cell in line.split("|")] for line in lines]
    return {row[0]: dict(zip(head[1:], row[1:], strict=True)) for row in rows}


WHAT_IT_CAN = table("What each importer cannot do")
REFUSED = table("When the block refuses a value")


def asked(importer: str, *question: Any, process: Host | None = None) -> tuple[Any, str]:
    try:
        return ask(importer, *question, process=process)
    except DiedError as died:
        return "crash" if died.code and died.code < 0 else str(died), died.errors


@pytest.mark.parametrize("importer", each(IMPORTERS))
def test_an_importer_can_do_what_the_table_says(importer: str) -> None:
    found, _ = ask(importer, "tried", built("python-2"))
    seen = {column: "yes" if found[probe] else "no" for column, probe in COLUMNS.items()}
    others = {"any folder", "messages", "a refused start value"}
    assert seen == {
        name: cell for name, cell in WHAT_IT_CAN[importer].items() if name not in others
    }


@pytest.mark.parametrize("importer", each(IMPORTERS))
def test_where_an_importer_encodes_the_address_of_a_folder_it_crashes(
    tmp_path: Path, importer: str
) -> None:
    (tmp_path / "é").mkdir()
    process = Host(TMPDIR=str(tmp_path / "é"), **preload(importer))
    seen, _ = asked(importer, "inputs", built("python-2"), process=process)
    process.end()
    assert {True: "yes"}.get(seen, seen) == WHAT_IT_CAN[importer]["any folder"]


@pytest.mark.parametrize("importer", each(IMPORTERS))
def test_an_importer_shows_the_warnings_of_the_block_beside_standard_error(importer: str) -> None:
    seen, said = asked(importer, "warn", built("python-2"))
    if seen != "crash":
        lines = [line for line in said.splitlines() if "mu_k is clamped" in line]
        shown = [line for line in lines if not line.startswith("StickSlip: ")]
        seen = "yes" if shown else "no"
        assert (len(lines) > len(shown)) == (importer not in NOT_PYTHON)
    assert seen == WHAT_IT_CAN[importer]["messages"]


@pytest.mark.parametrize("when", ["at the start", "between two steps"])
@pytest.mark.parametrize("importer", each(IMPORTERS))
def test_what_comes_of_a_refused_value(importer: str, when: str) -> None:
    outcome, said = asked(importer, "refused", built("python-2"), when)
    assert outcome == REFUSED[importer][when].replace("the process is aborted", "crash")
    [message] = re.findall(r"^```text\n(StickSlip: .*)\n```$", DOCUMENT, re.MULTILINE)
    assert (message in said.splitlines()) == (importer not in NOT_PYTHON)
    if when == "at the start":
        in_a_word = re.match("goes on|crash|", outcome)
        assert in_a_word is not None
        assert WHAT_IT_CAN[importer]["a refused start value"] == (in_a_word[0] or "stops")
