"""A record in SI units at the slide, from arrays or a CSV file of a controller or a bench."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

import stickslip_score as score
from stickslip_score import CurveError
from stickslip_units import told

from ..axis import Axis
from .model import Floats, Record

_FILE: Final = tomllib.loads(Path(__file__).with_name("columns.toml").read_text(encoding="utf-8"))
_UNITS: Final = {**score.UNITS, **_FILE["units"]}
_OF_DRIVE: Final = _FILE["of_drive"]
_KINDS: Final = {unit: kind for kind in _OF_DRIVE for unit in _FILE["units"][kind]}


def read_record(
    source: Path | str | Mapping[str, ArrayLike],
    columns: Mapping[str, str] | None = None,
    axis: Axis | None = None,
) -> Record:
    """Read a record from a CSV file, as of `stickslip_score.read_columns`, or of arrays in SI.

    Arrays, shape (n,), are called t, position, command, velocity, force, torque and current;
    `columns` names columns of a file by these. A name may carry the unit that the header lacks,
    ``"ActPos [mm]"``, and t may be a sample time, ``"0.25 ms"``. `axis` turns torque [N.m; percent
    of its rated torque] and current [A] of the motor into force. `CurveError` names the file, line
    and column, and the reason.
    """
    names: Mapping[str, object] = source if isinstance(source, Mapping) else columns or {}
    quantities = score.quantities_of(_FILE["columns"], _UNITS, columns or {})
    drive, spread = axis.drive if axis else None, 0.0
    with score.refusing("the record" if isinstance(source, Mapping) else source):
        if unknown := names.keys() - quantities:
            raise CurveError(f"{min(unknown)} is none of {', '.join(quantities)}")
        if not isinstance(source, Mapping):
            printed, units = score.read_columns(Path(source), quantities)
        elif "t" in source:
            printed = {name: np.array(column, dtype=np.float64) for name, column in source.items()}
            units = dict.fromkeys(printed, "SI")
        else:
            raise CurveError("the time, t, is missing")
        score.check_samples(printed)
        notes = [f"{name} has no unit: it was taken in SI" for name in units if not units[name]]
        sizes = {name: quantities[name].units.get(unit, 1.0) for name, unit in units.items()}
        kinds = {name: _KINDS.get(unit, name) for name, unit in units.items()}
        for name in [name for name in kinds if kinds[name] in _OF_DRIVE]:
            kind, key = kinds[name], _OF_DRIVE[kinds[name]]
            value = getattr(drive, key, None)
            if axis is None or drive is None or value is None:
                needed = f"drive.{key} of an axis file takes it to the slide"
                raise CurveError(f"{name} of the motor: {needed}")
            radius = drive.pitch / (2.0 * math.pi)
            factor = {"motor_speed": radius, "torque": 1.0 / radius}.get(kind, value / radius)
            to = "velocity" if kind == "motor_speed" else "force"
            printed[to], sizes[to] = printed.pop(name), sizes[name] * factor
            notes.append(f"{name} of the motor was turned into {to} by drive.{key}")
            if f"drive.{key}" in axis.spread:
                spread = axis.spread[f"drive.{key}"] / value
                notes[-1] += f"; its ± of {100.0 * spread:.3g} % scales mass and all forces"
    if drive and not drive.on_table and "position" in printed:
        notes.append("the position is that of the motor, as drive.position says")
    record = {name: column * sizes[name] for name, column in printed.items()}
    rounding = {name: half * sizes[name] for name, half in score.roundings(printed).items()}
    notes += _uneven(record["t"], rounding["t"])
    return Record(**record, rounding=rounding, force_spread=spread, notes=tuple(notes))


def _uneven(t: Floats, rounding: float) -> Iterator[str]:
    """Yield what is not even in times [s], as notes; within their digits it is."""
    # Even times as printed have steps that differ by a unit of their last digit.
    steps = np.diff(t)
    step, longest = float(np.median(steps)), int(np.argmax(steps))
    if share := float(np.mean(np.abs(steps - step) > max(0.01 * step, 2.02 * rounding))):
        lost = np.sum(np.round(steps / step) - 1.0)
        yield f"{100.0 * share:.2g} % of the steps of time are off {told(step, 's')} by above 1 %"
        where = f"{told(steps[longest], 's')} at t = {t[longest]:.6g} s"
        yield f"the longest step is {where}; {lost:.0f} samples are missing in all"
