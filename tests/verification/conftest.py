"""What the tests of the verification share: FMUs that are not ours."""

from collections.abc import Callable
from pathlib import Path

import pytest
from pythonfmu.builder import FmuBuilder

from stickslip_verification.drive.fmu.names import NameMap, load_names
from tests.verification.foreign import building

FOREIGN = """\
from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class Foreign(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.k = 1.0
        self.z = 0.0
        self.register_variable(
            Real("k", causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable)
        )
        self.register_variable(Real("z", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        self.z += step_size
        return True
"""


# The outputs of the poor slider, and what they are to us.
POOR = {"slider.s": "x", "spring.force": "F"}


@pytest.fixture(scope="session")
def foreign_fmu(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return an FMU that is not ours: one parameter, one output."""
    folder = tmp_path_factory.mktemp("foreign")
    (folder / "foreign.py").write_text(FOREIGN, encoding="utf-8")
    return Path(FmuBuilder.build_FMU(folder / "foreign.py", dest=folder))


@pytest.fixture(scope="session")
def foreign_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder for foreign FMUs."""
    return tmp_path_factory.mktemp("foreign-fmus")


@pytest.fixture(scope="session")
def slider_mm(foreign_folder: Path) -> Path:
    """Return an honest slider: FMI 2.0, its own names, millimetres, undamped."""
    return building.build("slider_mm", foreign_folder)


@pytest.fixture(scope="session")
def slider_mm_names() -> NameMap:
    """Return the map to the names of `slider_mm` and `slider_faulty`."""
    return load_names(building.HERE / "slider_mm.toml")


@pytest.fixture(scope="session")
def slider_faulty(foreign_folder: Path) -> Path:
    """Return the slider in millimetres with a static friction that is 0.5 % too high."""
    return building.build("slider_mm", foreign_folder, "SliderFaulty", {"FAULT": "1.005"})


@pytest.fixture(scope="session")
def slider_si(foreign_folder: Path) -> Path:
    """Return an honest slider: FMI 3.0, its own names, SI, undamped, able to keep its state."""
    return building.build(
        "slider_si", foreign_folder, canGetAndSetFMUState=True, canSerializeFMUState=True
    )


@pytest.fixture(scope="session")
def slider_si_names() -> NameMap:
    """Return the map to the names of `slider_si`."""
    return load_names(building.HERE / "slider_si.toml")


@pytest.fixture(scope="session")
def slider_poor(slider_mm: Path, foreign_folder: Path) -> Path:
    """Return the slider in millimetres with position and spring force as its only outputs."""

    def poorer(description: str) -> str:
        outputs = building.outputs(description)
        return building.without(description, *(name for name in outputs if name not in POOR))

    return building.altered(slider_mm, foreign_folder / "SliderPoor.fmu", poorer)


@pytest.fixture(scope="session")
def slider_poor_names(slider_mm_names: NameMap) -> NameMap:
    """Return the map to the names of `slider_poor`."""
    left = {"m", "g", "k", "mu_s", "mu_k", "v", *POOR.values()}
    return NameMap({n: to for n, to in slider_mm_names.targets.items() if n in left})


@pytest.fixture(scope="session")
def model_exchange_fmu(slider_mm: Path, foreign_folder: Path) -> Path:
    """Return an FMU 2.0 for model exchange only."""
    to = foreign_folder / "ModelExchange.fmu"
    return building.altered(slider_mm, to, building.model_exchange_only)


@pytest.fixture(scope="session")
def misbehaving(foreign_folder: Path) -> Callable[[str], Path]:
    """Return what builds an FMU that does something on its third step.

    Its argument is crash (the whole process), hang (for ever), discard (the step), raise, eat (a
    gigabyte), print or log (a lot).
    """

    def build(what: str) -> Path:
        name = f"Does{what.capitalize()}"
        ready = foreign_folder / f"{name}.fmu"
        if ready.exists():
            return ready
        return building.build("misbehaving", foreign_folder, name, {"WHAT": repr(what)})

    return build
