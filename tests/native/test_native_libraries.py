"""The libraries in the native FMU: what they export, what they need, and where they lie."""

import platform
import re
import struct
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import pytest

from stickslip_native import packer
from stickslip_native.compiler import FLAGS, Compiler, CompilerError, compiler_for
from stickslip_native.platforms import PLATFORMS, current, universal
from tests.needs import needs

HEADERS = Path(fmpy.__file__).parent / "c-code"


def standard_names(face: int) -> set[str]:
    """Return the functions that a library for co-simulation exports.

    FMI 2.0 asks for those of its own interface types alone, FMI 3.0 for all.
    """
    text = (HEADERS / f"fmi{face}Functions.h").read_text(encoding="utf-8")
    if face == 2:
        text, found = re.subn(r"(?s)Functions for FMI2 for Model Exchange.*?(?=/\*{20})", "", text)
        assert found == 2
    return set(re.findall(rf"#define (fmi{face}\w+) +fmi{face}FullName", text))


def library_of(fmu: Path, folder: Path) -> Path:
    """Unpack the library of this machine."""
    with zipfile.ZipFile(fmu) as archive:
        (name,) = [name for name in archive.namelist() if name.startswith("binaries/")]
        return Path(archive.extract(name, folder))


def output_of(*words: object) -> str:
    """Return what a program prints."""
    command = [str(word) for word in words]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


@needs("cc")
def test_exactly_the_names_of_fmi_are_exported(either_native: Path, tmp_path: Path) -> None:
    """No function of the block is visible, and none of the standard is missing."""
    library = library_of(either_native, tmp_path)
    exported = output_of("nm", "-D", "--defined-only", library).split()[2::3]
    face = 3 if "fmi3" in either_native.name else 2
    assert set(exported) == standard_names(face)
    assert len(exported) == len(set(exported)) > 30


@needs("cc")
def test_the_library_needs_the_c_library_alone(either_native: Path, tmp_path: Path) -> None:
    """Nothing else is loaded with it, and no path is searched or recorded."""
    library = library_of(either_native, tmp_path)
    dynamic = output_of("readelf", "--dynamic", "--wide", library)
    needed = set(re.findall(r"\(NEEDED\).*\[(.*)\]", dynamic))
    assert needed <= {"libc.so.6", "libm.so.6"}
    assert not re.search(r"\((RPATH|RUNPATH|TEXTREL)\)", dynamic)
    content = library.read_bytes()
    for path in (packer.__file__, tmp_path, "/tmp/", "stickslip-"):
        assert str(path).encode() not in content


@needs("cc")
def test_the_library_lies_where_fmpy_looks(native_path: Path, native3_path: Path) -> None:
    """In FMI 2.0 under the name of the platform, in FMI 3.0 under its tuple."""
    for fmu, folder in ((native_path, fmpy.platform), (native3_path, fmpy.platform_tuple)):
        with zipfile.ZipFile(fmu) as archive:
            names = [name for name in archive.namelist() if name.startswith("binaries/")]
        assert names == [f"binaries/{folder}/StickSlip{fmpy.sharedLibraryExtension}"]


@needs("cc")
@pytest.mark.parametrize("face", [2, 3])
def test_two_copies_can_be_linked_statically(face: int, tmp_path: Path) -> None:
    """With a prefix, as the standard has it, a program calls both; the rest can be local."""
    for name, content in packer.sources_of(2 if face == 2 else 3).items():
        (tmp_path / name).write_bytes(content)
    sources = sorted(tmp_path.glob("*.c"))
    objects = []
    flags = [flag for flag in FLAGS if flag != "-s"]
    for prefix in ("first_", "second_"):
        folder = tmp_path / prefix
        folder.mkdir()
        define = f"-DFMI{face}_FUNCTION_PREFIX={prefix}"
        subprocess.run(["cc", *flags, define, "-c", *sources], cwd=folder, check=True)
        whole = folder / "whole.o"
        subprocess.run(["ld", "-r", "-o", whole, *folder.glob("*.o")], check=True)
        subprocess.run(["objcopy", "--localize-hidden", whole], check=True)
        seen = set(output_of("nm", "--defined-only", "--extern-only", whole).split()[2::3])
        assert seen == {prefix + name for name in standard_names(face)}
        objects.append(whole)
    (tmp_path / "main").mkdir()
    main = tmp_path / "main" / "main.c"
    main.write_text(
        "#include <stdio.h>\n"
        f"const char *first_fmi{face}GetVersion(void);\n"
        f"const char *second_fmi{face}GetVersion(void);\n"
        "int main(void)\n{\n"
        f'    printf("%s %s", first_fmi{face}GetVersion(), second_fmi{face}GetVersion());\n'
        f"    return first_fmi{face}GetVersion == second_fmi{face}GetVersion;\n}}\n",
        encoding="utf-8",
    )
    subprocess.run(["cc", "-o", tmp_path / "both", main, *objects, "-lm"], check=True)
    assert output_of(tmp_path / "both") == f"{face}.0 {face}.0"


