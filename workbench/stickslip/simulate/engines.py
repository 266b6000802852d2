"""One simulation by either engine: the FMU, or the SciPy reference.

Both are sampled at the same times and give the same `Run`.
"""

import contextlib
import io
import math
import warnings
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np

import stickslip_ref
from fmi.table import Table, Variable
from stickslip.errors import CommandError
from stickslip.progress import deferred_interrupt
from stickslip.simulate.run import Run, drawable_interval, fitting_interval, sample_times
from stickslip_design.curve_file import CURVE
from stickslip_fmu.spec import TABLE
from stickslip_verification import Event, Transition, drive, events_between, truth
from stickslip_verification.truth import COULOMB_NAME

Progress = Callable[[float, float], None]
"""Called with the time simulated and the time to simulate [s]."""

DEFAULT_STEP: Final = 0.01
"""The communication step of the FMU's default experiment [s]."""

_COLUMN_TYPES: Final = {"Real": np.float64, "Integer": np.int32, "Boolean": np.bool_}


class Experiment(NamedTuple):
    """What is simulated: every parameter and input by name (SI), and the times [s].

    `law` is the name of the friction law; `table` its variable table.
    """

    parameters: Mapping[str, float]
    start_time: float
    stop_time: float
    output_interval: float
    law: str = COULOMB_NAME
    table: Table = TABLE

    @property
    def duration(self) -> float:
        """Length of the experiment [s]."""
        return self.stop_time - self.start_time


def experiment(
    parameters: Mapping[str, float],
    start_time: float,
    stop_time: float,
    output_interval: float | None = None,
    *,
    drawn: bool = False,
    law: str = COULOMB_NAME,
    table: Table = TABLE,
) -> Experiment:
    """Make an experiment; where no interval is given, choose one.

    That is the step of the default experiment, doubled as fmpy does until 1000 are enough, and
    halved for a run that is to be drawn until its slips are smooth.
    """
    if output_interval is None:
        duration = stop_time - start_time
        output_interval = fitting_interval(duration, DEFAULT_STEP)
        if drawn:
            w = math.sqrt(parameters["k"] / parameters["m"])
            output_interval = drawable_interval(duration, output_interval, w)
    return Experiment(parameters, start_time, stop_time, output_interval, law, table)


def reference_parameters(
    values: Mapping[str, float], law: str = COULOMB_NAME
) -> stickslip_ref.Parameters:
    """Return values by name (SI) as the reference takes them, the friction law's own among them.

    Raises
    ------
    ValueError
        If they do not go together, or one that is not at its start value is none of the reference.
    """
    found = stickslip_ref.friction_law(law)
    own = {name: values[name] for name in found.parameters}
    shared = {name: value for name, value in values.items() if name in truth.START_VALUES}
    for name in values.keys() - own.keys() - shared.keys():
        if values[name] != TABLE.by_name[name].start:
            raise ValueError(f"{name}: the reference of the friction law {law} has no {name}")
    with warnings.catch_warnings():
        if own.get("shape") == CURVE:
            # A curve takes the place of mu_k, which is not clamped then.
            warnings.simplefilter("ignore", stickslip_ref.FrictionClampWarning)
        return found.complete(stickslip_ref.Parameters(**shared), own)


def expected_slips(what: Experiment) -> float | None:
    """Return about how many slips an experiment has, from its steady motion.

    None where that is not known: the reference does not have the friction law, the motion does not
    repeat, or the pulled end stands still.
    """
    try:
        p = reference_parameters(what.parameters, what.law)
        if what.law == COULOMB_NAME:
            period = float(stickslip_ref.steady_cycle(p).T)
        else:
            cycle = stickslip_ref.regime(p, what.law).stick_slip
            period = cycle.period if cycle else math.nan
    except (ValueError, RuntimeError):
        return None
    return what.duration / period if period > 0.0 else None


