"""One run after another: the FMUs of a model driven in this process.

The components of a system step side by side: each over the same interval, with what the others
gave at its start. Before the first step, in initialization mode, outputs are handed on as often as
there are components, so that the start values follow the wires.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from stickslip_verification import FmuError
from stickslip_verification.drive.fmu.instance import FACES, FmuInstance
from stickslip_verification.drive.fmu.names import Variable

from .job import Job
from .reductions import REDUCTIONS


class _File:
    """An unpacked FMU as an instance of `stickslip_verification.drive` takes it."""

    def __init__(self, job: Job, index: int, folder: Path) -> None:
        component = job.components[index]
        self.path = Path(component.name)
        self.folder = folder
        self.token = component.token
        self.model_identifier = component.identifier
        self.variables: Mapping[str, Variable] = {
            each.name: each for each in job.variables.values() if each.component == index
        }


class Runner:
    """Does the runs of a job, whose FMUs are in folders; `FmuError` if one cannot be loaded."""

    def __init__(self, job: Job, folders: Sequence[Path]) -> None:
        self.job = job
        self._folders = folders
        self._files = [_File(job, index, folder) for index, folder in enumerate(folders)]
        self._instances: list[FmuInstance] = []
        self._used = False
        self._whole = any(
            REDUCTIONS[each].whole for all_of in job.outputs.values() for each in all_of
        )
        self._instantiate()

    def run(self, values: NDArray[np.float64]) -> list[float]:
        """Do a run with these values, and return its results in the order of the job's columns.

        A run that fails in an instance that has been used before is done again in a new one, so
        that its result depends on its values alone, as does the text of an `FmuError`.
        """
        if self._used:
            if self.job.reset:
                with contextlib.suppress(FmuError):
                    for each in self._instances:
                        each.reset()
                    return self._run(values)
            self._instantiate()
        self._used = True
        try:
            return self._run(values)
        except FmuError as error:
            said = self._without_names(str(error))
            self._instantiate()
            raise FmuError(said) from None

    def close(self) -> None:
        """Free the instances."""
        for each in self._instances:
            with contextlib.suppress(FmuError):
                each.free()
        self._instances = []

    def _instantiate(self) -> None:
        self.close()
        for file, component in zip(self._files, self.job.components, strict=True):
            self._instances.append(FACES[component.fmi_version](file))
        self._used = False
        job = self.job
        self._set_start = self._writer([*job.fixed, *job.swept])
        self._set_tables = self._writer([*job.tables])
        self._set_wired = self._writer([each.input for each in job.wires])
        self._read_wired = self._reader([each.output for each in job.wires])
        self._read_outputs = self._reader(list(job.outputs))

    def _parts(self, names: Sequence[str]) -> list[tuple[FmuInstance, list[int]]]:
        """Return the instances that have some of these variables, with the places of the names."""
        homes = [self.job.variables[name].component for name in names]
        return [
            (instance, [place for place, home in enumerate(homes) if home == index])
            for index, instance in enumerate(self._instances)
            if index in homes
        ]

    def _writer(self, names: Sequence[str]) -> Callable[[Sequence[float]], None]:
        """Return a function that sets these variables, of any components, given their values."""
        writers = [
            (instance.writer([names[place] for place in places]), places)
            for instance, places in self._parts(names)
        ]

        def write(values: Sequence[float]) -> None:
            for writer, places in writers:
                writer([values[place] for place in places])

        return write

    def _reader(self, names: Sequence[str]) -> Callable[[], list[float]]:
        """Return a function that reads these variables, of any components, in this order."""
        parts = self._parts(names)
        readers = [one.reader([names[place] for place in places]) for one, places in parts]
        if len(readers) == 1:
            return readers[0]
        order = np.argsort([place for _, places in parts for place in places]).tolist()

        def read() -> list[float]:
            values = [value for reader in readers for value in reader()]
            return [values[place] for place in order]

        return read

    def _run(self, values: NDArray[np.float64]) -> list[float]:
        job = self.job
        self._set_start([*job.fixed.values(), *values.tolist()])
        if job.tables:
            self._set_tables([float(values[0]) for values in job.tables.values()])
        start = float(job.times[0])
        for each in self._instances:
            each.enter(start)
        if job.wires:
            for _ in self._instances:
                self._hand_on()
        for each in self._instances:
            each.leave()
        samples = []
        for index, (time, step) in enumerate(
            zip(job.times.tolist(), job.steps.tolist(), strict=False)
        ):
            if self._whole and index >= job.settled:
                samples.append(self._read_outputs())
            if job.wires:
                self._hand_on()
            if job.tables:
                self._set_tables([float(values[index]) for values in job.tables.values()])
            for instance in self._instances:
                instance.step(time, step)
        last = self._read_outputs()
        if not self._whole:
            return last
        return self._reduced(np.array([*samples, last]))

    def _hand_on(self) -> None:
        given = self._read_wired()
        wires = self.job.wires
        self._set_wired(
            [w.factor * value + w.offset for w, value in zip(wires, given, strict=True)]
        )

    def _reduced(self, samples: NDArray[np.float64]) -> list[float]:
        times = self.job.times[-len(samples) :]
        return [
            REDUCTIONS[reduction].of(times, samples[:, place])
            for place, all_of in enumerate(self.job.outputs.values())
            for reduction in all_of
        ]

    def _without_names(self, said: str) -> str:
        """Return a message without what differs from process to process."""
        for instance, component in zip(self._instances, self.job.components, strict=True):
            said = said.replace(instance._name, component.name)
        for folder in self._folders:
            said = said.replace(str(folder), "")
        return said
