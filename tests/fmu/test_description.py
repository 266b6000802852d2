"""The model descriptions of the Python FMUs: complete, true, and the same in both FMI versions."""

import math
import random
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import fmpy
import pytest

from stickslip_fmu.spec import TABLE
from tests.conftest import KINDS, built, kinds
from tests.fmu.blocks import make_block, outputs
from tests.fmu.conformity import CHECKERS
from tests.makers.vocabularies import BASES
from tests.needs import needs

Checker = Callable[[Path], list[str]]


@cache
def described(kind: str) -> Any:
    return fmpy.read_model_description(str(built(kind)))


@pytest.fixture(params=kinds())
def description(request: pytest.FixtureRequest) -> Any:
    return described(request.param)


@pytest.fixture
def old() -> Any:
    return described("python-2")


@pytest.fixture
def new() -> Any:
    return described("native-3")


@pytest.mark.parametrize("checker", CHECKERS)
@pytest.mark.parametrize("kind", kinds(*KINDS, "native-2me"))
def test_checkers_find_nothing(kind: str, checker: Checker) -> None:
    assert checker(built(kind)) == []


def test_a_description_is_the_table(description: Any) -> None:
    variables = list(description.modelVariables)
    if description.fmiVersion == "3.0":
        time, *beside = variables[len(TABLE.rows) :]
        del variables[len(TABLE.rows) :]
        assert {each.causality for each in beside} == {"local"}
        assert (time.name, time.causality, time.unit) == ("time", "independent", "s")
    types = {"Float64": "Real", "Int32": "Integer", "Enumeration": "Integer"}
    for found, row in zip(variables, TABLE.rows, strict=True):
        assert found.name == row.name
        assert types.get(found.type, found.type) == row.kind
        assert (found.causality, found.variability) == (row.causality, row.variability)
        assert (found.unit or "", found.description) == (row.unit, row.description)
        values = (row.start, row.minimum, row.maximum)
        # Written so that they read back to the last bit.
        expected = tuple(None if value is None else repr(value) for value in values)
        assert (found.start, found.min, found.max) == expected
        declared = found.declaredType
        assert declared.name == row.type.name
        for attribute in ("quantity", "unit", "displayUnit", "nominal"):
            assert getattr(found, attribute) == getattr(declared, attribute), found.name
        if row.kind == "Real":
            assert float(found.nominal) == row.type.nominal
    assert [each.name for each in description.typeDefinitions] == list(TABLE.quantities)


def test_a_description_claims_what_importers_ask_for_and_no_more(description: Any) -> None:
    slave, experiment = description.coSimulation, description.defaultExperiment
    assert description.modelName == slave.modelIdentifier == "StickSlip"
    assert slave.needsExecutionTool is False
    assert slave.canGetAndSetFMUstate
    assert slave.canSerializeFMUstate
    assert slave.canHandleVariableCommunicationStepSize
    times = (experiment.startTime, experiment.stopTime, experiment.stepSize)
    assert (*times, experiment.tolerance) == ("0.0", "10.0", "0.01", None)
    assert description.generationDateAndTime.endswith("Z")
    for name in ("author", "version", "copyright", "license", "description", "generationTool"):
        assert getattr(description, name)
    events = description.fmiVersion == "3.0"
    assert (description.modelExchange is not None) == events
    assert getattr(slave, "hasEventMode", False) == events
    assert getattr(slave, "mightReturnEarlyFromDoStep", False) == events
    assert getattr(slave, "providesIntermediateUpdate", False) == events
    native = description.generationTool.startswith("stickslip")
    assert bool(slave.canInterpolateInputs) == (native and not events)


@needs("cc")
def test_both_fmi_versions_tell_the_same(old: Any, new: Any) -> None:
    def told(description: Any) -> list[Any]:
        texts = ("description", "author", "version", "license", "generationDateAndTime")
        unknowns = [u for u in description.initialUnknowns if u.variable.name in TABLE.by_name]
        units = [(unit, unit.baseUnit) for unit in description.unitDefinitions if unit.name != "W"]
        return [
            *(getattr(description, name) for name in texts),
            *(output.variable.name for output in description.outputs),
            *((u.variable.name, u.dependenciesKind) for u in unknowns),
            *([on.name for on in u.dependencies] for u in unknowns),
            *((unit.name, base.kg, base.m, base.s, base.rad) for unit, base in units),
            *((shown.name, shown.factor) for unit, _ in units for shown in unit.displayUnits),
        ]

    assert told(new) == told(old)
    for identity in (old.guid, new.instantiationToken):
        assert re.fullmatch(r"\{[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}\}", identity)
    assert old.guid != new.instantiationToken


