"""The folder of a study: it resumes whatever ended it, and holds one study alone."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from stickslip_design.chunks import StudyError, run
from stickslip_design.chunks.chunk import name_of, packed
from stickslip_design.chunks.manifest import manifest_of
from stickslip_design.chunks.store import store_of
from stickslip_design.chunks.study import Chunk
from tests.interrupting import HEARING
from tests.needs import ROOT, needs

from .toy import Toy, same, times_computed

DRIVER = """\
import signal, sys
from pathlib import Path
from stickslip_design.chunks import plan, run
from tests.design.chunks.toy import Toy
sys.modules["stickslip_design.chunks.run"]._SHORT = 0.0
plan._SECONDS = 0.1
def show(progress):
    print(progress.done, flush=True)
if __name__ == "__main__":
    run(Toy(pace=4e-3, marks=Path(sys.argv[2])), sys.argv[1], workers=2, progress=show)
"""
"""A study of 4 s in chunks of a tenth of a second."""


@pytest.mark.parametrize("by", [signal.SIGKILL, signal.SIGINT])
def test_a_killed_study_resumes(tmp_path: Path, marks: Path, by: signal.Signals) -> None:
    """Its processes end with it, and nothing is computed twice but the chunks that were open."""
    folder, program = tmp_path / "study", tmp_path / "driver.py"
    program.write_text(DRIVER, encoding="utf-8")
    with subprocess.Popen(
        [*HEARING, sys.executable, program, folder, marks],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        start_new_session=True,
    ) as driver:
        assert driver.stdout is not None
        assert any(int(line) > 300 for line in driver.stdout)
        driver.send_signal(by)
        driver.wait(timeout=20)
        until = time.monotonic() + 10.0
        while processes_of(driver.pid) and time.monotonic() < until:
            time.sleep(0.02)
        assert not processes_of(driver.pid)
    computed = times_computed(marks)
    kept = sum(computed.values())
    assert 300 <= kept < 1000
    study = Toy(marks=marks)
    assert same(run(study, str(folder), workers=1), run(Toy(), workers=1))
    again = [point for point, times in times_computed(marks).items() if times > 1]
    # Two chunks of 0.1 s: computed, and their files perhaps not written.
    assert len(again) <= 2 * 8 * 4 + 25
    assert not list(folder.glob(".*.part"))


LONG = """\
import os, time
from stickslip_design.chunks.work import prepare
from stickslip_verification.drive.processes import Worker
if __name__ == "__main__":
    worker = Worker(prepare, (), None)
    worker.give(os.getpid, ())
    while not worker.connection.poll(1.0): pass
    worker.give(time.sleep, (300.0,))
    print(worker.answer(), flush=True)
    time.sleep(300.0)
