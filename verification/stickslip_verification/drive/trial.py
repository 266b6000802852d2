"""A trial run of an FMU whose names are not known: which of its variables moves as which of ours.

The likeliest parameters are set, here and in the reference. A variable of the FMU that then follows
a curve of the reference is that one, also with the other sign. What may be zero is set alone.
"""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

import numpy as np

from stickslip_verification.drive import workers
from stickslip_verification.drive.fmu.names import NOT_THERE, UNITS, NameMap, Target
from stickslip_verification.drive.fmu.variables import Variable
from stickslip_verification.drive.stepping import CommunicationStep, Setting
from stickslip_verification.model.quantities import QUANTITIES
from stickslip_verification.model.run import Run, Series
from stickslip_verification.suite.cases import Case
from stickslip_verification.truth.parameters import PARAMETERS

Gaps = Mapping[Variable, tuple[float, int]]
"""How far each output is from what it may be, with the better sign."""

_VALUES: Final = {"m": 1.3, "g": 9.7, "k": 1700.0, "mu_s": 0.55, "mu_k": 0.25, "v": 0.03}
"""What is set at first [SI], usual start values in none; the others are zero."""

_STARTS: Final = {"x_start": 2e-3, "x_dot_start": 0.06, "z_start": 2e-3}

_ALONE: Final = {"c": 10.0, "load": 3.0, "F_ext": 1.4, **_STARTS}
"""What the others are set to [SI], each alone."""

_STEPS: Final = (CommunicationStep(2.5e-3, {}),) * 800
"""Seven periods."""

_LIMITS: Final = workers.Limits(budget=20.0)

_SAME, _OTHER, _SAME_NUMBER = 0.1, 0.5, 1e-3
"""Mean distance of two curves, in mean deviations of ours, up to which they are one motion to a
crude solver, and from which they are two; relative distance of two numbers that are one."""

_CLEARER, _EXACT = 3.0, 1e-6
"""How many times as far a rival has to be; distances below the other are none."""

_MOVING: Final = ("x", "x_dot", "z", "F", "F_friction")
"""Outputs that prove the motion of a block. They are compared in the first half of the run, before
a crude solver is late, the others in the second, when the meter knows all."""

_PROOF: Final = 0.9
"""Sum of what these prove, each 1 if followed exactly and 0 at `_SAME`."""

DIRECTED: Final = {each.name for each in PARAMETERS if each.directed} | {
    name for name, quantity in QUANTITIES.items() if quantity.directed
}


def trial(
    fmu: Path, fitting: Sequence[Variable], guesses: Sequence[Sequence[Variable]]
) -> dict[Variable, int]:
    """Run an FMU in processes of its own; return with which sign a variable is ours, or 0 if not.

    What stays unknown is left out. `fitting` are variables of the FMU as each of ours that they may
    be, `guesses` what the parameters may be, the likeliest first.
    """
    nothing = NameMap(dict.fromkeys(UNITS, Target(NOT_THERE)))
    with workers.Pool(workers.jobs_here(), fmu=fmu, names=nothing, limits=_LIMITS) as pool:
        return _Trial(pool, fitting).findings(guesses)


