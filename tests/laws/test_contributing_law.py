"""The friction law of CONTRIBUTING.md, added as the section says."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import fmpy
import fmpy.validation

TEXT = (Path(__file__).parents[2] / "CONTRIBUTING.md").read_text(encoding="utf-8")
COMMAND = Path(sys.executable).parent / "stickslip"
TRUTH = """
from stickslip_verification import truth
from stickslip_verification.truth import Step

run = truth.run({"rise": 0.05}, [Step(1.0)], law="rising:RISING")
print(float(run.samples[0]["t_slip"]))
"""


def run(command: list[str], folder: Path) -> str:
    """Run a command in a folder; give what it prints."""
    environment = {**os.environ, "PYTHONPATH": str(folder), "COLUMNS": "100"}
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_a_friction_law_is_added_as_contributing_says(tmp_path: Path) -> None:
    """Its four files are a law that builds, and on which block, reference and truth agree."""
    section = TEXT[TEXT.index("## A friction law\n") :].split("\n## ")[0]
    files = re.findall(r"^\d\. `(rising/\w+\.py)`", section, re.MULTILINE)
    texts = re.findall(r"```python\n(.*?)```", section, re.DOTALL)
    assert len(files) == len(texts) == 4
    (tmp_path / "rising").mkdir()
    for name, text in zip(files, texts, strict=True):
        (tmp_path / name).write_text(text, encoding="utf-8")
    (commands,) = re.findall(r"```bash\n(.*?)```", section, re.DOTALL)
    said = []
    for line in commands.splitlines():
        name, *arguments = shlex.split(line)
        assert name == "stickslip"
        said.append(run([str(COMMAND), *arguments], tmp_path))
    (fmu,) = tmp_path.rglob("RisingFriction.fmu")
    assert str(fmu.relative_to(tmp_path)) in said[0]
    assert not fmpy.validation.validate_fmu(str(fmu))
    variables = fmpy.read_model_description(str(fmu)).modelVariables
    (rise,) = (each for each in variables if each.name == "rise")
    assert (rise.valueReference, rise.unit, rise.start) == (38, "s/m", "0.01")
    block, reference = (each.split("\n", 1)[1] for each in said[1:])
    assert block == reference
    (shown,) = re.findall(r"t_slip +ms +([\d.]+)", block)
    exact = float(run([sys.executable, "-c", TRUTH], tmp_path))
    assert shown == f"{1000.0 * exact:.6g}"
