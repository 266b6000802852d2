"""Where stick-slip ends, as a table of ranges of the pulling velocity."""

import math
from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from stickslip.show.scales import VELOCITIES, scale_for
from stickslip_ref import CriticalVelocity, Interval, Regime

_KINDS = {
    "eigenvalue": "eigenvalue",
    "grazing": "grazing",
    "fold": "fold",
    "reversal": "reversal",
    "none": "search",
}


def critical_table(found: CriticalVelocity, there: Regime | None = None) -> RenderableType:
    """Make the table of a limit, with what happens at a velocity where it is given."""
    table = Table(box=SIMPLE_HEAD)
    table.add_column("", overflow="fold")
    for heading in ("from", "", "to", ""):
        table.add_column(heading, justify="right" if heading else "left", overflow="fold")
    for name, ranges in (
        ("a cycle with a stick exists", found.cycle),
        ("steady sliding is unstable", found.unstable),
    ):
        for row in _rows(name, ranges, proven=found.proven):
            table.add_row(*row)
    notes = [] if found.proven else [_searched(found)]
    if there is not None:
        notes.insert(0, f"at {_speed(there.speed)} the mass {there.words}{_settles(there)}")
    return Group(table, *(Text(note) for note in notes))


def _settles(there: Regime) -> str:
    if there.kinds != ("even",) or math.isinf(there.settling):
        return ""
    return f": within 5 % of the speed {there.settling:.3g} s after it breaks away from rest"


def _rows(name: str, ranges: Sequence[Interval], *, proven: bool) -> list[list[str]]:
    if not ranges:
        return [[name, "none exists" if proven else "none found", "", "", ""]]
    return [
        [
            "" if number else name,
            _speed(each.low),
            _kind(each.low, each.low_end),
            _speed(each.high),
            _kind(each.high, each.high_end),
        ]
        for number, each in enumerate(ranges)
    ]


def _kind(v: float, kind: str) -> str:
    return "" if v in (0.0, math.inf) else _KINDS[kind]


def _speed(v: float) -> str:
    if math.isinf(v):
        return "no end"
    scale = scale_for(v, VELOCITIES)
    return f"{v / scale.size:.6g} {scale.symbol}"


def _searched(found: CriticalVelocity) -> str:
    low, high = found.between
    return (
        f"searched: {_speed(low)} to {_speed(high)} (--from, --to); nothing narrower than 1 % of v "
        "was looked for"
    )
