"""The cycle meter: what is read off the phases of a motion as they end; docs/theory.md (16)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from ..trajectory import EventKind, MeasuredCycle


@dataclass(frozen=True)
class Phase:
    """A completed stick or slip.

    Attributes
    ----------
    ended_by : str
        The kind of event that ended it: a break-away ends a stick, the others a slip.
    end : float
        Time of that event [s].
    duration : float
        Its length [s].
    delta_x, spring_drop : float
        Displacement of the mass and fall of z over it [m].
    x_dot_peak : float
        Extreme velocity [m/s]; 0 in stick.
    """

    ended_by: EventKind
    end: float
    duration: float
    delta_x: float = 0.0
    spring_drop: float = 0.0
    x_dot_peak: float = 0.0


@dataclass(frozen=True)
class Reading:
    """What the meter shows; names and units are those of `Trajectory`."""

    t_event: float
    delta_x: float = 0.0
    spring_drop: float = 0.0
    x_dot_peak: float = 0.0
    t_stick: float = 0.0
    t_slip: float = 0.0
    T: float = 0.0
    f: float = 0.0
    n_slips: int = 0


def readings(phases: Iterable[Phase], start_time: float) -> list[Reading]:
    """Return the readings before the first event and after each one."""
    shown = [Reading(t_event=start_time)]
    since_break_away: float | None = None
    for phase in phases:
        last = replace(shown[-1], t_event=phase.end)
        if since_break_away is not None:
            since_break_away += phase.duration
        if phase.ended_by == "break-away":
            T = since_break_away
            last = replace(last, t_stick=phase.duration)
            if T is not None:
                last = replace(last, T=T, f=1.0 / T if T > 0.0 else 0.0)
            since_break_away = 0.0
        else:
            last = replace(
                last,
                t_slip=phase.duration,
                delta_x=phase.delta_x,
                spring_drop=phase.spring_drop,
                x_dot_peak=phase.x_dot_peak,
                n_slips=last.n_slips + 1,
            )
        shown.append(last)
    return shown


def measured_cycles(phases: Iterable[Phase], shown: list[Reading]) -> tuple[MeasuredCycle, ...]:
    """Return the cycles that ``phases`` complete, given their `readings`."""
    cycles = []
    began: float | None = None
    for phase, reading in zip(phases, shown[1:], strict=True):
        if phase.ended_by != "break-away":
            continue
        if began is not None:
            cycles.append(
                MeasuredCycle(
                    t_break_away=began,
                    t_stick=reading.t_stick,
                    t_slip=reading.t_slip,
                    T=reading.T,
                    delta_x=reading.delta_x,
                    spring_drop=reading.spring_drop,
                    x_dot_peak=reading.x_dot_peak,
                )
            )
        began = phase.end
    return tuple(cycles)
