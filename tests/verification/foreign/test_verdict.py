"""The verdict on foreign FMUs: the suite passes the faultless and fails their faulty twins."""

from collections.abc import Sequence
from pathlib import Path

import pytest

from stickslip_verification import load_cases, verify
from stickslip_verification.suite.sequences import COUNT
from tests.verification.foreign import makers
from tests.verification.foreign.makers import CALLING_PATTERNS, COMBINATIONS, MAKERS
from tests.verification.records import named

SOME = 16
"""Random sequences that the faultless FMUs are tried on."""

FEW = 24
"""Random sequences of which two at least find each of the twins."""

# Cases with starts beyond rest, in motion and off zero, clamps, reversals, stops that only touch
# zero and equal forces: where conventions and rounding might decide.
OF_CONVENTION = (
    "clamp-tuned",
    "default",
    "frictionless",
    "gap-whole",
    "lifted-and-set-down",
    "moving-start",
    "no-gap",
    "no-pull",
    "reversals",
    "start-beyond",
)


@pytest.mark.parametrize("maker", MAKERS)
@pytest.mark.parametrize(
    ("cases", "sequences"),
    [
        pytest.param(OF_CONVENTION, SOME, id="some"),
        pytest.param([case.id for case in load_cases()], COUNT, marks=pytest.mark.soak, id="all"),
    ],
)
def test_a_faultless_foreign_fmu_passes(
    maker: str, cases: Sequence[str], sequences: int, tmp_path: Path
) -> None:
    """Another method, other names, units, signs and conventions fail no check that decides."""
    fmu = makers.make(maker, tmp_path)
    names, tried = makers.names_of(maker), [named(case) for case in cases]
    verdict = verify(fmu, tried, names=names, sequences=sequences, jobs=1)
    failed = [(each.case, each.check, each.failure) for each in verdict.checks if each.failed]
    assert failed == []
    assert verdict.passed


@pytest.mark.parametrize("maker", MAKERS)
@pytest.mark.parametrize(
    "faults",
    [
        pytest.param(COMBINATIONS, id="combination"),
        pytest.param(CALLING_PATTERNS, id="calling-pattern"),
    ],
)
def test_its_faulty_twin_fails(maker: str, faults: dict[str, str], tmp_path: Path) -> None:
    """A fault that no case of one step shows is found by what is tried besides the cases."""
    fmu = makers.make(maker, tmp_path, faults[maker])
    names = makers.names_of(maker)
    tried = [named("one-step")]
    verdict = verify(
        fmu, tried, names=names, sequences=FEW, fresh_processes=False, time_limit=3.0, jobs=1
    )
    # What takes too long has a failure in words, and no error.
    found = {each.case for each in verdict.checks if each.failed and each.error is not None}
    assert len(found - {"one-step", ""}) > 1
    assert not verdict.passed
