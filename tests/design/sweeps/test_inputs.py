"""All that the results of a sweep depend on is among its inputs."""

from pathlib import Path
from typing import Any

import pytest

from stickslip_design.datasets import digest_of
from stickslip_design.sweeps.refusal import SweepError
from stickslip_design.sweeps.study import Sweep, prepare

PLAN: dict[str, Any] = {
    "stop_time": 1.0,
    "step": 0.1,
    "parameters": {"k": [500.0, 1000.0]},
    "inputs": {"v": "v.csv"},
    "outputs": {"x": ["last", "max"]},
}


def prepared(fmu: Path, folder: Path, **changes: Any) -> Sweep:
    """Return the study of the plan with other entries, read from a file."""
    entries = {**PLAN, **changes}
    tables = {name: entries.pop(name) for name in ("parameters", "inputs", "outputs")}
    lines = [f"{name} = {_toml(value)}" for name, value in entries.items()]
    for name, table in tables.items():
        lines += [f"[{name}]", *(f"{key} = {_toml(value)}" for key, value in table.items())]
    plan = folder / "plan.toml"
    plan.write_text("\n".join(lines), encoding="utf-8")
    return prepare(fmu, plan)


def _toml(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else repr(value)


CHANGES: list[dict[str, Any]] = [
    {"stop_time": 2.0},
    {"step": 0.05},
    {"settle": 0.5},
    {"start_time": 0.5},
    {"reset": False},
    {"time_limit": 5.0},
    {"parameters": {"k": [500.0, 1001.0]}},
    {"parameters": {"k": [500.0, 1000.0], "c": 1.0}},
    {"inputs": {"v": 0.02}},
    {"outputs": {"x": ["last", "min"]}},
]


@pytest.mark.parametrize("changes", CHANGES)
def test_what_a_plan_says_is_an_input(
    fmu_path: Path, tmp_path: Path, changes: dict[str, Any]
) -> None:
    """A changed plan is another study: results of the old one are not taken for it."""
    (tmp_path / "v.csv").write_text("time,v\n0,0.02\n1,0.03\n", encoding="utf-8")
    assert prepared(fmu_path, tmp_path).identity == prepared(fmu_path, tmp_path).identity
    assert prepared(fmu_path, tmp_path, **changes).identity != prepared(fmu_path, tmp_path).identity


def test_files_are_inputs_by_what_is_in_them(fmu_path: Path, tmp_path: Path) -> None:
    """The model, and the tables that the plan names."""
    table, model = tmp_path / "v.csv", tmp_path / "StickSlip.fmu"
    content = fmu_path.read_bytes()
    identities = []
    for rows, more in (("0,0.02", b""), ("0,0.03", b""), ("0,0.03", b"\0")):
        table.write_text(f"time,v\n{rows}\n", encoding="utf-8")
        # Bytes before a zip archive are not of it.
        model.write_bytes(more + content)
        identities.append(prepared(model, tmp_path).identity)
    one, two, three = identities
    assert one != two
    assert two != three


def test_a_plan_without_a_file_has_no_lines(fmu_path: Path, tmp_path: Path) -> None:
    """A refusal names the line of a file, and of a mapping the key alone."""
    plan = {**PLAN, "inputs": {}, "parameters": {"kk": 1.0}}
    with pytest.raises(SweepError, match=r"^plan: parameters\.kk is no variable"):
        prepare(fmu_path, plan)
    with pytest.raises(SweepError, match=r"plan\.toml: line 4: parameters\.kk is no variable"):
        prepared(fmu_path, tmp_path, inputs={}, parameters={"kk": 1.0})


def test_the_order_of_the_axes_is_an_input(fmu_path: Path) -> None:
    """Results are kept by the number of a run, which counts along the axes."""
    k, m = {"k": [500.0, 1000.0]}, {"m": [1.0, 2.0]}
    plan = {"stop_time": 1.0, "step": 0.5, "outputs": {"x": "last"}}
    one, other = (prepare(fmu_path, {**plan, "parameters": each}) for each in (k | m, m | k))
    assert digest_of(one.identity) != digest_of(other.identity)
