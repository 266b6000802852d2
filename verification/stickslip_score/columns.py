"""Which column is which: names as the tools write them, and their units."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from stickslip_score.curve import CurveError

_TIMES = {
    "": 1.0,
    "s": 1.0,
    "sec": 1.0,
    "seconds": 1.0,
    "ms": 1e-3,
    "us": 1e-6,
    "µs": 1e-6,
    "min": 60.0,
}
_LENGTHS = {"": 1.0, "m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "nm": 1e-9}
_VELOCITIES = {f"{length}/s": size for length, size in _LENGTHS.items() if length} | {
    "": 1.0,
    "m.s-1": 1.0,
    "mm/min": 1e-3 / 60.0,
    "m/min": 1.0 / 60.0,
}
_FORCES = {"": 1.0, "N": 1.0, "mN": 1e-3, "kN": 1e3, "MN": 1e6}


@dataclass(frozen=True)
class _Quantity:
    """What a column may be called, the plainest names first, and its units by size in SI."""

    meaning: str
    plain: tuple[str, ...]
    others: frozenset[str]
    units: Mapping[str, float]


_QUANTITIES = {
    "t": _Quantity("time", ("time", "t", "Time"), frozenset({"time", "t", "zeit"}), _TIMES),
    "x": _Quantity(
        "position",
        ("x", "X", "position"),
        frozenset({"x", "s", "pos", "position", "x_mass", "mass_x", "displacement", "weg"}),
        _LENGTHS,
    ),
    "x_dot": _Quantity(
        "velocity",
        ("x_dot", "der(x)"),
        frozenset(
            {"x_dot", "xdot", "dx", "dxdt", "v_mass", "v_m", "vel", "velocity", "speed"}
            | {"der(x)", "der(s)", "mass.v"}
        ),
        _VELOCITIES,
    ),
    "F": _Quantity(
        "spring force",
        ("F", "F_spring", "spring_force"),
        frozenset({"f", "force", "f_spring", "spring_force", "springforce", "f_c", "kraft"}),
        _FORCES,
    ),
}

_WITH_UNIT = re.compile(r"^(?P<name>.*?)\s*(?:\[(?P<square>[^\]]*)\]|\s\((?P<round>[^)]*)\))$")
_ROUND_AT_ONCE = re.compile(r"^(?P<name>(?!der$)[^()]*)\((?P<round>[^)]*)\)$", re.IGNORECASE)


@dataclass(frozen=True)
class Column:
    """A column of the file: what it holds, where it stands, its name and the size of its unit."""

    quantity: str
    index: int
    name: str
    unit: float


def find_columns(header: Sequence[str], names: Mapping[str, str]) -> list[Column]:
    """Find the columns of t, x, x_dot and F in a header line.

    Parameters
    ----------
    header
        The cells of the header line.
    names
        Column names by quantity (t, x, x_dot, F) that are not to be guessed; one may carry the
        unit that the header lacks.

    Raises
    ------
    CurveError
        No time, neither x nor F, a name that is not there, several that may be meant, or a unit
        that is not known. The message names the columns.
    """
    cells = [cell.strip().strip("'\"").strip() for cell in header]
    if all(_is_number(cell) for cell in cells if cell):
        raise CurveError("has no header line: its first line holds numbers only")
    columns = []
    for quantity in _QUANTITIES:
        if quantity in names:
            index, text = _named(names[quantity], cells)
        else:
            guessed = _guessed(quantity, cells)
            if guessed is None:
                continue
            index, text = guessed, cells[guessed]
        columns.append(Column(quantity, index, cells[index], _unit(text, _QUANTITIES[quantity])))
    there = {column.quantity for column in columns}
    listed = f"the columns are {', '.join(cells)}"
    if "t" not in there:
        raise CurveError(f"no column of time; {listed}")
    if not there & {"x", "F"}:
        raise CurveError(f"no column of the position x nor of the spring force F; {listed}")
    return columns


def _is_number(cell: str) -> bool:
    try:
        float(cell.replace(",", "."))
    except ValueError:
        return False
    return True


def _split(cell: str) -> tuple[str, str]:
    """Return name and unit of a header cell."""
    found = _WITH_UNIT.match(cell) or _ROUND_AT_ONCE.match(cell)
    if not found:
        return cell, ""
    groups = found.groupdict()
    return groups["name"].strip(), (groups.get("square") or groups.get("round") or "").strip()


def _named(wanted: str, cells: Sequence[str]) -> tuple[int, str]:
    """Return the column that a person named, and the text that tells its unit.

    It is named by its whole text, by its name, by either in any case, or by its name with the
    unit that the header lacks.
    """
    plain = [_split(cell)[0] for cell in cells]
    name, unit = _split(wanted)
    without_unit = [cell if not _split(cell)[1] else "" for cell in cells]
    for there, looked_for, text in (
        (cells, wanted, ""),
        (plain, wanted, ""),
        ([cell.casefold() for cell in cells], wanted.casefold(), ""),
        ([cell.casefold() for cell in plain], wanted.casefold(), ""),
        (without_unit, name if unit else None, wanted),
        ([cell.casefold() for cell in without_unit], name.casefold() if unit else None, wanted),
    ):
        found = [index for index, cell in enumerate(there) if cell == looked_for]
        if len(found) == 1:
            return found[0], text or cells[found[0]]
        if found:
            raise CurveError(f"{len(found)} columns are called {wanted}")
    raise CurveError(f"no column {wanted!r}; the columns are {', '.join(cells)}")


def _guessed(quantity: str, cells: Sequence[str]) -> int | None:
    known = _QUANTITIES[quantity]
    names = [_split(cell)[0] for cell in cells]
    for name in known.plain:
        if names.count(name) == 1:
            return names.index(name)
    whole = [i for i, name in enumerate(names) if name.casefold() in known.others]
    last = [i for i, name in enumerate(names) if _last_part(name) in known.others]
    found = whole or last
    if len(found) > 1:
        candidates = ", ".join(cells[i] for i in found)
        raise CurveError(f"{known.meaning} may be any of {candidates}: name the column")
    return found[0] if found else None


def _last_part(name: str) -> str:
    """Return what stands after the last dot: ``mass.s`` is the s of a mass."""
    return name.rpartition(".")[2].casefold()


def _unit(cell: str, known: _Quantity) -> float:
    unit = _split(cell)[1].replace("μ", "µ").replace(" ", "")
    # The case of a letter tells milli from mega, and is else of no account.
    sizes = {known.units[unit]} if unit in known.units else set()
    sizes = sizes or {size for name, size in known.units.items() if name.lower() == unit.lower()}
    if len(sizes) != 1:
        units = ", ".join(name for name in known.units if name)
        raise CurveError(f"{cell}: the unit of the {known.meaning} is none of {units}")
    return sizes.pop()
