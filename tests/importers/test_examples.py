"""The lines of docs/importing.md are the examples, and do what the document says they do."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from stickslip_verification.truth import Step
from stickslip_verification.truth import run as exact_run
from tests.importers.cases import CASES
from tests.importers.judging import deviations
from tests.importers.running import IMPORTERS, NOT_PYTHON, Rows, ask
from tests.needs import NEEDS, needs

ROOT = Path(__file__).parents[2]
DOCUMENT = (ROOT / "docs" / "importing.md").read_text(encoding="utf-8")
EXAMPLES = ROOT / "examples" / "importing"
SCRIPTS = {file.name: file.stem.removeprefix("with_") for file in EXAMPLES.glob("with_*.py")}
"""The examples by file, and the importer of each."""
SHOWN = re.findall(r"^```python\n(.*?)^```$", DOCUMENT, re.MULTILINE | re.DOTALL)
ON_THE_COMMAND_LINE = "## Ecos with the block in a process of its own"
C_HOST = "## A host written in C"


@pytest.fixture
def folder(fmu_path: Path, tmp_path: Path) -> Path:
    """Give a user's folder: the FMU and the examples."""
    shutil.copy(fmu_path, tmp_path / "StickSlip.fmu")
    for script in SCRIPTS:
        shutil.copy(EXAMPLES / script, tmp_path)
    return tmp_path


def shell(lines: str, folder: Path) -> str:
    """Run lines in a shell that finds the project's commands; return what they print."""
    temporary = folder / "temporary"
    temporary.mkdir(exist_ok=True)
    programs = Path(sys.executable).parent
    done = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", lines],
        cwd=folder,
        env={
            **os.environ,
            "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}",
            "TMPDIR": str(temporary),
        },
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def shell_lines(heading: str) -> str:
    """Return the shell's lines below a heading of the document."""
    section = DOCUMENT.split(f"\n{heading}\n")[1].split("\n## ")[0]
    [lines] = re.findall(r"^```sh\n(.*?)^```$", section, re.MULTILINE | re.DOTALL)
    return str(lines)


@pytest.mark.parametrize("script", sorted(SCRIPTS))
def test_the_document_shows_an_example(script: str) -> None:
    """The document has the script to the letter, and its importer is one that is tried."""
    assert SHOWN.count((EXAMPLES / script).read_text(encoding="utf-8")) == 1
    assert SCRIPTS[script] in IMPORTERS


def test_every_python_block_is_an_example() -> None:
    """The document shows no Python beside the scripts of examples/importing."""
    assert len(SHOWN) == len(SCRIPTS)


def test_no_line_of_the_document_is_left_untried() -> None:
    """There are blocks of Python, which are the examples, and of shell lines, which are run."""
    for section in DOCUMENT.split("\n## ")[1:]:
        heading = "## " + section.splitlines()[0]
        kinds = re.findall(r"^```(\w+)$", section, re.MULTILINE)
        # The C host has tests of its own; the text elsewhere is the message of the block.
        assert "c" not in kinds or heading == C_HOST
        assert set(kinds) <= {"python", "sh", "text", "c"}
        assert "sh" not in kinds or heading in {"## FMPy", ON_THE_COMMAND_LINE, C_HOST}
        assert "text" not in kinds or heading in {"## When the block refuses a value", C_HOST}


def test_the_result_in_the_document_is_exact() -> None:
    """The line that the examples are said to end with is the exact solution, rounded."""
    steps = [Step(0.01, {"v": 0.05} if number == 500 else {}) for number in range(1000)]
    end = exact_run({"c": 2.0}, steps, digits=30).samples[-1]
    line = f"x = {float(end['x']):.9f} m, T = {float(end['T']):.9f} s, {end['n_slips']} slips"
    assert f"`{line}`" in DOCUMENT


