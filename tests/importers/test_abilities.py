"""The tables of docs/importing.md say of each importer what it was seen to do."""

import re
import string
import tomllib
from importlib.metadata import version
from pathlib import Path

import pytest

from tests.conftest import built
from tests.driver import DiedError, Host, play
from tests.importers import kinds
from tests.importers.running import IMPORTERS, NOT_PYTHON, ask, preload
from tests.needs import NEEDS, each, needs

ROOT = Path(__file__).parents[2]
pytestmark = pytest.mark.gate
DOCUMENT = (ROOT / "docs" / "importing.md").read_text(encoding="utf-8")
COLUMNS = {
    "Real": "Real",
    "Integer": "Integer",
    "Boolean": "Boolean",
    "Enumeration": "Enumeration",
    "String": "String",
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
SAFE = string.ascii_letters + string.digits + "_.-~ "
"""The characters that the document calls safe in the name of a folder."""
UNSAFE = "%#?()+,&'=@[]!$"
"""Those it warns of, letters with accents aside."""


def table(heading: str) -> dict[str, dict[str, str]]:
    section = DOCUMENT.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    lines = [line for line in section.splitlines() if line.startswith("|")]
    head, _, *rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    return {
        row[0].strip("`"): {
            column: re.sub("[*`]|exception: ", "", cell)
            for column, cell in zip(head, row, strict=True)
        }
        for row in rows
    }


WHAT_IT_CAN = table("What each importer cannot do")
REFUSED = table("When the block refuses a value")


def test_the_tables_have_every_importer_and_column() -> None:
    assert sorted(WHAT_IT_CAN) == sorted(REFUSED) == sorted(IMPORTERS)
    columns = {"importer", "any folder", "messages", "a refused start value", *COLUMNS}
    assert all(set(row) == columns for row in WHAT_IT_CAN.values())


@pytest.fixture(scope="module")
def echoes(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[Path, object]]:
    folder = tmp_path_factory.mktemp("echoes")
    return {kind: (kinds.build(kind, folder), value) for kind, (_, value) in kinds.VALUES.items()}


@pytest.mark.parametrize("importer", each(IMPORTERS))
def test_an_importer_can_do_what_the_table_says(
    echoes: dict[str, tuple[Path, object]], importer: str
) -> None:
    found, _ = ask(importer, "tried", built("python-2"), echoes)
    seen = {column: "yes" if found[probe] else "no" for column, probe in COLUMNS.items()}
    assert seen == {column: WHAT_IT_CAN[importer][column] for column in COLUMNS}


def crash(died: DiedError) -> str:
    return "crash" if died.code and died.code < 0 else str(died)


@pytest.mark.parametrize("importer", each(IMPORTERS))
def test_where_an_importer_encodes_the_address_of_a_folder_it_crashes(
    tmp_path: Path, importer: str
) -> None:
    folder = tmp_path / "é"
    folder.mkdir()
    process = Host(TMPDIR=str(folder), **preload(importer))
    try:
        done, _ = ask(importer, "inputs", built("python-2"), process=process)
        seen = "yes" if done else "no"
    except DiedError as died:
        seen = crash(died)
    process.end()
    assert seen == WHAT_IT_CAN[importer]["any folder"]


@pytest.mark.parametrize("importer", each(IMPORTERS))
def test_an_importer_shows_the_warnings_of_the_block_beside_standard_error(importer: str) -> None:
    try:
        _, said = ask(importer, "warn", built("python-2"))
    except DiedError as died:
        seen = crash(died)
    else:
        lines = [line for line in said.splitlines() if "mu_k is clamped" in line]
        shown = [line for line in lines if not line.startswith("StickSlip: ")]
        seen = "yes" if shown else "no"
        assert (len(lines) > len(shown)) == (importer not in NOT_PYTHON)
    assert seen == WHAT_IT_CAN[importer]["messages"]


@pytest.mark.parametrize("when", ["at the start", "between two steps"])
@pytest.mark.parametrize("importer", each(IMPORTERS))
def test_what_comes_of_a_refused_value(importer: str, when: str) -> None:
    try:
        outcome, said = ask(importer, "refused", built("python-2"), when)
    except DiedError as died:
        outcome, said = "the process is aborted" if died.code == -6 else str(died), died.errors
    assert outcome == REFUSED[importer][when]
    [message] = re.findall(r"^```text\n(StickSlip: .*)\n```$", DOCUMENT, re.MULTILINE)
    assert (message in said.splitlines()) == (importer not in NOT_PYTHON)
    if when == "at the start":
        word = re.match("goes on|(the process is aborted)|", outcome)
        assert word is not None
        in_a_word = "crash" if word[1] else word[0] or "stops"
        assert WHAT_IT_CAN[importer]["a refused start value"] == in_a_word


@needs("proxyfmu")
def test_without_libpython_ecos_crashes_in_proxyfmu() -> None:
    process = Host(LD_PRELOAD="")
    with pytest.raises(DiedError, match=r"(?s)exit code -.*Unable to bind") as caught:
        ask("proxyfmu", "inputs", built("python-2"), process=process)
    # The socket that nobody removes after the crash.
    for left in re.findall(r"using handle '([^']+)'", caught.value.errors):
        Path(left).unlink(missing_ok=True)


@needs(*(name for name in IMPORTERS if name in NEEDS))
def test_the_versions_in_the_document_are_those_that_were_tried() -> None:
    named = re.findall(r"`pip install ([\w-]+)`, tried with ([\d.]+\d)", DOCUMENT)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extra = re.findall(r"[\w-]+(?=>=)", " ".join(project["optional-dependencies"]["importers"]))
    assert sorted(named) == sorted((package, version(package)) for package in ["fmpy", *extra])


def step_in(folder: Path) -> None:
    """Step the FMU in a process that unpacks it there, and encodes the address."""
    folder.mkdir()
    process = Host(TMPDIR=str(folder))
    try:
        process.call(play, built("python-2"), [["start"], ["step", 0.01]])
    finally:
        process.end()


def test_the_document_calls_safe_what_is_safe_in_the_name_of_a_folder(tmp_path: Path) -> None:
    told = DOCUMENT.split("\n- **Put the FMU where the path is safe.**")[1].partition("\n- ")[0]
    safe, _, unsafe = told.partition("Of the resource URI")
    named = {*re.findall("`(.)`", safe), " "} - {"/"}
    assert named == {*SAFE} - {*string.ascii_letters, *string.digits}
    assert {*re.findall("`(.)`", unsafe)} == {*UNSAFE}
    step_in(tmp_path / SAFE)


@pytest.mark.parametrize("character", UNSAFE)
def test_any_other_character_ends_the_process(character: str, tmp_path: Path) -> None:
    with pytest.raises(DiedError, match="exit code -"):
        step_in(tmp_path / f"a{character}b")
