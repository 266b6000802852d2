"""The runs of a sweep: what each sets and keeps, how the FMUs are driven, and their process.

The components of a system step side by side: each over the same interval, with what the others
gave at its start. Before the first step, in initialization mode, outputs are handed on as often as
there are components, so that the start values follow the wires.

Jump and period are read off the sticks of a position, whose events lie between two samples, and
taken to means as the score takes those of a curve, `stickslip_score.figures.figures_of`.

The FMUs are in a process of their own, replaced where it ends. A run that crashes it, or takes
longer than the plan allows, costs that run alone: the runs that it was given with are done one by
one.
"""

from __future__ import annotations

import contextlib
import math
import multiprocessing
import shutil
import signal
import sys
import weakref
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from multiprocessing.connection import wait
from multiprocessing.util import Finalize
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip_verification import FmuError
from stickslip_verification.drive.description import new_folder
from stickslip_verification.drive.instance import FACES, FmuInstance
from stickslip_verification.drive.processes import LostError, Worker

from ..chunks import Columns
from .model import Model, SweepError, unpack_model

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
    # They bring SciPy, which takes a second; a process that reads last values goes without.
    from stickslip_score.figures import figures_of
    from stickslip_score.read import half_unit

    if not np.all(np.isfinite(position)):
        return None
    rounding = 4.0 * float(np.finfo(np.float64).eps) * float(np.max(np.abs(position)))
    digits = half_unit(position) + _INTEGRATED * float(np.ptp(position)) + rounding
    return figures_of(_sticks(times, position, digits), digits)


def _sticks(times: Floats, position: Floats, digits: float) -> list[Stick]:
    """Find the rests of a mass between its slips, in order of time.

    A rest is a longest run of at least `LEAST_AT_REST` samples within the `digits` of the position.
    Each of its events lies between the last sample that rests and the next one.
    """
    from stickslip_score.figures import VISIBLE, Event, Stick

    edges, begin = [0], position[0]
    # A run may drift within the band; of samples that move at once most begin a run of their own.
    for index, place in enumerate(position.tolist()):
        if abs(place - begin) > VISIBLE * digits:
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


FAILURE: Final = "failure"
"""Name of the column that says why a run has no results."""


@dataclass(frozen=True)
class Sweep:
    """The runs of a sweep, as `chunks.run` takes them; of the model's variables those in use.

    All runs have the values `fixed`, in the FMU's units. Each sets the variables `swept` to values:
    columns of points, or axes of a grid, the last one running fastest. `tables` are inputs from
    files: a value for each communication step, set before it. Communication points `times` [s] are
    of shape (steps + 1,); reductions, by variable in `outputs`, see them from `settled` on. A run
    may take the `time_limit` [s].
    """

    model: Model
    fixed: Mapping[str, float]
    swept: tuple[str, ...]
    values: tuple[Floats, ...]
    on_grid: bool
    tables: Mapping[str, Floats]
    times: Floats
    steps: Floats
    settled: int
    outputs: Mapping[str, tuple[str, ...]]
    time_limit: float
    identity: Mapping[str, Any]

    quantum = 1

    @property
    def results(self) -> dict[str, tuple[str, str]]:
        """Variable and reduction of each result of a run, by its name."""
        pairs = [(name, one) for name, reductions in self.outputs.items() for one in reductions]
        return {column_of(*pair): pair for pair in pairs}

    @property
    def shape(self) -> tuple[int, ...]:
        """Numbers of values along the axes of a grid; of points how many there are."""
        return tuple(axis.size for axis in (self.values if self.on_grid else self.values[:1]))

    @property
    def count(self) -> int:
        """How many runs there are."""
        return math.prod(self.shape)

    def compute(self, start: int, stop: int) -> Columns:
        """Do the runs from `start` up to but not including `stop`.

        `SweepError` if the model cannot be loaded here.
        """
        # A plan may sweep nothing.
        places = np.unravel_index(np.arange(start, stop), self.shape) if self.values else ()
        rows = np.empty((stop - start, len(self.values)))
        for column, values in enumerate(self.values):
            rows[:, column] = values[places[column if self.on_grid else 0]]
        results, failures = zip(*self._host.runs(rows), strict=True)
        columns = dict(zip(self.results, np.array(results).T.copy(), strict=True))
        return {**columns, FAILURE: np.array(failures, dtype=np.str_)}

    @cached_property
    def _host(self) -> Host:
        return Host(self)

    def __getstate__(self) -> dict[str, Any]:
        """Return what is pickled: a process starts FMUs of its own."""
        return {name: value for name, value in vars(self).items() if name != "_host"}


