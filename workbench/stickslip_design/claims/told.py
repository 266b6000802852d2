"""The claims as they are told: data files, each with the grid that its claim is tried on."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from stickslip_design.claims.finding import Finding, Panel
from stickslip_verification.model.data_file import DataError, DataFile
from stickslip_verification.truth.parameters import complete

HERE = Path(__file__).parent

_TEXTS = ("id", "title", "claim", "formula", "source")

_UNITS = {"m": "kg", "g": "m/s²", "k": "N/m", "c": "N·s/m", "v": "m/s", "load": "N", "F_ext": "N"}

# Points of a grid are written to so many digits, so that they are the same doubles everywhere.
_GRID_DIGITS = 5


class ClaimError(DataError):
    """A claim's file cannot be used; one line with the file, the field and the reason."""


@dataclass(frozen=True)
class Claim:
    """One claim as it is told, and where it is to be tried.

    Attributes
    ----------
    id, title, claim, formula, source
        As in `Finding`.
    parameters
        The block that it is tried on, SI, all twelve values of `truth.START_VALUES` by name.
    block
        What the file says of the block, as a reader reads it.
    grid
        Named lists of numbers; what each is and its unit stands in the file.
    """

    id: str
    title: str
    claim: str
    formula: str
    source: str
    parameters: Mapping[str, float]
    block: str
    grid: Mapping[str, tuple[float, ...]]

    def found(
        self,
        *,
        verdict: str,
        sentence: str,
        header: tuple[str, ...],
        rows: tuple[tuple[str, ...], ...],
        panels: tuple[Panel, ...],
    ) -> Finding:
        """Return the finding of this claim; the arguments are those of `Finding`."""
        return Finding(
            id=self.id,
            title=self.title,
            claim=self.claim,
            formula=self.formula,
            source=self.source,
            block=self.block,
            verdict=verdict,
            sentence=sentence,
            header=header,
            rows=rows,
            panels=panels,
        )


def load_claim(file: Path, wanted: Collection[str]) -> Claim:
    """Read one claim, whose grid holds just the wanted lists.

    Raises
    ------
    ClaimError
        Naming the file, the field and what is wrong with it.
    """
    table = DataFile(file, ClaimError).data
    unknown = sorted(set(table) - {*_TEXTS, "parameters", "grid"})
    if unknown:
        raise ClaimError(file, unknown[0], "no such field")
    for name in _TEXTS:
        if not isinstance(table.get(name), str) or not table[name].strip():
            raise ClaimError(file, name, "a text is wanted")
    if table["id"] != file.stem:
        raise ClaimError(file, "id", f"{table['id']!r} is not the name of the file")
    parameters = _table(file, table, "parameters")
    grid = _table(file, table, "grid")
    if set(grid) != set(wanted):
        raise ClaimError(file, "grid", f"it holds {sorted(grid)}, wanted is {sorted(wanted)}")
    given = {name: _number(file, f"parameters.{name}", each) for name, each in parameters.items()}
    try:
        block = complete(given)
    except ValueError as error:
        raise ClaimError(file, "parameters", str(error)) from error
    return Claim(
        **{name: " ".join(table[name].split()) for name in _TEXTS},
        parameters=block,
        block=", ".join(
            f"{name} = {block[name]:g} {_UNITS.get(name, '')}".rstrip() for name in parameters
        ),
        grid={name: _points(file, f"grid.{name}", each) for name, each in grid.items()},
    )


def geometric(low: float, high: float, count: int) -> tuple[float, ...]:
    """Return `count` numbers from `low` to `high` in equal ratios, to five digits."""
    ratio = high / low
    exact = (low * ratio ** (i / (count - 1)) for i in range(count))
    return tuple(float(f"{number:.{_GRID_DIGITS}g}") for number in exact)


def _table(file: Path, table: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    found = table.get(name)
    if not isinstance(found, dict):
        raise ClaimError(file, name, "a table is wanted")
    return found


def _number(file: Path, where: str, given: object) -> float:
    if isinstance(given, bool) or not isinstance(given, int | float) or not math.isfinite(given):
        raise ClaimError(file, where, f"{given!r} is not a finite number")
    return float(given)


def _points(file: Path, where: str, given: object) -> tuple[float, ...]:
    if isinstance(given, list):
        points = tuple(_number(file, where, each) for each in given)
        if not points:
            raise ClaimError(file, where, "an empty list")
        return points
    if isinstance(given, dict):
        if set(given) != {"from", "to", "points"}:
            raise ClaimError(file, where, "a range is { from, to, points }")
        low, high = _number(file, where, given["from"]), _number(file, where, given["to"])
        count = given["points"]
        if isinstance(count, bool) or not isinstance(count, int) or count < 2:
            raise ClaimError(file, where, f"points = {count!r} is outside points >= 2")
        if not 0.0 < low < high:
            raise ClaimError(file, where, "0 < from < to is wanted: the range goes by equal ratios")
        return geometric(low, high, count)
    return (_number(file, where, given),)
