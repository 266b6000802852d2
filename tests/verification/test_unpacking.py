"""An FMU is unpacked within limits, and nowhere but in its folder."""

import stat
import struct
import tracemalloc
import zipfile
from pathlib import Path

import pytest

from stickslip_verification import FmuError
from stickslip_verification.drive import FmuFile
from stickslip_verification.drive import description as unpacking
from tests.makers import SLIDER, described
from tests.python import python

MB = 1_000_000
Stuffing = tuple[str | zipfile.ZipInfo, str | bytes]


def stuffed(folder: Path, *files: Stuffing, method: int = zipfile.ZIP_DEFLATED) -> Path:
    to = folder / "stuffed.fmu"
    with zipfile.ZipFile(SLIDER.path) as old, zipfile.ZipFile(to, "w", method) as new:
        for entry in old.infolist():
            new.writestr(entry, old.read(entry))
        for name, content in files:
            new.writestr(name, content, method, 9)
    return to


def refusal(path: str | Path) -> str:
    with pytest.raises(FmuError) as caught:
        FmuFile(Path(path))
    assert "\n" not in str(caught.value)
    return str(caught.value)


def stating(path: Path, size: int) -> Path:
    content = bytearray(path.read_bytes())
    place = content.find(b"PK\x01\x02")
    while place >= 0:
        struct.pack_into("<I", content, place + 24, size)
        place = content.find(b"PK\x01\x02", place + 4)
    path.write_bytes(content)
    return path


MANY = [(f"resources/{number}.bin", bytes(9 * MB)) for number in range(25)]


@pytest.mark.parametrize(
    ("files", "told"),
    [
        ([("zeros.bin", bytes(50 * MB))], "'zeros.bin' unpacks to 50 MB, more than 200 times its"),
        # What no file does alone, all of them do not do together either.
        (MANY, "it unpacks to 226 MB, more than 200 times"),
        ([("/etc/escaped", b"escaped")], "Illegal path /etc/escaped"),
        ([("C:/escaped", b"escaped")], "Illegal path C:/escaped"),
        ([("..\\escaped", b"escaped")], "Illegal path ..\\escaped"),
    ],
    ids=["bomb", "bombs", "absolute", "drive", "backslash"],
)
def test_bombs_and_files_elsewhere_are_refused_by_name(
    tmp_path: Path, files: list[Stuffing], told: str
) -> None:
    assert told in refusal(stuffed(tmp_path, *files))


def test_more_than_the_limits_is_refused_as_the_archive_states_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = stuffed(tmp_path, *MANY[:3], method=zipfile.ZIP_STORED)
    monkeypatch.setattr(unpacking, "MOST_UNPACKED", 27 * MB)
    assert refusal(path) == f"{path}: unpacks to 28 MB; at most 27 MB are unpacked"
    monkeypatch.setattr(unpacking, "MOST_FILES", 3)
    assert "files; at most 3 are unpacked" in refusal(path)
    monkeypatch.undo()
    assert ",000 MB; at most 2,000 MB are unpacked" in refusal(stating(path, 3_000_000_000))


def test_a_description_beyond_64_megabytes_is_not_read(tmp_path: Path) -> None:
    path = described(tmp_path / "large.fmu", "<!-- -->" * (9 * MB))
    assert refusal(path) == f"{path}: modelDescription.xml has 72 MB; at most 64 MB are read"
    # One that the archive states as a kilobyte is not unpacked to find that out.
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as new:
        new.writestr("modelDescription.xml", bytes(500 * MB))
    stating(path, 1000)
    tracemalloc.start()
    assert "not an FMU" in refusal(path)
    assert tracemalloc.get_traced_memory()[1] < 200 * MB
    tracemalloc.stop()


def test_small_tables_of_zeros_dots_and_links_stay_inside(tmp_path: Path) -> None:
    link = zipfile.ZipInfo("resources/link")
    link.create_system = 3
    link.external_attr = (stat.S_IFLNK | 0o777) << 16
    table = ("resources/table.csv", b"0.0,0.0\n" * MB)
    escaping = ("resources/../../../escaped", b"escaped")
    fmu = FmuFile(stuffed(tmp_path, table, escaping, (link, "/etc")))
    resources = fmu.folder / "resources"
    assert (resources / "table.csv").stat().st_size == 8 * MB
    assert not (fmu.folder.parent / "escaped").exists()
    # A link is unpacked as a file with its target in it.
    assert not (resources / "link").is_symlink()
    assert (resources / "link").read_text(encoding="utf-8") == "/etc"
    fmu.close()


OPENING = "import sys, tests.verification.test_unpacking as of; print(of.refusal(sys.argv[1]))"


def test_a_million_elements_in_each_other_end_no_process(tmp_path: Path) -> None:
    text = f'<fmiModelDescription fmiVersion="2.0"><CoSimulation/>{"<a>" * MB}{"</a>" * MB}'
    path = described(tmp_path / "deep.fmu", f"{text}</fmiModelDescription>")
    assert "not an FMU" in python("-c", OPENING, path).stdout
