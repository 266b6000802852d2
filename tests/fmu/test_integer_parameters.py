"""Integer parameters of an FMU, in both versions of FMI: set, read, refused, saved and restored."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from stickslip_fmu.laws.named import friction_law
from stickslip_fmu.packer import build
from stickslip_fmu.spec import spec_of
from tests.python import python

PROGRAM = Path(__file__).with_name("integers.py")
SPEC = spec_of(friction_law("stribeck").law)


@pytest.fixture(scope="module", params=[2, 3])
def fmu(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return StickSlipStribeck.fmu of FMI 2.0 or 3.0."""
    return build(tmp_path_factory.mktemp("integers"), face=request.param, law="stribeck")


def test_a_whole_number_may_be_given_as_a_float() -> None:
    """The record of values keeps an int, which is what a state is compared with."""
    values = SPEC.values({**SPEC.table.start_values(), "shape": 3.0, "n_points": 2.0})
    assert [type(each) for each in (values.shape, values.n_points, values.m)] == [int, int, float]


def test_integer_parameters_are_set_read_and_kept_in_states(fmu: Path) -> None:
    """An enumeration and a count: read back, refused out of range, and restored from bytes."""
    found = json.loads(python("-I", PROGRAM, fmu).stdout.splitlines()[-1])
    assert found["start"] == [1, 2]
    assert found["set"] == [3, 4]
    # The run over the curve goes on from the bytes as it would have.
    assert found["goes on"] == found["restored"]
    assert found["restored"][2:] == [3, 4]
    assert found["other shape"] != found["goes on"][:2]
    told = "shape = 4 is out of range: it must be one of 1 (Stribeck), 2 (Hyperbolic), 3 (Curve)"
    assert told in found["refused shape"]
    assert "n_points = 13 is out of range" in found["refused count"]
    assert "shape is fixed" in found["refused change"]
