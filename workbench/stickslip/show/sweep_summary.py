"""A sweep at a glance: its runs, why some failed, and the range of each result."""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING, Final

import numpy as np
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from stickslip.show.fitted import grid

if TYPE_CHECKING:
    import xarray

MOST_REASONS: Final = 8
"""Reasons of failures that are shown, the most frequent first."""

_NUMBER: Final = re.compile(r"[+-]?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?")


def sweep_summary(found: xarray.Dataset) -> RenderableType:
    """Make the summary of a sweep."""
    reasons = [str(each) for each in found["failure"].values.ravel().tolist() if each]
    runs = int(found["failure"].size)
    failed = f", {len(reasons)} failed" if reasons else ", none failed"
    said = Text(f"{runs} run{'' if runs == 1 else 's'}{failed}")
    parts: list[RenderableType] = [_results(found), said]
    # Messages of one reason differ in their numbers.
    alike = Counter(_NUMBER.sub("...", each) for each in reasons)
    first = {_NUMBER.sub("...", each): each for each in reversed(reasons)}
    for kind, count in alike.most_common(MOST_REASONS):
        such = "such as: " if count > 1 and kind != first[kind] else ""
        parts.append(Text(f"  {count} x {such}{first[kind]}"))
    if len(alike) > MOST_REASONS:
        parts.append(Text(f"  and {len(alike) - MOST_REASONS} more reasons"))
    return Group(*parts)


def _results(found: xarray.Dataset) -> Table:
    rows = []
    ok = found["failure"].values.ravel() == ""
    for name, column in found.data_vars.items():
        if name == "failure":
            continue
        values = np.asarray(column.values).ravel()[ok]
        known = values[~np.isnan(values)]
        ends = [f"{known.min():.6g}", f"{known.max():.6g}"] if known.size else ["", ""]
        lacking = str(values.size - known.size) if values.size > known.size else ""
        about = column.attrs
        rows.append((name, about.get("units", ""), *ends, lacking, about.get("long_name", "")))
    return grid(("result", "unit", "least", "greatest", "NaN", "meaning"), rows, texts=(0, 1, 5))
