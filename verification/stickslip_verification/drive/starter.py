"""A names file to begin with: for each variable of the suite the likeliest one of an FMU.

A guess needs the right causality and, where the FMU declares a unit, the right dimension. Among
those decide a trial run, then the words of name and description, and each variable is one of ours
at most. A guess that another comes near is written as a comment, for a person to decide.
"""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

import numpy as np
from scipy.optimize import linear_sum_assignment

from stickslip_verification.drive.fmu.archive import REQUIRED
from stickslip_verification.drive.fmu.description import Declared, read_description, shown
from stickslip_verification.drive.fmu.likeness import MEANINGS, WHOLE, candidate, likeness, words
from stickslip_verification.drive.fmu.names import INPUT_UNITS, UNITS
from stickslip_verification.drive.fmu.variables import Variable, looks_like
from stickslip_verification.drive.trial import DIRECTED, trial
from stickslip_verification.model.quantities import QUANTITIES

_AHEAD: Final = 1.0
"""By how much an assignment with a sure guess is better than the best one without it."""

_SEEN: Final = 100.0
"""Score of a guess that a trial run confirms, beside that of its words."""

_MOST_TRIED: Final = 2000
"""Pairs in a trial run; an FMU with more is not run."""

_ALTERNATIVES: Final = 3

_AGAINST: Final = "compress"
"""Word of an extension that is counted the other way."""

_HEAD: Final = """\
# Names file of {file} for stickslip verify --names, begun by stickslip names. Check each line.
# An entry is: our name = "name in the FMU". In square brackets stands our unit. Where the FMU
# declares another unit than it means, or counts against the pull, write
# x = {{ name = "...", unit = "mm", sign = -1 }}
# A line behind a # is not sure. T = "" says that the FMU has no T.
# {note}
"""
_NO_BLOCK: Final = "Nothing in it is like {}: no stick-slip block by its names, so nothing is set."
_SEEN_SO: Final = "What is marked as seen moved so in a trial run."
_NOT_SEEN: Final = (
    "Words and units alone: a trial run failed, or did not move as a block does (SI is taken "
    "where none is declared)."
)


def starter(fmu: Path) -> str:
    """Return the text of a names file of an FMU, which is run in a process of its own if it can be.

    It loads back with `load_names` where it has an entry at all, and the FMU opens with it.

    Raises
    ------
    FmuError
        No such file, or not an FMU.
    """
    description = read_description(fmu)
    theirs, units = description.declared, description.units
    fitting = [candidate(ours, each, units) for ours in UNITS for each in theirs.values()]
    scores = {v: likeness(v.name, theirs[v.their_name]) for v in fitting if v}
    seen = _tried(fmu, scores)
    scores = {v: s + _SEEN * (v in seen) for v, s in scores.items() if seen.get(v, s)}
    # Without gravity a normal force may be the whole of it, and is no load on top of m g.
    if not any(each.name == "g" for each in scores):
        scores = {
            v: min(s, WHOLE - 1.0) if v.name == "load" and v not in seen else s
            for v, s in scores.items()
        }
    whole = {each.name for each, score in scores.items() if score >= WHOLE}
    lacking = [] if seen else [ours for ours in REQUIRED if ours not in whole]
    chosen = {} if lacking else _sure(scores)
    note = _SEEN_SO if seen else _NO_BLOCK if lacking else _NOT_SEEN
    head = _HEAD.format(file=_plain(fmu.name), note=note.format(", ".join(lacking)))
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


def _tried(fmu: Path, scores: Mapping[Variable, float]) -> dict[Variable, int]:
    """Try the likeliest parameters, and those that are likeliest without one of these."""
    if len(scores) > _MOST_TRIED or not set(REQUIRED) <= {each.name for each in scores}:
        return {}
    likely = {
        v: s or 0.1 * (v.name in REQUIRED) for v, s in scores.items() if v.name in INPUT_UNITS
    }
    best, without = _assigned(likely)
    return trial(fmu, list(scores), [best, *without.values()])


def _sure(scores: Mapping[Variable, float]) -> dict[str, Variable]:
    """Return the variables that are sure by our names, none twice."""
    best, without = _assigned({v: score for v, score in scores.items() if score >= WHOLE})
    total = sum(scores[each] for each in best)
    return {
        each.name: each
        for each in best
        if total - sum(scores[other] for other in without[each]) >= _AHEAD
    }


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
        found = zip(*linear_sum_assignment(weights, maximize=True), strict=True)
        return [places[place] for place in found if weights[place] > 0.0]

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
    about = (MEANINGS.get(ours) or QUANTITIES[ours].meaning) + unit
    if ours in DIRECTED:
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
    against = ours in ("z", "z_start") and _AGAINST in words(chosen.their_name)
    name = _quoted(chosen.their_name)
    if seen.get(chosen, -1 if against else 1) < 0:
        name = f"{{ name = {name}, sign = -1 }}"
    return f"{ours} = {name}  # {about}"


def _or(others: Sequence[Variable]) -> str:
    names = ", ".join(_quoted(each.their_name) for each in others[:_ALTERNATIVES])
    return f"; or {names}" if names else ""


def _quoted(name: str) -> str:
    """Return a name as a TOML string."""
    return json.dumps(name, ensure_ascii=False).replace("\x7f", "\\u007f")


def _plain(text: str) -> str:
    """Return a text as a TOML comment can hold it: on one line, without control characters."""
    return "".join(letter if letter.isprintable() else " " for letter in text)
