"""The servo drive: set point, controller, and ServoDrive.fmu as an importer meets it."""

import ast
import json
import math
import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

from examples.feed_axis.axis import Axis
from examples.feed_axis.document import exact_axis
from examples.feed_axis.monolithic import solve
from examples.feed_axis.servo_drive.drive import Drive
from examples.feed_axis.servo_drive.model import ServoDrive
from examples.feed_axis.servo_drive.motion import Inertia, Place, Pull
from examples.feed_axis.servo_drive.setpoint import SetPoint
from examples.feed_axis.servo_drive.table import Settings
from fmukit.model import ModelError
from tests.python import python
from tests.test_architecture import imports_in, modules_of, newer_than_3_8

from .in_process import couple, make_drive
from .running import ROOT


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


def test_nothing_but_the_standard_library_and_pythonfmu_travels(
    fmus: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What stands in the FMU is Python 3.8, and imports itself, pythonfmu and Python's library."""
    with zipfile.ZipFile(fmus / "ServoDrive.fmu") as archive:
        archive.extractall(tmp_path)
    resources = tmp_path / "resources"
    (package,) = (each.name for each in resources.glob("servo_drive_*") if each.is_dir())
    assert {each.name for each in resources.iterdir()} == {
        package,
        f"{package}_slave.py",
        "pythonfmu",
        "slavemodule.txt",
    }
    monkeypatch.syspath_prepend(str(resources))
    files = modules_of(package)
    assert len(files) > 5
    allowed = {package, "pythonfmu", *sys.stdlib_module_names}
    for file in files:
        source = file.read_text(encoding="utf-8")
        assert not newer_than_3_8(source), file.name
        found = list(imports_in(file, ast.parse(source), package))
        assert not [str(each) for each in found if each.top not in allowed]


def test_two_builds_are_the_same_bytes(fmus: Path, tmp_path: Path) -> None:
    """Built again, by another process, the drive's FMU and the SSP file are the same bytes."""
    for folder in (tmp_path / "one", tmp_path / "two"):
        program = (
            "import pathlib, sys; from examples.feed_axis.axis import Axis; "
            "from examples.feed_axis.run import write_all; "
            "write_all(pathlib.Path(sys.argv[1]), Axis())"
        )
        subprocess.run([sys.executable, "-c", program, str(folder)], check=True, cwd=ROOT)
    for name in ("ServoDrive.fmu", "FeedAxis.ssp"):
        first, second = ((tmp_path / each / name).read_bytes() for each in ("one", "two"))
        assert first == second
        with zipfile.ZipFile(tmp_path / "one" / name) as archive:
            # No entry tells when it was made.
            assert {each.date_time for each in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
    built = (fmus / "ServoDrive.fmu").read_bytes()
    assert built == (tmp_path / "one/ServoDrive.fmu").read_bytes()


def test_the_drive_starts_as_the_axis_is(fmus: Path) -> None:
    """The start values of ServoDrive.fmu are the example's axis, to the last bit."""
    from fmpy import read_model_description

    description = read_model_description(str(fmus / "ServoDrive.fmu"))
    starts = {
        each.name: float(each.start)
        for each in description.modelVariables
        if each.causality == "parameter"
    }
    assert starts == Axis().of_drive()
    assert float(description.defaultExperiment.stepSize) == Axis().T_s


@pytest.mark.parametrize(("w", "d"), [(0.5, 0.0), (0.0, 0.5), (0.4, 0.18)])
def test_a_sample_as_long_as_may_be_is_solved(w: float, d: float) -> None:
    """At the bound T_s (delta + sqrt(delta^2 + w^2)) = 1/2 the motion is that of the matrix."""
    # Units in which T_s and the inertia are 1.
    k, r = w * w, 0.5 * d + math.hypot(0.5 * d, w)
    assert r == pytest.approx(0.5, abs=1e-15)
    place, pull = Place(0.25, -1.0, 1.5), Pull(1.5, 0.5, 0.75)
    # State: way, speed, time, 1; the table goes on at `speed`.
    rates = np.zeros((4, 4))
    rates[0, 1] = rates[2, 3] = 1.0
    rates[1] = -k, -d, k * pull.speed, pull.command - pull.at_zero
    start = np.array([place.x, place.v, 0.0, 1.0])
    first, second = (rates @ start)[1], (rates @ rates @ start)[1]
    found = Inertia(1.0, d, k, 0.0, 0.0).moved(1.0, place, pull)
    x, v, *_ = expm(rates) @ start
    # What the series leaves out; beside it the rounding of some numbers around 1.
    left_out = 4.1e-14 * max(abs(first), abs(second) / r)
    assert found.v == pytest.approx(v, abs=left_out + 1e-15)
    assert found.x == pytest.approx(x, abs=left_out + 1e-15)


def test_a_sample_too_long_for_the_motion_is_refused() -> None:
    """Beyond the bound, by spring or by friction, axis and drive name T_s, value and range."""
    usual = Axis()
    longest = 0.5 / math.sqrt(usual.k / usual.m_d)
    Axis(T_s=0.999 * longest, d=0.0)
    with pytest.raises(ValueError, match=r"T_s = .* at most 0\.00385 s with k = 4e\+07 N/m"):
        Axis(T_s=1.001 * longest, d=0.0)
    with pytest.raises(ValueError, match=r"T_s = 0\.00025 s is out of range.*d = 1e\+09"):
        Axis(d=1e9, follow=False)
    # A drive that holds the force has no resonance.
    assert Axis(k=1e12, follow=False).of_drive()["k"] == 0.0
    _, controller = make_drive(usual)
    with pytest.raises(ValueError, match=r"T_s = 0\.00025 s is out of range.*k = 1e\+12"):
        Drive(usual.m_d, 0.0, 1e12, usual.T_s, controller)
    for pitch in (1e-300, 1e300):
        with pytest.raises(ValueError, match=r"m_d = .* is out of range"):
            Axis(pitch=pitch)


@pytest.mark.parametrize(
    "changes",
    [
        {"K_v": 60.0, "distance": 1e-4},
        {
            "lag": 1e-4,
            "dead_time": 7e-4,
            "low_pass": 500.0,
            "low_pass_damping": 0.7,
            "notch": 200.0,
            "notch_damping": 0.4,
            "dry": 50.0,
        },
    ],
)
def test_a_state_of_the_drive_goes_on_to_the_bit(changes: dict[str, float]) -> None:
    """Set in another drive, or from plain data, a state gives the same outputs at every step."""

    def go_on(model: ServoDrive) -> list[tuple[float, ...]]:
        shown = []
        for step in range(1, 40):
            model.set("F", 10.0 * step)
            model.set("x", 1e-7 * step)
            model.advance(0.0, 1.7e-4 * step)
            shown.append((model.drive.output, model.drive.x, model.x_command, *model.drive.memory))
        return shown

    settings = Settings.at_start()
    for name, value in changes.items():
        settings = settings.changed(name, value)
    model = ServoDrive(settings)
    go_on(model)
    frozen, saved = model.freeze(), json.loads(json.dumps(model.save()))
    expected = go_on(model)
    assert go_on(model) != expected
    other = ServoDrive(Settings.at_start())
    other.thaw(frozen)
    assert go_on(other) == expected
    other = ServoDrive(Settings.at_start())
    other.restore(saved)
    assert go_on(other) == expected
    for bad in ({}, {**saved, "time": None}, {**saved, "memory": saved["memory"][1:]}):
        with pytest.raises(ModelError):
            other.restore(bad)


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

def too_long(slave):
    slave.setReal([references["k"]], [1e12])
    slave.enterInitializationMode()
    slave.exitInitializationMode()

def set_unreadable(slave):
    slave.setFMUstate(slave.deSerializeFMUstate(b"no state"))

calls = [
    set_unreadable,
    lambda slave: slave.getBoolean([0]),
    lambda slave: slave.setBoolean([0], [True]),
    lambda slave: slave.getString([0]),
    lambda slave: slave.setString([0], ["text"]),
    lambda slave: slave.getInteger([0]),
    lambda slave: slave.setInteger([0], [1]),
    lambda slave: slave.getReal([references["on_table"]]),
    lambda slave: slave.setReal([1000], [1.0]),
    too_long,
]
for call in calls:
    slave = fresh()
    for repeat in range(50):
        seen += fails(call, slave)
    slave.freeInstance()
print(seen)
"""


def test_hundreds_of_instances_and_a_thousand_refusals_leave_a_process_that_goes_on(
    fmus: Path,
) -> None:
    """Wrong values, types, references and states are refused with a reason; nothing crashes."""
    done = python("-I", "-c", HOST, fmus / "ServoDrive.fmu")
    assert done.stdout.split() == [str(7 * 100 + 10 * 50)]
    assert "the state to set is none that this FMU handed out" in done.stderr
    assert "T_s = 0.0 s is out of range: it must be finite and above 0" in done.stderr
    assert "K_v is fixed: it cannot change after initialization" in done.stderr
    assert "J is of type Real, not Boolean" in done.stderr
    assert "J is of type Real, not String" in done.stderr
    assert "J is of type Real, not Integer" in done.stderr
    assert "on_table is of type Integer, not Real" in done.stderr
    assert "there is no variable with value reference 1000" in done.stderr
    assert "T_s = 0.00025 s is out of range: it must be at most 2.43e-05 s" in done.stderr
    assert "internal error" not in done.stderr
