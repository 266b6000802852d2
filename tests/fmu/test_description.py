"""The FMI 2.0 model description: complete and true; what checkers say of it and of FMI 3.0's."""

import math
import random
import re
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import fmpy
import pytest

from stickslip_fmu import packer
from stickslip_fmu.spec import TABLE
from tests.needs import needs

from .blocks import make_block, outputs
from .conformity import (
    CHECKERS,
    by_fmpy,
    by_schema,
    by_toolbox,
    description_of,
    spoilt,
    starts_and_bounds,
)

Checker = Callable[[Path], list[str]]


@pytest.fixture(params=["fmu_path", "fmi3_path"])
def fmu(request: pytest.FixtureRequest) -> Path:
    """Return the FMU of either version."""
    path: Path = request.getfixturevalue(request.param)
    return path


@pytest.mark.parametrize("checker", CHECKERS)
def test_checkers_find_nothing(fmu: Path, checker: Checker) -> None:
    """The XML schema, fmpy and fmutool have nothing to say of the FMU."""
    assert checker(fmu) == []


FROZEN = ('variability="fixed"', 'variability="frozen"')
IN_INCHES = ('displayUnit="mm" nominal="0.1" start', 'displayUnit="inch" nominal="0.1" start')
SPOILT = {
    "fmu_path": [
        (by_schema, *FROZEN),
        (by_schema, "<TypeDefinitions>", "<Types/><TypeDefinitions>"),
        (by_fmpy, '<Unknown index="13" dependencies=""/>', ""),
        (by_fmpy, *IN_INCHES),
        (by_toolbox, *FROZEN),
        (by_toolbox, '<Unknown index="13" dependencies=""/>', ""),
        (by_toolbox, 'initial="exact"', 'initial="calculated"'),
        (by_toolbox, 'name="g"', 'name="m"'),
    ],
    "fmi3_path": [
        (by_schema, *FROZEN),
        (by_schema, '<Item name="Sticks" value="0"', '<Item name="Sticks"'),
        (by_fmpy, '<Output valueReference="12" dependencies=""/>', ""),
        (by_fmpy, 'causality="independent"', 'causality="local"'),
        (by_toolbox, *FROZEN),
        (by_toolbox, '<Output valueReference="12" dependencies=""/>', ""),
        (by_toolbox, 'name="g" valueReference="1"', 'name="g" valueReference="0"'),
    ],
}


@pytest.mark.parametrize(
    ("fmu", "checker", "old", "new"),
    [
        pytest.param(fmu, *row, marks=[needs("fmutool")] if row[0] is by_toolbox else [])
        for fmu, rows in SPOILT.items()
        for row in rows
    ],
    indirect=["fmu"],
)
def test_checkers_find_a_spoilt_description(
    fmu: Path, tmp_path: Path, checker: Checker, old: str, new: str
) -> None:
    """Each checker, which is content with the FMU, finds the fault of one spoilt in one place."""
    assert checker(spoilt(fmu, tmp_path, old, new))


def test_description_is_the_table(fmu_path: Path) -> None:
    """Every row of the table stands in the model description, and nothing else."""
    description = fmpy.read_model_description(str(fmu_path))
    assert [each.name for each in description.modelVariables] == [each.name for each in TABLE.rows]
    for found, row in zip(description.modelVariables, TABLE.rows, strict=True):
        assert (found.type, found.causality, found.variability) == (
            row.kind,
            row.causality,
            row.variability,
        )
        assert (found.unit or "") == row.unit
        assert found.description == row.description
        assert (found.start, found.min, found.max) == starts_and_bounds(row)
    assert all(unknown.dependencies == [] for unknown in description.outputs)
    initial = {each.variable.name: each.dependencies for each in description.initialUnknowns}
    assert {each.name for each in initial["x_pull"]} == {"x_start", "z_start"}


