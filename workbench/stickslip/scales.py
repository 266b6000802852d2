"""What a person can read: units in which a value is neither tiny nor huge, tables that fit."""

from collections.abc import Sequence
from typing import Final, NamedTuple, TypeAlias

from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.measure import Measurement
from rich.segment import Segment


class Scale(NamedTuple):
    """A unit to show values in: its size in SI and its symbol."""

    size: float
    symbol: str


Scales: TypeAlias = Sequence[Scale]
"""Scales of one dimension, the largest unit first."""


def _ladder(*steps: tuple[float, str]) -> tuple[Scale, ...]:
    return tuple(Scale(*step) for step in steps)


LENGTHS: Final = _ladder((1.0, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm"))
FORCES: Final = _ladder((1e6, "MN"), (1e3, "kN"), (1.0, "N"), (1e-3, "mN"), (1e-6, "µN"))
TIMES: Final = _ladder((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns"))
FREQUENCIES: Final = _ladder((1e6, "MHz"), (1e3, "kHz"), (1.0, "Hz"), (1e-3, "mHz"))
VELOCITIES: Final = _ladder((1.0, "m/s"), (1e-3, "mm/s"), (1e-6, "µm/s"))
STIFFNESSES: Final = _ladder((1e6, "N/µm"), (1e3, "kN/m"), (1.0, "N/m"))


def scale_for(value: float, scales: Scales, enough: float = 1.0) -> Scale:
    """Choose the largest unit of which `value` has at least `enough`; else the smallest.

    Parameters
    ----------
    value
        The value to show, or the largest of many, SI; its sign does not count.
    scales
        The units to choose from, largest first. A value of 0 takes the one of size 1.
    enough
        How many of the unit `value` must hold.
    """
    if value == 0.0:
        return next(scale for scale in scales if scale.size == 1.0)
    return next((scale for scale in scales if abs(value) >= enough * scale.size), scales[-1])


class Fitted:
    """A table in the fullest form that fits the line, with notes below and no blanks at line ends.

    Parameters
    ----------
    forms
        The same table, the widest first. The last one is taken where none fits.
    notes
        What stands below the table.
    """

    def __init__(self, forms: Sequence[RenderableType], *notes: RenderableType) -> None:
        self._forms, self._notes = forms, notes

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        unbound = options.update(max_width=_UNBOUND)
        fitting = (
            form
            for form in self._forms
            if Measurement.get(console, unbound, form).maximum <= options.max_width
        )
        shown = Group(next(fitting, self._forms[-1]), *self._notes)
        for line in console.render_lines(shown, options, pad=False):
            yield from _without_blanks_at_the_end(line)
            yield Segment.line()


_UNBOUND: Final = 10_000


def _without_blanks_at_the_end(line: list[Segment]) -> list[Segment]:
    kept = list(line)
    while kept and not kept[-1].text.strip():
        kept.pop()
    if kept:
        text, style, control = kept[-1]
        kept[-1] = Segment(text.rstrip(), style, control)
    return kept
