"""Cases of growing static friction in the suite: whom they are for, and what they may say."""

from __future__ import annotations

from pathlib import Path

import pytest

from stickslip_verification import CaseError, load_cases
from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.fmu.law import law_of
from stickslip_verification.drive.fmu.names import NameMap, Target
from stickslip_verification.drive.other_runs import RUNS
from stickslip_verification.drive.stepping import (
    NotApplicableError,
    require_law,
    run_case,
    setting_of,
)
from stickslip_verification.model.symmetries import HEAVIER, MIRROR, QUICKER
from stickslip_verification.model.verdict import CaseGroup
from stickslip_verification.suite.cases import follow
from stickslip_verification.suite.other_laws import SHARE, with_dwell
from stickslip_verification.suite.sequences import draw_sequences, well_decided
from tests.verification.foreign import building

(GROWTH,) = load_cases("dwell-growth")
(DEFAULT,) = load_cases("default")

OWN = ["tau_s", "B", "t_0", "age_start"]

GOOD = """\
id = "good"
title = "A case"
about = "It is enough to be read."
courses = ["x"]
motion = { slips = 1 }

[parameters]
tau_s = 0.1

[experiment]
stop_time = 0.5
steps = { fixed = 0.1 }
"""


def _without(fmu: Path, folder: Path, old: str, new: str) -> FmuFile:
    """Return our FMU with a text of its description replaced, held as an FMU of somebody else."""
    altered = building.altered(fmu, folder / "other.fmu", lambda text: text.replace(old, new))
    return FmuFile(altered, own_starts=False)


def test_parameters_of_the_growth_are_those_of_a_case_that_names_one() -> None:
    """Other cases of Coulomb's law have the twelve values, and ask no FMU for more."""
    assert [each.name for each in GROWTH.own] == OWN
    assert DEFAULT.own == ()
    assert set(GROWTH.start) - set(DEFAULT.start) == set(OWN)
    assert GROWTH.group == CaseGroup.DWELL
    assert DEFAULT.group == CaseGroup.DEFAULT


def test_an_fmu_without_growth_is_judged_on_all_other_cases(fmu_path: Path, tmp_path: Path) -> None:
    """It lacks a variable that the case gives another value than the start, and no more."""
    other = _without(fmu_path, tmp_path, 'name="tau_s"', 'name="tau_x"')
    require_law(other, GROWTH)
    with pytest.raises(NotApplicableError, match="it has no variable tau_s"):
        setting_of(other, GROWTH)
    assert "tau_s" not in setting_of(other, DEFAULT).parameters
    (logarithm,) = load_cases("dwell-logarithm")
    assert setting_of(other, logarithm).parameters["B"] == 0.02
    assert law_of(other) == "coulomb"
    ours = FmuFile(fmu_path)
    assert setting_of(ours, GROWTH).parameters == {"tau_s": 0.1}


def test_a_variable_of_another_unit_is_not_taken_for_the_growth(
    fmu_path: Path, tmp_path: Path
) -> None:
    """B of another unit is something else; a person who maps it is told."""
    renamed = building.altered(
        fmu_path,
        tmp_path / "b.fmu",
        lambda text: text.replace('name="B"', 'name="B_"').replace('name="x_start"', 'name="B"'),
    )
    (logarithm,) = load_cases("dwell-logarithm")
    fmu = FmuFile(renamed, own_starts=False)
    require_law(fmu, logarithm)
    assert not fmu.has("B")
    with pytest.raises(NotApplicableError, match="it has no variable B"):
        setting_of(fmu, logarithm)
    with pytest.raises(FmuError, match="which is not a unit like '1'"):
        require_law(FmuFile(renamed, NameMap({"B": Target("B")})), logarithm)


def test_scaling_takes_times_and_leaves_coefficients() -> None:
    """tau_s, t_0 and age_start are times, B a number; none has a direction."""
    values = {"tau_s": 0.1, "B": 0.02, "t_0": 0.5, "age_start": 3.0}
    assert MIRROR.scaled(values, GROWTH.own) == values
    assert HEAVIER.scaled(values, GROWTH.own) == values
    assert QUICKER.scaled(values, GROWTH.own) == {
        "tau_s": 0.05,
        "B": 0.02,
        "t_0": 0.25,
        "age_start": 1.5,
    }


@pytest.mark.parametrize("other", ["mirror", "forces", "time"])
def test_the_scaled_motion_is_the_same_to_the_bit(fmu_path: Path, other: str) -> None:
    """Mirror, heavier and quicker, of our FMU with both growths and an old first stick."""
    fmu = FmuFile(fmu_path)
    (case,) = load_cases("dwell-first-stick")
    plain, scaled = run_case(fmu, case), RUNS[other](fmu, case)
    for name, samples in plain.outputs.items():
        assert samples.tolist() == scaled.outputs[name].tolist(), name


def test_a_formula_of_constant_coefficients_is_refused(tmp_path: Path) -> None:
    """The closed forms of the cycle are not those of a friction that grows."""
    file = tmp_path / "good.toml"
    file.write_text(GOOD, encoding="utf-8")
    load_cases(folder=tmp_path)
    file.write_text(
        GOOD.replace("[parameters]", "[cycle]\nat = { cycle = 1 }\n\n[parameters]"),
        encoding="utf-8",
    )
    with pytest.raises(CaseError, match="Coulomb's law with constant coefficients"):
        load_cases(folder=tmp_path)
    file.write_text(GOOD.replace("tau_s = 0.1", "tau_s = -0.1"), encoding="utf-8")
    with pytest.raises(CaseError, match=r"-0\.1 is less than the minimum of 0"):
        load_cases(folder=tmp_path)


def test_every_eighth_sequence_is_tried_with_growth_too() -> None:
    """Its changes come as before, one of them tunes the growth, and rounding decides no event."""
    drawn = [each.case for each in draw_sequences(seed=7, count=40)]
    grown = with_dwell(drawn, 7)
    assert [each.id for each in grown] == [f"{each.id}-dwell" for each in drawn[::SHARE]]
    assert grown == with_dwell(drawn, 7)
    tuned = 0
    for plain, case in zip(drawn[::SHARE], grown, strict=True):
        assert case.times == plain.times
        tuned += any("tau_s" in step.changes for step in case.steps)
        assert well_decided(follow(case.parameters, case.steps))
    assert tuned > len(grown) // 2