@pytest.mark.parametrize(
    "script",
    [
        pytest.param(script, marks=needs(importer)) if importer in NEEDS else script
        for script, importer in sorted(SCRIPTS.items())
        if importer not in NOT_PYTHON
    ],
)
def test_an_example_ends_with_the_result_in_the_document(script: str, folder: Path) -> None:
    """Started in a folder with the FMU, where the project is out of reach, it prints that line."""
    commands = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    fmu = folder / "StickSlip.fmu"
    printed = ask("script", "run", fmu, folder, {"PATH": commands}, script).out.splitlines()[-1]
    assert f"`{printed}`" in DOCUMENT


def test_the_lines_for_fmpy_write_an_exact_table(folder: Path) -> None:
    """From the command line FMPy writes every output with all its digits."""
    shell(shell_lines("## FMPy"), folder)
    head, *rows = (folder / "result.csv").read_text(encoding="utf-8").splitlines()
    columns = list(zip(*(map(_value, row.split(",")) for row in rows), strict=True))
    table = dict(zip(head.replace('"', "").split(","), columns, strict=True))
    times = table.pop("time")
    assert len(times) == 1001
    assert max(deviations(CASES["default"], Rows(times, table)).values()) < 1e-9


def _value(text: str) -> float:
    return float(text == "True") if text in ("True", "False") else float(text)


@pytest.fixture(scope="module")
def folder_of_ecos(fmu_path: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give a user's folder with a copy of ecospy as its wheel is, without run bits."""
    import ecospy

    folder = tmp_path_factory.mktemp("ecos")
    copied = folder / "packages" / "ecospy"
    shutil.copytree(Path(ecospy.__file__).parent, copied)
    for program in (copied / "binaries").iterdir():
        program.chmod(0o644)
    shutil.copy(fmu_path, folder / "StickSlip.fmu")
    shutil.copy(EXAMPLES / "with_proxyfmu.py", folder)
    return folder


@pytest.fixture(scope="module")
def without_the_run_bit(folder_of_ecos: Path) -> str:
    """Return what the example says where proxyfmu may not run."""
    lines = "export PYTHONPATH=packages\nstickslip host -- python with_proxyfmu.py 2>&1 || true"
    return shell(lines, folder_of_ecos)


@pytest.fixture(scope="module")
def on_the_command_line(folder_of_ecos: Path, without_the_run_bit: str) -> str:
    """Return what the shell's lines for Ecos print, the first of which set the run bits."""
    lines = shell_lines(ON_THE_COMMAND_LINE)
    assert "chmod +x" in lines
    return shell(f"export PYTHONPATH=packages\n{lines}", folder_of_ecos)


@needs("proxyfmu")
def test_ecos_says_that_proxyfmu_cannot_run(without_the_run_bit: str) -> None:
    """Without the run bit Ecos ends with the message that the document explains."""
    [message] = re.findall(r"Unable to create/bind proxyfmu process!", without_the_run_bit)[:1]
    assert f"`{message}`" in DOCUMENT


@needs("proxyfmu")
def test_the_lines_for_ecos_run_the_block_in_its_own_process(on_the_command_line: str) -> None:
    """With the run bit set and libpython preloaded the example ends with the same result."""
    results = [line for line in on_the_command_line.splitlines() if line.startswith("x = ")]
    assert [f"`{line}`" in DOCUMENT for line in results] == [True]


@needs("proxyfmu")
def test_the_table_that_ecos_writes_is_exact_to_six_decimals(
    on_the_command_line: str, folder_of_ecos: Path
) -> None:
    """Each sample is the exact one, rounded as Ecos writes it."""
    head, *rows = (folder_of_ecos / "StickSlip.csv").read_text(encoding="utf-8").splitlines()
    names = [column.split("::")[-1].split("[")[0] for column in head.split(", ")]
    samples = [dict(zip(names, map(float, row.split(", ")), strict=True)) for row in rows]
    exact = exact_run({}, [Step(0.01)] * 1000, digits=30)
    assert len(samples) in (1000, 1001)
    for sample, end in zip(samples, [exact.initial, *exact.samples], strict=False):
        for name in exact.initial:
            # Half a unit of the last of six decimals.
            assert abs(sample[name] - float(end[name])) <= 0.5e-6 + 1e-9, (name, sample["time"])
