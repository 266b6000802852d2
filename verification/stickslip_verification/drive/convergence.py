"""The observed order of the reference: how its error falls as its tolerance does."""

import itertools
import math
import warnings

import numpy as np

from stickslip_verification.drive.exact import exact_motion
from stickslip_verification.drive.reference import simulate_reference
from stickslip_verification.model.verdict import ObservedOrder
from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.invariants import Order


def observe(case: Case, invariant: Order) -> ObservedOrder:
    """Run the reference on a case at each tolerance of an invariant.

    The error is the root mean square over the communication points, over the quantity's largest
    value in the exact motion: a mean scatters less from level to level than a worst value.
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
