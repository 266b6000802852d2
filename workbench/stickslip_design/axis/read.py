"""Axis files: TOML, as a machine-tool designer writes it.

    [axis]
    mass = "500 kg"
    stiffness = "40 N/um ± 10 %"

`keys.KEYS` lists what may stand there, `template` writes a file with all of it.
"""

from __future__ import annotations

import re
import textwrap
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from difflib import get_close_matches
from hashlib import sha256
from pathlib import Path
from typing import Any, Final

import numpy as np

from stickslip_ref import FloatOrArray

from .build import Builder, Number, Value, as_written, values_of
from .keys import BY_SECTION, KEYS, SECTIONS, Key, Section, key_of
from .model import Axis, AxisError

_NAMES_OF_DRIVES: Final = {"j": "inertia", "k_p": "velocity_gain", "lead": "pitch"}
"""Names that catalogues and parameter lists of drives have for keys."""
_DECIMAL_COMMA: Final = re.compile(r"=\s*-?\d+,\d")


@dataclass(frozen=True)
class AxisFile:
    """What an axis file states."""

    name: str
    """Name of the file, for refusals."""
    values: Mapping[str, Value]
    """Numbers and texts: ``axis.mass``, ``axis.stiffness[1]``, ``drive.filter[1].frequency``."""
    sections: tuple[str, ...]
    """Places of its sections: ``drive``, ``drive.filter[1]``."""
    _written: Mapping[str, str]
    text: str
    """The text in TOML; empty where tables were read."""
    tables: Mapping[str, Any]
    """What it says, as TOML reads it."""
    folder: Path
    """Where files that it names are looked for."""
    _is_changed: bool = False

    @property
    def identity(self) -> dict[str, Any]:
        """What the file states, as JSON knows it; of a measured curve the SHA-256 of its file.

        AxisError if that cannot be read.
        """
        stated: dict[str, Any] = {
            path: list(value) if isinstance(value, Number) else value
            for path, value in self.values.items()
        }
        curve = self.values.get("friction.curve")
        if not isinstance(curve, str):
            return stated
        try:
            content = (self.folder / curve).read_bytes()
        except OSError as error:
            reason = _unread(error)
            raise AxisError(reason, "friction.curve", value=curve, name=self.name) from None
        return stated | {"friction.curve": sha256(content).hexdigest()}

    def axis(self) -> Axis:
        """Return the axis; AxisError if something is missing, or values do not go together."""
        name = Path(self.name).stem or "axis"
        builder = Builder(name, self.values, self.sections, self.folder)
        try:
            return builder.axis(capped=self._is_changed)
        except AxisError as error:
            error.name, error.line = self.name, _line_of(self.text, error.key)
            error.value = self._written.get(error.key, "")
            raise

    def refuse_turning(self, study: str) -> None:
        """Raise AxisError if it states a rotary table, whose units a study does not show."""
        if self.values.get("drive.kind") == "rotary":
            reason = f"is not for {study}, which is in mm and N; stickslip design judges the table"
            raise AxisError(reason, "drive.kind", '"rotary"', name=self.name)

    def changed(self, numbers: Mapping[str, FloatOrArray]) -> AxisFile:
        """Return the file with other numbers; what else it states is held.

        For an end of a ±: ``file.changed({"axis.mass": 550.0}).axis()``. Where the file states
        zeta, that is held when the stiffness changes, and not c; where it states forces, those and
        not the coefficients. A kinetic friction that comes above the static one is taken as that.

        `numbers` are in the SI unit in which the file states them; KeyError if it states no such
        number. Arrays of one length make an axis whose numbers are arrays: many axes at once. For a
        rigid drive and friction of constant coefficients alone: closed forms take them.
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


AxisSource = AxisFile | Path | str | Mapping[str, Any]
"""An axis file: read, by its path, or as the dictionary of its tables."""


def read_axis_file(axis: AxisSource) -> AxisFile:
    """Read what a file, or a dictionary of its tables, states; AxisError if it cannot be used."""
    if isinstance(axis, AxisFile):
        return axis
    if isinstance(axis, Mapping):
        return axis_file_of(axis, "axis")
    path = Path(axis)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise AxisError(_unread(error), name=str(path)) from None
    except UnicodeDecodeError:
        remedy = "save the file as UTF-8"
        raise AxisError("is no text in UTF-8", name=str(path), remedy=remedy) from None
    return axis_file_of(text, str(path), path.parent)


def axis_file_of(
    text: str | Mapping[str, Any], name: str = "axis.toml", folder: Path | None = None
) -> AxisFile:
    """Read what an axis file states, its text in TOML or its tables; AxisError if not allowed.

    `name` is the file, for refusals; without its suffix that of an axis that has none. A measured
    curve is looked for in `folder`, the working folder by default.
    """
    if isinstance(text, str):
        try:
            data: Mapping[str, Any] = tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            raise _not_toml(error, name, text) from None
    else:
        data, text = _as_toml(text), ""
    values: dict[str, Value] = {}
    written: dict[str, str] = {}
    sections: list[str] = []
    drive, kind = data.get("drive"), "drive.kind"
    try:
        if isinstance(drive, Mapping) and "kind" in drive:
            values |= values_of(key_of(kind), kind, drive["kind"])
        for path, value in _stated(data, ""):
            if value is None:
                sections.append(path)
            else:
                written[path] = as_written(value)
                values |= values_of(key_of(path, str(values.get(kind))), path, value)
    except AxisError as error:
        error.name, error.line = name, _line_of(text, error.key)
        raise
    return AxisFile(name, values, tuple(sections), written, text, data, folder or Path())


def _as_toml(value: Any) -> Any:
    """Return tables from Python as TOML has them: of dictionaries, lists and plain numbers."""
    if isinstance(value, Mapping):
        return {str(name): _as_toml(inner) for name, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_as_toml(inner) for inner in value]
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value


def _unread(error: OSError) -> str:
    return f"cannot be read: {(error.strerror or type(error).__name__).lower()}"


def _line_of(text: str, path: str) -> int:
    """Return the line of a name, else of what it stands in, else the last one; 0 without text."""
    # It brings pydantic, which a refusal alone needs.
    from stickslip_verification.model.data_file import line_of

    parts = re.findall(r"[^.\[\]]+", path)
    place = [int(part) - 1 if part.isdigit() else part for part in parts]
    return line_of(text, place) or len(text.splitlines())


def _not_toml(error: tomllib.TOMLDecodeError, name: str, text: str) -> AxisError:
    from stickslip_verification.model.data_file import fault_of

    line, reason = fault_of(error, text)
    remedy = 'a key stands once, and a text in quotes, such as mass = "500 kg"'
    if _DECIMAL_COMMA.search("".join(text.splitlines()[line - 1 : line])):
        remedy = "a number has a decimal point, such as mu_s = 0.2"
    reason = f"is not TOML: {reason[:1].lower()}{reason[1:]}"
    return AxisError(reason, name=name, line=line, remedy=remedy)


def _stated(table: Any, path: str, section: Section | None = None) -> Iterator[tuple[str, Any]]:
    """Yield the sections of a table by place, without value, and what its keys say."""
    if section:
        if not isinstance(table, dict) or section.is_array != path.endswith("]"):
            remedy = f"write {section.header} on a line of its own, and its keys below"
            raise AxisError("is no section", key=path, value=as_written(table), remedy=remedy)
        yield path, None
    for name, value in table.items():
        place = f"{path}.{name}" if section else name
        inner = SECTIONS.get(place)
        if inner and inner.is_array and isinstance(value, list):
            for number, each in enumerate(value, 1):
                yield from _stated(each, f"{place}[{number}]", inner)
        elif inner:
            yield from _stated(value, place, inner)
        elif section and name in BY_SECTION[section.name]:
            yield place, value
        else:
            raise _unknown(place, name, value, section)


def _unknown(path: str, name: str, value: Any, section: Section | None) -> AxisError:
    if section:
        known = BY_SECTION[section.name].values()
        names = {(key.symbol or key.name).lower(): key.name for key in known}
        names |= {key.name.lower(): key.name for key in known}
        names |= _NAMES_OF_DRIVES if section.name == "drive" else {}
    else:
        names = {each.name: each.header for each in SECTIONS.values() if not each.is_array}
    most = 1 if name.lower() in names else 3
    near = [names[each] for each in get_close_matches(name.lower(), names, most, 0.6)]
    others = [SECTIONS[key.section].header for key in KEYS.values() if key.name == name]
    if others:
        remedy = f"{name} stands in {others[0]}"
    elif near:
        remedy = f"nearest: {', '.join(dict.fromkeys(near))}"
    else:
        remedy = f"there are {', '.join(dict.fromkeys(names.values()))}"
    outside = "stands outside a section" if others else "is no section of an axis file"
    reason = "is an unknown key" if section else outside
    shown = "" if isinstance(value, dict) else as_written(value)
    return AxisError(reason, key=path, value=shown, remedy=remedy)


_WIDTH: Final = 100
_NO_BREAK: Final = "\0"
_HEAD: Final = (
    'An axis, for `stickslip design`. Numbers carry their units, as text: "50 N/um", "5 mm/min", '
    '"60 kg cm2", "1.5 m/min/mm", "0.25 ms". '
)
_HOW: Final = (
    'Where [±] stands a number may have a tolerance: "50 N/um ± 5 N/um" or "50 N/um ± 10 %"; +- '
    "does as well. A key behind # may be left out: take the # away to state it."
)


TEMPLATES: Final = ("screw", "belt", "rotary")
"""The kinds of drive that have a template."""


def template(kind: str = "screw") -> str:
    """Return an axis file with all keys of a kind of drive, of `TEMPLATES`.

    Those that may be left out are commented out.
    """
    lines = _comment(_HEAD + _HOW)
    for section in SECTIONS.values():
        mark = "# " if section.is_array else ""
        without = f" Without it: {section.otherwise}." if section.otherwise else ""
        lines += ["", *_comment(section.meaning + without), f"{mark}{section.header}"]
        for key in _fitting(section.name, kind):
            # What stands in place of another key would be refused beside it.
            alone = not (key.unless or key.goes_with)
            is_stated = key.required and (key.in_example or alone)
            # Without its kind the file would be of a screw.
            is_stated |= key.path == "drive.kind" and kind != "screw"
            line = f"{mark if is_stated else '# '}{key.name} = {key.example}"
            lines += [*_comment(told(key)), line]
    return "\n".join((*lines, ""))


def example() -> str:
    """Return the axis file of the axis of docs/feed-axis.md."""
    lines = _comment(_HEAD)
    for section in SECTIONS.values():
        keys = [key for key in _fitting(section.name, "screw") if key.in_example]
        if keys:
            lines += ["", section.header, *(f"{key.name} = {key.example}" for key in keys)]
    return "\n".join((*lines, ""))


def _fitting(section: str, kind: str) -> Iterator[Key]:
    """Yield the keys of a section that may be stated with a kind of drive, without that need."""
    for key in (key.of(kind) for key in BY_SECTION[section].values()):
        if key.fits(kind):
            yield replace(key, goes_with=()) if key.goes_with[:1] == ("drive.kind",) else key


def told(key: Key) -> str:
    """Return in a line what a key means, its range, and what is taken where it is not stated."""
    marks = f" [{', '.join(key.marks())}]" if key.marks() else ""
    needs = f" With {key.needs} only." if key.goes_with else ""
    taken = ", ".join(filter(None, (key.taken, key.reason)))
    return f"{key.meaning}{marks}{needs}" + (f" Without it: {taken}." if taken else "")


def _comment(text: str) -> list[str]:
    # What stands in quotes stays on a line.
    kept = re.sub(r'"[^"]*"', lambda quoted: quoted[0].replace(" ", _NO_BREAK), text)
    lines = textwrap.wrap(kept, _WIDTH - 2, break_long_words=False, break_on_hyphens=False)
    return [f"# {line.replace(_NO_BREAK, ' ')}" for line in lines]
