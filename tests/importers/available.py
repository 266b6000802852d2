"""Whether an importer is installed: a test without it fails in CI, and is skipped elsewhere."""

from __future__ import annotations

import ctypes
import importlib.util
import os

import pytest

from stickslip.errors import CommandError
from tests.importers.running import needs

_PACKAGES = {
    "fmpy": "fmpy",
    "fmpy_container": "fmpy.container_fmu",
    "fmucontainer": "fmu_manipulation_toolbox",
    "libcosimpy": "libcosimpy",
    "ecospy": "ecospy",
    "proxyfmu": "ecospy",
}
_OF_ECOS = ("ecospy", "proxyfmu")


def need(importer: str) -> None:
    """Fail or skip the test that runs if an importer is missing; say what installs it."""
    lacking = _lacking(importer)
    if lacking is None:
        return
    reason = f"NOT TRIED IN {importer}: {lacking}"
    if os.environ.get("CI"):
        pytest.fail(reason)
    pytest.skip(reason)


def _lacking(importer: str) -> str | None:
    if importlib.util.find_spec(_PACKAGES[importer]) is None:
        return f"no package {_PACKAGES[importer]}. Needed: pip install '.[importers]'."
    if importer in _OF_ECOS:
        try:
            ctypes.CDLL("libtbb.so.12")
        except OSError as error:
            return f"{error}. Needed (Debian): apt-get install libtbb12."
    try:
        needs(importer)
    except CommandError as error:
        return str(error)
    return None
