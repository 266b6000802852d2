"""What goes wrong with importers, and what docs/importing.md says of it."""

from __future__ import annotations

import re
import string
from pathlib import Path

import pytest

from tests.importers.running import ImporterError, ask, preload, run
from tests.needs import each, needs

DOCUMENT = Path(__file__).parents[2] / "docs" / "importing.md"
SAFE = string.ascii_letters + string.digits + "_.-~ "
"""The characters that docs/importing.md calls safe in the name of a folder."""
UNSAFE = sorted({*string.punctuation, "é"} - {*SAFE, "/"})


def unpacked_in(folder: Path, importer: str, fmu_path: Path) -> object:
    """Make the folder, and have an importer unpack and step the FMU there."""
    folder.mkdir()
    return ask("abilities", "begin", fmu_path, folder, argument=importer).answer


def crashes_in(folder: Path, importer: str, fmu_path: Path) -> bool:
    """Whether a signal ends the process of that importer."""
    with pytest.raises(ImporterError) as caught:
        unpacked_in(folder, importer, fmu_path)
    return caught.value.code < 0


@pytest.mark.parametrize("importer", each(["fmpy", "libcosimpy"]))
def test_safe_characters_of_a_folder_are_safe(
    importer: str, fmu_path: Path, tmp_path: Path
) -> None:
    """A folder whose name holds all safe characters does no harm."""
    assert unpacked_in(tmp_path / SAFE, importer, fmu_path)


@pytest.mark.parametrize("character", UNSAFE)
def test_every_other_character_of_a_folder_ends_fmpy(
    character: str, fmu_path: Path, tmp_path: Path
) -> None:
    """One such character in the name of the folder, and the process crashes."""
    assert crashes_in(tmp_path / f"a{character}b", "fmpy", fmu_path)


@needs("libcosimpy")
@pytest.mark.parametrize("name", ["(x86)", "a+b", "a@b"])
def test_such_a_character_ends_libcosim(name: str, fmu_path: Path, tmp_path: Path) -> None:
    """Libcosim encodes the address as FMPy does."""
    assert crashes_in(tmp_path / name, "libcosimpy", fmu_path)


def test_the_document_names_what_is_safe() -> None:
    """The characters that the document calls safe, and those it warns of, are those tried here."""
    [_, told] = DOCUMENT.read_text(encoding="utf-8").split(
        "\n- **Put the FMU where the path is safe.**"
    )
    safe, _, unsafe = told.partition("\n- ")[0].partition("Of the resource URI")
    assert {*re.findall("`(.)`", safe), " "} == {"/", *SAFE} - {
        *string.ascii_letters,
        *string.digits,
    }
    assert {*re.findall("`(.)`", unsafe)} == {*"%#?()+,&'=@[]!$"}


def test_fmpy_takes_a_sloping_input_at_the_beginning_of_each_step(
    fmu_path: Path, tmp_path: Path
) -> None:
    """Over a step the block holds the speed that the table has at its beginning."""
    _, x_pull = ask("traps", "ramp", fmu_path, tmp_path).answer
    assert x_pull == pytest.approx([0.0, 0.0, 0.01, 0.03], abs=1e-15)


def test_fmpy_changes_a_parameter_that_has_a_column(fmu_path: Path, tmp_path: Path) -> None:
    """The stiffness of the table acts from the step that begins at its time."""
    F, z = ask("traps", "tunable", fmu_path, tmp_path).answer
    stiffness = [force / extension for force, extension in zip(F[1:], z[1:], strict=True)]
    assert stiffness == pytest.approx([1e3, 1e3, 2e3, 2e3], rel=1e-15)


@needs("fmucontainer")
def test_a_container_leaves_what_is_over_for_the_next_step(fmu_path: Path, tmp_path: Path) -> None:
    """With 0.015 s for a container of 0.01 s the block shows 0.01, 0.03, 0.04 and 0.06 s."""
    x_pull = ask("traps", "coarse", fmu_path, tmp_path).answer
    reached = [0.0, 0.01, 0.03, 0.04, 0.06]
    assert x_pull == pytest.approx([0.02 * time for time in reached], abs=1e-15)


@needs("ecospy")
def test_ecos_keeps_a_pending_input_over_a_reset(fmu_path: Path, tmp_path: Path) -> None:
    """What is set just before a reset acts in the first step after it."""
    assert ask("traps", "pending", fmu_path, tmp_path).answer == pytest.approx(0.05 * 0.01)


@needs("proxyfmu")
def test_a_reset_through_proxyfmu_stops_the_block(fmu_path: Path, tmp_path: Path) -> None:
    """Ecos reports nothing, and in ten steps of the second run the pulled end does not move."""
    answer = ask("traps", "standing_still", fmu_path, tmp_path, preload("proxyfmu")).answer
    before, begun, after = answer
    assert before == pytest.approx(0.001)
    assert begun == after


@needs("ecospy")
def test_ecos_shows_zeros_for_a_block_that_refused(fmu_path: Path, tmp_path: Path) -> None:
    """Time goes on, every output and even the mass is 0; the message is on standard error."""
    said = ask("traps", "all_zero", fmu_path, tmp_path)
    time, *rest = said.answer
    assert time == pytest.approx(0.52)
    assert rest == [0.0] * 5
    assert "StickSlip: k = -1.0 N/m is out of range" in said.err


@needs("proxyfmu")
def test_without_libpython_ecos_crashes_in_proxyfmu(fmu_path: Path, tmp_path: Path) -> None:
    """A process that is not Python cannot load the block, and Ecos does not survive that."""
    with pytest.raises(ImporterError, match="Unable to bind") as caught:
        run("proxyfmu", fmu_path, "default", tmp_path, {"LD_PRELOAD": ""})
    # The socket that nobody removes after the crash.
    for left in re.findall(r"using handle '([^']+)'", str(caught.value)):
        Path(left).unlink(missing_ok=True)
    assert caught.value.code < 0


@needs("ecospy")
def test_ecos_needs_a_library_of_the_system() -> None:
    """The library of ecospy asks the system for libtbb.so.12 and does not bring it."""
    import ecospy

    binaries = Path(ecospy.__file__).parent / "binaries"
    assert b"libtbb.so.12\0" in (binaries / "libecosc.so").read_bytes()
    assert not list(binaries.glob("libtbb*"))
