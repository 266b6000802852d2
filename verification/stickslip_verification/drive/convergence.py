"""A case run with the SciPy reference, through its public API, and its observed order.

The reference is imported when it runs: most of a second that only the workers' processes need.
"""

from __future__ import annotations

import itertools
import math
import warnings
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from stickslip_verification.drive.exact import exact_motion
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.model.run import Run
from stickslip_verification.model.verdict import ObservedOrder
from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.invariants import Order

if TYPE_CHECKING:
    import stickslip_ref


def run_reference(case: Case) -> Run:
    """Run a case with the reference, sampled at its communication points; warnings are messages."""
    times = np.array((0.0, *case.times))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        trajectory = simulate_reference(case)
    columns = {}
    for name in OUTPUT_NAMES:
        samples = getattr(trajectory, "mode" if name == "sticking" else name, None)
        if samples is not None:
            values = np.broadcast_to(np.asarray(samples, dtype=np.float64), times.shape)
            columns[name] = np.where(values == 0, 1.0, 0.0) if name == "sticking" else values
    return Run(
        times=times[1:],
        outputs={name: samples[1:] for name, samples in columns.items()},
        initial={name: float(samples[0]) for name, samples in columns.items()},
        messages=tuple(str(warning.message) for warning in caught),
    )


def simulate_reference(case: Case, rtol: float | None = None) -> stickslip_ref.Trajectory:
    """Simulate a case with the reference; `rtol` is the tolerance of a step, its own if None."""
    import stickslip_ref

    base, own = _split(case, case.parameters)
    changes = [
        stickslip_ref.Change(time, *_split(case, step.changes))
        for step, time in zip(case.steps, (0.0, *case.times), strict=False)
        if step.changes
    ]
    return stickslip_ref.simulate(
        stickslip_ref.Parameters(**base),
        case.stop_time,
        changes=changes,
        times=np.array((0.0, *case.times)),
        rtol=stickslip_ref.RTOL if rtol is None else rtol,
        law=case.law,
        own=own,
    )


def _split(case: Case, values: Mapping[str, float]) -> tuple[dict[str, float], dict[str, float]]:
    """Divide values into the model's and those of the friction law's own parameters."""
    names = {each.name for each in case.own}
    own = {name: value for name, value in values.items() if name in names}
    return {name: value for name, value in values.items() if name not in names}, own


def observe(case: Case, invariant: Order) -> ObservedOrder:
    """Run the reference on a case at each tolerance of an invariant.

    The error is the root mean square over the communication points, over the quantity's largest
    value in the exact motion.
    """
    expected = exact_motion(case).record.outputs[invariant.quantity]
    scale = float(np.max(np.abs(expected)))
    tolerances = np.geomspace(invariant.coarsest, invariant.finest, invariant.levels).tolist()
    errors = []
    for tolerance in tolerances:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            got = getattr(simulate_reference(case, tolerance), invariant.quantity)[1:]
        errors.append(float(np.sqrt(np.mean((got - expected) ** 2))) / scale)
    pairs = itertools.pairwise(zip(tolerances, errors, strict=True))
    return ObservedOrder(
        case=case.id,
        quantity=invariant.quantity,
        tolerances=tolerances,
        errors=errors,
        orders=[slope([a[0], b[0]], [a[1], b[1]]) for a, b in pairs],
        expected=invariant.order,
    )


def slope(tolerances: list[float], errors: list[float]) -> float:
    """Fit the slope of log error over log tolerance; NaN where an error is zero or not finite."""
    if not all(0.0 < error < math.inf for error in errors):
        return math.nan
    return float(np.polyfit(np.log(tolerances), np.log(errors), 1)[0])


def halves(order: ObservedOrder) -> float:
    """Return the slope of the coarser half of the levels less that of the finer half."""
    tolerances, errors = list(order.tolerances), list(order.errors)
    middle = len(errors) // 2
    coarser = slope(tolerances[: middle + 1], errors[: middle + 1])
    return coarser - slope(tolerances[middle:], errors[middle:])
