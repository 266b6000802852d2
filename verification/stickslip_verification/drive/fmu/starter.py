"""A names file to begin with: for each variable of the suite the likeliest one of an FMU.

A guess needs the right causality and, where the FMU declares a unit, the right dimension. Among
those decide the words of name and description. A guess that another variable comes near is written
as a comment, for a person to decide.
"""

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final

from stickslip_verification.drive.fmu.archive import description_of
from stickslip_verification.drive.fmu.names import INPUT_UNITS, UNITS
from stickslip_verification.drive.fmu.variables import (
    NUMBERS,
    READABLE,
    SETTABLE,
    looks_like,
    told,
    unit_of,
    units_defined,
)
from stickslip_verification.model.quantities import QUANTITIES
from stickslip_verification.model.units import Unit, spelled
from stickslip_verification.truth.parameters import PARAMETERS

_SURE: Final = 2
"""Least score of a guess that is written as an entry. A word of the name counts 2, one of the
description 1, and a dimension that no other variable of the FMU has counts 2."""

_AHEAD: Final = 1
"""By how much the score of such a guess exceeds that of the next one."""

_SAME_NAME: Final = 8

_ALONE: Final = 2
_TELLING: Final = ("kg", "m/s2", "N/m", "N.s/m")
"""Units that say enough where one variable alone has the dimension: a mass, a stiffness."""

_INNER: Final = 1
"""What speaks against a variable of the FMU that is no output."""

_ALTERNATIVES: Final = 3

_PARAMETERS: Final[Mapping[str, str]] = {
    "m": "mass",
    "g": "gravity",
    "k": "spring stiffness",
    "c": "viscous damping between mass and way",
    "mu_s": "static friction coefficient",
    "mu_k": "kinetic friction coefficient",
    "v": "velocity of the pulled end",
    "load": "normal force on top of m g",
    "F_ext": "external force on the mass along the way",
    "x_start": "position of the mass at the start",
    "x_dot_start": "velocity of the mass at the start",
    "z_start": "spring extension at the start",
}

_WORDS: Final[Mapping[str, str]] = {
    "m": "mass",
    "g": "gravity | g",
    "k": "stiffness | spring constant | spring rate | spring c",
    "c": "damping | damper | viscous",
    "mu_s": "static friction | static | stiction | adhesion | break away",
    "mu_k": "kinetic friction | dynamic friction | sliding friction | kinetic | dynamic | "
    "sliding | coulomb",
    "v": "pull speed | pull velocity | drive speed | drive velocity | driv velocity | feed | "
    "belt speed | belt velocity | speed | velocity",
    "load": "normal force | load",
    "F_ext": "external force | disturb",
    "x_start": "start position | initial position",
    "x_dot_start": "start velocity | start speed | initial velocity | initial speed",
    "z_start": "start extension | initial extension | initial deflection | preload",
    "x": "mass position | slider position | body position | mass s | slider s | position",
    "x_dot": "mass velocity | mass v | slider velocity | slider speed | slider v | body velocity | "
    "velocity | speed",
    "x_pull": "pull position | pull end | drive position | driv position | drive s | belt position",
    "z": "extension | elongation | deflection | compression",
    "F": "spring force",
    "F_friction": "friction force",
    "F_s": "break away | threshold | friction limit | static friction",
    "sticking": "stuck | sticking | locked",
    "mode": "mode | phase | direction",
    "delta_x": "jump | slip distance | slip length",
    "spring_drop": "relief | drop",
    "t_stick": "stick time | stick duration | stick",
    "t_slip": "slip time | slip duration | slip",
    "T": "period | cycle time",
    "f": "frequency",
    "x_dot_peak": "peak speed | peak velocity | top speed | max velocity | max speed | top | peak",
    "n_slips": "slips | count | slip number",
    "t_event": "event time | event",
    "W_pull": "pull work | drive work | pull energy | input energy",
    "W_k": "stiffness work | stiffness energy",
    "Q_friction": "heat | dissipat | friction work | friction energy",
    "mu_k_used": "used kinetic | effective kinetic | kinetic used",
}
"""Beginnings of words by which a variable is known; one of the alternatives has to be there whole.
A single letter is a word of its own."""