def test_every_variable_has_a_type_that_it_does_not_contradict(fmu_path: Path) -> None:
    """What a variable repeats of its declared type is what the type says."""
    description = fmpy.read_model_description(str(fmu_path))
    assert [each.name for each in description.typeDefinitions] == list(TABLE.quantities)
    for found in description.modelVariables:
        declared = found.declaredType
        assert declared is not None
        for attribute in ("quantity", "unit", "displayUnit", "nominal"):
            assert getattr(found, attribute) == getattr(declared, attribute), found.name
        assert (found.type == "Real") == (declared.quantity is not None)


def test_nominal_values_are_the_orders_of_magnitude(fmu_path: Path) -> None:
    """In the default run nothing that moves is ten times larger or smaller than its nominal."""
    description = fmpy.read_model_description(str(fmu_path))
    run = fmpy.simulate_fmu(str(fmu_path), stop_time=10.0)
    compared = 0
    for found in description.modelVariables:
        if found.type == "Real":
            nominal = float(found.nominal)
            assert nominal > 0.0
            seen = run[found.name] if found.name in run.dtype.names else [float(found.start)]
            largest = max(map(abs, seen))
            if largest > 0.0:
                assert 0.1 < largest / nominal < 10.0, found.name
                compared += 1
    assert compared > 20


def test_outputs_keep_to_their_bounds() -> None:
    """Whatever is set, no output leaves the range that the description gives it."""
    generator = random.Random(11)
    for _ in range(300):
        block = make_block(
            k=10.0 ** generator.uniform(1.0, 6.0),
            c=generator.choice([0.0, 0.1, 30.0]),
            mu_s=generator.choice([0.0, 0.1, 0.5]),
            mu_k=generator.choice([0.0, 0.1, 0.3, 0.7]),
            x_dot_start=generator.choice([0.0, 0.3, -0.3]),
            z_start=generator.uniform(-0.02, 0.02),
            v=generator.uniform(-0.1, 0.1),
        )
        for _ in range(10):
            block.set("F_ext", generator.uniform(-10.0, 10.0))
            block.set("v", generator.uniform(-0.1, 0.1))
            block.advance(0.0, generator.choice([1e-9, 1e-3, 0.1]))
            found = outputs(block)
            for row in TABLE.rows:
                if row.causality == "output":
                    low = -math.inf if row.minimum is None else row.minimum
                    high = math.inf if row.maximum is None else row.maximum
                    assert low <= found[row.name] <= high, row.name


def test_the_description_claims_what_importers_ask_for(fmu_path: Path) -> None:
    """No execution tool is needed, states can be kept, and the default experiment is there."""
    description = fmpy.read_model_description(str(fmu_path))
    slave = description.coSimulation
    assert slave.needsExecutionTool is False
    assert slave.canGetAndSetFMUstate
    assert slave.canSerializeFMUstate
    assert slave.canHandleVariableCommunicationStepSize
    experiment = description.defaultExperiment
    assert (experiment.startTime, experiment.stopTime, experiment.stepSize) == (
        "0.0",
        "10.0",
        "0.01",
    )
    assert experiment.tolerance is None
    assert description.generationDateAndTime.endswith("Z")
    for each in ("author", "version", "copyright", "license", "description", "generationTool"):
        assert getattr(description, each)


def test_units_are_those_of_physics(fmu_path: Path) -> None:
    """Base units have the exponents of SI, display units their factors."""
    description = fmpy.read_model_description(str(fmu_path))
    exponents = {
        unit.name: (unit.baseUnit.kg, unit.baseUnit.m, unit.baseUnit.s)
        for unit in description.unitDefinitions
    }
    assert exponents == {
        "kg": (1, 0, 0),
        "m": (0, 1, 0),
        "s": (0, 0, 1),
        "m/s": (0, 1, -1),
        "m/s2": (0, 1, -2),
        "N": (1, 1, -2),
        "N/m": (1, 0, -2),
        "N.s/m": (1, 0, -1),
        "J": (1, 2, -2),
        "Hz": (0, 0, -1),
        "1": (0, 0, 0),
    }
    displays = {
        display.name: float(display.factor)
        for unit in description.unitDefinitions
        for display in unit.displayUnits
    }
    assert displays == {"mm": 1e3, "ms": 1e3, "mm/s": 1e3, "kN": 1e-3, "N/mm": 1e-3, "mJ": 1e3}
    shown = {each.name: each.displayUnit for each in description.modelVariables if each.displayUnit}
    assert shown["x"] == "mm"
    assert shown["v"] == "mm/s"


