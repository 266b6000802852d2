"""Rows of the story, the applications and the questions: settings complete, texts filled."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

from stickslip.page.texts import Numbers, filled

Row: TypeAlias = Mapping[str, Any]
Setting: TypeAlias = Mapping[str, float]


def story(rows: Sequence[Row], start: Setting, applications: Sequence[Row]) -> list[Row]:
    """Return the steps of the story, as story.toml explains them.

    Parameters
    ----------
    rows
        The table of story.toml.
    start
        The start values of the FMU [SI].
    applications
        The table of applications.toml, whose values a step may begin with.

    Returns
    -------
    list
        The rows with their whole setting as ``set`` and their texts filled.
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
    """Return the applications, as applications.toml explains them.

    Parameters
    ----------
    rows
        The table of applications.toml.
    start
        The start values of the FMU, which name the parameters.

    Returns
    -------
    list
        The rows with their texts filled.
    """
    return [_application(row, _setting(row, start)) for row in rows]


def questions(rows: Sequence[Row], start: Setting, applications: Sequence[Row]) -> list[Row]:
    """Return the questions with their texts filled, as questions.toml explains them.

    Parameters
    ----------
    rows, start, applications
        As for `story`, of questions.toml.
    """
    return [_filled(row, {"now": _complete(row, start, applications)}) for row in rows]


def _application(row: Row, own: Setting) -> Row:
    cures = [
        _filled(cure, {"now": {**own, **cure.get("set", {})}, "over": own})
        for cure in row.get("cures", ())
    ]
    return {**_filled(row, {"now": own}), "cures": cures}


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
