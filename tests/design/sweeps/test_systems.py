"""Sweeps over systems: an SSP file's FMUs side by side, wired as it says."""

import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from stickslip.systems import Move, start_values
from stickslip_design.axis import axis_file_of, example
from stickslip_design.sweeps.model import SweepError, read_model
from stickslip_design.sweeps.study import prepare
from tests.design.sweeps.test_runs import results
from tests.examples.coupled import simulate

STRUCTURE = "SystemStructure.ssd"
PLAN = {
    "stop_time": "20 ms", "step": "250 us",
    "parameters": {"table": {"m": ["450 kg", "0.5 t"]}, "drive.feed": "2 mm/s"},
    "outputs": {"table.x": ["last", "max"], "drive.F_motor": "last"},
}  # fmt: skip


def test_a_system_moves_to_the_bit_as_in_the_loop_of_the_example(feed_axis: Path) -> None:
    columns = results(feed_axis, PLAN)
    assert columns["failure"].tolist() == ["", ""]
    for place, m in enumerate((450.0, 500.0)):
        values = start_values(replace(axis_file_of(example()).axis(), m=m), Move(2e-3))
        run = simulate(feed_axis.parent, values, 0.02)
        assert columns["table.x"][place] == run["table.x"][-1]
        assert columns["table.x.max"][place] == np.max(run["table.x"])
        assert columns["drive.F_motor"][place] == run["drive.F_motor"][-1]


def test_values_of_the_file_hold_unless_the_plan_has_others(
    feed_axis: Path, tmp_path: Path
) -> None:
    study = prepare(feed_axis, PLAN)
    assert (study.fixed["table.k"], study.fixed["drive.feed"]) == (4e7, 2e-3)
    assert "table.m" not in study.fixed
    assert [wire.input for wire in study.model.wires] == ["table.v", "drive.F", "drive.x"]
    points = tmp_path / "points.csv"
    points.write_text("table.k [N/um], table.m [t]\n40, 0.5\n", encoding="utf-8")
    plan = {**PLAN, "parameters": {}, "points": str(points)}
    assert [each.tolist() for each in prepare(feed_axis, plan).values] == [[4e7], [500.0]]
    with pytest.raises(
        SweepError, match=r"inputs\.table\.v: table\.v is driven by drive\.v, and cannot"
    ):
        prepare(feed_axis, {**PLAN, "inputs": {"table.v": 0.02}})


COMMON = "http://ssp-standard.org/SSP1/SystemStructure"
FMU = 'type="application/x-fmu-sharedlibrary" source="resources/a.fmu"'
CHAIN = f"""\
<ssd:SystemStructureDescription version="1.0" name="S"
 xmlns:ssc="{COMMON}Common" xmlns:ssd="{COMMON}Description" xmlns:ssv="{COMMON}ParameterValues">
<ssd:System name="S"><ssd:Elements>
 <ssd:Component name="a" {FMU}><ssd:Connectors>
  <ssd:Connector name="y" kind="output"><ssc:Real/></ssd:Connector>
 </ssd:Connectors></ssd:Component>
 <ssd:System name="inner"><ssd:Connectors>
  <ssd:Connector name="in" kind="input"><ssc:Real/></ssd:Connector>
 </ssd:Connectors><ssd:Elements><ssd:Component name="b" {FMU}><ssd:Connectors>
  <ssd:Connector name="u" kind="input"><ssc:Real/></ssd:Connector>
 </ssd:Connectors></ssd:Component></ssd:Elements><ssd:Connections>
  <ssd:Connection startElement="b" startConnector="u" endConnector="in">
   <ssc:LinearTransformation factor="10" offset="1"/>
 </ssd:Connection></ssd:Connections></ssd:System>
</ssd:Elements><ssd:Connections>
 <ssd:Connection startElement="a" startConnector="y" endElement="inner" endConnector="in">
  <ssc:LinearTransformation factor="2" offset="5"/>
</ssd:Connection></ssd:Connections></ssd:System>
<ssd:DefaultExperiment startTime="0" stopTime="1"/></ssd:SystemStructureDescription>
"""


def test_wires_carry_start_values_and_scale_them_through_a_system_inside(
    troubled: Path, tmp_path: Path
) -> None:
    file = tmp_path / "chain.ssp"
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr(STRUCTURE, CHAIN)
        archive.write(troubled, "resources/a.fmu")
    plan = {
        "step": 0.5, "parameters": {"a.y": [3.0, 4.0]}, "inputs": {"a.u": 1.0},
        "outputs": {"inner.b.u_begun": "last", "inner.b.y": "last"},
    }  # fmt: skip
    columns = results(file, plan)
    # u = 10 (2 y + 5) + 1, from the start on.
    assert columns["inner.b.u_begun"].tolist() == [111.0, 131.0]
    # b steps beside a, with what a gave at the beginning of each of two steps of 0.5 s.
    assert columns["inner.b.y"].tolist() == [0.5 * (111 + 121), 0.5 * (131 + 141)]


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ('endConnector="x"', 'endConnector="y"', "drive.y is no variable"),
        ('source="resources/StickSlip.fmu"', 'source="resources/a.fmu"', "resources/a.fmu: no suc"),
        ('name="k"', 'name="no_such"', "table.no_such is no variable"),
        ("<ssd:System ", "<ssd:Systematics ", "not an SSP file ("),
        # A value of the system holds in place of the component's own.
        ('<ssv:Real value="40000000.0"', '<ssv:Real value="70000000.0"', None),
    ],
)  # fmt: skip
def test_a_file_that_is_no_system_is_refused_with_the_reason(
    feed_axis: Path, tmp_path: Path, old: str, new: str, reason: str | None
) -> None:
    file = tmp_path / "other.ssp"
    with zipfile.ZipFile(feed_axis) as source, zipfile.ZipFile(file, "w") as target:
        for entry in source.infolist():
            content = source.read(entry)
            if entry.filename == STRUCTURE:
                assert old.encode() in content
                content = content.replace(old.encode(), new.encode(), 1)
            target.writestr(entry, content)
    if reason is None:
        assert read_model(file).bound["table.k"] == 4e7
        return
    with pytest.raises(SweepError) as refused:
        read_model(file)
    assert str(refused.value).startswith(f"{file}: {reason}")
    assert "\n" not in str(refused.value)
