"""A run: every output at every communication point, from an FMU or from the reference."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Series = NDArray[np.float64]


@dataclass(frozen=True)
class Run:
    """The outputs of one run, in SI units, sampled at the end of each communication step.

    ``times`` are the communication points after the start [s], shape ``(n,)``. ``outputs`` are the
    samples by name, shape ``(n,)`` each; integers and Booleans as numbers; an output that the side
    does not have is not among the keys. ``initial`` are the values after initialization,
    ``messages`` what the side logged, in order: warnings of the clamp, for example.
    """

    times: Series
    outputs: Mapping[str, Series]
    initial: Mapping[str, float]
    messages: tuple[str, ...] = field(default=())
