"""Plans: what they say of a model, and what is refused."""

from __future__ import annotations

import tomllib
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stickslip_design.quantity import QuantityError
from stickslip_design.sweeps import SweepError, read_model, read_plan
from stickslip_design.sweeps.model import Model
from stickslip_design.sweeps.resolve import Resolved, resolve
from stickslip_design.sweeps.study import prepare
from stickslip_design.sweeps.template import template
from stickslip_design.sweeps.units import between, read_as
from stickslip_verification import Unit

HEAD = "stop_time = 2\nstep = 1\n"
TAIL = '[outputs]\nx = "last"\n'


@pytest.fixture(scope="session")
def block(fmu_path: Path) -> Model:
    """Return the FMU's description."""
    return read_model(fmu_path)


def resolved(text: str, model: Model, folder: Path) -> Resolved:
    """Return what a plan is for a model."""
    file = folder / "plan.toml"
    file.write_text(text, encoding="utf-8")
    return resolve(read_plan(file), model)


def refusal(text: str, model: Model, folder: Path) -> str:
    """Return why a plan is refused, without the name of its folder."""
    with pytest.raises(SweepError) as refused:
        resolved(text, model, folder)
    said = str(refused.value)
    assert "\n" not in said
    return said.replace(f"{folder}/", "")


def test_values_are_in_the_units_of_the_model(block: Model, tmp_path: Path) -> None:
    """A plain number as it is, another unit converted, a range by its ends."""
    found = resolved(
        f"""{HEAD}
        [parameters]
        k = "0.5..2 N/mm log 3"
        mu_s = [0.4, "50 %"]
        m = "900 g"
        [inputs]
        v = ["1.2 m/min", 0.03]
        {TAIL}""",
        block,
        tmp_path,
    )
    assert found.on_grid
    assert found.job.swept == ("k", "mu_s", "v")
    np.testing.assert_allclose(found.values[0], [500.0, 1000.0, 2000.0], rtol=1e-15)
    assert found.values[1].tolist() == [0.4, 0.5]
    assert found.values[2].tolist() == [0.02, 0.03]
    assert found.job.fixed == {"m": 0.9}


def test_times_are_laid_out_from_start_to_stop(block: Model, tmp_path: Path) -> None:
    """Even steps, and a shorter last one where they do not divide the whole."""
    even = resolved(f'start_time = 1\nstop_time = "2 s"\nstep = "100 ms"\n{TAIL}', block, tmp_path)
    assert even.job.steps.tolist() == [0.1] * 10
    assert even.job.times[[0, -1]].tolist() == [1.0, 2.0]
    odd = resolved(f"stop_time = 1\nstep = 0.3\nsettle = 0.5\n{TAIL}", block, tmp_path)
    np.testing.assert_allclose(odd.job.steps, [0.3, 0.3, 0.3, 0.1], rtol=1e-12)
    assert odd.job.settled == 2


