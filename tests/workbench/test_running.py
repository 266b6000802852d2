"""How a command runs a study of many points: what it refuses, and what it tells on the way."""

from pathlib import Path
from typing import Any

import pytest

from stickslip.commands.running import _how_far, computed
from stickslip.errors import CommandError
from stickslip_design import chunks
from tests.design.chunks.toy import Toy


@pytest.mark.parametrize(
    ("study", "options", "told"),
    [
        (Toy(), {"workers": 0}, "--workers 0: at least 1 is needed"),
        (
            Toy(),
            {"workers": 2, "cluster": "tcp://host:8786"},
            "--workers goes with this machine, not with --cluster",
        ),
        (Toy(10**9 + 1), {}, r"1e\+09 points are more than 10\^9; --yes computes them"),
        (Toy(), {"cluster": "tcp://127.0.0.1:1"}, "no dask scheduler answers at tcp://127"),
        (Toy(0), {}, "the study has no points"),
    ],
)
def test_wrong_options_are_refused_and_nothing_is_written(
    tmp_path: Path, study: Toy, options: dict[str, Any], told: str
) -> None:
    """In one line."""
    with pytest.raises(CommandError, match=told):
        computed(study, str(tmp_path / "study"), described="Computing", **options)
    assert not list(tmp_path.iterdir())


def test_more_than_a_billion_points_are_computed_if_that_is_meant(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """With --yes; up to 10^9 without."""
    asked = []
    monkeypatch.setattr(chunks, "run", lambda study, *_, **__: asked.append(study.count))
    computed(Toy(10**9 + 1), None, described="Computing", yes=True)
    computed(Toy(10**9), None, described="Computing")
    assert asked == [10**9 + 1, 10**9]


def test_a_note_is_told_once(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """On standard error, at a terminal or not."""

    def run(*_: object, progress: Any, **__: object) -> None:
        for done in range(3):
            progress(chunks.Progress(done, 9, 0, 1.0, note="no workers: waiting"))

    monkeypatch.setattr(chunks, "run", run)
    computed(Toy(), None, described="Computing")
    assert capsys.readouterr().err == "stickslip: no workers: waiting\n"


def test_the_rate_is_that_of_this_run() -> None:
    """Points of an earlier run took it no time."""
    progress = chunks.Progress(done=5000, count=20_000, failed=3, seconds=10.0, kept=4000)
    assert _how_far(progress) == "5\u202f000 of 20\u202f000 points, 100/s, 3 without a result"
    assert _how_far(chunks.Progress(0, 7, 0, 0.0)) == "0 of 7 points"
