"""The contract that a model description names, in an annotation of the model.

FMI 2.0: ``VendorAnnotations/Tool`` with the type as its name; FMI 3.0: ``Annotations/Annotation``
with the type. The annotation holds one element, ``<Contract name="..." version="..."/>``.
"""

from dataclasses import dataclass
from typing import Final
from xml.etree.ElementTree import Element

ANNOTATION: Final = "org.stickslip.contract"
"""The type of the annotation."""

NAME, VERSION = "stickslip-exact", "1"
"""Name and version of the exact contract of this suite."""

_LETTERS: Final = 40

_PLACES: Final = (("VendorAnnotations/Tool", "name"), ("Annotations/Annotation", "type"))


@dataclass(frozen=True)
class StatedContract:
    """Whether a description names the exact contract of this suite, and what it names in words."""

    exact: bool
    told: str


def stated_contract(root: Element) -> StatedContract:
    """Read the contract from the root of a model description."""
    notes = [
        note for path, key in _PLACES for note in root.findall(path) if note.get(key) == ANNOTATION
    ]
    if not notes:
        return StatedContract(False, "its description names no contract of this suite")
    if len(notes) > 1:
        return StatedContract(False, f"its description has {len(notes)} annotations {ANNOTATION}")
    found = [(each.tag, each.get("name"), each.get("version")) for each in notes[0]]
    if len(found) != 1 or found[0][0] != "Contract" or None in found[0]:
        malformed = f"the annotation {ANNOTATION} of its description is malformed"
        return StatedContract(
            False, f'{malformed}: expected one element <Contract name="..." version="..."/>'
        )
    # What stands in an attribute, on one line and not endless.
    named = " ".join(" ".join(str(text).split())[:_LETTERS] for text in found[0][1:])
    told = f"its description names {named}"
    if found[0][1:] == (NAME, VERSION):
        return StatedContract(True, told)
    return StatedContract(False, f"{told}; this suite knows {NAME} {VERSION}")
