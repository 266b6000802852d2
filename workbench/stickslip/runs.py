"""One simulation by either engine, the FMU or the SciPy reference: samples, and events.

Both are sampled at the same times and give the same `Run`. Samples go to CSV files in fmpy's
format, which `fmpy.util.read_csv` reads back.
"""

import contextlib
import io
import math
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

import stickslip_ref
from fmi.table import Table, Variable
from stickslip.parameters import ParameterError, Parameters, above_zero, quantity
from stickslip.progress import deferred_interrupt
from stickslip_design.axis.curve_file import CURVE
from stickslip_fmu.spec import TABLE
from stickslip_verification import Event, Transition, drive, events_between, truth
from stickslip_verification.truth import COULOMB_NAME

Floats: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True)
class Run:
    """What an engine made of one set of parameters, inputs held constant.

    Attributes
    ----------
    engine
        ``"fmu"`` or ``"reference"``.
    parameters
        The block that was run.
    samples
        Structured array, shape (n,), as fmpy gives it: ``time`` and every output by its name, SI.
    events
        The transitions in order of time.
    hidden_events
        Number of sampling intervals that hold more transitions than the samples tell apart;
        `events` lacks those.
    notes
        The warnings of the engine, in the order they were given.
    """

    engine: str
    parameters: Parameters
    samples: NDArray[np.void]
    events: tuple[Event, ...]
    hidden_events: int = 0
    notes: tuple[str, ...] = ()

    @property
    def last(self) -> np.void:
        """The last sample: state and meter at the stop time."""
        sample: np.void = self.samples[-1]
        return sample


def sample_times(start_time: float, stop_time: float, output_interval: float) -> Floats:
    """Return the times [s], shape (n,), at which `fmpy.simulate_fmu` would sample a run.

    The first, every whole interval after it, and the last one, which is later than the first; the
    distance before it may be shorter.
    """
    whole = math.floor((stop_time - start_time) / output_interval)
    times = start_time + output_interval * np.arange(whole + 1)
    # fmpy takes times within a relative 1e-9 for one, as math.isclose does.
    times = times[times < stop_time]
    if len(times) > 1 and math.isclose(float(times[-1]), stop_time):
        times = times[:-1]
    return np.append(times, stop_time)


def fitting_interval(duration: float, step: float) -> float:
    """Double `step` [s] until no more than 1000 of it make `duration` [s], as fmpy does."""
    return step * 2.0 ** max(0, math.ceil(math.log2(duration / step / 1000.0)))


def csv_bytes(samples: NDArray[np.void]) -> bytes:
    """Return samples, a structured array of ``time`` [s] and outputs, as the bytes of a CSV file.

    It is the file of `fmpy.util.write_csv`, with Booleans as 0 and 1: fmpy's reader refuses True.
    """
    head = ",".join(f'"{name}"' for name in samples.dtype.names or ())
    rows = (",".join(str(+value) for value in row.item()) for row in samples)
    return "".join(f"{line}\n" for line in (head, *rows)).encode()


Progress = Callable[[float, float], None]
"""Called with the time simulated and the time to simulate [s]."""

DEFAULT_STEP: Final = 0.01
"""The communication step of the FMU's default experiment [s]."""

LARGEST_SAMPLE_COUNT: Final = 1_000_000
"""Samples of a run: they take 1.5 GB and a minute."""

_COLUMN_TYPES: Final = {"Real": np.float64, "Integer": np.int32, "Boolean": np.bool_}


class Experiment(NamedTuple):
    """What is simulated, and the times [s]."""

    parameters: Parameters
    start_time: float
    stop_time: float
    output_interval: float

    @property
    def duration(self) -> float:
        """Length of the experiment [s]."""
        return self.stop_time - self.start_time