_STARTING: Final = 60.0
"""Seconds that loading the FMUs may take, beside the time limit of a run."""
_LONGEST_REASON: Final = 300
"""Characters of a reason that are kept."""

_Result: TypeAlias = tuple[list[float], str]
"""Results and reason of failure of a run, NaN and empty where there is none."""


class Host:
    """Does runs of a sweep in a process of its own, which ends with this object.

    `SweepError` if FMUs cannot be unpacked or loaded.
    """

    def __init__(self, study: Sweep) -> None:
        try:
            folder = new_folder()
            weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)
            folders = unpack_model(study.model, folder)
        except FmuError as error:
            raise SweepError(str(error)) from None
        # The process needs neither the archive nor all values.
        study = replace(study, model=replace(study.model, content=b""), values=())
        self._limit, self._lost = study.time_limit, [math.nan] * len(study.results)
        self._begin = _begin, (study, folders), sys.maxsize, folder
        self._worker: Worker | None = None

    def runs(self, rows: Floats) -> list[_Result]:
        """Return the results of runs, given values of the swept variables, (runs, variables)."""
        is_fresh = self._worker is None
        if self._worker is None:
            # A nanny of dask forbids its worker to have children: they would outlive it, and these
            # end with their connection.
            multiprocessing.current_process()._config["daemon"] = False  # type: ignore[attr-defined]
            self._worker = Worker(*self._begin)
            # A traceback may keep this object to the end, where Python waits for its processes.
            Finalize(self, self._worker.connection.close, exitpriority=0)
        worker, reason = self._worker, "SIGALRM"
        self._worker = None
        try:
            worker.give(_run, (rows,))
            if wait(worker.handles, _STARTING + self._limit * len(rows)):
                answer: list[_Result] | str = worker.answer()
                if isinstance(answer, str):
                    raise SweepError(answer)
                self._worker = worker
                return answer
        except LostError as error:
            reason = str(error)
        finally:
            if self._worker is None:
                worker.end()
        if len(rows) == 1 and is_fresh:
            late = f"took longer than {self._limit:g} s"
            return [(self._lost, late if "SIGALRM" in reason else reason)]
        # What an earlier run left behind must not decide: each is done on its own.
        return [result for row in rows for result in self.runs(row[np.newaxis])]


_STATE: list[Any] = []
"""In the process of the FMUs: the sweep and the folders of its FMUs, and what does the runs."""


def _begin(study: Sweep, folders: Sequence[Path]) -> None:
    _STATE[:] = [study, folders]
    if sys.platform != "win32":
        signal.signal(signal.SIGALRM, signal.SIG_DFL)


def _run(rows: Floats) -> list[_Result] | str:
    """Return results, or why the FMUs cannot be loaded."""
    if len(_STATE) == 2:
        try:
            _STATE.append(Runner(*_STATE))
        except FmuError as error:
            return str(error)
    study, _, runner = _STATE
    results: list[_Result] = []
    for row in rows:
        try:
            results.append((runner.run(row), ""))
        except FmuError as error:
            said = " ".join(str(error).split())[:_LONGEST_REASON]
            results.append(([math.nan] * len(study.results), said))
    _end_after(0.0)
    return results


def _end_after(seconds: float) -> None:
    """End this process after so many seconds whatever the FMU does; 0: not."""
    if sys.platform != "win32":
        signal.setitimer(signal.ITIMER_REAL, seconds)


_Part: TypeAlias = tuple[Callable[..., Any], list[int]]
"""What writes or reads the variables of one instance, and their places among all."""


def _write(parts: Sequence[_Part], values: Sequence[float]) -> None:
    for write, places in parts:
        write([values[place] for place in places])


