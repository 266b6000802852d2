"""Cases of growing static friction: whom they are for, how they scale, every eighth sequence."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from stickslip_verification import FmuError, NameMap, load_cases
from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.law import law_of
from stickslip_verification.drive.fmu.names import Target
from stickslip_verification.drive.other_runs import RUNS
from stickslip_verification.drive.stepping import (
    NotApplicableError,
    require_law,
    run_case,
    setting_of,
)
from stickslip_verification.suite.cases import follow
from stickslip_verification.suite.other_laws import SHARE, with_dwell
from stickslip_verification.suite.sequences import draw_sequences, well_decided
from tests.makers import altered

GROWTH, LOGARITHM, FIRST, DEFAULT = (
    load_cases(name)[0]
    for name in ("dwell-growth", "dwell-logarithm", "dwell-first-stick", "default")
)


@pytest.fixture
def renamed(fmu_path: Path, tmp_path: Path) -> Callable[..., Path]:
    """Give what makes an FMU of ours with other names of some variables."""

    def make(**names: str) -> Path:
        def renaming(text: str) -> str:
            return re.sub(r'(?<= name=")\w+', lambda old: names.get(old[0], old[0]), text)

        return altered(fmu_path, tmp_path / "other.fmu", renaming)

    return make


def test_an_fmu_without_growth_is_judged_on_all_other_cases(
    fmu_path: Path, renamed: Callable[..., Path]
) -> None:
    other = FmuFile(renamed(tau_s="tau_x"), own_starts=False)
    require_law(other, GROWTH)
    with pytest.raises(NotApplicableError, match="it has no variable tau_s"):
        setting_of(other, GROWTH)
    assert "tau_s" not in setting_of(other, DEFAULT).parameters
    assert setting_of(other, LOGARITHM).parameters["B"] == 0.02
    assert law_of(other) == "coulomb"
    assert setting_of(FmuFile(fmu_path), GROWTH).parameters == {"tau_s": 0.1}


def test_a_variable_of_another_unit_is_not_the_growth_and_a_map_to_it_is_refused(
    renamed: Callable[..., Path],
) -> None:
    path = renamed(B="B_", x_start="B")
    other = FmuFile(path, own_starts=False)
    require_law(other, LOGARITHM)
    with pytest.raises(NotApplicableError, match="it has no variable B"):
        setting_of(other, LOGARITHM)
    with pytest.raises(FmuError, match="which is not a unit like '1'"):
        require_law(FmuFile(path, NameMap({"B": Target("B")})), LOGARITHM)


@pytest.mark.parametrize("other", ["mirror", "forces", "time"])
def test_the_scaled_motion_with_both_growths_is_the_same_to_the_bit(
    fmu_path: Path, other: str
) -> None:
    fmu = FmuFile(fmu_path)
    plain, scaled = run_case(fmu, FIRST), RUNS[other](fmu, FIRST)
    for name, samples in plain.outputs.items():
        assert samples.tolist() == scaled.outputs[name].tolist(), name


def test_every_eighth_sequence_is_tried_with_growth_too() -> None:
    drawn = [each.case for each in draw_sequences(seed=7, count=40)]
    grown = with_dwell(drawn, 7)
    assert [each.id for each in grown] == [f"{each.id}-dwell" for each in drawn[::SHARE]]
    assert grown == with_dwell(drawn, 7)
    assert [each.times for each in grown] == [each.times for each in drawn[::SHARE]]
    assert all(well_decided(follow(case.parameters, case.steps)) for case in grown)
    tuned = sum(any("tau_s" in step.changes for step in case.steps) for case in grown)
    assert tuned > len(grown) // 2
