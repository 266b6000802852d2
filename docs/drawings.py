"""Compares the pictures of the site with what the code draws."""

import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from stickslip_verification.report.svg import BASE

SAME: Final = 2.5 * float(BASE["path.simplify_threshold"])
"""Distance [pt] up to which two lines are the same: each may be thinned to other points."""

_PLACES: Final = {"d", "x", "y", "width", "height", "viewBox", "transform"}
_NAMES: Final = {"id", "clip-path", "{http://www.w3.org/1999/xlink}href"}
"""Attributes that are lengths, and those that count or digest what they name."""

_NUMBER: Final = re.compile(r"-?\d+(?:\.\d+)?")

Points = NDArray[np.float64]


def differences(file: Path, drawn: str, same: float = SAME) -> list[str]:
    """Return in words whether a file shows something else than a drawing, both of `as_svg`.

    Elements, texts and colours are compared as they stand; lines by their distance and all other
    places by theirs. What is not further off than `same` [pt] is the same.
    """
    if not file.is_file():
        return [f"{file} is missing"]
    old, new = (list(ET.fromstring(text).iter()) for text in (file.read_text("utf-8"), drawn))
    if [_look(element) for element in old] != [_look(element) for element in new]:
        return [f"{file} shows other texts, colours or lines"]
    off = max(max(_off(one, other)) for one, other in zip(old, new, strict=True))
    return [f"{file} is off by {off:.2g} pt"] if off > same else []


def _look(element: ET.Element) -> tuple[Any, ...]:
    """Return all of an element but its place and its name."""
    rest = {key: element.attrib[key] for key in element.attrib.keys() - _PLACES - _NAMES}
    return element.tag, (element.text or "").strip(), rest


def _off(old: ET.Element, new: ET.Element) -> Iterator[float]:
    """Yield by how much the places of an element differ [pt]."""
    yield 0.0
    for key in (old.attrib.keys() | new.attrib.keys()) & _PLACES:
        one, other = (
            np.array(_NUMBER.findall(element.get(key, "")), dtype=np.float64)
            for element in (old, new)
        )
        if key == "d" and len(one) and len(other):
            line, line_too = one.reshape(-1, 2), other.reshape(-1, 2)
            yield max(_away(line, line_too), _away(line_too, line))
        else:
            yield float(np.max(np.abs(one - other))) if len(one) == len(other) else np.inf


def _away(points: Points, line: Points) -> float:
    """Return the largest distance of points from a line through others, both of shape (n, 2)."""
    start = line[:-1] if len(line) > 1 else line
    along = np.diff(line, axis=0) if len(line) > 1 else np.zeros_like(line)
    length = np.maximum(np.sum(along**2, axis=1), np.finfo(float).tiny)
    from_start = points[:, np.newaxis] - start
    share = np.clip(np.sum(from_start * along, axis=2) / length, 0.0, 1.0)
    off = from_start - share[:, :, np.newaxis] * along
    return float(np.max(np.min(np.hypot(off[..., 0], off[..., 1]), axis=1)))
