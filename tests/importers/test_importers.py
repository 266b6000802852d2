"""The FMU does what the exact solution says in every importer that can be had."""

import re
from collections.abc import Iterable
from dataclasses import asdict
from functools import cache

import pytest
from _pytest.mark import ParameterSet

from tests.conftest import built
from tests.importers.cases import CASES
from tests.importers.judging import EXACT, deviations
from tests.importers.running import IMPORTERS, PAIRING, Rows, ask, run
from tests.needs import NEEDS, needs


def among(importers: Iterable[str]) -> list[ParameterSet]:
    marks = {name: [needs(name)] if name in NEEDS else [pytest.mark.gate] for name in importers}
    marks |= {"fmpy": [], "fmucontainer": [pytest.mark.gate, needs("fmucontainer")]}
    return [pytest.param(name, marks=marks[name]) for name in importers]


@cache
def ran(importer: str, case: str) -> tuple[Rows, str]:
    how = "pair" if case == "inputs" and importer in PAIRING else "run"
    return ask(importer, how, built("python-2"), asdict(CASES[case]))


def assert_exact(importer: str, case: str, nested: bool = False) -> None:
    found = deviations(CASES[case], ran(importer, case)[0], nested)
    # The block itself is within 1e-13, whatever the steps; a few roundings of times come on top.
    # Ecos adds its steps up: after 1000 of 0.01 s its clock is 2e-13 s off, and at the largest
    # acceleration, 20 peak velocities per second, the mass is then 4e-12 of its speed off.
    assert max(found.values()) <= (1e-11 if importer in ("ecospy", "proxyfmu") else 1e-12), found
    assert all(found[name] == 0.0 for name in EXACT)


@pytest.mark.parametrize("case", ["default", "inputs"])
@pytest.mark.parametrize("importer", among(IMPORTERS))
def test_every_output_is_exact_at_the_importers_own_times(importer: str, case: str) -> None:
    assert_exact(importer, case)


@pytest.mark.parametrize("importer", among(PAIRING))
def test_a_second_block_that_the_spring_of_the_first_pushes_is_exact_too(importer: str) -> None:
    assert_exact(importer, "inputs", nested=True)


@pytest.mark.gate
@needs("fmucontainer")
def test_threads_of_a_container_change_nothing() -> None:
    threaded = run("fmucontainer", built("python-2"), "inputs", "in_threads")
    assert threaded == ran("fmucontainer", "inputs")[0]


@pytest.mark.parametrize("importer", among(IMPORTERS))
def test_a_second_run_in_one_process_repeats_the_first_bit_for_bit(importer: str) -> None:
    rows, said = ran(importer, "restart")
    # It ends in mid-slip, with every input away from its start.
    assert rows["outputs"]["mode"][-1] == 1
    assert {**rows["again"], "again": rows["again"]} == rows
    longer = ran(importer, "inputs")[0]["outputs"]
    for name in (*EXACT, "x"):
        assert longer[name][: len(rows["times"])] == rows["outputs"][name]
    # Nothing to warn of; fmucontainer and proxyfmu say "error" without one.
    if importer in ("fmpy", "libcosimpy", "ecospy"):
        assert not re.findall(r".*(?:warn|error|fail|invalid).*", said, re.IGNORECASE)
