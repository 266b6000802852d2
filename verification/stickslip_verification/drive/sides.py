"""The two sides of a case: an FMU through FMI, and the SciPy reference. Both give a `Run`."""

import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Protocol

import numpy as np

import stickslip_ref
from stickslip_verification.drive import stepping
from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.fmu.names import NameMap
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.model.run import Run
from stickslip_verification.suite.cases import Case

__all__ = ["FmuError", "FmuSide", "ReferenceSide", "Side", "reference_run"]


class Side(Protocol):
    """Something that can run a case. ``name`` is fmu or reference, as in the report."""

    name: str

    def run(self, case: Case) -> Run:
        """Run the case from its start; raise with a reason if that is impossible."""
        ...


class FmuSide:
    """An FMU for co-simulation, driven step by step; one fresh instance per case.

    Raises `FmuError` when the file is no usable FMU, and from `run` with the FMU's own message
    when it refuses a call. An output that the FMU lacks is absent from the record.
    """

    name = "fmu"

    def __init__(self, path: Path, names: NameMap | None = None) -> None:
        self.file = FmuFile(path, names)

    def run(self, case: Case) -> Run:
        """Run the case: values set before initialization, changes before the step they act in."""
        return stepping.run_case(self.file, case)


class ReferenceSide:
    """The SciPy reference through its public API."""

    name = "reference"

    def run(self, case: Case) -> Run:
        """Run the case; the samples are those of its communication points."""
        times = np.array((0.0, *case.times))
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            trajectory = reference_run(case)
        columns = _columns(trajectory, len(times))
        return Run(
            times=times[1:],
            outputs={name: samples[1:] for name, samples in columns.items()},
            initial={name: float(samples[0]) for name, samples in columns.items()},
            messages=tuple(str(warning.message) for warning in caught),
        )


def reference_run(case: Case, rtol: float | None = None) -> stickslip_ref.Trajectory:
    """Simulate a case with the reference, at its own tolerance of a step or at `rtol`."""
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
