"""The kill matrix: planted faults are detected by the foretold checks, and nothing else is."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from stickslip_verification import (
    FmuError,
    KillMatrix,
    Mutant,
    NameMap,
    load_invariants,
    load_mutants,
    verify,
)
from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.probes import IN_A_FRESH_PROCESS
from stickslip_verification.judge.checks import PHYSICS_CONTRACT
from stickslip_verification.run.baseline import Baseline, compute
from stickslip_verification.run.kill_matrix import How, detect
from stickslip_verification.suite.faults import Override, reasons_to_stay

from .records import named

CASES = [named("one-step"), named("reversals")]
ALL = load_invariants()
INVARIANTS = replace(
    ALL,
    orders=(),
    probes=[probe for probe in ALL.probes if probe.probe not in IN_A_FRESH_PROCESS],
)
WHOLE, FORETOLD = How(), How(whole=False)


@cache
def baseline() -> list[Baseline]:
    return compute(CASES, INVARIANTS, jobs=1)


def tried(fmu: Path, *mutants: Mutant, how: How = FORETOLD) -> KillMatrix:
    """Try faults on two cases, and on the probes that need no fresh process."""
    return detect(fmu, mutants, baseline(), INVARIANTS, jobs=1, how=how)


def fault(name: str, **changes: object) -> Mutant:
    """Return a planted fault of the suite, with changes to its description."""
    return replace(load_mutants(name)[0], **changes)  # type: ignore[arg-type]


def overriding(target: str, code: str) -> Mutant:
    return fault("constant-g", id=target, overrides=(Override(target, code),))


IN_THE_FMU = overriding("block.Block.set", "def set(self, name, v):\n    original(self, name, v)")
IN_ITS_CALLS = overriding("master.step", "def step(self, time, h):\n    original(self, time, h)")


@pytest.mark.gate
def test_tried_on_everything_a_fault_fails_what_is_about_it_and_no_fault_fails_nothing(
    fmu_path: Path,
) -> None:
    mutants = (fault("constant-g"), fault("creep-in-stick"), IN_THE_FMU, IN_ITS_CALLS)
    kills = tried(fmu_path, *mutants, how=WHOLE)
    gravity, creep, *harmless = kills.rows
    assert gravity.caught
    assert creep.caught
    assert "break-away-force-is-mu_s-N" in gravity.failing.keys() - creep.failing.keys()
    assert "stick-holds-x" in creep.failing.keys() - gravity.failing.keys()
    assert [(row.failing, row.caught, row.broken) for row in harmless] == [({}, False, None)] * 2
    assert not kills.passed
    # With so few faults most checks detect none, and each has to say why it stays.
    assert kills.kills_nothing["mode-and-sticking-agree"] == ""
    assert "stick-holds-x" not in kills.kills_nothing
    assert all(reasons_to_stay().values())


@pytest.mark.parametrize(
    ("name", "failing"),
    [("constant-g", "break-away-force-is-mu_s-N"), ("refusal-nan", "refuses-nan")],
)
def test_foretold_the_first_check_that_fails_ends_it(
    fmu_path: Path, name: str, failing: str
) -> None:
    kills = tried(fmu_path, fault(name))
    (row,) = kills.rows
    assert row.failing == {failing: 1}
    assert (row.caught, kills.kills_nothing, kills.passed) == (True, {}, True)


GONE = overriding("friction.breakaway", "def breakaway():\n    return 1.0")
LEAVES = overriding("master.get", "def get(self, names):\n    raise SystemExit(0)")
NO_CHECK = fault("constant-g", detected_by=("slip-frction",))


@pytest.mark.parametrize(
    ("mutant", "why"),
    [
        (GONE, "no friction.breakaway in the FMU"),
        (LEAVES, "SystemExit"),
        (NO_CHECK, "none of slip-frction is a check of these cases or of all runs"),
    ],
)
def test_a_fault_that_cannot_be_judged_survives_with_the_reason(
    fmu_path: Path, mutant: Mutant, why: str
) -> None:
    kills = tried(fmu_path, mutant)
    assert why in (kills.rows[0].broken or "")
    assert (kills.rows[0].caught, kills.passed) == (False, False)


def test_a_fault_that_was_foretold_wrongly_survives_with_what_fails(fmu_path: Path) -> None:
    wrong = fault("constant-g", detected_by=("mode-and-sticking-agree",))
    kills = tried(fmu_path, wrong)
    assert not kills.passed
    assert kills.rows[0].failing["break-away-force-is-mu_s-N"] >= 1


def test_a_foreign_fmu_carries_faults_in_its_calls_alone(
    slider_mm: Path, slider_mm_names: NameMap
) -> None:
    mutants = [fault(name) for name in ("unit-force-in-kgf", "output-x-pull-lags", "constant-g")]
    how = How(slider_mm_names, PHYSICS_CONTRACT, whole=False)
    honest, unit, lag, inside = tried(slider_mm, IN_ITS_CALLS, *mutants, how=how).rows
    assert (honest.failing, unit.caught, lag.caught) == ({}, True, True)
    assert "carries no packed source" in (inside.broken or "")
    words = r"\w+.fmu: the fault constant-g changes the Python source of the block"
    with pytest.raises(FmuError, match=words):
        verify(slider_mm, CASES, mutants=mutants, names=slider_mm_names)


@pytest.mark.parametrize("slider", ["slider_mm", "slider_si"])
def test_a_fault_in_the_calls_has_each_instance_to_itself(
    slider: str, request: pytest.FixtureRequest
) -> None:
    counting = "def step(self, time, h):\n    original(self, time, h)\n    self.steps = {0} + 1"
    hooks = (
        # The second of a call lies over the first; names are ours, values in SI.
        ("step", counting.format("getattr(self, 'steps', 0)")),
        ("step", counting.format("self.steps")),
        ("get", "def get(self, names):\n    return {**original(self, names), 'F': self.steps}"),
        ("set", "def set(self, values):\n    original(self, {**values, 'v': 0.03})"),
        ("reset", "def reset(self):\n    original(self)\n    self.steps = 100"),
    )
    fmu, names = request.getfixturevalue(slider), request.getfixturevalue(f"{slider}_names")
    file = FmuFile(fmu, names, hooks)
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