def test_no_unit_or_type_is_idle() -> None:
    """Every unit belongs to a type and every type to a variable."""
    assert {each.unit for each in TABLE.quantities.values() if each.unit} == set(TABLE.units)
    assert {each.type.name for each in TABLE.rows} == set(TABLE.quantities)


def test_initial_values_depend_on_what_the_description_says(fmu_path: Path) -> None:
    """Each start value moves those outputs at the start that name it, and no other.

    Where the description calls the dependence constant, the output moves by the same as the value.
    """
    description = fmpy.read_model_description(str(fmu_path))
    named = {
        each.variable.name: {dependency.name for dependency in each.dependencies}
        for each in description.initialUnknowns
    }
    constant = {
        each.variable.name: "constant" in each.dependenciesKind
        for each in description.initialUnknowns
    }
    assert {name for name, is_so in constant.items() if is_so} == {"x", "x_dot", "x_pull", "z"}
    generator = random.Random(5)
    seen: dict[str, set[str]] = {name: set() for name in named}
    shifts = {"load": 5.0, "x_start": 0.01, "x_dot_start": 0.1, "z_start": 0.01, "F_ext": 5.0}
    longer = {"tau_s": 0.1, "B": 0.1, "age_start": 0.1}
    for _ in range(600):
        base = TABLE.start_values()
        base |= {
            "z_start": generator.uniform(-0.01, 0.01),
            "x_dot_start": generator.choice([0.0, 0.0, 0.1, -0.1]),
            "F_ext": generator.uniform(-5.0, 5.0),
            "c": 1.0,
            "tau_s": generator.choice([0.0, 0.1]),
            "B": generator.choice([0.0, 0.1]),
            "age_start": generator.choice([0.0, 3.0]),
        }
        before = outputs(make_block(**base))
        for name in base:
            shift = shifts.get(name, 0.0) * generator.uniform(-1.0, 1.0)
            shift += longer.get(name, 0.0) * generator.random()
            other = {**base, name: base[name] * generator.uniform(0.2, 3.0) + shift}
            after = outputs(make_block(**other))
            for output in named:
                if after[output] != before[output]:
                    seen[output].add(name)
                    if constant[output]:
                        # Sums and differences of numbers below 1 are rounded by less than 2^-53.
                        moved = (after[output] - before[output]) - (other[name] - base[name])
                        assert abs(moved) < 4.0 * 2.0**-53
    assert seen == named


def test_the_guid_tells_the_content(
    fmu_path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It has the usual form, and is another one where one byte of the packed code is another."""
    guid = fmpy.read_model_description(str(fmu_path)).guid
    assert re.fullmatch(r"\{[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}\}", guid)
    shutil.copytree(Path(packer.__file__).parent, tmp_path / "stickslip_fmu")
    with (tmp_path / "stickslip_fmu" / "meter.py").open("a") as source:
        source.write("\n")
    # The packer looks for what travels where Python does.
    monkeypatch.syspath_prepend(tmp_path)
    for name in [name for name in sys.modules if name.partition(".")[0] == "stickslip_fmu"]:
        monkeypatch.delitem(sys.modules, name)
    other = fmpy.read_model_description(str(packer.build(tmp_path))).guid
    assert re.fullmatch(r"\{[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}\}", other)
    assert other != guid


def test_numbers_are_written_with_all_their_digits(fmu_path: Path) -> None:
    """Every number of the description reads back as the table's, to the last bit."""
    starts = dict(
        re.findall(
            r'ScalarVariable name="(\w+)"[^>]*>\s*<\w+[^>]* start="([^"]*)"',
            description_of(fmu_path).decode(),
        )
    )
    for name, value in TABLE.start_values().items():
        assert float(starts[name]) == value
