"""Axis files as text: all keys with their meanings, and the axis of docs/feed-axis.md."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator
from typing import Final

from .keys import ANY, BY_SECTION, SECTIONS, Key, Section

_WIDTH: Final = 100
_NO_BREAK: Final = "\0"
_HEAD: Final = (
    'An axis, for `stickslip design`. Numbers carry their units, as text: "50 N/um", "5 mm/min", '
    '"60 kg cm2", "1.5 m/min/mm", "0.25 ms". '
)
_HOW: Final = (
    'Where [±] stands a number may have a tolerance: "50 N/um ± 5 N/um" or "50 N/um ± 10 %"; +- '
    "does as well. A key behind # may be left out: take the # away to state it."
)


def template() -> str:
    """Return an axis file with all keys; those that may be left out are commented out."""
    return "\n".join((*_comment(_HEAD + _HOW), *_sections(), ""))


def example() -> str:
    """Return the axis file of the axis of docs/feed-axis.md."""
    lines = list(_comment(_HEAD))
    for section in SECTIONS:
        keys = [key for key in BY_SECTION[section.name].values() if key.in_example]
        if keys:
            lines += ["", section.header, *(f"{key.name} = {key.example}" for key in keys)]
    return "\n".join((*lines, ""))


def _sections() -> Iterator[str]:
    for section in SECTIONS:
        yield ""
        yield from _comment(_about(section))
        mark = "# " if section.is_array else ""
        yield f"{mark}{section.header}"
        for key in BY_SECTION[section.name].values():
            yield from _comment(told(key))
            # What stands in place of another key would be refused beside it.
            is_stated = key.required and (key.in_example or not (key.unless or key.goes_with))
            yield f"{mark if is_stated else '# '}{key.name} = {key.example}"


def _about(section: Section) -> str:
    if section.required:
        return section.meaning
    return f"{section.meaning} Without it: {section.otherwise}."


def told(key: Key) -> str:
    """Return in a line what a key means, its range, and what is taken where it is not stated."""
    choices = ", ".join(f'"{choice}"' for choice in key.choices)
    within = "" if key.within == ANY else str(key.within)
    marks = ", ".join(filter(None, (choices, within, "±" if key.spread else "")))
    text = f"{key.meaning}{f' [{marks}]' if marks else ''}"
    if key.goes_with:
        text += f" With {key.needs} only."
    if key.taken:
        text += f" Without it: {key.taken}{f', {key.reason}' if key.reason else ''}."
    return text


def _comment(text: str) -> Iterator[str]:
    # What stands in quotes stays on a line.
    kept = re.sub(r'"[^"]*"', lambda quoted: quoted[0].replace(" ", _NO_BREAK), text)
    for line in textwrap.wrap(kept, _WIDTH - 2, break_long_words=False, break_on_hyphens=False):
        yield f"# {line.replace(_NO_BREAK, ' ')}"
