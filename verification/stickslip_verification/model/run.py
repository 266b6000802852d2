"""A run: every output at every communication point, from an FMU or from the reference."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Series = NDArray[np.float64]


@dataclass(frozen=True)
class Run:
    """The outputs of one run, in SI units, sampled at the end of each communication step.

    Attributes
    ----------
    times
        Communication points after the start [s], shape ``(n,)``.
    outputs
        Output name to its samples, shape ``(n,)`` each; integers and Booleans as numbers.
        An output that the side does not have is not among the keys.
    initial
        Output name to its value at the start, after initialization.
    messages
        What the side logged, in order: warnings of the clamp, for example.
    """

    times: Series
    outputs: Mapping[str, Series]
    initial: Mapping[str, float]
    messages: tuple[str, ...] = field(default=())
