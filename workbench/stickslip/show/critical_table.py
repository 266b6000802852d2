"""Where stick-slip ends, as a table of ranges of the pulling velocity."""

import math
from collections.abc import Sequence

from rich.console import Group, RenderableType
from rich.text import Text

from stickslip.show.fitted import grid
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
    rows = [
        *_rows("a cycle with a stick exists", found.cycle, proven=found.proven),
        *_rows("steady sliding is unstable", found.unstable, proven=found.proven),
    ]
    notes = [] if found.proven else [_searched(found)]
    if there is not None:
        notes.insert(0, f"at {_speed(there.speed)} the mass {there.words}{_settles(there)}")
    table = grid(("", "from", "", "to", ""), rows, texts=(0, 2, 4))
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
    return "no end" if math.isinf(v) else scale_for(v, VELOCITIES).text(v)


def _searched(found: CriticalVelocity) -> str:
    low, high = found.between
    return (
        f"searched: {_speed(low)} to {_speed(high)} (--from, --to); nothing narrower than 1 % of v "
        "was looked for"
    )
