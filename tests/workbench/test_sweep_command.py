"""`stickslip sweep`: what it writes, what it says, and what it refuses."""

from __future__ import annotations

from pathlib import Path

import pytest

from stickslip_design.datasets import read_grid, read_points
from stickslip_native.packer import build as build_native
from stickslip_ref import Parameters, steady_cycle
from tests.needs import needs
from tests.workbench.running import Command

PLAN = """\
stop_time = "2 s"
step = "2 s"

[parameters]
k = "500..2000 N/m log 3"
mu_s = [0.4, -1.0]

[outputs]
delta_x = "last"
T = "last"
"""


@pytest.fixture
def plan(tmp_path: Path) -> Path:
    """Return the file of a plan of six runs, three of which fail."""
    file = tmp_path / "plan.toml"
    file.write_text(PLAN, encoding="utf-8")
    return file


@needs("studies")
def test_a_grid_is_written_as_zarr(command: Command, plan: Path, fmu_path: Path) -> None:
    """With its failures; the summary has the runs, the reason and the ranges."""
    answer = command("sweep", fmu_path, plan, "-o", "out", "--workers", 1)
    assert (answer.code, answer.err) == (0, "stickslip: written: out/sweep.zarr\n")
    assert "6 runs, 3 failed" in answer.out
    assert "3 x " in answer.out
    assert "mu_s = -1.0" in answer.out
    found = read_grid("out/sweep.zarr").load()
    exact = steady_cycle(Parameters(k=found["k"].values, mu_s=0.4))
    assert found["delta_x"].sel(mu_s=0.4).values == pytest.approx(exact.delta_x, rel=1e-12)
    assert found["delta_x"].attrs["units"] == "m"
    assert found["delta_x"].sel(mu_s=-1.0).isnull().all()
    assert "mu_s" in str(found["failure"].sel(mu_s=-1.0).values[0])
    assert "sweep" in found.attrs["command"]
    again = command("sweep", fmu_path, plan, "-o", "out", "--workers", 1)
    assert again.code == 0
    plan.write_text(PLAN.replace("0.4", "0.45"), encoding="utf-8")
    changed = command("sweep", fmu_path, plan, "-o", "out", "--workers", 1)
    assert changed.code == 2
    assert "--fresh" in changed.err
    fresh = command("sweep", fmu_path, plan, "-o", "out", "--workers", 1, "--fresh")
    assert fresh.code == 0


@needs("studies")
def test_points_are_written_as_parquet(command: Command, plan: Path, fmu_path: Path) -> None:
    """In the order of the table."""
    Path("points.csv").write_text("k [N/mm], mu_s\n1, 0.5\n2, 0.6\n", encoding="utf-8")
    text = PLAN[: PLAN.index("[parameters]")] + 'points = "points.csv"\n'
    plan.write_text(text + PLAN[PLAN.index("[outputs]") :], encoding="utf-8")
    answer = command("sweep", fmu_path, plan, "-o", "out", "--workers", 1)
    assert answer.code == 0
    found = read_points("out/sweep.parquet")
    assert found["k"].values.tolist() == [1000.0, 2000.0]
    exact = steady_cycle(Parameters(k=found["k"].values, mu_s=found["mu_s"].values))
    assert found["T"].values == pytest.approx(exact.T, rel=1e-12)
    assert found["T"].attrs["units"] == "s"


def test_a_template_is_written_once(command: Command, fmu_path: Path) -> None:
    """To a new file, or printed."""
    answer = command("sweep", fmu_path, "new.toml", "--template")
    assert (answer.code, answer.err) == (0, "stickslip: written: new.toml\n")
    assert 'x = "last"' in Path("new.toml").read_text(encoding="utf-8")
    assert command("sweep", fmu_path, "--template").out == Path("new.toml").read_text("utf-8")
    again = command("sweep", fmu_path, "new.toml", "--template")
    assert again.code == 2
    assert again.err == "stickslip: --template new.toml: is there already; name a new file\n"


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("delta_x =", "delta_y =",
         "line 9: outputs.delta_y is no variable of StickSlip.fmu; nearest: delta_x"),
        ('"500..2000 N/m log 3"', "nan", "line 5: parameters.k = nan is not finite"),
        ("500..2000", "2000..500", "line 5: parameters.k = '2000..500 N/m log 3' runs backwards"),
        ("log 3", "log 1000000000",
         ""),
    ],
)  # fmt: skip
def test_a_wrong_plan_writes_nothing(
    command: Command, plan: Path, fmu_path: Path, old: str, new: str, said: str
) -> None:
    """One line, exit code 2, no folder."""
    text = PLAN.replace(old, new)
    if "1000000000" in new:
        text = PLAN.replace("log 3", "log 1000000").replace("[0.4, -1.0]", '"0.4..0.9 600000"')
    plan.write_text(text, encoding="utf-8")
    answer = command("sweep", fmu_path, plan, "-o", "out", "--workers", 1)
    assert answer.code == 2
    many = "stickslip: 6e+11 points are more than 10^9; --yes computes them"
    assert answer.err.startswith(f"stickslip: {plan}: {said}" if said else many)
    assert answer.err.count("\n") == 1
    assert not Path("out").exists()


def test_what_is_no_model_is_refused(command: Command, plan: Path) -> None:
    """And a sweep without a plan."""
    assert command("sweep", "none.fmu", plan).err == "stickslip: none.fmu: no such file\n"
    Path("text.fmu").write_text("text", encoding="utf-8")
    answer = command("sweep", "text.fmu", plan)
    assert (answer.code, answer.err) == (
        2,
        "stickslip: text.fmu: not an FMU (not a zip archive)\n",
    )
    assert "--template" in command("sweep", "text.fmu").err


@needs("cc", "studies")
def test_the_native_fmu_is_swept_to_the_same_bits(
    command: Command, plan: Path, fmu_path: Path, tmp_path: Path
) -> None:
    """As the one in Python, under the same plan."""
    native = build_native(tmp_path / "native.fmu", this_machine=True)
    for fmu, folder in ((fmu_path, "one"), (native, "other")):
        assert command("sweep", fmu, plan, "-o", folder, "--workers", 1).code == 0
    one, other = (read_grid(f"{folder}/sweep.zarr").load() for folder in ("one", "other"))
    for name in ("delta_x", "T"):
        assert one[name].values.tobytes() == other[name].values.tobytes()
