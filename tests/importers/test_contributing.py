"""The section "Add an importer" of CONTRIBUTING.md, done as it says in a copy of the tests."""

import re
from pathlib import Path

from tests.test_contributing import applied, copied, walk
from tests.verification.test_contributing import blocks

SECTION = "Add an importer"
COPIED = ("CONTRIBUTING.md", "pyproject.toml", "docs/importing.md", "examples/importing", "tests")


def test_an_importer_is_added_as_contributing_says(tmp_path: Path) -> None:
    """Its modules, its script and its rows in the document pass the tests of every importer."""
    copied(COPIED, tmp_path)
    by, able = blocks(SECTION, "python")
    inside = tmp_path / "tests" / "importers" / "inside"
    (inside / "by_stepper.py").write_text(by, encoding="utf-8")
    (inside / "able_stepper.py").write_text(able, encoding="utf-8")
    (diff,) = blocks(SECTION, "diff")
    (document,) = applied(diff, tmp_path)
    section = document.read_text(encoding="utf-8").split("\n## FMPy, call by call\n")[1]
    script = re.findall(r"^```python\n(.*?)^```$", section, re.MULTILINE | re.DOTALL)[0]
    example = tmp_path / "examples" / "importing" / "with_stepper.py"
    example.write_text(script, encoding="utf-8")

    (command,) = blocks(SECTION, "bash")
    said = walk(command, tmp_path, PYTEST_DEBUG_TEMPROOT=str(tmp_path))
    # Where no C compiler or no libpython is found, two of them are skipped.
    assert re.search(r" (16 passed|14 passed, 2 skipped), ", said), said
