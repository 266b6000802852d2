"""An FMU as a file: what is opened, what is refused and in what words."""

import zipfile
from collections.abc import Callable
from pathlib import Path

import fmpy
import pytest

from stickslip_verification import FmuError, NameMap
from stickslip_verification.drive import FmuFile
from stickslip_verification.drive.description import Target, new_folder
from stickslip_verification.drive.instance import require
from tests.makers import ODD, POOR, RENAMED, SLIDER, SLIDER_3, Foreign, altered, described, edited

HERE, ELSEWHERE = fmpy.platform, {"linux64": "win64"}.get(fmpy.platform, "linux64")
FMI_1 = '<fmiModelDescription fmiVersion="1.0" modelName="A" modelIdentifier="A" guid="1"/>'
TO_EXCHANGE = edited(("CoSimulation", "ModelExchange"), (r' canHandleVar\w+="\w+"', ""))


def damaged(to: Path) -> Path:
    content = SLIDER.path.read_bytes()
    assert b"ForeignBlock" in content
    to.write_bytes(content.replace(b"ForeignBlock", b"fOREIGNbLOCK"))
    return to


def no_fmu(to: Path) -> Path:
    with zipfile.ZipFile(to, "w") as archive:
        archive.writestr("readme.txt", "hello")
    return to


def text(to: Path) -> Path:
    to.write_text("hello", encoding="utf-8")
    return to


NOT_OPENED: dict[str, tuple[Callable[[Path], Path], str]] = {
    "no file": (lambda to: to, ": no such file"),
    "a folder": (lambda to: to.parent, ": not an FMU (not a file)"),
    "a text": (text, ": not an FMU (not a zip archive)"),
    "another archive": (no_fmu, ": not an FMU (no modelDescription.xml in it)"),
    "broken": (lambda to: described(to, "<fmiModelDescription>"), ": not an FMU (no element found"),
    "other XML": (lambda to: described(to, "<a/>"), ": not an FMU (modelDescription.xml is no"),
    "FMI 1.0": (lambda to: described(to, FMI_1), ": is FMI 1.0; this suite drives FMI 2.0 and 3.0"),
    "model exchange": (
        lambda to: altered(SLIDER.path, to, TO_EXCHANGE),
        ": has no co-simulation interface, only model exchange",
    ),
    "for elsewhere": (
        lambda to: altered(SLIDER.path, to, keep=lambda name: f"/{HERE}/" not in name),
        f": is not for this platform, {HERE}; it has {ELSEWHERE}",
    ),
    "damaged": (damaged, ": cannot be unpacked (Bad CRC-32 for file"),
}


@pytest.mark.parametrize("what", NOT_OPENED)
def test_what_cannot_be_driven_is_refused_on_one_line(tmp_path: Path, what: str) -> None:
    make, words = NOT_OPENED[what]
    path = make(tmp_path / "a.fmu")
    with pytest.raises(FmuError) as caught:
        FmuFile(path)
    assert str(caught.value).startswith(f"{path}{words}")
    assert "\n" not in str(caught.value)


def test_a_library_that_cannot_be_loaded_is_told(tmp_path: Path) -> None:
    path, folder = tmp_path / "garbage.fmu", Path.cwd()
    with zipfile.ZipFile(SLIDER.path) as old, zipfile.ZipFile(path, "w") as new:
        for entry in old.infolist():
            binary = entry.filename.startswith("binaries/")
            new.writestr(entry, b"garbage" if binary else old.read(entry))
    with pytest.raises(FmuError, match=r"^garbage.fmu: Failed to load shared library [^\n]*$"):
        FmuFile(path).instantiate()
    assert Path.cwd() == folder


UNKNOWN_UNIT = edited(
    (r'<Unit name="kN">\s*<BaseUnit[^>]*/>\s*</Unit>', '<Unit name="klbf"/>'),
    ('unit="kN"', 'unit="klbf"'),
)
TYPE = '<TypeDefinitions><SimpleType name="P"><Real unit="kN"/></SimpleType></TypeDefinitions>'
OF_A_TYPE = edited(
    (r'(name="spring.force"[^>]*>\s*)<Real[^>]*/>', r'\1<Real declaredType="P"/>'),
    ("</UnitDefinitions>", f"</UnitDefinitions>{TYPE}"),
)
STIFFNESS_IN_N = edited(('unit="N/mm"', 'unit="N"'))
ARRAY = edited((r'(<Float64 [^>]*name="jump"[^>]*)/>', r'\1><Dimension start="1"/></Float64>'))
TEXT = edited((r'(name="phase"[^>]*>\s*)<Integer\s*/>', r"\1<String/>"))
LOST = {"x": "slider.q", "F": "none"}
MISFITS = [
    (SLIDER, STIFFNESS_IN_N, {}, "k ('spring.rate') is in 'N', which is not"),
    (SLIDER, UNKNOWN_UNIT, {}, "the unit 'klbf' of F ('spring.force') is not known; give one in"),
    (SLIDER_3, ARRAY, {}, "delta_x ('jump') is an array; only scalars can be verified"),
    (SLIDER, TEXT, {}, "mode ('phase') is of type String, not a number"),
    (SLIDER, str, {"x": "spring.rate", "k": ""}, "x ('spring.rate') must be an output, not a"),
    (SLIDER, str, {"v": "slider.v", "x_dot": ""}, "v ('slider.v') must be a parameter or an input"),
    (SLIDER, str, LOST, "has no variable 'slider.q' for x, 'none' for F; it"),
]


