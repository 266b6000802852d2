"""Steady runs at several feeds: friction over the speed, and the law that explains it best."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..axis import Axis
from .evened import Even, filtered, scatter
from .laws import Law, law_of
from .model import Curve, Floats, Identified, Number, Record, Residual, Trace
from .noise import least_squares, memory_of

_STEADY: Final = 0.05
"""Of its speed: how far a steady run may be off its mean."""
_ENDS: Final = 0.1
"""Of a steady run that is left out at each end, where it may still settle."""
_LEAST: Final = 20
"""Samples of a steady run at least."""
_CORNER: Final = 0.02
"""Corner of the low pass behind which the speed is judged, of the sample rate."""
_DEVIATIONS: Final = 4.0
"""Of the noise of the speed, within which it is steady."""
SHARE: Final = 0.9
"""Of the moving time: in steady runs, so that a record is one of them."""
LEAST_SPEEDS: Final = 3
"""Speeds that differ by a twentieth, so that friction over the speed can be told."""
_MOST: Final = 3000


class Plateau(NamedTuple):
    """A steady run: its samples in a run of the record, and its mean speed [m/s]."""

    run: Even
    samples: slice
    speed: float


def plateaus(runs: Sequence[Even], rounding: float) -> tuple[list[Plateau], float]:
    """Return the steady runs, and their share of the time in which the table moves."""
    found, moving, steady = [], 0, 0
    corner = _CORNER / runs[0].step
    ways = [filtered(run, corner) for run in runs]
    highest = max(float(np.max(np.abs(way.v))) for way in ways)
    for run, way in zip(runs, ways, strict=True):
        noise = _DEVIATIONS * scatter(run, corner, rounding).v
        moves = np.abs(way.v) > max(1e-3 * highest, 2.0 * noise)
        moving += int(np.count_nonzero(moves))
        # Cut where the speed has moved on from that at the begin of a part.
        least = max(_LEAST, int(2.0 / _CORNER))
        begin = 0
        while begin < way.t.size - least:
            middle = float(np.median(way.v[begin : begin + least]))
            within = np.abs(way.v[begin:] - middle) <= _STEADY * abs(middle) + noise
            ends = np.flatnonzero(~within)
            length = int(ends[0]) if ends.size else within.size
            if length < least or not moves[begin]:
                begin += max(1, least // 10)
                continue
            steady += length
            off = int(_ENDS * length)
            offset = int(np.searchsorted(run.t, way.t[begin]))
            samples = slice(offset + off, offset + length - off)
            span = run.t[samples]
            speed = float(np.polyfit(span - span[0], run.position[samples], 1)[0])
            found.append(Plateau(run, samples, speed))
            begin += length
    return found, min(steady / max(moving, 1), 1.0)


def steady_runs(record: Record, found: Sequence[Plateau], axis: Axis | None) -> Identified:
    """Return what steady runs tell: friction over the speed, each direction its own."""
    forces: list[Floats] = []
    for run, samples, _ in found:
        if run.force is None:
            raise ValueError("steady runs need a column of the force, torque or current")
        forces.append(run.force[samples])
    step = found[0].run.step
    memory = memory_of([force - np.mean(force) for force in forces])
    means = []
    for force in forces:
        one = least_squares(np.ones((force.size, 1)), force, np.zeros(force.size), memory.samples)
        means.append((float(one.value[0]), one.deviation(np.ones(1)), one.reach(np.ones(1))))
    mean, deviation, reach = np.array(means).T
    floor = record.rounding.get("force", 0.0) / math.sqrt(3.0 * max(map(len, forces)))
    speed = np.array([each.speed for each in found])
    order = np.argsort(speed)
    speed, mean, reach = speed[order], mean[order], reach[order]
    deviation = np.maximum(deviation[order], max(floor, 1e-12 * float(np.max(np.abs(mean)))))
    law = law_of(speed, mean, deviation)
    chi = float(np.sum(((mean - law.fitted) / deviation) ** 2))
    freedom = speed.size - len(law.names)
    return Identified(
        kind="steady runs",
        reason=f"{len(found)} runs of constant speed",
        numbers=tuple(_numbers(law, axis)),
        untold=tuple(_untold(law)),
        residual=Residual(
            rms=float(np.sqrt(np.mean((mean - law.fitted) ** 2))),
            unit="N",
            memory=memory.samples * step,
            faults=tuple(_faults(chi, freedom, mean, law)),
        ),
        traces=(_trace(found, law, order),),
        segments=tuple(
            (float(r.t[s][0]), float(r.t[s][-1]), f"{v * 6e4:.4g} mm/min") for r, s, v in found
        ),
        curve=Curve(
            speed=speed, force=mean, band=reach, law=law.words, fitted=law.fitted
        ),
        notes=tuple(_notes(law, speed)),
    )  # fmt: skip


def _numbers(law: Law, axis: Axis | None) -> Iterator[Number]:
    drive = axis.drive if axis else None
    d, dry = (drive.d, drive.dry) if drive else (0.0, 0.0)
    shown = {
        "F_k": ("friction.F_k", "Coulomb friction", "N", dry, 1),
        "c": ("axis.c", "viscous friction", "N.s/m", d, 1),
        "c forward": ("c forward", "viscous friction forward", "N.s/m", d, 1),
        "c backward": ("c backward", "viscous friction backward", "N.s/m", d, 1),
        "fall": ("fall", "fall of friction from rest to high speed", "N", 0.0, 1),
        "offset": ("axis.force_along", "constant force along the way, as of a weight", "N", 0, -1),
    }  # fmt: skip
    for symbol, (name, meaning, unit, less, sign) in shown.items():
        if symbol in law.names:
            value, reach = law.number(symbol)
            value = sign * value - less
            yield Number(
                name=name, meaning=meaning, unit=unit, value=value, low=value - reach,
                high=value + reach, scales=True,
            )  # fmt: skip


def _untold(law: Law) -> Iterator[tuple[str, str]]:
    yield "axis.mass", "the table is not accelerated in steady runs"
    yield "friction.F_s", "the table does not stick and slip in this record"
    yield "axis.stiffness", "a steady run does not stretch the spring anew"
    if "offset" not in law.names:
        yield "axis.force_along", "runs in one direction do not tell it from friction"


def _faults(chi: float, freedom: int, mean: Floats, law: Law) -> Iterator[str]:
    if freedom > 0 and chi / freedom > 25.0:
        worst = float(np.max(np.abs(mean - law.fitted)))
        if worst > 0.02 * float(np.ptp(mean)):
            yield f"runs are up to {worst:.2g} N off every law tried"


def _notes(law: Law, speed: Floats) -> Iterator[str]:
    if not np.any(speed < 0.0) or not np.any(speed > 0.0):
        yield "All runs are in one direction: Coulomb friction and a constant force are one number."
    if "fall" in law.names:
        yield f"The fall is over at about {3.0 * law.v_s * 6e4:.3g} mm/min."


def _trace(found: Sequence[Plateau], law: Law, order: NDArray[np.intp]) -> Trace:
    fitted = np.empty(len(found))
    fitted[order] = law.fitted
    stride = max(1, sum(len(each.run.t[each.samples]) for each in found) // _MOST)
    columns = [
        (r.t[s][::stride], r.force[s][::stride], np.full(r.t[s][::stride].size, value))
        for (r, s, _), value in zip(found, fitted, strict=True)
        if r.force is not None
    ]
    t, measured, drawn = map(np.concatenate, zip(*columns, strict=True))
    return Trace(name="force", unit="N", t=t, measured=measured, fitted=drawn)
