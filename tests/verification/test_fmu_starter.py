"""The names file to begin with: guesses by unit, sort and words, and what is not sure."""

import re
import tomllib
import zipfile
from collections.abc import Sequence
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, tostring

import pytest

from stickslip_verification import FmuError, NamesError, load_names, starter
from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.names import UNITS, NameMap

# Name, unit ("" for none), causality, type, description.
Row = tuple[str, str, str, str, str]

BASES: dict[str, dict[str, str]] = {
    "kg": {"kg": "1"},
    "m": {"m": "1"},
    "m/s": {"m": "1", "s": "-1"},
    "J": {"kg": "1", "m": "2", "s": "-2"},
    "K": {"K": "1"},
}


def declared(folder: Path, *rows: Row) -> Path:
    """Write an FMU that is a description and nothing else."""
    root = Element("fmiModelDescription", fmiVersion="2.0", modelName="A", guid="1")
    SubElement(root, "CoSimulation", modelIdentifier="A")
    units = SubElement(root, "UnitDefinitions")
    for unit, base in BASES.items():
        SubElement(SubElement(units, "Unit", name=unit), "BaseUnit", base)
    variables = SubElement(root, "ModelVariables")
    for number, (name, unit, causality, kind, text) in enumerate(rows):
        sort = {"causality": causality, "variability": "discrete"}
        if causality == "parameter":
            sort["variability"] = "fixed"
        naming = {"name": name, "valueReference": str(number), "description": text}
        scalar = SubElement(variables, "ScalarVariable", {**naming, **sort})
        SubElement(scalar, kind, {"unit": unit} if unit else {})
    SubElement(root, "ModelStructure")
    fmu = folder / "declared.fmu"
    with zipfile.ZipFile(fmu, "w") as archive:
        archive.writestr("modelDescription.xml", tostring(root))
    return fmu


def begun(folder: Path, *rows: Row) -> str:
    """Return the names file that is begun for an FMU of these variables."""
    return starter(declared(folder, *rows))


def entries(text: str) -> dict[str, object]:
    """Return the entries of a names file."""
    return tomllib.loads(text)


