"""What a record tells, written into the text of an axis file: the lines of these numbers change."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

from stickslip_units import on_data_sheet, parts_of

from ..axis import Axis, AxisFile, template
from ..axis import Number as Stated
from ..axis.keys import ABOVE, KEYS, LEAST, Key, place
from ..measures.moving import with_number
from .model import Identified, Number

_OURS: Final = "#: "
"""What a line of ours begins with; the next record takes its place."""
_LINE: Final = re.compile(r"\s*(#\s*)?(?:\[\[?([\w.]+)\]\]?\s*(?:#.*)?$|([A-Za-z_]\w*)\s*=\s*(.*))")
"""A header or a key, maybe behind #: that, the section, the name, the value."""
_RIGID: Final = ("", "axis", "friction", "demand")
"""What the template of a rigid axis has: its head, and these sections."""
_LOW: Final = 0.2
"""The low end of a number above 0 that is not known, over its middle, is at least this."""
_STATIC: Final = {f"friction.{form}_k": f"friction.{form}_s" for form in ("mu", "F")}
"""Keys of the static friction, by those of the kinetic."""


def axis_of(file: AxisFile) -> Axis:
    """Return the axis of a file whose friction may be what a record is made for.

    A static or kinetic friction that it does not state is taken as the other one, or as none.
    AxisError as of `AxisFile.axis`, and of a rotary table.
    """
    file.refuse_turning("identification")
    values = dict(file.values)
    if "friction.curve" not in values:
        for kinetic, static in _STATIC.items():
            for one, other in ((kinetic, static), (static, kinetic)):
                if one in values:
                    values.setdefault(other, values[one])
        if not values.keys() & _STATIC.keys():
            values |= dict.fromkeys(("friction.F_s", "friction.F_k"), Stated(0.0, "N"))
    sections = tuple(dict.fromkeys((*file.sections, "friction")))
    return replace(file, values=values, sections=sections).axis()


def written(found: Identified, file: AxisFile | None, source: str) -> str:
    """Return the text of an axis file with the numbers that a record tells, each with its ±.

    The other lines of a file are held. Without a file it is the template of a rigid axis, in which
    what the record leaves open is commented out. `source` is the name of the record.
    """
    text = file.text if file else _rigid()
    lines = [line for line in text.splitlines() if not line.startswith(_OURS)]
    if file and not (text and _places(lines).keys() >= file.tables.keys()):
        lines = [line for name, table in file.tables.items() for line in _in_lines(name, table)]
    values = {path: v for path, v in (file.values if file else {}).items() if isinstance(v, Stated)}
    curve = file is not None and "friction.curve" in file.values
    numbers = {each.name: each for each in found.numbers}
    numbers = _for_file(found.numbers, file) if file else numbers
    said = [f"identified from {source}; ± is half the interval of 95 %"]
    said += [f"the model does not explain the record: {each}" for each in found.residual.faults]
    done = {*_RIGID}
    for path, number in numbers.items():
        key, why = KEYS.get(path), "no key of an axis file"
        if key is not None:
            stated, why = _stated(key, number), "its interval is too wide for the key"
            if not (curve and key.section == "friction") and stated is not None:
                note = f"{source}, {'95 %' if number.known else 'not identified: a range'}"
                _write(lines, key, stated, note, told=file is not None)
                done.add(path)
                continue
            why = why if stated is None else "the curve of the file is held"
        value, half = rounded(number.value, 0.5 * (number.high - number.low))
        said.append(f"{path} = {value} ± {half} {number.unit} ({number.meaning}): {why}")
    for kinetic, static in _STATIC.items() if not curve else ():
        if kinetic in numbers and static not in numbers:
            now, reason = values.get(static), f"without {static} no verdict"
            if now and now.unit == numbers[kinetic].unit and now.value < numbers[kinetic].value:
                reason = f"{static} of the file is below the kinetic one, {reason}"
                _comment_out(lines, static)
            elif now:
                exact = ", which states no ±" * (not now.spread)
                reason = f"{static} of the file is held{exact}"
            said.append(f"static friction is not in this record: {reason}")
    said += [f"this record cannot tell {what}: {why}" for what, why in found.untold]
    if file is None:
        for path, (n, off) in _places(lines).items():
            if path not in done and not off:
                lines[n] = f"# {lines[n]}  # missing: not in this record"
    return "\n".join((*(_OURS + " ".join(each.split()) for each in said), *lines, ""))


