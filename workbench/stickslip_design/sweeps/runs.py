"""The runs of a sweep: what each sets, how the FMUs are driven in this process, and what is kept.

The components of a system step side by side: each over the same interval, with what the others
gave at its start. Before the first step, in initialization mode, outputs are handed on as often as
there are components, so that the start values follow the wires.

Jump and period are read off the sticks of a position, whose events lie between two samples, and
taken to means as the score takes those of a curve, `stickslip_score.figures.figures_of`.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip_verification import FmuError
from stickslip_verification.drive.instance import FACES, FmuInstance

from .model import Model

if TYPE_CHECKING:
    from stickslip_score.figures import Figures, Stick

Floats: TypeAlias = NDArray[np.float64]

LEAST_AT_REST: Final = 3
"""Samples of one place that are a rest: a smooth turn may have two alike."""

_INTEGRATED: Final = 1e-9
"""Of the range of a position: no tool that integrates promises more, so less is a rest."""


class Reduction(NamedTuple):
    """A number `of` times [s] and samples; without a unit it has that of the variable.

    One of the `whole` needs the samples on the way, and not the last one alone.
    """

    of: Callable[[Floats, Floats], float]
    meaning: str
    unit: str | None = None
    whole: bool = True


def _mean(times: Floats, samples: Floats) -> float:
    if times.size < 2:
        return float(samples[-1])
    return float(np.trapezoid(samples, times) / (times[-1] - times[0]))


def _jump(times: Floats, position: Floats) -> float:
    jumps = figures.jumps if (figures := _measured(times, position)) else [math.nan]
    return float(np.mean(np.abs(jumps))) if jumps else 0.0


def _period(times: Floats, position: Floats) -> float:
    figures = _measured(times, position)
    return figures.values.get("period", (math.nan,))[0] if figures else math.nan


def _measured(times: Floats, position: Floats) -> Figures | None:
    """Return the figures of a position; None where a sample is not finite."""
    # It brings SciPy, which takes a second; a process that reads last values goes without.
    from stickslip_score.figures import figures_of

    if not np.all(np.isfinite(position)):
        return None
    return figures_of(sticks(times, position), _digits(position))


REDUCTIONS: Final[Mapping[str, Reduction]] = {
    "last": Reduction(lambda times, samples: float(samples[-1]), "at the end", whole=False),
    "max": Reduction(lambda times, samples: float(np.max(samples)), "greatest sample"),
    "min": Reduction(lambda times, samples: float(np.min(samples)), "least sample"),
    "mean": Reduction(_mean, "mean over time, the samples joined by straight lines"),
    "jump": Reduction(
        _jump, "mean length of the jumps between two rests, 0 where there is none; of a position"
    ),
    "period": Reduction(
        _period,
        "mean time from break-away to break-away, NaN where there is no whole cycle; of a position",
        "s",
    ),
}
"""The reductions by name."""


def reduces(outputs: Mapping[str, Sequence[str]]) -> bool:
    """Return whether a reduction of some by variable needs the samples on the way."""
    return any(REDUCTIONS[name].whole for names in outputs.values() for name in names)


def column_of(name: str, reduction: str) -> str:
    """Return the name of a result: the variable for its last value, else variable.reduction."""
    return name if reduction == "last" else f"{name}.{reduction}"


def sticks(times: Floats, position: Floats) -> list[Stick]:
    """Find the rests of a mass between its slips, in order of time.

    A rest is a longest run of at least `LEAST_AT_REST` samples within the digits of the position.
    Each of its events lies between the last sample that rests and the next one.
    """
    from stickslip_score.figures import VISIBLE, Event, Stick

    band = VISIBLE * _digits(position)
    edges, begin = [0], position[0]
    # A run may drift within the band; of samples that move at once most begin a run of their own.
    for index, place in enumerate(position.tolist()):
        if abs(place - begin) > band:
            edges.append(index)
            begin = place
    found = []
    for first, stop in pairwise((*edges, position.size)):
        if stop - first < LEAST_AT_REST:
            continue
        begins = Event(float(times[first - 1]), float(times[first])) if first > 0 else None
        ends = Event(float(times[stop - 1]), float(times[stop])) if stop < position.size else None
        found.append(Stick(begins, ends, float(np.median(position[first:stop])), stop - first))
    return found


def _digits(position: Floats) -> float:
    """Return how far samples of one place may be apart: digits, integration, rounding."""
    from stickslip_score.read import half_unit

    rounding = 4.0 * float(np.finfo(np.float64).eps) * float(np.max(np.abs(position)))
    return half_unit(position) + _INTEGRATED * float(np.ptp(position)) + rounding


@dataclass(frozen=True)
class Runs:
    """The runs of a sweep.

    Attributes
    ----------
    model
        The FMUs, and of their variables those that are set, read or connected.
    fixed
        Values that all runs have, by name, in the FMU's units.
    swept, values, on_grid
        Names of the variables that each run sets, and their values: columns of points, or axes of a
        grid, whose points are all combinations of them, the last one running fastest.
    tables
        Inputs from files, by name: a value for each communication step, set before it.
    times, steps, settled
        Communication points [s], shape (steps + 1,), and communication steps [s], shape (steps,);
        index of the first communication point that reductions see.
    outputs
        Names of reductions by variable.
    time_limit
        Seconds that a run may take.
    reset
        Whether an instance does run after run, reset between.
    identity
        All that the results depend on.
    """

    model: Model
    fixed: Mapping[str, float]
    swept: tuple[str, ...]
    values: tuple[NDArray[np.float64], ...]
    on_grid: bool
    tables: Mapping[str, NDArray[np.float64]]
    times: NDArray[np.float64]
    steps: NDArray[np.float64]
    settled: int
    outputs: Mapping[str, tuple[str, ...]]
    time_limit: float
    reset: bool
    identity: Mapping[str, Any]

    @property
    def results(self) -> list[tuple[str, str]]:
        """Variable and reduction of each result of a run, in order."""
        return [(name, one) for name, reductions in self.outputs.items() for one in reductions]

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the results."""
        return tuple(column_of(*result) for result in self.results)

    @property
    def shape(self) -> tuple[int, ...]:
        """Numbers of values along the axes of a grid; of points how many there are."""
        return tuple(axis.size for axis in (self.values if self.on_grid else self.values[:1]))

    @property
    def count(self) -> int:
        """How many runs there are."""
        return int(np.prod(self.shape, dtype=np.int64))

    def rows(self, start: int, stop: int) -> NDArray[np.float64]:
        """Return the values of runs, shape (stop - start, swept variables)."""
        rows, runs = np.empty((stop - start, len(self.values))), np.arange(start, stop)
        # A plan may sweep nothing.
        places = np.unravel_index(runs, self.shape) if self.values else ()
        for column, values in enumerate(self.values):
            rows[:, column] = values[places[column if self.on_grid else 0]]
        return rows


