"""The native FMU as a file: its description, its libraries, its sources."""

import os
import platform
import re
import shutil
import struct
import sys
from pathlib import Path
from typing import Literal
from xml.etree import ElementTree

import fmpy
import numpy as np
import pytest
from fmpy.build import build_platform_binary

from stickslip_native import packer
from stickslip_native.compiler import FLAGS, Compiler, CompilerError, compiler_for
from stickslip_native.platforms import PLATFORMS, current, universal
from tests.conftest import built
from tests.driver import Fmu, loaded
from tests.native.compiling import run, written
from tests.native.test_native_calls import standard
from tests.needs import needs

needs_cc = needs("cc")
VERSIONS: tuple[Literal[2, 3], ...] = (2, 3)
versions = pytest.mark.parametrize("version", VERSIONS)
laws = pytest.mark.parametrize("law", ["coulomb", "stribeck"])


def native(version: int, law: str = "coulomb") -> Fmu:
    return loaded(built(f"native-{version}", law))


def parts_of(root: ElementTree.Element) -> dict[str, str]:
    texts = {each.tag: ElementTree.tostring(each, encoding="unicode") for each in root}
    return {tag: ElementTree.canonicalize(text, strip_text=True) for tag, text in texts.items()}


@needs_cc
@laws
def test_the_description_is_that_of_the_python_fmu(law: str) -> None:
    ours, theirs = (
        ElementTree.parse(fmu.folder / "modelDescription.xml").getroot()
        for fmu in (native(2, law), Fmu(built("python-2", law)))
    )
    different = {name for name in ours.attrib | theirs.attrib if ours.get(name) != theirs.get(name)}
    assert different == {"guid", "generationTool"}
    categories = {each.get("name") for each in ours.iter("Category")}
    assert categories == {"logStatusWarning", "logStatusError", "logAll"}
    for slave in ours.iter("CoSimulation"):
        assert slave.attrib.pop("canInterpolateInputs") == "true"
        for sources in slave.findall("SourceFiles"):
            slave.remove(sources)
    for slave in theirs.iter("CoSimulation"):
        assert slave.attrib.pop("canInterpolateInputs") == "false"
    one, other = parts_of(ours), parts_of(theirs)
    assert list(one) == list(other)
    assert {tag for tag in one if one[tag] != other[tag]} == {"LogCategories"}


