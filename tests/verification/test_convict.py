"""The suite on trial: planted faults are convicted as foretold, and nothing else is."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from stickslip_verification import load_laws, load_mutants, verify
from stickslip_verification.mutants import Mutant
from stickslip_verification.mutants.planted import Substitution, idle_reasons
from stickslip_verification.suite.convict import convict
from stickslip_verification.suite.ground import Ground, lay
from stickslip_verification.verdict import KillMatrix

from .standing_in import named

CASES = [named("default"), named("reversals")]


@cache
def ground() -> list[Ground]:
    """Return the ground of two cases, without observed orders."""
    return lay(CASES, replace(load_laws(), orders=()), jobs=1)


def fault(name: str) -> Mutant:
    """Return a planted fault of the suite."""
    return load_mutants(name)[0]


def tried(fmu: Path, *mutants: Mutant) -> KillMatrix:
    """Try faults on two cases."""
    return convict(fmu, mutants, ground(), load_laws(), jobs=1)


def test_faults_are_caught_by_the_checks_that_fit(fmu_path: Path) -> None:
    """Wrong gravity fails the break-away force, a creep the law of stick, each by its name."""
    kills = tried(fmu_path, fault("constant-g"), fault("creep-in-stick"))
    gravity, creep = kills.rows
    assert gravity.caught
    assert creep.caught
    assert "stick-holds-x" in creep.failing
    assert "stick-holds-x" not in gravity.failing
    assert "slip-propagates" not in creep.failing
    assert gravity.failing["F_s-course"] == 1


def test_what_is_no_fault_is_not_convicted(fmu_path: Path) -> None:
    """A change that changes nothing fails nothing, so its mutant survives and the suite fails."""
    comment = Substitution("friction.py", "# The rest test forgives", "# The test of rest forgives")
    harmless = replace(fault("constant-g"), substitutions=(comment,), additions=())
    kills = tried(fmu_path, harmless)
    (row,) = kills.rows
    assert row.failing == {}
    assert not row.caught
    assert row.broken is None
    assert not kills.passed


def test_a_fault_that_does_not_fit_is_told(fmu_path: Path) -> None:
    """A substitution that matches nothing convicts nobody; the row says why."""
    lost = Substitution("friction.py", "no such text", "x")
    kills = tried(fmu_path, replace(fault("constant-g"), substitutions=(lost,), additions=()))
    assert not kills.rows[0].caught
    assert "friction.py" in (kills.rows[0].broken or "")


def test_a_check_that_kills_nothing_needs_a_reason(fmu_path: Path) -> None:
    """With one fault most checks are idle, and without reasons the suite does not pass."""
    kills = tried(fmu_path, fault("constant-g"))
    assert "creep" not in kills.idle
    assert kills.idle["stick-holds-x"] == ""
    assert kills.rows[0].caught
    assert not kills.passed
    assert all(idle_reasons().values())


def test_the_matrix_is_part_of_the_verdict(fmu_path: Path) -> None:
    """A verdict with a survivor does not pass, whatever the checks say."""
    comment = Substitution("friction.py", "# The rest test forgives", "# The test of rest forgives")
    harmless = replace(fault("constant-g"), substitutions=(comment,), additions=())
    verdict = verify(fmu_path, [named("one-step")], mutants=[harmless], jobs=1)
    assert verdict.summary["failed"] == 0
    assert verdict.kills is not None
    assert not verdict.passed


@pytest.mark.parametrize("name", ["fixed-step-1ms", "tanh-friction"])
def test_whole_simulators_can_be_planted(fmu_path: Path, name: str) -> None:
    """A fixed-step solver and a regularised friction run as FMUs and are convicted."""
    (row,) = tried(fmu_path, fault(name)).rows
    assert row.caught
