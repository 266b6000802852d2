"""How accurate a numerical solution is, and where it is not one of the model.

A run is as accurate as the data of the exact motion would have to be for it to lie as far away
(`Ruler`): that part of the data, delta, is the error of a solution in the terms of numerical
analysis, free of what a motion does to it. Delta differs between the cases by a factor of 1,000 for
one honest solver. So the deltas of an FMU are held against those of honest solvers in the same
cases (`matched`): where one is `STANDS_OUT` times what they are, the FMU solves another model.
"""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ..drive.exact import OFF, Exact, shifted
from ..drive.solvers import LATE
from ..model.quantities import QUANTITIES
from ..model.verdict import Run, Series
from ..suite.cases import Case
from ..truth import COULOMB_NAME
from .course import Band, Mask

MOTION: Final = ("x", "x_dot")
"""The outputs that delta is taken from; the spring force where the FMU has neither."""

_SMOOTH: Final = (*MOTION, "F")

_TIMES: Final = ("t_event", "t_stick", "t_slip", "T")
"""Outputs that are off by a step where events are found at its end."""
_COUNTED: Final = ("mode", "sticking", "n_slips", "delta_x", "spring_drop", "x_dot_peak", "f")
"""Outputs that hang, as times do, on which slips have ended."""
_CONTINUOUS: Final = ("F", "F_friction", "x_pull", "z")
"""Outputs beside the motion that are off in few points where they lag by a step."""
STANDS_OUT: Final = 20.0
"""From honest solvers, of which those outside of the family came near it (docs/theory.md)."""
SPREAD: Final = 4.0
"""How often the spread of nearby motions a solution may be off: they are only a few of all."""
SATURATED: Final = 0.1  # a point counts while the spread is below this part of the largest value
LEAST: Final = 1e-13  # below it delta is rounding
FLOOR: Final = 5e-11
"""Delta that any solution may have: the arithmetic of an exact block, which no user sees."""
IN_STICK: Final = "x in stick"  # what is off where the mass creeps
STILL: Final = 2e-4
"""Part of the pull's way that the mass may move in stick: honest solvers none, the switch model a
quarter of it."""
DIVERGED: Final = 1.0
"""Delta of a run that leaves all numbers: its steps are too long for the motion."""
REPEATS: Final = 0.25
"""Distance of the quartiles over the median of an offset that repeats; honest solvers: above 0.3,
parameters off by 0.1 to 1 % in an accurate one: below 0.18 (measured)."""
LEFT: Final = 0.4  # what an offset may leave of the deviation in the middle case
_ENOUGH, _FEW = 5, 3
"""Fewest cases that an offset is taken from, and that a large one is where it leaves `_CLEARLY`."""
_CLEARLY: Final = 0.1  # rough honest solvers leave 0.36 of that by the load, and more (measured)
LARGE: Final = 0.005  # offset from which on motions are compared, as they are not linear in it
_OFFSETS: Final = tuple(s * part for part in (0.015, 0.03, 0.05, 0.07, 0.1, 0.15) for s in (-1, 1))
_FINER: Final = (0.02, 0.01, 0.005, 0.0025, 0.001)
"""Large offsets that are tried first, and steps from the best of them."""
_PROMISING: Final = 0.8  # what the best of `_OFFSETS` may leave for its parameter to be looked at
_SLIPS: Final = 3  # that are compared then: more of them are out of step
_POINTS: Final = 20  # fewest of a run in these slips
_SHORTEST: Final = 12  # cases that are compared then
_NEAR: Final = 6
"""Points count that are not saturated at this one of `OFF`: there the motion is nearly linear."""
_MOVES: Final = 1e-3
"""Least change, over the largest value, of a parameter that matters in a case, for each part."""
_CREEP: Final = 1e-6  # a slip that is slower, over the largest speed, may be called a stick
_ALIKE: Final = 4
"""How many solvers are matched, the nearest ones: more of them excuse a fault, fewer accuse."""
_FARTHEST: Final = 2.0
"""Largest misfit of one case, as a logarithm: what stands out does not choose the solver."""


