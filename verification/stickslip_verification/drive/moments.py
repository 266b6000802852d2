"""An FMU's samples beside the exact motion at the same moment of the same stick or slip.

An FMU that integrates breaks away and re-sticks a little early or late. At one time it may then
stick where the exact motion slips, and its forces differ by as much as they fall in a slip. So a
sample is not compared at its time but at its moment: the stick or slip it lies in, numbered by the
completed slips, and the time since that began.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip_verification.drive.exact import Exact, sampled
from stickslip_verification.drive.stepping import NotApplicableError
from stickslip_verification.model.run import Run, Series
from stickslip_verification.suite.cases import Case, follow
from stickslip_verification.suite.experiment import CommunicationStep

_INSIDE = 1e-6
"""Part of a phase by which a moment stays away from its ends, where rounding decides the phase."""

_EARLY = 1e-6
"""Part of a communication step by which a transition may seem to lie outside its step."""


@dataclass(frozen=True)
class Moments:
    """Samples of an FMU that have a counterpart in the exact motion.

    Attributes
    ----------
    places
        Numbers of the samples, shape ``(n,)``.
    exact
        The exact outputs at the same moments, shape ``(n,)`` each.
    dated
        Whether the time since the phase began is known, shape ``(n,)``; elsewhere the moment is any
        of the phase.
    lost
        How many samples lie in a phase that the exact motion does not have, or has on the other
        side of a change.
    """

    places: NDArray[np.intp]
    exact: Mapping[str, Series]
    dated: NDArray[np.bool_]
    lost: int


def moments(case: Case, exact: Exact, run: Run) -> Moments:
    """Find the exact motion at the moments of an FMU's samples.

    Raises
    ------
    NotApplicableError
        The FMU does not tell its phases: it lacks n_slips, or sticking and mode.
    """
    slips, sticks = _phases(run)
    begins = _begins(run, slips, sticks)
    changes = np.array(
        [time for time, step in zip((0.0, *case.times), case.steps, strict=False) if step.changes]
    )
    ends = [each.begin for each in exact.phases[1:]] + [np.inf]
    known = {
        (each.slips, each.sticks): (each, end) for each, end in zip(exact.phases, ends, strict=True)
    }
    places, times, dated = [], [], []
    lost = 0
    for place, time in enumerate(run.times):
        found = known.get((int(slips[place]), bool(sticks[place])))
        if found is None:
            lost += 1
            continue
        phase, end = found
        age = time - begins[place]
        if not np.isfinite(age):
            moment = float(time)
        elif end == np.inf and phase.begin + age > run.times[-1]:
            continue
        else:
            moment = phase.begin + age
        last = min(end, float(run.times[-1]))
        margin = _INSIDE * (last - phase.begin)
        moment = min(max(moment, phase.begin + margin), last - margin if end < np.inf else last)
        if np.searchsorted(changes, moment) == np.searchsorted(changes, time):
            places.append(place)
            times.append(moment)
            dated.append(bool(np.isfinite(age)))
        else:
            lost += 1
    return Moments(
        np.array(places, dtype=np.intp), _at(case, times), np.array(dated, dtype=bool), lost
    )


def _phases(run: Run) -> tuple[Series, NDArray[np.bool_]]:
    """Return the completed slips and whether the mass sticks, sample by sample."""
    outputs = run.outputs
    if "n_slips" not in outputs:
        raise NotApplicableError("it has no output n_slips")
    if "sticking" in outputs:
        return outputs["n_slips"], outputs["sticking"] != 0.0
    if "mode" in outputs:
        return outputs["n_slips"], outputs["mode"] == 0.0
    raise NotApplicableError("it has no output sticking or mode")


def _begins(run: Run, slips: Series, sticks: NDArray[np.bool_]) -> Series:
    """Return when the phase of each sample began [s]; NaN where that is not known.

    An FMU without t_event shows the length of the phase before, as t_stick or t_slip.
    """
    outputs = run.outputs
    if "t_event" in outputs:
        return outputs["t_event"]
    begins = np.full(run.times.shape, np.nan)
    if "t_stick" not in outputs or "t_slip" not in outputs:
        return begins
    begin, before = 0.0, 0.0
    number = run.initial["n_slips"]
    stuck = bool(run.initial.get("sticking", run.initial.get("mode", 0.0) == 0.0))
    for place, time in enumerate(run.times):
        if (slips[place], sticks[place]) != (number, stuck):
            left = int(slips[place] - number)
            if stuck and left in (0, 1):
                begin += outputs["t_stick"][place]
            if left == 1:
                begin += outputs["t_slip"][place]
            if left not in (0, 1) or not (
                before - _EARLY * (time - before) <= begin <= time + _EARLY * (time - before)
            ):
                break
            number, stuck = slips[place], bool(sticks[place])
        begins[place] = begin
        before = float(time)
    return begins


def _at(case: Case, times: Sequence[float]) -> dict[str, Series]:
    """Return the exact outputs at these times [s] of a case, each above 0.

    The steps of the case are cut there. A part is a multiple of the last place of its step, so the
    parts add up to the step without rounding, and every change acts at its very time; to set it
    again before the next part has no effect.
    """
    wanted = np.array(times, dtype=np.float64)
    inside = np.searchsorted(case.times, wanted)
    cuts: dict[int, set[float]] = {}
    asked = []
    for number, time in zip(inside.tolist(), wanted.tolist(), strict=True):
        h = case.steps[number].h
        place = math.ulp(h)
        since = time - (case.times[number - 1] if number else 0.0)
        cut = min(max(round(since / place), 1) * place, h)
        cuts.setdefault(number, set()).add(cut)
        asked.append((number, cut))
    steps: list[CommunicationStep] = []
    sample: dict[tuple[int, float], int] = {}
    for number, step in enumerate(case.steps):
        before = 0.0
        for cut in sorted({*cuts.get(number, ()), step.h}):
            sample[number, cut] = len(steps)
            steps.append(CommunicationStep(cut - before, step.changes))
            before = cut
    outputs = sampled(follow(case.parameters, steps, case.law))
    places = [sample[each] for each in asked]
    return {name: values[places] for name, values in outputs.items()}
