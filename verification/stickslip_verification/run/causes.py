"""What a wrong model does instead: what it is likeliest to do is done, and compared with it.

A cause is named only if its motion is the FMU's in every failed run that is tried, but for a tenth
of the deviation, and in no other run another one; else there is none that explains it alone.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import takewhile
from typing import Final

import numpy as np

from stickslip_verification.drive.solvers import SHARES, Acceleration, Slider, Solver
from stickslip_verification.model.run import Run, Series
from stickslip_verification.suite.cases import Case
from stickslip_verification.truth.parameters import CHANGEABLE

EXPLAINS: Final = 0.1
"""Most of the mean deviation that a cause may leave."""

WORST: Final = 3
"""How many failed runs are tried."""

OTHERS: Final = 15
"""How many runs in which the FMU is right are compared with a cause, the shortest ones."""

_SOLVER: Final = Solver(rtol=1e-7, adapts="LSODA")
_EVEN: Final = 0.3
"""Distance of the quartiles over the median of a creep that is in proportion to the force."""

_ALSO: Final = 3.0
"""How many times farther off a cause may be where the FMU is right, and `_PART` of the motion."""
_PART: Final = 0.01

Values = Mapping[str, float]
Model = Callable[[Case], Slider]
Distance = tuple[float, float, float]
"""Of an output: its mean deviation, what a cause leaves of it, and its mean size."""


@dataclass(frozen=True)
class Shown:
    """A run: its case, the exact motion, what the FMU did, and the output that is off."""

    case: Case
    exact: Run
    got: Run
    output: str = ""


def cause(failures: Sequence[Shown], others: Sequence[Shown]) -> str | None:
    """Return in words the one cause that explains all failed runs, if there is one.

    ``others`` are the runs in which the FMU is right.
    """
    if not failures:
        return None
    for words, instead in _OUTPUTS.items():
        if all(_left([_of_output(shown, instead)]) <= EXPLAINS for shown in failures):
            return f"{', '.join(dict.fromkeys(shown.output for shown in failures))} {words}"
    if any(shown.output not in SHARES for shown in failures):
        return None
    creeps = [creep for shown in failures if (creep := _creep(shown)) is not None]
    if creeps and all(creeps):
        return (
            "friction is regularised: in stick the mass creeps at "
            f"{1e6 * float(np.median(creeps)):.2g} um/s per newton"
        )
    failures = sorted(failures, key=lambda shown: shown.got.times[-1])
    others = sorted(others, key=lambda shown: shown.got.times[-1])[:OTHERS]
    left = {}
    for words, model in _models():
        parts = (_left(_of_motion(shown, model)) for shown in failures)
        explained = list(takewhile(lambda part: part <= EXPLAINS, parts))
        if len(explained) == len(failures) and not any(_contradicts(of, model) for of in others):
            left[words] = max(explained)
    # Of those that explain about as much, the first is the simplest.
    least = min(left.values(), default=0.0)
    return next((words for words, part in left.items() if part <= 2.0 * least), None)


def _left(distances: Sequence[Distance]) -> float:
    """Return what a cause leaves of the deviation, where most is left."""
    parts = [rest / min(off, size) for off, rest, size in distances if off > 0.0 and size > 0.0]
    return max(parts, default=1.0) if np.all(np.isfinite(parts)) else 1.0


def _contradicts(shown: Shown, model: Model) -> bool:
    """Whether a model moves otherwise than an FMU that is right."""
    distances = _of_motion(shown, model)
    return any(rest > _ALSO * off + _PART * size for off, rest, size in distances)


def _of_motion(shown: Shown, model: Model) -> list[Distance]:
    """Return the distances of the motion from a model; nothing where that cannot be set so."""
    try:
        instead = model(shown.case).run().outputs
    except ValueError:
        return []
    got, exact = shown.got.outputs, shown.exact.outputs
    rows = [(got[n] - exact[n], got[n] - instead[n], exact[n]) for n in SHARES if n in got]
    return [(_mean(off), _mean(rest), _mean(size)) for off, rest, size in rows]


def _of_output(shown: Shown, instead: Callable[[Series, Shown], Series]) -> Distance:
    """Return the distances of an output from what would be right if it showed another one."""
    got, exact = (run.outputs[shown.output] for run in (shown.got, shown.exact))
    meant = np.isfinite(got) & np.isfinite(exact)
    off, rest, size = got - exact, instead(got, shown) - exact, exact
    return _mean(off[meant]), _mean(rest[meant]), _mean(size[meant])


def _mean(samples: Series) -> float:
    return float(np.mean(np.abs(samples))) if samples.size else 0.0


def _creep(shown: Shown) -> float | None:
    """Return the speed over the force [m/(N s)] at which a mass creeps that should stick.

    0 where it does not creep in proportion to the force, None where it should hardly stick.
    """
    got, exact = shown.got.outputs, shown.exact.outputs
    if not {"x_dot", "F"} <= set(got):
        return None
    sticks = (exact["mode"] == 0.0) & (got["F"] != 0.0)
    sticks &= np.abs(got["x_dot"]) <= 0.1 * np.max(np.abs(exact["x_dot"]), initial=0.0)
    if np.sum(sticks) < 8:
        return None
    rates = got["x_dot"][sticks] / got["F"][sticks]
    low, middle, high = np.quantile(rates, (0.25, 0.5, 0.75))
    return float(middle) if middle > 0.0 and high - low <= _EVEN * middle else 0.0


def _models() -> Iterator[tuple[str, Model]]:
    """Yield in words what models make of what is set, and of the equation of slip."""
    for name in ("c", "load", "F_ext", "x_dot_start", "z_start"):
        yield f"{name} is ignored", partial(_valued, name=name, factor=0.0)
    for name in ("v", "load", "F_ext", "x_dot_start", "z_start"):
        yield f"{name} has the other sign", partial(_valued, name=name, factor=-1.0)
    for name in CHANGEABLE:
        yield f"changes of {name} are ignored", partial(_delayed, name=name, acts=False)
        yield f"changes of {name} act one step late", partial(_delayed, name=name, acts=True)
        for factor, words in ((1e3, "1000 times as large"), (1e-3, "a thousandth")):
            yield f"{name} acts as if it were {words}", partial(_valued, name=name, factor=factor)
    yield "g is 9.81 m/s2, whatever is set", partial(_valued, name="g", factor=9.81, of="1")
    yield "m is 1 kg, whatever is set", partial(_valued, name="m", of="1")
    yield "mu_k acts in stick too", partial(_valued, name="mu_s", of="mu_k")
    yield "mu_s acts in slip too", partial(_valued, name="mu_k", of="mu_s")
    for words, acceleration in STRUCTURES.items():
        yield words, partial(Slider, _SOLVER, acceleration=acceleration)


def _valued(case: Case, name: str, factor: float = 1.0, of: str = "") -> Slider:
    """Return a slider on which a value acts as a factor times itself, or times that `of` another.

    That of "1" is 1.
    """
    now = {"1": 1.0}

    def acting(new: Values) -> Values:
        now.update(new)
        return {**new, name: factor * now[of or name]} if name in now else new

    parameters = acting(case.start)
    steps = tuple(replace(step, changes=acting(step.changes)) for step in case.steps)
    return Slider(_SOLVER, replace(case, parameters=parameters, steps=steps))


def _delayed(case: Case, name: str, *, acts: bool) -> Slider:
    """Return a slider on which changes of a value act one step late, or never."""
    steps = []
    late: Values = {}
    for step in case.steps:
        others = {n: value for n, value in step.changes.items() if n != name}
        steps.append(replace(step, changes={**others, **late}))
        late = {name: step.changes[name]} if acts and name in step.changes else {}
    return Slider(_SOLVER, replace(case, steps=tuple(steps)))


def _slip(
    damping: Callable[[Values, float], float] = lambda p, u: p["c"] * u,
    push: float = 1.0,
    direction: int = 0,
) -> Acceleration:
    """Return another equation of slip: damping force, factor on F_ext, direction of friction."""
    return lambda p, s, friction: (
        lambda z, u: (
            (p["k"] * z + push * p["F_ext"] - (direction or s) * friction(u) - damping(p, u))
            / p["m"]
        )
    )


STRUCTURES: Final[Mapping[str, Acceleration]] = {
    "damping acts forwards only": _slip(lambda p, u: p["c"] * max(u, 0.0)),
    "damping acts on the speed relative to the pull": _slip(lambda p, u: p["c"] * (u - p["v"])),
    "damping has the other sign": _slip(lambda p, u: -p["c"] * u),
    "c is a rate, and acts as c m": _slip(lambda p, u: p["c"] * p["m"] * u),
    "friction points backwards whichever way the mass moves": _slip(direction=1),
    "F_ext is ignored in slip": _slip(push=0.0),
    "F_ext has the other sign in slip": _slip(push=-1.0),
}
"""What models make of the equation of motion in slip."""

_OUTPUTS: Final[Mapping[str, Callable[[Series, Shown], Series]]] = {
    "has the other sign": lambda got, _: -got,
    "has the other sign in backward motion": lambda got, of: np.where(
        of.exact.outputs["x_dot"] < 0.0, -got, got
    ),
    "is 1000 times too large": lambda got, _: 1e-3 * got,
    "is 1000 times too small": lambda got, _: 1e3 * got,
    "is that of the step before": lambda got, _: np.append(got[1:], got[-1]),
    "lacks the damping force": lambda got, of: got - _damping(of),
    "has a constant added": lambda got, of: got - np.median(got - of.exact.outputs[of.output]),
}
"""What would be right, from an output that shows something else."""


def _damping(shown: Shown) -> Series:
    now, forces = dict(shown.case.start), []
    for step, speed in zip(shown.case.steps, shown.exact.outputs["x_dot"], strict=True):
        now.update(step.changes)
        forces.append(now["c"] * float(speed))
    return np.array(forces)
