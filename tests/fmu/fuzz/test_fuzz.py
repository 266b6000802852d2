"""Whatever is called, in whatever order: the FMU lives, and answers as it promises."""

from collections.abc import Callable
from pathlib import Path

import pytest

from stickslip_fmu.packer import build
from stickslip_verification.drive.planting import plant
from stickslip_verification.suite.faults import Mutant, Substitution
from tests.fmu.fuzz.sequences import sequence
from tests.fmu.fuzz.trial import Trial, table

ALL = {"coulomb": 10_000, "stribeck": 3_000}
"""How many lives; those of the second block take longer."""

# What each function must have given at least once in the set, or it is too tame.
MET = [
    *((name, status) for name in ("enter", "exit", "set_up", "step", "terminate", "get_state")
      for status in (0, 4)),
    *((f"{verb} {kind}", status) for verb in ("get", "set")
      for kind in ("Real", "Integer", "Boolean", "String") for status in (0, 4)),
    *((name, 0) for name in ("instantiate", "free", "reset", "free_state", "serialize",
                             "deserialize", "debug", "version", "get RealStatus",
                             "get BooleanStatus")),
    *((name, 3) for name in ("cancel", "directional", "SetRealInputDerivatives",
                             "GetRealOutputDerivatives", "get Status")),
    *((name, 2) for name in ("get IntegerStatus", "get StringStatus")),
    *((f"set_state in {where}", 0) for where in (
        "instantiated", "initialization", "stick", "forward slip", "backward slip",
        "damped stick", "damped forward slip", "damped backward slip", "terminated")),
    ("set_state in failed", 4),
]  # fmt: skip


@pytest.mark.parametrize("law", ALL)
def test_no_sequence_of_calls_crashes_hangs_or_misleads(
    law: str, tmp_path: Path, sized: Callable[[int], int]
) -> None:
    """Thousands of random lives give the status, the values and the words that are promised."""
    trial = Trial(build(tmp_path, law=law), tmp_path, law=law)
    seeds = range(1, 1 + sized(ALL[law]))
    findings = trial.run([sequence(seed, law) for seed in seeds])
    for number, finding in findings.items():
        again = f"python -m tests.fmu.fuzz.trial --law {law} --first {seeds[number]} --count 1"
        pytest.fail(f"seed {seeds[number]}: {trial.shrunk(finding)}\n{again}")
    missed = {each for each in MET if not trial.counts[each]}
    assert missed <= (set() if len(seeds) == ALL["coulomb"] else RARE), table(trial.counts)


# Of these what a tenth of the set may do without: there is no Boolean and no String to set.
RARE = {("set Boolean", 0), ("set String", 0)}

STEP = "        if not 0.0 < step < math.inf:\n"
TWIN = "        twin.meter = self.meter.copy()\n"

FAULTS = {
    "takes NaN": (
        ("table.py", "math.isfinite(value) and low <= value <= high:", "not value < low:"),
        "set: status 0, expected 4",
    ),
    "lets the load lift the mass": (
        ("settings.py", "if not self.load >= -weight:", "if False:"),
        "status 0, expected 4: the load lifts the mass",
    ),
    "crashes": (
        (
            "block.py",
            STEP,
            f"        if step == 2.0:\n            __import__('os').abort()\n{STEP}",
        ),
        "the process ends by SIGABRT",
    ),
    "hangs": (
        ("block.py", STEP, f"        while step == 2.0:\n            pass\n{STEP}"),
        "a call hangs",
    ),
    "exits": (
        (
            "block.py",
            STEP,
            f"        if step == 2.0:\n            __import__('os')._exit(0)\n{STEP}",
        ),
        "the process stops",
    ),
    "fails without its own words": (
        ("block.py", STEP, f"        1.0 / (step - 2.0)\n{STEP}"),
        "internal error: ZeroDivisionError",
    ),
    "forgets the sum of its heat": (
        ("block.py", TWIN, f"{TWIN}        twin.Q_friction = ZERO\n"),
        "get: gives",
    ),
}


# One for each way to tell: by a value, by a status, by the end of the process.
AT_ONCE = ("forgets the sum of its heat", "takes NaN", "crashes")


@pytest.mark.parametrize(
    "fault",
    [name if name in AT_ONCE else pytest.param(name, marks=pytest.mark.soak) for name in FAULTS],
)
def test_a_planted_fault_is_convicted(fmu_path: Path, tmp_path: Path, fault: str) -> None:
    """An FMU that fails in a way looked for here is found out, by calls that can be repeated."""
    change, reason = FAULTS[fault]
    bad = plant(fmu_path, Mutant("bad", "", (), (Substitution(*change),), (), Path()), tmp_path)
    trial = Trial(bad, tmp_path, seconds=0.5)
    findings = trial.run([sequence(seed) for seed in range(1, 401)])
    convicted = [each for each in findings.values() if reason in each.reason]
    assert convicted, findings
    shortest = trial.shrunk(min(convicted, key=lambda each: each.position), rounds=8)
    again = trial.run([shortest.calls])
    assert reason in again[0].reason
