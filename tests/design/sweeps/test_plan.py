"""Plans: what they say of a model, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

from stickslip_design.datasets import digest_of
from stickslip_design.sweeps.model import Model, SweepError, read_model
from stickslip_design.sweeps.runs import Sweep
from stickslip_design.sweeps.study import prepare

HEAD = "stop_time = 2\nstep = 1\n"
TAIL = '[outputs]\nx = "last"\n'


@pytest.fixture(scope="module")
def block(fmu_path: Path) -> Model:
    return read_model(fmu_path)


def planned(text: str, model: Model | Path, folder: Path) -> Sweep:
    file = folder / "plan.toml"
    file.write_text(text, encoding="utf-8")
    return prepare(model, file)


def test_values_are_in_the_units_of_the_model(block: Model, tmp_path: Path) -> None:
    text = """
        [parameters]
        k = "0.5..2 N/mm log 3"
        mu_s = [0.4, "50 %"]
        m = "900 g"
        [inputs]
        v = ["1.2 m/min", 0.03]
        """
    study = planned(HEAD + text + TAIL, block, tmp_path)
    assert study.on_grid
    assert study.swept == ("k", "mu_s", "v")
    np.testing.assert_allclose(study.values[0], [500.0, 1000.0, 2000.0], rtol=1e-15)
    assert [each.tolist() for each in study.values[1:]] == [[0.4, 0.5], [0.02, 0.03]]
    assert study.fixed == {"m": 0.9}


@pytest.mark.parametrize(
    ("text", "ends", "steps", "settled"),
    [
        ('start_time = 1\nstop_time = "2 s"\nstep = "100 ms"\n', [1.0, 2.0], [0.1] * 10, 0),
        ("stop_time = 1\nstep = 0.3\nsettle = 0.5\n", [0.0, 1.0], [0.3, 0.3, 0.3, 0.1], 2),
        # From the default experiment of the model.
        ("", [0.0, 10.0], [0.01] * 1000, 0),
    ],
)
def test_steps_are_even_with_a_shorter_last_one(
    text: str, ends: list[float], steps: list[float], settled: int, block: Model, tmp_path: Path
) -> None:
    study = planned(text + TAIL, block, tmp_path)
    assert study.times[[0, -1]].tolist() == ends
    np.testing.assert_allclose(study.steps, steps, rtol=1e-12)  # roundings of the sum
    assert study.settled == settled


POINTS = {
    "nan.csv": "k, mu_s\n1000, 0.5\n1000, nan\n",
    "short.csv": "k, mu_s\n1000\n",
    "kg.csv": "k [kg]\n1\n",
}


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (f"stop_tim = 2\n{TAIL}", "line 1, stop_tim: is no field; there are start_time, "),
        (f'step = "2 kg"\n{TAIL}', "line 1, step: '2 kg' is a mass; expected a time in s"),
        (f"step = 1e-12\n{TAIL}", "line 1, step: 1e-12 s makes 1e+13 steps; at most 1e+08"),
        (f"{HEAD}[parameters]\nmu_S = 1\n{TAIL}",
         "line 4, parameters.mu_S: mu_S is no variable of StickSlip.fmu; nearest: mu_s"),
        (f'{HEAD}[parameters]\nk = "3 kg"\n{TAIL}',
         "line 4, parameters.k: k = '3 kg' has the unit 'kg', which is no unit like"),
        (f"{HEAD}[parameters]\nx = 1\n{TAIL}",
         "line 4, parameters.x: x is a continuous output, and cannot be set"),
        (f"{HEAD}[inputs]\nm = 1\n{TAIL}",
         "line 4, inputs.m: m is a fixed parameter, and cannot be set during a run"),
        (f'{HEAD}[outputs]\nx = "maximum"\n',
         "line 4, outputs.x: 'maximum' is no reduction; nearest: max"),
        (f'{HEAD}points = "nan.csv"\n{TAIL}', "nan.csv': line 3 has 1000, nan, and not 2"),
        (f'{HEAD}points = "short.csv"\n{TAIL}', "short.csv': line 2 has 1000, and not 2"),
        (f'{HEAD}points = "kg.csv"\n{TAIL}', "k has the unit 'kg', which is no unit like"),
        (f'{HEAD}[parameters]\nk = [1, 2]\n[outputs]\nk = "last"\n',
         "line 6, outputs.k: would be k twice in the results"),
    ],
)  # fmt: skip
def test_a_plan_that_cannot_be_used_is_refused_on_one_line(
    block: Model, tmp_path: Path, text: str, reason: str
) -> None:
    for name, points in POINTS.items():
        (tmp_path / name).write_text(points, encoding="utf-8")
    with pytest.raises(SweepError) as refused:
        planned(text, block, tmp_path)
    assert reason in str(refused.value)
    assert "\n" not in str(refused.value)


def test_points_are_read_in_their_units_and_what_the_plan_holds_is_the_same_for_all(
    block: Model, tmp_path: Path
) -> None:
    (tmp_path / "points.csv").write_text("k [N/mm]; v\n0.5; 0.01\n2; 0.02\n")
    text = f'{HEAD}points = "points.csv"\n[parameters]\nm = 2\n{TAIL}'
    study = planned(text, block, tmp_path)
    assert not study.on_grid
    assert [each.tolist() for each in study.values] == [[500.0, 2000.0], [0.01, 0.02]]
    assert study.fixed == {"m": 2.0}


def test_what_is_no_number_is_refused(troubled: Path) -> None:
    plan = {"outputs": {"y": "last"}, "stop_time": 1, "step": 1, "parameters": {"label": 1}}
    with pytest.raises(SweepError, match="is of type String, and no number"):
        prepare(troubled, plan)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("step = 1", "step = 0.5"),
        ("step = 1", "step = 1\nsettle = 0.5"),
        ("1000.0]", "1001.0]"),
        ("k = [500.0, 1000.0]\nm = [1.0, 2.0]", "m = [1.0, 2.0]\nk = [500.0, 1000.0]"),
        ('"v.csv"', "0.02"),
        ('"last"', '["last", "min"]'),
        ("0.03", "0.04"),
    ],
)
def test_all_that_results_depend_on_is_an_input(
    block: Model, tmp_path: Path, old: str, new: str
) -> None:
    table = "time,v\n0,0.02\n1,0.03\n"
    values = '[parameters]\nk = [500.0, 1000.0]\nm = [1.0, 2.0]\n[inputs]\nv = "v.csv"\n'
    identities = []
    for change in ((old, old), (old, old), (old, new)):
        (tmp_path / "v.csv").write_text(table.replace(*change), encoding="utf-8")
        study = planned((HEAD + values + TAIL).replace(*change), block, tmp_path)
        identities.append(digest_of(study.identity))
    assert identities[0] == identities[1] != identities[2]
