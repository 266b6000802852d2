"""The example's command, the SSP file that it writes, and the masters that run it."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import typer
from fmpy.ssp.ssd import read_ssd, read_ssm, read_ssv
from numpy.typing import NDArray

from examples.feed_axis.__main__ import build_all, main
from examples.feed_axis.masters import MasterError, run
from stickslip import Parameters, cycle
from stickslip.systems import (
    WIRES,
    Move,
    System,
    start_values,
    values_of,
    write_system,
)
from stickslip_design.axis import axis_file_of, example
from tests.needs import needs
from tests.python import python

from .coupled import simulate

Columns = dict[str, NDArray[np.float64]]

STOP, STEP = 0.5, 250e-6
FMPY = "fmpy"
MASTERS = [
    FMPY,
    pytest.param("ecos", marks=needs("ecospy")),
    pytest.param("libcosim", marks=needs("libcosimpy")),
]
AXIS, MOVE = axis_file_of(example()).axis(), Move(5e-4)
VALUES = start_values(AXIS, MOVE)


@pytest.mark.gate
def test_a_run_writes_the_ssp_file_samples_and_a_picture(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "axis.toml"
    file.write_text(example().replace('position = "table"', 'position = "motor"'), "utf-8")
    main(file, feed="0.3 mm/s", stop_time="0.4 s", output=tmp_path)
    assert capsys.readouterr().err == ""
    assert {"FeedAxis.ssp", "run.csv", "run.svg"} <= {file.name for file in tmp_path.iterdir()}
    rows = pd.read_csv(tmp_path / "run.csv")
    # Friction winds the screw up: the table stays behind the motor, by F_s / k at most.
    assert 0.0 < (rows["drive.x_motor"] - rows["table.x"]).iat[-1] < 1.01 * 981.0 / 4e7


def test_what_is_no_run_is_refused_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(typer.Exit):
        main(feed="3 kg")
    assert re.fullmatch("feed_axis: .*3 kg.*\n", capsys.readouterr().err)


def run_in(master: str, ssp: Path, stop: float) -> Any:
    run(master, ssp, stop, STEP, ssp.with_suffix(".csv"))
    return pd.read_csv(ssp.with_suffix(".csv"))


@pytest.fixture(scope="module")
def axis_file(fmus: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_system(
        "drive", tmp_path_factory.mktemp("ssp") / "FeedAxis.ssp", VALUES, fmus / "StickSlip.fmu"
    )


@pytest.fixture(scope="module")
def own(fmus: Path) -> Columns:
    return simulate(fmus, VALUES, STOP)


@needs("cc")
def test_the_native_table_shows_the_same_bits(own: Columns, tmp_path: Path) -> None:
    found = run_in(FMPY, build_all(tmp_path, AXIS, MOVE, native=True), STOP)
    assert all(np.array_equal(found[name], own[name]) for name in own)


# A step of 2.5e-4 s in whole nanoseconds differs by 1 ulp of time, 1e-16 s; the force that the
# velocity loop makes of a position's rounding, K_p 1e-19 m / T_s = 3e-10 N, is nothing. The axis is
# stable, so differences stay; a count of an encoder that fell the other way is 1e-8 m or more.
@pytest.mark.parametrize("master", MASTERS[1:])
def test_masters_that_step_both_at_once_agree_in_every_bit_or_nanosecond(
    master: str, axis_file: Path, own: Columns
) -> None:
    off = 1e-11 if master == "libcosim" else 0.0
    found = run_in(master, axis_file, STOP)
    assert off or all(np.array_equal(found[name], own[name]) for name in own)
    for name in ("table.x", "drive.x_motor"):
        assert np.max(np.abs(found[name] - own[name])) <= off


@pytest.mark.parametrize("master", MASTERS)
def test_what_the_drive_refuses_is_told_also_where_the_master_goes_on(
    master: str, fmus: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    refused = {**VALUES, "drive": {**VALUES["drive"], "K_v": -1.0}}
    file = write_system("drive", tmp_path / "refused.ssp", refused, fmus / "StickSlip.fmu")
    reason = "K_v = -1.0 1/s is out of range: it must be finite and at least 0"
    if master == "ecos":
        assert not run_in(master, file, 4 * STEP)["drive.x_motor"].any()
        assert reason in capsys.readouterr().err
    else:
        with pytest.raises(MasterError, match=re.escape(reason)):
            run_in(master, file, 4 * STEP)


@pytest.mark.parametrize("system", WIRES)
def test_a_system_is_a_valid_ssp_with_the_same_numbers_in_both_places(
    system: System, fmus: Path, tmp_path: Path
) -> None:
    values = values_of(system, "coulomb", None)
    file = str(write_system(system, tmp_path / "own.ssp", values, fmus / "StickSlip.fmu"))
    read_ssv(file, "resources/parameters.ssv", validate=True)
    read_ssm(file, "resources/parameters.ssm", validate=True)
    structure = read_ssd(file, validate=True).system
    [binding] = structure.parameterBindings
    [parameters], [mapping] = binding.parameterValues, binding.parameterMapping
    of_system = {each.name: each for each in parameters.parameters}
    inside = {
        f"{component.name}.{each.name}": (each.type, each.value, each.unit)
        for component in structure.elements
        for each in component.parameterBindings[0].parameterValues[0].parameters
    }
    assert inside == {
        each.target: (own.type, own.value, own.unit)
        for each in mapping.mappingEntries
        for own in [of_system[each.source]]
    }
    # libcosim drops a Real that is written as an Integer.
    assert {name for name, (kind, *_) in inside.items() if kind != "Real"} <= {"drive.on_table"}
    # One name for a stiffness that table and drive share; none where they differ.
    shared = [each.target for each in mapping.mappingEntries if each.source == "k"]
    assert shared == {"source": ["block.k"], "drive": ["table.k", "drive.k"], "pair": []}[system]
    # FMPy gives an input that nothing drives the value of another one.
    wires = structure.connections
    assert {(component.name, each.name) for component in structure.elements
            for each in component.connectors if each.kind == "input"} == {
        (each.endElement, each.endConnector) for each in wires
    }  # fmt: skip
    assert {f"{each.startElement}.{each.startConnector} {each.endElement}.{each.endConnector}"
            for each in wires} == set(WIRES[system])  # fmt: skip


@pytest.mark.gate
@pytest.mark.parametrize("master", MASTERS)
def test_a_system_that_is_built_sticks_and_slips_wherever_it_runs(
    master: str, tmp_path: Path
) -> None:
    last: dict[str, float] = {}
    for system, stop, step, names in (
        ("source", 1.0, 1e-3, ["block.T"]),
        ("pair", 0.2, STEP, ["first.delta_x", "second.delta_x"]),
    ):
        done = python("-m", "stickslip", "build", "--ssp", system, "-o", tmp_path)
        file = Path(done.stdout.split("  ")[0])
        run(master, file, stop, step, tmp_path / "run.csv", names)
        last |= pd.read_csv(tmp_path / "run.csv").iloc[-1]
    # The speed is a difference of positions of 0.02 m, each rounded to 2e-18 m, over a step.
    assert last["block.T"] == pytest.approx(cycle(Parameters()).exact.T, rel=1e-12)
    # Each jumps by its gap 2 (mu_s - mu_k) m g / k, and by what the pulled end moves meanwhile.
    for table, relief in (("first", 12.26e-6), ("second", 6.13e-6)):
        assert relief < last[f"{table}.delta_x"] < 2.0 * relief