@pytest.mark.parametrize("slider", ["slider_mm", "slider_si"])
def test_the_guesses_are_those_of_a_person(
    slider: str, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    """Of two FMUs with names of their own every variable is found, and the file loads back."""
    fmu: Path = request.getfixturevalue(slider)
    names: NameMap = request.getfixturevalue(f"{slider}_names")
    file = tmp_path / "begun.toml"
    file.write_text(starter(fmu), encoding="utf-8")
    assert dict(load_names(file).targets) == dict(names.targets)
    assert FmuFile(fmu, load_names(file)).variables == FmuFile(fmu, names).variables


def test_our_own_fmu_is_named_as_it_is(fmu_path: Path) -> None:
    """A variable of our name is that variable."""
    assert entries(starter(fmu_path)) == {name: name for name in UNITS}


def test_words_of_the_description_decide_where_names_say_nothing(tmp_path: Path) -> None:
    """Letters and digits as names, and what they are in words."""
    text = begun(
        tmp_path,
        ("p1", "", "parameter", "Real", "Coefficient of static friction"),
        ("p2", "", "parameter", "Real", "Coefficient of kinetic friction"),
        ("u1", "m/s", "input", "Real", "Velocity of the belt"),
        ("y1", "m", "output", "Real", "Position of the mass"),
        ("y2", "m", "output", "Real", "Position of the pulled end"),
    )
    assert entries(text) == {"mu_s": "p1", "mu_k": "p2", "v": "u1", "x": "y1", "x_pull": "y2"}


@pytest.mark.parametrize(
    ("rows", "name", "line"),
    [
        # A mass is no stiffness, whatever it is called.
        ([("stiffness", "kg", "parameter", "Real", "")], "k", '# k = "..."  # spring stiffness'),
        # Only one has kg: no word is needed.
        ([("body", "kg", "parameter", "Real", "")], "m", 'm = "body"  # mass [kg]; in kg'),
        # Two masses.
        (
            [("mass1", "kg", "parameter", "Real", ""), ("mass2", "kg", "parameter", "Real", "")],
            "m",
            '# m = "mass1"  # mass [kg]; or "mass2"',
        ),
        # One variable, and two of ours that it may be.
        (
            [("locked_phase", "", "output", "Integer", "")],
            "sticking",
            '# sticking = "locked_phase"  # whether the mass sticks',
        ),
        # What is set is not read.
        ([("position", "m", "parameter", "Real", "")], "x", '# x = "..."  # position'),
        (
            [("spring_force", "", "output", "Real", "")],
            "F",
            'F = "spring_force"  # spring force [N], positive along the pull; no unit declared, '
            "so this one is assumed",
        ),
        (
            [("springCompression", "m", "output", "Real", "")],
            "z",
            'z = { name = "springCompression", sign = -1 }  # spring extension [m]',
        ),
        # Read as it is, it would be refused.
        (
            [("T", "K", "output", "Real", "of the bearing")],
            "T",
            'T = ""  # time between the last two break-aways [s]; of the FMU: T [K] (of the '
            "bearing), something else",
        ),
        # A count is no length of time, and a flag no number.
        ([("slips", "", "output", "Integer", "")], "n_slips", 'n_slips = "slips"'),
        ([("slips", "", "output", "Integer", "")], "t_slip", '# t_slip = "..."'),
        ([("stuck", "", "output", "Boolean", "")], "t_stick", '# t_stick = "..."'),
        # A unit that nobody knows has to be given by a person.
        ([("mass", "stone", "parameter", "Real", "")], "m", '# m = "..."'),
    ],
)
def test_each_line_says_what_is_known(
    tmp_path: Path, rows: Sequence[Row], name: str, line: str
) -> None:
    """An entry where one variable fits, a comment with the alternatives where not."""
    text = begun(tmp_path, *rows)
    (found,) = [each for each in text.splitlines() if re.match(rf"(# )?{name} = .*  # ", each)]
    assert found.startswith(line)


def test_a_variable_inside_stands_behind_an_output(tmp_path: Path) -> None:
    """A local variable is taken where no output is as likely."""
    force = ("spring.force", "", "local", "Real", "")
    assert entries(begun(tmp_path, force)) == {"F": "spring.force"}
    output = ("spring_force", "", "output", "Real", "")
    assert entries(begun(tmp_path, force, output)) == {"F": "spring_force"}


def test_every_variable_of_the_fmu_is_in_the_file(tmp_path: Path) -> None:
    """What has no entry is listed at the end, to be copied."""
    text = begun(
        tmp_path,
        ("heat", "J", "output", "Real", ""),
        ("oil.pressure", "", "output", "Real", 'Pressure\nof the "oil"'),
    )
    assert text.endswith('that have no entry\n# oil.pressure (Pressure of the "oil") (output)\n')
    assert entries(text) == {"Q_friction": "heat"}


def test_strange_names_load_back(tmp_path: Path) -> None:
    """Quotes, backslashes and letters from anywhere are written as TOML has them."""
    name = "mass \\ \u00e4\U0001f600[1].\u007f"
    text = begun(tmp_path, (name, "kg", "parameter", "Real", ""))
    assert entries(text) == {"m": name}


def test_where_nothing_is_known_a_person_has_to_write(tmp_path: Path) -> None:
    """The file lists what there is; as it stands it names nothing, which is told."""
    file = tmp_path / "begun.toml"
    file.write_text(begun(tmp_path, ("y", "K", "output", "Real", "")), encoding="utf-8")
    with pytest.raises(NamesError, match="names no variable"):
        load_names(file)


def test_what_is_no_fmu_is_refused(tmp_path: Path) -> None:
    """As for every other use."""
    with pytest.raises(FmuError, match="no such file"):
        starter(tmp_path / "none.fmu")
