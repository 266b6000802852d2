"""The FMI 3.0 model description, made from the same table, and the file that carries it."""

import re
from pathlib import Path

import fmpy

from stickslip_fmu import packer
from stickslip_fmu.spec import TABLE

from .conformity import starts_and_bounds


def test_description_is_the_table_and_the_time(fmi3_path: Path) -> None:
    """Every row of the table stands in the model description, and the independent variable."""
    description = fmpy.read_model_description(str(fmi3_path))
    *rows, time = description.modelVariables
    assert (time.name, time.causality, time.unit) == ("time", "independent", "s")
    kinds = {"Real": {"Float64"}, "Integer": {"Int32", "Enumeration"}, "Boolean": {"Boolean"}}
    for found, row in zip(rows, TABLE.rows, strict=True):
        assert found.name == row.name
        assert found.type in kinds[row.kind]
        assert (found.causality, found.variability) == (row.causality, row.variability)
        assert (found.unit or "") == row.unit
        assert found.description == row.description
        assert found.declaredType.name == row.type.name
        assert (found.start, found.min, found.max) == starts_and_bounds(row)
        if row.kind == "Real":
            assert float(found.nominal) == row.type.nominal
    assert [each.name for each in description.typeDefinitions] == list(TABLE.quantities)


def test_both_versions_tell_the_same(fmi3_path: Path, fmu_path: Path) -> None:
    """Units, dependencies, experiment and texts are those of the FMI 2.0 description."""
    new, old = (fmpy.read_model_description(str(each)) for each in (fmi3_path, fmu_path))
    for kind in ("outputs", "initialUnknowns"):
        assert [
            (each.variable.name, [on.name for on in each.dependencies], each.dependenciesKind)
            for each in getattr(new, kind)
        ] == [
            (each.variable.name, [on.name for on in each.dependencies], each.dependenciesKind)
            for each in getattr(old, kind)
        ]
    for a, b in zip(new.unitDefinitions, old.unitDefinitions, strict=True):
        assert a.name == b.name
        assert all(getattr(a.baseUnit, si) == getattr(b.baseUnit, si) for si in ("kg", "m", "s"))
        assert [(d.name, d.factor) for d in a.displayUnits] == [
            (d.name, d.factor) for d in b.displayUnits
        ]
    for number in ("startTime", "stopTime", "stepSize", "tolerance"):
        assert getattr(new.defaultExperiment, number) == getattr(old.defaultExperiment, number)
    for text in ("description", "author", "version", "copyright", "license", "modelName"):
        assert getattr(new, text) == getattr(old, text)
    assert new.generationDateAndTime == old.generationDateAndTime
    assert new.instantiationToken != old.guid


def test_the_mode_is_an_enumeration(fmi3_path: Path) -> None:
    """It has a name for each direction of slip, and the values of FMI 2.0."""
    description = fmpy.read_model_description(str(fmi3_path))
    mode = next(each for each in description.modelVariables if each.name == "mode")
    assert mode.type == "Enumeration"
    assert [(each.name, int(each.value)) for each in mode.declaredType.items] == [
        ("SlipsBackward", -1),
        ("Sticks", 0),
        ("SlipsForward", 1),
    ]


def test_the_description_claims_only_what_is_there(fmi3_path: Path) -> None:
    """States and variable steps, no event mode, no early return, no clock."""
    description = fmpy.read_model_description(str(fmi3_path))
    slave = description.coSimulation
    assert description.modelExchange is None
    assert description.scheduledExecution is None
    assert slave.modelIdentifier == "StickSlip"
    assert slave.needsExecutionTool is False
    assert slave.canGetAndSetFMUstate
    assert slave.canSerializeFMUstate
    assert slave.canHandleVariableCommunicationStepSize
    assert not slave.hasEventMode
    assert not slave.mightReturnEarlyFromDoStep
    assert not slave.providesIntermediateUpdate
    assert re.fullmatch(
        r"\{[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}\}", description.instantiationToken
    )


def test_two_builds_are_the_same_bytes(fmi3_path: Path, tmp_path: Path) -> None:
    """A second build gives the same file, under the name that tells the version."""
    again = packer.build(tmp_path / "again", {"documentation/index.html": b"<html/>"}, face=3)
    assert again.name == fmi3_path.name == "StickSlip_fmi3.fmu"
    assert again.read_bytes() != fmi3_path.read_bytes()
    assert packer.build(tmp_path, face=3).read_bytes() == fmi3_path.read_bytes()
