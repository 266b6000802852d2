"""A run: every output at every communication point, from an FMU or from the reference."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from stickslip_verification.truth import Step

Series = NDArray[np.float64]

CommunicationStep = Step
"""One step of ``h`` [s]; ``changes`` (name to value, SI) are set just before it."""


def points(lengths: Iterable[float]) -> tuple[float, ...]:
    """Partial sums, each correctly rounded (Neumaier's compensation), starting at 0."""
    total = carry = 0.0
    ends = []
    for h in lengths:
        bigger = total + h
        carry += (total - bigger) + h if abs(total) >= abs(h) else (h - bigger) + total
        total = bigger
        ends.append(total + carry)
    return tuple(ends)


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


class Transition(StrEnum):
    """The kinds of transition: stick to slip, slip to stick, slip to slip the other way."""

    BREAK_AWAY = "break-away"
    RE_STICK = "re-stick"
    REVERSAL = "reversal"


@dataclass(frozen=True)
class Event:
    """A transition at a time [s]: the mode from then on, position x and extension z [m]."""

    time: float
    kind: Transition
    mode: int
    x: float
    z: float


def events_between(samples: NDArray[np.void], v: float) -> tuple[tuple[Event, ...], int]:
    """Recover the transitions between the samples from the outputs, inputs being constant.

    A sample tells the time of the last transition and the length of the last stick and slip; that
    dates up to two transitions in an interval exactly. The mass does not move while it sticks and
    the pulled end moves at constant speed, so the place of each follows without interpolation.

    ``samples``, shape (n,), are structured: ``time`` and the outputs ``mode``, ``n_slips``,
    ``t_event``, ``t_stick``, ``t_slip``, ``delta_x``, ``x``, ``x_pull``; `v` is the velocity of the
    pulled end [m/s]. The second value is the number of intervals that hold more than two
    transitions, or cannot be told for such an interval just before.
    """
    first = samples[0]
    # What an unseen or an unfinished slip began from: the first sample.
    origin = _event(first, float(first["time"]), Transition.BREAK_AWAY, float(first["x"]), v)
    events = [origin] if first["mode"] != 0 and first["x_dot"] == 0.0 else []
    previous: Event | None = origin
    hidden = 0
    changed = np.flatnonzero(
        (np.diff(samples["t_event"]) != 0.0) | (np.diff(samples["n_slips"]) != 0)
    )
    for before, after in zip(samples[changed], samples[changed + 1], strict=True):
        found = _events_in(before, after, previous, v)
        hidden += not found
        events.extend(found)
        previous = found[-1] if found else None
    return tuple(events), hidden


def _events_in(before: np.void, after: np.void, previous: Event | None, v: float) -> list[Event]:
    """Return the one or two transitions between two samples; nothing where they cannot be told.

    That is where there are more, or where a slip ends whose beginning is hidden: `previous` None.
    """
    time, slips = float(after["t_event"]), int(after["n_slips"]) - int(before["n_slips"])
    slipped, slips_now = before["mode"] != 0, after["mode"] != 0
    if slips == 0 and not slipped and slips_now:
        return [_event(after, time, Transition.BREAK_AWAY, float(before["x"]), v)]
    if slips == 1 and not slips_now:
        stop = _event(after, time, Transition.RE_STICK, float(after["x"]), v, mode=0)
        if slipped:
            return [stop]
        mode, broke_away = 1 if after["delta_x"] > 0 else -1, time - float(after["t_slip"])
        return [_event(after, broke_away, Transition.BREAK_AWAY, float(before["x"]), v, mode), stop]
    if slips == 1 and slipped and previous is not None:
        x = previous.x + float(after["delta_x"])
        t_stick = float(after["t_stick"])
        after_slip = time - previous.time - float(after["t_slip"])
        # A break-away the other way needs a stick in which the spring comes over: after a slip
        # that ended just now it was none.
        reversed_at_once = abs(after_slip) <= abs(after_slip - t_stick)
        if after["mode"] == -before["mode"] and reversed_at_once:
            return [_event(after, time, Transition.REVERSAL, x, v)]
        return [
            _event(after, time - t_stick, Transition.RE_STICK, x, v, mode=0),
            _event(after, time, Transition.BREAK_AWAY, x, v),
        ]
    return []


def _event(
    sample: np.void, time: float, kind: Transition, x: float, v: float, mode: int | None = None
) -> Event:
    x_pull = float(sample["x_pull"]) - v * (float(sample["time"]) - time)
    return Event(time, kind, int(sample["mode"]) if mode is None else mode, x, x_pull - x)