class Runner:
    """Does the runs of a sweep, whose FMUs are in folders; `FmuError` if one cannot be loaded."""

    def __init__(self, study: Runs, folders: Sequence[Path]) -> None:
        self.study, self._folders, self._reduces = study, folders, reduces(study.outputs)
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
        for index, component in enumerate(study.model.components):
            its = {n: one for n, one in study.model.variables.items() if one.component == index}
            file = replace(component, folder=self._folders[index], variables=its)
            self._instances.append(FACES[component.fmi_version](file))
        self._used = False
        self._set_start = self._writer([*study.fixed, *study.swept])
        self._set_tables = self._writer([*study.tables])
        self._set_wired = self._writer([wire.input for wire in study.model.wires])
        self._read_wired = self._reader([wire.output for wire in study.model.wires])
        self._read_outputs = self._reader([*study.outputs])

    def _parts(self, called: Sequence[str]) -> list[tuple[FmuInstance, list[int]]]:
        """Return the instances that have some of these variables, with the places of the names."""
        homes = [self.study.model.variables[name].component for name in called]
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
        if wires := self.study.model.wires:
            outputs = zip(wires, self._read_wired(), strict=True)
            self._set_wired([wire.factor * value + wire.offset for wire, value in outputs])

    def _without_names(self, said: str) -> str:
        """Return a message without what differs from process to process."""
        for instance, component in zip(self._instances, self.study.model.components, strict=True):
            said = said.replace(instance._name, str(component.path))
        for folder in self._folders:
            said = said.replace(str(folder), "")
        return said