@dataclass(frozen=True)
class Deviation:
    """How far off a run is: delta, and the output and time [s] that show it."""

    delta: float
    output: str = ""
    time: float = 0.0


@dataclass(frozen=True)
class Ruler:
    """Measures the delta of runs of one case.

    ``spreads``: how far each output of ``exact`` moves when the data are off by `OFF`.
    """

    exact: Exact
    spreads: Mapping[str, Series]

    def deviation(self, run: Run, names: Collection[str] = (), step: float = 0.0) -> Deviation:
        """Return the largest delta of a run in some of its outputs, by default those of the motion.

        Times may be off by a `step` [s]. ``run`` may hold some of the points of the exact motion
        only. Beyond the delta at which a point is saturated it counts with that delta: it is at
        least as large.
        """
        worst = Deviation(0.0)
        for name in filter(run.outputs.__contains__, names or motion_of(run)):
            discrete, smooth = QUANTITIES[name].discrete, name in _SMOOTH
            read, expected, got, counted = self.band.pair(name, run)
            where = np.flatnonzero(counted)
            if not where.size:
                continue
            error = np.abs(got - expected)
            if name in _TIMES:
                error = np.maximum(error - step, 0.0)
            if not smooth:
                # What jumps at an event may jump at the next point.
                low, high = (each[read] - self._at(name)[read] for each in self._about(name))
                between = np.fmax(np.fmax(expected + low - got, got - expected - high), 0.0)
                error = np.where(self._near_event[read], 0.0 if discrete else between, error)
            if name == "x_dot_peak":
                # The extreme may be that of the communication points.
                part = got * np.sign(expected)
                seen = part >= (1.0 - STANDS_OUT * FLOOR) * self.sampled_peak[read]
                error = np.where(seen & (part <= np.abs(expected)), 0.0, error)
            if name in (*_COUNTED, *_TIMES):
                error = np.where(self._crept[read], 0.0, error)
            largest = self.band.largest(name) or float(discrete)
            parts = largest * np.array(OFF)[:, np.newaxis]
            columns = np.maximum(SPREAD * self.spreads[name], parts)
            if not smooth:
                columns = np.where(self._other_phase, np.inf, columns)
            deltas = _deltas(error[where], columns[:, read[where]], SATURATED * largest)
            place = int(np.argmax(deltas))
            if deltas[place] > worst.delta:
                worst = Deviation(float(deltas[place]), name, float(run.times[where[place]]))
        return worst

    def throughout(self, run: Run, delta: float) -> Deviation | None:
        """Return an output beside the motion that is off in half of the points, if there is one.

        Points count at which data that are off by `delta` move it little.
        """
        row = min(int(np.searchsorted(OFF, delta)), len(OFF) - 1)
        for name in set(_CONTINUOUS) & set(run.outputs) - set(motion_of(run)):
            read, expected, got, counted = self.band.pair(name, run)
            still = SPREAD * self.spreads[name][row] <= SATURATED * self.band.largest(name)
            error = np.abs(got - expected)[counted & still[read]]
            if error.size and np.median(error) > SATURATED * (self.band.largest(name) or np.inf):
                return Deviation(DIVERGED, name, float(run.times[int(np.argmax(error))]))
        return None

    def creep(self, run: Run, delta: float) -> Deviation:
        """Return the largest part of the pull's way that the mass moves in stick.

        Points count where data off by 20 times `delta` lead to the same stick.
        """
        row = int(np.searchsorted(OFF, STANDS_OUT * delta))
        if row == len(OFF) or "x" not in run.outputs:
            return Deviation(0.0)
        read, _, x, _ = self.band.pair("x", run)
        stick = (self._at("mode") == 0.0) & ~self._other_phase[row] & ~self._near_event
        count, pull = self._at("n_slips")[read], np.abs(np.diff(self._at("x_pull")[read]))
        both = stick[read][1:] & stick[read][:-1] & (np.diff(count) == 0.0) & (pull > 0.0)
        parts = np.where(both, np.abs(np.diff(x)), 0.0) / np.where(both, pull, 1.0)
        place = int(np.argmax(parts)) if parts.size else 0
        largest = float(parts[place]) if parts.size else 0.0
        return Deviation(largest, IN_STICK, float(run.times[place]))

    @cached_property
    def sampled_peak(self) -> Series:
        """Largest speed at the communication points of the slip that was completed last."""
        count = self._at("n_slips").astype(np.intp)
        highest = np.zeros(count.max() + 2)
        np.maximum.at(highest, count + 1, np.abs(self._at("x_dot")) * (self._at("mode") != 0.0))
        return highest[count]

    @cached_property
    def _other_phase(self) -> Mask:
        """Where data off by as much have led to another stick or slip; shape ``(len(OFF), n)``."""
        return np.asarray((self.spreads["n_slips"] > 0.0) | (self.spreads["mode"] > 0.0))

    @cached_property
    def _near_event(self) -> Mask:
        """Points before or after which a transition comes."""
        record = self.exact.record
        changes = np.isin(record.times, self.exact.event_times)
        for name in ("mode", "n_slips", "t_event"):
            changes |= np.diff(self._at(name), prepend=record.initial[name]) != 0.0
        return np.asarray(changes | np.append(changes[1:], False))

    @cached_property
    def _crept(self) -> Mask:
        """Points from which on a slip has faded that has no end: a solver ends it at some speed."""
        slow = np.abs(self._at("x_dot")) < _CREEP * self.band.largest("x_dot")
        return np.logical_or.accumulate((self._at("mode") != 0.0) & slow)

    def _at(self, name: str) -> Series:
        return self.exact.record.outputs[name]

    def _about(self, name: str) -> tuple[Series, Series]:
        """Return the least and largest value of an output at each point and the two beside it."""
        samples = self._at(name)
        first = self.exact.record.initial[name]
        beside = np.stack([samples, np.append(first, samples[:-1]), np.append(samples[1:], np.nan)])
        return np.fmin.reduce(beside), np.fmax.reduce(beside)

    def moved(self, name: str, delta: float) -> Series:
        """Return how far an output lies off at each point where the data are off by `delta`.

        NaN where the number of slips hangs on less.
        """
        at = np.interp(math.log(max(delta, LEAST)), np.log(OFF), np.arange(len(OFF)))
        low = min(int(at), len(OFF) - 2)
        below, above = self.spreads[name][low], self.spreads[name][low + 1]
        between = below + (at - low) * (above - below)
        other = self._other_phase[min(math.ceil(at), len(OFF) - 1)]
        return np.where(other, np.nan, between * min(delta / OFF[0], 1.0))

    @property
    def decided(self) -> Mask:
        """Points at which stick or slip does not hang on the millionth part of the data."""
        return np.asarray(~self._other_phase[OFF.index(1e-6)])

    @cached_property
    def band(self) -> Band:
        """What is physics and what was only agreed on."""
        return Band(self.exact)


