"""The libraries of all platforms, read: exports, what they need, oldest systems, instructions."""

import re
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Literal

import fmpy
import lief
import pytest

from stickslip_native import packer
from stickslip_native.compiler import compiler_for
from tests.conftest import built
from tests.native.compiling import run
from tests.native.platforms.conftest import for_all
from tests.native.test_native_calls import standard
from tests.needs import needs

pytestmark = needs("zig")

Version = Literal[2, 3]
versions = pytest.mark.parametrize("version", [2, 3])

FOLDERS = {
    2: {"linux64", "aarch64-linux", "win64", "darwin64", "aarch64-darwin"},
    3: {"x86_64-linux", "aarch64-linux", "x86_64-windows", "x86_64-darwin", "aarch64-darwin"},
}
# Zig's linker exports the start of the library and the handle of the C runtime on macOS.
OF_THE_LINKER = {"__mh_dylib_header", "___dso_handle"}
MOST_BYTES = 450_000


def libraries(version: Version, suffix: str = "") -> dict[str, bytes]:
    with zipfile.ZipFile(for_all(version)) as archive:
        names = [each for each in archive.namelist() if each.startswith("binaries/")]
        return {name: archive.read(name) for name in names if name.endswith(suffix)}


def exports(version: Version) -> set[str]:
    return {f"fmi{version}{name}" for name in standard(version)}


@versions
def test_there_is_a_library_for_each_platform_and_nothing_beside_it(version: Version) -> None:
    places = [name.split("/") for name in libraries(version)]
    assert {folder for _, folder, _ in places} == FOLDERS[version]
    assert {name for *_, name in places} == {f"StickSlip.{end}" for end in ("so", "dll", "dylib")}
    assert len(places) == len(FOLDERS[version])
    supported = set(fmpy.supported_platforms(str(for_all(version))))
    assert supported == {"c-code", "darwin64", "linux64", "win64"}


@versions
def test_on_linux_a_c_library_of_2012_is_enough(version: Version) -> None:
    found = [lief.ELF.parse(list(content)) for content in libraries(version, ".so").values()]
    assert len({str(each.header.machine_type) for each in found}) == 2
    for library in found:
        assert {each.name for each in library.exported_symbols} == exports(version)
        assert set(library.libraries) <= {"libc.so.6", "libm.so.6"}
        asked = [
            tuple(map(int, symbol.name.removeprefix("GLIBC_").split(".")))
            for needed in library.symbols_version_requirement
            for symbol in needed.get_auxiliary_symbols()
        ]
        assert max(asked) <= (2, 17)
        assert library.has_nx


@versions
def test_on_windows_the_universal_c_runtime_is_enough(version: Version) -> None:
    (content,) = libraries(version, ".dll").values()
    library = lief.PE.parse(list(content))
    assert library.header.machine == lief.PE.Header.MACHINE_TYPES.AMD64
    assert {each.name for each in library.get_export().entries} == exports(version)
    loaded = {each.name.lower() for each in library.imports}
    assert all(each.startswith("api-ms-win-crt-") for each in loaded - {"kernel32.dll"})
    assert not library.has_debug or not re.search(rb"\.pdb", content)


@versions
def test_on_macos_version_11_is_enough_and_code_for_arm_is_signed(version: Version) -> None:
    contents = libraries(version, ".dylib").values()
    found = [each for content in contents for each in lief.MachO.parse(list(content))]
    # FMI 2.0: a universal library, and one for ARM alone.
    assert len(found) == (3 if version == 2 else 2)
    for library in found:
        names = {each.name for each in library.exported_symbols} - OF_THE_LINKER
        assert names == {f"_{name}" for name in exports(version)}
        assert list(library.build_version.minos)[:2] == [11, 0]
        needed = [each.name for each in library.libraries]
        assert needed == ["@rpath/StickSlip.dylib", "/usr/lib/libSystem.B.dylib"]
        arm = library.header.cpu_type == lief.MachO.Header.CPU_TYPE.ARM64
        assert library.has_code_signature == arm


