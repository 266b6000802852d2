"""The names file to begin with: guesses by unit, sort and words, and what is not sure."""

import re
import tomllib
from pathlib import Path

import pytest

from stickslip_verification import NamesError, load_names, starter
from stickslip_verification.drive import FmuFile
from stickslip_verification.drive.description import UNITS
from tests.makers import (
    SLIDER,
    SLIDER_3,
    Described,
    Foreign,
    altered,
    described,
    description,
    edited,
    misbehaving,
)

PARAMETER = ("parameter", "fixed", "Real")
OUTPUT = ("output", "discrete", "Real")


BLOCK = {
    "m": Described("slider.mass", "kg", *PARAMETER),
    "k": Described("stiffness", "N/m", *PARAMETER),
    "mu_s": Described("mu_static", "", *PARAMETER),
    "mu_k": Described("mu_sliding", "", *PARAMETER),
    "v": Described("pull_speed", "m/s", "input"),
    "x": Described("slider_position", "m"),
}
"""What an FMU has by which it is taken for a block; ours to theirs."""


def begun(folder: Path, *variables: Described) -> str:
    return starter(described(folder / "declared.fmu", description("A", variables)))


VOCABULARIES = [Foreign("Plain", "plain", order=1, step=0.01), Foreign("Terse", "terse")]


@pytest.mark.parametrize("fmu", [SLIDER, SLIDER_3, *VOCABULARIES], ids=lambda fmu: fmu.name)
def test_the_guesses_are_those_of_a_person_and_load_back(fmu: Foreign, tmp_path: Path) -> None:
    file = tmp_path / "begun.toml"
    file.write_text(starter(fmu.path), encoding="utf-8")
    assert load_names(file).targets == fmu.names.targets
    assert FmuFile(fmu.path, load_names(file)).variables == fmu.opened().variables


def test_our_own_fmu_is_named_as_it_is(fmu_path: Path) -> None:
    assert tomllib.loads(starter(fmu_path)) == {name: name for name in UNITS}


def test_a_trial_run_tells_more_than_names(tmp_path: Path) -> None:
    swap = edited(('"slider.s"', '"?"'), ('"drive.s"', '"slider.s"'), (r'"\?"', '"drive.s"'))
    named = tomllib.loads(starter(altered(SLIDER.path, tmp_path / "swapped.fmu", swap)))
    assert (named["x"], named["x_pull"]) == ("drive.s", "slider.s")


def test_an_fmu_that_crashes_is_named_by_words_alone() -> None:
    text = starter(misbehaving("crash").path)
    assert "# Words and units alone: a trial run failed" in text
    assert set(tomllib.loads(text)) >= {"m", "k", "x", "F"}


def test_of_what_is_no_block_nothing_is_set(tmp_path: Path) -> None:
    text = begun(tmp_path, *[each for name, each in BLOCK.items() if name != "mu_k"])
    assert tomllib.loads(text) == {}
    assert "# Nothing in it is like mu_k: no stick-slip block" in text


def test_abbreviations_without_a_seam_are_read(tmp_path: Path) -> None:
    names = {"m": "m", "k": "k_spring", "mu_s": "mus", "mu_k": "muk", "v": "vpull", "x": "pos"}
    text = begun(tmp_path, *[BLOCK[o]._replace(name=n, unit="") for o, n in names.items()])
    assert tomllib.loads(text) == names


def test_words_of_the_description_decide_where_names_say_nothing(tmp_path: Path) -> None:
    text = begun(
        tmp_path,
        BLOCK["m"],
        BLOCK["k"],
        Described("p1", "", *PARAMETER, "Coefficient of static friction"),
        Described("p2", "", *PARAMETER, "Coefficient of kinetic friction"),
        Described("u1", "m/s", "input", text="Velocity of the belt"),
        Described("y1", "m", text="Position of the mass"),
        Described("y2", "m", text="Position of the pulled end"),
    )
    expected = {
        "m": "slider.mass",
        "k": "stiffness",
        "mu_s": "p1",
        "mu_k": "p2",
        "v": "u1",
        "x": "y1",
        "x_pull": "y2",
    }
    assert tomllib.loads(text) == expected


LINES = {
    "a mass is no stiffness": ("stiffness kg parameter", '# k = "..."  # spring stiffness'),
    "the only one in kg": ("body kg parameter", 'm = "body"  # mass [kg]; in kg'),
    "two": ("mass1 kg parameter; mass2 kg parameter", '# m = "mass1"  # mass [kg]; or "mass2"'),
    "one of two of ours": ("locked_phase - output Integer", '# sticking = "locked_phase"  # '),
    "what is set is not read": ("position m parameter", '# x = "..."  # position'),
    "no unit": ("spring_force - output", 'F = "spring_force"  # spring force [N], positive along'),
    "counted the other way": (
        "springCompression m output",
        'z = { name = "springCompression", sign = -1 }  # spring extension [m]',
    ),
    "our name for something else": ("T K output", 'T = ""  # time between the last two'),
    "a count": ("slips - output Integer", 'n_slips = "slips"'),
    "a flag is no number": ("stuck - output Boolean", '# t_stick = "..."'),
    "an unknown unit": ("mass stone parameter", '# m = "..."'),
    "inside": ("spring.force - local", 'F = "spring.force"'),
    "both": ("spring.force - local; spring_force - output", 'F = "spring_force"'),
}


@pytest.mark.parametrize("what", LINES)
def test_a_line_is_an_entry_or_a_comment_with_the_alternatives(tmp_path: Path, what: str) -> None:
    rows, line = LINES[what]
    variables = []
    for row in rows.split("; "):
        name, unit, causality, kind = [*row.split(), "Real"][:4]
        varies = "fixed" if causality == "parameter" else "discrete"
        variables.append(Described(name, unit.strip("-"), causality, varies, kind))
    ours = line.removeprefix("# ").partition(" ")[0]
    block = [each for name, each in BLOCK.items() if name != ours]
    text = begun(tmp_path, *block, *variables)
    (found,) = [each for each in text.splitlines() if re.match(rf"(# )?{ours} = .*  # ", each)]
    assert found.startswith(line)


def test_every_variable_of_the_fmu_is_in_the_file_whatever_its_name(tmp_path: Path) -> None:
    strange = "mass \\ \u00e4\U0001f600[1].\u007f"
    text = begun(
        tmp_path,
        *[each for name, each in BLOCK.items() if name != "m"],
        Described(strange, "kg", *PARAMETER),
        Described("oil.pressure", "", *OUTPUT, 'Pressure\nof the "oil"'),
    )
    assert tomllib.loads(text)["m"] == strange
    assert text.endswith('that have no entry\n# oil.pressure (Pressure of the "oil") (output)\n')


def test_where_nothing_is_known_the_file_names_nothing_as_it_stands(tmp_path: Path) -> None:
    file = tmp_path / "begun.toml"
    file.write_text(begun(tmp_path, Described("y", "K", *OUTPUT)), encoding="utf-8")
    with pytest.raises(NamesError, match="names no variable"):
        load_names(file)
