"""What the command adds to a refusal: how to write a quantity, and what installs a package here."""

import re
import shlex
import sys
from collections.abc import Sequence
from importlib import metadata
from itertools import pairwise
from typing import Final

_INSTALL: Final = re.compile(r"pip install 'stickslip\[([\w-]+)\]'")


def advised(refusal: str, words: Sequence[str]) -> str:
    """Return a refusal with advice for the person who typed `words`."""
    return _INSTALL.sub(_line_of_extra, refusal) + _on_a_unit_apart(words)


def _on_a_unit_apart(words: Sequence[str]) -> str:
    """Say how to write a quantity whose unit the shell has made a word of its own."""
    from stickslip_verification import spelled

    for number, unit in pairwise(words):
        if number[-1:].isdigit() and unit != "1" and spelled(unit, all_below=True) is not None:
            return f"; number and unit must be one word: {number}{unit}, or '{number} {unit}'"
    return ""


def _line_of_extra(advice: re.Match[str]) -> str:
    """Return a line that installs an extra into this Python, wherever stickslip came from."""
    try:
        requirements = metadata.requires("stickslip") or []
    except metadata.PackageNotFoundError:
        return advice[0]
    extra = re.compile(rf"extra == (['\"]){advice[1]}\1")
    packages = [text.partition(";")[0].strip() for text in requirements if extra.search(text)]
    return shlex.join([sys.executable, "-m", "pip", "install", *packages])
