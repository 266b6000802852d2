"""What docs/importing.md says of a host written in C is what works."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.needs import needs

from .host_c import ROOT

DOCUMENT = ROOT / "docs" / "importing.md"
HEADING = "## A host written in C"

pytestmark = needs("cc", "libpython")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Run the lines of the section, as they stand there, in a folder with the examples."""
    folder = tmp_path_factory.mktemp("lines")
    (folder / "examples").symlink_to(ROOT / "examples")
    section = DOCUMENT.read_text(encoding="utf-8").split(f"\n{HEADING}\n")[1].split("\n## ")[0]
    lines = "".join(re.findall(r"^```sh\n(.*?)^```$", section, re.MULTILINE | re.DOTALL))
    assert "stickslip host -- " in lines
    done = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", lines],
        cwd=folder,
        env={**os.environ, "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    (folder / "shown.txt").write_text(done.stdout, encoding="utf-8")
    return folder


def test_the_lines_run_the_default_experiment(folder: Path) -> None:
    """Compiled and started as documented, the host writes a row for each of the 1,001 times."""
    head, *rows = (folder / "run.csv").read_text(encoding="utf-8").splitlines()
    assert head.startswith("time,x,")
    assert len(rows) == 1001
    assert (folder / "by-hand.csv").read_bytes() == (folder / "run.csv").read_bytes()
    assert "LD_PRELOAD=/" in (folder / "shown.txt").read_text(encoding="utf-8")


def test_the_script_repeats_after_the_rollback(folder: Path) -> None:
    """The two rows of the documented script are the same, and not those of a mass at rest."""
    first, second = (folder / "rollback.csv").read_text(encoding="utf-8").splitlines()
    assert first == second
    assert float(first.split(",")[0]) > 0.0
