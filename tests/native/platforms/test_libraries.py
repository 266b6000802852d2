"""The libraries of all platforms, read: exports, what they need, oldest systems, instructions."""

import re
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path

import fmpy
import lief
import pytest

from stickslip_native import packer
from stickslip_native.compiler import compiler_for
from tests.native.test_native_libraries import standard_names
from tests.needs import needs

pytestmark = needs("zig")

LIBRARIES = {
    "binaries/linux64/StickSlip.so",
    "binaries/aarch64-linux/StickSlip.so",
    "binaries/win64/StickSlip.dll",
    "binaries/darwin64/StickSlip.dylib",
    "binaries/aarch64-darwin/StickSlip.dylib",
}
LIBRARIES_3 = {
    "binaries/x86_64-linux/StickSlip.so",
    "binaries/aarch64-linux/StickSlip.so",
    "binaries/x86_64-windows/StickSlip.dll",
    "binaries/x86_64-darwin/StickSlip.dylib",
    "binaries/aarch64-darwin/StickSlip.dylib",
}
# Zig's linker exports the start of the library and the handle of the C runtime on macOS.
OF_THE_LINKER = {"__mh_dylib_header", "___dso_handle"}
MOST_BYTES = 450_000


def libraries(fmu: Path) -> dict[str, bytes]:
    """Return the libraries by their path in the FMU."""
    with zipfile.ZipFile(fmu) as archive:
        names = [name for name in archive.namelist() if name.startswith("binaries/")]
        return {name: archive.read(name) for name in names}


@pytest.fixture(params=[2, 3])
def fmu(request: pytest.FixtureRequest) -> Path:
    """Return the FMU of either version."""
    path: Path = request.getfixturevalue("all_path" if request.param == 2 else "all3_path")
    return path


@pytest.fixture
def names(fmu: Path) -> set[str]:
    """Return the functions of the standard that the FMU exports."""
    return standard_names(3 if "fmi3" in fmu.name else 2)


def test_there_is_a_library_for_each_platform(all_path: Path, all3_path: Path) -> None:
    """Each lies in the folder that FMI names; nothing of the linker lies beside it."""
    assert set(libraries(all_path)) == LIBRARIES
    assert set(libraries(all3_path)) == LIBRARIES_3
    supported = {"c-code", "darwin64", "linux64", "win64"}
    assert set(fmpy.supported_platforms(str(all_path))) == supported
    assert set(fmpy.supported_platforms(str(all3_path))) == supported


def test_on_linux_a_c_library_of_2012_is_enough(fmu: Path, names: set[str]) -> None:
    """Each library asks for versions of glibc up to 2.17, and for nothing but glibc."""
    found = {}
    for name, content in libraries(fmu).items():
        if not name.endswith(".so"):
            continue
        library = lief.ELF.parse(list(content))
        found[str(library.header.machine_type)] = name
        assert {each.name for each in library.exported_symbols} == names
        assert set(library.libraries) <= {"libc.so.6", "libm.so.6"}
        asked = [
            tuple(map(int, version.name.removeprefix("GLIBC_").split(".")))
            for needed in library.symbols_version_requirement
            for version in needed.get_auxiliary_symbols()
        ]
        assert asked
        assert max(asked) <= (2, 17)
        assert library.has_nx
    assert len(found) == 2


def test_on_windows_the_universal_c_runtime_is_enough(fmu: Path, names: set[str]) -> None:
    """The library loads what Windows 10 has, and exports the functions of FMI alone."""
    (content,) = (each for name, each in libraries(fmu).items() if name.endswith(".dll"))
    library = lief.PE.parse(list(content))
    assert library.header.machine == lief.PE.Header.MACHINE_TYPES.AMD64
    assert {each.name for each in library.get_export().entries} == names
    loaded = {each.name.lower() for each in library.imports}
    assert all(each.startswith("api-ms-win-crt-") for each in loaded - {"kernel32.dll"})
    assert not library.has_debug or not re.search(rb"\.pdb", content)


def test_on_macos_version_11_is_enough(fmu: Path, names: set[str], report: list[str]) -> None:
    """Oldest system, name and exports; the code for ARM is signed, as macOS asks there."""
    seen = 0
    for content in (each for name, each in libraries(fmu).items() if name.endswith(".dylib")):
        whole = lief.MachO.parse(list(content))
        for library in whole:
            seen += 1
            arm = library.header.cpu_type == lief.MachO.Header.CPU_TYPE.ARM64
            exported = {each.name for each in library.exported_symbols}
            assert exported - OF_THE_LINKER == {f"_{name}" for name in names}
            assert list(library.build_version.minos)[:2] == [11, 0]
            assert [each.name for each in library.libraries] == [
                "@rpath/StickSlip.dylib",
                "/usr/lib/libSystem.B.dylib",
            ]
            assert library.has_code_signature == arm
    # FMI 2.0: a universal library, and one for ARM alone.
    assert seen == (2 if "fmi3" in fmu.name else 3)
    report.append(f"macOS, {fmu.name}: built, not run; {seen} libraries were read")


