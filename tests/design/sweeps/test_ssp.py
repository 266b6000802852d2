"""Sweeps over systems: an SSP file's FMUs side by side, wired as it says."""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from examples.feed_axis.axis import Axis
from examples.feed_axis.coupling import simulate
from stickslip_design.sweeps import SweepError, read_model
from stickslip_design.sweeps.study import prepare, release
from tests.design.sweeps.test_runs import columns_of

STRUCTURE = "SystemStructure.ssd"
PLAN = {
    "stop_time": "50 ms",
    "step": "250 us",
    "parameters": {"table": {"k": ["30 N/um", "40 N/um"]}, "drive.feed": "2 mm/s"},
    "outputs": {"table.x": ["last", "max"], "drive.F_motor": "last", "drive.x_command": "last"},
}


def altered(ssp: Path, to: Path, change: Callable[[str], str]) -> Path:
    """Write a copy of an SSP file with another structure."""
    with zipfile.ZipFile(ssp) as old, zipfile.ZipFile(to, "w") as new:
        for entry in old.infolist():
            content = old.read(entry)
            if entry.filename == STRUCTURE:
                text = content.decode()
                assert change(text) != text
                content = change(text).encode()
            new.writestr(entry, content)
    return to


def test_a_system_moves_as_in_a_master_of_its_own(feed_axis: Path) -> None:
    """To the bit, in the two FMUs stepped side by side by the example's own loop."""
    study = prepare(feed_axis, PLAN)
    columns = study.compute(0, 2)
    release()
    assert columns["failure"].tolist() == ["", ""]
    for place, k in enumerate((3e7, 4e7)):
        # The stiffness that the drive is told is a parameter of its own.
        run = simulate(feed_axis.parent, _Axis(feed=2e-3, k_of_table=k), 0.05)
        assert columns["table.x"][place] == run["x"][-1]
        assert columns["table.x.max"][place] == np.max(run["x"])
        assert columns["drive.F_motor"][place] == run["F_motor"][-1]


@dataclass(frozen=True)
class _Axis(Axis):
    """The axis whose table has another stiffness than its drive is told."""

    k_of_table: float = 0.0

    def of_table(self) -> dict[str, float]:
        """Return the start values of the table."""
        return {**super().of_table(), "k": self.k_of_table}


def test_instances_of_a_system_are_reset_together(feed_axis: Path) -> None:
    """Results are equal to the bit with a new instance for each run."""
    study = prepare(feed_axis, {**PLAN, "stop_time": "5 ms"})
    without = prepare(feed_axis, {**PLAN, "stop_time": "5 ms", "reset": False})
    assert columns_of(study, 0, 2) == columns_of(without, 0, 2)


def test_values_of_the_file_hold_unless_the_plan_has_others(feed_axis: Path) -> None:
    """Its inline values and its parameters.ssv; the names are component.variable."""
    job = prepare(feed_axis, PLAN).job
    assert job.fixed["table.m"] == 500.0
    assert job.fixed["drive.feed"] == 2e-3
    assert "table.k" not in job.fixed
    assert [wire.input for wire in job.wires] == ["table.v", "drive.F", "drive.x"]


def test_points_are_read_in_their_units(feed_axis: Path, tmp_path: Path) -> None:
    """Under the name that a variable has in the system."""
    points = tmp_path / "points.csv"
    points.write_text("table.k [N/um], table.m [t]\n40, 0.5\n", encoding="utf-8")
    plan = {**PLAN, "parameters": {}, "points": str(points)}
    assert [each.tolist() for each in prepare(feed_axis, plan).values] == [[4e7], [500.0]]


CHAIN = """\
<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription version="1.0" name="Chain"
    xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"
    xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription">
  <ssd:System name="Chain">
    <ssd:Elements>
      <ssd:Component name="a" type="application/x-fmu-sharedlibrary" source="resources/a.fmu">
        <ssd:Connectors><ssd:Connector name="y" kind="output"><ssc:Real/></ssd:Connector>
        </ssd:Connectors>
      </ssd:Component>
      <ssd:System name="inner">
        <ssd:Connectors><ssd:Connector name="in" kind="input"><ssc:Real/></ssd:Connector>
        </ssd:Connectors>
        <ssd:Elements>
          <ssd:Component name="b" type="application/x-fmu-sharedlibrary" source="resources/a.fmu">
            <ssd:Connectors><ssd:Connector name="u" kind="input"><ssc:Real/></ssd:Connector>
            </ssd:Connectors>
          </ssd:Component>
        </ssd:Elements>
        <ssd:Connections>
          <ssd:Connection startElement="b" startConnector="u" endConnector="in">
            <ssc:LinearTransformation factor="10" offset="1"/>
          </ssd:Connection>
        </ssd:Connections>
      </ssd:System>
    </ssd:Elements>
    <ssd:Connections>
      <ssd:Connection startElement="a" startConnector="y" endElement="inner" endConnector="in">
        <ssc:LinearTransformation factor="2" offset="5"/>
      </ssd:Connection>
    </ssd:Connections>
  </ssd:System>
  <ssd:DefaultExperiment startTime="0" stopTime="1"/>
</ssd:SystemStructureDescription>
"""