"""
"""A worker process in a chunk of five minutes."""


def test_a_worker_ends_with_its_study_in_the_middle_of_a_chunk(tmp_path: Path) -> None:
    """However long the chunk takes."""
    program = tmp_path / "long.py"
    program.write_text(LONG, encoding="utf-8")
    with subprocess.Popen(
        [sys.executable, program], stdout=subprocess.PIPE, text=True, start_new_session=True
    ) as driver:
        assert driver.stdout is not None
        worker = int(driver.stdout.readline())
        assert worker in processes_of(driver.pid)
        driver.kill()
        driver.wait(timeout=20)
        until = time.monotonic() + 20.0
        while processes_of(driver.pid) and time.monotonic() < until:
            time.sleep(0.02)
        assert not processes_of(driver.pid)


def processes_of(session: int) -> list[int]:
    """Return the processes of a session that live: proc(5), fields 3 and 6."""
    found = []
    for file in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = file.read_text(encoding="utf-8", errors="replace").rpartition(") ")[2].split()
        except (FileNotFoundError, ProcessLookupError):
            continue
        if int(fields[3]) == session and fields[0] != "Z":
            found.append(int(file.parent.name))
    return found


def cut(file: Path) -> None:
    """Take the last byte of a file."""
    file.write_bytes(file.read_bytes()[:-1])


def alter(file: Path) -> None:
    """Change one bit in the middle of a file."""
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.write_bytes(content)


def empty(file: Path) -> None:
    """Leave nothing of a file but its name."""
    file.write_bytes(b"")


def exchange(file: Path) -> None:
    """Put the file of other points in its place."""
    file.write_bytes(sorted(file.parent.glob("*.chunk"))[0].read_bytes())


@pytest.mark.parametrize("spoil", [cut, alter, empty, exchange, Path.unlink])
def test_a_spoilt_chunk_is_made_anew(
    tmp_path: Path, marks: Path, spoil: Callable[[Path], None]
) -> None:
    """It alone, and the results are as before."""
    study = Toy(200, pace=1e-4, marks=marks)
    folder = tmp_path / "study"
    before = run(study, str(folder), workers=1).read()["x"]
    file = sorted(folder.glob("*.chunk"))[2]
    _, start, stop = file.stem.split("-")
    spoil(file)
    part = folder / ".killed.part"
    part.touch()
    results = run(study, str(folder), workers=1)
    assert results.read()["x"].tobytes() == before.tobytes()
    again = sorted(point for point, times in times_computed(marks).items() if times > 1)
    assert again == list(range(int(start), int(stop)))
    assert not part.exists()


def test_a_late_chunk_that_overlaps_is_dropped(tmp_path: Path) -> None:
    """A worker that outlived its study may write one after another study made its points."""
    results = run(Toy(200), str(tmp_path), workers=1)
    chunk, key = Chunk(8, 48), manifest_of(Toy(200)).key
    (tmp_path / name_of(chunk)).write_bytes(packed(chunk, key, Toy(200).compute(*chunk)))
    assert same(run(Toy(200), str(tmp_path), workers=1), results)
    assert not (tmp_path / name_of(chunk)).exists()


def test_another_study_is_refused_and_named(tmp_path: Path) -> None:
    """The value that changed, the old one and the new one; --fresh computes the new one."""
    run(Toy(), str(tmp_path), workers=1)
    before = contents(tmp_path)
    with pytest.raises(StudyError) as told:
        run(Toy(seed=2), str(tmp_path), workers=1)
    assert str(told.value) == (
        f"{tmp_path} holds results of another study: inputs.toy.seed is 2 and was 1; --fresh "
        "throws them away, another folder keeps them"
    )
    assert contents(tmp_path) == before
    fresh = run(Toy(seed=2), str(tmp_path), workers=1, fresh=True)
    assert same(fresh, run(Toy(seed=2), workers=1))
    assert same(run(Toy(seed=2), str(tmp_path), workers=1), fresh)


@pytest.mark.parametrize("package", ["numpy", "sources"])
def test_other_versions_are_refused_and_named(tmp_path: Path, package: str) -> None:
    """Of a package, or of our own sources."""
    run(Toy(), str(tmp_path), workers=1)
    manifest = tmp_path / "manifest.json"
    content = json.loads(manifest.read_text(encoding="utf-8"))
    now, content["versions"][package] = content["versions"][package], "0.1"
    manifest.write_text(json.dumps(content), encoding="utf-8")
    with pytest.raises(StudyError, match=rf'versions\.{package} is "{now}" and was "0.1"; --fresh'):
        run(Toy(), str(tmp_path), workers=1)


def test_only_its_own_files_are_thrown_away(tmp_path: Path) -> None:
    """Those of a study; a person's notes beside them stay."""
    run(Toy(1000), str(tmp_path), workers=1)
    (tmp_path / "notes.txt").write_text("keep", encoding="utf-8")
    run(Toy(20), str(tmp_path), workers=1, fresh=True)
    assert (tmp_path / "notes.txt").read_text(encoding="utf-8") == "keep"
    assert len(list(tmp_path.glob("*.chunk"))) < 5


@pytest.mark.parametrize("name", ["notes.txt", "manifest.json"])
@pytest.mark.parametrize("fresh", [False, True])
def test_a_folder_of_other_files_is_refused(tmp_path: Path, name: str, fresh: bool) -> None:
    """Even with --fresh, and nothing is written there."""
    (tmp_path / name).write_text("{}", encoding="utf-8")
    with pytest.raises(StudyError, match=name):
        run(Toy(), str(tmp_path), workers=1, fresh=fresh)
    assert list(contents(tmp_path)) == [name]