def experiment(
    p: Parameters,
    start_time: float | str,
    stop_time: float | str,
    output_interval: float | str | None = None,
    *,
    drawn: bool = False,
) -> Experiment:
    """Make an experiment; where no interval is given, choose one.

    That is the step of the default experiment, doubled as fmpy does until 1000 are enough, and
    halved for a run that is to be drawn until its slips are smooth.

    Raises
    ------
    ParameterError
        If a text is no time, the stop is not after the start, or the interval is not positive or
        makes more than a million samples.
    """
    start, stop = quantity(start_time, "s", "start_time"), quantity(stop_time, "s", "stop_time")
    if not stop > start:
        raise ParameterError(
            "stop_time",
            f" {stop_time!r} is out of range: it must be after the start, > {start:g} s",
        )
    duration = stop - start
    if output_interval is None:
        interval = fitting_interval(duration, DEFAULT_STEP)
        if drawn:
            # Half a radian of the free oscillation is smooth; 20,000 samples are enough.
            smooth = max(0.5 * math.sqrt(p.m / p.k), duration / 20_000)
            interval /= 2.0 ** max(0, math.ceil(math.log2(interval / smooth)))
        return Experiment(p, start, stop, interval)
    interval = above_zero(output_interval, "s", "output_interval")
    smallest = max(duration / LARGEST_SAMPLE_COUNT, math.ulp(max(abs(start), abs(stop))))
    if interval < smallest:
        raise ParameterError(
            "output_interval",
            f" {output_interval!r} is out of range: it must be at least {smallest:.3g} s for a run "
            f"of {duration:g} s, a million samples",
        )
    return Experiment(p, start, stop, interval)


def reference_parameters(p: Parameters) -> stickslip_ref.Parameters:
    """Return parameters as the reference takes them, the friction law's own among them.

    Raises
    ------
    ValueError
        If they do not go together, or one that is not at its start value is none of the reference.
    """
    found, values = stickslip_ref.friction_law(p.law), p.values
    own = {name: values[name] for name in found.parameters}
    shared = {name: value for name, value in values.items() if name in truth.START_VALUES}
    for name in values.keys() - own.keys() - shared.keys():
        if values[name] != TABLE.by_name[name].start:
            raise ValueError(f"{name}: the reference of the friction law {p.law} has no {name}")
    with warnings.catch_warnings():
        if own.get("shape") == CURVE:
            # A curve takes the place of mu_k, which is not clamped then.
            warnings.simplefilter("ignore", stickslip_ref.FrictionClampWarning)
        return found.complete(stickslip_ref.Parameters(**shared), own)


def check_slips(what: Experiment, most: int) -> None:
    """Refuse a run that would have more slips than `most`, where its steady motion is known."""
    law = what.parameters.law
    # No slip is shorter than half a swing of the mass on its spring, so most runs are short enough.
    half_swing = math.pi * math.sqrt(what.parameters.m / what.parameters.k)
    if what.duration / half_swing <= most:
        return
    try:
        p = reference_parameters(what.parameters)
        if law == COULOMB_NAME:
            period = float(stickslip_ref.steady_cycle(p).T)
        else:
            cycle = stickslip_ref.regime(p, law).stick_slip
            period = cycle.period if cycle else math.nan
    except (ValueError, RuntimeError):
        # The reference does not have the friction law.
        return
    if period > 0.0 and (slips := what.duration / period) > most:
        # Beyond that nobody waits for them.
        allow = f", or allow them by --most-slips {math.ceil(slips)}" if slips < 1e12 else ""
        raise ParameterError(
            "stop_time",
            f": the run has about {slips:.3g} slips, and {most} are allowed; shorten it{allow}",
        )


def simulate_reference(what: Experiment) -> Run:
    """Simulate with `stickslip_ref`; raises RuntimeError if it cannot finish."""
    times = sample_times(what.start_time, what.stop_time, what.output_interval)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        parameters = reference_parameters(what.parameters)
        trajectory = stickslip_ref.simulate(
            parameters,
            what.stop_time,
            start_time=what.start_time,
            times=times,
            law=what.parameters.law,
            own=parameters.own,
        )
    events = tuple(
        Event(event.time, Transition(event.kind), event.mode, event.x, event.z)
        for event in trajectory.events
    )
    columns = {output.name: getattr(trajectory, output.name) for output in _outputs(TABLE)}
    samples = _samples({**columns, **trajectory.own}, times, what.parameters.table)
    notes = tuple(str(warning.message) for warning in caught)
    return Run("reference", what.parameters, samples, events, notes=notes)


