"""First slips of many runs: by the native core, or by the Python block where that is missing."""

from __future__ import annotations

import math
import warnings
from array import array
from collections.abc import Mapping
from functools import cache
from typing import Final, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from stickslip_fmu.block import Block
from stickslip_fmu.laws.named import friction_law
from stickslip_fmu.spec import spec_of
from stickslip_native.batch import first_slips as native_first_slips
from stickslip_native.compiler import CompilerError

from .columns import Floats

Flags = NDArray[np.bool_]
Values = Mapping[str, float | Floats]
"""Parameters and inputs of the block by name [SI]."""

BESIDE: Final = 1e-6
"""A pulling velocity this near to a limit, relative, is at the limit."""

LEAST_STICK: Final = 1e-12
"""A shorter stick counts as none [1/w]: it is rounding."""

SEEN: Final = 1e-6
"""What is more than rounding of a speed, relative to the highest of the slip."""

REST_SLACK: Final = 8.0 * 2.0**-52
"""Rounding slack of the rest test; docs/theory.md (4)."""


class Motion(NamedTuple):
    """Steady motions of many blocks: whether a cycle `sticks`; arrays that broadcast.

    `t_stick`, and `t_slip` from break-away to re-stick [s], are NaN where there is no cycle, or
    its sticks do not settle to one length; steady sliding that is unstable `swings`. One of the two
    changes within `BESIDE` of the velocity where it is `at_limit`.
    """

    sticks: Flags
    t_stick: Floats
    t_slip: Floats
    swings: Flags
    at_limit: Flags


class SlowCoreWarning(UserWarning):
    """There is no C compiler: the Python block computes, some hundred times slower."""


class Slips(NamedTuple):
    """First slips of many runs, as of `stickslip_native.batch.FirstSlips` [s, m]."""

    t_stick: Floats
    t_slip: Floats
    delta_x: Floats
    spring_drop: Floats


def first_slips(values: Values, law: str) -> Slips:
    """Compute the first slip of many runs under a built-in friction law, each exactly, on one core.

    `values` are parameters and inputs of the block by name [SI]: numbers, and arrays of one
    dimension and one length; what is not named has its start value. ValueError, which names the run
    from 0 on, if one is out of range. `SlowCoreWarning`, once a process, without a C compiler; the
    results are the same to the bit.
    """
    if native_problem() is None:
        given = {
            name: array("d", np.ascontiguousarray(each, np.float64).tobytes())
            if isinstance(each, np.ndarray)
            else each
            for name, each in values.items()
        }
        found = native_first_slips(given, law)
        return Slips(*(np.array(getattr(found, name)) for name in Slips._fields))
    _warn_once()
    return _by_python_blocks(values, law)


def taken(values: Values, places: NDArray[np.intp]) -> dict[str, float | Floats]:
    """Return the values of some runs alone."""
    return {
        name: each[places] if isinstance(each, np.ndarray) else each
        for name, each in values.items()
    }


@cache
def native_problem() -> str | None:
    """Return why the native core cannot be used; None where it can. It is compiled for that."""
    try:
        native_first_slips({})
    except CompilerError as error:
        return str(error)
    return None


@cache
def _warn_once() -> None:
    warnings.warn(
        f"{native_problem()}; the Python block computes, some hundred times slower",
        SlowCoreWarning,
        stacklevel=3,
    )


def _by_python_blocks(values: Values, law: str) -> Slips:
    spec = spec_of(friction_law(law).law)
    names = list(values)
    start = spec.table.start_values()
    columns = np.broadcast_arrays(*(np.atleast_1d(each) for each in values.values()))
    runs = list(zip(*(each.tolist() for each in columns), strict=True))
    found = np.empty((len(Slips._fields), len(runs)))
    for number, run in enumerate(runs):
        try:
            given = spec.values({**start, **dict(zip(names, run, strict=True))})
            # The model of each of these specifications is the block under its friction law.
            found[:, number] = _first_slip(cast(Block, spec.model(given)))
        except ValueError as error:
            raise ValueError(f"run {number}: {error}") from error
    return Slips(*found)


def _first_slip(block: Block) -> tuple[float, float, float, float]:
    """Move a block from arc to arc until its first slip has ended, or it is seen to have no end.

    From rest a speed that has fallen and rises again never falls to rest; docs/theory.md (30).
    """
    meter, state = block.meter, block.state
    from_rest = state.arc.x_dot_start == 0.0
    in_slip = block.mode != 0
    highest, lowest, extreme = 0.0, math.inf, 0.0
    while meter.n_slips == 0:
        arc = state.arc
        left = arc.duration - state.elapsed
        if in_slip:
            speed = abs(arc.x_dot_start)
            if speed < highest - SEEN * highest:
                lowest = min(lowest, speed)
            extreme = abs(arc.extreme_velocity(arc.duration)) if left < math.inf else 0.0
        if math.isinf(left) or (from_rest and extreme > lowest + SEEN * highest):
            t_stick = meter.t_stick if in_slip else math.inf
            return t_stick, math.inf if in_slip else math.nan, math.nan, math.nan
        highest = max(highest, extreme)
        # A stick ends when time passes its end.
        block.advance(0.0, math.nextafter(left, math.inf))
        in_slip = in_slip or block.mode != 0
    return meter.t_stick, meter.t_slip, meter.delta_x, meter.spring_drop
