"""A probe of a long run: the cycle at its end must be that of its beginning."""

import time
from collections.abc import Mapping

import numpy as np

from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.stepping import NotApplicableError, defaults, lacking, need

_ALIKE = 0.05
"""Difference of mean and of deviation, as a part of the deviation: what the points' places in the
cycles make is a fifth of it."""


def keeps_its_cycle(
    fmu: FmuFile,
    parameters: Mapping[str, float],
    step: float,
    count: int,
    window: int,
    seconds: float,
) -> list[str]:
    """Complain if the elongation of the spring is another one at the end of a long run.

    Its `parameters` (SI) differ from our defaults. Of `count` steps of `step` [s] a `window` is
    compared at the beginning and at the end. After `seconds` of the processor, or twice as much of
    the clock, it ends with fewer. `NotApplicableError` if the FMU lacks a parameter, is too slow
    for a run that is long, or diverges from the beginning.
    """
    need(fmu, lacking(fmu, parameters))
    values = {**defaults(fmu), **parameters}
    name = "x" if fmu.has("x") else "F"
    seen, end, last_call = [], time.process_time() + seconds, time.monotonic() + 2.0 * seconds
    with fmu.instantiate() as instance:
        instance.start({name: value for name, value in values.items() if fmu.has(name)})
        read = instance.reader([name])
        for number in range(count):
            instance.step(number * step, step)
            seen.append(read()[0])
            if number % 1000 == 0:
                instance.messages.clear()
                if time.process_time() > end or time.monotonic() > last_call:
                    break
    if len(seen) < 4 * window:
        raise NotApplicableError(f"{len(seen)} steps in {seconds:g} s are too few for a long run")
    shown = np.array(seen)
    if name == "x":
        shown = values["v"] * step * np.arange(1, shown.size + 1) - shown
    first, last = shown[window : 2 * window], shown[-window:]
    if not np.all(np.isfinite(first)):
        raise NotApplicableError("its steps are too long for this block")
    spread = float(np.std(first))
    moved = abs(float(np.mean(last) - np.mean(first))), abs(float(np.std(last)) - spread)
    if max(moved) <= _ALIKE * spread:
        return []
    return [
        f"after {shown.size * step:.0f} s the spring is stretched otherwise than at the beginning: "
        f"mean {np.mean(last):.4g}, not {np.mean(first):.4g}; deviation {np.std(last):.4g}, not "
        f"{spread:.4g}"
    ]
