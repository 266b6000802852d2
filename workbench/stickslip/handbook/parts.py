"""The files of the FMU that are there to be read, by their path in it."""

from collections.abc import Mapping
from typing import Literal

from stickslip.handbook.document import document, notes_on_references
from stickslip.handbook.icon import icon
from stickslip.handbook.licences import licences, licences_of_native
from stickslip.page import page
from stickslip_fmu.laws.named import BUILT_IN, COULOMB_NAME


def parts(
    fmi_version: Literal[2, 3] = 2,
    runtime: Mapping[str, tuple[str, bytes]] | None = None,
    law: str = COULOMB_NAME,
) -> dict[str, bytes]:
    """Return the files that a person finds in the FMU.

    Parameters
    ----------
    fmi_version
        2 or 3: the two standards keep licences and the icon in different places.
    runtime
        None for the Python FMU. For the native one, name, description and licence of each part of a
        compiler's runtime that is in its libraries.
    law
        The friction law. One that is not built in has no documentation; the interactive page and
        the notes on reference results are about Coulomb's law.

    Returns
    -------
    dict of bytes
        ``documentation/index.html`` and what it leads to, the icon, the licences.
    """
    found = _icon_and_licences(fmi_version, runtime)
    if law in BUILT_IN:
        text = document(fmi_version, native=runtime is not None, law=law)
        found["documentation/index.html"] = text.encode()
    if law == COULOMB_NAME:
        found["documentation/explore.html"] = page().encode()
        found["documentation/fmi-ls-ref.html"] = notes_on_references().encode()
    return found


def _icon_and_licences(
    fmi_version: Literal[2, 3], runtime: Mapping[str, tuple[str, bytes]] | None
) -> dict[str, bytes]:
    licence_folder, icon_file = (
        ("licenses", "model.png")
        if fmi_version == 2
        else ("documentation/licenses", "terminalsAndIcons/icon.png")
    )
    texts = licences(fmi_version) if runtime is None else licences_of_native(runtime)
    return {
        icon_file: icon(),
        **{f"{licence_folder}/{name}": text for name, text in texts.items()},
    }
