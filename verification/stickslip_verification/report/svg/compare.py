"""Two SVG files compared by what they draw."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from stickslip_verification.report.svg.line import SHAPE

SAME = 2.5 * SHAPE
"""Distance [pt] up to which two lines are the same, a 20th of a line's width: each may be off by
`SHAPE` from thinning, and by 0.007 pt from rounding."""

MOST_TOLD = 3
"""Differences of a file that are told one by one: another range moves everything."""

_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
_PLACES = ("transform", "x", "y", "width", "height", "viewBox")

Points = NDArray[np.float64]


def differences(file: Path, drawn: str, same: float = SAME) -> list[str]:
    """Return in words where a file shows something else than a drawing, both made by `as_svg`.

    Elements, texts and colours are compared as they stand; lines by their distance, because lines
    that are as good as equal may be thinned to other points; all other places by theirs. What is
    not further off than `same` [pt] is the same.
    """
    if not file.is_file():
        return [f"{file} is missing"]
    try:
        old = list(ET.parse(file).iter())
    except ET.ParseError as error:
        return [f"{file} is no SVG: {error}"]
    new = list(ET.fromstring(drawn).iter())
    if [each.tag for each in old] != [each.tag for each in new]:
        return [f"{file} has {len(old)} elements, and others than the {len(new)} drawn now"]
    found = [
        f"{file}, {one.tag.rpartition('}')[2]} {number}: {words}"
        for number, (one, other) in enumerate(zip(old, new, strict=True))
        for words in _of_element(one, other, same)
    ]
    if len(found) > MOST_TOLD:
        found[MOST_TOLD:] = [f"{file}: {len(found) - MOST_TOLD} more differences"]
    return found


def _of_element(old: ET.Element, new: ET.Element, same: float) -> Iterator[str]:
    for one, other in ((old.text, new.text), (old.tail, new.tail)):
        if (one or "").strip() != (other or "").strip():
            yield f"{one!r} is told, {other!r} is drawn now"
    if set(old.keys()) != set(new.keys()):
        yield f"{', '.join(old.keys())} are told, {', '.join(new.keys())} are drawn now"
        return
    for key, told in old.items():
        drawn = new.attrib[key]
        if key == "d":
            off = _distance(told, drawn)
        elif key in _PLACES:
            off = _shift(told, drawn)
        else:
            off = 0.0 if told == drawn else math.inf
        if math.isinf(off):
            yield f"{key} is {told[:40]}, now {drawn[:40]}"
        elif off > same:
            yield f"off by {off:.2g} pt"


def _shift(old: str, new: str) -> float:
    """Return the largest difference of two lists of lengths [pt]; infinite if all else differs."""
    (told, _, scale), (drawn, _, scale_too) = old.partition("scale"), new.partition("scale")
    if scale != scale_too or _NUMBER.sub("", told) != _NUMBER.sub("", drawn):
        return math.inf
    pairs = zip(_NUMBER.findall(told), _NUMBER.findall(drawn), strict=True)
    return max((abs(float(one) - float(other)) for one, other in pairs), default=0.0)


def _distance(old: str, new: str) -> float:
    """Return the largest distance of two paths [pt]; infinite if they are no comparable ones."""
    pieces, others = (text.split("M")[1:] for text in (old, new))
    if len(pieces) != len(others):
        return math.inf
    worst = 0.0
    for one, other in zip(pieces, others, strict=True):
        (line, shape), (line_too, shape_too) = _split(one), _split(other)
        if shape != shape_too:
            return math.inf
        worst = max(worst, _away(line, line_too), _away(line_too, line))
    return worst


def _split(piece: str) -> tuple[Points, str]:
    """Split a piece of a path into the points of its straight lines and what follows them."""
    lines, shape = re.fullmatch(r"([-\d.\sL]*)(.*)", piece, re.DOTALL).groups()  # type: ignore[union-attr]
    return np.array(lines.replace("L", " ").split(), dtype=np.float64).reshape(-1, 2), shape


def _away(points: Points, line: Points) -> float:
    """Return the largest distance of points from a line through others, both of shape (n, 2)."""
    start = line[:-1] if len(line) > 1 else line
    along = np.diff(line, axis=0) if len(line) > 1 else np.zeros_like(line)
    length = np.maximum(np.sum(along**2, axis=1), np.finfo(float).tiny)
    from_start = points[:, np.newaxis] - start
    share = np.clip(np.sum(from_start * along, axis=2) / length, 0.0, 1.0)
    off = from_start - share[:, :, np.newaxis] * along
    return float(np.max(np.min(np.hypot(off[..., 0], off[..., 1]), axis=1)))
