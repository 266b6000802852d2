"""Builds the FMU of the block under Coulomb's friction law, or under another one."""

from pathlib import Path
from typing import Mapping, Optional

from fmi.packer import build_fmu

from .laws.named import COULOMB_NAME, friction_law
from .laws.native_only import NativeOnly, refusal
from .spec import SPEC

MAIN = "from stickslip_fmu.spec import SPEC"
"""What is packed for Coulomb's law: the text of a module that defines SPEC."""

_MAIN_OF_LAW = """\
from stickslip_fmu.spec import spec_of
from {module} import {name}

SPEC = spec_of({name})
"""


def build(
    destination: Path,
    parts: Optional[Mapping[str, bytes]] = None,
    law: str = COULOMB_NAME,
) -> Path:
    """Build the FMU and return its file.

    Parameters
    ----------
    destination, parts
        As of `fmi.packer.build_fmu`. In a folder the file has the name of the law's model, for
        Coulomb's law StickSlip.
    law
        Name of a friction law, as `laws.named.friction_law` takes it.

    Raises
    ------
    OSError
        If it cannot be written.
    ValueError
        If SOURCE_DATE_EPOCH is set to something else than whole seconds, the law is not found, its
        rows do not fit the table, its model is called StickSlip, it has a native FMU alone, or a
        module of it cannot travel.
    """
    main = MAIN
    if law != COULOMB_NAME:
        named = friction_law(law)
        main = _MAIN_OF_LAW.format(module=named.module, name=named.name)
        if isinstance(named.law, NativeOnly):
            raise ValueError(refusal(named.law))
        if named.law.interface.model == SPEC.name:
            raise ValueError(f"the friction law {law!r} needs a model name other than {SPEC.name}")
    return build_fmu(main, destination, "stickslip_fmu_", parts)
