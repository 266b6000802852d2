"""One simulation by either engine: the FMU through fmpy, or the SciPy reference.

Both are sampled at the same times and give the same `Run`.
"""

import contextlib
import io
import math
import shutil
import warnings
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np

import stickslip_ref
from stickslip.errors import CommandError
from stickslip.progress import deferred_interrupt
from stickslip.run import (
    Event,
    Run,
    drawable_interval,
    events_between,
    fitting_interval,
    sample_times,
)
from stickslip_fmu.interface import TABLE

Progress = Callable[[float, float], None]
"""Called with the time simulated and the time to simulate [s]."""

DEFAULT_STEP: Final = 0.01
"""The communication step of the FMU's default experiment [s]."""

_COLUMN_TYPES: Final = {"Real": np.float64, "Integer": np.int32, "Boolean": np.bool_}


class Experiment(NamedTuple):
    """What is simulated: every parameter and input by name (SI), and the times [s]."""

    parameters: Mapping[str, float]
    start_time: float
    stop_time: float
    output_interval: float

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
    return Experiment(parameters, start_time, stop_time, output_interval)


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
            trajectory = stickslip_ref.simulate(
                stickslip_ref.Parameters(**what.parameters),
                what.stop_time,
                start_time=what.start_time,
                times=times,
            )
        except (ValueError, RuntimeError) as error:
            raise CommandError(_one_line(error)) from error
    events = tuple(
        Event(event.time, event.kind, event.mode, event.x, event.z) for event in trajectory.events
    )
    samples = _samples(trajectory, times)
    run = Run("reference", dict(what.parameters), samples, events)
    return run, [str(warning.message) for warning in caught]


def _samples(
    trajectory: stickslip_ref.Trajectory, times: np.ndarray[Any, Any]
) -> np.ndarray[Any, Any]:
    """Give the trajectory as fmpy gives its result: Reals, then Integers, then Booleans."""
    outputs = [
        variable
        for kind in _COLUMN_TYPES
        for variable in TABLE.rows
        if variable.causality == "output" and variable.kind == kind
    ]
    columns = [("time", np.float64), *((o.name, _COLUMN_TYPES[o.kind]) for o in outputs)]
    samples = np.empty(len(times), dtype=columns)
    samples["time"] = times
    for output in outputs:
        samples[output.name] = getattr(trajectory, output.name)
    return samples


def simulate_fmu(what: Experiment, fmu: Path, progress: Progress) -> tuple[Run, list[str]]:
    """Simulate the FMU in the file `fmu` with `fmpy.simulate_fmu`.

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
    import fmpy
    from fmpy.fmi1 import FMICallException

    description = _description(fmu)
    messages: list[str] = []

    def take_message(
        environment: object, instance: bytes, status: int, category: bytes, text: bytes
    ) -> None:
        if status > 0 and text:
            messages.append(" ".join(text.decode("utf-8", errors="replace").split()))

    known = {variable.name for variable in description.modelVariables}
    with (
        _unpacked(fmu) as folder,
        deferred_interrupt() as interrupted,
        # The FMU says a failure on standard error too, for importers that drop its log.
        contextlib.redirect_stderr(io.StringIO()) as said,
    ):

        def step_finished(time: float, recorder: object) -> bool:
            progress(time - what.start_time, what.duration)
            return not interrupted()

        try:
            samples = fmpy.simulate_fmu(
                folder,
                start_time=what.start_time,
                stop_time=what.stop_time,
                output_interval=what.output_interval,
                start_values={n: value for n, value in what.parameters.items() if n in known},
                fmi_type="CoSimulation",
                model_description=description,
                logger=take_message,
                debug_logging=True,
                step_finished=step_finished,
            )
        except FMICallException as error:
            # The last line it wrote is its own; pythonfmu's wrapper dresses it up in the log.
            own = [*messages, *said.getvalue().split("\n")]
            last = next((text for text in reversed(own) if text.strip()), _one_line(error))
            raise CommandError(last) from error
        except Exception as error:
            raise CommandError(f"{fmu}: {_one_line(error)}") from error
    events, hidden = events_between(samples, what.parameters["v"])
    return Run("fmu", dict(what.parameters), samples, events, hidden), messages


@contextlib.contextmanager
def _unpacked(fmu: Path) -> Iterator[str]:
    """Unpack an FMU for as long as it runs."""
    import fmpy

    from stickslip_verification.drive.fmu.errors import FmuError
    from stickslip_verification.drive.fmu.unpacking import new_folder

    try:
        folder = new_folder()
    except FmuError as error:
        raise CommandError(str(error)) from error
    try:
        fmpy.extract(str(fmu), unzipdir=str(folder))
    except Exception as error:
        shutil.rmtree(folder, ignore_errors=True)
        raise CommandError(f"{fmu}: {_one_line(error)}") from error
    try:
        yield str(folder)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _description(fmu: Path) -> Any:
    import fmpy

    if not fmu.is_file():
        reason = "it is not a file" if fmu.exists() else "there is no such file"
        raise CommandError(f"--fmu {fmu}: {reason}")
    try:
        description = fmpy.read_model_description(str(fmu))
    except Exception as error:
        raise CommandError(f"--fmu {fmu}: not an FMU: {_one_line(error)}") from error
    if description.coSimulation is None:
        raise CommandError(f"--fmu {fmu}: the FMU has no co-simulation interface")
    outputs = {v.name for v in description.modelVariables if v.causality == "output"}
    missing = [v.name for v in TABLE.rows if v.causality == "output" and v.name not in outputs]
    if missing:
        raise CommandError(f"--fmu {fmu}: the FMU has no output {', '.join(missing)}")
    return description


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__
