"""The pendulum of CONTRIBUTING.md, whose parts make one file, as an FMU of both FMI versions."""

import math
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Literal
from xml.etree import ElementTree

import pytest

from fmi.packer import build_fmu
from tests.contributing import blocks, walk
from tests.driver import Host, play
from tests.fmu.acts import printed_log
from tests.fmu.conformity import CHECKERS, by_fmpy, by_schema, description_of

PENDULUM = "\n".join(blocks("A model of your own", "python"))
FACES: tuple[Literal[2, 3], ...] = (2, 3)
STEPS = [(0.01, 0.0), (1e-13, 0.0), (0.7, 2.0), (0.003, -1.0), (2.5, 0.5), (0.125, 0.0)]
"""Length [s] and push [rad/s2] of each step."""
FIRST, LATER = (
    [line for h, p in part for line in (["set", {"push": p}], ["step", h], ["get", "phi", "omega"])]
    for part in (STEPS[:3], STEPS[3:])
)


@pytest.fixture(params=FACES)
def face(request: pytest.FixtureRequest) -> Any:
    return request.param


@pytest.fixture(scope="module")
def pendulums(tmp_path_factory: pytest.TempPathFactory) -> dict[int, Path]:
    folder = tmp_path_factory.mktemp("pendulum")
    return {n: build_fmu(PENDULUM, folder / f"{n}.fmu", "pendulum_", face=n) for n in FACES}


def swung(host: Host, fmu: Path, script: list[Any]) -> list[Any]:
    start = ["start", {"l": 0.5, "d": 0.3, "phi_start": 0.2}]
    return [shown for shown in host.call(play, fmu, [start, *script]) if shown is not None]


def closed_form() -> list[list[float]]:
    """Return angle and angular velocity after each of STEPS, by the complex exponential."""
    stiffness, d = 9.81 / 0.5, 0.3
    rate = complex(-d, math.sqrt(stiffness - d * d))
    phi, omega, found = 0.2, 0.0, []
    for step, push in STEPS:
        rest = push / stiffness
        # phi - rest = 2 Re(C exp(rate t)), with C from the state at the start of the step.
        half = complex(0.5 * (phi - rest), -0.5 * (omega + d * (phi - rest)) / rate.imag)
        turned = half * (math.e ** (rate * step))
        phi, omega = rest + 2.0 * turned.real, 2.0 * (turned * rate).real
        found.append([phi, omega])
    return found


def test_it_swings_as_the_closed_form_says(
    pendulums: dict[int, Path], face: int, host: Host
) -> None:
    found = swung(host, pendulums[face], FIRST + LATER)
    for shown, expected in zip(found, closed_form(), strict=True):
        # Rounding of a few dozen operations on numbers below 5.
        assert shown == pytest.approx(expected, abs=1e-14)


def test_a_state_and_its_bytes_repeat_the_motion_to_the_bit(
    pendulums: dict[int, Path], face: int, host: Host
) -> None:
    script = [*FIRST, ["save"], *LATER, ["restore"], ["rewrite"], *LATER]
    found = swung(host, pendulums[face], script)
    assert found[3:6] == found[6:]


def test_values_that_do_not_go_together_are_refused_in_the_models_own_words(
    pendulums: dict[int, Path], face: int, host: Host
) -> None:
    host.errors()
    (found,) = host.call(play, pendulums[face], [["start", {"l": 1.0, "d": 4.0}]])
    assert "d = 4.0 1/s is out of range: below sqrt(g/l)" in found["messages"][-1]
    assert "Pendulum: d = 4.0 1/s is out of range: below sqrt(g/l)" in host.errors()


@pytest.mark.gate
def test_it_is_packed_checked_and_played_by_the_lines_of_contributing(tmp_path: Path) -> None:
    (tmp_path / "pendulum.py").write_text(PENDULUM, encoding="utf-8")
    (commands,) = blocks("A model of your own", "bash")
    assert "No problems found" in walk(commands, tmp_path)
    assert len((tmp_path / "swing.csv").read_text("utf-8").splitlines()) == 1002


TOLD = "swings are 20 % slower than rated, 100 %s of them"
GRUMBLING = f"""
class Grumbling(Pendulum):
    def warning(self):
        return {TOLD!r}


SPEC = SPEC._replace(model=Grumbling)
"""


def test_a_percent_sign_in_a_warning_reaches_the_log(
    tmp_path: Path, face: Literal[2, 3], host: Host
) -> None:
    fmu = build_fmu(PENDULUM + GRUMBLING, tmp_path / "p.fmu", "p_", face=face)
    assert TOLD in "".join(host.call(printed_log, fmu))
    assert TOLD in host.errors()


@pytest.mark.parametrize("checker", CHECKERS)
def test_checkers_find_nothing(pendulums: dict[int, Path], face: int, checker: Any) -> None:
    assert checker(pendulums[face]) == []


ALONE = """
import sys
from pathlib import Path
sys.path.insert(0, sys.argv[1])
from fmi.packer import build_fmu
for name in ("stickslip", "stickslip_fmu", "stickslip_ref", "numpy"):
    try:
        __import__(name)
    except ImportError:
        continue
    raise SystemExit(f"{name} can be imported")
build_fmu("from pendulum import SPEC", Path(sys.argv[1], "Pendulum.fmu"), "pendulum_")
"""


@pytest.mark.gate
def test_fmi_packs_where_nothing_else_of_ours_is(tmp_path: Path, host: Host) -> None:
    for name in ("fmi", "pythonfmu", "pythonfmu3"):
        spec = find_spec(name)
        assert spec is not None
        (tmp_path / name).symlink_to(Path(spec.origin or "").parent, target_is_directory=True)
    (tmp_path / "pendulum.py").write_text(PENDULUM, encoding="utf-8")
    # Neither the environment nor its site-packages: Python's library alone.
    command = [sys.executable, "-I", "-S", "-c", ALONE, str(tmp_path)]
    subprocess.run(command, check=True, cwd=tmp_path)
    assert len(swung(host, tmp_path / "Pendulum.fmu", LATER)) == 3


NOTED = """
from fmi.model import Annotation

MASTER = Annotation("org.example.master", "Rate", {"unit": "Hz", "value": "100"})
PLOT = Annotation("org.example.plot", "Colour", {"name": "blue & \\"green\\" <"})
SPEC = SPEC._replace(annotations=(MASTER, PLOT))
"""


@pytest.mark.parametrize(
    ("face", "path", "key"),
    [(2, "VendorAnnotations/Tool", "name"), (3, "Annotations/Annotation", "type")],
)
def test_annotations_of_a_model_stand_where_the_schema_has_them(
    tmp_path: Path, face: Literal[2, 3], path: str, key: str
) -> None:
    fmu = build_fmu(PENDULUM + NOTED, tmp_path / "Noted.fmu", "noted_", face=face)
    assert by_schema(fmu) == by_fmpy(fmu) == []
    found = ElementTree.fromstring(description_of(fmu)).findall(path)
    assert [(each.get(key), [(one.tag, one.attrib) for one in each]) for each in found] == [
        ("org.example.master", [("Rate", {"unit": "Hz", "value": "100"})]),
        ("org.example.plot", [("Colour", {"name": 'blue & "green" <'})]),
    ]
