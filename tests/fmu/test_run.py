"""The default run, as an importer plays it."""

from pathlib import Path

import fmpy
import pytest

PERIOD = 0.31526808704944753
"""T of the default parameters by design.md, section 2, with 30 digits."""


def test_fmpy_plays_the_default_run_and_the_step_does_not_matter(fmu: Path) -> None:
    often, once = (
        fmpy.simulate_fmu(str(fmu), stop_time=10.0, output_interval=interval)[-1]
        for interval in (0.01, 10.0)
    )
    assert often["n_slips"] == 31
    # Two roundings of its parts.
    assert once["T"] == pytest.approx(PERIOD, rel=4e-15)
    for name in often.dtype.names:
        # Sums over 31 cycles, each rounded.
        assert often[name] == pytest.approx(once[name], rel=1e-13, abs=1e-13), name
