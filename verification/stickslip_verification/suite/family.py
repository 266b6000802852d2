"""How accurate honest solvers are in each case: data, made by `run.lint.family_of`."""

import tomllib
from collections.abc import Mapping
from functools import cache
from pathlib import Path

FILE = Path(__file__).with_name("family.toml")


@cache
def load_family() -> Mapping[str, Mapping[str, float]]:
    """Return delta by solver and case, see `judge.accuracy`."""
    data = tomllib.loads(FILE.read_text("utf-8"))
    return {
        solver: {case: float(row[n]) for case, row in data["deltas"].items()}
        for n, solver in enumerate(data["solvers"])
    }
