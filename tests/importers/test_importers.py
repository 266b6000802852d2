"""The FMU does what the exact solution says in every importer that can be had."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from functools import cache
from pathlib import Path

import pytest

from stickslip_fmu.packer import build
from tests.importers.cases import CASES
from tests.importers.judging import EXACT, deviations, nested_deviations
from tests.importers.running import (
    CONTAINERS,
    IMPORTERS,
    ImporterError,
    Rows,
    ask,
    run,
    run_pair,
)
from tests.needs import each, needs

KEPT = 1e-12
"""The block itself is within 1e-13, whatever the steps; a few roundings of times come on top."""

KEPT_BY_ECOS = 1e-11
"""Ecos adds its steps up: after 1000 of 0.01 s its clock is 2e-13 s off, and at the largest
acceleration, 20 peak velocities per second, the mass is then 4e-12 of its speed off."""

OF_ECOS = ("ecospy", "proxyfmu")

Ran = Callable[[str, str], Rows]


def assert_exact(importer: str, found: Mapping[str, float]) -> None:
    """Fail if an output is too far from the exact solution; far below the 1e-9 to be kept."""
    assert max(found.values()) <= (KEPT_BY_ECOS if importer in OF_ECOS else KEPT), found
    assert all(found[name] == 0.0 for name in EXACT)


@pytest.fixture(scope="module")
def ran(fmu_path: Path, tmp_path_factory: pytest.TempPathFactory) -> Ran:
    """Give what runs a case in an importer, each pair once."""

    @cache
    def fmu(law: str) -> Path:
        return fmu_path if law == "coulomb" else build(tmp_path_factory.mktemp(law), law=law)

    @cache
    def once(importer: str, case: str) -> Rows:
        return run(importer, fmu(CASES[case].law), case, tmp_path_factory.mktemp(importer))

    return once


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("importer", each(IMPORTERS))
def test_every_output_is_exact_at_the_importers_own_times(
    ran: Ran, importer: str, case: str
) -> None:
    """All 22 outputs keep to the exact solution; mode, sticking and n_slips are the same."""
    rows = ran(importer, case)
    assert len(rows.times) in (CASES[case].steps, CASES[case].steps + 1)
    found = deviations(CASES[case], rows)
    assert len(found) == 22
    assert_exact(importer, found)


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("importer", each(CONTAINERS))
def test_a_second_block_in_a_container_is_exact_too(ran: Ran, importer: str, case: str) -> None:
    """A block that the first one's spring force pushes moves as that force makes it move."""
    rows = ran(importer, case)
    assert_exact(importer, nested_deviations(CASES[case], rows))
    assert rows.nested is not None
    assert rows.nested.outputs["x"] != rows.outputs["x"]


@pytest.mark.parametrize("importer", each(["libcosimpy", "ecospy", "proxyfmu"]))
def test_two_blocks_in_one_simulation_are_exact(
    fmu_path: Path, tmp_path: Path, importer: str
) -> None:
    """Connected, and stepped at the same time where the importer uses threads, both are exact."""
    rows = run_pair(importer, fmu_path, "inputs", tmp_path)
    assert_exact(importer, deviations(CASES["inputs"], rows))
    assert_exact(importer, nested_deviations(CASES["inputs"], rows))


@needs("fmucontainer")
def test_threads_of_a_container_change_nothing(ran: Ran, fmu_path: Path, tmp_path: Path) -> None:
    """Two blocks that are stepped at once, each in its thread, give the same bits."""
    threaded = run_pair("fmucontainer", fmu_path, "inputs", tmp_path, how="in_threads")
    assert threaded == ran("fmucontainer", "inputs")


@pytest.mark.parametrize("importer", each(IMPORTERS))
def test_a_second_run_in_one_process_repeats_the_first(ran: Ran, importer: str) -> None:
    """Started again by the importer's own means, in mid-slip, the run is the same bit for bit."""
    rows = ran(importer, "restart")
    assert rows.outputs["mode"][-1] == 1
    assert rows.again is not None
    assert rows.how
    assert rows.again == replace(rows, again=None, how="")


@pytest.mark.parametrize("importer", each(["fmpy", "libcosimpy", "ecospy"]))
def test_an_importer_finds_nothing_to_warn_of(
    fmu_path: Path, tmp_path: Path, importer: str
) -> None:
    """Loading the FMU, two runs and the end of the process leave no warning and no error."""
    said = ask(f"by_{importer}", "run", fmu_path, tmp_path, None, asdict(CASES["restart"]))
    assert not re.findall(r".*(?:warn|error|fail|invalid).*", said.out + said.err, re.IGNORECASE)


@pytest.mark.parametrize("importer", each(IMPORTERS))
def test_importers_kinds_of_numbers_are_kept(ran: Ran, importer: str) -> None:
    """Booleans come as bool, Integers as int and Reals as float."""
    outputs = ran(importer, "inputs").outputs
    assert {type(value) for value in outputs["sticking"]} == {bool}
    assert {type(value) for value in outputs["mode"] + outputs["n_slips"]} == {int}
    assert {type(value) for value in outputs["x"] + outputs["T"]} == {float}


@pytest.mark.parametrize("name", ["x", "t_slip", "F", "t_event", "W_pull", "f", "x_dot_peak"])
def test_a_wrong_sample_is_seen(ran: Ran, name: str) -> None:
    """One sample of any quantity that is off by 1e-9 of its largest value is far from exact."""
    rows = ran("fmpy", "inputs")
    samples = list(rows.outputs[name])
    worst = max(range(len(samples)), key=lambda place: abs(samples[place]))
    samples[worst] *= 1.0 + 1e-9
    spoiled = replace(rows, outputs={**rows.outputs, name: tuple(samples)})
    assert deviations(CASES["inputs"], spoiled)[name] > 10.0 * KEPT_BY_ECOS


def test_the_project_is_out_of_reach(fmu_path: Path, tmp_path: Path) -> None:
    """The importers' processes cannot import the project: the FMU runs what it carries."""
    with pytest.raises(ImporterError, match="stickslip is barred here"):
        run("nothing", fmu_path, "default", tmp_path)
