"""One simulation run, whatever engine made it: samples of every output, and the events between.

Samples go to CSV files in fmpy's format, which `fmpy.util.read_csv` reads back.
"""

import math
import os
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import numpy as np
from fmpy.util import write_csv as _fmpy_write_csv
from numpy.typing import NDArray

from stickslip.files import writing
from stickslip.parameters import Parameters
from stickslip_verification.model.verdict import Event

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
    """Return the times at which a run is sampled, as `fmpy.simulate_fmu` chooses them.

    Parameters
    ----------
    start_time, stop_time
        First and last time [s], `stop_time` > `start_time`.
    output_interval
        Distance of the samples [s], > 0; the last one may be shorter.

    Returns
    -------
    ndarray, shape (n,)
        `start_time`, every whole interval after it, and `stop_time`.
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


def drawable_interval(duration: float, step: float, w: float) -> float:
    """Halve `step` [s] until a slip is drawn smoothly, or 20,000 of it make `duration` [s].

    Parameters
    ----------
    duration
        Length of the run [s].
    step
        The interval to begin with [s].
    w
        Natural frequency [rad/s]; a step of half a radian is smooth.
    """
    shortest = max(0.5 / w, duration / 20_000)
    return step / 2.0 ** max(0, math.ceil(math.log2(step / shortest)))


def csv_bytes(samples: NDArray[np.void]) -> bytes:
    """Return samples as the bytes of a CSV file.

    fmpy writes a Boolean as ``True``, which its own reader refuses, so Booleans become 0 and 1.

    Parameters
    ----------
    samples
        Structured array, shape (n,): ``time`` [s] and outputs, SI.
    """
    numeric = np.dtype(
        [
            (name, np.int8 if samples.dtype[name] == np.bool_ else samples.dtype[name])
            for name in samples.dtype.names or ()
        ]
    )
    with tempfile.TemporaryFile() as stream:
        # fmpy opens and closes what it is given: a second descriptor of the stream.
        _fmpy_write_csv(os.dup(stream.fileno()), samples.astype(numeric))
        stream.seek(0)
        return stream.read()


def write_csv(samples: NDArray[np.void], target: Path, option: str) -> None:
    """Write samples to `target`; a file is written whole or not at all.

    Parameters
    ----------
    samples
        As for `csv_bytes`.
    target
        The file.
    option
        The option that named it, for the message.

    Raises
    ------
    CommandError
        If the file cannot be written.
    """
    with writing(target, option) as stream:
        stream.write(csv_bytes(samples))
