"""The section "Add an importer" of CONTRIBUTING.md, done as it says in a copy of the tests."""

import re
from pathlib import Path

import pytest

from tests.contributing import applied, blocks, copied, walk

COPIED = ("CONTRIBUTING.md", "pyproject.toml", "docs/importing.md", "examples/importing", "tests")


@pytest.mark.gate
def test_an_importer_is_added_as_contributing_says(tmp_path: Path) -> None:
    copied(COPIED, tmp_path)
    [module], [diff], [command] = (
        blocks("Add an importer", language) for language in ("python", "diff", "bash")
    )
    inside = tmp_path / "tests" / "importers" / "inside"
    (inside / "by_stepper.py").write_text(module, encoding="utf-8")
    [document] = applied(diff, tmp_path)
    section = document.read_text(encoding="utf-8").split("\n## FMPy, call by call\n")[1]
    script = re.findall(r"^```python\n(.*?)^```$", section, re.MULTILINE | re.DOTALL)[0]
    example = tmp_path / "examples" / "importing" / "with_stepper.py"
    example.write_text(script, encoding="utf-8")
    said = walk(command, tmp_path, PYTEST_DEBUG_TEMPROOT=str(tmp_path))
    assert re.search(r"\b9 passed, ", said), said
