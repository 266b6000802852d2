"""The section "A model of your own" of CONTRIBUTING.md, done as it says."""

import csv
import math
from pathlib import Path

import pytest

from tests.contributing import blocks, walk

pytestmark = pytest.mark.gate
SECTION = "A model of your own"


def test_a_model_is_built_as_contributing_says(tmp_path: Path) -> None:
    (tmp_path / "pendulum.py").write_text("\n".join(blocks(SECTION, "python")), "utf-8")
    (commands,) = blocks(SECTION, "bash")
    assert "No problems found" in walk(commands, tmp_path)
    with (tmp_path / "swing.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 1001
    w = math.sqrt(9.81 - 0.1**2)
    for row in rows:
        t = float(row["time"])
        phi = 0.1 * math.exp(-0.1 * t) * (math.cos(w * t) + 0.1 / w * math.sin(w * t))
        # A thousand steps, each with roundings of 0.1.
        assert float(row["phi"]) == pytest.approx(phi, abs=1e-13)
