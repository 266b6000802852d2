"""How accurate honest solvers are in each case: data, made by `run.family`."""

import tomllib
from collections.abc import Collection, Iterable, Mapping
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


def load_family(solvers: Iterable[str]) -> Mapping[str, Mapping[str, float]]:
    """Return delta by solver, of the names in order, and case; see `judge.accuracy`."""
    deltas: Mapping[str, list[float]] = _data()["deltas"]
    columns = zip(solvers, zip(*deltas.values(), strict=True), strict=True)
    return {solver: dict(zip(deltas, column, strict=True)) for solver, column in columns}
