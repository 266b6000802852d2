"""The FMU of another friction law takes the place of StickSlip.fmu, and nothing is rewired."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from examples.feed_axis.axis import Axis
from examples.feed_axis.build import build_drive
from examples.feed_axis.coupling import simulate
from examples.feed_axis.measure import Hunting, hunting
from examples.feed_axis.study import HUNTING, MOVE, hunting_time
from stickslip_fmu.packer import build


@pytest.fixture(scope="module")
def stribeck(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder where the table is StickSlipStribeck.fmu under the name of StickSlip.fmu."""
    folder = tmp_path_factory.mktemp("feed_axis_stribeck")
    build(folder / "StickSlip.fmu", law="stribeck")
    build_drive(folder)
    return folder


def _hunting(folder: Path, monkeypatch: pytest.MonkeyPatch, **own: Any) -> Hunting:
    """Let the axis as it is hunt about its target, the table with these values besides."""
    of_table = Axis.of_table
    monkeypatch.setattr(Axis, "of_table", lambda axis: {**of_table(axis), **own})
    axis = replace(HUNTING[0].axis, **MOVE)
    return hunting(simulate(folder, axis, hunting_time(axis)))


def test_hunting_halves_where_friction_falls_over_a_millimetre_a_second(
    stribeck: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of the jump of 13.6 um at constant coefficients 6.9 are left at v_s = 1 mm/s."""
    found = _hunting(stribeck, monkeypatch, v_s=1e-3, delta=1.0)
    assert found.jump == pytest.approx(6.9e-6, rel=0.01)


@pytest.mark.soak
def test_hunting_is_gone_where_friction_falls_slower_yet(
    stribeck: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At v_s = 5 mm/s the table stops at its target."""
    assert _hunting(stribeck, monkeypatch, v_s=5e-3, delta=1.0).stops


@pytest.mark.soak
def test_a_tiny_stribeck_velocity_is_coulomb_friction(
    stribeck: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At v_s = 1 um/s the table jumps as under constant coefficients."""
    found = _hunting(stribeck, monkeypatch, v_s=1e-6, delta=1.0)
    assert found.jump == pytest.approx(13.6e-6, rel=0.005)
