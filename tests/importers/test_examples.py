"""The lines of docs/importing.md are the examples, and do what the document says they do."""

import csv
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from stickslip_verification.truth import Step
from stickslip_verification.truth import run as exact_run
from tests.conftest import built
from tests.contributing import walk
from tests.importers.cases import CASES
from tests.importers.judging import deviations
from tests.importers.running import IMPORTERS, NOT_PYTHON, Rows
from tests.needs import LIBPYTHON, each, needs

ROOT = Path(__file__).parents[2]
DOCUMENT = (ROOT / "docs" / "importing.md").read_text(encoding="utf-8")
EXAMPLES = ROOT / "examples" / "importing"
SCRIPTS = {file.stem.removeprefix("with_"): file for file in sorted(EXAMPLES.glob("with_*.py"))}
"""The examples by their importers."""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    shutil.copy(built("python-2"), tmp_path / "StickSlip.fmu")
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    return tmp_path


def shell_lines(heading: str) -> str:
    section = DOCUMENT.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    return "".join(re.findall(r"^```sh\n(.*?)^```$", section, re.MULTILINE | re.DOTALL))


def assert_result(printed: str) -> None:
    [result] = re.findall("^x = .*", printed, re.MULTILINE)
    assert f"`{result}`" in DOCUMENT


def test_the_document_shows_the_examples_to_the_letter_and_no_other_python() -> None:
    shown = re.findall(r"^```python\n(.*?)^```$", DOCUMENT, re.MULTILINE | re.DOTALL)
    names = ("fmpy", "libcosimpy", "ecospy")
    assert shown == [SCRIPTS[name].read_text(encoding="utf-8") for name in names]
    assert set(SCRIPTS) <= set(IMPORTERS)


def test_the_result_in_the_document_is_exact() -> None:
    steps = [Step(0.01, {"v": 0.05} if number == 500 else {}) for number in range(1000)]
    end = exact_run({"c": 2.0}, steps, digits=30).samples[-1]
    x, T, n_slips = (float(end[name]) for name in ("x", "T", "n_slips"))
    assert_result(f"x = {x:.9f} m, T = {T:.9f} s, {n_slips:.0f} slips")


@pytest.mark.parametrize("importer", each(name for name in SCRIPTS if name not in NOT_PYTHON))
def test_an_example_ends_with_the_result_in_the_document(importer: str, folder: Path) -> None:
    assert_result(walk(f"python {SCRIPTS[importer]}", folder))


def columns(file: Path) -> dict[str, list[float]]:
    with file.open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream, skipinitialspace=True))
    return {
        re.sub(r".*::|\[.*", "", name): [
            float({"True": 1, "False": 0}.get(row[name], row[name])) for row in rows
        ]
        for name in rows[0]
    }


@pytest.mark.gate
def test_the_lines_for_fmpy_write_an_exact_table(folder: Path) -> None:
    walk(shell_lines("FMPy"), folder)
    table = columns(folder / "result.csv")
    rows: Rows = {"times": table.pop("time"), "outputs": table}
    # The block, whose table has all digits.
    assert max(deviations(CASES["default"], rows).values()) < 1e-12


@pytest.mark.gate
def test_the_lines_for_a_system_build_it_and_run_it(folder: Path) -> None:
    walk(shell_lines("A system ready to run: SSP"), folder)
    table = columns(folder / "run.csv")
    assert len(table["time"]) == 1000
    assert table["block.T"][-1] == pytest.approx(0.31526808705)


@needs("proxyfmu")
def test_ecos_runs_the_block_in_its_own_process_where_it_may(folder: Path) -> None:
    import ecospy

    # A copy of ecospy as its wheel is, without permissions to execute.
    copied = folder / "packages" / "ecospy"
    shutil.copytree(Path(ecospy.__file__).parent, copied)
    for program in (copied / "binaries").iterdir():
        program.chmod(0o644)
    shutil.copy(SCRIPTS["proxyfmu"], folder)
    path = "export PYTHONPATH=packages\n"
    before = walk(f"{path}LD_PRELOAD={LIBPYTHON} python with_proxyfmu.py 2>&1 || true", folder)
    [symptom] = re.findall("^.*`(Unable to create/bind .*?)`", DOCUMENT, re.MULTILINE)
    assert symptom in before

    assert_result(walk(path + shell_lines("Ecos with the block in a process of its own"), folder))
    # The default experiment, with six decimals: half a unit of the last one.
    exact = exact_run({}, [Step(0.01)] * 1000, digits=30)
    shown = columns(folder / "StickSlip.csv")["x"][:1000]
    expected = [float(sample["x"]) for sample in (exact.initial, *exact.samples)][:1000]
    assert shown == pytest.approx(expected, rel=0.0, abs=0.5e-6 + 1e-9)


@needs("cc", "libpython")
def test_the_lines_for_a_host_in_c_compile_it_and_run_it(folder: Path) -> None:
    # An FMU without its evidence is made sooner.
    lines = shell_lines("A host written in C").replace("stickslip build", "stickslip build --bare")
    walk(lines, folder)
    table = columns(folder / "run.csv")
    assert (len(table["x"]), table["time"][-1], table["n_slips"][-1]) == (1001, 10.0, 31.0)
    first, second = np.loadtxt(folder / "rollback.csv", delimiter=",")
    assert first.tolist() == second.tolist()
    assert first[0] > 0.0
