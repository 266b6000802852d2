"""Block, reference and truth declare the same parameters, apart, and refuse the same values."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import fields

import pytest

import stickslip_ref as ref
from fmi.model import ModelError
from stickslip_fmu.block import Block
from stickslip_ref import Change, Parameters, simulate
from stickslip_verification import truth
from stickslip_verification.truth import Kind, Step
from tests.facts.closed import START
from tests.facts.sides import BASE, parted
from tests.fmu.blocks import block_of, spec_named
from tests.laws.stribeck import curve

LAWS = ("coulomb", "stribeck")


@pytest.mark.parametrize("law", [*LAWS, "lugre"])
def test_starts_units_bounds_and_what_may_change_are_the_same_on_three_sides(law: str) -> None:
    rows = [row for row in spec_named(law).table.rows if row.settable]
    own = ref.friction_law(law).parameters
    reference = {each.name: each.default for each in fields(Parameters) if each.name in BASE}
    reference |= {name: float(each.start) for name, each in own.items()}
    exact = (*truth.PARAMETERS, *truth.friction_law(law).parameters)
    assert {row.name: float(row.start or 0.0) for row in rows} == reference
    assert {each.name: each.start for each in exact} == reference
    tunable = {row.name for row in rows if row.variability != "fixed"}
    assert {each.name for each in exact if each.kind is not Kind.FIXED} == tunable
    assert {name for name, each in own.items() if each.tunable} == tunable - BASE
    for each in truth.friction_law(law).parameters:
        bound = own[each.name].bound
        low = -math.inf if each.low is None else each.low
        assert (bound.unit or "1", bound.low, bound.strict) == (each.unit, low, each.strict)


def test_the_start_values_are_those_of_the_design() -> None:
    starts = spec_named("coulomb").table.start_values()
    assert {name: starts[name] for name in START} == START


CURVE = curve([(0.0, 0.4), (0.02, 0.3), (0.15, 0.45)])
REFUSED: list[tuple[str, Mapping[str, float], str]] = [
    ("coulomb", {"m": 0.0}, "m = 0.0"),
    ("coulomb", {"g": -9.81}, "g = -9.81"),
    ("coulomb", {"k": -1.0}, "k = -1.0"),
    ("coulomb", {"c": -0.1}, "c = -0.1"),
    ("coulomb", {"mu_s": -0.5}, "mu_s = -0.5"),
    ("coulomb", {"mu_k": math.nan}, "mu_k = nan"),
    ("coulomb", {"v": math.inf}, "v = inf"),
    ("coulomb", {"F_ext": math.nan}, "F_ext = nan"),
    ("coulomb", {"load": -9.82}, "load = -9.82 .*-m g = -9.81"),
    ("coulomb", {"x_start": -math.inf}, "x_start = -inf"),
    ("coulomb", {"tau_s": -1.0}, "tau_s = -1.0"),
    ("coulomb", {"B": -0.5}, "B = -0.5"),
    ("coulomb", {"t_0": 0.0}, "t_0 = 0.0"),
    ("coulomb", {"age_start": -1e-9}, "age_start = -1e-09"),
    ("stribeck", {"shape": 4.0}, "shape = 4"),
    ("stribeck", {"shape": 0.0}, "shape = 0"),
    ("stribeck", {"n_points": 1.0}, "n_points = 1"),
    ("stribeck", {"n_points": 13.0}, "n_points = 13"),
    ("stribeck", {"v_s": 0.0}, "v_s = 0.0"),
    ("stribeck", {"delta": 0.99}, "delta = 0.99"),
    ("stribeck", {**CURVE, "u_3": 0.02}, "u_3 = 0.02"),
    ("stribeck", {**CURVE, "u_2": 0.0}, "u_2 = 0.0"),
    ("stribeck", {**CURVE, "mu_2": -0.1}, "mu_2 = -0.1"),
    ("stribeck", {**CURVE, "mu_1": 0.51}, "mu_1 = 0.51"),
]


def _block(law: str, values: Mapping[str, float]) -> Block:
    """Return a block, its values checked one by one as the FMU's setters do."""
    table = spec_named(law).table
    for name, value in values.items():
        if objection := table.by_name[name].objection(value):
            raise ModelError(objection)
    return block_of(spec_named(law), values)


@pytest.mark.parametrize(("law", "values", "words"), REFUSED, ids=str)
def test_a_value_out_of_range_is_refused_with_name_value_and_range(
    law: str, values: Mapping[str, float], words: str
) -> None:
    base, own = parted(values)
    with pytest.raises(ModelError, match=words):
        _block(law, values)
    with pytest.raises(ValueError, match=words):
        simulate(Parameters(**base), 0.1, law=law, own=own)
    with pytest.raises(ValueError, match=words):
        truth.run(values, [Step(0.1)], law=law)
    (name,) = re.findall("^[a-z_0-9A-Z]+", words)
    tunable = {row.name for row in spec_named(law).table.rows if row.variability != "fixed"}
    if len(values) > 1 or name not in tunable:
        return
    with pytest.raises(ValueError, match=words):
        simulate(Parameters(), 1.0, law=law, changes=[Change(0.5, base, own)])
    with pytest.raises(ValueError, match=words):
        truth.run({}, [Step(0.1), Step(0.1, values)], law=law)


@pytest.mark.parametrize("name", ["m", "g", "x_start", "age_start"])
def test_what_is_fixed_cannot_change_in_a_run(name: str) -> None:
    with pytest.raises(ValueError, match=rf"{name} = 2\.0.* cannot change during a run"):
        simulate(Parameters(), 1.0, changes=[Change(0.5, *parted({name: 2.0}))])
    with pytest.raises(ValueError, match=f"{name} cannot change in a run"):
        truth.run({}, [Step(1.0), Step(1.0, {name: 2.0})])


def test_points_that_do_not_count_are_not_checked() -> None:
    for own in ({**CURVE, "n_points": 2, "u_3": 0.01}, {**CURVE, "shape": 2, "mu_1": 0.9}):
        _block("stribeck", own)
        simulate(Parameters(), 0.1, law="stribeck", own=own)
        truth.run(own, [Step(0.01)], law="stribeck")


@pytest.mark.parametrize("step", [0.0, -1.0, math.nan, math.inf])
def test_a_step_that_is_none_is_refused(step: float) -> None:
    with pytest.raises(ModelError, match=r"step size h = .* above 0 and finite"):
        _block("coulomb", {}).advance(0.0, step)
    with pytest.raises(ValueError, match=r"h = .* is outside h > 0"):
        truth.run({}, [Step(step)])
