"""Runs of a sweep: what each gives, and what one that goes wrong costs the others."""

from __future__ import annotations

import dataclasses
import zipfile
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stickslip_design.chunks import run
from stickslip_design.sweeps.runner import Runner
from stickslip_design.sweeps.study import Sweep, prepare, release, sweep, tried
from stickslip_fmu.packer import build
from stickslip_ref import Parameters, steady_cycle
from stickslip_verification import FmuError
from tests.needs import needs

TROUBLES = {
    "trouble": [0, 1, 0, 2, 3, 4, 5, 7, 0],
}
PLAN: dict[str, Any] = {
    "stop_time": 1.0,
    "step": 0.5,
    "time_limit": 2.0,
    "parameters": {"gain": 3.0},
    "inputs": {"u": 2.0},
    "outputs": {"y": ["last", "max", "min", "mean"]},
}


def planned(**changes: Any) -> dict[str, Any]:
    """Return the plan with other entries; those of its tables are added."""
    plan = dict(PLAN)
    for name, value in changes.items():
        plan[name] = {**plan.get(name, {}), **value} if isinstance(value, dict) else value
    return plan


def columns_of(study: Sweep, *bounds: int) -> dict[str, bytes]:
    """Return the columns of a study as bytes, computed in the chunks between these bounds."""
    parts = [study.compute(start, stop) for start, stop in pairwise(bounds)]
    release()
    return {
        name: b"".join(np.asarray(part[name]).astype("U200").tobytes() for part in parts)
        if name == "failure"
        else b"".join(part[name].tobytes() for part in parts)
        for name in parts[0]
    }


def test_a_run_that_goes_wrong_costs_itself_alone(troubled: Path) -> None:
    """Each is recorded with its reason; those before and after it have their results."""
    study = prepare(troubled, planned(parameters=TROUBLES))
    columns = study.compute(0, study.count)
    release()
    said = dict(enumerate(columns["failure"].tolist()))
    fine = [0, 2, 6, 8]
    assert [place for place, reason in said.items() if not reason] == fine
    assert columns["y"][fine].tolist() == [6.0] * 4
    assert np.isnan(np.delete(columns["y"], fine)).all()
    assert said[1] == "took longer than 2 s"
    assert said[3] == "crashed (SIGSEGV)"
    assert said[4] == "ended the process with exit code 3"
    assert "fmi2DoStep(t = 0.0, h = 0.5) failed" in said[5]
    assert "fmi2DoStep(t = 0.0, h = 0.5) failed" in said[7]
    assert "discarded" in said[7]


def test_a_crash_left_behind_by_another_run_is_no_failure(troubled: Path) -> None:
    """The run is done again in a process of its own, where it ends well."""
    study = prepare(troubled, planned(parameters={"trouble": [0, 6, 0, 6]}))
    columns = study.compute(0, 4)
    release()
    assert columns["failure"].tolist() == [""] * 4


def test_reductions_are_those_of_the_samples(troubled: Path) -> None:
    """Of y = 6 t at 0, 0.5 and 1 s."""
    study = prepare(troubled, PLAN)
    columns = study.compute(0, 1)
    release()
    assert {name: each.tolist() for name, each in columns.items() if name != "failure"} == {
        "y": [6.0],
        "y.max": [6.0],
        "y.min": [0.0],
        "y.mean": [3.0],
    }


def test_what_is_settled_is_reduced_alone(troubled: Path) -> None:
    """From the first communication point at or after that time."""
    study = prepare(troubled, planned(settle="500 ms"))
    columns = study.compute(0, 1)
    release()
    assert columns["y.min"].tolist() == [3.0]
    assert columns["y.mean"].tolist() == [4.5]


def test_a_reset_that_forgets_nothing_is_not_used(troubled: Path) -> None:
    """It is tried before the sweep: each run of such an FMU has a new instance."""
    keeps = planned(parameters={"on": True, "gain": [1.0, 2.0]}, outputs={"runs": "last"})
    assert not tried(prepare(troubled, keeps)).job.reset
    assert tried(prepare(troubled, planned(parameters={"gain": [1.0, 2.0]}))).job.reset
    some_fail = prepare(troubled, planned(parameters={"trouble": [4, 0, 2]}))
    assert tried(some_fail).job.reset


def test_the_plan_may_ask_for_new_instances(fmu_path: Path) -> None:
    """Results are equal to the bit with a reset between runs and with a new instance for each."""
    plan = {
        "stop_time": 2.0,
        "step": 0.7,
        "parameters": {"k": "500..3000 N/m log 5", "mu_s": [0.4, 0.5]},
        "outputs": {"x": ["last", "max"], "delta_x": "last", "Q_friction": "last"},
    }
    with_reset = prepare(fmu_path, plan)
    without = prepare(fmu_path, {**plan, "reset": False})
    assert with_reset.job.reset
    assert not without.job.reset
    assert columns_of(with_reset, 0, 10) == columns_of(without, 0, 10)


def test_an_instance_does_run_after_run(troubled: Path, tmp_path: Path) -> None:
    """Reset between; after a run that fails, and where resets are not used, there is a new one."""
    job = prepare(troubled, planned(parameters={"trouble": [0, 4]})).job
    with zipfile.ZipFile(troubled) as archive:
        archive.extractall(tmp_path)
    fine, wrong = np.array([0.0]), np.array([4.0])
    runner = Runner(job, [tmp_path])
    first = runner.instances
    assert runner.run(fine) == runner.run(fine)
    assert runner.instances == first
    with pytest.raises(FmuError, match="fmi2DoStep"):
        runner.run(wrong)
    assert runner.instances != first
    runner.close()
    runner = Runner(job, [tmp_path])
    first = runner.instances
    with pytest.raises(FmuError, match="fmi2DoStep"):
        runner.run(wrong)
    assert runner.instances != first
    runner.close()
    runner = Runner(dataclasses.replace(job, reset=False), [tmp_path])
    first = runner.instances
    assert runner.run(fine) == runner.run(fine)
    assert runner.instances != first
    runner.close()


