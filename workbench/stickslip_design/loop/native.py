"""The motion of a servo axis in C: `walk.c`, compiled once for this machine."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from ctypes import Structure, byref, c_double, c_int, c_void_p
from functools import cache, lru_cache
from pathlib import Path
from typing import Final

import numpy as np

from stickslip_native.compiler import CompilerError
from stickslip_native.library import load
from stickslip_native.named import HOME

from .system import Matrix, Mode, System

EVENTS: Final = (
    "time", "stop", "forward", "backward", "slower", "faster", "motor stops", "motor forward",
    "motor backward", "peak", "dip",
)  # fmt: skip
"""Names of the events by their number in C."""
COLUMNS: Final = 8
"""Of a row in C: number of the event, time, place, speed, least speed, and the mode."""
_STEP: Final = 36
"""Numbers of a step of the plant in C, and whether it is known."""
_ENTRY: Final = np.dtype([("value", "d"), ("at", "2i")])
"""An entry of the controller's matrix in C: row and column."""


def _fields(kind: type, names: str) -> Iterator[tuple[str, type]]:
    return ((name, kind) for name in names.split())


class _Mode(Structure):
    _fields_ = (*_fields(c_int, "table motor line"),)


class _Axis(Structure):
    _fields_ = (
        *_fields(c_double, "k m c along inertia d dry lag sample fully"),
        *_fields(c_void_p, "lengths offsets rates forces decays lines control steps blocks"),
        *_fields(c_void_p, "scratch lates"),
        *_fields(c_int, "size commands command feed acceleration ungrown growth one"),
        *_fields(c_int, "parts n_lines entries"),
    )


class NativeWalk(Structure):
    """A motion on its way in C."""

    _fields_ = (
        ("state", c_void_p),
        *_fields(c_double, "offset passed near off band"),
        ("mode", _Mode),
        *_fields(c_double, "left end slips rests feed beside least settles"),
        *_fields(c_int, "extremes rebased rising turned turns most"),
    )


def _blocks(size: int) -> int:
    """Return how many numbers the blocks of a mode in C take, of states of a size."""
    return sum(2 + size * (size + 3 * ends) for ends in (9, 65))


class Native:
    """A servo axis as C has it."""

    def __init__(self, system: System, library: ctypes.CDLL) -> None:
        axis, drive, layout = system.axis, system.drive, system.layout
        lates = [part.late for part in system.parts]
        rates, forces = system.growth
        unit = np.eye(layout.size)
        # Of rows that change anything: what they take, and their own place where it is left.
        changed = (system.control != unit).any(axis=1)[:, None] & (system.control + unit != 0.0)
        rows, columns = np.nonzero(changed)
        entries = np.empty(len(rows), _ENTRY)
        entries["value"] = system.control[rows, columns]
        entries["at"] = np.column_stack([rows, columns])
        lengths = np.array([part.length for part in system.parts])
        ends = lengths[[-1, 0]]
        arrays = {
            "lengths": lengths, "offsets": system.offsets, "rates": rates, "forces": forces,
            "decays": np.exp(-np.outer(ends, rates)), "lines": np.array(system.lines),
            "control": entries, "steps": np.zeros(9 * len(system.lines) * 2 * _STEP),
            "blocks": np.zeros((3 + 6 * len(system.lines)) * _blocks(layout.size)),
            "scratch": np.empty(3 * layout.size), "lates": np.array(lates, np.intc),
        }  # fmt: skip
        self._library = library
        # Held as long as C reads them.
        self._arrays = arrays
        self._axis = _Axis(
            axis.k, axis.m, axis.c, axis.along, drive.inertia, drive.d, drive.dry, drive.lag,
            drive.T_s, system.fully, *(each.ctypes.data for each in arrays.values()),
            layout.size, layout.commands, layout.command, layout.feed, layout.acceleration,
            layout.ungrown.start, len(rates), layout.one, len(lates), len(system.lines),
            len(entries),
        )  # fmt: skip

    def over_sample(self, mode: Mode, states: Matrix, *, controlled: bool) -> Matrix:
        """Return what a sample makes of states, one a row, with or without the controller first."""
        states = np.array(states, np.float64, order="C")
        native = _Mode(*mode)
        self._library.stickslip_over_sample(
            byref(self._axis), byref(native), controlled, states.ctypes.data, len(states)
        )
        return states

    def walk(self, walk: NativeWalk, rows: Matrix) -> int:
        """Follow a motion to as many events of the table as there are rows; how many there are."""
        return int(
            self._library.stickslip_walk(
                byref(self._axis), byref(walk), rows.ctypes.data, len(rows)
            )
        )


@cache
def library() -> ctypes.CDLL | None:
    """Return the library, compiled; None where there is no C compiler."""
    folder = Path(__file__).parent
    sources = {
        "walk.c": (folder / "walk.c").read_bytes(),
        "export.h": (HOME / "face" / "export.h").read_bytes(),
    }
    try:
        found = load("walk", sources)
    except CompilerError:
        return None
    found.stickslip_walk.restype = ctypes.c_size_t
    found.stickslip_walk.argtypes = [c_void_p, c_void_p, c_void_p, ctypes.c_size_t]
    found.stickslip_over_sample.restype = None
    found.stickslip_over_sample.argtypes = [c_void_p, c_void_p, c_int, c_void_p, ctypes.c_size_t]
    return found


@lru_cache(maxsize=8)
def native_of(system: System) -> Native | None:
    """Return a system in C; None where there is no compiler."""
    found = library()
    return None if found is None else Native(system, found)


def over_sample(system: System, mode: Mode, *, controlled: bool = True) -> Matrix:
    """Return the matrix of a sample, with or without the turn of the controller before it."""
    unit, native = np.eye(system.layout.size), native_of(system)
    if native is not None:
        return native.over_sample(mode, unit, controlled=controlled).T
    state = system.control if controlled else unit
    for step in system.steps(mode):
        state = step @ state
    return state
