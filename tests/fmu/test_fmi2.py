"""The built FMU in a fresh process that cannot import the project."""

import json
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.python import python

IMPORTER = Path(__file__).with_name("importer.py")


def imported(fmu: Path, task: str) -> tuple[Any, str]:
    """Run a task of `importer` and return its result and what it wrote to standard error."""
    done = python("-I", IMPORTER, fmu, task)
    return json.loads(done.stdout.splitlines()[-1]), done.stderr


def test_fmpy_runs_it_and_the_step_does_not_matter(fmu_path: Path) -> None:
    """The default run gives the same at 1,000 steps and at one."""
    (often, once), _ = imported(fmu_path, "default_run")
    assert often["n_slips"] == once["n_slips"] == 31
    for name in ("x", "z", "t_slip", "t_stick", "T", "Q_friction", "W_pull"):
        assert often[name] == pytest.approx(once[name], rel=1e-13)
    assert often["T"] == pytest.approx(0.31526808704944753, rel=4e-15)


def test_it_survives_every_failure(fmu_path: Path) -> None:
    """Two thousand failures, with resets between, leave a process that goes on."""
    seen, errors = imported(fmu_path, "failures")
    assert seen == 200 * 10
    assert "internal error" not in errors


@pytest.mark.parametrize(
    "line",
    [
        "k = -1.0 N/m is out of range: it must be finite and above 0",
        "v = nan m/s is out of range: it must be a finite number",
        "load = -10.0 N is out of range: it must be at least -m g = -9.81 N",
        "m is fixed: it cannot change after initialization",
        "x is an output: it cannot be set",
        "doStep is not allowed here: the instance is in phase instantiated",
        "exitInitializationMode is not allowed here",
        "there is no variable with value reference 4000000",
        "mode is of type Integer, not Real",
        "start time = nan s is out of range: a finite number",
        "k cannot be set: the simulation is terminated",
    ],
)
def test_a_failure_says_why_once(fmu_path: Path, line: str) -> None:
    """The reason stands on standard error, with name, value and range, once a failure."""
    _, errors = imported(fmu_path, "messages")
    assert errors.count(line) == 1


def test_clamp_warns_with_both_names(fmu_path: Path) -> None:
    """mu_k above mu_s is clamped, seen in mu_k_used and said once."""
    (used,), errors = imported(fmu_path, "clamp")
    assert used == 0.3 - 0.01
    assert errors.count("mu_k = 0.5 is above mu_s = 0.3") == 1


def test_outputs_follow_in_initialization_and_wait_afterwards(fmu_path: Path) -> None:
    """What is set shows at once before the start, and after the next step from then on."""
    found, _ = imported(fmu_path, "initialization")
    assert found["at_once"] == [[1.0, 4.905, 5.0, 0], [6.0, 4.905, 5.0, 1]]
    assert found["waiting"] == [2000.0, 6.0]
    assert found["after"][0] == pytest.approx(12.0, rel=1e-6)
    assert found["after"][1] == 5.0


def test_it_survives_without_standard_error(fmu_path: Path) -> None:
    """Where standard error cannot be written, failures stay failures and warnings harmless."""
    alive, _ = imported(fmu_path, "silent")
    assert alive == "alive"


def test_start_values_may_be_written_back(fmu_path: Path) -> None:
    """An importer that sets every start value it has read changes nothing."""
    (period,), _ = imported(fmu_path, "written_back")
    assert period == pytest.approx(0.31526808704944753, rel=4e-15)


def test_only_a_clamp_that_acts_is_warned_of(fmu_path: Path) -> None:
    """Values on their way to others warn of nothing, a clamp that acts warns once."""
    (used,), errors = imported(fmu_path, "passing_clamp")
    assert used == 0.2 - 0.01
    assert errors.count("clamped") == 1


def test_the_standard_library_is_enough(fmu_path: Path) -> None:
    """An instance loads nothing but its own package, pythonfmu and the standard library."""
    loaded, _ = imported(fmu_path, "modules")
    roots = {name.split(".")[0] for name in loaded}
    own = {name for name in roots if name.startswith("stickslip_fmu_")}
    assert len(own) == 2
    assert roots - own - {"pythonfmu"} <= set(sys.stdlib_module_names)
