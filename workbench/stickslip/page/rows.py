"""Rows of the story, the applications and the questions: settings complete, texts filled."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

from stickslip.page.texts import Numbers, filled

Row: TypeAlias = Mapping[str, Any]
Setting: TypeAlias = Mapping[str, float]


def story(rows: Sequence[Row], start: Setting, applications: Sequence[Row]) -> list[Row]:
    """Return the steps of the story, as story.toml explains them, each with its setting as ``set``.

    A step begins with the `start` values of the FMU [SI], or with those of one of the applications.
    """
    settings = [_complete(row, start, applications) for row in rows]
    steps: list[Row] = []
    for row, now in zip(rows, settings, strict=True):
        known = {"now": now, "tried": {**now, **row.get("tried", {})}}
        if "over" in row:
            known["over"] = settings[row["over"] - 1]
        steps.append({**_filled(row, known, row.get("curve")), "set": now})
    return steps


def applications(rows: Sequence[Row], start: Setting) -> list[Row]:
    """Return the applications, as applications.toml explains them; `start` names the parameters."""
    found: list[Row] = []
    for row in rows:
        own = _setting(row, start)
        cures = [
            _filled(cure, {"now": {**own, **cure.get("set", {})}, "over": own})
            for cure in row.get("cures", ())
        ]
        found.append({**_filled(row, {"now": own}), "cures": cures})
    return found


def questions(rows: Sequence[Row], start: Setting, applications: Sequence[Row]) -> list[Row]:
    """Return the questions, as questions.toml explains them; the rest is as for `story`."""
    return [_filled(row, {"now": _complete(row, start, applications)}) for row in rows]


def _complete(row: Row, start: Setting, applications: Sequence[Row]) -> Setting:
    """Return the setting of a row: that of an application or of the start, with its own values."""
    presets = {each["id"]: _setting(each, start) for each in applications}
    own = presets[row["preset"]] if "preset" in row else start
    return {**own, **row.get("set", {})}


def _setting(row: Row, names: Setting) -> Setting:
    return {name: row[name] for name in names}


def _filled(row: Row, settings: Mapping[str, Setting], curve: Any = None) -> dict[str, Any]:
    """Fill the texts of a row, those in its lists and tables of texts too."""
    numbers = {name: Numbers(setting, curve) for name, setting in settings.items()}

    def fill(value: Any) -> Any:
        if isinstance(value, str):
            return filled(value, numbers)
        if isinstance(value, list):
            return [fill(each) for each in value]
        if isinstance(value, dict):
            return {name: fill(each) for name, each in value.items()}
        return value

    return {name: fill(value) for name, value in row.items() if name != "cures"}