def contents(folder: Path) -> dict[str, bytes]:
    """Return the files of a folder and what they hold."""
    return {file.name: file.read_bytes() for file in sorted(folder.iterdir())}


def test_one_process_computes_in_a_folder(tmp_path: Path) -> None:
    """A second one is refused, until the first one has ended."""
    with (
        store_of(str(tmp_path)).locked(),
        pytest.raises(StudyError, match="another process computes a study here"),
    ):
        run(Toy(), str(tmp_path), workers=1)
    assert run(Toy(), str(tmp_path), workers=1).count == 1000


@pytest.mark.usefixtures("_short_chunks", "_by_workers_alone")
def test_a_full_disk_names_the_file_and_the_study_resumes(tmp_path: Path, marks: Path) -> None:
    """In a worker process; no part of a file is left."""
    folder = tmp_path / "study"
    with pytest.raises(StudyError) as told:
        run(Toy(pace=1e-4, marks=marks, largest=1500), str(folder), workers=1)
    name, _, rest = str(told.value).partition(": ")
    assert Path(name).parent == folder
    assert Path(name).suffix == ".chunk"
    assert rest == "File too large; what is computed is kept, and the study resumes"
    assert not Path(name).exists()
    assert not list(folder.glob(".*.part"))
    kept = len(list(folder.glob("*.chunk")))
    assert kept > 0
    again = run(Toy(marks=marks), str(folder), workers=2)
    assert len(list(folder.glob("*.chunk"))) > kept
    points = np.arange(1000)
    assert again.read()["x"].tobytes() == np.sin(1.7 * points + 1).tobytes()


def test_a_folder_that_cannot_be_made_is_told(tmp_path: Path) -> None:
    """In one line, with its name."""
    (tmp_path / "file").touch()
    with pytest.raises(StudyError, match=r"/file.*: (Not a directory|File exists)"):
        run(Toy(), str(tmp_path / "file" / "study"), workers=1)


@needs("studies")
def test_an_address_of_fsspec_is_a_folder(marks: Path) -> None:
    """A study there resumes, and a spoilt chunk is made anew."""
    import fsspec

    address = "memory://studies/toy"
    memory = fsspec.filesystem("memory")
    study = Toy(200, pace=1e-4, marks=marks)
    whole = run(Toy(200), workers=1)
    assert same(run(study, address, workers=1), whole)
    files = sorted(memory.glob("/studies/toy/*.chunk"))
    assert len(files) > 3
    memory.rm_file(files[1])
    memory.pipe_file(files[2], memory.cat_file(files[2])[:-9])
    with pytest.raises(StudyError, match=r"inputs\.toy\.over is \[1, 100\] and was \[1, 200\]"):
        run(Toy(100), address, workers=1)
    assert same(run(study, address, workers=1), whole)
    assert sum(times_computed(marks).values()) < 2 * 200
    assert not memory.glob("/studies/toy/.*.part")
    memory.rm("/studies", recursive=True)


@needs("studies")
@pytest.mark.usefixtures("_short_chunks")
def test_workers_that_do_not_see_the_folder_are_told() -> None:
    """As those of a folder that is in the memory of one process."""
    # This process computes until the first worker is there, on a busy machine for long.
    with pytest.raises(StudyError, match=r"the worker on .* does not see the study in memory://"):
        run(Toy(100_000, pace=1e-3), "memory://of-one-process", workers=2)


def test_a_change_far_inside_a_long_value_is_one() -> None:
    """Though a refusal shows the beginning alone."""
    old = manifest_of(Toy())
    one, other = (replace(old, identity={"over": [*range(100), end]}) for end in (1, 2))
    assert one.changes(one) == ""
    assert one.changes(other).startswith("inputs.over is [0, 1, ")


@needs("studies")
def test_an_address_that_cannot_be_used_is_told() -> None:
    """With a protocol that is none."""
    with pytest.raises(StudyError, match=r"nowhere://x: .*[Pp]rotocol"):
        run(Toy(), "nowhere://x", workers=1)
