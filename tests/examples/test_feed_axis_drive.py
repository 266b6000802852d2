"""The servo drive: set point, controller, and ServoDrive.fmu as an importer meets it."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from examples.feed_axis import servo_drive
from examples.feed_axis.axis import Axis
from examples.feed_axis.document import exact_axis
from examples.feed_axis.monolithic import solve
from examples.feed_axis.servo_drive.setpoint import SetPoint
from tests.test_architecture import newer_than_3_8

from .in_process import couple, make_drive

SOURCES = sorted(Path(servo_drive.__file__).parent.glob("*.py"))


@pytest.mark.parametrize(
    ("set_point", "end"),
    [
        (SetPoint(5e-3, 0.1, 0.01), 0.01),
        (SetPoint(-5e-3, 0.1, 0.01), -0.01),
        # Too short to reach the feed.
        (SetPoint(5e-3, 0.1, 1e-4), 1e-4),
    ],
)
def test_a_move_is_the_integral_of_its_speed_and_ends_where_it_should(
    set_point: SetPoint, end: float
) -> None:
    """The commanded position is the integral of the commanded speed, and stays at its target."""
    t = np.linspace(0.0, 3.0, 30001)
    position, speed = np.array([set_point.at(time) for time in t]).T
    # The trapezoidal rule is exact but at the four corners, each off by a h^2 / 8 at most.
    integral = np.concatenate(([0.0], np.cumsum(0.5e-4 * (speed[1:] + speed[:-1]))))
    assert np.max(np.abs(integral - position)) < 4 * 0.1 * 1e-8 / 8 + 1e-15
    assert set_point.at(3.0) == (end, 0.0)
    assert np.max(np.abs(speed)) <= 5e-3 * (1 + 1e-15)
    assert np.max(np.abs(np.diff(speed))) <= 0.1 * 1e-4 * (1 + 1e-9)


def test_a_feed_goes_on_for_ever() -> None:
    """Without a distance the speed is reached and kept."""
    assert SetPoint(1e-3, 0.1, 0.0).at(1e4) == (1e-3 * (1e4 - 0.005), 1e-3)


def test_the_integral_does_not_wind_up_beyond_the_limit() -> None:
    """At the force limit the integral stands still; off the limit it goes on."""
    axis = Axis(F_max=500.0, mu_s=1.0, mu_k=0.9)
    drive, controller = make_drive(axis)
    for _ in range(4000):
        drive.advance(axis.T_s, 600.0, 0.0)
    assert abs(drive.F_motor) == 500.0
    assert abs(controller.integral) <= 500.0


def test_a_limited_force_is_limited_alike_in_the_whole_loop() -> None:
    """With a force limit that is met at every break-away, both solutions move alike."""
    axis = replace(exact_axis(), F_max=850.0)
    truth = solve(axis, 0.3)
    # Without the limit the force goes beyond it, so the limit is met.
    assert solve(exact_axis(), 0.3).column("F_motor", axis).max() > 850.0
    assert truth.column("F_motor", axis).max() == 850.0
    motion = couple(axis, [axis.T_s] * 1200)
    # A hundredth of a jump; the coupling's own error is smaller (docs/feed-axis.md).
    assert np.max(np.abs(np.array(motion.x) - truth.column("x", axis))) < 2e-7


def test_nothing_but_the_standard_library_and_pythonfmu_travels() -> None:
    """What stands in the FMU is Python 3.8."""
    assert len(SOURCES) > 5
    for file in SOURCES:
        assert not newer_than_3_8(file.read_text(encoding="utf-8")), file.name


def test_the_description_has_no_findings(fmus: Path) -> None:
    """Fmpy finds nothing wrong with the drive's model description; no output feeds through."""
    from fmpy import read_model_description
    from fmpy.validation import validate_fmu

    file = str(fmus / "ServoDrive.fmu")
    assert validate_fmu(file) == []
    description = read_model_description(file)
    assert not description.coSimulation.needsExecutionTool
    assert all(each.dependencies == [] for each in description.outputs)
    assert len(description.outputs) == 6
    assert all(each.unit for each in description.modelVariables if each.type == "Real")


HOST = """
import sys
import fmpy
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave

file = sys.argv[1]
description = fmpy.read_model_description(file)
references = {each.name: each.valueReference for each in description.modelVariables}
folder = fmpy.extract(file)

def fresh():
    slave = FMU2Slave(guid=description.guid, unzipDirectory=folder, instanceName="drive",
                      modelIdentifier=description.coSimulation.modelIdentifier)
    slave.instantiate()
    slave.setupExperiment(startTime=0.0)
    return slave

def fails(call, *arguments):
    try:
        call(*arguments)
    except FMICallException:
        return True
    return False

seen = 0
for round_ in range(100):
    slave = fresh()
    bad = {"T_s": 0.0, "K_v": -1.0, "F": float("nan"), "v": 1.0, "J": float("inf")}
    for name, value in bad.items():
        seen += fails(slave.setReal, [references[name]], [value])
    slave.freeInstance()
    slave = fresh()
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    seen += fails(slave.setReal, [references["K_v"]], [1.0])
    slave.freeInstance()
    slave = fresh()
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    slave.doStep(0.0, 0.00999999999999979)
    seen += slave.getReal([references["x_command"]])[0] > 0.0
    slave.terminate()
    slave.freeInstance()
print(seen)
"""


def test_three_hundred_instances_and_six_hundred_refusals_leave_a_process_that_goes_on(
    fmus: Path,
) -> None:
    """Bad values are refused with name and range, and neither they nor many instances crash."""
    done = subprocess.run(
        [sys.executable, "-I", "-c", HOST, str(fmus / "ServoDrive.fmu")],
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    assert done.stdout.split() == ["700"]
    assert "T_s = 0.0 s is out of range: it must be finite, above 0" in done.stderr
    assert "K_v is fixed: it cannot change after initialization" in done.stderr
    assert "internal error" not in done.stderr