def code_of(content: bytes) -> Iterator[tuple[bool, bytes]]:
    """Yield the instructions of each processor in a library, and whether it is ARM."""
    whole = lief.MachO.parse(list(content)) if lief.is_macho(list(content)) else None
    for library in whole or [lief.parse(list(content))]:
        (section,) = (each for each in library.sections if each.name in (".text", "__text"))
        kind = library.abstract.header.architecture
        yield kind == lief.Header.ARCHITECTURES.ARM64, bytes(section.content)


def fused_on_arm(word: int) -> bool:
    """Whether a word is FMADD, FMSUB, FNMADD, FNMSUB, FMLA or FMLS of doubles or singles."""
    return (
        word & 0xFF000000 == 0x1F000000
        or word & 0xBFA0FC00 in (0x0E20CC00, 0x0EA0CC00)
        or word & 0xAF80F400 in (0x0F801000, 0x0F805000)
    )


@versions
def test_no_instruction_multiplies_and_adds_at_once(version: Version, tmp_path: Path) -> None:
    # fmadd, fmsub, fnmadd, fnmsub d0,d1,d2,d3; fmla, fmls v0.2d; fmla v0.2d, d0 by element ...
    fused = (0x1F420C20, 0x1F428C20, 0x1F620C20, 0x1F628C20, 0x4E62CC20, 0x4EE2CC20, 0x4FC21020)
    assert all(map(fused_on_arm, (*fused, 0x5FC21020)))
    # ... but not fmul d0, d1, d2; fadd d0, d1, d2; ret.
    assert not any(map(fused_on_arm, (0x1E620820, 0x1E622820, 0xD65F03C0)))
    counts = {True: 0, False: 0}
    for name, content in libraries(version).items():
        for is_arm, code in code_of(content):
            counts[is_arm] += 1
            if is_arm:
                words = [int.from_bytes(code[n : n + 4], "little") for n in range(0, len(code), 4)]
                assert len(words) > 1000
                assert not list(filter(fused_on_arm, words)), name
            else:
                file = tmp_path / "code"
                file.write_bytes(code)
                listing = run("objdump", "-D", "-b", "binary", "-m", "i386:x86-64", file)
                assert "mulsd" in listing
                assert not re.search(r"\bvf(n?m(add|sub)|maddsub|msubadd)", listing), name
    assert counts == {True: 3 if version == 2 else 2, False: 3}


def test_the_bytes_do_not_tell_where_they_were_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = for_all().read_bytes()
    folder = tmp_path / "a folder with another name"
    folder.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(folder))
    monkeypatch.chdir(folder)
    assert packer.build(folder / "made").read_bytes() == expected
    assert [each.name for each in folder.iterdir()] == ["made"]
    for name, content in libraries(2).items():
        for path in (str(Path(packer.__file__).parent), sys.prefix, str(Path.home())):
            # A home of one letter would be found everywhere.
            assert len(path) < 5 or path.encode() not in content, name


@needs("cc")
@pytest.mark.parametrize("values", [{}, {"c": 2.0}, {"c": 90.0, "mu_k": 0.1}])
def test_zig_and_the_compiler_of_this_machine_give_the_same_bits(values: dict[str, float]) -> None:
    one, other = (
        fmpy.simulate_fmu(str(each), stop_time=10.0, start_values=values)
        for each in (for_all(), built("native-2"))
    )
    assert one.tobytes() == other.tobytes()


def test_the_licences_of_the_runtime_are_those_of_zig_and_two_c_libraries() -> None:
    texts = {name: text.decode() for name, (_, text) in compiler_for(False).runtime().items()}
    words = {"zig": "Zig contributors", "musl": "Rich Felker", "mingw-w64": "Zope Public License"}
    assert texts.keys() == words.keys()
    assert all(words[name] in text for name, text in texts.items())


@versions
def test_the_whole_fmu_is_small(version: Version, tmp_path: Path) -> None:
    # With documentation, page, licences and evidence of all cases.
    fmu = tmp_path / f"StickSlip_native{'_fmi3' if version == 3 else ''}.fmu"
    command = [sys.executable, "-c", "from stickslip.cli import main; main()"]
    run(*command, "build", "--native", "--fmi", version, "--bare", "-o", fmu)
    run(*command, "verify", "--fmu", fmu, "--pack", cwd=tmp_path)
    assert fmu.stat().st_size <= MOST_BYTES
