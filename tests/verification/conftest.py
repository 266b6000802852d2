"""What the tests of the verification share: an FMU that is not ours."""

from pathlib import Path

import pytest
from pythonfmu.builder import FmuBuilder

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


@pytest.fixture(scope="session")
def foreign_fmu(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return an FMU that is not ours: one parameter, one output."""
    folder = tmp_path_factory.mktemp("foreign")
    (folder / "foreign.py").write_text(FOREIGN, encoding="utf-8")
    return Path(FmuBuilder.build_FMU(folder / "foreign.py", dest=folder))
