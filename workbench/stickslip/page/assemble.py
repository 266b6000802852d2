"""Puts the page together: markup, style, script, texts and theory in one HTML file."""

import json
import posixpath
import re
import tomllib
from base64 import b64encode
from collections.abc import Mapping, Sequence
from functools import cache
from graphlib import TopologicalSorter
from importlib.resources import files
from typing import Any, Final
from urllib.parse import urljoin

from jinja2 import Environment, FunctionLoader, StrictUndefined

from stickslip_fmu.laws.lugre.law import LUGRE
from stickslip_fmu.release import VERSION
from stickslip_fmu.spec import TABLE
from stickslip_units import KINDS, UNIT_PREFIXES, UNITS_ALONE, UNITS_WITH_PREFIX

_IMPORT: Final = re.compile(r'^import \{[^}]*\} from "(?P<path>\.[^"]*)";\n', re.MULTILINE)
_EXPORT: Final = re.compile(r"^export (?=(?:async )?(?:function|const|class)\b)", re.MULTILINE)
_NAME: Final = re.compile(
    r"^(?:(?:async )?function\*? |const |let |class )(?P<name>[A-Za-z_$][\w$]*)", re.MULTILINE
)
_COMMENT: Final = re.compile(r"^ *(?:/\*(?:(?!\*/)[\s\S])*\*/|//.*)\n", re.MULTILINE)
"""On lines of its own; the sources keep theirs."""
_PATTERN: Final = re.compile(r"^(?:const|let) [\[{]", re.MULTILINE)


def joined(modules: Mapping[str, str]) -> str:
    """Join modules, each after those that it needs, into one script.

    It has no imports, no exports and no comments on lines of their own. `modules` are sources by
    path, such as ``"model/cycle.js"``. KeyError if one is missing; ValueError if there is a circle
    of imports, two modules use one name, or one declares several by a pattern.
    """
    owners: dict[str, str] = {}
    parts = []
    needed = {path: _imports(path, source) for path, source in modules.items()}
    for path in TopologicalSorter(needed).static_order():
        text = _COMMENT.sub("", _EXPORT.sub("", _IMPORT.sub("", modules[path])))
        if _PATTERN.search(text):
            raise ValueError(f"{path}: a pattern declares names; declare each by itself")
        for found in _NAME.finditer(text):
            other = owners.setdefault(found["name"], path)
            if other != path:
                raise ValueError(f"{path}: {found['name']} is a name of {other} too")
        parts.append(text)
    return "\n".join(parts)


def _imports(path: str, source: str) -> list[str]:
    folder = posixpath.dirname(path)
    paths = (found["path"] for found in _IMPORT.finditer(source))
    return [posixpath.normpath(posixpath.join(folder, each)) for each in paths]


_SETTING: Final = ("m", "g", "load", "k", "c", "mu_s", "mu_k", "v")
_SOURCES: Final = files("stickslip.page")
CARD: Final = "card.png"


