"""Puts the page together: markup, style, script, presets and theory in one HTML file."""

import json
import re
import tomllib
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from typing import Any, Final

from stickslip.page.script import joined
from stickslip_fmu.release import VERSION
from stickslip_fmu.spec import TABLE

_ENTRY: Final = "main.js"
# End tags that HTML lets one leave out wherever the next element or the parent's end follows.
_OPTIONAL_ENDS: Final = re.compile(r"</(?:t[dhr]|d[dt]|li|tbody|thead|option)>(?=\s*<)")
# Where a text holds a number of the model: its name, and how it is shown.
_FIGURE: Final = re.compile(r"\{(\w+:\w+)\}")
_SOURCES: Final = files("stickslip.page")


def page(setting: Mapping[str, float] | None = None) -> str:
    """Return the page: one HTML text that asks for nothing else, from a file or from a server.

    Parameters
    ----------
    setting
        Values that it begins with [SI], by name; the rest are the FMU's start values. A value
        out of `page_range` is named on the page and not taken.
    """
    from jinja2 import Environment, FunctionLoader, StrictUndefined
    from rcssmin import cssmin
    from rjsmin import jsmin

    environment = Environment(
        loader=FunctionLoader(_text),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
    )
    environment.filters["figures"] = _figures
    presets = _table("applications/presets.toml")["preset"]
    sentences = _table("said/said.toml")["sentence"]
    data = {
        # What the markup already says, the script need not.
        "controls": [_without(each, {"label", "symbol", "folded"}) for each in _controls()],
        "presets": [_without(preset, {"name"}) for preset in presets],
        "sentences": [
            _without(each, {"said", "sign", "verdict", "truth", "topic"}) for each in sentences
        ],
        "setting": dict(setting or {}),
    }
    text = environment.get_template("page.html.j2").render(
        version=VERSION,
        controls=_controls(),
        presets=presets,
        sentences=sentences,
        data=_embedded(data),
        style=cssmin("".join(map(_text, ["style.css", *_paths(".css")]))),
        chart_style=cssmin(_text("chart.css")),
        script=jsmin(joined(_modules(), _ENTRY)),
    )
    return _OPTIONAL_ENDS.sub("", "\n".join(filter(None, map(str.strip, text.splitlines()))))


def page_range(name: str) -> tuple[float, float, str]:
    """Return the least and the greatest value of a parameter that the page takes, and its SI unit.

    Raises
    ------
    KeyError
        If the page has no such control.
    """
    control = next((each for each in _controls() if each["name"] == name), None)
    if control is None:
        raise KeyError(name)
    shown = 10.0 ** control["decimals"]
    unit = TABLE.by_name[name].unit
    return control["least"] / shown, control["most"] / shown, "" if unit == "1" else unit


@cache
def _controls() -> list[dict[str, Any]]:
    """Return the controls, each with the start value (SI) of its FMU variable."""
    return [
        {**control, "start": TABLE.by_name[control["name"]].start}
        for control in _table("controls/controls.toml")["control"]
    ]


def _without(row: Mapping[str, Any], keys: set[str]) -> dict[str, Any]:
    return {key: value for key, value in row.items() if key not in keys}


def _modules() -> dict[str, str]:
    return {path: _text(path) for path in ["main.js", *_paths(".js")]}


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


def _figures(text: str) -> str:
    """Give each ``{name:kind}`` of a text an element that the script writes the number into."""
    return _FIGURE.sub(r'<data data-of="\1"></data>', text)


def _embedded(data: object) -> str:
    """Write data as JSON that can stand inside a script element."""
    return json.dumps(data, ensure_ascii=False, separators=(",", ":")).replace("</", "<\\/")
