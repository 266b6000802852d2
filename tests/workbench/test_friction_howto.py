"""docs/friction.md: its commands run as they stand, and its numbers are those of the block."""

import re
import shlex
from pathlib import Path

import pytest

from stickslip_design.curve_file import read_curve
from stickslip_ref import Parameters, coulomb_limit, critical_velocity, simulate
from tests.workbench.running import Command

TEXT = (Path(__file__).parents[2] / "docs" / "friction.md").read_text(encoding="utf-8")
COMMANDS = re.findall(r"^stickslip (.+)$", TEXT, re.MULTILINE)
(CURVE,) = re.findall(r"```\n(speed .+?)```", TEXT, re.DOTALL)

AXIS = {"m": 400.0, "k": 4e7, "c": 800.0, "mu_s": 0.25}


@pytest.fixture
def guideway(tmp_path: Path) -> Path:
    """Return the file of the how-to, in the working folder of the command."""
    file = tmp_path / "guideway.csv"
    file.write_text(CURVE, encoding="utf-8")
    return file


def test_there_are_commands() -> None:
    """Two questions, a run, a build, and growing static friction."""
    assert [each.split()[0] for each in COMMANDS] == [
        "critical", "critical", "simulate", "build", "critical"
    ]  # fmt: skip


@pytest.mark.parametrize("line", COMMANDS)
def test_a_command_runs_as_it_stands(line: str, command: Command, guideway: Path) -> None:
    """It ends without an error and prints something."""
    answer = command.in_fresh_process(*shlex.split(line))
    assert answer.code == 0, answer.err
    assert answer.out.strip()
    assert not answer.err


def test_the_numbers_are_those_of_the_block(guideway: Path) -> None:
    """Speeds and the jump that the text names, as the reference computes them."""
    own = read_curve(guideway, None).parameters
    found = critical_velocity(Parameters(**AXIS, mu_k=0.09), "stribeck", own)
    (cycle,), (unstable,) = found.cycle, found.unstable
    assert f"exists up to {cycle.high * 1e3:.3g} mm/s" in TEXT
    assert f"from {unstable.low * 1e3:g} to {unstable.high * 1e3:g} mm/s" in TEXT
    constants = Parameters(**AXIS, mu_k=0.09)
    assert f"would have said {float(coulomb_limit(constants)) * 1e3:.3g} mm/s" in TEXT
    last = simulate(Parameters(**AXIS, mu_k=0.09, v=1e-3), 1.0, law="stribeck", own=own).cycles[-1]
    assert f"jumps {last.delta_x * 1e6:.3g} µm, {1.0 / last.T:.3g} times a second" in TEXT
    grows = Parameters(**AXIS, mu_k=0.21)
    (only,) = critical_velocity(grows, own={"tau_s": 0.1}).cycle
    assert f"ends at {only.high * 1e6:.3g} µm/s by a {only.high_end}" in TEXT
    assert f"it would be {float(coulomb_limit(grows)) * 1e3:.3g} mm/s" in TEXT
