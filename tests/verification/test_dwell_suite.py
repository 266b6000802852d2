"""Cases of growing static friction: whom they are for, every eighth sequence."""

from pathlib import Path

import pytest

from stickslip_verification.drive.instance import FmuFile
from stickslip_verification.drive.masters import law_of, require_law, setting_of
from stickslip_verification.drive.processes import NotApplicableError
from stickslip_verification.suite.cases import follow
from stickslip_verification.suite.sequences import SHARE, draw_sequences, well_decided, with_dwell
from tests.makers import altered, edited

from .records import named

GROWTH, LOGARITHM, DEFAULT = map(named, ("dwell-growth", "dwell-logarithm", "default"))


def test_an_fmu_without_growth_is_judged_on_all_other_cases(fmu_path: Path, tmp_path: Path) -> None:
    # Its `B` is a length, and so not the growth.
    names = (("tau_s", "tau_x"), ("B", "B_"), ("x_start", "B"))
    renamed = edited(*((f' name="{old}"', f' name="{new}"') for old, new in names))
    other = FmuFile(altered(fmu_path, tmp_path / "other.fmu", renamed), own_starts=False)
    require_law(other, GROWTH)
    with pytest.raises(NotApplicableError, match="it has no variable tau_s"):
        setting_of(other, GROWTH)
    assert "tau_s" not in setting_of(other, DEFAULT).parameters
    with pytest.raises(NotApplicableError, match="it has no variable B"):
        setting_of(other, LOGARITHM)
    assert law_of(other) == "coulomb"
    assert setting_of(FmuFile(fmu_path), GROWTH).parameters == {"tau_s": 0.1}


def test_every_eighth_sequence_is_tried_with_growth_too() -> None:
    drawn = [each.case for each in draw_sequences(seed=7, count=40)]
    grown = with_dwell(drawn, 7)
    assert [each.id for each in grown] == [f"{each.id}-dwell" for each in drawn[::SHARE]]
    assert grown == with_dwell(drawn, 7)
    assert [each.times for each in grown] == [each.times for each in drawn[::SHARE]]
    assert all(well_decided(follow(case.parameters, case.steps)) for case in grown)
    tuned = sum(any("tau_s" in step.changes for step in case.steps) for case in grown)
    assert tuned > len(grown) // 2
