"""The picture of an axis: drive, spring, damper and table on its way, with their numbers."""

from __future__ import annotations

from typing import Any, Final

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip_verification.report.svg import BLUE, INK, SOFT, STYLE

from ..verdict import Verdict, feed_in_words, judder
from .plots import LETTERS, NARROW
from .tables import numbers

_HEIGHT: Final = 132.0
_WAY: Final = 44.0
"""Height of the picture, and of the way in it [pt]; all places below are in pt."""
_DRIVE, _TABLE, _WALL = (8.0, 62.0), (116.0, 180.0), 240.0
"""Left and right end of drive and table, and the wall that holds the damper."""
_AXIS: Final = 70.0
"""Height of the spring."""
_LINE: Final[Any] = {"color": INK, "lw": 1.3, "solid_capstyle": "round"}


def sketch(verdict: Verdict, width: float = NARROW) -> Figure:
    """Draw the axis with the numbers of its file, and the slowest feed that judders.

    If none judders the slowest feed asked for. A rigid drive is an end of the spring that is
    pulled. `width` is that of the picture [in].
    """
    axis, shown = verdict.axis, {name: value for name, value, _ in numbers(verdict.axis).rows}
    point = judder(verdict.points) or next(iter(verdict.points), None)
    feed = feed_in_words(point.feed) if point else "at a feed"
    with mpl.rc_context(STYLE):
        page = Figure(figsize=(width, _HEIGHT / 72.0))
        on = page.add_axes((0.0, 0.0, 1.0, 1.0), xlim=(0.0, 72.0 * width), ylim=(0.0, _HEIGHT))
        on.set_axis_off()
        on.fill_between([6.0, _WALL + 6.0], _WAY - 6.0, _WAY, lw=0.0, hatch="////", fc="w", ec=SOFT)
        on.plot([6.0, _WALL + 6.0], [_WAY] * 2, **_LINE)
        _box(on, *_TABLE, _WAY, 96.0, f"table\n{shown.get('axis.mass', '')}")
        if axis.drive is None:
            on.plot([_DRIVE[1]] * 2, [_AXIS - 18.0, _AXIS + 18.0], **_LINE | {"lw": 4.0})
            _label(on, 0.5 * sum(_DRIVE), _AXIS, "rigid\ndrive", va="center")
        else:
            _box(on, *_DRIVE, 53.0, 87.0, f"drive\n{shown.get('drive.inertia', '')}")
        arrow = _DRIVE[1] if axis.drive is None else _TABLE[0]
        on.annotate(
            "", (arrow + 40.0, 108.0), (arrow, 108.0),
            arrowprops={"arrowstyle": "-|>", "color": BLUE, "lw": 1.6, "shrinkA": 0, "shrinkB": 0},
        )  # fmt: skip
        _label(on, arrow + 46.0, 108.0, feed, ha="left", va="center")
        between = 0.5 * (_DRIVE[1] + _TABLE[0])
        _spring(on, _DRIVE[1], _TABLE[0])
        _label(on, between, _AXIS + 9.0, shown.get("axis.stiffness", ""))
        _damper(on, _TABLE[1], _WALL)
        _label(on, 0.5 * (_TABLE[1] + _WALL), _AXIS + 9.0, shown.get("axis.c", ""))
        static, kinetic = (shown.get(f"friction.mu_{which}", "–") for which in "sk")
        law = "" if axis.friction.law == "coulomb" else f" ({axis.friction.law})"
        forces = shown.get("break-away force, kinetic friction", "").split(", ")
        middle = 0.5 * (_WALL + 12.0)
        _label(on, middle, 20.0, f"friction{law}: static {static}, kinetic {kinetic}")
        _label(on, middle, 6.0, f"breaks away at {', slides at '.join(forces)}")
    return page


def _label(on: Axes, x: float, y: float, text: str, **look: Any) -> None:
    placed: dict[str, Any] = {"ha": "center", "va": "bottom", "fontsize": LETTERS}
    on.text(x, y, text, **placed | look)


def _box(on: Axes, left: float, right: float, low: float, high: float, text: str) -> None:
    on.fill([left, right, right, left], [low, low, high, high], fc="#eef2f6", ec=INK, lw=1.3)
    _label(on, 0.5 * (left + right), 0.5 * (low + high), text, va="center")


def _spring(on: Axes, left: float, right: float) -> None:
    coil = np.linspace(left + 8.0, right - 8.0, 10)
    side = 5.0 * np.array([0, 1, -1, 1, -1, 1, -1, 1, -1, 0])
    on.plot([left, *coil, right], [_AXIS, *(_AXIS + side), _AXIS], **_LINE)


def _damper(on: Axes, left: float, right: float) -> None:
    low, high, middle = _AXIS - 6.0, _AXIS + 6.0, 0.5 * (left + right)
    on.plot([left, middle], [_AXIS] * 2, **_LINE)
    on.plot([middle] * 2, [low + 2.0, high - 2.0], **_LINE)
    cup = middle - 10.0, middle + 10.0
    on.plot([cup[0], cup[1], cup[1], cup[0]], [high, high, low, low], **_LINE)
    on.plot([cup[1], right], [_AXIS] * 2, **_LINE)
    on.plot([right] * 2, [_WAY, _AXIS + 20.0], **_LINE | {"lw": 2.5})
