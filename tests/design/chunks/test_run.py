"""Studies in chunks: the same results however they are computed, and an end told in one line."""

import gc
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stickslip_design.chunks import Progress, StudyError, run
from stickslip_design.chunks.manifest import manifest_of
from stickslip_design.chunks.plan import Plan
from stickslip_design.chunks.study import Chunk
from stickslip_design.chunks.work import Done, Job, work

from .conftest import RUN
from .toy import Toy, failure, same, times_computed


@given(
    st.integers(1, 3000),
    st.integers(1, 70),
    st.lists(st.tuples(st.floats(1e-6, 20.0), st.integers(1, 10**9)), min_size=1),
    st.integers(1, 9),
    st.sets(st.integers(0, 40)),
)
def test_chunks_are_each_point_once(
    count: int, quantum: int, times: list[tuple[float, int]], workers: int, before: set[int]
) -> None:
    """In multiples of the quantum, whatever chunks take and whichever are there already."""
    done = [
        Chunk(start, min(start + 2 * quantum, count))
        for start in range(0, count, 2 * quantum)
        if start // (2 * quantum) in before
    ]
    plan, taken = Plan(count, quantum, done), list(done)
    while plan.left:
        chunk = plan.take(workers)
        assert chunk.start % quantum == 0
        assert chunk.points % quantum == 0 or chunk.stop == count
        seconds, size = times[len(taken) % len(times)]
        plan.learn(chunk.points, seconds, size)
        taken.append(chunk)
    assert [point for chunk in sorted(taken) for point in range(*chunk)] == list(range(count))


def test_chunks_take_a_second() -> None:
    """Once the time of a point is known, and until the end is near."""
    plan, sizes = Plan(10**6, 10, ()), []
    for _ in range(12):
        chunk = plan.take(2)
        sizes.append(chunk.points)
        plan.learn(chunk.points, 1e-3 * chunk.points, 80 * chunk.points)
    assert sizes[0] == 10
    assert sizes[4:] == [1000] * 8


def test_chunks_are_longer_on_many_workers() -> None:
    """20 s on 1,000: so that no scheduler has to hand out more than 50 a second."""
    plan = Plan(10**9, 10, ())
    for _ in range(12):
        chunk = plan.take(1000)
        plan.learn(chunk.points, 1e-3 * chunk.points, 80 * chunk.points)
    assert chunk.points == 20_000


def test_chunks_of_quick_points_fit_into_memory() -> None:
    """A chunk file has 64 MB at most, however fast it is made."""
    plan = Plan(10**9, 10, ())
    for _ in range(12):
        chunk = plan.take(2)
        plan.learn(chunk.points, 1e-9 * chunk.points, 80 * chunk.points)
    assert 32e6 < 80 * chunk.points <= 2**26


@pytest.mark.usefixtures("_short_chunks")
def test_results_are_the_same_by_any_workers(tmp_path: Path) -> None:
    """To the bit: one process in large chunks, three in small ones, each point from the formula."""
    one = run(Toy(), workers=1)
    three = run(Toy(pace=3e-4), str(tmp_path / "three"), workers=3)
    assert same(one, three)
    assert len(list((tmp_path / "three").glob("*.chunk"))) > 5
    read = three.read()
    np.testing.assert_array_equal(read["x"], np.sin(1.7 * np.arange(1000) + 1))
    assert list(read["failure"]) == [failure(point) for point in range(1000)]
    assert three.names == ("x", "n", "failure")
    assert three.count == 1000


@pytest.mark.parametrize("between", [(0, 1000), (17, 29), (3, 997), (500, 500), (990, None)])
def test_a_range_of_results_is_part_of_all(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, between: tuple[int, int | None]
) -> None:
    """Over any borders of chunks."""
    monkeypatch.setattr("stickslip_design.chunks.plan._SECONDS", 0.01)
    results = run(Toy(pace=1e-4), str(tmp_path), workers=1)
    part, whole = results.read(*between), results.read()
    for name, column in whole.items():
        np.testing.assert_array_equal(part[name], column[slice(*between)])


def test_a_range_reads_the_files_of_its_chunks_alone(tmp_path: Path) -> None:
    """The files of others may be anything; one of its own that was altered is told."""
    results = run(Toy(100, pace=1e-3), str(tmp_path), workers=1)
    first, *_, last = sorted(tmp_path.glob("*.chunk"))
    first.write_bytes(b"")
    assert results.read(90, 100)["n"].tolist() == [0, 1, 2, 3, 4] * 2
    last.write_bytes(last.read_bytes()[:-1])
    with pytest.raises(StudyError, match=rf"{first.name}: the file was altered; the same command"):
        results.read(0, 1)


