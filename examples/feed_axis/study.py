"""The study: what changes creeping and hunting, in numbers; its tables stand in the how-to."""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from stickslip_design.critical import jumps_of, rigid_critical_feed
from stickslip_design.loop.hunting import Hunting
from stickslip_design.loop.hunting import hunting as hunting_of
from stickslip_design.loop.jumps import jump_at, limit_of_jumps
from stickslip_design.loop.stability import is_stable

from .axis import Axis, critically_damped
from .coupling import Run, simulate
from .designed import designed
from .measure import creep, hunting

BASE: Final = Axis()

CREEP_TIME: Final = 2.0
RISING_TIME: Final = 3.0
"""Lengths of the runs [s]: of creeping at least 20 jumps in the half that is measured."""

HUNTING_TIME: Final = 20.0
RESTING_TIME: Final = 12.0
HUNTING_PERIODS: Final = 11
"""Lengths of the runs around a target [s], where hunting should go on and where it should not, and
how many computed periods the former hold at least. The half that is measured is the last: by then
the cycle has evened out, and 5 periods or more are in it."""

MOVE: Final[Mapping[str, Any]] = {"feed": 5e-3, "distance": 0.01}
"""A move of 10 mm at 5 mm/s, after which the axis holds its target."""


@dataclass(frozen=True)
class Variant:
    """One change to the axis: its name in the tables, and what is set."""

    name: str
    changes: Mapping[str, Any] = field(default_factory=dict)

    @property
    def axis(self) -> Axis:
        """The axis with the change."""
        return replace(BASE, **self.changes)


VARIANTS: Final = (
    Variant("as it is"),
    Variant("no velocity feed-forward", {"velocity_feedforward": 0.0}),
    Variant("friction feed-forward 736 N", {"friction_feedforward": BASE.F_k}),
    Variant("stiffer, k = 100 N/µm", {"k": 1e8}),
    Variant("smaller gap, µ_s = 0.16", {"mu_s": 0.16}),
    Variant("faster, 2 mm/s", {"feed": 2e-3}),
    Variant("position on the motor", {"on_table": False}),
    Variant("no integral", {"T_n": 0.0}),
    Variant("K_v = 50 1/s", {"K_v": 50.0}),
    Variant("velocity loop 600 1/s", {"omega_v": 600.0, "T_n": critically_damped(600.0)}),
    Variant("viscous, c = 16 kN s/m", {"c": 16e3}),
    Variant("dead band of 6 µm *", {"dead_band": 6e-6, "velocity_feedforward": 0.95}),
    Variant("dead band of 7 µm *", {"dead_band": 7e-6, "velocity_feedforward": 0.95}),
)

CREEPING: Final = tuple(each for each in VARIANTS if "dead_band" not in each.changes)
HUNTING: Final = tuple(each for each in VARIANTS if "feed" not in each.changes)

CREEP_HEAD: Final = (
    "variant",
    "jump [µm]",
    "design tool",
    "rigid drive",
    "period [ms]",
    "mean error [µm]",
    "uneven [µm rms]",
    "jumps up to [mm/s]",
    "design tool",
    "rigid drive",
)
HUNTING_HEAD: Final = (
    "variant",
    "comes to rest",
    "jump [µm]",
    "design tool [µm]",
    "period [s]",
    "design tool [s]",
    "error left [µm]",
)


@functools.lru_cache(maxsize=3 * len(VARIANTS))
def _simulated(folder: Path, axis: Axis, stop_time: float) -> Run:
    # The tables and the pictures show the same runs.
    return simulate(folder, axis, stop_time)


def creep_run(folder: Path, variant: Variant) -> Run:
    """Run an axis at constant feed."""
    return _simulated(folder, variant.axis, CREEP_TIME)


def hunting_run(folder: Path, variant: Variant) -> Run:
    """Run a move, and the hold after it, as long as `hunting_time` says."""
    return _simulated(folder, replace(variant.axis, **MOVE), hunting_time(variant.axis))


def hunting_time(axis: Axis) -> float:
    """Return how long to watch an axis around its target [s]."""
    expected = expected_hunting(axis)
    if expected is None:
        return RESTING_TIME
    return max(HUNTING_TIME, float(math.ceil(HUNTING_PERIODS * expected.period)))


def expected_hunting(axis: Axis) -> Hunting | None:
    """Return the cycle about a target by the design tool, None where the axis rests.

    None too for an unstable loop. The cycle is that without a dead band, as long as the dead band
    does not end it.
    """
    computed = designed(axis)
    found = hunting_of(computed) if is_stable(computed) else None
    return None if found is None or found.dead_band <= axis.dead_band else found


