"""Axis files: TOML, as a machine-tool designer writes it.

    [axis]
    mass = "500 kg"
    stiffness = "40 N/um ± 10 %"

`keys.KEYS` lists what may stand there, `template` writes a file with all of it.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from difflib import get_close_matches
from hashlib import sha256
from pathlib import Path
from typing import Any, Final

import numpy as np

from stickslip_ref import FloatOrArray

from .build import Builder
from .keys import BY_SECTION, KEYS, NOT_YET, SECTIONS, Key, Section
from .model import Axis
from .refusal import AxisError
from .values import Number, Value, as_written, values_of

_SECTIONS: Final = {section.name: section for section in SECTIONS}
_NAMES_OF_DRIVES: Final = {"J": "inertia", "K_p": "velocity_gain", "lead": "pitch"}
"""Names that catalogues and parameter lists of drives have for keys."""
_DECIMAL_COMMA: Final = re.compile(r"=\s*-?\d+,\d")


@dataclass(frozen=True)
class AxisFile:
    """What an axis file states.

    Attributes
    ----------
    name
        Name of the file, for refusals.
    values
        The numbers and texts by name: ``axis.mass``, ``axis.stiffness[1]`` of a list,
        ``drive.filter[1].frequency``.
    """

    name: str
    values: Mapping[str, Value]
    _sections: tuple[str, ...]
    _written: Mapping[str, str]
    _text: str
    _folder: Path
    _is_changed: bool = False

    @property
    def identity(self) -> dict[str, Any]:
        """What the file states, as JSON knows it; of a measured curve the SHA-256 of its file.

        Raises
        ------
        AxisError
            If the file of the curve cannot be read.
        """
        stated = {
            path: [each.value, each.unit, each.spread] if isinstance(each, Number) else each
            for path, each in self.values.items()
        }
        curve = self.values.get("friction.curve")
        if not isinstance(curve, str):
            return stated
        try:
            content = (self._folder / curve).read_bytes()
        except OSError as error:
            reason = (error.strerror or type(error).__name__).lower()
            raise AxisError(
                f"cannot be read: {reason}", key="friction.curve", value=curve, name=self.name
            ) from None
        return stated | {"friction.curve": sha256(content).hexdigest()}

    def axis(self) -> Axis:
        """Return the axis.

        Raises
        ------
        AxisError
            If something is missing, or values do not go together.
        """
        name = Path(self.name).stem or "axis"
        builder = Builder(name, self.values, self._sections, self._folder)
        try:
            return builder.axis(capped=self._is_changed)
        except AxisError as error:
            line = _line_of(self._text, error.key)
            raise error.at(self.name, line, self._written.get(error.key, "")) from None

    def changed(self, numbers: Mapping[str, FloatOrArray]) -> AxisFile:
        """Return the file with other numbers; what else it states is held.

        For an end of a ±: ``file.changed({"axis.mass": 550.0}).axis()``. Where the file states
        zeta, that is held when the stiffness changes, and not c; where it states forces, those and
        not the coefficients. A kinetic friction that comes above the static one is taken as that.

        Parameters
        ----------
        numbers
            Numbers by name, of those that the file states, in the SI unit in which it states them.
            Arrays of one length make an axis whose numbers are arrays: many axes at once. For a
            rigid drive and friction of constant coefficients alone: closed forms take them.

        Raises
        ------
        KeyError
            If the file states no such number.
        """
        values = dict(self.values)
        for path, value in numbers.items():
            number = values[path]
            if not isinstance(number, Number):
                raise KeyError(path)
            # An array stands where a number is declared; the closed forms take both.
            stated: Any = value if isinstance(value, np.ndarray) else float(value)
            values[path] = number._replace(value=stated)
        return replace(self, values=values, _is_changed=True)


def read_axis(path: Path | str) -> Axis:
    """Read an axis file.

    Raises
    ------
    AxisError
        If it cannot be read, or what it states is not an axis.
    """
    return read_axis_file(path).axis()


def read_axis_file(path: Path | str) -> AxisFile:
    """Read what an axis file states; raises AxisError as `read_axis`."""
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        reason = (error.strerror or type(error).__name__).lower()
        raise AxisError(f"cannot be read: {reason}", name=str(path)) from None
    except UnicodeDecodeError:
        remedy = "save the file as UTF-8"
        raise AxisError("is no text in UTF-8", name=str(path), remedy=remedy) from None
    return axis_file_of(text, str(path), path.parent)


def axis_of(text: str, name: str = "axis.toml", folder: Path | None = None) -> Axis:
    """Read the text of an axis file.

    Parameters
    ----------
    text
        TOML.
    name
        Name of the file, for refusals; without its suffix that of an axis that has none.
    folder
        Where the file of a measured curve is looked for; the working folder by default.

    Raises
    ------
    AxisError
        If what it states is not an axis.
    """
    return axis_file_of(text, name, folder).axis()


def axis_file_of(text: str, name: str = "axis.toml", folder: Path | None = None) -> AxisFile:
    """Read what the text of an axis file states; arguments and errors as of `axis_of`."""
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise _not_toml(str(error), name, text) from None
    values: dict[str, Value] = {}
    written: dict[str, str] = {}
    sections: list[str] = []
    try:
        for table, section, entries in _tables(data):
            sections.append(table)
            for key, path, value in _keys(table, section, entries):
                written[path] = as_written(value)
                values |= values_of(key, path, value)
    except AxisError as error:
        raise error.at(name, _line_of(text, error.key)) from None
    return AxisFile(name, values, tuple(sections), written, text, folder or Path())


def _line_of(text: str, path: str) -> int:
    """Return the line of a name, else of what it stands in, else the last one."""
    # It brings pydantic, which a refusal alone needs.
    from stickslip_verification.model.data_file import Lines

    parts = re.findall(r"[^.\[\]]+", path)
    place = [int(part) - 1 if part.isdigit() else part for part in parts]
    return Lines(text).of(place) or max(1, len(text.splitlines()))


def _not_toml(message: str, name: str, text: str) -> AxisError:
    place = re.search(r" \(at (?:line (\d+), column \d+|end of document)\)$", message)
    line = int(place[1]) if place and place[1] else max(1, len(text.splitlines()))
    reason = message[: place.start()] if place else message
    remedy = 'a key stands once, and a text in quotes, such as mass = "500 kg"'
    if _DECIMAL_COMMA.search("".join(text.splitlines()[line - 1 : line])):
        remedy = "a number has a decimal point, such as mu_s = 0.2"
    return AxisError(
        f"is not TOML: {reason[:1].lower()}{reason[1:]}", name=name, line=line, remedy=remedy
    )


def _tables(data: Mapping[str, Any]) -> Iterator[tuple[str, Section, Mapping[str, Any]]]:
    """Yield the tables of a file by their names, those of an array each with its number."""
    tops = [name for name, section in _SECTIONS.items() if not section.is_array]
    for name, table in data.items():
        if name not in tops:
            raise _unknown_section(name, table, tops)
        if not isinstance(table, dict):
            raise _no_table(_SECTIONS[name], name, table)
        arrays = {f"{name}.{key}": key for key in table if f"{name}.{key}" in _SECTIONS}
        own = {key: value for key, value in table.items() if key not in arrays.values()}
        yield name, _SECTIONS[name], own
        for path, key in arrays.items():
            if not isinstance(table[key], list):
                raise _no_table(_SECTIONS[path], path, table[key])
            for place, each in enumerate(table[key], 1):
                if not isinstance(each, dict):
                    raise _no_table(_SECTIONS[path], f"{path}[{place}]", each)
                yield f"{path}[{place}]", _SECTIONS[path], each


def _keys(
    table: str, section: Section, entries: Mapping[str, Any]
) -> Iterator[tuple[Key, str, Any]]:
    known = BY_SECTION[section.name]
    for name, value in entries.items():
        path = f"{table}.{name}"
        if name not in known:
            raise _unknown_key(section, path, name)
        if path == "drive.kind" and isinstance(value, str) and value.lower() in NOT_YET:
            raise AxisError(
                "is not computed yet", key=path, value=as_written(value),
                within=known[name].expected,
                remedy='with kind = "rigid" the axis is judged without its loop',
            )  # fmt: skip
        yield known[name], path, value


def _no_table(section: Section, path: str, value: Any) -> AxisError:
    remedy = f"write {section.header} on a line of its own, and its keys below"
    return AxisError("is no section", key=path, value=as_written(value), remedy=remedy)


def _unknown_section(name: str, value: Any, known: list[str]) -> AxisError:
    owner = next((key for key in KEYS if key.name == name), None)
    headers = ", ".join(f"[{each}]" for each in known)
    if not isinstance(value, dict) and owner:
        remedy = f"write it below {_SECTIONS[owner.section].header}"
        value = as_written(value)
        return AxisError("stands outside a section", key=name, value=value, remedy=remedy)
    near = get_close_matches(name, known, 1, 0.5)
    remedy = f"[{near[0]}] is the nearest" if near else ""
    return AxisError("is no section of an axis file", key=name, within=headers, remedy=remedy)


def _unknown_key(section: Section, path: str, name: str) -> AxisError:
    known = BY_SECTION[section.name]
    symbols = {key.symbol: each for each, key in known.items()}
    if section.name == "drive":
        symbols |= _NAMES_OF_DRIVES
    lower = {each.lower(): each for each in (*known, *symbols)}
    near = get_close_matches(name.lower(), lower, 3, 0.6)
    names = [symbols.get(lower[each], lower[each]) for each in near]
    if name in symbols:
        names = [symbols[name]]
    elsewhere = [key for key in KEYS if key.name == name and key.section != section.name]
    if elsewhere:
        remedy = f"{name} stands in {_SECTIONS[elsewhere[0].section].header}"
    elif names:
        remedy = f"nearest: {', '.join(dict.fromkeys(names))}"
    else:
        remedy = f"{section.header} has {', '.join(known)}"
    return AxisError("is an unknown key", key=path, remedy=remedy)
