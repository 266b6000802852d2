"""How accurate honest solvers are in each case: data, made by `run.family`."""

import tomllib
from collections.abc import Collection, Mapping
from functools import cache
from pathlib import Path
from typing import Any

FILE = Path(__file__).with_name("family.toml")


@cache
def _data() -> Mapping[str, Any]:
    return tomllib.loads(FILE.read_text("utf-8"))


def long_cases() -> Collection[str]:
    """Return the cases whose nearby motions take seconds, and tell little that others do not."""
    return frozenset(_data()["long"])


@cache
def load_family() -> Mapping[str, Mapping[str, float]]:
    """Return delta by solver and case, see `judge.accuracy`."""
    data = _data()
    return {
        solver: {case: float(row[n]) for case, row in data["deltas"].items()}
        for n, solver in enumerate(data["solvers"])
    }
