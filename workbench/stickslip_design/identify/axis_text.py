"""What a record tells, written into the text of an axis file: the lines of these numbers change."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Final

from stickslip_units import scale_for

from ..axis import Axis, AxisFile
from ..axis import Number as Stated
from ..axis.keys import ABOVE, KEYS, LEAST, Key, place
from ..measures.moving import with_number
from .model import Identified, Number

_OURS: Final = "#: "
"""What a line of ours begins with; the next record takes its place."""
_LINE: Final = re.compile(r"\s*(?:\[+([\w.]+)\]+|(\w+)\s*=)")
"""A header or a key: the section, the key."""
_PAIR: Final = re.compile(r'"(\w+)": ')
"""A key and its colon in JSON."""
_RIGID: Final = ("axis.mass", "axis.stiffness", "friction.F_s", "friction.F_k", "demand.feeds")
"""What a rigid axis needs."""
_LOW: Final = 0.2
"""The low end of a number above 0, over its middle, is at least this."""


def axis_of(file: AxisFile) -> Axis:
    """Return the axis of a file whose friction may be what a record is made for.

    A static or kinetic friction that it does not state is taken as the other one, or as none.
    AxisError as of `AxisFile.axis`, and of a rotary table.
    """
    file.refuse_turning("identification")
    if "friction.curve" in file.values:
        return file.axis()
    static, kinetic = _frictions(file)
    none = Stated(0.0, KEYS[static].units[0])
    other = {static: file.values.get(kinetic, none), kinetic: file.values.get(static, none)}
    sections = tuple(dict.fromkeys((*file.sections, "friction")))
    return replace(file, values={**other, **file.values}, sections=sections).axis()


def _frictions(file: AxisFile | None) -> tuple[str, str]:
    """Return the keys of friction in a file: coefficients, else forces."""
    names = "friction.mu_s", "friction.mu_k"
    is_by_mu = file and any(name in file.values for name in names)
    return names if is_by_mu else ("friction.F_s", "friction.F_k")


def written(found: Identified, file: AxisFile | None, source: str) -> str:
    """Return the text of an axis file with the numbers that a record tells, each with its ±.

    They stand below the headers of their sections. What stated the same becomes a comment, all
    other lines of a file are held. `source` is the name of the record.
    """
    numbers = {number.name: number for number in found.numbers}
    numbers = _for_file(numbers, file) if file else numbers
    new: dict[str, str] = {}
    said = [f"identified from {source}; ± is half the interval of 95 %"]
    said += [f"the model does not explain the record: {fault}" for fault in found.residual.faults]
    for path, number in numbers.items():
        key = KEYS.get(path)
        if key and (quantity := _quantity(key, number)):
            note = "95 %" if number.identified else "not identified: a range"
            new[path] = f'{key.name} = "{quantity}"  # {source}, {note}'
        elif key:
            said.append(f"{path} is not stated: it is not in the range of the key")
    static, kinetic = _frictions(file)
    if file and static in file.values and kinetic in new and static not in new:
        said.append(f"static friction is not in this record: {static} of the file is held")
    said += [f"this record cannot tell {what}: {why}" for what, why in found.missing]
    missing = () if file else (KEYS[path] for path in _RIGID if path not in new)
    said += [f"missing: {key.path}, such as {key.name} = {key.example}" for key in missing]
    lines = _edited(_lines(file) if file else ["[axis]", "", "[friction]"], new)
    return "\n".join((*(_OURS + " ".join(each.split()) for each in said), *lines, ""))


def shown(unit: str, half: float, *values: float) -> tuple[str, ...]:
    """Return values [SI], their half-width and their unit, as `rounded` in the unit of the first.

    That is one in which the larger of value and half-width is neither tiny nor huge.
    """
    scale = scale_for(max(abs(values[0]), half if math.isfinite(half) else 0.0), unit)
    cut = [rounded(value / scale.size, half / scale.size) for value in values]
    return (*(value for value, _ in cut), cut[0][1], scale.symbol.replace(".s", "·s"))


def rounded(value: float, half: float) -> tuple[str, str]:
    """Return a value to the second digit of its half-width, and that, rounded up."""
    if not 0.0 < half < math.inf:
        return f"{value:.6g}", f"{half:g}"
    power = math.floor(math.log10(half)) - 1
    steps, decimals = math.ceil(half / 10.0**power - 1e-6), max(0, -power)
    near, around = round(value / 10.0**power) * 10.0**power, steps * 10.0**power
    return f"{near:.{decimals}f}", f"{around:.{decimals}f}"


def _lines(file: AxisFile) -> list[str]:
    """Return the lines of a file; of sections in a line, or from Python, one for each key."""
    lines = [line for line in file.text.splitlines() if not line.startswith(_OURS)]
    headers = {match[1] for match in map(_LINE.match, lines) if match}
    if file.tables.keys() <= headers:
        return lines
    lines = []
    for name, table in file.tables.items():
        texts = {key: json.dumps(value, ensure_ascii=False) for key, value in table.items()}
        lines += ["", f"[{name}]"]
        lines += [f"{key} = " + _PAIR.sub(r"\1 = ", text) for key, text in texts.items()]
    return lines


def _edited(lines: Iterable[str], new: Mapping[str, str]) -> Iterator[str]:
    """Yield lines with new ones below the headers; what says the same becomes a comment.

    With a key go those that need it.
    """
    old = {place(KEYS[path].section, name) for path in new for name in KEYS[path].excludes}
    needs = {key.path: place(key.section, (key.goes_with or ("",))[0]) for key in KEYS.values()}
    left, section = dict(new), ""
    for line in lines:
        match = _LINE.match(line)
        section = (match and match[1]) or section
        path = f"{section}.{match[2]}" if match and match[2] else ""
        is_old = {path, needs.get(path), needs.get(needs.get(path, ""))} & (old | new.keys())
        yield f"# {line}" if is_old else line
        if match and match[1]:
            yield from [left.pop(path) for path in new if KEYS[path].section == section]
    for key in (KEYS[path] for path in KEYS if path in left):
        if section != key.section:
            section = key.section
            yield from ("", f"[{section}]")
        yield left[key.path]


def _for_file(numbers: Mapping[str, Number], file: AxisFile) -> dict[str, Number]:
    """Return by name the numbers as a file states them, with those that both together make.

    k = (k/m) m, c = (c/m) m, F_s = F_k + (F_s - F_k), F_s - F_k = k gap; friction by forces or by
    coefficients, none beside a curve. The parts of an interval are taken as independent.
    """
    told, axis = dict(numbers), axis_of(file)
    if "friction.curve" in file.values:
        told = {name: each for name, each in told.items() if not name.startswith("friction")}
    part, of_weight = axis.spread.get("axis.mass", 0.0) / axis.m, 0.0
    if (mass := told.get("axis.mass")) and mass.identified and mass.value > 0.0:
        axis, part = with_number(axis, "axis.mass", mass.value), mass.width
        of_weight = part * axis.m * axis.g / axis.normal_force

    def make(name: str, of: str, factor: float, part: float, more: float = 0.0) -> None:
        """Make a number of another one, by a factor that is known to a part of it, and a sum."""
        if of in told and name not in told:
            one, unit, value = told[of], KEYS[name].units[0], more + factor * told[of].value
            half = math.hypot(0.5 * factor * (one.high - one.low), part * (value - more))
            low, high = value - half, value + half
            told[name] = replace(one, name=name, unit=unit, value=value, low=low, high=high)

    make("axis.stiffness", "k/m", axis.m, part)
    make("axis.c", "c/m", axis.m, part)
    static, kinetic = _frictions(file)
    if kinetic in file.values and "friction.mu_s" not in told:
        make("friction.F_s", "F_s - F_k", 1.0, 0.0, axis.F_k)
        if k := told.get("axis.stiffness"):
            make("friction.F_s", "gap", k.value, k.width, axis.F_k)
    normal = axis.normal_force
    of, factor = ("F", 1.0 / normal) if "mu" in static else ("mu", normal)
    for name in (static, kinetic):
        make(name, other := f"friction.{of}_{name[-1]}", factor, of_weight)
        told.pop(other, None)
    return told


def _quantity(key: Key, number: Number) -> str:
    """Return a number, or the range of an unknown one, as a file has it; empty: too wide for it."""
    low, high = max(number.low, 0.0) if key.within is LEAST else number.low, number.high
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    if number.identified:
        middle, half = number.value, max(high - number.value, number.value - low)
    inside = low in key.within and high in key.within
    if not inside or (key.within is ABOVE and low < _LOW * middle):
        return ""
    value, around, unit = shown(key.units[0], half, middle)
    # Rounded up, the ± may leave the range of the key.
    value = around if key.within is LEAST and float(value) < float(around) else value
    return f"{value} {unit} ± {around} {unit}".replace("  ", " ").strip()
