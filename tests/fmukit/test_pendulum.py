"""A pendulum, whose table and model stand in one file, as an FMU of both FMI versions."""

import json
import math
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Literal
from xml.etree import ElementTree

import fmpy
import pytest

from fmukit.packer import build_fmu
from tests.fmu.conformity import CHECKERS, by_fmpy, by_schema, description_of

from .grumbling import TOLD
from .swinging import STEPS

HERE = Path(__file__).parent
MAIN = "from tests.fmukit.pendulum import SPEC"


@pytest.fixture(scope="module", params=[2, 3])
def pendulum(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the pendulum's FMU."""
    face: Literal[2, 3] = request.param
    target = tmp_path_factory.mktemp("pendulum") / f"Pendulum{face}.fmu"
    return build_fmu(MAIN, target, "pendulum_", face=face)


def swung(fmu: Path, folder: Path) -> tuple[dict[str, Any], str]:
    """Return what the FMU gave in a process that knows the FMU alone, and standard error."""
    done = subprocess.run(
        [sys.executable, "-I", str(HERE / "swinging.py"), str(fmu)],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1]), done.stderr


@pytest.fixture(scope="module")
def run(pendulum: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], str]:
    """Return what `swung` returns of the pendulum's FMU."""
    return swung(pendulum, tmp_path_factory.mktemp("run"))


@pytest.mark.parametrize("face", [2, 3])
def test_a_percent_sign_in_a_warning_reaches_the_log(tmp_path: Path, face: Literal[2, 3]) -> None:
    """The wrapper of FMI 2.0 reads texts as formats; the process lives and the text is whole."""
    fmu = build_fmu("from tests.fmukit.grumbling import SPEC", tmp_path / "p.fmu", "p_", face=face)
    program = (
        "import fmpy, sys; fmpy.simulate_fmu(sys.argv[1], stop_time=0.1, debug_logging=True, "
        "logger=lambda *call: print(call[-1]))"
    )
    done = subprocess.run(
        [sys.executable, "-I", "-c", program, str(fmu)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert done.returncode == 0, done.stderr
    assert TOLD in done.stdout
    assert TOLD in done.stderr


def closed_form() -> list[tuple[float, float]]:
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
        found.append((phi, omega))
    return found


def test_it_swings_as_the_closed_form_says(run: tuple[dict[str, Any], str]) -> None:
    """Over steps of 1e-13 s to 2.5 s the FMU gives the exact motion."""
    given, _ = run
    for found, expected in zip(given["given"], closed_form(), strict=True):
        # Rounding of a few dozen operations on numbers below 5.
        assert found == pytest.approx(expected, abs=1e-14)


def test_its_states_and_their_bytes_go_on_to_the_bit(run: tuple[dict[str, Any], str]) -> None:
    """A state that is set, and one made of its bytes, repeat the motion exactly."""
    given, _ = run
    assert given["again"] == [given["given"][3:]] * 2


def test_values_that_do_not_go_together_are_refused_by_name(
    run: tuple[dict[str, Any], str],
) -> None:
    """The model's own words stand on standard error after the model's name."""
    given, said = run
    assert given["creeping"] == "refused"
    assert "Pendulum: d = 4.0 1/s is out of range: below sqrt(g/l)" in said


@pytest.mark.parametrize("checker", CHECKERS)
def test_checkers_find_nothing(pendulum: Path, checker: Any) -> None:
    """The XML schema, fmpy and fmutool have nothing to say of the FMU."""
    assert checker(pendulum) == []


ALONE = """
import sys
from pathlib import Path
sys.path.insert(0, sys.argv[1])
from fmukit.packer import build_fmu
for name in ("stickslip", "stickslip_fmu", "stickslip_ref", "numpy"):
    try:
        __import__(name)
    except ImportError:
        continue
    raise SystemExit(f"{name} can be imported")
build_fmu("from pendulum import SPEC", Path(sys.argv[1], "Pendulum.fmu"), "pendulum_")
"""


def test_the_kit_packs_where_nothing_else_of_ours_is(tmp_path: Path) -> None:
    """The kit, the wrappers and Python's library are enough to pack a model."""
    for name in ("fmukit", "pythonfmu", "pythonfmu3"):
        spec = find_spec(name)
        assert spec is not None
        (tmp_path / name).symlink_to(Path(spec.origin or "").parent, target_is_directory=True)
    (tmp_path / "pendulum.py").write_bytes((HERE / "pendulum.py").read_bytes())
    # Neither the environment nor its site-packages: Python's library alone.
    subprocess.run(
        [sys.executable, "-I", "-S", "-c", ALONE, str(tmp_path)], check=True, cwd=tmp_path
    )
    given, _ = swung(tmp_path / "Pendulum.fmu", tmp_path)
    assert given["again"] == [given["given"][3:]] * 2


NOTED = """
from fmukit.model import Annotation
from tests.fmukit.pendulum import SPEC as PENDULUM

MASTER = Annotation("org.example.master", "Rate", {"unit": "Hz", "value": "100"})
PLOT = Annotation("org.example.plot", "Colour", {"name": "blue & \\"green\\" <"})
SPEC = PENDULUM._replace(annotations=(MASTER, PLOT))
"""


@pytest.mark.parametrize(
    ("face", "path", "key"),
    [(2, "VendorAnnotations/Tool", "name"), (3, "Annotations/Annotation", "type")],
)
def test_a_model_may_have_annotations(
    tmp_path: Path, face: Literal[2, 3], path: str, key: str
) -> None:
    """They stand where the schema of either version has them, and say what was written."""
    fmu = build_fmu(NOTED, tmp_path / "Noted.fmu", "noted_", face=face)
    assert by_schema(fmu) == by_fmpy(fmu) == []
    found = ElementTree.fromstring(description_of(fmu)).findall(path)
    assert [(each.get(key), [(one.tag, one.attrib) for one in each]) for each in found] == [
        ("org.example.master", [("Rate", {"unit": "Hz", "value": "100"})]),
        ("org.example.plot", [("Colour", {"name": 'blue & "green" <'})]),
    ]


BUOYANT = """
from tests.fmukit.pendulum import SPEC as PENDULUM
from tests.fmukit.pendulum import Pendulum, Settings
from fmukit.table import Table
from water import BUOYANCY, DENSITY

TABLE = Settings.table


class Wet(Settings, table=Table(TABLE.units, [*TABLE.quantities.values(), DENSITY],
                                [*TABLE.rows, BUOYANCY])):
    pass


class Buoyant(Pendulum):
    pass


SPEC = PENDULUM._replace(name="Buoyant", values=Wet, model=Buoyant)
"""
WATER = """
from fmukit.table import Quantity, Variable

DENSITY = Quantity("Density", "Real", "Density")
BUOYANCY = Variable(6, "density", DENSITY, "parameter", "fixed", 1e3, "Density of the water")
"""


def test_a_model_may_be_put_together_in_the_main_text(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of modules from anywhere, with a name and last rows of its own."""
    (tmp_path / "water.py").write_text(WATER, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    fmu = build_fmu(BUOYANT, tmp_path / "Buoyant.fmu", "buoyant_")
    description = fmpy.read_model_description(str(fmu))
    assert (description.modelName, description.coSimulation.modelIdentifier) == ("Buoyant",) * 2
    assert description.modelVariables[-1].name == "density"
    given, said = swung(fmu, tmp_path)
    assert len(given["again"]) == 2
    assert "Buoyant: d = 4.0 1/s is out of range" in said
