"""The names file: what it may say, and what is said when it says something else."""

from pathlib import Path

import pytest

from stickslip_fmu.packer import build
from stickslip_verification import load_cases
from stickslip_verification.drive.fmu.archive import FmuFile, require
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.fmu.names import (
    INPUT_UNITS,
    NOT_THERE,
    UNITS,
    NameMap,
    NamesError,
    Target,
    load_names,
)
from stickslip_verification.drive.stepping import require_law
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.truth import friction_law
from stickslip_verification.truth.parameters import START_VALUES

from .foreign import building


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """Return where a names file may be written."""
    return tmp_path / "names.toml"


def test_the_variables_of_the_suite_are_those_it_sets_and_reads() -> None:
    """Every parameter, input and output of the suite can be named, and nothing else."""
    assert set(INPUT_UNITS) == set(START_VALUES)
    assert set(UNITS) == set(START_VALUES) | set(OUTPUT_NAMES)


@pytest.mark.parametrize("head", ["", "[names]\n"])
def test_entries_stand_at_the_top_or_in_a_table(file: Path, head: str) -> None:
    """An entry is a name, or a name with unit and sign, in either place."""
    text = (
        'x = "mass.s"\nz = { name = "dz", unit = "mm", sign = -1 }\nF = { unit = "kN" }\nT = ""\n'
    )
    file.write_text(head + text, encoding="utf-8")
    assert load_names(file).targets == {
        "x": Target("mass.s"),
        "z": Target("dz", "mm", -1),
        "F": Target("F", "kN"),
        "T": Target(NOT_THERE),
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
        ('x = { name = "a", sign = 2 }', "line 1", "x.sign is 2, not 1 or -1"),
        ('x = { name = "a", sign = true }', "line 1", "x.sign is True, not 1 or -1"),
        ("[x]\nsign = -2", "line 1", "x.sign is -2, not 1 or -1"),
        ('x = "a"\nz = "a"', "line 2", "z and x are both 'a'"),
        ('x = "a', "line 1", "Unterminated string"),
        ('x = "a"\nx = "b"', "line 2", "Cannot overwrite a value"),
        ("", "", "names no variable"),
    ],
)
def test_what_is_wrong_is_told_with_its_line(
    file: Path, text: str, where: str, reason: str
) -> None:
    """A names file that cannot be used is refused on one line: file, line and what is wrong."""
    file.write_text(text, encoding="utf-8")
    with pytest.raises(NamesError) as caught:
        load_names(file)
    assert str(caught.value).startswith(f"{file}: {where}")
    assert reason in caught.value.reason
    assert "\n" not in str(caught.value)


def test_a_names_file_that_cannot_be_read_is_told(tmp_path: Path) -> None:
    """A file that is not there, is a folder or is no text is refused with the reason."""
    with pytest.raises(NamesError, match="no such file"):
        load_names(tmp_path / "none.toml")
    with pytest.raises(NamesError, match="is a directory"):
        load_names(tmp_path)
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"x = '\xff'")
    with pytest.raises(NamesError, match="is not UTF-8"):
        load_names(binary)


def test_mapped_names_that_the_fmu_lacks_are_all_told(slider_mm: Path) -> None:
    """Every name that the FMU does not have is named, with ours, and then what it does have."""
    names = NameMap({"x": Target("slider.q"), "F": Target("nothing"), "v": Target("drive.speed")})
    with pytest.raises(FmuError) as caught:
        FmuFile(slider_mm, names)
    lacks, has = str(caught.value).split("; it has ")
    assert lacks == "SliderMm.fmu: has no variable 'slider.q' for x, 'nothing' for F"
    near = has.removesuffix(" and 14 more").split(", ")
    assert len(near) == 8
    assert set(near[:2]) == {"slider.s [millimetre]", "slider.v [mm/s]"}


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        (
            {"x": Target("spring.rate")},
            "x ('spring.rate') must be an output, not a fixed parameter",
        ),
        (
            {"v": Target("slider.v")},
            "v ('slider.v') must be a parameter or an input, not a continuous output",
        ),
    ],
)
def test_a_variable_of_the_wrong_sort_is_refused(
    slider_mm: Path, entry: dict[str, Target], said: str
) -> None:
    """What the suite sets must be settable in the FMU, what it reads must be given by it."""
    with pytest.raises(FmuError) as caught:
        FmuFile(slider_mm, NameMap(entry))
    assert str(caught.value) == f"SliderMm.fmu: {said}"


