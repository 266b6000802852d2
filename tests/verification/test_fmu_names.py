"""The names file, and the friction law that names of parameters tell."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import pytest

from stickslip_verification import FmuError, NameMap, NamesError, load_cases, load_names, truth
from stickslip_verification.drive import FmuFile
from stickslip_verification.drive.fmu.archive import require
from stickslip_verification.drive.fmu.law import fitting, law_of
from stickslip_verification.drive.fmu.names import Target
from stickslip_verification.drive.stepping import require_law
from stickslip_verification.truth.parameters import Parameter
from tests.conftest import built
from tests.makers import SLIDER, altered, edited

OF_STRIBECK = truth.friction_law("stribeck").parameters


@pytest.mark.parametrize("head", ["", "[names]\n"])
def test_entries_stand_at_the_top_or_in_a_table(tmp_path: Path, head: str) -> None:
    file = tmp_path / "names.toml"
    text = (
        'x = "mass.s"\nz = { name = "dz", unit = "mm", sign = -1 }\nF = { unit = "kN" }\nT = ""\n'
    )
    file.write_text(head + text, encoding="utf-8")
    assert load_names(file).targets == {
        "x": Target("mass.s"),
        "z": Target("dz", "mm", -1),
        "F": Target("F", "kN"),
        "T": Target(""),
    }


@pytest.mark.parametrize(
    ("text", "where", "reason"),
    [
        ('m = "a"\nx_pul = "b"', "line 2", "'x_pul' is no variable of the suite; near it: x_pull"),
        ('MU_S = "a"', "line 1", "near it: mu_s"),
        ('colour = "red"', "line 1", "there are m, g, k"),
        ("[names]\ny9 = 'a'", "line 2", "'y9' is no variable of the suite"),
        ('v = "a"\n[names]\nx = "b"', "line 1", "'v' stands beside the table [names]"),
        ("x = 3", "line 1", "x is 3; it takes a name or { name, unit, sign }"),
        ('\nx = ["a"]', "line 2", "x is ['a']; it takes a name"),
        ('x = { nam = "a" }', "line 1", "x has an unknown key 'nam'; there are name, unit, sign"),
        ("x = { name = 1 }", "line 1", "x.name is 1, not a text"),
        ('x = { name = "a", unit = 1 }', "line 1", "x.unit is 1, not a text"),
        ('x = { name = "a", sign = true }', "line 1", "x.sign is True, not 1 or -1"),
        ("[x]\nsign = -2", "line 1", "x.sign is -2, not 1 or -1"),
        ('x = "a"\nz = "a"', "line 2", "z and x are both 'a'"),
        ('x = "a', "line 1", "Unterminated string"),
        ('v_s = "a"', "line 1", "'v_s' is no variable of the suite"),
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
    renamed = altered(
        built("python-2", "stribeck"),
        tmp_path / "renamed.fmu",
        edited(('name="v_s"', 'name="friction.speed"')),
    )
    (case,) = load_cases("stribeck-default")
    fmu = FmuFile(renamed, NameMap({"v_s": Target("friction.speed")}))
    require_law(fmu, case)
    assert fmu.variables["v_s"].their_name == "friction.speed"
    refusals: Mapping[str, tuple[dict[str, Target], str]] = {
        "none": ({}, "has no variable v_s, which the friction law"),
        "lost": ({"v_s": Target("speed")}, r"has no variable 'speed' for v_s; it has friction\.sp"),
        "output": ({"v_s": Target("F")}, r"v_s \('F'\) must be a parameter or an input, not a"),
    }
    for targets, words in refusals.values():
        with pytest.raises(FmuError, match=words):
            require_law(FmuFile(renamed, NameMap(targets)), case)


class Variables:
    """Stands for an FMU that has variables of these names."""

    path = "some.fmu"

    def __init__(self, names: Iterable[str]) -> None:
        self.has = set(names).__contains__

    def look_for(self, parameters: Iterable[Parameter], **how: Any) -> None:
        """Find nothing more."""


NAMES = [each.name for each in OF_STRIBECK]


@pytest.mark.parametrize(
    ("names", "law"),
    [([], "coulomb"), (["delta"], "coulomb"), (NAMES[1:], "coulomb"), (NAMES, "stribeck")],
)
def test_an_fmu_of_another_law_has_all_of_its_parameters(names: list[str], law: str) -> None:
    fmu: Any = Variables(names)
    assert law_of(fmu) == law
    cases = [*load_cases("default"), *load_cases("stribeck-default")]
    assert [case.law for case in fitting(fmu, cases)] == [law]


def test_cases_of_another_law_alone_are_refused() -> None:
    fmu: Any = Variables([])
    with pytest.raises(FmuError, match=r"its friction law is coulomb.*stickslip build --law strib"):
        fitting(fmu, load_cases("stribeck-default"))
