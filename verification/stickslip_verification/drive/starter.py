"""A names file to begin with: for each variable of the suite the likeliest one of an FMU.

A guess needs the right causality and, where the FMU declares a unit, the right dimension. Among
those decide a trial run, then the words of name and description, and each variable is one of ours
at most. A guess that another comes near is written as a comment, for a person to decide.

In a trial run the likeliest parameters are set, here and in the reference. A variable of the FMU
that then follows a curve of the reference is that one, also with the other sign. What may be zero
is set alone.
"""

import contextlib
import json
import math
import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from pathlib import Path
from typing import Any, Final

import numpy as np
from scipy.optimize import linear_sum_assignment

from stickslip_units import Unit

from ..model.quantities import QUANTITIES
from ..model.verdict import Run, Series
from ..suite.cases import Case
from ..truth.parameters import PARAMETERS, Kind
from . import processes
from .description import (
    INPUT_UNITS,
    NOT_THERE,
    UNITS,
    Declared,
    Description,
    FmuError,
    NameMap,
    Target,
    Variable,
    as_ours,
    looks_like,
    shown,
)
from .exchange import OPENED, Interface
from .instance import FLOATING, REQUIRED, FmuFile
from .masters import CommunicationStep, Setting
from .other_runs import reference_run, trial_run

_ALL_SAID: Final = 20.0
"""What it counts that name, description and unit say all that a quantity needs, and the name no
more; whatever lacks something has a smaller score."""
_SAME_NAME, _BASE = 8.0, 8.0
"""What our own name counts, and any variable of which something is said."""
_NAME, _TEXT, _MISSING = 2.0, 1.0, 2.0
"""What a word of the name and one of the description count, and what is not said."""

_TABLES: Final[Mapping[str, Mapping[str, Any]]] = tomllib.loads(
    Path(__file__).with_name("words.toml").read_text("utf-8")
)
_MEANINGS, _VALUES, _ALONE = (_TABLES[name] for name in ("parameters", "trial", "alone"))
_TELLING: Final = ("kg", "m/s2", "N/m", "N.s/m")
_FIXED: Final = {each.name for each in PARAMETERS if each.kind is Kind.FIXED}
_DISCRETE: Final = {name for name, quantity in QUANTITIES.items() if quantity.discrete}

_CONCEPTS: Final[Mapping[str, set[str]]] = {
    word: {concept for concept, words in _TABLES["concepts"].items() if word in words.split()}
    for word in " ".join(_TABLES["concepts"].values()).split()
}
_LONG: Final = "|".join(word for word in _CONCEPTS if len(word) > 3)
_WORD: Final = re.compile(
    "|".join(
        word if len(word) > 3 else rf"\b{word}(?:\b|(?={_LONG}))"
        for word in sorted(_CONCEPTS, key=len, reverse=True)
    )
)
_SEAM: Final = re.compile(r"_|(?<=[a-zäöü])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])|(?<=[^\W\d])(?=\d)")

_AHEAD, _SEEN = 1.0, 100.0
"""By how much an assignment with a sure guess is better than the best one without it; score of a
guess that a trial run confirms, on top of that of its words."""
_MOST_TRIED, _ALTERNATIVES, _AGAINST = 2000, 3, "compress"
"""Pairs in a trial run; names that a comment offers; word of an extension that is counted the other
way."""

Gaps = Mapping[Variable, tuple[float, int]]
"""How far each output is from what it may be, with the better sign."""
_STEPS: Final = (CommunicationStep(2.5e-3, {}),) * 800  # seven periods
_SAME, _OTHER, _SAME_NUMBER = 0.1, 0.5, 1e-3
"""Mean distance of two curves, in mean deviations of ours, up to which they are one motion to a
crude solver, and from which they are two; relative distance of two numbers that are one."""
_CLEARER, _EXACT = 3.0, 1e-6
"""How many times as far a rival has to be; distances below the other are none."""
_MOVING: Final = ("x", "x_dot", "z", "F", "F_friction")
"""Outputs that prove the motion of a block. They are compared in the first half of the run, before
a crude solver is late, the others in the second, when the meter knows all."""
_PROOF: Final = 0.9  # sum of what these prove, each 1 if followed exactly and 0 at `_SAME`

_DIRECTED: Final = {each.name for each in PARAMETERS if each.directed} | {
    name for name, quantity in QUANTITIES.items() if quantity.directed
}


