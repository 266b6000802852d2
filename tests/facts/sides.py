"""The block, the native FMU, the reference and the truth, each through the door of its users."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import pytest

from stickslip_ref import Change, Parameters, simulate
from stickslip_verification import truth
from tests.conftest import built
from tests.driver import loaded
from tests.fmu.blocks import Segment, drive, spec_named
from tests.needs import needs

Row = Mapping[str, Any]

BASE = frozenset(each.name for each in fields(Parameters)) - {"own"}
"""Names of what every friction law has; the others are its own."""


@dataclass(frozen=True)
class Setting:
    values: Mapping[str, float]
    segments: Sequence[Segment]
    law: str = "coulomb"
    start_time: float = 0.0


@dataclass(frozen=True)
class Side:
    name: str
    # Every output at the end of every step.
    rows: Callable[[Setting], Sequence[Row]]
    # Relative error of a well-conditioned output.
    accuracy: float
    # Whether slips are integrated, so that the conditioning of docs/theory.md (17) counts.
    integrates: bool = False


def _block(setting: Setting) -> Sequence[Row]:
    return drive(
        setting.values,
        setting.segments,
        spec=spec_named(setting.law),
        start_time=setting.start_time,
    )


def _native(setting: Setting) -> Sequence[Row]:
    fmu = loaded(built("native-2", setting.law))

    def typed(values: Mapping[str, float]) -> dict[str, float]:
        return {
            name: int(value) if fmu.types[name] == "Integer" else value
            for name, value in values.items()
        }

    instance = fmu.started(setting.start_time, **typed(setting.values))
    rows = []
    for segment in setting.segments:
        instance.set(**typed(segment.changes))
        instance.step(segment.length)
        rows.append(instance.everything())
    instance.free()
    return rows


def parted(values: Mapping[str, float]) -> tuple[dict[str, float], dict[str, float]]:
    base = {name: value for name, value in values.items() if name in BASE}
    return base, {name: value for name, value in values.items() if name not in BASE}


def _reference(setting: Setting) -> Sequence[Row]:
    lengths = [segment.length for segment in setting.segments]
    times = [setting.start_time + math.fsum(lengths[:n]) for n in range(len(lengths) + 1)]
    changes = [
        Change(time, *parted(segment.changes))
        for time, segment in zip(times, setting.segments, strict=False)
        if segment.changes
    ]
    base, own = parted(setting.values)
    run = simulate(
        Parameters(**base),
        times[-1],
        start_time=setting.start_time,
        times=times[1:],
        changes=changes,
        law=setting.law,
        own=own,
    )
    names = [name for name, value in vars(run).items() if len(value) == len(lengths)]
    names = [name for name in names if name not in ("events", "cycles", "own")]
    columns = {name: getattr(run, name) for name in (*names, "sticking")} | dict(run.own)
    return [{name: column[n] for name, column in columns.items()} for n in range(len(lengths))]


def _truth(setting: Setting, digits: int = 50) -> Sequence[Row]:
    steps = [truth.Step(segment.length, segment.changes) for segment in setting.segments]
    run = truth.run(
        setting.values, steps, digits=digits, start_time=setting.start_time, law=setting.law
    )
    return run.samples


BLOCK = Side("block", _block, 1e-14)
NATIVE = Side("native", _native, 1e-14)
REFERENCE = Side("reference", _reference, 3e-13, integrates=True)
TRUTH = Side("truth", _truth, 1e-40)
"""Errors: roundings of a handful of operations; 50 steps of an integration to 3e-14, with room for
another SciPy; ten digits fewer than the fifty that are promised."""

SIDES = (BLOCK, NATIVE, REFERENCE, TRUTH)
EXACT = (BLOCK, NATIVE, TRUTH)
QUICK = (BLOCK, NATIVE, REFERENCE)


def each_side(sides: Sequence[Side] = SIDES) -> list[Any]:
    return [
        pytest.param(side, id=side.name, marks=needs("cc") if side is NATIVE else ())
        for side in sides
    ]
