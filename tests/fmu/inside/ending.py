"""The end of a process whose simulator leaves the binary loaded and deletes the FMU's folder."""

import ctypes
import os
import shutil
import sys
from ctypes import byref
from typing import Any

import fmpy.fmi2

from tests.fmu.importer import Importer


def found_after_deletion(importer: Importer, _: Any) -> Any:
    """Return, for a URI with more slashes than it needs, by how many names the binary is found."""
    folder = importer.folder
    slave = fmpy.fmi2.FMU2Slave(
        guid=importer.description.guid,
        unzipDirectory=folder,
        modelIdentifier=importer.description.coSimulation.modelIdentifier,
    )
    callbacks = fmpy.fmi2.defaultCallbacks
    instance = slave.fmi2Instantiate(
        b"a",
        fmpy.fmi2.fmi2CoSimulation,
        importer.description.guid.encode(),
        f"file:///{folder}/resources".encode(),
        byref(callbacks),
        0,
        0,
    )
    slave.fmi2FreeInstance(instance)
    shutil.rmtree(folder)
    (lifetime,) = (
        module
        for name, module in sys.modules.items()
        if name.startswith("stickslip_fmu_") and name.endswith(".lifetime")
    )
    names = set().union(*lifetime._binaries.values())
    return sum(is_loaded(name) for name in names)


def is_loaded(name: str) -> bool:
    """Whether the loader has a library under this name."""
    try:
        ctypes.CDLL(name, mode=os.RTLD_NOLOAD)
    except OSError:
        return False
    return True
