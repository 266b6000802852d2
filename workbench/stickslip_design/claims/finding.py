"""What came out when a claim was tried: a verdict, a sentence, a table and a plot, as data."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Literal

# Enough for any plot, and few enough that no rounding of a library function is seen in them.
_PLOTTED_DIGITS = 6


@dataclass(frozen=True)
class Series:
    """One line or one cloud of points of a plot.

    Attributes
    ----------
    name
        What the reader is told it is; stands beside it at `name_at`.
    x, y
        Its points, in the units of the panel's axes.
    kind
        How it is drawn.
    colour
        Which colour of the palette, from 0; -1 is grey.
    name_at
        Where the name begins, in the units of the axes; None leaves it out of the plot.
    """

    name: str
    x: tuple[float, ...]
    y: tuple[float, ...]
    kind: Literal["line", "dashed", "points"] = "line"
    colour: int = 0
    name_at: tuple[float, float] | None = None


def mark(name: str, x: float, y: float, name_at: tuple[float, float]) -> Series:
    """Return a single point of a plot, with its name beside it at `name_at`."""
    return Series(name, plotted([x]), plotted([y]), kind="points", name_at=name_at)


@dataclass(frozen=True)
class Axis:
    """One axis: its label with the unit, its range and whether it is logarithmic."""

    label: str
    low: float
    high: float
    log: bool = False
    ticks: tuple[float, ...] = ()


@dataclass(frozen=True)
class Panel:
    """One pair of axes with its series; the title is empty where there is one panel only."""

    x: Axis
    y: Axis
    series: tuple[Series, ...]
    title: str = ""


@dataclass(frozen=True)
class Finding:
    """What came out when a claim was tried.

    Attributes
    ----------
    id, title
        Short name (also of the plot file) and heading.
    claim, formula
        What designers are told, in words and as a formula in the symbols of docs/theory.md.
    source
        Where it stands, and its equation in docs/theory.md.
    block
        The block that it was tried on, as far as the grid does not vary it.
    verdict
        A few words: whether it holds, and where.
    sentence
        The verdict with its numbers.
    header, rows
        A table of rounded figures.
    panels
        The plot.
    """

    id: str
    title: str
    claim: str
    formula: str
    source: str
    block: str
    verdict: str
    sentence: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    panels: tuple[Panel, ...]


def plotted(values: Iterable[Any]) -> tuple[float, ...]:
    """Return numbers (high-precision ones too) as they are drawn, to six digits."""
    return tuple(float(f"{float(value):.{_PLOTTED_DIGITS}g}") for value in values)
