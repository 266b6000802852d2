"""What a record tells, written into an axis file."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import tomlkit

from stickslip_units import told

from ..axis import Axis, AxisError, AxisFile, axis_file_of
from ..axis import Number as Stated
from ..axis.build import values_of
from ..axis.keys import KEYS, LEAST, place
from .model import Identified


def axis_of(file: AxisFile) -> Axis:
    """Return the axis of a file without its friction, which a record is made for.

    AxisError as of `AxisFile.axis`, and of a rotary table.
    """
    file.refuse_turning("identification")
    values = {path: one for path, one in file.values.items() if not path.startswith("friction.")}
    values |= dict.fromkeys(("friction.F_s", "friction.F_k"), Stated(0.0, "N"))
    return replace(file, values=values, sections=(*file.sections, "friction")).axis()


def written(found: Identified, file: AxisFile, source: str) -> AxisFile:
    """Return an axis file that states what a file does, and the numbers of a record with their ±.

    What said the same goes, all other lines are held. `source` is the name of the record.
    """
    document, new = tomlkit.parse(file.text or tomlkit.dumps(file.tables)), dict[str, str]()
    said = list[str]()
    for path, (middle, half) in _intervals(found, file).items():
        if key := KEYS.get(path):
            low = max(middle - half, 0.0) if key.within is LEAST else middle - half
            middle, half = 0.5 * (low + middle + half), 0.5 * (middle + half - low)
            part = 100.0 * half / abs(middle) if middle else math.inf
            quantity = f"{told(middle, key.units[0], 6)} ± {part:.3g} %".replace("−", "-")
            try:
                values_of(key, path, quantity)
                new[path] = quantity
            except AxisError:
                said.append(f"# {path} is not stated: its interval is not in the range of the key")
    said.append(f"# from {source}, ± is half the interval of 95 %: {', '.join(new) or 'nothing'}")
    said += [f"# the model does not explain it: {fault}" for fault in found.faults]
    said += [f"# it cannot tell {what}: {why}" for what, why in found.missing]
    gone = {place(KEYS[path].section, name) for path in new for name in KEYS[path].excludes}
    for key in KEYS.values():
        if key.goes_with and place(key.section, key.goes_with[0]) in gone:
            gone.add(key.path)
        table: dict[str, Any] = document.get(key.section, {})
        if key.path in gone | new.keys():
            table.pop(key.name, None)
        if key.path in new:
            document.setdefault(key.section, {})[key.name] = new[key.path]
    text = "\n".join((*said, document.as_string()))
    return axis_file_of(text, file.name, file.folder)


def _intervals(found: Identified, file: AxisFile) -> dict[str, tuple[float, float]]:
    """Return middle and half-width [SI] by name, and of what they and a file together make.

    k = (k/m) m, c = (c/m) m, F_s - F_k = k gap, F_s = F_k + (F_s - F_k), mu = F/N where the file
    has coefficients; no friction beside a curve. The parts of an interval are independent.
    """
    known = {n.name: (0.5 * (n.low + n.high), 0.5 * (n.high - n.low)) for n in found.numbers}
    if not file.tables:
        return known
    axis, stated = axis_of(file), file.values
    if "friction.curve" in stated:
        known = {name: one for name, one in known.items() if not name.startswith("friction")}
    mass, around = axis.m, axis.spread.get("axis.mass", 0.0)
    if any(one.name == "axis.mass" and one.identified for one in found.numbers):
        mass, around = known["axis.mass"]
    normal, by_mu = mass * axis.g + axis.load, bool({"friction.mu_s", "friction.mu_k"} & {*stated})

    def make(name: str, of: str, factor: float, around: float = 0.0, more: float = 0.0) -> None:
        if of in known and name not in known:
            middle, half = known[of]
            known[name] = more + factor * middle, math.hypot(factor * half, around * middle)

    make("axis.stiffness", "k/m", mass, around)
    make("axis.c", "c/m", mass, around)
    make("F_s - F_k", "gap", *known.get("axis.stiffness", (axis.k, 0.0)))
    kinetic = stated.get("friction.mu_k" if by_mu else "friction.F_k")
    if isinstance(kinetic, Stated) and "friction.mu_s" not in known:
        make("friction.F_s", "F_s - F_k", 1.0, more=kinetic.value * (normal if by_mu else 1.0))
    for which in "sk" * by_mu:
        make(f"friction.mu_{which}", force := f"friction.F_{which}", 1.0 / normal)
        known.pop(force, None)
    return known