def motion_of(run: Run) -> Collection[str]:
    """Return the outputs of a run that show its motion."""
    return [name for name in MOTION if name in run.outputs] or ["F"]


def _deltas(error: Series, columns: Series, limit: float) -> Series:
    """Return by how much data are off that move each point by its error.

    ``columns`` are the distances at each of `OFF`, shape ``(len(OFF), n)`` and rising.
    """
    off = np.array(OFF)
    usable = np.sum(columns <= limit, axis=0)
    above = np.sum(columns < error, axis=0)
    points = np.arange(error.size)
    low, high = np.clip(above - 1, 0, off.size - 1), np.clip(above, 0, off.size - 1)
    with np.errstate(divide="ignore", invalid="ignore"):
        part = np.log(error / columns[low, points]) / np.log(
            columns[high, points] / columns[low, points]
        )
        between = off[low] * (off[high] / off[low]) ** np.clip(part, 0.0, 1.0)
        found = np.where(above == 0, off[0] * error / columns[0], between)
    found = np.where(above >= usable, np.where(usable > 0, off[usable - 1], 0.0), found)
    found = np.where((error == 0.0) | (usable == 0), 0.0, found)
    return np.where(np.isfinite(error), found, np.inf)


@dataclass(frozen=True)
class Plain:
    """The plain run of a case, or of a random sequence, and the output that is off, if one is."""

    case: Case
    ruler: Ruler
    run: Run
    output: str = ""

    @property
    def exact(self) -> Run:
        """The exact motion."""
        return self.ruler.exact.record

    @cached_property
    def motion(self) -> Deviation:
        """Delta of the motion."""
        return self.ruler.deviation(self.run)

    def of(self, output: str) -> float:
        """Return the delta of one output, at least `FLOOR`."""
        return max(self.ruler.deviation(self.run, [output]).delta, FLOOR)

    def left(self, name: str, part: float) -> float:
        """Return how much of the area is left if a parameter is larger by a part."""
        try:
            return self._area_to(shifted(self.case, name, part)) / self.area
        except ValueError:
            # The case does not allow it: the mass would lift off.
            return 1.0

    @cached_property
    def _read(self) -> NDArray[np.intp]:
        read = np.searchsorted(self.exact.times, self.run.times)
        return read[self.exact.outputs["n_slips"][read] < _SLIPS]

    @cached_property
    def area(self) -> float:
        """Area between the run and the exact motion; 0 without slips, or points enough in them."""
        slips = self.ruler.exact.facts.slips
        area = self._area_to(self.exact) if slips >= _SLIPS and self._read.size >= _POINTS else 0.0
        return area if area < np.inf else 0.0

    def _area_to(self, motion: Run) -> float:
        """Return the area between the run and a motion over the first slips."""
        size = self._read.size
        return sum(
            float(np.mean(np.abs(self.run.outputs[name][:size] - motion.outputs[name][self._read])))
            / (self.ruler.band.largest(name) or 1.0)
            for name in ("x", "F")
            if name in self.run.outputs
        )


