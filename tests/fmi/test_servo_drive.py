"""A model that is not the block, the servo drive of the feed axis, as an FMU."""

import subprocess
import sys
from importlib.util import find_spec
from operator import attrgetter
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from fmi.packer import build_fmu
from tests.driver import Host, play
from tests.examples.coupled import servo
from tests.fmu.acts import printed_log
from tests.fmu.conformity import CHECKERS, by_fmpy, by_schema, description_of

MAIN = "from stickslip_drive.model import SPEC\n"
START = {"K_v": 60.0, "on_table": 0, "dead_time": 4e-4, "low_pass": 500.0}
OUTPUTS = {
    "v": "drive.output",
    "x_motor": "drive.x",
    "x_command": "x_command",
    "following_error": "controller.error",
    "F_motor": "drive.F_motor",
    "F_integral": "controller.integral",
}
"""Outputs, and the model's attributes that they show."""
STEPS = [(1e-3, 0.0), (1e-13, 0.0), (0.07, 2e3), (3e-4, -1e3), (0.25, 500.0), (0.0125, 0.0)]
"""Length [s] and spring force [N] of each step."""
FIRST, LATER = (
    [line for h, F in part for line in (["set", {"F": F}], ["step", h], ["get", *OUTPUTS])]
    for part in (STEPS[:3], STEPS[3:])
)


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_fmu(MAIN, tmp_path_factory.mktemp("drive") / "drive.fmu", "servo_drive_")


def driven(host: Host, fmu: Path, script: list[Any]) -> list[Any]:
    shown = host.call(play, fmu, [["start", START], *script])
    return [each for each in shown if each is not None]


def test_it_shows_the_bits_of_the_model(drive: Path, host: Host) -> None:
    model, expected = servo(START), []
    for h, F in STEPS:
        model.set("F", F)
        model.advance(0.0, h)
        expected.append(list(attrgetter(*OUTPUTS.values())(model)))
    assert driven(host, drive, FIRST + LATER) == expected


def test_a_state_and_its_bytes_repeat_the_motion_to_the_bit(drive: Path, host: Host) -> None:
    script = [*FIRST, ["save"], *LATER, ["restore"], ["rewrite"], *LATER]
    found = driven(host, drive, script)
    assert found[3:6] == found[6:]


def test_values_that_do_not_go_together_are_refused_in_the_models_own_words(
    drive: Path, host: Host
) -> None:
    host.errors()
    (found,) = host.call(play, drive, [["start", {"notch": 200.0}]])
    assert "notch_damping = 0.0 is out of range: above 0" in found["messages"][-1]
    assert "ServoDrive: notch_damping = 0.0 is out of range: above 0" in host.errors()


WARNING = "the drive is 20 % weaker than rated, 100 %s of it"
WARNS = f"""
class Warns(SPEC.model):
    def warning(self):
        return {WARNING!r}


SPEC = SPEC._replace(model=Warns)
"""


def test_a_percent_sign_in_a_warning_reaches_the_log(tmp_path: Path, host: Host) -> None:
    fmu = build_fmu(MAIN + WARNS, tmp_path / "w.fmu", "w_")
    assert WARNING in "".join(host.call(printed_log, fmu))
    assert WARNING in host.errors()


@pytest.mark.parametrize("checker", CHECKERS)
def test_checkers_find_nothing(drive: Path, checker: Any) -> None:
    assert checker(drive) == []


ALONE = f"""
import sys
from pathlib import Path
sys.path.insert(0, sys.argv[1])
from fmi.packer import build_fmu
for name in ("stickslip", "stickslip_fmu", "stickslip_ref", "numpy"):
    try:
        __import__(name)
    except ImportError:
        continue
    raise SystemExit(f"{{name}} can be imported")
build_fmu({MAIN!r}, Path(sys.argv[1], "ServoDrive.fmu"), "servo_drive_")
"""


@pytest.mark.gate
def test_fmi_packs_where_nothing_else_of_ours_is(tmp_path: Path, host: Host) -> None:
    for name in ("stickslip_drive", "fmi", "pythonfmu"):
        spec = find_spec(name)
        assert spec is not None
        (tmp_path / name).symlink_to(Path(spec.origin or "").parent, target_is_directory=True)
    # Neither the environment nor its site-packages: Python's library alone.
    command = [sys.executable, "-I", "-S", "-c", ALONE, str(tmp_path)]
    subprocess.run(command, check=True, cwd=tmp_path)
    assert len(driven(host, tmp_path / "ServoDrive.fmu", LATER)) == 3


NOTED = """
from fmi.model import Annotation

MASTER = Annotation("org.example.master", "Rate", {"unit": "Hz", "value": "100"})
PLOT = Annotation("org.example.plot", "Colour", {"name": "blue & \\"green\\" <"})
SPEC = SPEC._replace(annotations=(MASTER, PLOT))
"""


def test_annotations_of_a_model_stand_where_the_schema_has_them(tmp_path: Path) -> None:
    fmu = build_fmu(MAIN + NOTED, tmp_path / "Noted.fmu", "noted_")
    assert by_schema(fmu) == by_fmpy(fmu) == []
    found = ElementTree.fromstring(description_of(fmu)).findall("VendorAnnotations/Tool")
    assert [(each.get("name"), [(one.tag, one.attrib) for one in each]) for each in found] == [
        ("org.example.master", [("Rate", {"unit": "Hz", "value": "100"})]),
        ("org.example.plot", [("Colour", {"name": 'blue & "green" <'})]),
    ]