def _outputs(table: Table) -> list[Variable]:
    """Return the outputs in the order of fmpy's results: Reals, then Integers, then Booleans."""
    return [
        variable
        for kind in _COLUMN_TYPES
        for variable in table.rows
        if variable.causality == "output" and variable.kind == kind
    ]


def _samples(
    columns: Mapping[str, Any], times: np.ndarray[Any, Any], table: Table
) -> np.ndarray[Any, Any]:
    """Return samples as fmpy gives them: a structured array of the time and every output."""
    types = {o.name: _COLUMN_TYPES[o.kind] for o in _outputs(table) if o.name in columns}
    samples = np.empty(len(times), dtype=[("time", np.float64), *types.items()])
    samples["time"] = times
    for name in types:
        samples[name] = columns[name]
    return samples


def simulate_fmu(what: Experiment, fmu: Path, progress: Progress) -> Run:
    """Simulate the FMU in a file; every value that it knows is set.

    `progress` is called after each communication step. ParameterError if the file is not an FMU
    that can be simulated; FmuError, with the FMU's own message, if it fails.
    """
    table, values = what.parameters.table, what.parameters.values
    times = sample_times(what.start_time, what.stop_time, what.output_interval)
    file = _opened(fmu, table)
    its = [row for row in table.rows if row.name not in (*truth.START_VALUES, *TABLE.by_name)]
    file.look_for(
        truth.Parameter(row.name, row.unit, values.get(row.name, 0.0), truth.Kind.TUNABLE)
        for row in its
    )
    own = [row.name for row in its if not row.settable]
    its = [row for row in its if row.settable]
    lacking = [row.name for row in its if not file.has(row.name) and values[row.name] != row.start]
    if lacking:
        raise ParameterError(
            "fmu", f" {fmu}: the FMU has no parameter {', '.join(lacking)} of the friction law"
        )
    setting = drive.Setting(
        {name: value for name, value in values.items() if file.has(name)},
        [drive.CommunicationStep(float(h), {}) for h in np.diff(times)],
        what.start_time,
    )
    with (
        deferred_interrupt() as interrupted,
        # The FMU says a failure on standard error too, for importers that drop its log.
        contextlib.redirect_stderr(io.StringIO()) as said,
    ):

        def after_step(elapsed: float) -> bool:
            progress(elapsed, what.duration)
            return interrupted()

        try:
            run = drive.run(file, setting, after_step, own)
        except drive.FmuError as error:
            # The last line that the FMU wrote is its own; its wrapper dresses it up in the log.
            own = [line for line in said.getvalue().split("\n") if line.strip()]
            raise drive.FmuError(own[-1] if own else str(error)) from error
        finally:
            file.close()
    columns = {name: np.append(run.initial[name], run.outputs[name]) for name in run.outputs}
    samples = _samples(columns, times[: len(run.times) + 1], table)
    plain = what.parameters.sticks
    events, hidden = events_between(samples, what.parameters.v) if plain else ((), 0)
    notes = tuple(" ".join(text.split()) for text in run.messages)
    return Run("fmu", what.parameters, samples, events, hidden, notes)


def _opened(fmu: Path, table: Table) -> drive.FmuFile:
    if not fmu.is_file():
        reason = "it is not a file" if fmu.exists() else "there is no such file"
        raise ParameterError("fmu", f" {fmu}: {reason}")
    try:
        file = drive.FmuFile(fmu)
    except drive.FmuError as error:
        raise ParameterError("fmu", f" {error}") from error
    if file.problems:
        raise ParameterError("fmu", f" {fmu}: not an FMU: {file.problems[0]}")
    common = (output for output in _outputs(table) if output.name in TABLE.by_name)
    missing = [output.name for output in common if not file.has(output.name)]
    if missing:
        raise ParameterError("fmu", f" {fmu}: the FMU has no output {', '.join(missing)}")
    return file
