"""The kill matrix: planted faults are detected as foretold, and nothing else is."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from stickslip_verification import load_invariants, load_mutants, verify
from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.fmu.names import NameMap
from stickslip_verification.drive.probes import IN_A_FRESH_PROCESS
from stickslip_verification.judge.checks import PHYSICS_CONTRACT
from stickslip_verification.model.verdict import KillMatrix
from stickslip_verification.run.baseline import Baseline, compute
from stickslip_verification.run.kill_matrix import How, detect
from stickslip_verification.suite.faults import Mutant, Override, reasons_to_stay

from .records import named

CASES = [named("default"), named("reversals")]
ALL = load_invariants()
INVARIANTS = replace(
    ALL,
    orders=(),
    probes=[probe for probe in ALL.probes if probe.probe not in IN_A_FRESH_PROCESS],
)


@cache
def baseline() -> list[Baseline]:
    """Return the baseline of two cases, without observed orders."""
    return compute(CASES, INVARIANTS, jobs=1)


def fault(name: str) -> Mutant:
    """Return a planted fault of the suite."""
    return load_mutants(name)[0]


WHOLE, FORETOLD = How(), How(whole=False)


def tried(fmu: Path, *mutants: Mutant, how: How = WHOLE) -> KillMatrix:
    """Try faults on two cases, and on the probes that need no fresh process."""
    return detect(fmu, mutants, baseline(), INVARIANTS, jobs=1, how=how)


def test_faults_are_caught_by_the_checks_that_fit(fmu_path: Path) -> None:
    """Wrong gravity fails the break-away force, creep the invariant of stick, each by its name."""
    kills = tried(fmu_path, fault("constant-g"), fault("creep-in-stick"))
    gravity, creep = kills.rows
    assert gravity.caught
    assert creep.caught
    assert "stick-holds-x" in creep.failing
    assert "stick-holds-x" not in gravity.failing
    assert "slip-propagates" not in creep.failing
    assert gravity.failing["F_s-course"] == 1


def overriding(target: str, code: str) -> Mutant:
    """Return a fault of one override."""
    return replace(fault("constant-g"), overrides=(Override(target, code),))


HARMLESS = (
    overriding("block.Block.set", "def set(self, name, value):\n    original(self, name, value)"),
    overriding("master.step", "def step(self, time, h):\n    original(self, time, h)"),
)


@pytest.mark.parametrize("harmless", HARMLESS, ids=["in the FMU", "in its calls"])
def test_what_is_no_fault_is_not_convicted(fmu_path: Path, harmless: Mutant) -> None:
    """A change that changes nothing fails nothing, so its mutant survives and the suite fails."""
    kills = tried(fmu_path, harmless)
    (row,) = kills.rows
    assert row.failing == {}
    assert not row.caught
    assert row.broken is None
    assert not kills.passed


def test_a_fault_that_does_not_fit_is_told(fmu_path: Path) -> None:
    """An override of a name that is gone detects nothing; the row says why."""
    kills = tried(fmu_path, overriding("friction.breakaway", "def breakaway():\n    return 1.0"))
    assert not kills.rows[0].caught
    assert "no friction.breakaway in the FMU" in (kills.rows[0].broken or "")


def test_in_the_gate_a_fault_is_tried_where_it_was_foretold(fmu_path: Path) -> None:
    """The first foretold check that fails ends it; nothing is said of checks that kill nothing."""
    kills = tried(fmu_path, fault("constant-g"), how=FORETOLD)
    (row,) = kills.rows
    assert row.caught
    assert set(row.failing.values()) == {1}
    assert set(row.failing) <= set(row.wanted)
    assert kills.kills_nothing == {}
    assert kills.passed


def test_a_fault_of_the_interface_needs_its_probe_alone(fmu_path: Path) -> None:
    """A refusal that is missing is seen by the probe that was foretold, and by it alone."""
    kills = tried(fmu_path, fault("refusal-nan"), how=FORETOLD)
    assert kills.rows[0].failing == {"refuses-nan": 1}


def test_a_fault_that_ends_its_process_is_no_end_of_the_suite(fmu_path: Path) -> None:
    """Code that leaves Python is a run that did not end, and its fault survives with the reason."""
    leaving = overriding("master.get", "def get(self, names):\n    raise SystemExit(0)")
    (row,) = tried(fmu_path, leaving, how=FORETOLD).rows
    assert not row.caught
    assert "SystemExit" in (row.broken or "")


def test_a_fault_whose_checks_are_nowhere_says_so(fmu_path: Path) -> None:
    """A name that is no check of the chosen cases is told, and not tried."""
    lost = replace(fault("constant-g"), detected_by=("slip-frction",))
    (row,) = tried(fmu_path, lost, how=FORETOLD).rows
    assert row.broken == "none of slip-frction is a check of these cases or of all runs"


def test_a_fault_that_was_foretold_wrongly_is_tried_on_everything(fmu_path: Path) -> None:
    """Where no foretold check fails, the row says which others do, so the next try is right."""
    wrong = replace(fault("constant-g"), detected_by=("mode-and-sticking-agree",))
    kills = tried(fmu_path, wrong, how=FORETOLD)
    (row,) = kills.rows
    assert not row.caught
    assert not kills.passed
    assert row.failing["F_s-course"] == 1


def test_a_check_that_kills_nothing_needs_a_reason(fmu_path: Path) -> None:
    """With one fault most checks are kills_nothing, and without reasons the suite does not pass."""
    kills = tried(fmu_path, fault("constant-g"))
    assert "creep" not in kills.kills_nothing
    assert kills.kills_nothing["stick-holds-x"] == ""
    assert kills.rows[0].caught
    assert not kills.passed
    assert all(reasons_to_stay().values())


def test_the_matrix_is_part_of_the_verdict(fmu_path: Path) -> None:
    """A verdict with a survivor does not pass, whatever the checks say."""
    verdict = verify(
        fmu_path, [named("one-step")], mutants=[HARMLESS[0]], fresh_processes=False, jobs=1
    )
    assert verdict.summary["failed"] == 0
    assert verdict.kills is not None
    assert not verdict.passed


@pytest.mark.parametrize("name", ["fixed-step-1ms", "tanh-friction"])
def test_whole_simulators_can_be_planted(fmu_path: Path, name: str) -> None:
    """A fixed-step solver and a regularised friction run as FMUs and are detected."""
    (row,) = tried(fmu_path, fault(name)).rows
    assert row.caught


def test_a_foreign_fmu_carries_faults_in_its_calls(
    slider_mm: Path, slider_mm_names: NameMap
) -> None:
    """An honest FMU without source, by its own names and units, fails by what is planted."""
    wrong_unit, lagging = (fault(name) for name in ("unit-force-in-kgf", "output-x-pull-lags"))
    how = How(slider_mm_names, PHYSICS_CONTRACT)
    honest, unit, lag = tried(slider_mm, HARMLESS[1], wrong_unit, lagging, how=how).rows
    assert honest.failing == {}
    assert (unit.caught, lag.caught) == (True, True)
    assert "F_s-course" in unit.failing.keys() - lag.failing.keys()


def test_a_foreign_fmu_carries_no_others(slider_mm: Path, slider_mm_names: NameMap) -> None:
    """A fault in the block's source is refused for an FMU that does not carry it, by its id."""
    faults = [HARMLESS[1], fault("constant-g")]
    with pytest.raises(
        FmuError, match=r"\w+.fmu: the fault constant-g changes the Python source of the block"
    ):
        verify(slider_mm, CASES, mutants=faults, names=slider_mm_names)
    (row,) = tried(slider_mm, fault("constant-g"), how=How(slider_mm_names)).rows
    assert "carries no packed source" in (row.broken or "")


@pytest.mark.parametrize("slider", ["slider_mm", "slider_si"])
def test_a_fault_in_the_calls_has_each_instance_to_itself(
    slider: str, request: pytest.FixtureRequest
) -> None:
    """In FMI 2.0 and 3.0 faults see our names and SI; the second of a call lies over the first."""
    counting = "def step(self, time, h):\n    original(self, time, h)\n    self.steps = {0} + 1"
    hooks = (
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
