"""The friction law that CONTRIBUTING.md gives to copy, built and verified by its lines."""

from pathlib import Path

import pytest

from tests.contributing import ROOT, blocks, walk
from tests.fmu.conformity import by_fmpy


@pytest.mark.gate
def test_the_law_to_copy_keeps_the_exact_contract_on_its_case(tmp_path: Path) -> None:
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    (commands,) = blocks("Add a friction law", "bash")
    printed = walk(commands, tmp_path, COLUMNS="100")
    assert "contract: exact" in printed
    assert " passed, 0 failed" in printed
    assert not by_fmpy(tmp_path / "build" / "RisingFriction.fmu")