def test_what_an_fmu_has_is_told_with_unit_and_description(slider_mm: Path, tmp_path: Path) -> None:
    """The nearest first; a long description is cut, and the message stays on one line."""

    def described(description: str) -> str:
        text = "The way of the slider &#10; along the rail, counted from where it was at the start"
        return description.replace('name="slider.s"', f'name="slider.s" description="{text}"')

    fmu = building.altered(slider_mm, tmp_path / "told.fmu", described)
    with pytest.raises(FmuError) as caught:
        require(FmuFile(fmu))
    assert (
        "has no variable m, k, mu_s, mu_k, v, x; map them with --names (`stickslip names`"
        in str(caught.value)
    )
    shown = "slider.s [millimetre] (The way of the slider along the rail, c\N{HORIZONTAL ELLIPSIS})"
    assert shown in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_names_file_may_name_the_parameters_of_a_law(file: Path) -> None:
    """Those of the law that is tried, and of no other."""
    file.write_text('x = "mass.s"\nv_s = { name = "friction.speed", sign = -1 }\n', "utf-8")
    own = friction_law("stribeck").parameters
    assert load_names(file, own).targets["v_s"] == Target("friction.speed", sign=-1)
    with pytest.raises(NamesError, match="line 2: 'v_s' is no variable of the suite"):
        load_names(file)


def test_a_parameter_of_a_law_is_set_under_its_name_in_the_fmu(
    fmu_path: Path, tmp_path: Path
) -> None:
    """It is found by the names file; one that is mapped to nothing there is told."""
    renamed = building.altered(
        build(tmp_path, law="stribeck"),
        tmp_path / "renamed.fmu",
        lambda text: text.replace('name="v_s"', 'name="friction.speed"'),
    )
    (case,) = load_cases("stribeck-default")
    with pytest.raises(FmuError, match="has no variable v_s, which the friction law"):
        require_law(FmuFile(renamed), case)
    fmu = FmuFile(renamed, NameMap({"v_s": Target("friction.speed")}))
    require_law(fmu, case)
    assert fmu.variables["v_s"].their_name == "friction.speed"
    with pytest.raises(FmuError, match=r"has no variable 'speed' for v_s; it has friction\.speed"):
        FmuFile(renamed, NameMap({"v_s": Target("speed")}))
    with pytest.raises(FmuError, match=r"v_s \('F'\) must be a parameter or an input, not a"):
        require_law(FmuFile(renamed, NameMap({"v_s": Target("F")})), case)


def test_without_a_map_our_own_names_count(foreign_fmu: Path) -> None:
    """An FMU that calls its variables as we do needs no map."""
    fmu = FmuFile(foreign_fmu)
    assert set(fmu.variables) == {"k", "z"}
    assert not fmu.extra_outputs


def test_a_variable_is_never_taken_twice(foreign_fmu: Path) -> None:
    """What the map gives to one of our names is not guessed for another."""
    fmu = FmuFile(foreign_fmu, NameMap({"x": Target("z")}))
    assert set(fmu.variables) == {"k", "x"}


def test_a_variable_can_be_left_out(foreign_fmu: Path) -> None:
    """An empty name says that a variable of our name is something else in this FMU."""
    fmu = FmuFile(foreign_fmu, NameMap({"z": Target(NOT_THERE)}))
    assert set(fmu.variables) == {"k"}
    assert fmu.extra_outputs == ("z",)