def rounded(value: float, half: float) -> tuple[str, str]:
    """Return a value to the second digit of its half-width, and that, rounded up."""
    if not 0.0 < half < math.inf:
        return f"{value:.6g}", f"{half:g}"
    power = math.floor(math.log10(half)) - 1
    steps, decimals = math.ceil(half / 10.0**power - 1e-6), max(0, -power)
    near, around = round(value / 10.0**power) * 10.0**power, steps * 10.0**power
    return f"{near:.{decimals}f}", f"{around:.{decimals}f}"


def _in_lines(name: str, table: Mapping[str, Any]) -> Iterator[str]:
    """Yield a section of a file whose sections stand in a line, or that comes from Python."""
    yield from ("", f"[{name}]")
    for key, value in sorted(table.items(), key=lambda each: each[0] == "filter"):
        for row in value if key == "filter" else ():
            yield from _in_lines(f"[{name}.{key}]", row)
        if key != "filter":
            yield f"{key} = {json.dumps(value, ensure_ascii=False)}"


def _rigid() -> str:
    """Return the template of a rigid axis."""
    parts = template().split("\n\n")
    headers = [re.findall(r"^(?:# )?\[\[?([\w.]+)\]", part, re.M) or [""] for part in parts]
    return "\n\n".join(part for part, of in zip(parts, headers, strict=True) if of[0] in _RIGID)


def _for_file(numbers: Sequence[Number], file: AxisFile) -> dict[str, Number]:
    """Return by name the numbers as a file states them, with those that both together make.

    k = (k/m) m, c = (c/m) m, F_s = F_k + (F_s - F_k), F_s - F_k = k gap; friction by forces or by
    coefficients. The parts of an interval are taken as independent.
    """
    told, axis = {each.name: each for each in numbers}, axis_of(file)
    parts = {path: v.spread / v.value for path, v in file.values.items()
             if isinstance(v, Stated) and v.spread}  # fmt: skip

    def make(name: str, of: Number, value: float, half: float) -> None:
        unit, low, high = KEYS[name].units[0], value - half, value + half
        told[name] = replace(of, name=name, unit=unit, value=value, low=low, high=high)

    mass = told.get("axis.mass")
    mass = mass if mass and mass.known and mass.value > 0.0 else None
    axis = with_number(axis, "axis.mass", mass.value) if mass else axis
    for ratio, name in (("k/m", "axis.stiffness"), ("c/m", "axis.c")):
        if ratio in told and name not in told and not mass:
            of, width = told[ratio], math.hypot(told[ratio].width, parts.get("axis.mass", 0.0))
            make(name, of, of.value * axis.m, abs(of.value) * axis.m * width)
    gap, k, step = (told.get(name) for name in ("gap", "axis.stiffness", "F_s - F_k"))
    rise, wide = (step.value, step.width) if step else (0.0, 0.0)
    if gap and k and not step:
        step, rise, wide = gap, gap.value * k.value, math.hypot(gap.width, k.width)
    kinetic = next((path for path in _STATIC if path in file.values), "")
    if step and kinetic and not told.keys() & {*_STATIC.values(), *_STATIC}:
        half = math.hypot(axis.F_k * parts.get(kinetic, 0.0), rise * wide)
        make("friction.F_s", step, axis.F_k + rise, half)
    weight, normal = axis.m * axis.g, axis.normal_force
    of_mass = mass.width * weight / normal if mass else 0.0
    for form, other, factor in (("F", "mu", 1.0 / normal), ("mu", "F", normal)):
        if any(f"friction.{other}_{which}" in file.values for which in "sk"):
            for which in "sk":
                of_form = told.pop(f"friction.{form}_{which}", None)
                if of_form and (name := f"friction.{other}_{which}") not in told:
                    value, width = of_form.value * factor, math.hypot(of_form.width, of_mass)
                    make(name, of_form, value, abs(value) * width)
    return told


