"""The study: what changes creeping and hunting; its tables and pictures are in the how-to."""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from stickslip_design.axis import Axis, axis_of, example
from stickslip_design.critical import jumps_of, rigid_critical_feed
from stickslip_design.loop.hunting import Hunting, hunting
from stickslip_design.loop.jumps import Jump, jump_at, limit_of_jumps
from stickslip_design.loop.stability import is_stable
from stickslip_verification.report.svg import as_svg, differences

from . import plots
from .runs import Run, creep, hold, jumps, simulate
from .system import Move, start_values

BASE: Final = axis_of(example())

CREEP_TIME: Final = 2.0
RISING_TIME: Final = 3.0
"""Lengths of the runs [s]: of creeping at least 20 jumps in the half that is measured."""

HUNTING_TIME: Final = 20.0
RESTING_TIME: Final = 12.0
HUNTING_PERIODS: Final = 11
"""Lengths of the runs around a target [s], where hunting should go on and where it should not, and
how many computed periods the former hold at least. The half that is measured is the last: by then
the cycle has evened out, and 5 periods or more are in it."""

TOLERANCE: Final = 0.02
"""Relative, of the numbers in the tables. On another machine a count of an encoder may fall the
other way; a jump of 10 um then moves by a count of 0.1 um, and so does the cycle."""

PICTURES: Final = {
    "creeping": ("A feed axis at constant feed", 1.5),
    "rising": ("Jumps while the feed rises", 1.5),
    "hunting": ("A feed axis that hunts around its target", 3.0),
}
"""Title of each picture, and the distance [pt] up to which its lines are the same. A count of an
encoder that falls the other way moves a jump by 0.1 um and the next by 0.4 ms: 0.8 pt. In three
seconds of hunting, with the last digit of k changed, every jump comes 6 ms later, which is 0.9 pt,
and 1.9 pt up or down where a steep line leaves the panel."""


def varied(**changes: Any) -> Axis:
    """Return the axis with other numbers of its own, of its friction or of its drive."""
    parts: dict[str, Any] = {}
    for part in ("friction", "drive"):
        own = getattr(BASE, part)
        names = changes.keys() & vars(own).keys()
        parts[part] = replace(own, **{name: changes.pop(name) for name in names})
    return replace(BASE, **parts, **changes)


VARIANTS: Final = {
    "as it is": BASE,
    "no velocity feed-forward": varied(velocity_feedforward=0.0),
    "friction feed-forward 736 N": varied(friction_feedforward=BASE.F_k),
    "stiffer, k = 100 N/µm": varied(k=1e8),
    "smaller gap, µ_s = 0.16": varied(mu_s=0.16),
    "faster, 2 mm/s": BASE,
    "position on the motor": varied(on_table=False),
    "no integral": varied(T_n=0.0),
    "K_v = 50 1/s": varied(K_v=50.0),
    "velocity loop 600 1/s": varied(bandwidth=600.0, T_n=4.0 / 600.0),
    "viscous, c = 16 kN s/m": varied(c=16e3),
    "dead band of 6 µm *": varied(dead_band=6e-6, velocity_feedforward=0.95),
    "dead band of 7 µm *": varied(dead_band=7e-6, velocity_feedforward=0.95),
}
FASTER: Final = "faster, 2 mm/s"
CREEPING: Final = tuple(name for name in VARIANTS if "dead band" not in name)
HOLDING: Final = tuple(name for name in VARIANTS if name != FASTER)

HEADS: Final = {
    "creep": "| variant | jump [µm] | design tool | rigid drive | period [ms] | mean error [µm] "
    "| uneven [µm rms] | jumps up to [mm/s] | design tool | rigid drive |",
    "hunting": "| variant | comes to rest | jump [µm] | design tool [µm] | period [s] "
    "| design tool [s] | error left [µm] |",
}


@functools.cache
def creep_run(fmus: Path, name: str) -> Run:
    """Run a variant at constant feed."""
    feed = 2e-3 if name == FASTER else 5e-4
    return simulate(fmus, start_values(VARIANTS[name], Move(feed)), CREEP_TIME)


@functools.cache
def hunting_run(fmus: Path, name: str) -> Run:
    """Run a move of 10 mm at 5 mm/s, and the hold after it."""
    axis, stop = VARIANTS[name], RESTING_TIME
    if expected := expected_hunting(axis):
        stop = max(HUNTING_TIME, float(math.ceil(HUNTING_PERIODS * expected.period)))
    return simulate(fmus, start_values(axis, Move(5e-3, distance=0.01)), stop)


@functools.cache
def rising_run(fmus: Path, name: str) -> Run:
    """Run a feed that rises evenly to twice the feed at which jumping should end."""
    axis = VARIANTS[name]
    feed = 2.0 * limit_of_jumps(axis).feed
    return simulate(fmus, start_values(axis, Move(feed, feed / RISING_TIME)), RISING_TIME)


def feeds_of_jumps(run: Run) -> Any:
    """Return the commanded feed [m/s] at the end of each jump."""
    feeds = np.gradient(run["x_command"], run["time"])
    return np.interp(jumps(run)[0], run["time"], feeds)


def expected_hunting(axis: Axis) -> Hunting | None:
    """Return the cycle about a target by the design tool, None where it rests or is unstable.

    The cycle is that without a dead band, as long as the dead band does not end it.
    """
    found = hunting(axis) if is_stable(axis) else None
    assert axis.drive is not None
    return None if found is None or found.dead_band <= axis.drive.dead_band else found


