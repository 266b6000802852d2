import re
import shutil
from pathlib import Path

import pytest

from tests.python import python

README = Path(__file__).parents[1] / "README.md"
EXAMPLES = re.findall(r"```python\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)


@pytest.mark.parametrize("example", EXAMPLES)
def test_an_example_of_the_readme_runs_where_the_fmu_was_built(
    example: str, fmu_path: Path, tmp_path: Path
) -> None:
    (tmp_path / "build").mkdir()
    shutil.copy(fmu_path, tmp_path / "build")
    assert python("-c", example, cwd=tmp_path).stdout.strip()
