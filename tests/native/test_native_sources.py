"""The C sources in the native FMU: an importer compiles them to an FMU that works."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.build import build_platform_binary

from tests.needs import needs

WITHOUT_CXX = {"CMAKE_CXX_COMPILER:FILEPATH": "cc", "CMAKE_CXX_COMPILER_WORKS:BOOL": "ON"}
"""CMake asks for a compiler of C++, which nothing here is compiled with."""


@needs("cc")
def test_fmpy_compiles_the_sources(
    either_native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The FMU without libraries runs when FMPy has compiled it, and gives the same motion."""
    # CMake comes with FMPy, and its program lies beside Python's.
    monkeypatch.setenv("PATH", os.pathsep.join([str(Path(sys.executable).parent), os.defpath]))
    folder = tmp_path / "unpacked"
    with zipfile.ZipFile(either_native) as archive:
        archive.extractall(folder)
    (library,) = folder.glob("binaries/*/*")
    shutil.rmtree(folder / "binaries")
    work = tmp_path / "work"
    work.mkdir()
    build_platform_binary(folder, work, cmake_options=WITHOUT_CXX)
    assert library.exists()
    compiled = fmpy.simulate_fmu(str(folder), stop_time=10.0, start_values={"c": 2.0})
    packed = fmpy.simulate_fmu(str(either_native), stop_time=10.0, start_values={"c": 2.0})
    assert packed["n_slips"][-1] > 20
    for name in packed.dtype.names:
        # FMPy's compiler options are not ours: products may be rounded otherwise.
        scale = np.max(np.abs(packed[name])) or 1.0
        np.testing.assert_allclose(compiled[name], packed[name], rtol=0.0, atol=1e-11 * scale)


@needs("cc")
def test_the_sources_compile_without_a_warning(either_native: Path, tmp_path: Path) -> None:
    """As C99, in one folder, by the compiler's strictest options."""
    folder = tmp_path / "sources"
    with zipfile.ZipFile(either_native) as archive:
        names = [name for name in archive.namelist() if name.startswith("sources/")]
        archive.extractall(tmp_path, names)
    strict = ["-std=c99", "-pedantic-errors", "-Werror", "-Wall", "-Wextra", "-Wconversion"]
    command = ["cc", *strict, "-Wdouble-promotion", "-fanalyzer", "-O2", "-c", "-o", os.devnull]
    for file in sorted(folder.glob("*.c")):
        done = subprocess.run([*command, file], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
