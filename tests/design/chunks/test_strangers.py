"""Files of other studies, of other workers and of killed processes, in the folder of a study."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from stickslip_design.chunks import Columns, StudyError, run
from stickslip_design.chunks.chunk import packed
from stickslip_design.chunks.manifest import read_manifest
from stickslip_design.chunks.store import store_of
from stickslip_design.chunks.study import Chunk
from stickslip_design.chunks.work import Failed, Job, work

from .toy import Toy, same, times_computed


@dataclass(frozen=True)
class Longer(Toy):
    """A study whose identity does not say how many points it has."""

    @property
    def identity(self) -> Mapping[str, Any]:
        """The seed alone."""
        return {"toy": self.seed}


@dataclass(frozen=True)
class Eraser(Toy):
    """A study that loses the files of its chunks."""

    folder: Path = Path()

    def compute(self, start: int, stop: int) -> Columns:
        """Return what a `Toy` returns, and remove all files of chunks."""
        for file in self.folder.glob("*.chunk"):
            file.unlink()
        return super().compute(start, stop)


def test_a_whole_chunk_of_another_study_is_made_anew(tmp_path: Path, marks: Path) -> None:
    """A worker that outlived its study may write one after --fresh."""
    folder = tmp_path / "study"
    run(Toy(200), str(folder), workers=1)
    file = sorted(folder.glob("*.chunk"))[0]
    chunk = Chunk(*(int(part) for part in file.stem.split("-")[1:]))
    file.write_bytes(packed(chunk, "0" * 64, Toy(200, seed=2).compute(*chunk)))
    assert same(run(Toy(200, marks=marks), str(folder), workers=1), run(Toy(200), workers=1))
    assert set(times_computed(marks)) == set(range(*chunk))


@pytest.mark.parametrize(
    ("other", "told"),
    [(Longer(300), "points.count is 300 and"), (Longer(200, 8), "points.quantum is 8 and")],
)
def test_how_many_points_there_are_is_an_input(tmp_path: Path, other: Longer, told: str) -> None:
    """Also where the study itself does not say so."""
    folder = str(tmp_path / "study")
    run(Longer(200), folder, workers=1)
    with pytest.raises(StudyError, match=told):
        run(other, folder, workers=1)


@pytest.mark.usefixtures("_short_chunks")
def test_chunks_whose_files_are_gone_end_the_study(tmp_path: Path) -> None:
    """What workers computed counts once its file is seen here."""
    folder = tmp_path / "study"
    with pytest.raises(StudyError, match="are computed, and their file is not here"):
        run(Eraser(200, pace=1e-3, folder=folder), str(folder), workers=2)


def test_a_worker_that_reads_another_study_says_so(tmp_path: Path) -> None:
    """The folder of its name may be another one where it runs."""
    folder = str(tmp_path / "study")
    run(Toy(200), folder, workers=1)
    manifest = read_manifest(store_of(folder))
    assert manifest is not None
    answer = work(Job(folder, manifest.key, "0" * 64), Chunk(0, 4))
    assert isinstance(answer, Failed)
    assert "reads another study" in answer.reason


def test_what_a_killed_process_left_is_removed(tmp_path: Path) -> None:
    """A part of a file has no name that is ever asked for again."""
    folder = tmp_path / "study"
    run(Toy(200), str(folder), workers=1)
    part = folder / ".points-000000000000-000000000004.chunk.1234.part"
    part.write_bytes(b"half")
    run(Toy(200), str(folder), workers=1)
    assert not part.exists()


def test_a_fresh_study_takes_no_chunk_of_the_same_one(tmp_path: Path, marks: Path) -> None:
    """All of it is computed again."""
    folder = str(tmp_path / "study")
    run(Toy(200), folder, workers=1)
    run(Toy(200, marks=marks), folder, workers=1, fresh=True)
    assert set(times_computed(marks)) == set(range(200))
