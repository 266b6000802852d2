"""Samples as a CSV file in fmpy's format, which `fmpy.util.read_csv` reads back."""

import os
import tempfile
from pathlib import Path

import numpy as np
from fmpy.util import write_csv as _fmpy_write_csv
from numpy.typing import NDArray

from stickslip.files import writing


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
