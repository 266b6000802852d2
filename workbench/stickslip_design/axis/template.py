"""Axis files as text: all keys with their meanings, and the axis of docs/feed-axis.md."""

from __future__ import annotations

import re
import textwrap
from typing import Final

from .keys import BY_SECTION, SECTIONS, Key

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
    lines = _comment(_HEAD + _HOW)
    for section in SECTIONS.values():
        mark = "# " if section.is_array else ""
        without = f" Without it: {section.otherwise}." if section.otherwise else ""
        lines += ["", *_comment(section.meaning + without), f"{mark}{section.header}"]
        for key in BY_SECTION[section.name].values():
            # What stands in place of another key would be refused beside it.
            is_stated = key.required and (key.in_example or not (key.unless or key.goes_with))
            line = f"{mark if is_stated else '# '}{key.name} = {key.example}"
            lines += [*_comment(told(key)), line]
    return "\n".join((*lines, ""))


def example() -> str:
    """Return the axis file of the axis of docs/feed-axis.md."""
    lines = _comment(_HEAD)
    for section in SECTIONS.values():
        keys = [key for key in BY_SECTION[section.name].values() if key.in_example]
        if keys:
            lines += ["", section.header, *(f"{key.name} = {key.example}" for key in keys)]
    return "\n".join((*lines, ""))


def told(key: Key) -> str:
    """Return in a line what a key means, its range, and what is taken where it is not stated."""
    marks = f" [{', '.join(key.marks())}]" if key.marks() else ""
    needs = f" With {key.needs} only." if key.goes_with else ""
    taken = ", ".join(filter(None, (key.taken, key.reason)))
    return f"{key.meaning}{marks}{needs}" + (f" Without it: {taken}." if taken else "")


def _comment(text: str) -> list[str]:
    # What stands in quotes stays on a line.
    kept = re.sub(r'"[^"]*"', lambda quoted: quoted[0].replace(" ", _NO_BREAK), text)
    lines = textwrap.wrap(kept, _WIDTH - 2, break_long_words=False, break_on_hyphens=False)
    return [f"# {line.replace(_NO_BREAK, ' ')}" for line in lines]