def test_no_library_tells_where_it_was_made(fmu: Path) -> None:
    """No path of the sources, of the compiler or of a temporary folder is in it."""
    for name, content in libraries(fmu).items():
        for path in (str(Path(packer.__file__).parent), sys.prefix, str(Path.home()), "/tmp/"):
            # A home of one letter would be found everywhere.
            assert len(path) < 5 or path.encode() not in content, name
        assert not re.search(rb"stickslip-\w{8}", content), name


def code_of(content: bytes) -> Iterator[tuple[bool, bytes]]:
    """Give the instructions of each processor in a library, and whether it is ARM."""
    whole = lief.MachO.parse(list(content)) if lief.is_macho(list(content)) else None
    for library in whole or [lief.parse(list(content))]:
        (section,) = (each for each in library.sections if each.name in (".text", "__text"))
        kind = library.abstract.header.architecture
        yield kind == lief.Header.ARCHITECTURES.ARM64, bytes(section.content)


def test_no_instruction_multiplies_and_adds_at_once(fmu: Path, tmp_path: Path) -> None:
    """A fused multiply-add rounds once where the Python block rounds twice."""
    arm, intel = 0, 0
    for name, content in libraries(fmu).items():
        for is_arm, code in code_of(content):
            if is_arm:
                arm += 1
                words = [int.from_bytes(code[n : n + 4], "little") for n in range(0, len(code), 4)]
                assert len(words) > 1000
                assert not list(filter(fused_on_arm, words)), name
            else:
                intel += 1
                file = tmp_path / "code"
                file.write_bytes(code)
                listing = subprocess.run(
                    ["objdump", "-D", "-b", "binary", "-m", "i386:x86-64", file],
                    capture_output=True,
                    text=True,
                    check=True,
                ).stdout
                assert "mulsd" in listing
                assert not re.search(r"\bvf(n?m(add|sub)|maddsub|msubadd)", listing), name
    assert (arm, intel) == ((2, 3) if "fmi3" in fmu.name else (3, 3))


def fused_on_arm(word: int) -> bool:
    """Whether a word is FMADD, FMSUB, FNMADD, FNMSUB, FMLA or FMLS of doubles or singles."""
    return (
        word & 0xFF000000 == 0x1F000000
        or word & 0xBFA0FC00 in (0x0E20CC00, 0x0EA0CC00)
        or word & 0xAF80F400 in (0x0F801000, 0x0F805000)
    )


@pytest.mark.parametrize(
    "word",
    [
        0x1F420C20,
        0x1F428C20,
        0x1F620C20,
        0x1F628C20,
        0x4E62CC20,
        0x4EE2CC20,
        0x4FC21020,
        0x5FC21020,
    ],
)
def test_the_fused_instructions_of_arm_are_known(word: int) -> None:
    """fmadd, fmsub, fnmadd, fnmsub d0,d1,d2,d3; fmla, fmls v0.2d; fmla v0.2d, d0 by element."""
    assert fused_on_arm(word)
    # fmul d0, d1, d2; fadd d0, d1, d2; ret
    assert not any(map(fused_on_arm, (0x1E620820, 0x1E622820, 0xD65F03C0)))


def test_two_builds_are_the_same_bytes(
    all_path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In other folders the same FMU is made."""
    folder = tmp_path / "a folder with another name"
    folder.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(folder))
    monkeypatch.chdir(folder)
    again = packer.build(folder / "made")
    assert again.read_bytes() == all_path.read_bytes()
    assert [each.name for each in folder.iterdir()] == ["made"]


def test_the_compilers_give_the_same_bits(all_path: Path, native_path: Path) -> None:
    """On Linux x86-64 the library of Zig and that of this machine's compiler compute alike."""
    for values in ({}, {"c": 2.0}, {"c": 90.0, "mu_k": 0.1}):
        one, other = (
            fmpy.simulate_fmu(str(each), stop_time=10.0, start_values=values)
            for each in (all_path, native_path)
        )
        assert one.tobytes() == other.tobytes()


def test_the_licences_of_the_runtime_are_those_of_zig() -> None:
    """Its own, and those of the two C libraries that the library for Windows has parts of."""
    texts = {name: text.decode() for name, (_, text) in compiler_for(False).runtime().items()}
    said = {"zig": "Zig contributors", "musl": "Rich Felker", "mingw-w64": "Zope Public License"}
    assert texts.keys() == said.keys()
    for name, words in said.items():
        assert words in texts[name]


@pytest.mark.parametrize("face", [2, 3])
def test_the_whole_fmu_is_small(face: int, tmp_path: Path, report: list[str]) -> None:
    """With documentation, page, licences and evidence of all cases it has at most 450 kB."""
    command = [sys.executable, "-c", "from stickslip.cli import main; main()"]
    name = "StickSlip_native.fmu" if face == 2 else "StickSlip_native_fmi3.fmu"
    for words in (
        ["build", "--native", "--fmi", str(face), "--bare", "-o", "."],
        ["verify", "--fmu", name, "--pack"],
    ):
        done = subprocess.run([*command, *words], cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
    size = (tmp_path / name).stat().st_size
    report.append(f"{name} for all platforms, with the evidence of all cases: {size} bytes")
    assert size <= MOST_BYTES