@needs_cc
def test_the_identity_is_made_from_version_sources_and_options(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    two, three = (native(version).token for version in VERSIONS)
    assert two != three
    sources = packer.sources_of(2)
    assert two in sources["identity.h"]
    assert three in packer.sources_of(3)["identity.h"]
    assert two in packer.description(2, sources)
    assert two not in packer.description(2, {**sources, "block.c": sources["block.c"] + b"\n"})
    monkeypatch.setattr(packer, "FLAGS", (*FLAGS, "-ffast-math"))
    assert two not in packer.sources_of(2)["identity.h"]


@needs_cc
@pytest.mark.parametrize("version", ["2", "2me", "3"])
@laws
def test_a_library_exports_the_names_of_fmi_and_needs_the_c_library_alone(
    version: str, law: str
) -> None:
    library = loaded(built(f"native-{version}", law)).binary
    exported = run("nm", "-D", "--defined-only", library).split()[2::3]
    names = standard(int(version[0]), solved=version == "2me")
    assert sorted(exported) == sorted(f"fmi{version[0]}{name}" for name in names)
    dynamic = run("readelf", "--dynamic", "--wide", library)
    assert set(re.findall(r"\(NEEDED\).*\[(.*)\]", dynamic)) <= {"libc.so.6", "libm.so.6"}
    assert not re.search(r"\((RPATH|RUNPATH|TEXTREL)\)", dynamic)
    code = run("objdump", "-d", "--no-show-raw-insn", library)
    operations = {line.split("\t")[1].split()[0] for line in code.splitlines() if "\t" in line}
    assert any("mul" in each for each in operations)
    # A fused multiply-add rounds once where the Python block rounds twice.
    assert not [each for each in operations if "fma" in each or each.startswith(("fnm", "vfnm"))]


@needs_cc
@versions
def test_with_a_prefix_the_sources_can_be_linked_statically(
    version: Literal[2, 3], tmp_path: Path
) -> None:
    flags = [flag for flag in FLAGS if flag != "-s"]
    for file in written(packer.sources_of(version), tmp_path):
        define = f"-DFMI{version}_FUNCTION_PREFIX=one_"
        run("cc", *flags, "-O0", define, "-c", file, "-o", file.with_suffix(".o"))
    whole = tmp_path / "whole"
    run("ld", "-r", "-o", whole, *tmp_path.glob("*.o"))
    run("objcopy", "--localize-hidden", whole)
    seen = run("nm", "--defined-only", "--extern-only", whole).split()[2::3]
    assert set(seen) == {f"one_fmi{version}{name}" for name in standard(version)}


STRICT = ("-std=c99", "-pedantic-errors", "-Werror", "-Wall", "-Wextra", "-Wconversion",
          "-Wdouble-promotion", "-fanalyzer", "-O2", "-c", "-o", os.devnull)  # fmt: skip


@needs_cc
@pytest.mark.parametrize(
    ("version", "law"), [(2, "coulomb"), (3, "stribeck"), (2, "lugre"), (3, "rate_state")]
)
def test_the_sources_compile_without_a_warning(version: int, law: str) -> None:
    files = sorted((native(version, law).folder / "sources").glob("*.c"))
    assert len(files) > 10
    for file in files:
        run("cc", *STRICT, file)


@needs_cc
@pytest.mark.parametrize(
    ("version", "law"), [(2, "stribeck"), pytest.param(3, "coulomb", marks=pytest.mark.soak)]
)
def test_fmpy_compiles_the_sources_to_an_fmu_with_the_same_motion(
    version: int, law: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # CMake comes with FMPy, and its program lies beside Python's. It asks for a compiler of C++,
    # which nothing here is compiled with.
    monkeypatch.setenv("PATH", os.pathsep.join([str(Path(sys.executable).parent), os.defpath]))
    without_cxx = {"CMAKE_CXX_COMPILER:FILEPATH": "cc", "CMAKE_CXX_COMPILER_WORKS:BOOL": "ON"}
    folder, work = tmp_path / "fmu", tmp_path / "work"
    shutil.copytree(native(version, law).folder, folder)
    shutil.rmtree(folder / "binaries")
    work.mkdir()
    build_platform_binary(folder, work, cmake_options=without_cxx)
    compiled, packed = (
        fmpy.simulate_fmu(str(fmu), stop_time=3.0, start_values={"c": 2.0})
        for fmu in (folder, built(f"native-{version}", law))
    )
    assert packed["n_slips"][-1] > 5
    for name in packed.dtype.names:
        # FMPy's compiler options are not ours: products may be rounded otherwise.
        scale = np.max(np.abs(packed[name])) or 1.0
        np.testing.assert_allclose(compiled[name], packed[name], rtol=0.0, atol=1e-11 * scale)


@needs_cc
def test_the_bytes_do_not_tell_where_they_were_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = built("native-2").read_bytes()
    folder = tmp_path / "another folder, with a longer name than that of the others"
    folder.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(folder))
    monkeypatch.chdir(folder)
    again = packer.build(folder / "made", this_machine=True)
    assert again.read_bytes() == expected
    assert [each.name for each in folder.iterdir()] == ["made"]


@needs_cc
def test_a_source_that_does_not_compile_is_named_in_one_line() -> None:
    compiler = compiler_for(this_machine=True)
    with pytest.raises(CompilerError, match=r"\Acc: wrong\.c:1:.*error.*\Z") as caught:
        compiler.library({"wrong.c": b"int x = ;\n"}, "wrong", compiler.platforms[0])
    assert "\n" not in str(caught.value)


def test_a_cache_that_cannot_be_written_is_named(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    # Zig itself would never end.
    (tmp_path / "file").touch()
    monkeypatch.setenv("ZIG_GLOBAL_CACHE_DIR", str(tmp_path / "file" / "cache"))
    words = r"file/cache cannot be written \(Not a directory\); .* ZIG_GLOBAL_CACHE_DIR\Z"
    with pytest.raises(CompilerError, match=words):
        Compiler(("true",), PLATFORMS, is_zig=True).library({}, "StickSlip", PLATFORMS[0])


@pytest.mark.parametrize(
    ("machine", "expected"),
    [
        ("linux x86_64", "x86_64-linux"),
        ("linux aarch64", "aarch64-linux"),
        ("win32 AMD64", "x86_64-windows"),
        ("darwin x86_64", "x86_64-darwin"),
        ("darwin arm64", "aarch64-darwin"),
        ("linux riscv64", None),
        ("win32 ARM64", None),
    ],
)
def test_a_machine_is_known_by_system_and_processor(
    machine: str, expected: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    system, processor = machine.split()
    monkeypatch.setattr(sys, "platform", system)
    monkeypatch.setattr(platform, "machine", lambda: processor)
    found = current()
    assert (found and found.fmi3) == expected


def test_a_universal_library_holds_each_library_aligned_to_its_pages() -> None:
    intel, arm = (each for each in PLATFORMS if each.system == "darwin")
    # Mach-O: the number of the processor, and pages of 4 kB, on ARM of 16 kB.
    expected = {intel: (0x01000007, 4096), arm: (0x0100000C, 16384)}
    libraries = {intel: b"intel" * 1000, arm: b"arm" * 2000}
    whole = universal(libraries)
    assert struct.unpack(">2I", whole[:8]) == (0xCAFEBABE, 2)
    end = 8 + 20 * 2
    for n, (each, content) in enumerate(libraries.items()):
        kind, _, start, size, power = struct.unpack_from(">5I", whole, 8 + 20 * n)
        assert (kind, 2**power) == expected[each]
        assert start % 2**power == 0
        assert start >= end
        assert whole[start : start + size] == content
        end = start + size
    assert len(whole) == end