def page(setting: Mapping[str, float] | None = None, address: str = "") -> str:
    """Return the page: one HTML text that asks for nothing else, from a file or from a server.

    Parameters
    ----------
    setting
        Values that it begins with [SI], by name; the rest are the FMU's start values. A value
        out of `page_range` is named on the page and not taken.
    address
        Where the page will be on a network, for previews of links to it; their picture, `card`, is
        then `CARD` beside it.
    """
    from stickslip.page import texts

    environment = Environment(
        loader=FunctionLoader(_text),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
    )
    start: dict[str, Any] = {name: TABLE.by_name[name].start for name in _SETTING}
    table = _table("applications/applications.toml")["application"]
    applications = texts.applications(table, start)
    story = texts.story(_table("story/story.toml")["step"], start, table)
    sentences = texts.sentences(_table("said/said.toml")["sentence"], start)
    curves = _table("friction/friction.toml")["curve"]
    data = {
        # What the markup already says, the script need not.
        "controls": [
            {key: value for key, value in row.items() if key != "symbol"}
            for row in _rows("control", "parameter")
        ],
        "bristles": _rows("bristle"),
        "units": _units(),
        "scales": texts.SCALES,
        "applications": [
            {**kept, "cures": [cure.get("set") for cure in each["cures"]]}
            for each, kept in zip(applications, _only(applications, "id", *start), strict=True)
        ],
        "steps": _only(story, "set", "over", "from", "curve"),
        "curves": _only(curves, "set", "points"),
        "sentences": _only(sentences, "id", "set", "curve", "before", "from"),
        "setting": dict(setting or {}),
    }
    return environment.get_template("page.html.j2").render(
        version=VERSION,
        controls=_rows("control"),
        bristles=_rows("bristle"),
        applications=applications,
        story=story,
        questions=texts.questions(_table("questions/questions.toml")["question"], start, table),
        sentences=sentences,
        address=address,
        picture=urljoin(address, CARD)
        if address
        else f"data:image/png;base64,{b64encode(card()).decode()}",
        curves=curves,
        # As JSON that can stand inside a script element.
        data=json.dumps(data, ensure_ascii=False, separators=(",", ":")).replace("</", "<\\/"),
        # What the window and paper change, they change in every part.
        style="".join(map(_text, ["style.css", *_paths(".css"), "windows.css", "print.css"])),
        chart_style=_text("chart.css"),
        script=joined({path: _text(path) for path in ["main.js", *_paths(".js")]}),
    )


def card() -> bytes:
    """Return the picture of a link to the page: the stage at the start values, 600 x 315 px."""
    return (_SOURCES / CARD).read_bytes()


def page_range(name: str) -> tuple[float, float, str]:
    """Return the least and the greatest value of a parameter that the page takes, and its SI unit.

    Raises
    ------
    KeyError
        If the page has no such parameter.
    """
    row = {each["name"]: each for each in _rows("control", "parameter")}[name]
    return row["least"], row["most"], row["unit"]


@cache
def _rows(*kinds: str) -> list[dict[str, Any]]:
    """Return rows of controls.toml: each ``"control"``, ``"parameter"`` without one, ``"bristle"``.

    Each has its SI unit, what is expected there in words, and the start value (SI) of its variable.
    """
    rows, table = [], _table("controls/controls.toml")
    variables = {row.name: row for row in LUGRE.interface.rows} | TABLE.by_name
    for row in (row for kind in kinds for row in table[kind]):
        variable = variables.get(row["name"])
        # The normal force is no variable of the FMU.
        unit = KINDS[variable.unit if variable else "N"]
        start = {"start": variable.start} if variable else {}
        symbol = "" if unit.unit == "1" else unit.unit
        rows.append({**row, **start, "unit": symbol, "expected": unit.expected()})
    return rows


def _units() -> dict[str, Any]:
    """Return the command's tables of units: symbol to numerator, denominator and exponents."""
    tables = {"prefixable": UNITS_WITH_PREFIX, "alone": UNITS_ALONE}
    return {
        name: {unit: [*size.as_integer_ratio(), *powers] for unit, (size, powers) in table.items()}
        for name, table in tables.items()
    } | {
        "prefixes": {symbol: size.as_integer_ratio() for symbol, size in UNIT_PREFIXES.items()},
        "kinds": {unit: kind.name for unit, kind in KINDS.items()},
    }


def _only(rows: Sequence[Mapping[str, Any]], *keys: str) -> list[dict[str, Any]]:
    return [{key: row[key] for key in row if key in keys} for row in rows]


def _paths(suffix: str) -> list[str]:
    """Return the paths of the files of a kind in the folders of the page."""
    return sorted(
        f"{folder.name}/{file.name}"
        for folder in _SOURCES.iterdir()
        if folder.is_dir()
        for file in folder.iterdir()
        if file.name.endswith(suffix)
    )


def _table(name: str) -> dict[str, Any]:
    return tomllib.loads(_text(name))


def _text(name: str) -> str:
    return (_SOURCES / name).read_text(encoding="utf-8")
