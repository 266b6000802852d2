"""The example's command, the SSP file that it writes, and the masters that run it."""

import re
import zipfile
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import pytest
import typer
from fmpy.ssp.ssd import read_ssd, read_ssv
from numpy.typing import NDArray

from examples.feed_axis.__main__ import main
from examples.feed_axis.masters import MasterError, run
from examples.feed_axis.system import Move, build_all, start_values, write_ssp
from stickslip_design.axis import axis_file_of, example
from tests.needs import needs

from .coupled import simulate

Columns = dict[str, NDArray[np.float64]]

STOP, STEP = 0.5, 250e-6
SSV = "{http://ssp-standard.org/SSP1/SystemStructureParameterValues}"
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
    return write_ssp(tmp_path_factory.mktemp("ssp") / "FeedAxis.ssp", VALUES, fmus)


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
    file = write_ssp(tmp_path / "refused.ssp", refused, fmus)
    reason = "K_v = -1.0 1/s is out of range: it must be finite and at least 0"
    if master == "ecos":
        assert not run_in(master, file, 4 * STEP)["drive.x_motor"].any()
        assert reason in capsys.readouterr().err
    else:
        with pytest.raises(MasterError, match=re.escape(reason)):
            run_in(master, file, 4 * STEP)


def test_the_file_is_a_valid_ssp_with_the_same_numbers_in_both_places(axis_file: Path) -> None:
    wires = read_ssd(str(axis_file), validate=True).system.connections
    read_ssv(str(axis_file), "parameters.ssv", validate=True)
    assert {(f"{each.startElement}.{each.startConnector}", each.endElement) for each in wires} == {
        ("drive.v", "table"), ("table.F", "drive"), ("table.x", "drive")
    }  # fmt: skip
    assert all(each.startConnector == each.endConnector for each in wires)
    with zipfile.ZipFile(axis_file) as archive:
        system = ElementTree.fromstring(archive.read("parameters.ssv"))
        structure = ElementTree.fromstring(archive.read("SystemStructure.ssd"))
    inside = {
        f"{component.get('name')}.{name}": value
        for component in structure.iter()
        if component.tag.endswith("}Component")
        for name, value in parameters(component).items()
    }
    assert inside == parameters(system)
    assert inside.pop("drive.on_table") == ("Integer", "1")
    # libcosim drops a Real that is written as an Integer.
    assert {kind for kind, _ in inside.values()} == {"Real"}


def parameters(tree: ElementTree.Element) -> dict[str, tuple[str, str]]:
    return {
        str(each.get("name")): (each[0].tag.removeprefix(SSV), str(each[0].get("value")))
        for each in tree.iter(f"{SSV}Parameter")
    }
