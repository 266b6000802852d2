"""An FMU as a file: what can be opened, and what is said of what cannot."""

import re
import zipfile
from pathlib import Path

import fmpy
import pytest

from stickslip_verification.drive.fmu.archive import FmuFile, available, missing, require
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.fmu.names import NameMap, Target
from stickslip_verification.drive.fmu.unpacking import new_folder
from stickslip_verification.model.quantities import OUTPUT_NAMES
from tests.verification.foreign.building import altered, build

FMI_1 = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="1.0" modelName="A" modelIdentifier="A" guid="1"
 numberOfContinuousStates="0" numberOfEventIndicators="0">
 <ModelVariables/>
</fmiModelDescription>
"""


def refusal(path: Path, names: NameMap | None = None) -> str:
    """Return what is said when the file cannot be opened."""
    with pytest.raises(FmuError) as caught:
        FmuFile(path, names)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_what_is_no_fmu_is_told(tmp_path: Path) -> None:
    """A missing file, a folder, a text and an archive of something else are no FMU."""
    text = tmp_path / "text.fmu"
    text.write_text("hello", encoding="utf-8")
    archive = tmp_path / "archive.fmu"
    with zipfile.ZipFile(archive, "w") as new:
        new.writestr("readme.txt", "hello")
    broken = tmp_path / "broken.fmu"
    with zipfile.ZipFile(broken, "w") as new:
        new.writestr("modelDescription.xml", "<fmiModelDescription>")
    assert refusal(tmp_path / "none.fmu") == f"{tmp_path / 'none.fmu'}: no such file"
    assert refusal(tmp_path) == f"{tmp_path}: not an FMU (not a file)"
    assert refusal(text) == f"{text}: not an FMU (not a zip archive)"
    assert refusal(archive) == f"{archive}: not an FMU (no modelDescription.xml in it)"
    assert refusal(broken).startswith(f"{broken}: not an FMU (")


def test_fmi_1_is_refused(tmp_path: Path) -> None:
    """An FMU 1.0 is told its version and which versions can be driven."""
    path = tmp_path / "old.fmu"
    with zipfile.ZipFile(path, "w") as new:
        new.writestr("modelDescription.xml", FMI_1)
    assert refusal(path) == f"{path}: is FMI 1.0; this suite drives FMI 2.0 and 3.0"


def test_model_exchange_alone_is_refused(model_exchange_fmu: Path) -> None:
    """An FMU without the interface that drives itself says which one it has."""
    said = f"{model_exchange_fmu}: has no co-simulation interface, only model exchange"
    assert refusal(model_exchange_fmu) == said


def test_an_fmu_for_another_platform_is_refused(slider_mm: Path, tmp_path: Path) -> None:
    """Without a binary for this machine, those that there are are told."""
    here = {"linux64": "linux64", "win64": "win64"}[fmpy.platform]
    other = "win64" if here == "linux64" else "linux64"
    path = altered(slider_mm, tmp_path / "other.fmu", keep=lambda name: f"/{here}/" not in name)
    assert refusal(path) == f"{path}: is not for this platform, {here}; it has {other}"
    none = altered(slider_mm, tmp_path / "none.fmu", keep=lambda name: "binaries" not in name)
    assert refusal(none) == f"{none}: is not for this platform, {here}; it has no binary"


def test_a_damaged_archive_is_refused(slider_mm: Path, tmp_path: Path) -> None:
    """An archive whose contents do not have their checksum is told with the file in it."""
    path = tmp_path / "damaged.fmu"
    content = slider_mm.read_bytes()
    assert b"ExactBlock" in content
    path.write_bytes(content.replace(b"ExactBlock", b"eXACTbLOCK"))
    assert refusal(path).startswith(f"{path}: cannot be unpacked (Bad CRC-32 for file")


def test_a_library_that_cannot_be_loaded_is_told(slider_mm: Path, tmp_path: Path) -> None:
    """A binary that is none is an error of the FMU, and the process stays where it was."""
    path = tmp_path / "garbage.fmu"
    with zipfile.ZipFile(slider_mm) as old, zipfile.ZipFile(path, "w") as new:
        for entry in old.infolist():
            binary = entry.filename.startswith("binaries/")
            new.writestr(entry, b"garbage" if binary else old.read(entry))
    folder = Path.cwd()
    with pytest.raises(FmuError, match=r"^garbage.fmu: Failed to load shared library [^\n]*$"):
        FmuFile(path).instantiate()
    assert Path.cwd() == folder


def test_what_an_fmu_can_is_read_from_its_description(
    slider_mm: Path, slider_si: Path, fmu_path: Path
) -> None:
    """Version and handling of state are those that the FMU declares."""
    declared = {
        path.stem: (fmu.fmi_version, fmu.can_get_and_set_state, fmu.can_serialize_state)
        for path, fmu in ((path, FmuFile(path)) for path in (slider_mm, slider_si, fmu_path))
    }
    assert declared == {
        "SliderMm": ("2.0", False, False),
        "SliderSi": ("3.0", True, True),
        fmu_path.stem: ("2.0", True, True),
    }


def test_the_block_has_all_variables_and_no_other_output(fmu_path: Path) -> None:
    """Our own FMU gives every output of the suite in SI, no other, and breaks no rule of FMI."""
    fmu = FmuFile(fmu_path)
    assert available(fmu, OUTPUT_NAMES) == list(OUTPUT_NAMES)
    assert fmu.extra_outputs == ()
    assert fmu.problems == ()
    assert all(variable.conversion.leaves_alone for variable in fmu.variables.values())


def test_start_values_are_read_in_si(slider_mm: Path, slider_mm_names: NameMap) -> None:
    """A start value in foreign units is ours once converted."""
    variables = FmuFile(slider_mm, slider_mm_names).variables
    starts = {name: variables[name].start for name in ("m", "g", "k", "mu_s", "v")}
    assert starts == {"m": 1.0, "g": 9.81, "k": 1000.0, "mu_s": 0.5, "v": 0.02}


def test_what_is_missing_is_told_with_what_to_do(slider_mm: Path, foreign_fmu: Path) -> None:
    """An FMU without the variables of a stick-slip block says which, and how to name them."""
    assert missing(FmuFile(foreign_fmu)) == ["m", "mu_s", "mu_k", "v", "x"]
    with pytest.raises(FmuError) as caught:
        require(FmuFile(slider_mm), ["x", "v"])
    told = "map them with --names (`stickslip names` begins the file); it has "
    assert str(caught.value).startswith(f"{slider_mm}: has no variable x, v; {told}")


def test_a_description_that_breaks_a_rule_is_told_and_used(slider_si: Path, tmp_path: Path) -> None:
    """An FMU 3.0 without its independent variable breaks the standard and can be driven."""
    path = altered(
        slider_si,
        tmp_path / "timeless.fmu",
        lambda text: re.sub(r'(?s)<Float64[^>]*causality="independent"[^>]*/>', "", text),
    )
    assert FmuFile(path).problems == ("Exactly one independent variable must be defined.",)


def changed(fmu: Path, to: Path, old: str, new: str) -> Path:
    """Return a copy of an FMU with one piece of its description replaced."""

    def replace(text: str) -> str:
        assert old in text
        return text.replace(old, new)

    return altered(fmu, to, replace)


def test_a_unit_of_another_dimension_is_refused(
    slider_mm: Path, slider_mm_names: NameMap, tmp_path: Path
) -> None:
    """A spring rate that is declared in newtons names itself, its unit and the expected one."""
    path = changed(slider_mm, tmp_path / "a.fmu", 'unit="N/mm"', 'unit="N"')
    said = refusal(path, slider_mm_names)
    assert said.startswith("a.fmu: k ('spring.rate') is in 'N', which is not a unit like 'N/m'")


def test_an_angular_frequency_is_no_frequency(slider_mm: Path, tmp_path: Path) -> None:
    """Radians per second are not taken for hertz, which are 2 pi of them."""
    path = changed(
        slider_mm,
        tmp_path / "a.fmu",
        '<BaseUnit s="1" factor="0.001"/>',
        '<BaseUnit s="-1" rad="1"/>',
    )
    assert "f ('cycle.period') is in 'ms'" in refusal(path, NameMap({"f": Target("cycle.period")}))


def test_an_unknown_unit_can_be_given(
    slider_mm: Path, slider_mm_names: NameMap, tmp_path: Path
) -> None:
    """A unit that nobody defines is told with the line for the names file, and that line helps."""
    undefined = r'<Unit name="kN">\s*<BaseUnit[^>]*/>\s*</Unit>'
    path = altered(
        slider_mm,
        tmp_path / "a.fmu",
        lambda text: re.sub(undefined, '<Unit name="klbf"/>', text).replace(
            'unit="kN"', 'unit="klbf"'
        ),
    )
    said = refusal(path, slider_mm_names)
    assert "the unit 'klbf' of F ('spring.force') is not known; give one in the names file" in said
    helped = NameMap({**slider_mm_names.targets, "F": Target("spring.force", "kN")})
    assert FmuFile(path, helped).variables["F"].conversion.to_si(2.0) == 2000.0


def test_a_unit_may_come_from_the_declared_type(
    slider_mm: Path, slider_mm_names: NameMap, tmp_path: Path
) -> None:
    """A variable without a unit of its own has that of its type."""
    types = (
        '<TypeDefinitions><SimpleType name="Force"><Real unit="kN"/></SimpleType></TypeDefinitions>'
    )
    path = altered(
        slider_mm,
        tmp_path / "a.fmu",
        lambda text: text.replace("</UnitDefinitions>", f"</UnitDefinitions>{types}").replace(
            'unit="kN"', 'declaredType="Force"', text.count('unit="kN"')
        ).replace('<Real declaredType="Force"/></SimpleType>', '<Real unit="kN"/></SimpleType>'),
    )  # fmt: skip
    fmu = FmuFile(path, slider_mm_names)
    assert fmu.problems == ()
    assert fmu.variables["F"].unit == "kN"
    assert fmu.variables["F"].conversion.to_si(1.0) == 1000.0


def test_the_folder_goes_with_the_file(slider_mm: Path) -> None:
    """What was extracted is gone once the file is closed."""
    fmu = FmuFile(slider_mm)
    assert any(fmu.folder.iterdir())
    fmu.close()
    assert not fmu.folder.exists()


def test_an_array_is_refused(slider_si: Path, slider_si_names: NameMap, tmp_path: Path) -> None:
    """A quantity that the FMU gives as an array cannot be one of ours."""
    path = altered(
        slider_si,
        tmp_path / "a.fmu",
        lambda text: re.sub(
            r'(<Float64 [^>]*name="jump"[^>]*)/>', r'\1><Dimension start="1"/></Float64>', text
        ),
    )
    said = refusal(path, slider_si_names)
    assert said == "a.fmu: delta_x ('jump') is an array; only scalars can be verified"


def test_a_text_is_no_number(slider_mm: Path, tmp_path: Path, slider_mm_names: NameMap) -> None:
    """A variable that holds a text cannot be one of ours."""
    path = altered(
        slider_mm,
        tmp_path / "a.fmu",
        lambda text: re.sub(r'(?s)(name="phase".*?)<Integer\s*/>', r"\1<String/>", text, count=1),
    )
    assert refusal(path, slider_mm_names) == "a.fmu: mode ('phase') is of type String, not a number"


def test_the_maps_of_the_sliders_leave_nothing_out(
    slider_mm: Path, slider_mm_names: NameMap, slider_poor: Path, slider_poor_names: NameMap
) -> None:
    """Every output of the slider is one of ours; the poor one has two of them."""
    assert FmuFile(slider_mm, slider_mm_names).extra_outputs == ()
    poor = FmuFile(slider_poor, slider_poor_names)
    assert available(poor, OUTPUT_NAMES) == ["x", "F"]
    assert poor.extra_outputs == ()


def test_another_name_makes_another_fmu(tmp_path: Path) -> None:
    """A foreign FMU under another name says so in its description, and has what was set."""
    fmu = FmuFile(build("misbehaving", tmp_path, "Another", {"WHAT": "'raise'"}))
    assert fmu.model_identifier == "Another"


def test_it_is_unpacked_where_the_wrapper_can_read_the_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A blank in the name of the temporary folder is fine; an umlaut or a # is walked around."""
    for name, kept in (("a b", True), ("ü", False), ("a#b", False)):
        folder = tmp_path / name
        folder.mkdir()
        monkeypatch.setattr("tempfile.tempdir", str(folder))
        made = new_folder()
        made.rmdir()
        assert (made.parent == folder) is kept


def test_no_plain_folder_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where there is none, the reason names the folder and what to set."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "ü"))
    monkeypatch.setattr("stickslip_verification.drive.fmu.unpacking._ELSEWHERE", ())
    with pytest.raises(FmuError, match=r"ü: FMUs made with pythonfmu .* set TMPDIR"):
        new_folder()
