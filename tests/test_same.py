"""Facts about `tools/same.py`, which says whether a change left reports and FMUs as they were."""

import copy
import json
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from stickslip_verification import load_mutants
from stickslip_verification.drive.planting import plant

pytestmark = pytest.mark.gate
TOOL = Path(__file__).parents[1] / "tools" / "same.py"

ROW = {
    "case": "default",
    "check": "T-exact",
    "side": "fmu",
    "quantity": "T",
    "truth": "closed_form",
    "class": "physics",
    "decides": True,
    "expected": 0.3,
    "got": 0.3,
    "tolerance": 1e-12,
    "measure": "relative",
    "verdict": "pass",
}
REPORT: dict[str, Any] = {
    "checks": [ROW, {**ROW, "side": "reference"}],
    "passed": True,
    "kills": {
        "rows": [
            {
                "mutant": "tanh",
                "wanted": ["T-exact"],
                "caught": True,
                "broken": None,
                "failing": {"T-exact": 3},
            }
        ],
        "kills_nothing": {},
    },
    "provenance": {"created": "today"},
}


def same(old: Path, new: Path, *options: str) -> tuple[int, str]:
    done = subprocess.run(
        [sys.executable, str(TOOL), str(old), str(new), *options],
        capture_output=True,
        text=True,
        check=False,
    )
    return done.returncode, done.stdout + done.stderr


def changed(report: dict[str, Any], *path: str | int, to: object) -> dict[str, Any]:
    twin = copy.deepcopy(report)
    node: Any = twin
    for part in path[:-1]:
        node = node[part]
    node[path[-1]] = to
    return twin


@pytest.mark.parametrize(
    ("new", "code", "told"),
    [
        (changed(REPORT, "provenance", "created", to="tomorrow"), 0, "the same"),
        (changed(REPORT, "checks", 1, "got", to=0.30000000000000004), 1, "T-exact (reference): {"),
        (changed(REPORT, "checks", 0, "tolerance", to=1e-11), 1, "rows: 3 and 3, 1 different"),
        (changed(REPORT, "checks", to=[]), 1, "T-exact (fmu): gone"),
        (changed(REPORT, "checks", to=[ROW, *REPORT["checks"]]), 1, "row 2 of this name: new"),
        (changed(REPORT, "passed", to=False), 1, "the whole passed: True, now False"),
        (changed(REPORT, "checks", 0, "check", to="T"), 1, "default / T-exact (fmu): gone"),
        (changed(REPORT, "kills", "rows", 0, "failing", "T-exact", to=2), 1, "tanh: {'wanted'"),
    ],
)
def test_reports_differ_by_what_a_row_compared(
    tmp_path: Path, new: dict[str, Any], code: int, told: str
) -> None:
    for name, report in (("old", REPORT), ("new", new)):
        (tmp_path / f"{name}.json").write_text(json.dumps(report), encoding="utf-8")
    found, printed = same(tmp_path / "old.json", tmp_path / "new.json")
    assert (found, told in printed) == (code, True), printed


def test_fmus_differ_by_description_or_bits(fmu_path: Path, tmp_path: Path) -> None:
    assert same(fmu_path, fmu_path, "--sequences", "3") == (
        0,
        "elements of the description: 186 and 186, 0 different\n"
        "random sequences: 66 and 66, 0 different\nthe same\n",
    )
    faults = [load_mutants(name)[0] for name in ("description-type", "constant-mu-k")]
    both = replace(faults[0], overrides=faults[1].overrides, substitutions=faults[0].substitutions)
    code, printed = same(fmu_path, plant(fmu_path, both, tmp_path), "--sequences", "2")
    assert code == 1
    assert re.search(r"ModelVariables \d+ / ScalarVariable 4: {.*'tunable'.*, now {", printed)
    assert re.search(r"sequence 1, \w+: sample \d+ is .*, now .*: apart by ", printed)
