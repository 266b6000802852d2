"""Runs of the coupled FMUs in processes of their own."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.python import python

ROOT = Path(__file__).parents[2]

Columns = list[NDArray[np.float64]]


def run_all(
    fmus: Path, runs: Sequence[tuple[Mapping[str, Any], float, float, str]], *columns: str
) -> list[Columns]:
    """Return the columns of runs, each given by changes to the axis, stop time, step and order."""
    words = json.dumps([[*each, columns] for each in runs])
    found = json.loads(output_of("loose", str(fmus), words))
    return [[np.array(column) for column in run] for run in found]


def output_of(program: str, *arguments: str, timeout: float = 120.0) -> str:
    """Return what a program of this folder prints."""
    return python("-m", f"tests.examples.{program}", *arguments, timeout=timeout, cwd=ROOT).stdout
