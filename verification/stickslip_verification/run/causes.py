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
    if (said := _of_output(failures)) or any(each.output not in SHARES for each in failures):
        return said
    creeps = [creep for each in failures if (creep := _creep(each)) is not None]
    if creeps and all(creeps):
        return (
            "friction is regularised: in stick the mass creeps at "
            f"{1e6 * float(np.median(creeps)):.2g} um/s per newton"
        )
    failures = sorted(failures, key=lambda each: each.got.times[-1])
    others = sorted(others, key=lambda each: each.got.times[-1])[:OTHERS]
    left = {}
    for words, solve in _models():
        parts = takewhile(lambda part: part <= EXPLAINS, (_left(each, solve) for each in failures))
        kept = list(parts)
        if len(kept) == len(failures) and not any(_contradicts(each, solve) for each in others):
            left[words] = max(kept)
    # Of those that explain about as much, the first is the simplest.
    least = min(left.values(), default=0.0)
    return next((words for words, part in left.items() if part <= 2.0 * least), None)


def _left(shown: Shown, solve: Callable[[Case], Run]) -> float:
    """Return what a model leaves of the mean deviation of the motion."""
    found = _distances(shown, solve)
    parts = [rest / min(off, size) for off, rest, size in found if off > 0.0 and size > 0.0]
    return max(parts, default=1.0) if np.all(np.isfinite(parts)) else 1.0


def _contradicts(shown: Shown, solve: Callable[[Case], Run]) -> bool:
    """Whether a model moves otherwise than an FMU that is right."""
    found = _distances(shown, solve)
    return any(rest > _ALSO * off + _PART * size for off, rest, size in found)


def _distances(shown: Shown, solve: Callable[[Case], Run]) -> list[tuple[float, float, float]]:
    """Return for each output how far the FMU is from the exact motion and the model, and its size.

    Nothing where the model cannot be set so.
    """
    try:
        model = solve(shown.case)
    except ValueError:
        return []
    found = []
    for name in SHARES:
        if name in shown.got.outputs:
            got, exact = shown.got.outputs[name], shown.exact.outputs[name]
            off, rest = (
                float(np.mean(np.abs(got - each))) for each in (exact, model.outputs[name])
            )
            found.append((off, rest, float(np.mean(np.abs(exact)))))
    return found


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


def _models() -> Iterator[tuple[str, Callable[[Case], Run]]]:
    """Yield in words what models do instead, with what solves them."""
    for words, alter in _altered():
        yield words, partial(_solve, alter=alter)
    for words, acceleration in STRUCTURES.items():
        yield words, partial(_solve, acceleration=acceleration)


def _solve(
    case: Case,
    alter: Callable[[Case], Case] | None = None,
    acceleration: Acceleration | None = None,
) -> Run:
    if acceleration is not None:
        return Slider(_SOLVER, case, acceleration).run()
    return _SOLVER.run(case if alter is None else alter(case))


def _altered() -> Iterator[tuple[str, Callable[[Case], Case]]]:
    """Yield what models make of the values that are set."""
    for name in ("c", "load", "F_ext", "x_dot_start", "z_start"):
        yield f"{name} is ignored", partial(_valued, to={name: _times(name, 0.0)})
    for name in ("v", "load", "F_ext", "x_dot_start", "z_start"):
        yield f"{name} has the other sign", partial(_valued, to={name: _times(name, -1.0)})
    for name in CHANGEABLE:
        yield f"changes of {name} are ignored", partial(_unchanged, name=name)
        yield f"changes of {name} act one step late", partial(_late, name=name)
        for factor, words in ((1e3, "1000 times as large"), (1e-3, "a thousandth")):
            to = {name: _times(name, factor)}
            yield f"{name} acts as if it were {words}", partial(_valued, to=to)
    yield "g is 9.81 m/s2, whatever is set", partial(_valued, to={"g": lambda _: 9.81})
    yield "m is 1 kg, whatever is set", partial(_valued, to={"m": lambda _: 1.0})
    yield "mu_k acts in stick too", partial(_valued, to={"mu_s": lambda p: p["mu_k"]})
    yield "mu_s acts in slip too", partial(_valued, to={"mu_k": lambda p: p["mu_s"]})


