"""A case run with the SciPy reference, through its public API.

The reference is imported when it runs: most of a second that only the workers' processes need.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.model.run import Run
from stickslip_verification.suite.cases import Case

if TYPE_CHECKING:
    import stickslip_ref


def run_reference(case: Case) -> Run:
    """Run a case with the reference, sampled at its communication points.

    The messages of the run are the reference's warnings.
    """
    times = np.array((0.0, *case.times))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        trajectory = simulate_reference(case)
    columns = _columns(trajectory, len(times))
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


def _columns(
    trajectory: object, length: int
) -> dict[str, np.ndarray[tuple[int], np.dtype[np.float64]]]:
    columns = {}
    for name in OUTPUT_NAMES:
        source = "mode" if name == "sticking" else name
        samples: Sequence[float] | None = getattr(trajectory, source, None)
        if samples is not None:
            values = np.broadcast_to(np.asarray(samples, dtype=np.float64), (length,))
            columns[name] = np.where(values == 0, 1.0, 0.0) if name == "sticking" else values
    return columns
