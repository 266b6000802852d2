"""The FMU does what the exact solution says in every importer that can be had."""

import re
from collections.abc import Iterable
from dataclasses import asdict, replace
from functools import cache

import pytest
from _pytest.mark import ParameterSet

from tests.conftest import built
from tests.importers.cases import CASES
from tests.importers.judging import EXACT, deviations, nested_deviations
from tests.importers.running import CONTAINERS, IMPORTERS, PAIRING, Rows, ask, rows_of, run
from tests.needs import NEEDS, needs

# The block itself is within 1e-13, whatever the steps; a few roundings of times come on top. Ecos
# adds its steps up: after 1000 of 0.01 s its clock is 2e-13 s off, and at the largest acceleration,
# 20 peak velocities per second, the mass is then 4e-12 of its speed off.
TOLERANCE = dict.fromkeys(IMPORTERS, 1e-12) | dict.fromkeys(("ecospy", "proxyfmu"), 1e-11)


def among(importers: Iterable[str]) -> list[ParameterSet]:
    """Return importers as values of a parameter: one of them is for `make test`."""
    return [
        pytest.param(name, marks=[pytest.mark.gate, *([needs(name)] if name in NEEDS else [])])
        if name != "fmpy"
        else pytest.param(name)
        for name in importers
    ]


@cache
def ran(importer: str, case: str) -> tuple[Rows, str]:
    how = "pair" if case == "inputs" and importer in PAIRING else "run"
    answer, said = ask(importer, how, built("python-2"), asdict(CASES[case]))
    return rows_of(answer), said


def assert_exact(importer: str, found: dict[str, float]) -> None:
    assert max(found.values()) <= TOLERANCE[importer], found
    assert all(found[name] == 0.0 for name in EXACT)


@pytest.mark.parametrize("case", ["default", "inputs"])
@pytest.mark.parametrize("importer", among(IMPORTERS))
def test_every_output_is_exact_at_the_importers_own_times(importer: str, case: str) -> None:
    rows, _ = ran(importer, case)
    assert_exact(importer, deviations(CASES[case], rows))


@pytest.mark.parametrize("importer", among([*CONTAINERS, *PAIRING]))
def test_a_second_block_that_the_spring_of_the_first_pushes_is_exact_too(importer: str) -> None:
    rows, _ = ran(importer, "inputs")
    assert_exact(importer, nested_deviations(CASES["inputs"], rows))


@pytest.mark.gate
@needs("fmucontainer")
def test_threads_of_a_container_change_nothing() -> None:
    threaded = run("fmucontainer", built("python-2"), "inputs", "in_threads")
    assert threaded == ran("fmucontainer", "inputs")[0]


@pytest.mark.parametrize("importer", among(IMPORTERS))
def test_a_second_run_in_one_process_repeats_the_first_bit_for_bit(importer: str) -> None:
    rows, _ = ran(importer, "restart")
    longer, _ = ran(importer, "inputs")
    # It ends in mid-slip, with every input away from its start.
    assert rows.outputs["mode"][-1] == 1
    assert rows.again == replace(rows, again=None)
    assert all(longer.outputs[name][: len(rows.times)] == rows.outputs[name] for name in EXACT)
    assert longer.outputs["x"][: len(rows.times)] == rows.outputs["x"]


@pytest.mark.parametrize("importer", among(["fmpy", "libcosimpy", "ecospy"]))
def test_an_importer_finds_nothing_to_warn_of(importer: str) -> None:
    _, said = ran(importer, "restart")
    assert not re.findall(r".*(?:warn|error|fail|invalid).*", said, re.IGNORECASE)
