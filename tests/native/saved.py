"""The bytes of a state: fields in their order, and a checksum."""

import struct
from collections.abc import Iterator, Mapping
from typing import Any

from fmi.table import Table

HEAD = (("magic", "8s"), ("version", "I"), ("length", "I"), ("names", "Q"))
_SUMS = ("elapsed", "x_start", "W_pull", "W_k", "Q_friction")
_METER = ("t_stick", "t_slip", "T", "delta_x", "spring_drop", "x_dot_peak", "t_event")
_METER_SUMS = ("phase", "cycle", "displacement", "relief")


def fields(table: Table) -> Iterator[tuple[str, str]]:
    settings = [row.name for row in table.rows if row.settable]
    yield from HEAD
    yield from ((f"{group}.{name}", "d") for group in ("wanted", "settings") for name in settings)
    yield from (("mode", "i"), ("known", "?"))
    yield from ((name, "d") for name in ("z", "x_dot", "force", "age"))
    yield from _sums(_SUMS)
    yield from ((name, "d") for name in _METER)
    yield from (("n_slips", "i"), ("seen_break_away", "?"), ("peak", "d"))
    yield from _sums(_METER_SUMS)
    yield from (("started", "?"), ("changed", "?"))
    yield from (("time", "d"), ("rate.v", "d"), ("rate.load", "d"), ("rate.F_ext", "d"))
    yield from (("moves", "?"), ("fmi_phase", "i"), ("settled", "?"), ("holds", "?"))
    yield from (("solved", "?"), ("moved", "?"))
    yield from ((f"beside.{n}", "d") for n in range(12))


def _sums(names: tuple[str, ...]) -> Iterator[tuple[str, str]]:
    yield from ((f"{name}.{part}", "d") for name in names for part in ("high", "low"))


def checked(body: bytes) -> bytes:
    """Return bytes with the checksum of them behind: FNV-1a of 64 bits."""
    value = 14695981039346656037
    for byte in body:
        value = (value ^ byte) * 1099511628211 % 2**64
    return body + struct.pack("<Q", value)


def decoded(data: bytes, table: Table) -> dict[str, Any]:
    names, formats = zip(*fields(table), strict=True)
    return dict(zip(names, struct.unpack("<" + "".join(formats), data[:-8]), strict=True))


def encoded(values: Mapping[str, Any], table: Table) -> bytes:
    return checked(struct.pack("<" + "".join(form for _, form in fields(table)), *values.values()))


def changed(data: bytes, table: Table, changes: Mapping[str, Any]) -> bytes:
    return encoded({**decoded(data, table), **changes}, table)
