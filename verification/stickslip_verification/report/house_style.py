"""The look of every picture in the report."""

from __future__ import annotations

from typing import Any, Final

from stickslip_verification.report.svg import BASE

INK: Final = "#2b2f36"
GREY: Final = "#9aa1ab"
SOFT: Final = "#5d646e"
BLUE: Final = "#0072b2"
ORANGE: Final = "#d55e00"
"""Blue and vermillion of Okabe and Ito, told apart with every colour vision and in grey."""

STYLE: Final[Any] = BASE | {
    "font.size": 9.0,
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.unicode_minus": True,
    "grid.color": "#e6e9ed",
    "grid.linewidth": 0.6,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "legend.frameon": False,
}
