"""A master of our own: both FMUs in fmpy, stepped side by side or one after the other."""

from __future__ import annotations

import contextlib
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final, Literal

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave
from numpy.typing import NDArray

from .axis import Axis

Order = Literal["jacobi", "table first", "drive first"]
"""What steps when: both with what was given at the start of the step, or one after the other."""

TABLE_OUTPUTS: Final = ("F", "x", "x_pull", "x_dot", "delta_x", "T")
DRIVE_OUTPUTS: Final = ("v", "x_motor", "x_command", "following_error", "F_motor", "F_integral")

Run = Mapping[str, NDArray[np.float64]]
"""Columns by name: `time` [s], and the outputs above in SI."""


def simulate(
    folder: Path,
    axis: Axis,
    stop_time: float,
    step: float | None = None,
    order: Order = "jacobi",
) -> Run:
    """Run StickSlip.fmu and ServoDrive.fmu, both in `folder`, coupled.

    Parameters
    ----------
    folder
        Where the two FMUs are.
    axis
        The numbers of the axis.
    stop_time
        End [s].
    step
        Communication step [s]; the sample time of the controller where None.
    order
        What steps when.

    Returns
    -------
    Run
        One row for each communication point, the start among them.
    """
    h = axis.T_s if step is None else step
    steps = round(stop_time / h)
    with (
        _instance(folder / "StickSlip.fmu", axis.of_table()) as table,
        _instance(folder / "ServoDrive.fmu", axis.of_drive()) as drive,
    ):
        rows = np.empty((steps + 1, len(TABLE_OUTPUTS) + len(DRIVE_OUTPUTS)))
        of_table, of_drive = table.get(TABLE_OUTPUTS), drive.get(DRIVE_OUTPUTS)
        rows[0] = of_table + of_drive
        for index in range(steps):
            if order != "drive first":
                table.step(index * h, h, ("v",), of_drive[:1])
            if order == "table first":
                of_table = table.get(TABLE_OUTPUTS)
            drive.step(index * h, h, ("F", "x"), of_table[:2])
            of_drive = drive.get(DRIVE_OUTPUTS)
            if order == "drive first":
                table.step(index * h, h, ("v",), of_drive[:1])
            of_table = table.get(TABLE_OUTPUTS)
            rows[index + 1] = of_table + of_drive
    names = ("time", *TABLE_OUTPUTS, *DRIVE_OUTPUTS)
    time = h * np.arange(steps + 1, dtype=np.float64)
    return dict(zip(names, (time, *rows.T), strict=True))


def coupling_damping(w_d: float, w: float, h: float) -> float:
    """Return the damping ratio that explicit coupling adds; docs/feed-axis.md (3).

    Parameters
    ----------
    w_d, w
        sqrt(k / m_d), and the frequency of table and drive against each other [rad/s].
    h
        Communication step [s].

    Notes
    -----
    Of a drive that holds the force and gives its speed of now: it lags by one step.
    """
    return -0.5 * w_d * w_d * h / w


class _Instance:
    """An FMU's instance, its Reals called by name."""

    def __init__(self, slave: Any, references: dict[str, int]) -> None:
        self._slave, self._references = slave, references

    def get(self, names: tuple[str, ...]) -> list[float]:
        return list(self._slave.getReal([self._references[name] for name in names]))

    def step(self, time: float, h: float, names: tuple[str, ...], values: list[float]) -> None:
        self._slave.setReal([self._references[name] for name in names], values)
        self._slave.doStep(currentCommunicationPoint=time, communicationStepSize=h)


@contextlib.contextmanager
def _instance(fmu: Path, start_values: Mapping[str, float]) -> Iterator[_Instance]:
    description = fmpy.read_model_description(str(fmu))
    variables = {each.name: each for each in description.modelVariables}
    folder = fmpy.extract(str(fmu))
    slave = FMU2Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName=fmu.stem,
    )
    slave.instantiate()
    try:
        slave.setupExperiment(startTime=0.0)
        for name, value in start_values.items():
            reference = [variables[name].valueReference]
            if variables[name].type == "Integer":
                slave.setInteger(reference, [int(value)])
            else:
                slave.setReal(reference, [value])
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        yield _Instance(slave, {name: each.valueReference for name, each in variables.items()})
        slave.terminate()
    finally:
        slave.freeInstance()
        shutil.rmtree(folder, ignore_errors=True)
