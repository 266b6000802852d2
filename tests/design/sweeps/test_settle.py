"""Reductions over a part of a run."""

from pathlib import Path

import pytest

from stickslip_design.chunks import run
from stickslip_design.sweeps.study import prepare, release


def test_a_short_last_step_counts_by_its_length(fmu_path: Path) -> None:
    """The pulled end is at v t, so its mean from 0.6 to 1 s is that at 0.8 s."""
    plan = {
        "stop_time": 1.0,
        "step": 0.3,
        "settle": 0.5,
        "inputs": {"v": 0.02},
        "outputs": {"x_pull": ["mean", "min"]},
    }
    try:
        found = run(prepare(fmu_path, plan), workers=1).read()
    finally:
        release()
    assert found["x_pull.mean"] == pytest.approx(0.02 * 0.8, rel=1e-13)
    assert found["x_pull.min"] == pytest.approx(0.02 * 0.6, rel=1e-13)