def test_a_wire_carries_start_values_and_is_transformed(troubled: Path, tmp_path: Path) -> None:
    """Through a system inside the system: u = 10 (2 y + 5) + 1, from the start on."""
    file = tmp_path / "chain.ssp"
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr(STRUCTURE, CHAIN)
        archive.write(troubled, "resources/a.fmu")
    plan = {
        "step": 0.5,
        "parameters": {"a.y": [3.0, 4.0]},
        "inputs": {"a.u": 1.0},
        "outputs": {"inner.b.u_begun": "last", "inner.b.y": "last"},
    }
    study = prepare(file, plan)
    columns = study.compute(0, 2)
    release()
    assert columns["inner.b.u_begun"].tolist() == [111.0, 131.0]
    # b steps beside a, with what a gave at the beginning of each of two steps of 0.5 s.
    assert columns["inner.b.y"].tolist() == [0.5 * (111 + 121), 0.5 * (131 + 141)]


def test_a_system_knows_better_than_its_components(feed_axis: Path, tmp_path: Path) -> None:
    """A value in parameters.ssv, which is the system's, holds in place of the component's own."""
    value = '<ssv:Real value="40000000.0" />'
    file = altered(
        feed_axis, tmp_path / "other.ssp", lambda text: text.replace(value, value.replace("4", "7"))
    )
    assert read_model(file).bound["table.k"] == 4e7


ALONE = """\
<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription version="1.0" name="Alone"
    xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"
    xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription">
  <ssd:System name="Alone">
    <ssd:Elements>
      <ssd:Component name="a" type="application/x-fmu-sharedlibrary" source="resources/a.fmu">
        <ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>
          <ssv:ParameterSet version="1.0" name="p"><ssv:Parameters>
            <ssv:Parameter name="NAME">VALUE</ssv:Parameter>
          </ssv:Parameters></ssv:ParameterSet>
        </ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>
      </ssd:Component>
    </ssd:Elements>
  </ssd:System>
</ssd:SystemStructureDescription>
"""


def alone(fmu: Path, to: Path, name: str, value: str) -> Path:
    """Write an SSP file of one FMU and a value."""
    with zipfile.ZipFile(to, "w") as archive:
        archive.writestr(STRUCTURE, ALONE.replace("NAME", name).replace("VALUE", value))
        archive.write(fmu, "resources/a.fmu")
    return to


def test_a_value_of_the_file_has_its_unit(fmu_path: Path, tmp_path: Path) -> None:
    """It is taken in that of the variable."""
    for text, k in (("2", 2.0), ('2" unit="N/m', 2.0), ('2" unit="kN/m', 2000.0)):
        file = alone(fmu_path, tmp_path / "alone.ssp", "k", f'<ssv:Real value="{text}"/>')
        assert read_model(file).bound == {"a.k": k}


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("k", '<ssv:Real value="2" unit="m/s"/>', "its value of a.k has the unit 'm/s', which is"),
        ("F", '<ssv:Real value="2"/>', "gives a value to a.F, which is a continuous output, and"),
    ],
)
def test_a_value_that_the_file_cannot_give_is_refused(
    fmu_path: Path, tmp_path: Path, name: str, value: str, reason: str
) -> None:
    """By its unit, or as nobody can set it."""
    with pytest.raises(SweepError, match=reason):
        read_model(alone(fmu_path, tmp_path / "alone.ssp", name, value))


def test_a_value_of_the_file_is_one_of_its_type(troubled: Path, tmp_path: Path) -> None:
    """No fraction where the variable is an integer."""
    file = alone(troubled, tmp_path / "alone.ssp", "trouble", '<ssv:Real value="2.7"/>')
    with pytest.raises(SweepError, match=r"a\.trouble has 2\.7, and the variable is of type Int"):
        read_model(file)


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ('endConnector="x"', 'endConnector="y"', "drive has no connector y"),
        ('source="resources/StickSlip.fmu"', 'source="resources/a.fmu"', "has no file resources/a"),
        (' name="drive" type="application/x-fmu-sharedlibrary"', ' name="drive" type="text/x"',
         "the component drive is no FMU, but text/x"),
        ('name="k"', 'name="no_such"', "gives a value to table.no_such, which is no variable"),
        ("<ssd:System ", "<ssd:Systematics ", "not an SSP file ("),
    ],
)  # fmt: skip
def test_a_file_that_is_no_system_is_refused(
    feed_axis: Path, tmp_path: Path, old: str, new: str, reason: str
) -> None:
    """On one line with its name and the reason."""
    file = altered(feed_axis, tmp_path / "other.ssp", lambda text: text.replace(old, new, 1))
    with pytest.raises(SweepError) as refused:
        read_model(file)
    assert str(refused.value).startswith(f"{file}: {reason}")
    assert "\n" not in str(refused.value)


def test_what_another_component_drives_cannot_be_set(feed_axis: Path) -> None:
    """The refusal names what drives it."""
    with pytest.raises(SweepError, match=r"inputs\.table\.v is driven by drive\.v, and cannot"):
        prepare(feed_axis, {**PLAN, "inputs": {"table.v": 0.02}})