@dataclass(frozen=True)
class Matched:
    """The honest solvers that an FMU is most like, ``solver`` the most.

    ``alike`` are all that are matched, with the deltas of the FMU over theirs; ``expected`` is the
    largest delta that they have in each case times these factors. ``adapts``: the steps of the FMU
    are adapted to the motion, so that no two runs have the same.
    """

    solver: str
    expected: Mapping[str, float]
    alike: Mapping[str, float]
    adapts: bool = False


def matched(deltas: Mapping[str, float], family: Mapping[str, Mapping[str, float]]) -> Matched:
    """Match deltas by case with those of a family by solver and case, one free factor each."""
    if not deltas:
        return Matched(next(iter(family)), {}, {})
    logarithms = {
        solver: np.log(np.clip([of[case] for case in deltas], LEAST, DIVERGED))
        for solver, of in {**family, "": deltas}.items()
    }
    got = logarithms.pop("")
    nearest: dict[str, tuple[float, str, float, Series]] = {}
    for solver, own in logarithms.items():
        factor = float(np.median(got - own))
        misfit = float(np.mean(np.minimum(np.abs(got - own - factor), _FARTHEST)))
        # Of a solver and the one that breaks away later, the nearer one counts.
        pair = solver.removesuffix(LATE)
        if pair not in nearest or misfit < nearest[pair][0]:
            nearest[pair] = misfit, solver, factor, own + factor
    near = sorted(nearest.values(), key=lambda fit: fit[0])[:_ALIKE]
    expected = np.maximum(np.exp(np.max([own for *_, own in near], axis=0)), FLOOR).tolist()
    alike = {name: math.exp(factor) for _, name, factor, _ in near}
    return Matched(near[0][1], dict(zip(deltas, expected, strict=True)), alike)