def test_times_come_from_the_model_where_the_plan_has_none(block: Model, tmp_path: Path) -> None:
    """From its default experiment: 10 s in steps of 0.01 s."""
    job = resolved(TAIL, block, tmp_path).job
    assert job.times[-1] == 10.0
    assert job.steps.size == 1000


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (f"stop_tim = 2\n{TAIL}", "line 1: stop_tim is an unknown key; nearest: stop_time"),
        (f"{HEAD}{TAIL}[input]\n", "line 5: input is an unknown key; nearest: inputs"),
        (f"{HEAD}parameters = 3\n{TAIL}", "line 3: parameters = 3 is no table"),
        (HEAD, "has no [outputs]"),
        (f"stop_time = 2,5\n{TAIL}", "line 1: is not TOML: "),
        (f"stop_time = nan\n{TAIL}", "line 1: stop_time = NaN is out of range: finite"),
        (f"step = 0\n{TAIL}", "line 1: step = 0 is out of range: above 0"),
        (f'step = "2 kg"\n{TAIL}', 'line 1: step = "2 kg" is a mass; expected a time in s'),
        (f"time_limit = -1\n{TAIL}", "line 1: time_limit = -1 is out of range: above 0"),
        (f"stop_time = 0\n{TAIL}", "line 1: stop_time = 0 s is not after start_time = 0 s"),
        (f"{HEAD}settle = 2\n{TAIL}", "line 3: settle = 2 s is the whole run of 2 s or more"),
        (f"step = 1e-12\n{TAIL}", "line 1: step = 1e-12 s makes 1e+13 steps; at most 1e+08"),
        (f"{HEAD}reset = 1\n{TAIL}", "line 3: reset = 1 is neither true nor false"),
        (f"{HEAD}[parameters]\nmu_S = 1\n{TAIL}",
         "line 4: parameters.mu_S is no variable of StickSlip.fmu; nearest: mu_s"),
        (f"{HEAD}[parameters]\nk = nan\n{TAIL}", "line 4: parameters.k = nan is not finite"),
        (f"{HEAD}[parameters]\nk = [1, inf]\n{TAIL}", "line 4: parameters.k = inf is not finite"),
        (f"{HEAD}[parameters]\nk = []\n{TAIL}", "line 4: parameters.k = [] is empty"),
        (f'{HEAD}[parameters]\nk = "5..1 N/m 3"\n{TAIL}',
         "line 4: parameters.k = '5..1 N/m 3' runs backwards"),
        (f'{HEAD}[parameters]\nk = "5..5 N/m 3"\n{TAIL}',
         "line 4: parameters.k = '5..5 N/m 3' is empty"),
        (f'{HEAD}[parameters]\nk = "0..5 N/m log 3"\n{TAIL}',
         "line 4: parameters.k = '0..5 N/m log 3' is logarithmic and begins at 0"),
        (f'{HEAD}[parameters]\nk = ["1..5 N/m 3"]\n{TAIL}',
         "line 4: parameters.k = '1..5 N/m 3' is a range in a list"),
        (f'{HEAD}[parameters]\nk = "3 kg"\n{TAIL}',
         "line 4: parameters.k = '3 kg' has the unit 'kg', which is no unit like the model's"),
        (f'{HEAD}[parameters]\nk = "3 foo"\n{TAIL}',
         "line 4: parameters.k = '3 foo' has the unknown unit 'foo'; the model's is 'N/m'"),
        (f"{HEAD}[parameters]\nx = 1\n{TAIL}",
         "line 4: parameters.x is a continuous output, and cannot be set"),
        (f"{HEAD}[inputs]\nm = 1\n{TAIL}",
         "line 4: inputs.m is a fixed parameter, and cannot be set during a run; it goes below"),
        (f"{HEAD}[parameters]\nv = 1\n[inputs]\nv = 1\n{TAIL}",
         "line 6: inputs.v stands in [parameters] too"),
        (f'{HEAD}[parameters]\nk = "k.csv"\n{TAIL}',
         "line 4: parameters.k = 'k.csv': a file goes with [inputs] or points"),
        (f'{HEAD}[inputs]\nv = "v.csv"\n{TAIL}',
         "line 4: inputs.v = 'v.csv': v.csv: cannot be read: no such file or directory"),
        (f'{HEAD}[outputs]\nX_dot = "last"\n',
         "line 4: outputs.X_dot is no variable of StickSlip.fmu; nearest: x_dot"),
        (f'{HEAD}[outputs]\nx = "maximum"\n',
         'line 4: outputs.x = "maximum" is no reduction; nearest: max'),
        (f'{HEAD}[parameters]\nk = [1, 2]\n[outputs]\nk = "last"\n',
         "line 6: outputs.k would be k in the results, as what is swept is"),
        (f'{HEAD}points = "a.txt"\n{TAIL}', 'line 3: points = "a.txt" is no file ending in'),
    ],
)  # fmt: skip
def test_a_plan_that_cannot_be_used_is_refused(
    block: Model, tmp_path: Path, text: str, reason: str
) -> None:
    """On one line with file, line, name and reason."""
    assert refusal(text, block, tmp_path).startswith(f"plan.toml: {reason}")


@pytest.mark.parametrize(
    ("points", "reason"),
    [
        ("k, mu_s\n1000, 0.5\n1000, nan\n", "points.csv: line 3: mu_s = nan is not finite"),
        ("k, mu_s\n1000, 0.5\n\n1000, a\n", "points.csv: line 4: mu_s = 'a' is no number"),
        ("k, mu_s\n1000\n", "points.csv: line 2: has 1 cells, and the header 2"),
        ("k, k\n1, 2\n", "points.csv: line 1: the header has a column twice"),
        ("k\n", "points.csv: has no rows"),
        ("", "points.csv: is empty"),
        ("K\n1\n", "K is no variable of StickSlip.fmu; nearest: k"),
        ("k [kg]\n1\n", "k has the unit 'kg', which is no unit like the model's 'N/m'"),
    ],
)
def test_points_that_cannot_be_used_are_refused(
    block: Model, tmp_path: Path, points: str, reason: str
) -> None:
    """With the line of the table that is wrong."""
    (tmp_path / "points.csv").write_text(points, encoding="utf-8")
    said = refusal(f'{HEAD}points = "points.csv"\n{TAIL}', block, tmp_path)
    assert said.startswith("plan.toml: line 3: points = 'points.csv': ") or reason in said
    assert reason in said


