"""The reference under a friction that bends: it stops at corners, and meets the exact block."""

import itertools
from typing import Any

import numpy as np
import pytest

from stickslip_fmu.laws.named import friction_law
from stickslip_fmu.spec import spec_of
from stickslip_ref import RTOL, Parameters, simulate

SPEC = spec_of(friction_law("stribeck").law)
TWICE = {"shape": 3, "n_points": 5, "mu_1": 0.5, "u_2": 0.02, "mu_2": 0.3, "u_3": 0.15} | {
    "mu_3": 0.45, "u_4": 0.4, "mu_4": 0.2, "u_5": 0.6, "mu_5": 0.25
}  # fmt: skip
"""A curve that falls twice."""


@pytest.mark.parametrize(
    ("v", "own"),
    [
        (0.02, TWICE),
        (0.15, TWICE),
        (0.3, TWICE),
        (-0.3, TWICE),
        (0.02, {"v_s": 1e-3, "delta": 1.0}),
        (0.05, {"v_s": 0.02, "delta": 1.5}),
        (0.02, {"shape": 2, "v_s": 1e-3}),
    ],
)
def test_reference_and_exact_block_stand_together(v: float, own: dict[str, float]) -> None:
    """The spring at a hundred times, over a dozen slips; a corner may be at the speed of the pull.

    What a step of the integration leaves open, RTOL, times the steps of a dozen slips and their
    sensitivity, theory (17).
    """
    times = np.linspace(0.0, 3.0, 101)
    run = simulate(Parameters(c=1.0, v=v), 3.0, law="stribeck", own=own, times=times)
    values = {**SPEC.table.start_values(), **own, "c": 1.0, "v": v}
    block: Any = SPEC.model(SPEC.values(values))
    extensions = [0.0]
    for start, end in itertools.pairwise(times.tolist()):
        block.advance(start, end - start)
        block.refresh()
        extensions.append(block.z)
    scale = np.max(np.abs(run.z))
    assert np.max(np.abs(run.z - extensions)) <= 100.0 * RTOL * scale
    assert run.n_slips[-1] > 5


def test_a_corner_met_beside_its_speed_is_passed() -> None:
    """Pieces end at a corner to rounding; a run just above a limit crossed one without end."""
    v = 0.4195081103776426
    own = {name: float(value) for name, value in TWICE.items()}
    p = Parameters(c=2.0, v=v)
    stop_time = float(p.F_s / (p.k * v)) + 30.0 / float(p.w)
    assert not simulate(p, stop_time, law="stribeck", own=own).n_slips[-1]