class _Trial:
    """Runs of one FMU and of the reference through the same steps."""

    def __init__(self, pool: workers.Pool, fitting: Sequence[Variable]) -> None:
        self.pool = pool
        self.variables = {f"{each.name} = {each.their_name}": each for each in fitting}
        self.motions: dict[tuple[tuple[str, float], ...], Run | None] = {}

    def findings(self, guesses: Sequence[Sequence[Variable]]) -> dict[Variable, int]:
        """Compare with the parameters of each guess, then set each of the others alone."""
        values = [{v: _VALUES.get(v.name, 0.0) for v in guess} for guess in guesses]
        runs = self._runs(values)
        gaps = [self._gaps(run, _ours(given)) for run, given in zip(runs, values, strict=True)]
        scores = [sum(1.0 - gap[v][0] / _SAME for v in _same(gap)) for gap in gaps]
        best = scores.index(max(scores))
        guess, gap, same = values[best], gaps[best], _same(gaps[best])
        followed = [v for v in same if v.name in _MOVING]
        if sum(1.0 - gap[v][0] / _SAME for v in followed) < _PROOF:
            return {}
        signs = dict.fromkeys((v for v in gap if gap[v][0] > _OTHER or v.name in _MOVING), 0) | same
        # Another guess that does as well leaves open what it has otherwise.
        rivals = [v for i, g in enumerate(values) if scores[i] > scores[best] - _EXACT for v in g]
        for parameter in guess:
            others = [v for v in rivals if v.name == parameter.name and v != parameter]
            if parameter.name in _VALUES and not others:
                signs[parameter] = 1
        taken = {v.their_name for v in signs if v.name in _VALUES}
        alone = [
            v for v in self.variables.values() if v.name in _ALONE and v.their_name not in taken
        ]
        runs = self._runs([guess | {v: _ALONE[v.name]} for v in alone])
        for parameter, run in zip(alone, runs, strict=True):
            far = {}
            for sign in (0, 1, -1):
                moved = {**_ours(guess), parameter.name: sign * _ALONE[parameter.name]}
                gap = self._gaps(run, moved)
                far[sign] = sum(gap[v][0] for v in followed) if gap else math.inf
            nearest, second, _ = sorted(far, key=lambda sign: far[sign])
            if _CLEARER * far[nearest] + _EXACT < far[second]:
                signs[parameter] = nearest
        return signs

    def _runs(self, values: Sequence[Mapping[Variable, float]]) -> list[Run | None]:
        """Run the FMU; of two values for one of its variables the last counts."""
        names = [key for key, each in self.variables.items() if each.name in QUANTITIES]
        asked = []
        for each in values:
            last = {v.their_name: f"{v.name} = {v.their_name}" for v in each}
            given = {key: each[self.variables[key]] for key in last.values()}
            asked.append((Setting(given, _STEPS), self.variables, names))
        return [answer.value for answer in self.pool.each(workers.trial_run, asked)]

    def _gaps(self, run: Run | None, values: Mapping[str, float]) -> Gaps:
        """Return the gaps of a run to the reference with these values; none without a run."""
        key = tuple(sorted(values.items()))
        if key not in self.motions:
            case = Case("trial", "", "", values, _STEPS, (), Path())
            self.motions[key] = next(self.pool.each(workers.reference, [(case,)])).value
        motion = self.motions[key]
        if run is None or motion is None:
            return {}
        return {
            v: min(
                (_gap(v.name, sign * run.outputs[name], motion.outputs[v.name]), sign)
                for sign in ((1, -1) if v.name in DIRECTED else (1,))
            )
            for name, v in self.variables.items()
            if v.name in QUANTITIES
        }


def _ours(values: Mapping[Variable, float]) -> dict[str, float]:
    return {v.name: value for v, value in values.items()}


def _same(gaps: Gaps) -> dict[Variable, int]:
    """Return what is ours, with the sign: near, and nothing else of either name much nearer."""
    near = {each: gap for each, (gap, _) in gaps.items() if gap < _SAME}
    return {
        v: gaps[v][1]
        for v, gap in near.items()
        if gap - _EXACT
        <= _CLEARER * min(near[o] for o in near if o.name == v.name or o.their_name == v.their_name)
    }


def _gap(ours: str, samples: Series, expected: Series) -> float:
    """Return the distance of samples from ours, below `_SAME` where they are the same."""
    half = len(expected) // 2
    part = slice(half) if ours in _MOVING else slice(half, None)
    samples, expected = samples[part], expected[part]
    apart, size = float(np.mean(np.abs(samples - expected))), float(np.max(np.abs(expected)))
    spread = float(np.mean(np.abs(expected - np.mean(expected))))
    if spread > _EXACT * size:
        return apart / spread
    if size == 0.0:
        # Two zeros need not be the same.
        return math.inf if samples.any() else _OTHER
    return apart / size if apart < _SAME_NUMBER * size else max(apart / size, _SAME)
