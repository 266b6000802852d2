"""Serialized states with one field damaged and the checksum repaired: all must be refused."""

import ctypes as c
import math
import struct
from collections.abc import Iterator, Mapping

from stickslip_fmu.spec import TABLE
from tests.fmu.inside.raw import Raw

_SETTABLE = [row for row in TABLE.rows if row.settable]
_SUMS = ("elapsed", "x_start", "W_pull", "W_k", "Q_friction")
_METER = ("t_stick", "t_slip", "T", "delta_x", "spring_drop", "x_dot_peak", "t_event")
_METER_SUMS = ("phase", "cycle", "displacement", "relief")


def _settings(name: str) -> list[tuple[str, str]]:
    return [(f"{name}.{row.name}", "d") for row in _SETTABLE]


def _sums(names: tuple[str, ...]) -> list[tuple[str, str]]:
    return [(f"{name}.{part}", "d") for name in names for part in ("high", "low")]


FIELDS: tuple[tuple[str, str], ...] = (
    ("magic", "8s"),
    ("version", "I"),
    ("length", "I"),
    ("names", "Q"),
    *_settings("wanted"),
    *_settings("settings"),
    ("mode", "i"),
    ("known", "B"),
    *((name, "d") for name in ("z", "x_dot", "force", "age")),
    *((f"own.{n}", "d") for n in range(4)),
    *_sums(_SUMS),
    *((name, "d") for name in _METER),
    ("n_slips", "i"),
    ("seen_break_away", "B"),
    ("peak", "d"),
    *_sums(_METER_SUMS),
    ("started", "B"),
    ("changed", "B"),
    *_settings("values"),
    ("time", "d"),
    ("fmi_phase", "i"),
    ("settled", "B"),
)
"""Fields of a state in the order of its bytes, with their formats; the checksum follows."""

FORMAT = "<" + "".join(form for _, form in FIELDS)

_BELOW_ZERO = ("age", "elapsed.high", "t_slip", "t_stick", "T", "Q_friction.high")
_BAD: dict[str, list[object]] = {
    "magic": [b"slipstaT"],
    "version": [0, 2],
    "length": [0, 2**32 - 1],
    "names": [0],
    "mode": [-2, 2, 2**31 - 1],
    "n_slips": [-1],
    "fmi_phase": [-1, 4, 2**31 - 1],
}

_BAD_TOGETHER: tuple[dict[str, object], ...] = (
    # A slip without the force that it began with.
    {"mode": 1, "known": 0},
    # A load that lifts the mass.
    {"settings.load": -1e6},
    # A position beyond the numbers.
    {"z": 1.7e308, "x_start.high": 1.7e308, "x_start.low": 0.0},
)


def checksum(data: bytes) -> int:
    """Return the hash FNV-1a of 64 bits."""
    found = 14695981039346656037
    for byte in data:
        found = (found ^ byte) * 1099511628211 % 2**64
    return found


def with_values(data: bytes, changes: Mapping[str, object]) -> bytes:
    """Return a serialized state with other values of some fields, and the checksum of these."""
    values = struct.unpack(FORMAT, data[:-8])
    named = dict(zip((name for name, _ in FIELDS), values, strict=True))
    body = struct.pack(FORMAT, *{**named, **changes}.values())
    return body + struct.pack("<Q", checksum(body))


def damaged(data: bytes) -> Iterator[tuple[str, bytes]]:
    """Yield states that hold what no state can, each with the field and its value."""
    body, (old,) = data[:-8], struct.unpack("<Q", data[-8:])
    assert struct.calcsize(FORMAT) == len(body)
    assert old == checksum(body)
    values = struct.unpack(FORMAT, body)
    for (name, form), value in zip(FIELDS, values, strict=True):
        for bad in _bad_values(name, form, value):
            yield f"{name} = {bad}", with_values(data, {name: bad})
    for together in _BAD_TOGETHER:
        yield str(together), with_values(data, together)
    for n in range(0, len(body), 41):
        flipped = body[:n] + bytes([body[n] ^ 1]) + body[n + 1 :]
        yield f"byte {n} with the old checksum", flipped + data[-8:]


def _bad_values(name: str, form: str, value: object) -> list[object]:
    if name in _BAD:
        return _BAD[name]
    if form == "B":
        return [2, 255]
    bad: list[object] = [math.nan, math.inf]
    group, _, last = name.partition(".")
    if group in ("wanted", "settings", "values") and TABLE.by_name[last].minimum is not None:
        bad.append(-1.0)
    if last == "low":
        bad.append(1.0)
    if name in _BELOW_ZERO:
        bad.append(-1.0)
    return bad


def taken(raw: Raw) -> list[str]:
    """Return the damaged states of a run in motion that the FMU takes; none if it is sound."""
    instance = raw.instance()
    assert raw.EnterInitializationMode(instance) == 0
    assert raw.ExitInitializationMode(instance) == 0
    assert raw.DoStep(instance, 0.0, 1.0, 0) == 0
    state = raw.save(instance)
    data = raw.pack(instance, state)
    raw.forget(instance, raw.unpack(instance, data))
    found = []
    for name, bad in damaged(data):
        handle = c.c_void_p()
        if raw.DeSerializeFMUstate(instance, bad, len(bad), c.byref(handle)) == 0:
            raw.forget(instance, handle)
            found.append(name)
        assert raw.Reset(instance) == 0
    raw.forget(instance, state)
    raw.FreeInstance(instance)
    return found
