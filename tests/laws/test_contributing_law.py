"""The friction law of CONTRIBUTING.md, added as the section says."""

from __future__ import annotations

import re
from pathlib import Path

import fmpy
import fmpy.validation
import pytest

from tests.contributing import blocks, section, walk
from tests.python import python

TITLE = "A friction law"
TRUTH = """
from stickslip_verification import truth
from stickslip_verification.truth import Step

run = truth.run({"rise": 0.05}, [Step(1.0)], law="rising:RISING")
print(float(run.samples[0]["t_slip"]))
"""


@pytest.mark.gate
def test_a_friction_law_is_added_as_contributing_says(tmp_path: Path) -> None:
    files = re.findall(r"^\d\. `(rising/\w+\.py)`", section(TITLE), re.MULTILINE)
    texts = blocks(TITLE, "python")
    assert len(files) == len(texts) == 4
    (tmp_path / "rising").mkdir()
    for name, text in zip(files, texts, strict=True):
        (tmp_path / name).write_text(text, encoding="utf-8")
    (commands,) = blocks(TITLE, "bash")
    _, block, reference = (
        walk(line, tmp_path, PYTHONPATH=str(tmp_path), COLUMNS="100")
        for line in commands.splitlines()
    )
    (fmu,) = tmp_path.rglob("RisingFriction.fmu")
    assert not fmpy.validation.validate_fmu(str(fmu))
    variables = fmpy.read_model_description(str(fmu)).modelVariables
    (rise,) = (each for each in variables if each.name == "rise")
    assert (rise.valueReference, rise.unit, rise.start) == (38, "s/m", "0.01")
    assert block.split("\n", 1)[1] == reference.split("\n", 1)[1]
    (shown,) = re.findall(r"t_slip +ms +([\d.]+)", block)
    exact = float(python("-c", TRUTH, cwd=tmp_path, env={"PYTHONPATH": str(tmp_path)}).stdout)
    assert shown == f"{1000.0 * exact:.6g}"