def _times(name: str, factor: float) -> Callable[[Values], float]:
    return lambda p: factor * p[name]


def _valued(case: Case, to: Mapping[str, Callable[[Values], float]]) -> Case:
    """Return a case with other values, each of those that would be set."""
    now = dict(case.start)

    def other(new: Values) -> dict[str, float]:
        now.update(new)
        return {**new, **{name: value(now) for name, value in to.items() if name in now}}

    parameters = other(case.start)
    steps = tuple(replace(each, changes=other(each.changes)) for each in case.steps)
    return replace(case, parameters=parameters, steps=steps)


def _unchanged(case: Case, name: str) -> Case:
    steps = [
        replace(each, changes={n: value for n, value in each.changes.items() if n != name})
        for each in case.steps
    ]
    return replace(case, steps=tuple(steps))


def _late(case: Case, name: str) -> Case:
    steps = []
    before: dict[str, float] = {}
    for each in case.steps:
        kept = {n: value for n, value in each.changes.items() if n != name}
        steps.append(replace(each, changes={**kept, **before}))
        before = {name: each.changes[name]} if name in each.changes else {}
    return replace(case, steps=tuple(steps))


STRUCTURES: Final[Mapping[str, Acceleration]] = {
    "damping acts forwards only": lambda p, s, friction: (
        lambda z, u: (p["k"] * z + p["F_ext"] - s * friction(u) - p["c"] * max(u, 0.0)) / p["m"]
    ),
    "damping acts on the speed relative to the pull": lambda p, s, friction: (
        lambda z, u: (p["k"] * z + p["F_ext"] - s * friction(u) - p["c"] * (u - p["v"])) / p["m"]
    ),
    "damping has the other sign": lambda p, s, friction: (
        lambda z, u: (p["k"] * z + p["F_ext"] - s * friction(u) + p["c"] * u) / p["m"]
    ),
    "c is a rate, and acts as c m": lambda p, s, friction: (
        lambda z, u: (p["k"] * z + p["F_ext"] - s * friction(u)) / p["m"] - p["c"] * u
    ),
    "friction points backwards whichever way the mass moves": lambda p, s, friction: (
        lambda z, u: (p["k"] * z + p["F_ext"] - friction(u) - p["c"] * u) / p["m"]
    ),
    "F_ext is ignored in slip": lambda p, s, friction: (
        lambda z, u: (p["k"] * z - s * friction(u) - p["c"] * u) / p["m"]
    ),
    "F_ext has the other sign in slip": lambda p, s, friction: (
        lambda z, u: (p["k"] * z - p["F_ext"] - s * friction(u) - p["c"] * u) / p["m"]
    ),
}
"""What models make of the equation of motion in slip, from values, direction and friction force."""


def _of_output(failures: Sequence[Shown]) -> str | None:
    """Return what explains an output beside the motion."""
    for words, other in _OUTPUTS.items():
        if all(_shown(each, other) <= EXPLAINS for each in failures):
            names = ", ".join(dict.fromkeys(each.output for each in failures))
            return f"{names} {words}"
    return None


def _shown(shown: Shown, other: Callable[[Series, Shown], Series]) -> float:
    got, exact = (each.outputs[shown.output] for each in (shown.got, shown.exact))
    meant = np.isfinite(got) & np.isfinite(exact)
    off, rest = (
        float(np.mean(np.abs(each - exact)[meant])) if meant.any() else 0.0
        for each in (got, other(got, shown))
    )
    size = float(np.mean(np.abs(exact[meant]))) if meant.any() else 0.0
    return rest / min(off, size) if off > 0.0 and size > 0.0 and np.isfinite(rest) else 1.0


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


def _damping(shown: Shown) -> Series:
    now, forces = dict(shown.case.start), []
    for step, speed in zip(shown.case.steps, shown.exact.outputs["x_dot"], strict=True):
        now.update(step.changes)
        forces.append(now["c"] * float(speed))
    return np.array(forces)