def test_results_do_not_depend_on_chunks(troubled: Path) -> None:
    """To the bit, failures among them."""
    study = prepare(troubled, planned(parameters={"trouble": [0, 4, 7, 6, 2], "gain": [0.1, 0.7]}))
    whole = columns_of(study, 0, 10)
    assert whole == columns_of(study, 0, 1, 2, 7, 10)
    assert whole == columns_of(study, *range(11))


def test_results_do_not_depend_on_workers(troubled: Path) -> None:
    """To the bit, with one and with two; runs of 0.1 s are long enough for two to be started."""
    slow = planned(parameters={"trouble": [8, 4], "gain": "0.1..0.7 20"})
    study = prepare(troubled, slow)
    one = run(study, workers=1).read()
    two = run(study, workers=2).read()
    release()
    assert one["y"].tobytes() == two["y"].tobytes()
    assert one["failure"].tolist() == two["failure"].tolist()


@pytest.mark.parametrize("face", [2, 3])
def test_jump_and_period_are_those_of_the_reference(face: Any, tmp_path: Path) -> None:
    """By the FMU's meter to rounding; by the score's events within the sampling; FMI 2 and 3."""
    fmu = build(tmp_path, face=face)
    plan = {
        "stop_time": 4.0,
        "step": "4 ms",
        "parameters": {"k": [500.0, 3000.0]},
        "inputs": {"v": "20 mm/s"},
        "outputs": {"x": ["jump", "period"], "delta_x": "last", "T": "last"},
    }
    study = prepare(fmu, plan)
    columns = study.compute(0, study.count)
    release()
    found = {name: columns[name].astype(np.float64) for name in study.job.columns}
    exact = steady_cycle(Parameters(k=np.array([500.0, 3000.0]), v=0.02))
    jump, period = np.asarray(exact.delta_x), np.asarray(exact.T)
    np.testing.assert_allclose(found["delta_x"], jump, rtol=1e-12)
    np.testing.assert_allclose(found["T"], period, rtol=1e-12)
    # The mass does not move at rest, so that a jump needs no interpolation.
    np.testing.assert_allclose(found["x.jump"], jump, rtol=1e-9)
    # The first and the last of five break-aways or more are known to half a step each.
    np.testing.assert_allclose(found["x.period"], period, atol=4e-3 / 4.0)


@needs("studies")
def test_a_grid_has_dimensions_units_and_provenance(troubled: Path) -> None:
    """And failures as a variable; xarray opens it as it is."""
    found = sweep(
        troubled, planned(parameters={"trouble": [0, 4], "gain": [1.0, 2.0, 4.0]}), workers=1
    )
    assert dict(found.sizes) == {"trouble": 2, "gain": 3}
    assert found["y"].sel(trouble=0).values.tolist() == [2.0, 4.0, 8.0]
    assert (found["failure"].sel(trouble=0) == "").all()
    assert (found["failure"].sel(trouble=4) != "").all()
    assert found["y.max"].attrs["long_name"] == "y: greatest sample"
    assert '"model": "Troubled.fmu"' in found.attrs["inputs"]
    assert found.attrs["fixed"] == '{"u": "2.0"}'


@needs("studies")
def test_results_have_their_units(fmu_path: Path) -> None:
    """A jump that of the position, a period seconds."""
    plan = {"stop_time": 0.01, "step": 1e-3, "outputs": {"x": ["jump", "period"], "F": "last"}}
    found = sweep(fmu_path, {**plan, "parameters": {"k": [1e3, 2e3]}}, workers=1)
    units = {name: found[name].attrs["units"] for name in ("x.jump", "x.period", "F", "k")}
    assert units == {"x.jump": "m", "x.period": "s", "F": "N", "k": "N/m"}


@needs("studies")
def test_points_of_a_table_make_one_dimension(troubled: Path, tmp_path: Path) -> None:
    """In the order of its rows."""
    file = tmp_path / "points.csv"
    file.write_text("gain, u\n1, 2\n3, 4\n5, 6\n", encoding="utf-8")
    plan = planned(points=str(file))
    plan = {**plan, "parameters": {}, "inputs": {}}
    found = sweep(troubled, plan, workers=1)
    assert dict(found.sizes) == {"point": 3}
    assert found["y"].values.tolist() == [2.0, 12.0, 30.0]
    assert found["gain"].dims == ("point",)


def test_an_input_from_a_file_follows_straight_lines(troubled: Path, tmp_path: Path) -> None:
    """Its value at the beginning of a step holds over the step; a step of the input is two rows."""
    file = tmp_path / "u.csv"
    file.write_text("time [ms], u\n250, 1\n750, 3\n750, 8\n1000, 8\n", encoding="utf-8")
    plan = planned(step=0.25, inputs={"u": str(file)}, parameters={"gain": 1.0})
    study = prepare(troubled, plan)
    assert study.job.tables[0].values.tolist() == [1.0, 1.0, 2.0, 8.0]
    columns = study.compute(0, 1)
    release()
    assert columns["y"].tolist() == [3.0]
    file.write_text("time, u\n0, 5\n", encoding="utf-8")
    begun = prepare(troubled, {**plan, "outputs": {"u_begun": "last"}}).compute(0, 1)
    release()
    assert begun["u_begun"].tolist() == [5.0]
    assert prepare(troubled, plan).identity != study.identity