def starter(fmu: Path, interface: Interface = "cs") -> str:
    """Return the text of a names file of an FMU, which is run in a process of its own if it can be.

    It loads back with `load_names` where it has an entry at all, and the FMU opens with it.
    `FmuError` if it is none.
    """
    description = Description(fmu, OPENED[interface].KIND)
    theirs, units = description.declared, description.units
    fitting = [_candidate(ours, each, units) for ours in UNITS for each in theirs.values()]
    scores = {v: _likeness(v.name, theirs[v.their_name]) for v in fitting if v}
    seen = _tried(partial(OPENED[interface], fmu), scores)
    scores = {v: s + _SEEN * (v in seen) for v, s in scores.items() if seen.get(v, s)}
    # Without gravity a normal force may be the whole of it, and is no load on top of m g.
    if not any(each.name == "g" for each in scores):
        loads = [v for v in scores if v.name == "load" and v not in seen]
        scores |= {v: min(scores[v], _ALL_SAID - 1.0) for v in loads}
    sure = {each.name for each, score in scores.items() if score >= _ALL_SAID}
    lacking = [] if seen else [ours for ours in REQUIRED if ours not in sure]
    best, without = _assigned({v: score for v, score in scores.items() if score >= _ALL_SAID})
    total = sum(scores[each] for each in best)
    chosen = {
        each.name: each
        for each in ([] if lacking else best)
        if total - sum(scores[other] for other in without[each]) >= _AHEAD
    }
    texts = _TABLES["texts"]
    note = texts["seen" if seen else "no_block" if lacking else "not_seen"]
    head = texts["head"].format(file=_plain(fmu.name), note=note.format(", ".join(lacking)))
    lines = [head, "# What is set"]
    for ours in UNITS:
        if ours == next(name for name in UNITS if name not in INPUT_UNITS):
            lines += ["", "# What is read"]
        near = sorted((v for v in scores if v.name == ours), key=lambda v: -scores[v])
        lines.append(_line(ours, chosen.get(ours), near, theirs, seen))
    named = {each.their_name for each in chosen.values()}
    rest = [each for name, each in theirs.items() if name not in named]
    if rest:
        lines += ["", "# Variables of the FMU that have no entry"]
        lines += [f"# {_plain(shown(each))} ({each.causality})" for each in rest]
    return "\n".join(lines) + "\n"


def _tried(opener: Callable[..., FmuFile], scores: Mapping[Variable, float]) -> dict[Variable, int]:
    """Return with which sign a variable is ours by a trial run, or 0 if it is not.

    Tried are the likeliest parameters, and those that are likeliest without one of these. What
    stays unknown is left out: all if the FMU fails or does not move as a block.
    """
    if len(scores) > _MOST_TRIED or not set(REQUIRED) <= {each.name for each in scores}:
        return {}
    likely = {
        v: s or 0.1 * (v.name in REQUIRED) for v, s in scores.items() if v.name in INPUT_UNITS
    }
    best, without = _assigned(likely)
    nothing = NameMap(dict.fromkeys(UNITS, Target(NOT_THERE)))
    opened, limits = partial(opener, nothing), processes.Limits(budget=20.0)
    with processes.Pool(processes.jobs_here(), fmu=opened, limits=limits) as pool:
        return _Trial(pool, list(scores)).findings([best, *without.values()])


def _candidate(ours: str, theirs: Declared, units: Mapping[str, Unit]) -> Variable | None:
    """Return a variable as ours if it may be: by causality, variability, type and dimension."""
    is_whole = theirs.type not in FLOATING
    if (
        (ours in _FIXED and theirs.causality == "input")
        or (is_whole and ours not in _DISCRETE and theirs.name != ours)
        or (theirs.type == "Boolean" and ours != "sticking")
        or theirs.variability == "constant"
    ):
        return None
    with contextlib.suppress(FmuError):
        return as_ours("", ours, Target(theirs.name), theirs, units, UNITS[ours])
    return None


def _likeness(ours: str, theirs: Declared) -> float:
    needs, may = (set(part.split()) for part in f"{_TABLES['quantities'][ours]} | ".split("|")[:2])
    name, text = _words(theirs.name), _words(theirs.description)
    by_unit = {_TABLES["by_unit"].get(UNITS[ours], "")} if theirs.unit else set()
    said = by_unit if UNITS[ours] in _TELLING else set()
    score, doubtful = float(len(by_unit)), ours in _DISCRETE and theirs.type in FLOATING
    for word, worth, against in [(w, _NAME, _NAME) for w in name] + [(w, _TEXT, 0.5) for w in text]:
        meant = _CONCEPTS[word] & (needs | may)
        doubtful = doubtful or (not meant and word in name)
        score += (worth if meant - said else 0.0) if meant else -against
        said = said | meant
    missing = needs - said - by_unit
    score += _BASE - _MISSING * len(missing) - (not looks_like(ours, theirs))
    if theirs.name == ours:
        return _ALL_SAID + score + (_SAME_NAME if by_unit or UNITS[ours] == "1" else 0.0)
    if not said:
        return 0.0
    return max(score, 1.0) + (0.0 if missing or doubtful else _ALL_SAID)


