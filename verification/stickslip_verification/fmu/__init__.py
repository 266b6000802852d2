"""Anybody's FMU as a file: its archive, its variables by our names, its instances in SI.

`FmuFile` opens an FMU 2.0 or 3.0 for co-simulation, `load_names` reads the map from our names to
its names. What stands here is resolved when it is first used, so that importing costs nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from stickslip_verification.lazy import face

if TYPE_CHECKING:
    from stickslip_verification.fmu.archive import REQUIRED, FmuFile, available, missing, require
    from stickslip_verification.fmu.digest import content_digest
    from stickslip_verification.fmu.errors import FmuError
    from stickslip_verification.fmu.hooks import Hook
    from stickslip_verification.fmu.instance import FmuInstance, State
    from stickslip_verification.fmu.names import NameMap, NamesError, load_names
    from stickslip_verification.fmu.unpacking import new_folder
    from stickslip_verification.fmu.variables import Variable

_HOME = {
    "REQUIRED": "archive",
    "FmuError": "errors",
    "FmuFile": "archive",
    "FmuInstance": "instance",
    "Hook": "hooks",
    "NameMap": "names",
    "NamesError": "names",
    "State": "instance",
    "Variable": "variables",
    "available": "archive",
    "content_digest": "digest",
    "load_names": "names",
    "missing": "archive",
    "new_folder": "unpacking",
    "require": "archive",
}

__all__ = [
    "REQUIRED",
    "FmuError",
    "FmuFile",
    "FmuInstance",
    "Hook",
    "NameMap",
    "NamesError",
    "State",
    "Variable",
    "available",
    "content_digest",
    "load_names",
    "missing",
    "new_folder",
    "require",
]

__getattr__, __dir__ = face(__name__, _HOME)
