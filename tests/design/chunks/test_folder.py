"""The folder of a study: it resumes whatever ended it, and holds one study alone."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from stickslip_design.chunks import Progress, StudyError, run
from stickslip_design.chunks.store import Chunk, Store, compute, manifest_of
from stickslip_design.datasets import digest_of
from tests.design.chunks.toy import Toy, same, times_computed
from tests.interrupting import HEARING
from tests.needs import ROOT, needs

DRIVER = """\
import sys
from pathlib import Path
from stickslip_design.chunks import run
from tests.design.chunks.toy import Toy
def show(progress):
    print(progress.done, flush=True)
if __name__ == "__main__":
    study = Toy(20_000, pace=4e-3, pace_of_workers=4e-4, marks=Path(sys.argv[2]),
                hangs=sys.argv[3] == "hang")
    run(study, sys.argv[1], workers=2, progress=show)
"""


@pytest.mark.parametrize(
    ("workers", "by"),
    [("work", signal.SIGKILL), ("work", signal.SIGINT), ("hang", signal.SIGKILL)],
)
def test_workers_end_with_a_study_that_is_killed_and_it_resumes(
    tmp_path: Path, marks: Path, workers: str, by: signal.Signals
) -> None:
    folder, program = tmp_path / "study", tmp_path / "driver.py"
    program.write_text(DRIVER, encoding="utf-8")
    with subprocess.Popen(
        [*HEARING, sys.executable, program, folder, marks, workers],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        start_new_session=True,
    ) as driver:
        assert driver.stdout is not None
        hangs = marks / "hangs"
        assert any(hangs.exists() or int(line) > 5000 for line in driver.stdout)
        driver.send_signal(by)
        # All its processes have the end of the pipe, which the last one closes.
        driver.communicate(timeout=60.0)
    assert hangs.exists() == (workers == "hang")
    results = run(Toy(20_000, marks=marks), str(folder), workers=1)
    assert same(results, run(Toy(20_000), workers=1))
    times = times_computed(marks)
    assert len(times) == 20_000
    # Two chunks of a second: computed, and their files perhaps not written.
    assert sum(times.values()) - 20_000 <= 2 * 2500
    assert not list(folder.glob(".*.part"))


@pytest.mark.parametrize(
    "spoilt",
    [
        lambda old, first, foreign: old[:-1],
        lambda old, first, foreign: b"",
        lambda old, first, foreign: old[:300] + bytes([old[300] ^ 1]) + old[301:],
        lambda old, first, foreign: first,
        lambda old, first, foreign: foreign,
    ],
    ids=["cut", "empty", "one bit", "of other points", "of another study"],
)
def test_a_spoilt_chunk_alone_is_made_anew(
    tmp_path: Path, marks: Path, spoilt: Callable[[bytes, bytes, bytes], bytes]
) -> None:
    study, folder, other = Toy(200, marks=marks), tmp_path / "study", tmp_path / "other"
    before = run(study, str(folder), workers=1).read()["x"]
    run(Toy(200, seed=2), str(other), workers=1)
    first, _, file, *_ = sorted(folder.glob("*.chunk"))
    content = (file.read_bytes(), first.read_bytes(), (other / file.name).read_bytes())
    file.write_bytes(spoilt(*content))
    part = folder / ".points-000000000000-000000000004.chunk.1234.part"
    part.write_bytes(b"what a killed process left")
    assert run(study, str(folder), workers=1).read()["x"].tobytes() == before.tobytes()
    again = sorted(point for point, times in times_computed(marks).items() if times > 1)
    assert again == list(range(*map(int, file.stem.split("-")[1:])))
    assert not part.exists()


def test_a_late_chunk_that_overlaps_others_is_dropped(tmp_path: Path) -> None:
    study, late = Toy(60), Chunk(4, 60)
    results = run(study, str(tmp_path), workers=1)
    names = {file.name for file in tmp_path.glob("*.chunk")}
    assert late.file not in names
    compute(Store(str(tmp_path)), study, digest_of(manifest_of(study)), late)
    assert (tmp_path / late.file).exists()
    assert same(run(study, str(tmp_path), workers=1), results)
    assert {file.name for file in tmp_path.glob("*.chunk")} == names


def contents(folder: Path) -> dict[str, bytes]:
    return {file.name: file.read_bytes() for file in sorted(folder.iterdir())}


@pytest.mark.parametrize(
    ("other", "words"),
    [
        (Toy(seed=2), 'of another study: before "seed": 1, now "seed": 2; --fresh throws'),
        (Toy(1001), 'before 1000, now 1001, before "count": 1000, now "count": 1001;'),
        (Toy(1000, 8), 'before "quantum": 4, now "quantum": 8'),
    ],
)
def test_another_study_is_refused_with_what_changed_and_made_when_fresh(
    tmp_path: Path, other: Toy, words: str
) -> None:
    run(Toy(), str(tmp_path), workers=1)
    before = contents(tmp_path)
    with pytest.raises(StudyError, match=words):
        run(other, str(tmp_path), workers=1)
    assert contents(tmp_path) == before
    fresh = run(other, str(tmp_path), workers=1, fresh=True)
    assert same(fresh, run(other, workers=1))
    assert same(run(other, str(tmp_path), workers=1), fresh)


@pytest.mark.parametrize("package", ["numpy", "sources"])
def test_other_versions_are_refused_and_named(tmp_path: Path, package: str) -> None:
    run(Toy(), str(tmp_path), workers=1)
    manifest = tmp_path / "manifest.json"
    content = json.loads(manifest.read_text(encoding="utf-8"))
    now, content["versions"][package] = content["versions"][package], "0.1"
    manifest.write_text(json.dumps(content), encoding="utf-8")
    with pytest.raises(StudyError, match=f'before "{package}": "0.1", now "{package}": "{now}"'):
        run(Toy(), str(tmp_path), workers=1)


@pytest.mark.parametrize("name", ["notes.txt", "manifest.json"])
@pytest.mark.parametrize("fresh", [False, True])
def test_a_folder_of_other_files_is_refused_and_left_alone(
    tmp_path: Path, name: str, fresh: bool
) -> None:
    (tmp_path / name).write_text("{}", encoding="utf-8")
    with pytest.raises(StudyError, match=name):
        run(Toy(), str(tmp_path), workers=1, fresh=fresh)
    assert list(contents(tmp_path)) == [name]


def test_a_second_process_is_refused_while_one_computes_in_a_folder(tmp_path: Path) -> None:
    def meanwhile(_: Progress) -> None:
        with pytest.raises(StudyError, match="another process computes a study here"):
            run(Toy(), str(tmp_path), workers=1)

    run(Toy(), str(tmp_path), workers=1, progress=meanwhile)
    assert run(Toy(), str(tmp_path), workers=1).count == 1000


@needs("studies")
def test_at_an_address_of_fsspec_a_study_resumes_as_in_a_folder(marks: Path) -> None:
    import fsspec

    address = "memory://studies/toy"
    memory = fsspec.filesystem("memory")
    study, expected = Toy(200, marks=marks), run(Toy(200), workers=1)
    assert same(run(study, address, workers=1), expected)
    files = sorted(memory.glob("/studies/toy/*.chunk"))
    memory.rm_file(files[1])
    memory.pipe_file(files[2], memory.cat_file(files[2])[:-9])
    with pytest.raises(StudyError, match="another study"):
        run(Toy(100), address, workers=1)
    assert same(run(study, address, workers=1), expected)
    assert sum(times_computed(marks).values()) < 2 * 200
    memory.rm("/studies", recursive=True)