_AGAINST: Final = "compression"
"""Word of an extension that is counted the other way."""

_DIRECTED: Final = {each.name for each in PARAMETERS if each.directed} | {
    name for name, quantity in QUANTITIES.items() if quantity.directed
}

_HEAD: Final = """\
# Names file of {file} for stickslip verify --names, begun by stickslip names. Check each line.
# An entry is: our name = "name in the FMU". In square brackets stands our unit. Where the FMU
# declares another unit than it means, or counts against the pull, write
# x = {{ name = "...", unit = "mm", sign = -1 }}
# A line behind a # is not sure. T = "" says that the FMU has no T.
"""


@dataclass(frozen=True)
class _Guess:
    """A variable of the FMU that may be one of ours, and how much speaks for it."""

    theirs: Any
    score: int


def starter(fmu: Path) -> str:
    """Return the text of a names file of an FMU.

    It loads back with `load_names` where it has an entry at all, and the FMU opens with it.

    Raises
    ------
    FmuError
        No such file, or not an FMU.
    """
    description = description_of(fmu)
    theirs = description.modelVariables
    units = units_defined(description)
    guesses = {ours: _guesses(ours, theirs, units) for ours in UNITS}
    chosen = _chosen(guesses)
    lines = [_HEAD.format(file=_plain(fmu.name)), "# What is set"]
    for ours in UNITS:
        if ours == next(name for name in UNITS if name not in INPUT_UNITS):
            lines += ["", "# What is read"]
        lines.append(_line(ours, guesses[ours], chosen.get(ours), theirs))
    named = {guess.theirs.name for guess in chosen.values()}
    rest = [each for each in theirs if each.name not in named]
    if rest:
        lines += ["", "# Variables of the FMU that have no entry"]
        lines += [f"# {_plain(told(each))} ({each.causality})" for each in rest]
    return "\n".join(lines) + "\n"


def _guesses(ours: str, theirs: Sequence[Any], units: Mapping[str, Unit]) -> list[_Guess]:
    """Return what may be one of our variables, the likeliest first."""
    fitting = [each for each in theirs if _fits(ours, each, units)]
    with_unit = [each for each in fitting if unit_of(each) is not None]
    found = []
    for each in fitting:
        score = _score(ours, each)
        if UNITS[ours] in _TELLING and with_unit == [each]:
            score += _ALONE
        if not looks_like(ours, each):
            score -= _INNER
        if score > 0:
            found.append(_Guess(each, score))
    return sorted(found, key=lambda guess: -guess.score)


def _fits(ours: str, theirs: Any, units: Mapping[str, Unit]) -> bool:
    if theirs.causality not in (SETTABLE if ours in INPUT_UNITS else READABLE):
        return False
    if theirs.variability == "constant":
        return False
    if theirs.type not in NUMBERS or theirs.dimensions:
        return False
    whole = theirs.type not in ("Real", "Float64", "Float32")
    if theirs.name != ours and whole != (ours in QUANTITIES and QUANTITIES[ours].discrete):
        return False
    expected = spelled(UNITS[ours])
    unit = _dimension(theirs, units)
    assert expected is not None
    if unit_of(theirs) is not None and unit is None:
        return False
    return unit is None or unit.dimension == expected.dimension


def _dimension(theirs: Any, units: Mapping[str, Unit]) -> Unit | None:
    name = unit_of(theirs)
    return None if name is None else units.get(name) or spelled(name)


