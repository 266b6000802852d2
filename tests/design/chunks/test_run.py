"""Studies in chunks: the same results however they are computed, and an end told in one line."""

import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stickslip_design.chunks import Progress, StudyError, run
from tests.design.chunks.toy import Toy, failure, processes, same, times_computed

LONG: dict[str, Any] = {"count": 20_000, "pace": 4e-3}
"""A study that would take this process more than a minute, and its workers no time."""


def test_results_are_the_same_to_the_bit_by_any_workers(tmp_path: Path, marks: Path) -> None:
    one = run(Toy(LONG["count"]), workers=1)
    three = run(Toy(**LONG, marks=marks), str(tmp_path / "three"), workers=3)
    assert len(processes(marks)) > 1
    assert same(one, three)
    read = three.read()
    np.testing.assert_array_equal(read["x"], np.sin(1.7 * np.arange(three.count) + 1))
    assert list(read["failure"]) == [failure(point) for point in range(three.count)]
    assert list(read) == ["x", "n", "failure"]
    for start, stop in ((17, 29), (3, 19_997), (500, 500), (19_990, None)):
        for name, column in three.read(start, stop).items():
            np.testing.assert_array_equal(column, read[name][start:stop])


def test_a_range_reads_the_files_of_its_chunks_alone(tmp_path: Path) -> None:
    results = run(Toy(100), str(tmp_path), workers=1)
    first, *_, last = sorted(tmp_path.glob("*.chunk"))
    first.write_bytes(b"")
    assert results.read(95, 100)["n"].tolist() == [0, 1, 2, 3, 4]
    last.write_bytes(last.read_bytes()[:-1])
    with pytest.raises(StudyError, match=rf"{first.name}: was removed or altered; the same"):
        results.read(0, 1)


def test_a_short_study_is_computed_in_this_process(marks: Path) -> None:
    run(Toy(1000, pace=1e-4, marks=marks), workers=2)
    assert processes(marks) == {os.getpid()}


def test_progress_shows_points_failures_and_what_was_kept(tmp_path: Path) -> None:
    shown: list[Progress] = []
    for kept in (0, 1000):
        run(Toy(), str(tmp_path), workers=1, progress=shown.append)
        last = shown[-1]
        assert (last.done, last.count, last.failed, last.kept) == (1000, 1000, 10, kept)
    assert [each.done for each in shown[:-1]] == sorted(each.done for each in shown[:-1])


def test_a_killed_worker_costs_the_chunks_on_their_way_alone(marks: Path) -> None:
    results = run(Toy(**LONG, marks=marks, kills=2), workers=2)
    assert same(results, run(Toy(LONG["count"]), workers=1))
    assert len(list(marks.glob("killed*"))) == 2
    # That of the other worker may be computed, and not written.
    assert sum(times > 1 for times in times_computed(marks).values()) <= 2 * 2500


@pytest.mark.parametrize(
    ("goes_wrong", "words"),
    [
        (
            {"kills": 99},
            r"^points \d+ to \d+ ended their worker process 3 times$",
        ),
        ({"raises": 15_000}, "ZeroDivisionError: of point 15000, with a line more$"),
        ({"largest": 1500}, r"\.chunk: File too large; what is computed is kept, and the study"),
    ],
)
def test_what_goes_wrong_in_a_worker_ends_the_study_in_one_line_and_it_resumes(
    tmp_path: Path, marks: Path, goes_wrong: dict[str, Any], words: str
) -> None:
    folder = tmp_path / "study"
    with pytest.raises(StudyError, match=words) as ended:
        run(Toy(**LONG, marks=marks, **goes_wrong), str(folder), workers=2)
    assert "\n" not in str(ended.value)
    assert not list(folder.glob(".*.part"))
    before = sum(times_computed(marks).values())
    assert same(run(Toy(LONG["count"], marks=marks), str(folder)), run(Toy(LONG["count"])))
    # Three chunks of workers may be computed and not written.
    assert before > 0
    assert max(times_computed(marks).values()) <= 2


@pytest.mark.parametrize(
    ("study", "workers", "words"),
    [(Toy(0), None, "the study has no points"), (Toy(), 0, "0 workers: at least 1 is needed")],
)
def test_nothing_to_do_is_refused_and_nothing_written(
    tmp_path: Path, study: Toy, workers: int | None, words: str
) -> None:
    with pytest.raises(StudyError, match=words):
        run(study, str(tmp_path / "new"), workers=workers)
    assert not (tmp_path / "new").exists()