@needs("cc")
def test_the_mode_of_fmi_3_is_an_enumeration_of_the_values_of_fmi_2(new: Any) -> None:
    (mode,) = (each for each in new.modelVariables if each.name == "mode")
    items = [(each.name, int(each.value)) for each in mode.declaredType.items]
    assert items == [("SlipsBackward", -1), ("Sticks", 0), ("SlipsForward", 1)]


def test_units_are_those_of_physics(old: Any) -> None:
    exponents = {
        unit.name: (unit.baseUnit.kg, unit.baseUnit.m, unit.baseUnit.s)
        for unit in old.unitDefinitions
    }
    assert exponents == {
        name: tuple(base.get(unit, 0) for unit in ("kg", "m", "s"))
        for name, base in BASES.items()
        if name != "K"
    }
    displays = {
        display.name: float(display.factor)
        for unit in old.unitDefinitions
        for display in unit.displayUnits
    }
    assert displays == {"mm": 1e3, "ms": 1e3, "mm/s": 1e3, "kN": 1e-3, "N/mm": 1e-3, "mJ": 1e3}
    shown = {each.name: each.displayUnit for each in old.modelVariables if each.displayUnit}
    assert (shown["x"], shown["v"]) == ("mm", "mm/s")


def test_nominal_values_are_the_orders_of_magnitude_of_the_default_run(old: Any) -> None:
    run = fmpy.simulate_fmu(str(built("python-2")), stop_time=10.0)
    compared = 0
    for found in old.modelVariables:
        if found.type == "Real":
            seen = run[found.name] if found.name in run.dtype.names else [float(found.start)]
            largest = max(map(abs, seen))
            if largest > 0.0:
                assert 0.1 < largest / float(found.nominal) < 10.0, found.name
                compared += 1
    assert compared > 20


def test_no_output_leaves_the_bounds_of_its_row() -> None:
    chance = random.Random(11)
    bounded = [row for row in TABLE.rows if row.causality == "output"]
    for _ in range(100):
        block = make_block(
            k=10.0 ** chance.uniform(1.0, 6.0),
            c=chance.choice([0.0, 0.1, 30.0]),
            mu_s=chance.choice([0.0, 0.1, 0.5]),
            mu_k=chance.choice([0.0, 0.1, 0.3, 0.7]),
            x_dot_start=chance.choice([0.0, 0.3, -0.3]),
            z_start=chance.uniform(-0.02, 0.02),
            v=chance.uniform(-0.1, 0.1),
        )
        for _ in range(10):
            block.set("F_ext", chance.uniform(-10.0, 10.0))
            block.set("v", chance.uniform(-0.1, 0.1))
            block.advance(0.0, chance.choice([1e-9, 1e-3, 0.1]))
            found = outputs(block)
            for row in bounded:
                low = -math.inf if row.minimum is None else row.minimum
                high = math.inf if row.maximum is None else row.maximum
                assert low <= found[row.name] <= high, row.name


def test_outputs_at_the_start_depend_on_what_the_description_says(old: Any) -> None:
    assert all(unknown.dependencies == [] for unknown in old.outputs)
    named = {u.variable.name: {d.name for d in u.dependencies} for u in old.initialUnknowns}
    constant = {u.variable.name for u in old.initialUnknowns if "constant" in u.dependenciesKind}
    assert constant == {"x", "x_dot", "x_pull", "z"}
    chance = random.Random(5)
    seen: dict[str, set[str]] = {name: set() for name in named}
    shifts = {"load": 5.0, "x_start": 0.01, "x_dot_start": 0.1, "z_start": 0.01, "F_ext": 5.0}
    longer = {"tau_s": 0.1, "B": 0.1, "age_start": 0.1}
    for _ in range(200):
        base = TABLE.start_values() | {
            "z_start": chance.uniform(-0.01, 0.01),
            "x_dot_start": chance.choice([0.0, 0.0, 0.1, -0.1]),
            "F_ext": chance.uniform(-5.0, 5.0),
            "c": 1.0,
            "tau_s": chance.choice([0.0, 0.1]),
            "B": chance.choice([0.0, 0.1]),
            "age_start": chance.choice([0.0, 3.0]),
        }
        before = outputs(make_block(**base))
        for name in base:
            shift = shifts.get(name, 0.0) * chance.uniform(-1.0, 1.0)
            shift += longer.get(name, 0.0) * chance.random()
            other = {**base, name: base[name] * chance.uniform(0.2, 3.0) + shift}
            after = outputs(make_block(**other))
            for output in named:
                if after[output] != before[output]:
                    seen[output].add(name)
                    # Sums and differences of numbers below 1 are rounded by less than 2^-53.
                    moved = (after[output] - before[output]) - (other[name] - base[name])
                    assert output not in constant or abs(moved) < 4.0 * 2.0**-53
    assert seen == named