@cache
def _words(text: str) -> tuple[str, ...]:
    """Return the known words in a name or a sentence, also those in camelCase and compounds."""
    return tuple(_WORD.findall(_SEAM.sub(" ", text).lower()))


def _assigned(
    scores: Mapping[Variable, float],
) -> tuple[list[Variable], dict[Variable, list[Variable]]]:
    """Return the best assignment, and for each variable in it the best one without it."""
    ours = list(dict.fromkeys(each.name for each in scores))
    theirs = list(dict.fromkeys(each.their_name for each in scores))
    places = {(ours.index(v.name), theirs.index(v.their_name)): v for v in scores}
    weights = np.zeros((len(ours), len(theirs)))
    for place, each in places.items():
        weights[place] = scores[each]

    def best() -> list[Variable]:
        pairs = zip(*linear_sum_assignment(weights, maximize=True), strict=True)
        return [places[place] for place in pairs if weights[place] > 0.0]

    first, without = best(), {}
    for place, each in places.items():
        if each in first:
            weights[place] = 0.0
            without[each] = best()
            weights[place] = scores[each]
    return first, without


def _line(
    ours: str,
    chosen: Variable | None,
    near: Sequence[Variable],
    theirs: Mapping[str, Declared],
    seen: Mapping[Variable, int],
) -> str:
    unit = "" if UNITS[ours] == "1" else f" [{UNITS[ours]}]"
    about = (_MEANINGS.get(ours) or QUANTITIES[ours].meaning) + unit
    if ours in _DIRECTED:
        about += ", positive along the pull"
    if chosen is None:
        same = theirs.get(ours)
        if same and looks_like(ours, same) and same.name not in [v.their_name for v in near]:
            return f'{ours} = ""  # {about}; of the FMU: {_plain(shown(same))}, something else'
        first = _quoted(near[0].their_name if near else "...")
        return f"# {ours} = {first}  # {about}{_or(near[1:])}"
    if chosen.unit is not None:
        about += f"; in {_plain(chosen.unit)}"
    elif unit:
        about += "; no unit declared, so this one is assumed"
    about += "; seen" if chosen in seen else _or([each for each in near if each != chosen])
    against = ours in ("z", "z_start") and _AGAINST in _words(chosen.their_name)
    name = _quoted(chosen.their_name)
    if seen.get(chosen, -1 if against else 1) < 0:
        name = f"{{ name = {name}, sign = -1 }}"
    return f"{ours} = {name}  # {about}"


def _or(others: Sequence[Variable]) -> str:
    names = ", ".join(_quoted(each.their_name) for each in others[:_ALTERNATIVES])
    return f"; or {names}" if names else ""


def _quoted(name: str) -> str:
    return json.dumps(name, ensure_ascii=False).replace("\x7f", "\\u007f")


def _plain(text: str) -> str:
    """Return a text as a TOML comment can hold it: on one line, without control characters."""
    return "".join(letter if letter.isprintable() else " " for letter in text)


class _Trial:
    def __init__(self, pool: processes.Pool, fitting: Sequence[Variable]) -> None:
        self.pool = pool
        self.variables = {f"{each.name} = {each.their_name}": each for each in fitting}
        self.motions: dict[tuple[tuple[str, float], ...], Run | None] = {}

    def findings(self, guesses: Sequence[Sequence[Variable]]) -> dict[Variable, int]:
        """Compare with the parameters of each guess, then set each of the others alone."""
        values = [{v: _VALUES.get(v.name, 0.0) for v in guess} for guess in guesses]
        runs = self._runs(values)
        gaps = [self._gaps(run, _ours(of)) for run, of in zip(runs, values, strict=True)]
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
            settings = {key: each[self.variables[key]] for key in last.values()}
            asked.append((Setting(settings, _STEPS), self.variables, names))
        return [answer.value for answer in self.pool.each(trial_run, asked)]

    def _gaps(self, run: Run | None, values: Mapping[str, float]) -> Gaps:
        """Return the gaps of a run to the reference with these values; none without a run."""
        key = tuple(sorted(values.items()))
        if key not in self.motions:
            case = Case("trial", "", "", values, _STEPS, (), Path())
            self.motions[key] = next(self.pool.each(reference_run, [(case,)])).value
        motion = self.motions[key]
        if run is None or motion is None:
            return {}
        return {
            v: min(
                (_gap(v.name, sign * run.outputs[name], motion.outputs[v.name]), sign)
                for sign in ((1, -1) if v.name in _DIRECTED else (1,))
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