@dataclass(frozen=True)
class WrongParameter:
    """A parameter that acts as another value in every case: `part` larger than what is set."""

    name: str
    part: float


def wrong_parameter(
    runs: Mapping[str, Plain], changes: Mapping[tuple[str, str], Mapping[str, Series]]
) -> WrongParameter | None:
    """Return the parameter whose wrong value explains the runs of an FMU, if there is one.

    ``changes`` are the outputs' changes by case and parameter, for each part that it is larger. The
    offset that fits a case best has to repeat over the cases, and to leave little behind.
    """
    found = []
    for name in dict.fromkeys(name for _, name in changes):
        of = [(run, changes[case, name]) for case, run in runs.items() if (case, name) in changes]
        known = [fit for run, change in of if (fit := _offset(run, change)) is not None]
        if len(known) < _ENOUGH:
            continue
        offsets, left = np.array(known).T
        low, part, high = np.quantile(offsets, (0.25, 0.5, 0.75))
        if high - low <= REPEATS * abs(part) and np.median(left) <= LEFT:
            found.append((float(np.median(left)), WrongParameter(name, float(part))))
    return min(found, key=lambda each: each[0])[1] if found else None


def _offset(plain: Plain, change: Mapping[str, Series]) -> tuple[float, float] | None:
    """Return the part by which a parameter is off that fits a run, and what that leaves behind."""
    ruler, got, exact = plain.ruler, plain.run.outputs, plain.exact.outputs
    errors, moved = [], []
    for name, by in change.items():
        largest = ruler.band.largest(name)
        if name not in got or not largest:
            continue
        near = SPREAD * ruler.spreads[name][_NEAR] <= SATURATED * largest
        errors.append(((got[name] - exact[name]) / largest)[near])
        moved.append((by / largest)[near])
    error, move = np.concatenate([[], *errors]), np.concatenate([[], *moved])
    if not np.all(np.isfinite(error)) or np.max(np.abs(move), initial=0.0) < _MOVES:
        return None
    part = float(error @ move / (move @ move))
    size = float(np.linalg.norm(error))
    return part, float(np.linalg.norm(error - part * move)) / size if size else 1.0


def large_offset(
    runs: Mapping[str, Plain], names: Collection[tuple[str, str]]
) -> WrongParameter | None:
    """Return the parameter that is off by `LARGE` or more and explains the runs, if there is one.

    The motion with the same offset in all cases has to leave little of the area between a run and
    the exact motion; it is looked for among a few offsets, and from the best of them. ``names`` are
    the parameters that matter, by case. It takes hundreds of exact motions, so only cases of
    Coulomb's law count, whose motions are quick.
    """
    quick = sorted(runs.values(), key=lambda run: len(run.case.steps))
    usable = [run for run in quick if run.case.law == COULOMB_NAME and run.area > 0.0]
    found: list[tuple[float, WrongParameter]] = []
    for name in dict.fromkeys(name for _, name in names):
        of = [run for run in usable if (run.case.id, name) in names][:_SHORTEST]
        few, of_all = partial(_left, name, of[:_ENOUGH]), partial(_left, name, of)
        # What brings no motion nearer when it is small brings none nearer when it is large.
        if len(of) < _FEW or min(map(few, _OFFSETS[:2])) >= 1.0:
            continue
        if few(part := min(_OFFSETS, key=few)) > _PROMISING:
            continue
        for width in _FINER:
            part = min((part, part - width, part + width), key=of_all)
        left, most = of_all(part), LEFT if len(of) >= _ENOUGH else _CLEARLY
        if left <= most and abs(part) >= LARGE:
            found.append((left, WrongParameter(name, part)))
    return min(found, key=lambda each: each[0])[1] if found else None


def _left(name: str, runs: Sequence[Plain], part: float) -> float:
    """Return what a parameter that is larger by a part leaves of the areas in the middle case."""
    return float(np.median([run.left(name, part) for run in runs]))