def test_a_short_study_needs_no_worker(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is computed in this process, where starting another one would take longer."""
    monkeypatch.setattr(RUN, "processes", None)
    assert run(Toy(1000, pace=1e-4), workers=2).count == 1000
    with pytest.raises(TypeError, match="not callable"):
        run(Toy(10**6, pace=1e-4), workers=2)


def test_a_temporary_folder_lasts_as_long_as_the_results(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing is left of a study without a folder."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    results = run(Toy(20), workers=1)
    assert results.read(19)["n"].tolist() == [4]
    assert list(tmp_path.iterdir())
    del results
    gc.collect()
    assert not list(tmp_path.iterdir())


def test_progress_tells_points_failures_and_what_was_kept(tmp_path: Path) -> None:
    """All of them at the end; a study that is done is not computed again."""
    told: list[Progress] = []
    run(Toy(), str(tmp_path), workers=1, progress=told.append)
    assert [each.done for each in told] == sorted(each.done for each in told)
    assert (told[-1].done, told[-1].count, told[-1].failed, told[-1].kept) == (1000, 1000, 10, 0)
    run(Toy(), str(tmp_path), workers=1, progress=told.append)
    assert (told[-1].done, told[-1].failed, told[-1].kept) == (1000, 10, 1000)


@pytest.mark.usefixtures("_short_chunks", "_by_workers_alone")
def test_a_killed_worker_costs_its_chunk_alone(marks: Path) -> None:
    """It is computed again by another worker, and no other one is."""
    results = run(Toy(pace=3e-4, marks=marks, kills=700), workers=2)
    assert same(results, run(Toy(), workers=1))
    assert (marks / "killed").exists()
    assert set(times_computed(marks).values()) == {1}


@pytest.mark.usefixtures("_short_chunks", "_by_workers_alone")
def test_a_chunk_that_kills_three_workers_ends_the_study() -> None:
    """It is named, with the signal."""
    with pytest.raises(
        StudyError, match=r"points \d+ to \d+ ended their worker process 3 times \(SIGKILL\)"
    ) as told:
        run(Toy(pace=3e-4, kills=700), workers=2)
    first, last = (int(word) for word in str(told.value).split()[1:4:2])
    assert first <= 700 <= last


@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.usefixtures("_short_chunks")
def test_an_error_ends_the_study_in_one_line(tmp_path: Path, workers: int) -> None:
    """With its kind and the points; what is computed is kept."""
    study = Toy(pace=3e-4, raises=700)
    with pytest.raises(StudyError) as told:
        run(study, str(tmp_path), workers=workers)
    assert "ZeroDivisionError: of point 700, with a line more" in str(told.value)
    assert "\n" not in str(told.value)
    assert list(tmp_path.glob("*.chunk"))


def test_a_worker_of_several_threads_computes_one_chunk_at_a_time(tmp_path: Path) -> None:
    """A study need not be safe in threads."""
    study = Toy(16, pace=0.05)
    run(study, str(tmp_path), workers=1)
    content = (tmp_path / "study.pickle").read_bytes()
    job = Job(str(tmp_path), manifest_of(study).key, sha256(content).hexdigest())
    chunks = [Chunk(start, start + 4) for start in range(0, 16, 4)]
    begun = time.monotonic()
    with ThreadPoolExecutor(4) as threads:
        answers = list(threads.map(partial(work, job), chunks))
    assert time.monotonic() - begun >= 16 * study.pace
    assert [answer.chunk for answer in answers if isinstance(answer, Done)] == chunks


def test_a_column_of_another_length_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """One value a point is due, and no objects."""
    for column in (np.zeros(3), np.zeros((8, 2)), np.array([None] * 8)):
        monkeypatch.setattr(Toy, "compute", lambda *_, column=column: {"wrong": column})
        with pytest.raises(StudyError, match=r"points 0 to 7: the column wrong has shape"):
            run(Toy(8, 8), workers=1)


@pytest.mark.parametrize(
    ("study", "workers", "told"),
    [(Toy(0), None, "the study has no points"), (Toy(), 0, "0 workers: at least 1 is needed")],
)
def test_nothing_to_do_is_refused(
    tmp_path: Path, study: Toy, workers: int | None, told: str
) -> None:
    """No points, no workers; and nothing is written."""
    with pytest.raises(StudyError, match=told):
        run(study, str(tmp_path / "new"), workers=workers)
    assert not (tmp_path / "new").exists()