def _read(parts: Sequence[_Part]) -> list[float]:
    found: dict[int, float] = {}
    for read, places in parts:
        found.update(zip(places, read(), strict=True))
    return [found[place] for place in range(len(found))]


class Runner:
    """Does the runs of a sweep, whose FMUs are in folders; `FmuError` if one cannot be loaded."""

    def __init__(self, study: Sweep, folders: Sequence[Path]) -> None:
        self.study, self._folders, self._reduces = study, folders, reduces(study.outputs)
        self._instances: list[FmuInstance] = []
        # Whether a reset forgets all; None before it is tried.
        self.resets: bool | None = None
        # Values and bits of the results of a run in these instances.
        self._first: tuple[Floats, bytes] | None = None
        self._instantiate()

    def run(self, values: Floats) -> list[float]:
        """Do a run with these values, and return its results in the order of the sweep's columns.

        Run after run is done in one instance, if the first one gives the same bits after a reset. A
        run that fails after one is done again in a new instance, so that its result depends on its
        values alone, as does the text of an `FmuError`.
        """
        if self._first is not None:
            with contextlib.suppress(FmuError):
                if self.resets is None:
                    first, bits = self._first
                    self.resets = False
                    self._reset()
                    self.resets = np.array(self._run(first)).tobytes() == bits
                if self.resets:
                    self._reset()
                    return self._run(values)
            self._instantiate()
        try:
            results = self._run(values)
        except FmuError as error:
            said = self._without_names(str(error))
            self._instantiate()
            raise FmuError(said) from None
        self._first = values, np.array(results).tobytes()
        return results

    def _reset(self) -> None:
        for instance in self._instances:
            instance.reset()

    def _instantiate(self) -> None:
        for instance in self._instances:
            with contextlib.suppress(FmuError):
                instance.free()
        study, self._instances, self._first = self.study, [], None
        for index, component in enumerate(study.model.components):
            its = {n: one for n, one in study.model.variables.items() if one.component == index}
            file = replace(component, folder=self._folders[index], variables=its)
            self._instances.append(FACES[component.fmi_version](file))
        wires = study.model.wires
        self._start = self._parts("writer", [*study.fixed, *study.swept])
        self._tables = self._parts("writer", [*study.tables])
        self._inputs = self._parts("writer", [wire.input for wire in wires])
        self._wired = self._parts("reader", [wire.output for wire in wires])
        self._outputs = self._parts("reader", [*study.outputs])

    def _parts(self, what: str, names: Sequence[str]) -> list[_Part]:
        """Return the `writer` or `reader` of each instance that has some of these variables."""
        homes = [self.study.model.variables[name].component for name in names]
        parts = []
        for index, instance in enumerate(self._instances):
            places = [place for place, home in enumerate(homes) if home == index]
            if places:
                parts.append((getattr(instance, what)([names[n] for n in places]), places))
        return parts

    def _run(self, values: Floats) -> list[float]:
        study, samples = self.study, list[list[float]]()
        _end_after(study.time_limit)
        _write(self._start, [*study.fixed.values(), *values.tolist()])
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
                samples.append(_read(self._outputs))
            self._hand_on()
            self._follow_tables(index)
            for instance in self._instances:
                instance.step(time, step)
        samples.append(_read(self._outputs))
        if not self._reduces:
            return samples[-1]
        columns = dict(zip(study.outputs, np.array(samples).T, strict=True))
        times = study.times[-len(samples) :]
        results = study.results.values()
        return [REDUCTIONS[reduction].of(times, columns[name]) for name, reduction in results]

    def _follow_tables(self, index: int) -> None:
        if self.study.tables:
            _write(self._tables, [float(table[index]) for table in self.study.tables.values()])

    def _hand_on(self) -> None:
        if wires := self.study.model.wires:
            outputs = zip(wires, _read(self._wired), strict=True)
            _write(self._inputs, [wire.factor * value + wire.offset for wire, value in outputs])

    def _without_names(self, said: str) -> str:
        """Return a message without what differs from process to process."""
        for instance, component in zip(self._instances, self.study.model.components, strict=True):
            said = said.replace(instance._name, str(component.path))
        for folder in self._folders:
            said = said.replace(str(folder), "")
        return said
