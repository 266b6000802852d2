"""Wrong calls of a master: those that end it are the ones that docs/importing.md names."""

import re
from typing import Any

import pytest

from tests.conftest import built
from tests.driver import OK, Host
from tests.fmu.mistakes import (
    DIES,
    ENDING,
    ENDING_AT_THE_START,
    SURVIVED,
    SURVIVED_AT_THE_START,
    tried,
)
from tests.needs import ROOT

pytestmark = pytest.mark.gate

EXPECTED: dict[str, Any] = {
    **dict.fromkeys(SURVIVED_AT_THE_START, OK),
    **{title: statuses for title, (_, statuses) in SURVIVED.items()},
    **dict.fromkeys([*ENDING_AT_THE_START, *ENDING], DIES),
}


@pytest.fixture(scope="module")
def found() -> dict[str, Any]:
    # What is freed is overwritten, so that the use of it shows at once and not by chance.
    host = Host(PYTHONDEVMODE="1", MALLOC_PERTURB_="165")
    result: dict[str, Any] = host.call(tried, built("python-2"))
    host.end()
    return result


@pytest.mark.parametrize("mistake", EXPECTED)
def test_what_comes_of_a_wrong_call(found: dict[str, Any], mistake: str) -> None:
    assert found[mistake] == EXPECTED[mistake]


def test_the_document_tells_what_a_master_must_not_do() -> None:
    text = (ROOT / "docs" / "importing.md").read_text(encoding="utf-8")
    section = text.split("\n## What pythonfmu's wrapper does not survive")[1].split("\n## ")[0]
    _, *rows = re.findall(r"^\| (.+) \|$", section, re.MULTILINE)
    assert rows == [*ENDING_AT_THE_START, *ENDING]