def expected_jump(axis: Axis, feed: float) -> Jump | None:
    """Return the jump at a feed [m/s] by the design tool, None without one or unstable."""
    return jump_at(axis, feed) if is_stable(axis) else None


def creep_row(fmus: Path, name: str) -> list[str]:
    """Return the row of a variant in the table of creeping."""
    axis, feed = VARIANTS[name], 2e-3 if name == FASTER else 5e-4
    found, rigid = creep(creep_run(fmus, name)), replace(axis, drive=None)
    # Where it starts without jumping, the cycle that may exist beside is not shown.
    expected = expected_jump(axis, feed) if found.jumps else None
    of_rigid = jumps_of(rigid, feed)
    last = feeds_of_jumps(rising_run(fmus, name))
    return [
        name,
        number(found.jump * 1e6, 1),
        number(expected.way * 1e6 if expected else math.nan, 1),
        number(of_rigid.way * 1e6 if of_rigid else math.nan, 1),
        number(found.period * 1e3, 1),
        number(found.error * 1e6, 1),
        number(found.unevenness * 1e6, 2),
        number(last[-1] * 1e3 if len(last) else math.nan, 2),
        number(limit_of_jumps(axis).feed * 1e3, 2),
        number(rigid_critical_feed(rigid) * 1e3, 2),
    ]


def hunting_row(fmus: Path, name: str) -> list[str]:
    """Return the row of a variant in the table of hunting."""
    found = hold(hunting_run(fmus, name))
    expected = None if found.stops else expected_hunting(VARIANTS[name])
    return [
        name,
        "yes" if found.stops else "no",
        number(found.jump * 1e6, 1),
        number(expected.jump * 1e6 if expected else math.nan, 1),
        number(found.period, 2),
        number(expected.period if expected else math.nan, 2),
        number(-found.offset * 1e6, 1) if found.stops else "",
    ]


ROWS: Final = {"creep": (creep_row, CREEPING), "hunting": (hunting_row, HOLDING)}


def pictures(fmus: Path) -> dict[str, str]:
    """Return the pictures of the how-to by name, as SVG text."""
    base = "as it is"
    rising = rising_run(fmus, base)
    with plots.styled():
        pages = {
            "creeping": plots.creeping(creep_run(fmus, base), 5e-4, BASE.F_s, 1.5, 0.2),
            "rising": plots.rising(feeds_of_jumps(rising), jumps(rising)[1], BASE),
            "hunting": plots.holding(hunting_run(fmus, base), BASE.F_s, 15.0, 3.0),
        }
        return {name: as_svg(page, Title=PICTURES[name][0]) for name, page in pages.items()}


def write_document(document: Path, fmus: Path) -> None:
    """Write tables and pictures of the how-to anew, from runs of the FMUs."""
    text = document.read_text(encoding="utf-8")
    for table, (row, names) in ROWS.items():
        rows = [HEADS[table], "|---" * (HEADS[table].count("|") - 1) + "|"]
        rows += ["| " + " | ".join(row(fmus, name)) + " |" for name in names]
        pattern = rf"(<!-- table: {table} -->\n).*?(?=<!-- end of table -->)"
        made = "\n".join(rows).replace("\\", r"\\") + "\n"
        text = re.sub(pattern, rf"\g<1>{made}", text, count=1, flags=re.DOTALL)
    document.write_text(text, encoding="utf-8", newline="\n")
    for name, svg in pictures(fmus).items():
        file = document.with_suffix("") / f"{name}.svg"
        file.write_text(svg, encoding="utf-8", newline="\n")


def check_document(document: Path, fmus: Path, variants: Collection[str]) -> Iterator[str]:
    """Give what pictures, and rows of these variants, show otherwise than runs of the FMUs."""
    text = document.read_text(encoding="utf-8")
    for table in ROWS:
        yield from check_table(text, table, fmus, variants)
    for name, svg in pictures(fmus).items():
        yield from differences(document.with_suffix("") / f"{name}.svg", svg, PICTURES[name][1])


def check_table(text: str, table: str, fmus: Path, variants: Collection[str]) -> Iterator[str]:
    """Give what a table of the how-to says of these variants otherwise than runs of the FMUs."""
    row, names = ROWS[table]
    told = rows_of(text, table)
    if tuple(told) != names:
        yield f"{table}: the rows are {list(told)}, not {list(names)}"
        return
    for name in filter(variants.__contains__, names):
        for one, other in zip(told[name], row(fmus, name), strict=True):
            try:
                most = 10.0 ** -len(one.partition(".")[2]) + TOLERANCE * abs(float(other))
                close = abs(float(one) - float(other)) <= most
            except ValueError:
                close = one == other
            if not close:
                yield f"{table}, {name}: {one} is told, {other} was found"


def rows_of(document: str, table: str) -> Mapping[str, list[str]]:
    """Return the rows of a table in the how-to by their first cell."""
    lines = document.split(f"<!-- table: {table} -->\n")[1].split("<!-- end")[0].splitlines()[2:]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    return {cells[0]: cells for cells in rows}


def number(value: float, digits: int) -> str:
    """Return a number as the tables show it; no minus sign before a zero."""
    if not math.isfinite(value):
        return "–" if math.isnan(value) else "∞"
    text = f"{value:.{digits}f}"
    return text if float(text) else text.lstrip("-")
