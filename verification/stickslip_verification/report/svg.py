"""Figures as the SVG that matplotlib writes: a file, and a part of a page."""

from __future__ import annotations

import html
import io
import re
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_FIGURES: Final = tomllib.loads(Path(__file__).with_name("figures.toml").read_text("utf-8"))
BASE: Final[dict[str, Any]] = _FIGURES["base"]
"""Part of the style of every figure."""
_COLOURS: Final[dict[str, str]] = _FIGURES["colours"]
INK, GREY, SOFT, BLUE, ORANGE = _COLOURS.values()
STYLE: Final[Any] = BASE | {n: _COLOURS.get(v, v) for n, v in _FIGURES["style"].items()}
"""The style of figures in reports."""


def as_svg(figure: Figure, **metadata: str) -> str:
    """Return a figure as the text of an SVG file, without a date."""
    text = io.StringIO()
    nothing = dict.fromkeys(("Creator", "Date", "Format", "Type"))
    figure.savefig(text, format="svg", metadata=nothing | metadata)
    # The points of a line stand in one line of text.
    return text.getvalue().replace(" \n", " ")


def as_part(figure: Figure, name: str, title: str) -> str:
    """Return a figure as a part of a page: `name` is its id, `title` what a screen reader says."""
    drawn = as_svg(figure)
    view = re.findall('viewBox="[^"]*"', drawn)[0]
    body = drawn[drawn.index(">", drawn.index("<svg")) + 1 :]
    # Another figure in the page has the same ids.
    body = re.sub(r'(\bid="|href="#|url\(#)', rf"\g<1>{name}-", body)
    return f'<svg id="{name}" {view} role="img" aria-label="{html.escape(title)}">{body}'