def test_fmi_2_has_a_folder_for_each_platform() -> None:
    """FMI 2.0.4, section 2.3: three names for x86-64, elsewhere the tuples of FMI 3.0."""
    named = {"x86_64-linux": "linux64", "x86_64-windows": "win64", "x86_64-darwin": "darwin64"}
    for each in PLATFORMS:
        (folder,) = each.folders(3)
        assert folder == f"{each.processor}-{each.system}"
        assert named.get(folder, folder) in each.folders(2)
    # FMPy looks there on every Mac.
    assert all("darwin64" in each.folders(2) for each in PLATFORMS if each.system == "darwin")


@pytest.mark.parametrize(
    ("system", "processor", "tuple_"),
    [
        ("linux", "x86_64", "x86_64-linux"),
        ("linux", "aarch64", "aarch64-linux"),
        ("win32", "AMD64", "x86_64-windows"),
        ("darwin", "x86_64", "x86_64-darwin"),
        ("darwin", "arm64", "aarch64-darwin"),
        ("linux", "riscv64", None),
        ("win32", "ARM64", None),
        ("freebsd14", "amd64", None),
    ],
)
def test_a_machine_is_known_by_system_and_processor(
    system: str, processor: str, tuple_: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where a library for the machine can be built, it is the one that runs there."""
    monkeypatch.setattr(sys, "platform", system)
    monkeypatch.setattr(platform, "machine", lambda: processor)
    found = current()
    assert (None if found is None else found.fmi3) == tuple_


def test_a_universal_library_holds_each_library_aligned() -> None:
    """The table names processor, place, size and alignment of each; the content is as given."""
    intel, arm = (each for each in PLATFORMS if each.system == "darwin")
    libraries = {intel: b"intel" * 1000, arm: b"arm" * 2000}
    whole = universal(libraries)
    magic, count = struct.unpack(">2I", whole[:8])
    assert (magic, count) == (0xCAFEBABE, 2)
    end = 8 + 20 * count
    for n, (each, content) in enumerate(libraries.items()):
        kind, _, start, size, alignment = struct.unpack_from(">5I", whole, 8 + 20 * n)
        assert kind == {"x86_64": 0x01000007, "aarch64": 0x0100000C}[each.processor]
        # Pages of 4 kB, on ARM of 16 kB.
        assert 2**alignment == {"x86_64": 4096, "aarch64": 16384}[each.processor]
        assert start % 2**alignment == 0
        assert start >= end
        assert whole[start : start + size] == content
        end = start + size
    assert len(whole) == end


@needs("cc")
def test_the_bytes_do_not_tell_where_they_were_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Temporary folders and working folders of other names, and another time, give the same."""
    built = []
    for folder in (tmp_path / "a", tmp_path / "another folder, and a longer name"):
        folder.mkdir()
        monkeypatch.setattr("tempfile.tempdir", str(folder))
        monkeypatch.chdir(folder)
        fmu = packer.build(folder / "made" / "x.fmu", {"a.txt": b"part"}, this_machine=True)
        built.append(fmu.read_bytes())
        assert [each.name for each in folder.iterdir()] == ["made"]
    assert built[0] == built[1]


@needs("cc")
def test_a_source_that_does_not_compile_is_named_in_one_line() -> None:
    """The message is the compiler's first error, with the file."""
    compiler = compiler_for(this_machine=True)
    with pytest.raises(CompilerError, match=r"\Acc: wrong\.c:1:.*error.*\Z") as caught:
        compiler.library({"wrong.c": b"int x = ;\n"}, "wrong", compiler.platforms[0])
    assert "\n" not in str(caught.value)


def test_a_cache_that_cannot_be_written_is_named(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The message names the folder, and the variable for another one; Zig itself never ends."""
    (tmp_path / "file").touch()
    monkeypatch.setenv("ZIG_GLOBAL_CACHE_DIR", str(tmp_path / "file" / "cache"))
    zig = Compiler(("true",), PLATFORMS, is_zig=True)
    told = r"file/cache cannot be written \(Not a directory\); .* ZIG_GLOBAL_CACHE_DIR\Z"
    with pytest.raises(CompilerError, match=told):
        zig.library({}, "StickSlip", PLATFORMS[0])
