"""The names file, and the friction law that names of parameters tell."""

from pathlib import Path

import pytest

from stickslip_verification import FmuError, NameMap, NamesError, load_cases, load_names, truth
from stickslip_verification.drive import FmuFile
from stickslip_verification.drive.description import Target
from stickslip_verification.drive.instance import require
from stickslip_verification.drive.masters import fitting, require_law
from tests.conftest import built
from tests.makers import SLIDER, altered, edited

OF_STRIBECK = truth.friction_law("stribeck").parameters


@pytest.mark.parametrize("head", ["", "[names]\n"])
def test_entries_stand_at_the_top_or_in_a_table(tmp_path: Path, head: str) -> None:
    file = tmp_path / "names.toml"
    text = 'z = { name = "dz", unit = "mm", sign = -1 }\nF = { unit = "kN" }\nT = ""\n'
    file.write_text(head + text, encoding="utf-8")
    expected = {"z": Target("dz", "mm", -1), "F": Target("F", "kN"), "T": Target("")}
    assert load_names(file).targets == expected


@pytest.mark.parametrize(
    ("text", "where", "reason"),
    [
        ('m = "a"\nx_pul = "b"', "line 2", "'x_pul' is no variable of the suite; near it: x_pull"),
        ('colour = "red"', "line 1", "there are m, g, k"),
        ('v = "a"\n[names]\nx = "b"', "line 1", "'v' stands beside the table [names]"),
        ('\nx = ["a"]', "line 2", "should be a valid string"),
        ('x = { nam = "a" }', "line 1", "is no field; there are name, unit, sign"),
        ("x = { name = 1 }", "line 1", "1 should be a valid string"),
        ("[x]\nsign = -2", "line 2", "-2 should be 1 or -1"),
        ('x = "a"\nz = "a"', "line 2", "z and x are both 'a'"),
        ('x = "a', "line 1", "Unterminated string"),
        ("", "", "names no variable"),
        (b"x = '\xff'", "", "is not UTF-8"),
        (None, "", "no such file"),
    ],
)
def test_what_is_wrong_in_a_names_file_is_told_with_its_line(
    tmp_path: Path, text: str | bytes | None, where: str, reason: str
) -> None:
    file = tmp_path / "names.toml"
    if text is not None:
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(NamesError) as caught:
        load_names(file)
    assert str(caught.value).startswith(f"{file}: {where}")
    assert reason in caught.value.reason
    assert "\n" not in str(caught.value)


def test_a_names_file_may_name_the_parameters_of_the_law_that_is_tried(tmp_path: Path) -> None:
    file = tmp_path / "names.toml"
    file.write_text('v_s = { name = "friction.speed", sign = -1 }\n', "utf-8")
    assert load_names(file, OF_STRIBECK).targets["v_s"] == Target("friction.speed", sign=-1)


def test_what_an_fmu_lacks_is_told_with_what_it_has_the_nearest_first(tmp_path: Path) -> None:
    text = 'name="slider.s" description="The way along &#10; the rail, counted from the start"'
    described = altered(SLIDER.path, tmp_path / "a.fmu", edited((r'name="slider\.s"', text)))
    with pytest.raises(FmuError) as caught:
        require(FmuFile(described))
    lacks, has = str(caught.value).split("; it has ")
    assert "has no variable m, k, mu_s, mu_k, v, x; map them with --names (`stickslip n" in lacks
    assert "slider.s [millimetre] (The way along the rail, counted from th…)" in has
    assert has.endswith(" and 14 more")
    assert "\n" not in has


def test_a_parameter_of_a_law_is_found_under_its_name_in_the_fmu(tmp_path: Path) -> None:
    ours, change = built("python-2", "stribeck"), edited(('name="v_s"', 'name="friction.speed"'))
    renamed = altered(ours, tmp_path / "renamed.fmu", change)
    (case,) = load_cases("stribeck-default")
    fmu = FmuFile(renamed, NameMap({"v_s": Target("friction.speed")}))
    require_law(fmu, case)
    assert fmu.variables["v_s"].their_name == "friction.speed"
    refusals: list[tuple[dict[str, Target], str]] = [
        ({}, "has no variable v_s, which the friction law"),
        ({"v_s": Target("speed")}, r"has no variable 'speed' for v_s; it has friction\.sp"),
        ({"v_s": Target("F")}, r"v_s \('F'\) must be a parameter or an input, not a"),
    ]
    for targets, words in refusals:
        with pytest.raises(FmuError, match=words):
            require_law(FmuFile(renamed, NameMap(targets)), case)


def test_an_fmu_is_tried_on_cases_of_its_law_and_others_alone_are_refused() -> None:
    coulomb, other = load_cases("default"), load_cases("stribeck-default")
    ours, stribeck = FmuFile(built("python-2")), FmuFile(built("python-2", "stribeck"))
    assert fitting(ours, [*coulomb, *other]) == coulomb
    assert fitting(stribeck, [*coulomb, *other]) == other
    with pytest.raises(FmuError, match=r"its friction law is coulomb.*stickslip build --law strib"):
        fitting(ours, other)
