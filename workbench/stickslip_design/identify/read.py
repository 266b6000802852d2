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

from ..axis import Axis, Drive
from .model import Floats, Record

_OFF: Final = 0.01
"""A step of time that is off the median by more than this part of it is not even."""
_GAP: Final = 1.5
"""A step of time that is longer than so many medians is a gap."""

_FILE: Final = tomllib.loads(Path(__file__).with_name("columns.toml").read_text(encoding="utf-8"))
_UNITS: Final = {**score.UNITS, **_FILE["units"]}
_AT_SLIDE: Final = ("t", "position", "command", "velocity", "force")


def read_record(
    path: Path | str, columns: Mapping[str, str] | None = None, axis: Axis | None = None
) -> Record:
    """Read a record from a CSV file, as of `stickslip_score.read_columns`.

    `columns` are names of columns by t, position, command, velocity, force, torque and current; a
    name may carry the unit that the header lacks, ``"ActPos [mm]"``, and t may be a sample time,
    ``"0.25 ms"``. `axis` turns torque, percent of its rated torque, and current into force.
    `CurveError` names the file, line and column, and the reason.
    """
    quantities = score.quantities_of(_FILE["columns"], _UNITS, columns or {})
    with score.refusing(path):
        if unknown := (columns or {}).keys() - quantities:
            raise CurveError(f"{min(unknown)} is none of {', '.join(quantities)}")
        printed, units = score.read_columns(Path(path), quantities)
        sizes = {name: quantities[name].units.get(unit, 1.0) for name, unit in units.items()}
        return _record(printed, units, sizes, axis)


def record_of(columns: Mapping[str, ArrayLike], axis: Axis | None = None) -> Record:
    """Make a record of arrays in SI units, shape (n,), by the names of `read_record`.

    Torque and current are the motor's [N.m, A]. `CurveError` as of `stickslip_score.check_samples`,
    for another name, and for what cannot be turned into force.
    """
    if "t" not in columns or columns.keys() - _FILE["columns"]:
        raise CurveError(f"there must be t, and what is there one of {', '.join(_FILE['columns'])}")
    printed = {name: np.array(column, dtype=np.float64) for name, column in columns.items()}
    return _record(printed, dict.fromkeys(printed, "SI"), dict.fromkeys(printed, 1.0), axis)


def _record(
    printed: dict[str, Floats],
    units: Mapping[str, str],
    sizes: dict[str, float],
    axis: Axis | None,
) -> Record:
    """Make a record of columns as printed, with their units and the sizes of those."""
    score.check_samples(printed)
    source = next((name for name in ("force", "torque", "current") if name in printed), "")
    notes = [f"{name} has no unit: it was taken in SI" for name in units if not units[name]]
    spread, drive = 0.0, axis.drive if axis else None
    if source in ("torque", "current"):
        factor, by, spread = _to_force(source, units[source], axis)
        printed["force"], sizes["force"] = printed[source], sizes[source] * factor
        scales = f"; its ± of {100.0 * spread:.3g} % scales mass and all forces" if spread else ""
        notes.append(f"motor {source} was turned into force by {by}{scales}")
    if units.get("velocity") in _UNITS["motor_speed"]:
        sizes["velocity"] *= _drive("velocity", axis).pitch / (2.0 * math.pi)
    if drive and not drive.on_table and "position" in printed:
        notes.append("the position is that of the motor, as drive.position says")
    at_slide: dict[str, Floats] = {name: printed[name] for name in _AT_SLIDE if name in printed}
    found = {name: column * sizes[name] for name, column in at_slide.items()}
    rounding = {name: half * sizes[name] for name, half in score.roundings(at_slide).items()}
    notes += _uneven(found["t"], rounding["t"])
    return Record(**found, rounding=rounding, force_spread=spread, notes=tuple(notes))


def _drive(what: str, axis: Axis | None) -> Drive:
    """Return the drive that takes a quantity of the motor to the slide; CurveError without."""
    if axis is None or axis.drive is None:
        raise CurveError(f"{what} of the motor: an axis file with a drive takes it to the slide")
    return axis.drive


def _to_force(source: str, unit: str, axis: Axis | None) -> tuple[float, str, float]:
    """Return force at the slide per torque or current, what it is by, and its relative ±."""
    drive, spread = _drive(source, axis), axis.spread if axis else {}
    per_turn = 2.0 * math.pi / drive.pitch
    way = f"{told(drive.pitch, 'm')} per turn"
    if source == "torque" and unit != "%":
        return per_turn, way, 0.0
    key, of = ("rated_torque", "N m") if source == "torque" else ("torque_constant", "N m/A")
    value = getattr(drive, key)
    if value is None:
        raise CurveError(f"{source} of the motor: drive.{key} in the axis file takes it to force")
    by = f"drive.{key} = {value:.6g} {of} and {way}"
    return value * per_turn, by, spread.get(f"drive.{key}", 0.0) / value


def _uneven(t: Floats, rounding: float) -> Iterator[str]:
    """Yield what is not even in times [s], as notes; within their digits it is."""
    # Even times as printed have steps that differ by a unit of their last digit.
    steps, digits = np.diff(t), 2.02 * rounding
    step = float(np.median(steps))
    if share := float(np.mean(np.abs(steps - step) > max(_OFF * step, digits))):
        yield f"{100.0 * share:.2g} % of the steps of time are off {told(step, 's')} by above 1 %"
    gaps = np.flatnonzero(steps > max(_GAP * step, step + digits))
    if gaps.size:
        longest, lost = int(np.argmax(steps)), np.sum(np.round(steps[gaps] / step) - 1.0)
        yield (
            f"gaps of time: {gaps.size}, the longest of {told(steps[longest], 's')} at t = "
            f"{t[longest]:.6g} s; {lost:.0f} samples are missing in all"
        )
