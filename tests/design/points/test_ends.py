"""Limits that are not there, are met backward, or cannot be found."""

import math

import numpy as np
import pytest

from stickslip_design.axis import axis_file_of
from stickslip_design.points.axes import UNKNOWN, axis_points
from stickslip_design.points.blocks import block_points, critical_speeds
from stickslip_ref import Parameters, coulomb_limit, critical_velocity

AXIS = """
[axis]
mass = "500 kg"
stiffness = "40 N/um"
c = "5 kN s/m"
[friction]
mu_s = 0.2
mu_k = 0.18
law = "stribeck"
v_s = "1 mm/s"
delta = 1
"""


def test_a_limit_is_met_in_both_directions() -> None:
    """The critical velocity is that of the speed."""
    v_c = float(coulomb_limit(Parameters(c=1.0)))
    v = v_c * np.array([-1.0, -0.9, 0.9, 1.0])
    assert block_points({"c": 1.0, "v": v})["at_limit"].tolist() == [True, False, False, True]


def test_cycles_up_to_the_end_of_the_search_have_no_critical_velocity() -> None:
    """Without damping, friction that falls to a constant lets no motion come to rest for good."""
    assert critical_speeds({"c": 0.0}, "stribeck") == math.inf
    assert 0.0 < critical_speeds({"c": 5.0}, "stribeck") < math.inf


@pytest.mark.parametrize(
    ("law", "own"),
    [("coulomb", {}), ("coulomb", {"tau_s": 0.1}), ("coulomb", {"B": 0.01}), ("stribeck", {})],
)
def test_kinetic_friction_above_static_is_clamped(law: str, own: dict[str, float]) -> None:
    """It is mu_s - 0.01 under every friction law, at each speed."""
    v = np.geomspace(1e-3, 1.0, 7)
    above, clamped = (
        block_points({"c": 1.0, "mu_s": 0.3, "mu_k": mu_k, "v": v, **own}, law)
        for mu_k in (0.4, max(0.3 - 0.01, 0.0))
    )
    for name, column in clamped.items():
        np.testing.assert_array_equal(above[name], column, err_msg=name)


def test_an_axis_that_cannot_be_computed_is_unknown(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is not taken for one that moves evenly, and costs no other one."""

    def failing(p: Parameters, *arguments: object) -> object:
        if p.m == 600.0:
            raise RuntimeError("a slip cannot be followed")
        return critical_velocity(p, *arguments)  # type: ignore[arg-type]  # handed on as they came

    monkeypatch.setattr("stickslip_design.points.axes.critical_velocity", failing)
    file, mass = axis_file_of(AXIS), np.array([500.0, 600.0])
    found = axis_points(file, {"axis.mass": mass}, 1e-4)
    alone = axis_points(file, {"axis.mass": mass[:1]}, 1e-4)
    assert found["regime"][1] == UNKNOWN
    assert np.isnan([found[name][1] for name in ("critical_feed", "jump", "rate")]).all()
    for name, column in alone.items():
        assert found[name][0] == column[0], name