def _score(ours: str, theirs: Any) -> int:
    if theirs.name == ours:
        return _SAME_NAME
    in_name, in_text = _tokens(theirs.name), _tokens(theirs.description or "")
    best = 0
    for alternative in _WORDS[ours].split(" | "):
        found = [_found(word, in_name, in_text) for word in alternative.split()]
        if all(found):
            best = max(best, sum(found))
    return best


def _found(word: str, in_name: Sequence[str], in_text: Sequence[str]) -> int:
    for tokens, score in ((in_name, 2), (in_text, 1)):
        if any(each == word or (len(word) > 1 and each.startswith(word)) for each in tokens):
            return score
    return 0


@cache
def _tokens(text: str) -> tuple[str, ...]:
    """Split a name or a sentence into words: at other characters and at capitals."""
    parts = re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|[^\W\d_]+", text)
    return tuple(part.lower() for part in parts)


def _chosen(guesses: Mapping[str, Sequence[_Guess]]) -> dict[str, _Guess]:
    """Return the guesses that are sure, no variable twice.

    Of two that claim one variable the better has it, and the other takes its next guess.
    """
    chosen: dict[str, _Guess] = {}
    while True:
        taken = {guess.theirs.name for guess in chosen.values()}
        claims: dict[str, list[tuple[int, str, _Guess]]] = {}
        for ours, found in guesses.items():
            left = [guess for guess in found if guess.theirs.name not in taken]
            if ours not in chosen and _sure(left):
                claim = (left[0].score, ours, left[0])
                claims.setdefault(left[0].theirs.name, []).append(claim)
        before = len(chosen)
        for claimants in claims.values():
            best, *others = sorted(claimants, key=lambda claim: -claim[0])
            if not others or best[0] > others[0][0]:
                chosen[best[1]] = best[2]
        if len(chosen) == before:
            return chosen


def _sure(found: Sequence[_Guess]) -> bool:
    """Whether the first guess is good, and better than the next by enough."""
    if not found or found[0].score < _SURE:
        return False
    return len(found) == 1 or found[0].score - found[1].score >= _AHEAD


def _line(
    ours: str, guesses: Sequence[_Guess], chosen: _Guess | None, theirs: Sequence[Any]
) -> str:
    meaning = _PARAMETERS.get(ours) or QUANTITIES[ours].meaning
    unit = "" if UNITS[ours] == "1" else f" [{UNITS[ours]}]"
    about = f"{meaning}{unit}"
    if ours in _DIRECTED:
        about += ", positive along the pull"
    if chosen is None:
        same = next((each for each in theirs if each.name == ours), None)
        if same is not None and looks_like(ours, same) and not guesses:
            return f'{ours} = ""  # {about}; of the FMU: {_plain(told(same))}, something else'
        near = [_quoted(guess.theirs.name) for guess in guesses[: _ALTERNATIVES + 1]]
        also = f"; or {', '.join(near[1:])}" if len(near) > 1 else ""
        return f"# {ours} = {near[0] if near else _quoted('...')}  # {about}{also}"
    declared = unit_of(chosen.theirs)
    if declared is not None:
        about += f"; in {_plain(declared)}"
    elif unit:
        about += "; no unit declared, so this one is assumed"
    others = [guess for guess in guesses if guess is not chosen][:_ALTERNATIVES]
    if others:
        about += f"; or {', '.join(_quoted(guess.theirs.name) for guess in others)}"
    name = _quoted(chosen.theirs.name)
    if ours == "z" and _AGAINST in _tokens(chosen.theirs.name):
        return f"{ours} = {{ name = {name}, sign = -1 }}  # {about}"
    return f"{ours} = {name}  # {about}"


def _quoted(name: str) -> str:
    """Return a name as a TOML string."""
    return json.dumps(name, ensure_ascii=False).replace("\x7f", "\\u007f")


def _plain(text: str) -> str:
    """Return a text as a TOML comment can hold it: on one line, without control characters."""
    return "".join(letter if letter.isprintable() else " " for letter in text)