@pytest.mark.parametrize(("fmu", "description", "names", "words"), MISFITS)
def test_a_variable_that_cannot_be_ours_is_refused_by_both_names(
    tmp_path: Path,
    fmu: Foreign,
    description: Callable[[str], str],
    names: dict[str, str],
    words: str,
) -> None:
    path = altered(fmu.path, tmp_path / "a.fmu", description)
    targets = {**fmu.names.targets, **{ours: Target(name) for ours, name in names.items()}}
    with pytest.raises(FmuError) as caught:
        FmuFile(path, NameMap(targets))
    assert str(caught.value).startswith(f"a.fmu: {words}")


def test_a_unit_comes_from_the_names_file_or_from_a_type(tmp_path: Path) -> None:
    unknown = altered(SLIDER.path, tmp_path / "unknown.fmu", UNKNOWN_UNIT)
    helped = NameMap({**SLIDER.names.targets, "F": Target("spring.force", "kN")})
    typed = altered(SLIDER.path, tmp_path / "typed.fmu", OF_A_TYPE)
    for file in (FmuFile(unknown, helped), FmuFile(typed, SLIDER.names)):
        assert file.variables["F"].conversion.to_si(2.0) == 2000.0


def test_what_an_fmu_can_is_read_from_its_description(fmu_path: Path, tmp_path: Path) -> None:
    no_time = edited((r'<Float64[^>]*causality="independent"[^>]*/>', ""))
    timeless = altered(SLIDER_3.path, tmp_path / "timeless.fmu", no_time)
    files = (SLIDER.opened(), SLIDER_3.opened(), FmuFile(fmu_path), FmuFile(timeless))
    told = [(f.fmi_version, f.can_get_and_set_state, f.can_serialize_state) for f in files]
    assert told == [("2.0", False, False), ("3.0", True, True), ("2.0", True, True), told[1]]
    # It breaks the standard and can be driven.
    assert [bool(file.problems) for file in files] == [False, False, False, True]


def test_start_values_are_read_in_si() -> None:
    variables = SLIDER.opened().variables
    starts = {name: variables[name].start for name in ("m", "g", "k", "mu_s", "v")}
    assert starts == {"m": 1.0, "g": 9.81, "k": 1000.0, "mu_s": 0.5, "v": 0.02}


def test_what_a_block_needs_and_an_fmu_lacks_is_listed() -> None:
    with pytest.raises(FmuError, match="has no variable m, mu_s, mu_k, v, x; map them"):
        require(ODD.opened())
    require(POOR.opened())
    require(RENAMED.opened())


def test_names_that_are_ours_need_no_map_and_are_not_taken_twice() -> None:
    guessed, mapped = ODD.opened(NameMap()), ODD.opened(NameMap({"x": Target("z")}))
    left_out = ODD.opened(NameMap({"z": Target("")}))
    assert (set(guessed.variables), guessed.extra_outputs) == ({"k", "z"}, ())
    assert (set(mapped.variables), mapped.extra_outputs) == ({"k", "x"}, ())
    assert (set(left_out.variables), left_out.extra_outputs) == ({"k"}, ("z",))


def test_what_was_unpacked_goes_with_the_file() -> None:
    file = SLIDER.opened()
    assert any(file.folder.iterdir())
    file.close()
    assert not file.folder.exists()


@pytest.mark.parametrize(("name", "used"), [("a b", True), ("ü", False), ("a#b", False)])
def test_it_is_unpacked_where_the_wrapper_can_read_the_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, used: bool
) -> None:
    (tmp_path / name).mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / name))
    made = new_folder()
    made.rmdir()
    assert (made.parent == tmp_path / name) is used
    if not used:
        monkeypatch.setattr("stickslip_verification.drive.description._ELSEWHERE", ())
        with pytest.raises(FmuError, match=r"made with pythonfmu .* set TMPDIR"):
            new_folder()
