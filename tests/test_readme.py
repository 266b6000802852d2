"""The README's Python examples, run as they stand."""

import re
import shutil
from pathlib import Path

import pytest

from tests.python import python

README = Path(__file__).parents[1] / "README.md"
EXAMPLES = re.findall(r"```python\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)


def test_there_are_examples() -> None:
    """The README shows the FMU and the reference from Python."""
    assert len(EXAMPLES) == 2


@pytest.mark.parametrize("example", EXAMPLES)
def test_example_runs(example: str, fmu_path: Path, tmp_path: Path) -> None:
    """An example runs as printed, in a folder where the FMU was built, and says something."""
    (tmp_path / "build").mkdir()
    shutil.copy(fmu_path, tmp_path / "build")
    assert python("-c", example, cwd=tmp_path).stdout.strip()
