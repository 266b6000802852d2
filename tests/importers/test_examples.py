"""The lines of docs/importing.md are the examples, and do what the document says they do."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from stickslip_verification.truth import Step
from stickslip_verification.truth import run as exact_run
from tests.conftest import built
from tests.importers.cases import CASES
from tests.importers.judging import deviations
from tests.importers.running import IMPORTERS, NOT_PYTHON, Rows
from tests.needs import NEEDS, needs

ROOT = Path(__file__).parents[2]
DOCUMENT = (ROOT / "docs" / "importing.md").read_text(encoding="utf-8")
EXAMPLES = ROOT / "examples" / "importing"
SCRIPTS = {file.stem.removeprefix("with_"): file for file in sorted(EXAMPLES.glob("with_*.py"))}
"""The examples by their importers."""


def shell(lines: str, folder: Path) -> str:
    """Run lines in a shell that finds the project's commands; return what they print."""
    programs = Path(sys.executable).parent
    done = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", lines],
        cwd=folder,
        env={**os.environ, "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}"},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def shell_lines(heading: str) -> str:
    section = DOCUMENT.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    return "".join(re.findall(r"^```sh\n(.*?)^```$", section, re.MULTILINE | re.DOTALL))


def results(printed: str) -> list[str]:
    return [line for line in printed.splitlines() if line.startswith("x = ")]


def test_the_document_shows_the_examples_to_the_letter_and_no_other_python() -> None:
    shown = re.findall(r"^```python\n(.*?)^```$", DOCUMENT, re.MULTILINE | re.DOTALL)
    assert sorted(shown) == sorted(file.read_text(encoding="utf-8") for file in SCRIPTS.values())
    assert set(SCRIPTS) <= set(IMPORTERS)


def test_the_result_in_the_document_is_exact() -> None:
    steps = [Step(0.01, {"v": 0.05} if number == 500 else {}) for number in range(1000)]
    end = exact_run({"c": 2.0}, steps, digits=30).samples[-1]
    line = f"x = {float(end['x']):.9f} m, T = {float(end['T']):.9f} s, {end['n_slips']} slips"
    assert f"`{line}`" in DOCUMENT


@pytest.mark.parametrize(
    "importer",
    [
        pytest.param(importer, marks=needs(importer) if importer in NEEDS else ())
        for importer in SCRIPTS
        if importer not in NOT_PYTHON
    ],
)
def test_an_example_ends_with_the_result_in_the_document(importer: str, tmp_path: Path) -> None:
    shutil.copy(built("python-2"), tmp_path / "StickSlip.fmu")
    [result] = results(shell(f"python {SCRIPTS[importer]}", tmp_path))
    assert f"`{result}`" in DOCUMENT


@pytest.mark.gate
def test_the_lines_for_fmpy_write_an_exact_table(tmp_path: Path) -> None:
    shutil.copy(built("python-2"), tmp_path / "StickSlip.fmu")
    shell(shell_lines("FMPy"), tmp_path)
    head, *rows = (tmp_path / "result.csv").read_text(encoding="utf-8").splitlines()
    columns = list(zip(*(map(value_of, row.split(",")) for row in rows), strict=True))
    table = dict(zip(head.replace('"', "").split(","), columns, strict=True))
    times = table.pop("time")
    # The block, whose table has all digits.
    assert max(deviations(CASES["default"], Rows(times, table)).values()) < 1e-12


def value_of(text: str) -> float:
    return float(text == "True") if text in ("True", "False") else float(text)


@needs("proxyfmu")
def test_ecos_runs_the_block_in_its_own_process_where_it_may(tmp_path: Path) -> None:
    import ecospy

    # A copy of ecospy as its wheel is, without permissions to execute.
    copied = tmp_path / "packages" / "ecospy"
    shutil.copytree(Path(ecospy.__file__).parent, copied)
    for program in (copied / "binaries").iterdir():
        program.chmod(0o644)
    shutil.copy(built("python-2"), tmp_path / "StickSlip.fmu")
    shutil.copy(SCRIPTS["proxyfmu"], tmp_path)
    path = "export PYTHONPATH=packages\n"
    before = shell(f"{path}stickslip host -- python with_proxyfmu.py 2>&1 || true", tmp_path)
    assert "`Unable to create/bind proxyfmu process!`" in DOCUMENT
    assert "Unable to create/bind proxyfmu process!" in before

    lines = shell_lines("Ecos with the block in a process of its own")
    [result] = results(shell(f"{path}{lines}", tmp_path))
    assert f"`{result}`" in DOCUMENT

    head, *rows = (tmp_path / "StickSlip.csv").read_text(encoding="utf-8").splitlines()
    names = [column.split("::")[-1].split("[")[0] for column in head.split(", ")]
    exact = exact_run({}, [Step(0.01)] * 1000, digits=30)
    assert len(rows) in (1000, 1001)
    for row, end in zip(rows, [exact.initial, *exact.samples], strict=False):
        sample = dict(zip(names, map(float, row.split(", ")), strict=True))
        for name in exact.initial:
            # Half a unit of the last of six decimals.
            assert abs(sample[name] - float(end[name])) <= 0.5e-6 + 1e-9, (name, sample["time"])


@needs("cc", "libpython")
def test_the_lines_for_a_host_in_c_compile_it_and_run_it(tmp_path: Path) -> None:
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    lines = shell_lines("A host written in C")
    # An FMU without its evidence is made sooner.
    printed = shell(lines.replace("stickslip build", "stickslip build --bare", 1), tmp_path)
    # Of `stickslip host --show`, which by hand gives the same.
    assert "LD_PRELOAD=/" in printed
    by_launcher = (tmp_path / "run.csv").read_bytes()
    assert by_launcher == (tmp_path / "by-hand.csv").read_bytes()
    head, *rows = by_launcher.decode().splitlines()
    last = dict(zip(head.split(","), map(float, rows[-1].split(",")), strict=True))
    assert (len(rows), last["time"], last["n_slips"]) == (1001, 10.0, 31.0)
    first, second = (tmp_path / "rollback.csv").read_text(encoding="utf-8").splitlines()
    assert first == second
    assert float(first.split(",")[0]) > 0.0
