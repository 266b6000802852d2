"""Both engines give the same run."""

from pathlib import Path

import numpy as np
import pytest

from stickslip.simulate.engines import Experiment, experiment, simulate_fmu, simulate_reference
from stickslip_fmu.spec import TABLE

RUNS = {
    "default": {},
    "reversed": {"v": -0.02, "F_ext": 1.0},
    "damped": {"c": 1.0},
    "sliding": {"c": 30.0, "v": 0.1},
    "ringing": {"v": 0.0, "x_dot_start": 1.0, "k": 1e4},
    "turning": {"x_dot_start": -0.5, "k": 3000.0},
    "beyond": {"z_start": 0.02},
    "no gap": {"mu_k": 0.5},
    "resting": {"v": 0.0},
}


@pytest.mark.parametrize("interval", [0.004, 0.03])
@pytest.mark.parametrize("name", RUNS)
def test_the_engines_agree(fmu_path: Path, name: str, interval: float) -> None:
    """Events found between the FMU's samples are those of the reference, reversals included."""
    what = Experiment({**TABLE.start_values(), **RUNS[name]}, 0.5, 2.5, interval)
    fmu, _ = simulate_fmu(what, fmu_path, lambda done, total: None)
    reference, _ = simulate_reference(what)
    assert fmu.samples.dtype == reference.samples.dtype
    assert fmu.hidden_events == 0
    assert [(e.kind, e.mode) for e in fmu.events] == [(e.kind, e.mode) for e in reference.events]
    # The reference integrates each slip to some 1e-13 of its scale; 1e-9 leaves room for 60 slips.
    for mine, other in zip(fmu.events, reference.events, strict=True):
        assert mine.time == pytest.approx(other.time, abs=1e-9)
        assert mine.x == pytest.approx(other.x, abs=1e-9)
        assert mine.z == pytest.approx(other.z, abs=1e-9)
    for output in ("x", "z", "F", "Q_friction", "T"):
        scale = float(np.max(np.abs(reference.samples[output])))
        assert fmu.samples[output] == pytest.approx(reference.samples[output], abs=1e-9 * scale)


def test_progress_ends_at_the_whole_duration(fmu_path: Path) -> None:
    """The progress of a run goes from the first step to the last."""
    seen: list[tuple[float, float]] = []
    what = experiment(TABLE.start_values(), 1.0, 3.0)
    simulate_fmu(what, fmu_path, lambda done, total: seen.append((done, total)))
    assert seen[0] == pytest.approx((0.01, 2.0))
    assert seen[-1] == pytest.approx((2.0, 2.0))


def test_a_run_to_be_drawn_is_sampled_finely_enough() -> None:
    """A stiff drive has slips of a millisecond: ten samples of 0.01 s would draw nothing."""
    stiff = {**TABLE.start_values(), "k": 1e7}
    assert experiment(stiff, 0.0, 1.0).output_interval == 0.01
    # w = 3162 rad/s: half a radian is 0.16 ms.
    assert experiment(stiff, 0.0, 1.0, drawn=True).output_interval == 0.01 / 64
    assert experiment(stiff, 0.0, 1.0, 0.05, drawn=True).output_interval == 0.05
