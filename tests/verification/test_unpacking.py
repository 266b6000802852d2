"""An FMU is unpacked within limits, and nowhere but in its folder."""

import re
import stat
import struct
import subprocess
import sys
import tracemalloc
import zipfile
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import pytest

from stickslip_verification.drive.fmu import unpacking
from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.errors import FmuError

DEFLATED = zipfile.ZIP_DEFLATED
MB = 1_000_000


@pytest.fixture
def stuffed(slider_mm: Path, tmp_path: Path) -> Callable[..., Path]:
    """Return what writes the slider with more files: name or entry to what is in each."""

    def write(
        *files: tuple[str | zipfile.ZipInfo, str | bytes], method: int = DEFLATED, level: int = 9
    ) -> Path:
        to = tmp_path / "stuffed.fmu"
        with zipfile.ZipFile(slider_mm) as old, zipfile.ZipFile(to, "w", DEFLATED) as new:
            for entry in old.infolist():
                new.writestr(entry, old.read(entry))
            for name, content in files:
                new.writestr(name, content, method, level)
        return to

    return write


def refusal(path: Path) -> str:
    """Return why an FMU is not opened."""
    with pytest.raises(FmuError) as caught:
        FmuFile(path)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_a_file_that_grows_too_much_is_refused(stuffed: Callable[..., Path]) -> None:
    """Fifty megabytes of zeros are told by name; nothing is unpacked."""
    path = stuffed(("resources/zeros.bin", bytes(50 * MB)))
    assert refusal(path) == (
        f"{path}: its file 'resources/zeros.bin' unpacks to 50 MB, more than 200 times its packed "
        "size"
    )


def test_a_small_table_of_zeros_is_no_bomb(stuffed: Callable[..., Path]) -> None:
    """A file that packs to a thousandth is unpacked as long as it is small."""
    fmu = FmuFile(stuffed(("resources/table.csv", b"0.0,0.0\n" * MB)))
    assert (fmu.folder / "resources" / "table.csv").stat().st_size == 8 * MB
    fmu.close()


def test_many_small_bombs_are_one(stuffed: Callable[..., Path]) -> None:
    """What no file does alone, all of them do not do together either."""
    bombs = [(f"resources/{number}.bin", bytes(9 * MB)) for number in range(25)]
    assert "it unpacks to 226 MB, more than 200 times" in refusal(stuffed(*bombs))


def overlapping(path: Path, size: int) -> Path:
    """Have all entries of an archive say that they unpack to `size` bytes."""
    content = bytearray(path.read_bytes())
    place = content.find(b"PK\x01\x02")
    while place >= 0:
        struct.pack_into("<I", content, place + 24, size)
        place = content.find(b"PK\x01\x02", place + 4)
    path.write_bytes(content)
    return path


