"""Runs of a sweep: what each gives, and what one that goes wrong costs the others."""

import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stickslip_design.chunks import Columns
from stickslip_design.sweeps import runs
from stickslip_design.sweeps.model import unpack_model
from stickslip_design.sweeps.runs import REDUCTIONS, Floats
from stickslip_design.sweeps.study import prepare, sweep
from stickslip_ref import Parameters, steady_cycle
from tests.conftest import built
from tests.needs import needs
from tests.python import python

PLAN: dict[str, Any] = {
    "stop_time": 1.0, "step": 0.5, "time_limit": 5.0, "parameters": {"gain": 3.0},
    "inputs": {"u": 2.0}, "outputs": {"y": ["last", "max", "min", "mean"]},
}  # fmt: skip


def planned(**changes: Any) -> dict[str, Any]:
    """Return the plan with other entries; those of its tables are added."""
    plan = dict(PLAN)
    for name, value in changes.items():
        plan[name] = {**plan.get(name, {}), **value} if isinstance(value, dict) else value
    return plan


def results(model: Path, plan: dict[str, Any], *bounds: int) -> Columns:
    study = prepare(model, plan)
    parts = [study.compute(*ends) for ends in pairwise((0, *bounds, study.count))]
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def bits(columns: Columns) -> dict[str, Any]:
    return {
        name: column.tolist() if name == "failure" else column.tobytes()
        for name, column in columns.items()
    }


TROUBLE = [0, 1, 0, 2, 3, 4, 5, 7, 0]


def test_a_run_that_goes_wrong_costs_itself_alone(troubled: Path) -> None:
    columns = results(troubled, planned(parameters={"trouble": TROUBLE}))
    reasons = columns["failure"].tolist()
    fine = [place for place, reason in enumerate(reasons) if not reason]
    assert fine == [0, 2, 6, 8]
    assert columns["y"][fine].tolist() == [6.0] * 4
    assert np.isnan(np.delete(columns["y"].astype(float), fine)).all()
    assert reasons[1] == "took longer than 5 s"
    assert reasons[3] == "crashed (SIGSEGV)"
    assert reasons[4] == "ended by itself with exit code 3"
    assert "fmi2DoStep(t = 0.0, h = 0.5) failed" in reasons[5]
    assert "discarded" in reasons[7]


def test_no_folder_is_left_of_fmus_whose_last_run_crashed(
    troubled: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    assert results(troubled, planned(parameters={"trouble": [0, 2]}))["failure"][1]
    assert not list(tmp_path.glob("stickslip-fmu-*"))
    # A program ends that has a sweep to its end.
    kept = f"kept = prepare({str(troubled)!r}, {PLAN})"
    python("-c", f"from {prepare.__module__} import prepare\n{kept}\nkept.compute(0, 1)")


def test_results_do_not_depend_on_chunks_nor_on_a_crash_left_behind(troubled: Path) -> None:
    # A run with the trouble 6 crashes of what another one left behind, and ends well on its own.
    plan = planned(parameters={"trouble": [0, 4, 6, 2], "gain": [0.1, 0.7]})
    expected = results(troubled, plan)
    assert [not reason for reason in expected["failure"].tolist()] == [True, False] * 4
    assert bits(results(troubled, plan, 1, 2, 7)) == bits(expected)


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        # Of y = 6 t at 0, 0.5 and 1 s.
        ({}, {"y": 6.0, "y.max": 6.0, "y.min": 0.0, "y.mean": 3.0}),
        # From the first communication point at or after that time; a short last step.
        ({"settle": "0.5 s", "step": 0.3}, {"y": 6.0, "y.max": 6.0, "y.min": 3.6, "y.mean": 4.8}),
    ],
)
def test_reductions_are_those_of_the_samples_after_settling(
    troubled: Path, changes: dict[str, Any], expected: dict[str, float]
) -> None:
    columns = results(troubled, planned(**changes))
    found = {name: float(columns[name][0]) for name in expected}
    assert found == pytest.approx(expected, rel=1e-14)  # roundings of some steps


