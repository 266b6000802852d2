"""The manifest of the FMI layered standard FMI-LS-REF, draft 1.0.0-alpha.1."""

import hashlib
from collections.abc import Mapping
from typing import Final, NamedTuple
from xml.etree.ElementTree import Element, SubElement, register_namespace

from stickslip.handbook.evidence.xml_file import xml_file

FOLDER: Final = "extra/org.fmi-standard.fmi-ls-ref/"
MANIFEST: Final = "fmi-ls-manifest.xml"

_NAMESPACE: Final = "http://fmi-standard.org/fmi-ls-manifest"
_IDENTITY: Final = {
    "fmi-ls-name": "org.fmi-standard.fmi-ls-ref",
    "fmi-ls-version": "1.0.0-alpha.1",
    # The draft fixes these words.
    "fmi-ls-description": (
        "Layered Standard providing information on related files included in an FMU."
    ),
}


class Related(NamedTuple):
    """A file that belongs to the FMU: its media type, role and description."""

    type: str
    role: str
    description: str


def manifest(related: Mapping[str, Related], contents: Mapping[str, bytes]) -> bytes:
    """Return the manifest.

    Parameters
    ----------
    related
        What is told of each file, by its path from the manifest.
    contents
        Their contents by the same paths, of which it names the SHA3-256.
    """
    register_namespace("fmi-ls", _NAMESPACE)
    root = Element(
        "fmiReferences", {f"{{{_NAMESPACE}}}{name}": text for name, text in _IDENTITY.items()}
    )
    for source, told in related.items():
        SubElement(
            root,
            "Related",
            {
                "type": told.type,
                "source": source,
                "role": told.role,
                "description": told.description,
                "checksum": hashlib.sha3_256(contents[source]).hexdigest(),
                "checksumType": "SHA3-256",
            },
        )
    return xml_file(root)