def test_points_are_read_in_their_units(block: Model, tmp_path: Path) -> None:
    """The header names the unit of a column; other values of the plan hold for all points."""
    (tmp_path / "points.csv").write_text("k [N/mm]; v\n0,5; 0.01\n2; 0.02\n".replace("0,5", "0.5"))
    plan = f'{HEAD}points = "points.csv"\n[parameters]\nm = 2\n{TAIL}'
    found = resolved(plan, block, tmp_path)
    assert not found.on_grid
    assert [each.tolist() for each in found.values] == [[500.0, 2000.0], [0.01, 0.02]]
    assert found.job.fixed == {"m": 2.0}
    assert list(found.digests) == ["points.csv"]


def test_a_number_that_is_no_value_of_its_type_is_refused(troubled: Path) -> None:
    """Of an integer, of a Boolean, and of a text."""
    outputs = {"outputs": {"y": "last"}, "stop_time": 1, "step": 1}
    model = read_model(troubled)
    for name, value, reason in (
        ("trouble", 0.5, r"has 0.5, and the variable is of type Integer"),
        ("trouble", 2**31, r"and the variable is of type Integer"),
        ("on", 2, r"has 2, and the variable is true or false"),
        ("label", 1, r"is of type String, and no number"),
    ):
        with pytest.raises(SweepError, match=reason):
            prepare(model, {**outputs, "parameters": {name: value}})
    assert prepare(model, {**outputs, "parameters": {"on": True}}).job.fixed == {"on": 1.0}


def test_a_template_is_a_plan_for_its_model(block: Model, feed_axis: Path) -> None:
    """As it is it does one run; every line that is commented out may stand too."""
    text = template(block)
    assert prepare(block, tomllib.loads(text)).count == 1
    entries = [line.removeprefix("# ") for line in text.splitlines() if " = " in line]
    tables = [line for line in text.splitlines() if line.startswith("[")]
    all_of_it: dict[str, Any] = tomllib.loads(text)
    for line in entries:
        for name, value in tomllib.loads(line).items():
            if name in block.variables and block.variables[name].causality != "output":
                table = "inputs" if block.variables[name].causality == "input" else "parameters"
                all_of_it[table][name] = value
    assert tables == ["[parameters]", "[inputs]", "[outputs]"]
    assert len(prepare(block, all_of_it).job.fixed) > 10
    of_system = template(read_model(feed_axis))
    # The value of the SSP file's parameters, not the start value of the FMU.
    assert "# table.k = 40000000.0  # N/m" in of_system
    assert 'table.x = "last"' in of_system
    assert "# table.v" not in of_system


def test_units_of_a_model_are_taken_as_it_defines_them() -> None:
    """With factor and offset; a unit of another dimension is refused."""
    kelvin, celsius = Fraction(0), Fraction("273.15")
    of_heat = (0, 0, 0, 0, 1, 0, 0, 0)
    units = {
        "K": Unit(Fraction(1), kelvin, of_heat),
        "mK": Unit(Fraction(1, 1000), kelvin, of_heat),
        "degC": Unit(Fraction(1), celsius, of_heat),
        "mm": Unit(Fraction(1, 1000), Fraction(0), (0, 1, 0, 0, 0, 0, 0, 0)),
    }
    assert read_as(units, "20 degC", "K") == 293.15
    assert read_as(units, "300 K", "degC") == 26.85
    assert between(units, "degC", "K") == (1.0, 273.15)
    assert between(units, "degC", "mK") == (1000.0, 273150.0)
    assert between(units, "mm", "") == (1.0, 0.0)
    assert between(units, "mm", "inch") is None
    with pytest.raises(QuantityError, match=r"has the unit 'K', and what drives it 'mm'"):
        between(units, "mm", "K")
    with pytest.raises(QuantityError, match=r"has the unit 'mm', and the model declares none"):
        read_as(units, "1 mm", "")


@pytest.mark.parametrize(
    ("name", "content", "reason"),
    [
        ("none.fmu", None, "no such file"),
        ("text.fmu", b"no archive", "not an FMU (not a zip archive)"),
        ("none.ssp", None, "no such file"),
        ("text.ssp", b"no archive", "not an SSP file (not a zip archive)"),
    ],
)
def test_a_file_that_is_no_model_is_refused(
    tmp_path: Path, name: str, content: bytes | None, reason: str
) -> None:
    """With its name and what it is not."""
    file = tmp_path / name
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(SweepError) as refused:
        read_model(file)
    assert str(refused.value) == f"{file}: {reason}"