def _stated(key: Key, number: Number) -> tuple[float, float] | None:
    """Return a value and its ± that a file may state, of what is not known its range; or None."""
    low = max(number.low, 0.0) if key.within is LEAST else number.low
    if not (low in key.within and number.high in key.within):
        return None
    if number.known:
        return number.value, max(number.high - number.value, number.value - low)
    middle, half = 0.5 * (low + number.high), 0.5 * (number.high - low)
    return None if key.within is ABOVE and low < _LOW * middle else (middle, half)


def _write(
    lines: list[str], key: Key, stated: tuple[float, float], note: str, *, told: bool
) -> None:
    """State a number in its line, in the unit there; what says the same becomes a comment.

    If `told`, what was stated is told behind it.
    """
    for name in key.excludes:
        _comment_out(lines, place(key.section, name))
    n, off = _places(lines).get(key.path, (-1, True))
    match = None if off or not told else _LINE.match(lines[n])
    was = match[4].partition("#")[0].strip() if match else ""
    (symbol, size), example, usual = (
        _unit(text.strip('"'), key) for text in (was, key.example, f"1 {key.units[0]}")
    )
    if not symbol:
        symbol, size = example if abs(stated[0]) >= example[1] else usual
    value, half = rounded(*(each / size for each in stated))
    # Rounded up, the ± may leave the range of the key.
    value = half if key.within is LEAST and float(value) < float(half) else value
    value, half = (f"{each} {symbol}".strip() for each in (value, half))
    line = f'{key.name} = "{value} ± {half}"  # {note}{"; was " * bool(was)}{was}'
    if n >= 0:
        lines[n] = line
        return
    header, _ = _places(lines).get(key.section, (-1, True))
    if header < 0:
        lines += ["", f"[{key.section}]"]
    lines[header] = lines[header].lstrip("# ")
    lines.insert(header + 1 if header >= 0 else len(lines), line)


def _unit(text: str, key: Key) -> tuple[str, float]:
    """Return the unit of a quantity and its size [SI]; none if it is of another dimension."""
    symbol = parts_of(re.split(r"±|\+/-|\+-", text)[0])[1] if text[:1] not in ("", "[") else ""
    unit, usual = on_data_sheet(symbol or "1"), on_data_sheet(key.units[0])
    alike = unit and usual and unit.dimension == usual.dimension and symbol != "1"
    return (symbol.replace(".", " "), float(unit.factor)) if unit and alike else ("", 1.0)


def _comment_out(lines: list[str], path: str) -> None:
    """Make comments of what states a key, and of the keys that go with that alone."""
    n, off = _places(lines).get(path, (-1, True))
    if not off:
        lines[n] = f"# {lines[n]}"
        for key in KEYS.values():
            if key.goes_with and place(key.section, key.goes_with[0]) == path:
                _comment_out(lines, key.path)


def _places(lines: Sequence[str]) -> dict[str, tuple[int, bool]]:
    """Return where each section and key stands, and whether that is a comment."""
    found: dict[str, tuple[int, bool]] = {}
    live = section = ""
    for n, match in enumerate(map(_LINE.match, lines)):
        if match is None:
            continue
        off, header = bool(match[1]), match[2]
        if header:
            section, live = header, live if off else header
        path = header or f"{section if off else live}.{match[3]}"
        if path not in found or (found[path][1] and not off):
            found[path] = n, off
    return found