def simulate_reference(what: Experiment) -> tuple[Run, list[str]]:
    """Simulate with `stickslip_ref`.

    Returns
    -------
    Run, list of str
        The run, and the warnings in the order they were given.

    Raises
    ------
    CommandError
        If the reference refuses the values or cannot finish.
    """
    times = sample_times(what.start_time, what.stop_time, what.output_interval)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            parameters = reference_parameters(what.parameters, what.law)
            trajectory = stickslip_ref.simulate(
                parameters,
                what.stop_time,
                start_time=what.start_time,
                times=times,
                law=what.law,
                own=parameters.own,
            )
        except (ValueError, RuntimeError) as error:
            raise CommandError(_one_line(error)) from error
    events = tuple(
        Event(event.time, Transition(event.kind), event.mode, event.x, event.z)
        for event in trajectory.events
    )
    columns = {output.name: getattr(trajectory, output.name) for output in _outputs(TABLE)}
    samples = _samples(columns, times)
    run = Run("reference", dict(what.parameters), samples, events)
    return run, [str(warning.message) for warning in caught]


def _outputs(table: Table) -> list[Variable]:
    """Return the outputs in the order of fmpy's results: Reals, then Integers, then Booleans."""
    return [
        variable
        for kind in _COLUMN_TYPES
        for variable in table.rows
        if variable.causality == "output" and variable.kind == kind
    ]


def _samples(columns: Mapping[str, Any], times: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Return samples as fmpy gives them: a structured array of the time and every output."""
    outputs = [output for output in _outputs(TABLE) if output.name in columns]
    types = [("time", np.float64), *((o.name, _COLUMN_TYPES[o.kind]) for o in outputs)]
    samples = np.empty(len(times), dtype=types)
    samples["time"] = times
    for output in outputs:
        samples[output.name] = columns[output.name]
    return samples


def simulate_fmu(what: Experiment, fmu: Path, progress: Progress) -> tuple[Run, list[str]]:
    """Simulate the FMU in the file `fmu`.

    Parameters
    ----------
    what
        The experiment; every value that the FMU knows is set.
    fmu
        The FMU.
    progress
        Called after each communication step.

    Returns
    -------
    Run, list of str
        The run, and the warnings of the FMU in the order they were given.

    Raises
    ------
    CommandError
        If the file is not an FMU that can be simulated, or the FMU fails; then with the FMU's own
        message.
    """
    times = sample_times(what.start_time, what.stop_time, what.output_interval)
    file = _opened(fmu, what.table)
    its = [row for row in what.table.rows if row.settable and row.name not in truth.START_VALUES]
    file.look_for(
        truth.Parameter(row.name, row.unit, what.parameters[row.name], truth.Kind.TUNABLE)
        for row in its
    )
    lacking = [
        row.name for row in its if not file.has(row.name) and what.parameters[row.name] != row.start
    ]
    if lacking:
        raise CommandError(
            f"--fmu {fmu}: the FMU has no parameter {', '.join(lacking)} of the friction law"
        )
    setting = drive.Setting(
        {name: value for name, value in what.parameters.items() if file.has(name)},
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
            run = drive.run(file, setting, after_step)
        except drive.FmuError as error:
            # The last line that the FMU wrote is its own; its wrapper dresses it up in the log.
            own = [line for line in said.getvalue().split("\n") if line.strip()]
            raise CommandError(own[-1] if own else str(error)) from error
        finally:
            file.close()
    columns = {name: np.append(run.initial[name], run.outputs[name]) for name in run.outputs}
    samples = _samples(columns, times[: len(run.times) + 1])
    events, hidden = events_between(samples, what.parameters["v"])
    messages = [" ".join(text.split()) for text in run.messages]
    return Run("fmu", dict(what.parameters), samples, events, hidden), messages


def _opened(fmu: Path, table: Table) -> drive.FmuFile:
    if not fmu.is_file():
        reason = "it is not a file" if fmu.exists() else "there is no such file"
        raise CommandError(f"--fmu {fmu}: {reason}")
    try:
        file = drive.FmuFile(fmu)
    except drive.FmuError as error:
        raise CommandError(f"--fmu {error}") from error
    if file.problems:
        raise CommandError(f"--fmu {fmu}: not an FMU: {file.problems[0]}")
    common = (output for output in _outputs(table) if output.name in TABLE.by_name)
    missing = [output.name for output in common if not file.has(output.name)]
    if missing:
        raise CommandError(f"--fmu {fmu}: the FMU has no output {', '.join(missing)}")
    return file


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__