def test_more_than_two_gigabytes_are_refused(
    stuffed: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The sum of all files counts, as the archive states it, at any ratio."""
    noise = [(f"resources/{number}.bin", bytes(9 * MB)) for number in range(3)]
    monkeypatch.setattr(unpacking, "MOST_UNPACKED", 27 * MB)
    path = stuffed(*noise, method=zipfile.ZIP_STORED)
    assert refusal(path) == f"{path}: unpacks to 28 MB; at most 27 MB are unpacked"
    monkeypatch.undo()
    path = overlapping(path, 3_000_000_000)
    told = re.search(r"unpacks to (\d+),000 MB; at most 2,000 MB are unpacked", refusal(path))
    assert told is not None
    assert int(told[1]) % 3 == 0


def test_a_large_description_is_refused(slider_mm: Path, tmp_path: Path) -> None:
    """Seventy megabytes of description are not read, however small they are packed."""
    path = tmp_path / "large.fmu"
    with zipfile.ZipFile(path, "w", DEFLATED) as new:
        new.writestr("modelDescription.xml", b"<!-- -->" * (9 * MB))
    assert refusal(path) == (f"{path}: modelDescription.xml has 72 MB; at most 64 MB are read")


def test_a_description_that_says_less_than_it_is_takes_no_memory(tmp_path: Path) -> None:
    """Most of a gigabyte that the archive states as a kilobyte is not unpacked to find that out."""
    path = tmp_path / "lying.fmu"
    with zipfile.ZipFile(path, "w", DEFLATED) as new, new.open("modelDescription.xml", "w") as one:
        for _ in range(500):
            one.write(bytes(MB))
    overlapping(path, 1000)
    tracemalloc.start()
    assert "not an FMU" in refusal(path)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 200 * MB


def test_too_many_files_are_refused(
    stuffed: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Empty files take room as well."""
    monkeypatch.setattr(unpacking, "MOST_FILES", 100)
    path = stuffed(*((f"resources/{number}", b"") for number in range(200)))
    assert "files; at most 100 are unpacked" in refusal(path)


@pytest.mark.parametrize("name", ["/etc/escaped", "C:/escaped", "..\\escaped"])
def test_a_path_elsewhere_is_refused(stuffed: Callable[..., Path], name: str) -> None:
    """A file with the name of one elsewhere is not unpacked, and its name is told."""
    assert f"Illegal path {name}" in refusal(stuffed((name, b"escaped")))


def test_a_path_upwards_stays_inside(stuffed: Callable[..., Path]) -> None:
    """Dots that lead out of the folder are left out."""
    fmu = FmuFile(stuffed(("resources/../../../escaped", b"escaped")))
    assert not (fmu.folder.parent / "escaped").exists()
    assert [file.name for file in fmu.folder.rglob("escaped")] == ["escaped"]
    fmu.close()


def test_a_link_is_a_text(stuffed: Callable[..., Path]) -> None:
    """A symbolic link is unpacked as a file with its target in it, and leads nowhere."""
    link = zipfile.ZipInfo("resources/link")
    link.create_system = 3
    link.external_attr = (stat.S_IFLNK | 0o777) << 16
    fmu = FmuFile(stuffed((link, "/etc"), ("resources/other", b"fine")))
    assert not (fmu.folder / "resources" / "link").is_symlink()
    assert (fmu.folder / "resources" / "link").read_text(encoding="utf-8") == "/etc"
    fmu.close()


BILLION = """<?xml version="1.0"?>
<!DOCTYPE d [<!ENTITY a "{text}">{entities}]>
<fmiModelDescription fmiVersion="2.0" modelName="&{last};"/>
"""


def test_an_entity_of_entities_is_refused(tmp_path: Path) -> None:
    """A billion laughs in a description end it."""
    entities = "".join(
        f'<!ENTITY {name} "{10 * f"&{of};"}">' for of, name in pairwise("abcdefghij")
    )
    path = tmp_path / "laughs.fmu"
    with zipfile.ZipFile(path, "w") as new:
        text = BILLION.format(text="laugh" * 10, entities=entities, last="j")
        new.writestr("modelDescription.xml", text)
    assert "not an FMU" in refusal(path)


def test_a_deep_description_is_refused(tmp_path: Path) -> None:
    """A million elements in each other neither end the process nor pass."""
    path = tmp_path / "deep.fmu"
    with zipfile.ZipFile(path, "w", DEFLATED) as new:
        head, tail = '<fmiModelDescription fmiVersion="2.0">', "</fmiModelDescription>"
        text = f"{head}<CoSimulation/>{'<a>' * MB}{'</a>' * MB}{tail}"
        new.writestr("modelDescription.xml", text)
    code = (
        "import sys\nfrom pathlib import Path\n"
        "from stickslip_verification import FmuError\n"
        "from stickslip_verification.drive.fmu.archive import FmuFile\n"
        "try:\n    FmuFile(Path(sys.argv[1]))\n"
        "except FmuError as error:\n    print(error)\n"
    )
    run = subprocess.run([sys.executable, "-c", code, path], capture_output=True, text=True)
    assert run.returncode == 0, run.returncode
    assert "not an FMU" in run.stdout
