"""How well a variable of an FMU answers to one of the suite: sort, unit, and the words about it."""

import contextlib
import re
import tomllib
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Final

from stickslip_verification.drive.fmu.description import Declared
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.fmu.instance import FLOATING
from stickslip_verification.drive.fmu.names import UNITS, Target, Variable, as_ours, looks_like
from stickslip_verification.model.quantities import QUANTITIES
from stickslip_verification.model.units import Unit
from stickslip_verification.truth.parameters import PARAMETERS, Kind

WHOLE: Final = 20.0
"""What it counts that name, description and unit say all that a quantity needs, and the name no
more; whatever lacks something has a smaller score."""

_SAME_NAME, _BASE = 8.0, 8.0
"""What our own name counts, and any variable of which something is said."""

_NAME, _TEXT, _MISSING = 2.0, 1.0, 2.0
"""What a word of the name and one of the description count, and what is not said."""

_TABLES: Final[Mapping[str, Mapping[str, str]]] = tomllib.loads(
    Path(__file__).with_name("words.toml").read_text("utf-8")
)
MEANINGS: Final = _TABLES["parameters"]
_TELLING: Final = ("kg", "m/s2", "N/m", "N.s/m")
_FIXED: Final = {each.name for each in PARAMETERS if each.kind is Kind.FIXED}
_DISCRETE: Final = {name for name, quantity in QUANTITIES.items() if quantity.discrete}

_CONCEPTS: Final[Mapping[str, set[str]]] = {
    word: {concept for concept, words in _TABLES["concepts"].items() if word in words.split()}
    for word in " ".join(_TABLES["concepts"].values()).split()
}
_WORD: Final = re.compile(
    "|".join(
        word if len(word) > 3 else rf"\b{word}\b"
        for word in sorted(_CONCEPTS, key=len, reverse=True)
    )
)
_SEAM: Final = re.compile(r"_|(?<=[a-zäöü])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])|(?<=[^\W\d])(?=\d)")


def candidate(ours: str, theirs: Declared, units: Mapping[str, Unit]) -> Variable | None:
    """Return a variable as ours if it may be: by causality, variability, type and dimension."""
    whole = theirs.type not in FLOATING
    if (
        (ours in _FIXED and theirs.causality == "input")
        or (whole and ours not in _DISCRETE and theirs.name != ours)
        or (theirs.type == "Boolean" and ours != "sticking")
        or theirs.variability == "constant"
    ):
        return None
    with contextlib.suppress(FmuError):
        return as_ours("", ours, Target(theirs.name), theirs, units, UNITS[ours])
    return None


def likeness(ours: str, theirs: Declared) -> float:
    """Score a variable that fits; 0 if nothing is said."""
    needs, may = (set(part.split()) for part in f"{_TABLES['quantities'][ours]} | ".split("|")[:2])
    name, text = words(theirs.name), words(theirs.description)
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
        return WHOLE + score + (_SAME_NAME if by_unit or UNITS[ours] == "1" else 0.0)
    if not said:
        return 0.0
    return max(score, 1.0) + (0.0 if missing or doubtful else WHOLE)


@cache
def words(text: str) -> tuple[str, ...]:
    """Return the known words in a name or a sentence, also those in camelCase and compounds."""
    return tuple(_WORD.findall(_SEAM.sub(" ", text).lower()))