def test_a_reset_that_forgets_nothing_is_not_used(
    troubled: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(runs, "_end_after", lambda seconds: None)
    for on, resets in ((True, False), (False, True)):
        study = prepare(troubled, planned(parameters={"on": on}, outputs={"runs": "last"}))
        (folder := tmp_path / str(on)).mkdir()
        runner = runs.Runner(study, unpack_model(study.model, folder))
        for _ in range(2):
            runner.run(np.array([]))
        assert runner.resets == resets


@needs("studies", "cc")
def test_a_grid_has_dimensions_units_and_inputs_and_the_jumps_of_the_reference() -> None:
    plan = {
        "stop_time": 3.0, "step": "4 ms", "parameters": {"k": [500.0, 3000.0], "mu_s": [0.5]},
        "inputs": {"v": 0.02},
        "outputs": {"x": ["jump", "period"], "delta_x": "last", "T": "last", "F": "max"},
    }  # fmt: skip
    found = sweep(built("native-3"), plan, workers=1)
    assert dict(found.sizes) == {"k": 2, "mu_s": 1}
    names = ("x.jump", "x.period", "F.max", "k")
    assert [found[name].attrs["units"] for name in names] == ["m", "s", "N", "N/m"]
    exact = steady_cycle(Parameters(k=np.array([500.0, 3000.0]), v=0.02))
    # By the FMU's meter to rounding; the mass does not move at rest, so that a jump needs no
    # interpolation; the first and the last of four break-aways or more are known to half a step.
    for name, expected, tolerance in (
        ("delta_x", exact.delta_x, 1e-12),
        ("T", exact.T, 1e-12),
        ("x.jump", exact.delta_x, 1e-9),
        ("x.period", exact.T, 4e-3 / 3.0 / np.asarray(exact.T)),
    ):
        assert np.all(np.abs(found[name].values[:, 0] / expected - 1.0) <= tolerance), name


def test_an_input_from_a_file_follows_straight_lines_and_steps_at_two_rows(
    troubled: Path, tmp_path: Path
) -> None:
    file = tmp_path / "u.csv"
    file.write_text("time [ms], u\n250, 1\n750, 3\n750, 8\n1000, 8\n", encoding="utf-8")
    outputs = {"y": "last", "u_begun": "last"}
    plan = planned(step=0.25, inputs={"u": str(file)}, parameters={"gain": 1.0}, outputs=outputs)
    # Its value at the beginning of a step holds over the step: 1, 1, 2 and 8.
    columns = results(troubled, plan)
    assert (columns["y"].tolist(), columns["u_begun"].tolist()) == ([3.0], [1.0])


TIMES: Floats = 0.01 * np.arange(1000, dtype=np.float64)


def stairs(sign: float) -> Floats:
    """Return a position that rests, and goes on by 20 mm within 0.2 s each 1.005 s."""
    steps, within = np.divmod(TIMES, 1.005)
    return 3.0 + sign * 0.02 * (steps + np.clip((within - 0.805) / 0.2, 0.0, 1.0))


@pytest.mark.parametrize(
    ("position", "jump", "period"),
    [
        (stairs(1.0), 0.02, 1.005),
        (stairs(-1.0), 0.02, 1.005),
        (0.3 * TIMES, 0.0, math.nan),
        # Where it turns its speed is 0 at once and not for some samples.
        (0.1 * TIMES + 0.2 * np.sin(3.0 * TIMES), 0.0, math.nan),
        (np.where(TIMES == 5.0, math.nan, stairs(1.0)), math.nan, math.nan),
    ],
)
def test_a_jump_is_from_rest_to_rest(position: Floats, jump: float, period: float) -> None:
    # The rests are known to rounding, and eight periods to half a step at each end.
    found = REDUCTIONS["jump"].of(TIMES, position)
    assert found == pytest.approx(jump, rel=1e-9, nan_ok=True)
    found = REDUCTIONS["period"].of(TIMES, position)
    assert found == pytest.approx(period, abs=0.01 / 8, nan_ok=True)