def creep_row(folder: Path, variant: Variant) -> list[str]:
    """Return the row of a variant in the table of creeping."""
    axis = variant.axis
    found = creep(creep_run(folder, variant))
    computed = designed(axis)
    rigid = replace(computed, drive=None)
    # Where it starts without jumping, the cycle that may exist beside is not shown.
    expected = jump_at(computed, axis.feed) if found.jumps else None
    jumps_of_rigid = jumps_of(rigid, axis.feed)
    return [
        variant.name,
        _number(found.jump * 1e6, 1),
        _number(expected.way * 1e6 if expected else math.nan, 1),
        _number(jumps_of_rigid.way * 1e6 if jumps_of_rigid else math.nan, 1),
        _number(found.period * 1e3, 1),
        _number(found.error * 1e6, 1),
        _number(found.unevenness * 1e6, 2),
        _number(highest_jumping_feed(rising_run(folder, axis)) * 1e3, 2),
        _number(limit_of_jumps(computed).feed * 1e3, 2),
        _number(rigid_critical_feed(rigid) * 1e3, 2),
    ]


def rising_run(folder: Path, axis: Axis) -> Run:
    """Run an axis whose feed rises evenly, to twice the feed at which jumping should end."""
    limit = limit_of_jumps(designed(axis)).feed
    changes = {"feed": 2.0 * limit, "acceleration": 2.0 * limit / RISING_TIME, "distance": 0.0}
    return _simulated(folder, replace(axis, **changes), RISING_TIME)  # type: ignore[arg-type]


def highest_jumping_feed(run: Run) -> float:
    """Return the feed [m/s] at the last jump of a run whose feed rises, NaN without one."""
    ends = np.flatnonzero(np.diff(run["delta_x"])) + 1
    if not len(ends):
        return math.nan
    return float(np.gradient(run["x_command"], run["time"])[ends[-1]])


def hunting_row(folder: Path, variant: Variant) -> list[str]:
    """Return the row of a variant in the table of hunting."""
    axis = variant.axis
    found = hunting(hunting_run(folder, variant))
    expected = None if found.stops else expected_hunting(axis)
    return [
        variant.name,
        "yes" if found.stops else "no",
        _number(found.jump * 1e6, 1),
        _number(expected.jump * 1e6 if expected else math.nan, 1),
        _number(found.period, 2),
        _number(expected.period if expected else math.nan, 2),
        _number(-found.offset * 1e6, 1) if found.stops else "",
    ]


def tables(
    folder: Path, tell: Callable[[str], None] = lambda _: None
) -> Iterator[tuple[str, list[str]]]:
    """Yield both tables as lines of Markdown, each with the name of its place in the how-to."""
    for name, head, variants, row in (
        ("creep", CREEP_HEAD, CREEPING, creep_row),
        ("hunting", HUNTING_HEAD, HUNTING, hunting_row),
    ):
        lines = [_line(head), "|---" * len(head) + "|"]
        for variant in variants:
            tell(f"{name}: {variant.name}")
            lines.append(_line(row(folder, variant)))
        yield name, lines


def with_tables(document: str, made: Mapping[str, list[str]]) -> str:
    """Return the how-to with these tables between their marks."""
    for name, lines in made.items():
        begin, end = f"<!-- table: {name} -->\n", "<!-- end of table -->"
        pattern = re.compile(f"({re.escape(begin)}).*?({re.escape(end)})", re.DOTALL)
        text = "\n".join(lines) + "\n"
        document, count = pattern.subn(_between(text), document)
        if count != 1:
            raise ValueError(f"the how-to has {count} places for the table {name}, not one")
    return document


def rows_of(document: str, name: str) -> dict[str, list[str]]:
    """Return the rows of a table in the how-to by their first cell."""
    _, _, rest = document.partition(f"<!-- table: {name} -->\n")
    table, _, _ = rest.partition("<!-- end of table -->")
    return rows_in(table.splitlines())


def rows_in(lines: list[str]) -> dict[str, list[str]]:
    """Return the rows of a table in Markdown by their first cell."""
    rows = [line.strip("|").split("|") for line in lines[2:]]
    return {cells[0].strip(): [cell.strip() for cell in cells] for cells in rows}


def differences(told: list[str], found: list[str], tolerance: float) -> list[str]:
    """Return the cells of a row that differ by more than a relative tolerance, or in words."""
    wrong = []
    for one, other in zip(told, found, strict=True):
        try:
            last_digit = 10.0 ** -len(one.partition(".")[2])
            close = abs(float(one) - float(other)) <= (last_digit + tolerance * abs(float(other)))
        except ValueError:
            close = one == other
        if not close:
            wrong.append(f"{told[0]}: {one} is told, {other} was found")
    return wrong


def _between(text: str) -> Callable[[re.Match[str]], str]:
    return lambda found: found[1] + text + found[2]


def _line(cells: list[str] | tuple[str, ...]) -> str:
    return "| " + " | ".join(cells) + " |"


def _number(value: float, digits: int) -> str:
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        return "∞"
    text = f"{value:.{digits}f}"
    # No minus sign before a zero.
    return text if float(text) else text.lstrip("-")
