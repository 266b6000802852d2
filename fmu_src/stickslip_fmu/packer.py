"""Builds the FMU of the block under Coulomb's friction law, or under another one."""

from pathlib import Path
from typing import Literal, Mapping, Optional

from fmi import packer

from .laws.named import COULOMB_NAME, friction_law
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
    face: Literal[2, 3] = 2,
    law: str = COULOMB_NAME,
) -> Path:
    """Build the FMU.

    Parameters
    ----------
    destination
        The file to write, ending in .fmu, or the folder that gets StickSlip.fmu, and for FMI 3.0
        StickSlip_fmi3.fmu; with another friction law the name of its model stands for StickSlip.
        Folders are made. What was there stays until the new file is whole.
    parts
        Files that travel beside what is built here, such as documentation/index.html, by their
        path in the FMU.
    face
        The major version of FMI.
    law
        Name of a friction law, as `laws.named.friction_law` takes it.

    Returns
    -------
    Path
        The file that was written.

    Raises
    ------
    OSError
        If it cannot be written.
    ValueError
        If SOURCE_DATE_EPOCH is set to something else than whole seconds, the law is not found, its
        rows do not fit the table, its model is called StickSlip, or a module of it cannot travel.
    """
    main, model = MAIN, SPEC.name
    if law != COULOMB_NAME:
        named = friction_law(law)
        main = _MAIN_OF_LAW.format(module=named.module, name=named.name)
        model = named.law.interface.model
        if not model.isidentifier():
            raise ValueError(f"the model name {model!r} of {law!r} is no Python identifier")
        if model == SPEC.name:
            raise ValueError(f"the friction law {law!r} needs a model name other than {SPEC.name}")
    file_name = f"{model}.fmu" if face == 2 else f"{model}_fmi3.fmu"
    target = destination if destination.suffix == ".fmu" else destination / file_name
    return packer.build_fmu(main, target, "stickslip_fmu_", parts, face)
