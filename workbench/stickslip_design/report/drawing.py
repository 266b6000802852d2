"""The picture of an axis: drive, spring, damper and table on its way, with their numbers."""

from __future__ import annotations

from math import nan
from typing import Any, Final

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip_verification.report.svg import BLUE, INK, SOFT, STYLE

from ..verdict import Verdict, feed_in_words, in_its_units, judder
from .plots import LETTERS, NARROW
from .tables import numbers

_HEIGHT: Final = 132.0
"""Height of the picture; all places are in pt, from its lower left corner."""
_WAY: Final = [6.0, 246.0], [44.0, 44.0]
_SPRING: Final = (
    [62, 70, 74, 78, 82, 86, 90, 94, 98, 102, 106, 116],
    [70, 70, 75, 65, 75, 65, 75, 65, 75, 65, 70, 70],
)
_DAMPER: Final = (
    [180, 210, nan, 210, 210, nan, 200, 220, 220, 200, nan, 220, 240, nan, 240, 240],
    [70, 70, nan, 66, 74, nan, 76, 76, 64, 64, nan, 70, 70, nan, 44, 92],
)
_PULLED_END: Final = [62.0, 62.0], [52.0, 88.0]
_LINE: Final[Any] = {"color": INK, "lw": 1.3, "solid_capstyle": "round"}


@in_its_units
def sketch(verdict: Verdict) -> Figure:
    """Draw the axis with its numbers, and the slowest feed that judders, else that was asked for.

    A rigid drive is an end of the spring that is pulled.
    """
    fold = "\n" if verdict.axis.turns else " "
    axis, shown = verdict.axis, {name: value for name, value, _ in numbers(verdict.axis).rows}
    point = judder(verdict.points) or next(iter(verdict.points), None)
    with mpl.rc_context(STYLE):
        page = Figure(figsize=(NARROW, _HEIGHT / 72.0))
        on = page.add_axes((0.0, 0.0, 1.0, 1.0), xlim=(0.0, 72.0 * NARROW), ylim=(0.0, _HEIGHT))
        on.set_axis_off()
        for line in (_WAY, _SPRING, _DAMPER):
            on.plot(*line, **_LINE)
        on.fill_between(_WAY[0], 38.0, 44.0, lw=0.0, hatch="////", fc="w", ec=SOFT)
        mass = shown.get("axis.inertia" if axis.turns else "axis.mass", "")
        _box(on, 116.0, 180.0, 44.0, 96.0, f"table\n{mass}")
        if axis.drive is None:
            on.plot(*_PULLED_END, **_LINE | {"lw": 4.0})
            on.text(34.0, 70.0, "rigid\ndrive", ha="center", va="center", fontsize=LETTERS)
        else:
            _box(on, 8.0, 62.0, 53.0, 87.0, f"drive\n{shown.get('drive.inertia', '')}")
        tail = 62.0 if axis.drive is None else 116.0
        look: dict[str, Any] = {"arrowstyle": "-|>", "color": BLUE, "lw": 1.6, "shrinkA": 0}
        on.annotate("", (tail + 40.0, 108.0), (tail, 108.0), arrowprops=look)
        law = "" if axis.friction.law == "coulomb" else f" ({axis.friction.law})"
        static, kinetic = (shown.get(f"friction.mu_{which}", "–") for which in "sk")
        law += "" if axis.turns else f": static {static}, kinetic {kinetic}"
        (forces,) = (value for name, value in shown.items() if name.startswith("break-away"))
        for x, y, text in (
            (tail + 74.0, 105.0, feed_in_words(point.feed) if point else ""),
            (89.0, 81.0, shown.get("axis.stiffness", "").replace(" ", fold)),
            (210.0, 81.0, shown.get("axis.c", "").replace(" ", fold)),
            (126.0, 20.0, f"friction{law}"),
            (126.0, 6.0, f"breaks away at {forces.replace(', ', ', slides at ')}"),
        ):
            on.text(x, y, text, ha="center", fontsize=LETTERS)
    return page


def _box(on: Axes, left: float, right: float, low: float, high: float, text: str) -> None:
    on.fill([left, right, right, left], [low, low, high, high], fc="#eef2f6", ec=INK, lw=1.3)
    middle = 0.5 * (left + right), 0.5 * (low + high)
    on.text(*middle, text, ha="center", va="center", fontsize=LETTERS)
