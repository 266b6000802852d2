"""The kill matrix: planted faults are detected by the foretold checks, and nothing else is."""

from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import Any

import pytest

from stickslip_verification import (
    FmuError,
    KillMatrix,
    Mutant,
    load_invariants,
    load_mutants,
    verify,
)
from stickslip_verification.drive.environments import LONG_PROBES
from stickslip_verification.drive.instance import FmuFile
from stickslip_verification.judge.checks import EXACT_CONTRACT, PHYSICS_CONTRACT, Contract
from stickslip_verification.run.experiment import Experiment, compute
from stickslip_verification.run.verify import detect
from stickslip_verification.suite.faults import Override
from tests.makers import SLIDER

from .records import named

CASES = [named("one-step"), named("reversals")]
ALL = load_invariants()
PROBES = [probe for probe in ALL.probes if probe.probe not in LONG_PROBES]
INVARIANTS = replace(ALL, orders=(), probes=PROBES)


@cache
def experiment(contract: Contract) -> Experiment:
    cases = [named("default"), named("heavy")] if contract.numerical else CASES
    of = [case.id for case in cases] if contract.numerical else None
    return Experiment(compute(cases, INVARIANTS, jobs=1, numerical=of), INVARIANTS, contract)


def tried(
    fmu: Path, *mutants: Mutant, contract: Contract = EXACT_CONTRACT, **how: Any
) -> KillMatrix:
    return detect(fmu, mutants, experiment(contract), jobs=1, **{"whole": False, **how})


@cache
def suite() -> dict[str, Mutant]:
    return {mutant.id: mutant for mutant in load_mutants()}


def fault(name: str, **changes: object) -> Mutant:
    return replace(suite()[name], **changes)  # type: ignore[arg-type]


def overriding(target: str, code: str) -> Mutant:
    return fault("constant-g", id=target, overrides=(Override(target, code),))


GRAVITY = "break-away-force-is-mu_s-N"
IN_THE_FMU = overriding("block.Block.set", "def set(self, name, v):\n    original(self, name, v)")
IN_ITS_CALLS = overriding("master.step", "def step(self, time, h):\n    original(self, time, h)")


@pytest.mark.gate
def test_tried_on_everything_a_fault_fails_what_is_about_it_and_no_fault_fails_nothing(
    fmu_path: Path,
) -> None:
    mutants = (fault("constant-g"), fault("creep-in-stick"), IN_THE_FMU, IN_ITS_CALLS)
    kills = tried(fmu_path, *mutants, whole=True)
    gravity, creep, *harmless = kills.rows
    assert (gravity.caught, creep.caught, kills.passed) == (True, True, False)
    assert GRAVITY in gravity.failing.keys() - creep.failing.keys()
    assert "stick-holds-x" in creep.failing.keys() - gravity.failing.keys()
    assert [(row.failing, row.caught, row.broken) for row in harmless] == [({}, False, None)] * 2
    # With so few faults most checks detect none, and each has to say why it stays.
    assert kills.kills_nothing["mode-and-sticking-agree"] == ""
    assert "stick-holds-x" not in kills.kills_nothing


GONE = overriding("friction.breakaway", "def breakaway():\n    return 1.0")
NO_CHECK = fault("constant-g", detected_by=("slip-frction",))
LEAVES = overriding("master.get", "def get(self, names):\n    raise SystemExit(0)")


# A fault, the checks that fail, and why it cannot be judged.
@pytest.mark.parametrize(
    ("mutant", "failing", "broken"),
    [
        (fault("constant-g"), {GRAVITY}, ""),
        (fault("refusal-nan"), {"refuses-nan"}, ""),
        (fault("constant-g", detected_by=("mode-and-sticking-agree",)), {GRAVITY}, ""),
        (NO_CHECK, set(), "none of slip-frction is a check of these cases"),
        (GONE, set(), "no friction.breakaway in the FMU"),
        (LEAVES, set(), "SystemExit"),
    ],
)
def test_a_fault_is_detected_by_a_foretold_check_or_survives_with_the_reason(
    fmu_path: Path, mutant: Mutant, failing: set[str], broken: str
) -> None:
    kills = tried(fmu_path, mutant)
    (row,) = kills.rows
    caught = bool(failing & set(mutant.detected_by))
    assert (row.caught, kills.passed, bool(row.broken)) == (caught, caught, bool(broken))
    assert failing <= row.failing.keys()
    # The first foretold check that fails ends it.
    assert not caught or row.failing == dict.fromkeys(failing, 1)
    assert broken in (row.broken or "")


@pytest.mark.gate
def test_a_foreign_fmu_carries_faults_in_its_calls_alone() -> None:
    mutants = [fault(name) for name in ("unit-force-in-kgf", "output-x-pull-lags", "constant-g")]
    judged: dict[str, Any] = {"contract": PHYSICS_CONTRACT}
    judged["opener"] = partial(FmuFile, names=SLIDER.names)
    honest, unit, lag, inside = tried(SLIDER.path, IN_ITS_CALLS, *mutants, **judged).rows
    assert (honest.failing, unit.caught, lag.caught) == ({}, True, True)
    assert "carries no packed source" in (inside.broken or "")
    words = r"\w+.fmu: the fault constant-g changes the Python source of the block"
    with pytest.raises(FmuError, match=words):
        verify(SLIDER.path, CASES, mutants=mutants, names=SLIDER.names)


def test_a_fault_in_the_calls_has_each_instance_to_itself() -> None:
    counting = "def step(self, time, h):\n    original(self, time, h)\n    self.steps = {0} + 1"
    hooks = (
        # The second of a call lies over the first; names are ours, values in SI.
        ("step", counting.format("getattr(self, 'steps', 0)")),
        ("step", counting.format("self.steps")),
        ("get", "def get(self, names):\n    return {**original(self, names), 'F': self.steps}"),
        ("set", "def set(self, values):\n    original(self, {**values, 'v': 0.03})"),
        ("reset", "def reset(self):\n    original(self)\n    self.steps = 100"),
    )
    file = FmuFile(SLIDER.path, SLIDER.names, hooks)
    with file.instantiate() as first, file.instantiate() as second:
        for instance in (first, second):
            instance.start({"v": 0.01})
            instance.step(0.0, 0.5)
        first.step(0.5, 0.25)
        assert first.reader(["F"])() == [4.0]
        assert second.reader(["v", "F"])() == [pytest.approx(0.03), 2.0]
        second.reset()
        assert second.reader(["F"])() == [100.0]
    file.close()
