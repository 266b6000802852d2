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
from stickslip_verification.drive import description as names
from stickslip_verification.drive.instance import FACES, FmuInstance

from .reductions import REDUCTIONS
from .runs import Runs


class _File:
    """An unpacked FMU as an instance of `stickslip_verification.drive` takes it."""

    def __init__(self, study: Runs, index: int, folder: Path) -> None:
        component = study.components[index]
        self.path, self.folder = Path(component.name), folder
        self.token, self.model_identifier = component.token, component.identifier
        self.variables: Mapping[str, names.Variable] = {
            one.name: one for one in study.variables.values() if one.component == index
        }


class Runner:
    """Does the runs of a sweep, whose FMUs are in folders; `FmuError` if one cannot be loaded."""

    def __init__(self, study: Runs, folders: Sequence[Path]) -> None:
        self.study, self._folders, self._reduces = study, folders, study.reduces
        self._instances: list[FmuInstance] = []
        self._used = False
        self._instantiate()

    def run(self, values: NDArray[np.float64]) -> list[float]:
        """Do a run with these values, and return its results in the order of the sweep's columns.

        A run that fails in an instance that has been used before is done again in a new one, so
        that its result depends on its values alone, as does the text of an `FmuError`.
        """
        if self._used:
            if self.study.reset:
                with contextlib.suppress(FmuError):
                    for instance in self._instances:
                        instance.reset()
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
        for instance in self._instances:
            with contextlib.suppress(FmuError):
                instance.free()
        self._instances = []

    def _instantiate(self) -> None:
        self.close()
        study = self.study
        for index, component in enumerate(study.components):
            file = _File(study, index, self._folders[index])
            self._instances.append(FACES[component.fmi_version](file))
        self._used = False
        self._set_start = self._writer([*study.fixed, *study.swept])
        self._set_tables = self._writer([*study.tables])
        self._set_wired = self._writer([wire.input for wire in study.wires])
        self._read_wired = self._reader([wire.output for wire in study.wires])
        self._read_outputs = self._reader([*study.outputs])

    def _parts(self, called: Sequence[str]) -> list[tuple[FmuInstance, list[int]]]:
        """Return the instances that have some of these variables, with the places of the names."""
        homes = [self.study.variables[name].component for name in called]
        return [
            (instance, [place for place, home in enumerate(homes) if home == index])
            for index, instance in enumerate(self._instances)
            if index in homes
        ]

    def _writer(self, called: Sequence[str]) -> Callable[[Sequence[float]], None]:
        """Return a function that sets these variables, of any components, given their values."""
        writers = [
            (instance.writer([called[place] for place in places]), places)
            for instance, places in self._parts(called)
        ]

        def write(values: Sequence[float]) -> None:
            for writer, places in writers:
                writer([values[place] for place in places])

        return write

    def _reader(self, called: Sequence[str]) -> Callable[[], list[float]]:
        """Return a function that reads these variables, of any components, in this order."""
        parts = self._parts(called)
        readers = [one.reader([called[place] for place in places]) for one, places in parts]
        order = np.argsort([place for _, places in parts for place in places]).tolist()

        def read() -> list[float]:
            values = [value for reader in readers for value in reader()]
            return [values[place] for place in order]

        return readers[0] if len(readers) == 1 else read

    def _run(self, values: NDArray[np.float64]) -> list[float]:
        study, samples = self.study, list[list[float]]()
        self._set_start([*study.fixed.values(), *values.tolist()])
        self._follow_tables(0)
        for instance in self._instances:
            instance.enter(float(study.times[0]))
        for _ in self._instances:
            self._hand_on()
        for instance in self._instances:
            instance.leave()
        starts = study.times[:-1].tolist()
        for index, (time, step) in enumerate(zip(starts, study.steps.tolist(), strict=True)):
            if self._reduces and index >= study.settled:
                samples.append(self._read_outputs())
            self._hand_on()
            self._follow_tables(index)
            for instance in self._instances:
                instance.step(time, step)
        samples.append(self._read_outputs())
        if not self._reduces:
            return samples[-1]
        columns = dict(zip(study.outputs, np.array(samples).T, strict=True))
        times = study.times[-len(samples) :]
        return [REDUCTIONS[reduction].of(times, columns[name]) for name, reduction in study.results]

    def _follow_tables(self, index: int) -> None:
        if self.study.tables:
            self._set_tables([float(values[index]) for values in self.study.tables.values()])

    def _hand_on(self) -> None:
        if wires := self.study.wires:
            outputs = zip(wires, self._read_wired(), strict=True)
            self._set_wired([wire.factor * value + wire.offset for wire, value in outputs])

    def _without_names(self, said: str) -> str:
        """Return a message without what differs from process to process."""
        for instance, component in zip(self._instances, self.study.components, strict=True):
            said = said.replace(instance._name, component.name)
        for folder in self._folders:
            said = said.replace(str(folder), "")
        return said
