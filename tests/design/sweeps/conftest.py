"""The models that the tests of sweeps share, built once."""

import shutil
from pathlib import Path

import pytest
from pythonfmu.builder import FmuBuilder

from examples.feed_axis.__main__ import build_all
from stickslip.systems import Move
from stickslip_design.axis import axis_file_of, example

HERE = Path(__file__).parent


@pytest.fixture(scope="session")
def troubled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("troubled")
    script = shutil.copy(HERE / "troubled.py", folder)
    return Path(FmuBuilder.build_FMU(Path(script), dest=folder))


@pytest.fixture(scope="session")
def feed_axis(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_all(
        tmp_path_factory.mktemp("feed_axis"), axis_file_of(example()).axis(), Move(5e-4)
    )
