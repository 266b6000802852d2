"""Changes of inputs and tunable parameters during a run; each value holds until the next one."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

from ..laws import FrictionLaw
from ..parameters import FrictionClampWarning, Parameters

INPUTS = ("v", "load", "F_ext")
TUNABLE = ("k", "c", "mu_s", "mu_k")


@dataclass(frozen=True)
class Change:
    """New values of inputs or tunable parameters, acting from a time on.

    Parameters
    ----------
    time : float
        From when they act [s].
    values : mapping of str to float
        Values by name, in SI units: inputs ``v``, ``load``, ``F_ext``, tunable parameters ``k``,
        ``c``, ``mu_s``, ``mu_k``. What is not named stays as it is.
    own : mapping of str to float, optional
        Values of the friction law's own tunable parameters by name, in SI units.

    Raises
    ------
    ValueError
        If the time is not finite, a name is none of these or a value is no finite number. Ranges
        are checked where the values meet the parameters, in `simulate`.
    """

    time: float
    values: Mapping[str, float]
    own: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not math.isfinite(self.time):
            raise ValueError(f"time = {self.time!r} s of a change is out of range; must be finite")
        for name, value in self.values.items():
            if name not in INPUTS + TUNABLE:
                raise ValueError(
                    f"{name} = {value!r} cannot change during a run; these can: "
                    f"{', '.join(INPUTS + TUNABLE)}"
                )
            if not isinstance(value, int | float) or not math.isfinite(value):
                raise ValueError(f"{name} = {value!r} at {self.time!r} s must be a finite number")
        object.__setattr__(self, "values", MappingProxyType(dict(self.values)))
        object.__setattr__(self, "own", MappingProxyType(dict(self.own)))


@dataclass(frozen=True)
class Segment:
    """A stretch of time in which inputs and parameters hold; ``end`` counts from the start [s]."""

    end: float
    p: Parameters


def segments(
    p: Parameters,
    changes: Iterable[Change],
    start_time: float,
    stop_time: float,
    law: FrictionLaw,
) -> list[Segment]:
    """Cut a run at its changes.

    Changes at the start act from the start; of several at one time the later in the sequence
    wins; those at or after the stop show nothing any more and are left out.

    Raises
    ------
    ValueError
        If a change lies before the start, takes a parameter out of its range, or sets a parameter
        of the friction law that is not tunable.
    """
    result: list[Segment] = []
    stop = stop_time - start_time
    for change in sorted(changes, key=lambda each: each.time):
        if change.time < start_time:
            raise ValueError(
                f"a change at {change.time!r} s lies before the start of the run at "
                f"{start_time!r} s"
            )
        elapsed = change.time - start_time
        if elapsed >= stop > 0.0:
            break
        if elapsed > (result[-1].end if result else 0.0):
            result.append(Segment(elapsed, p))
        p = _changed(p, change, law)
    result.append(Segment(stop, p))
    return result


def _changed(p: Parameters, change: Change, law: FrictionLaw) -> Parameters:
    for name, value in change.own.items():
        if name in law.parameters and not law.parameters[name].tunable:
            raise ValueError(f"{name} = {value!r} at {change.time!r} s cannot change during a run")
    values: Mapping[str, Any] = change.values
    with warnings.catch_warnings():
        if not {"mu_s", "mu_k"} & values.keys():
            # The clamp was warned of when the friction coefficients were set.
            warnings.simplefilter("ignore", FrictionClampWarning)
        return law.complete(replace(p, **values), {**p.own, **change.own})
