"""Results that are kept for one session."""

from dataclasses import replace
from pathlib import Path

import pytest

from stickslip_verification.drive.exact import FOLDER, kept
from stickslip_verification.suite.cases import Case
from tests.verification.records import named

CASE = named("one-step")


class Counted:
    def __init__(self) -> None:
        self.calls = 0

    def work(self, case: Case, tolerance: float = 1.0) -> int:
        self.calls += 1
        if tolerance < 0.0:
            raise ValueError(case.id)
        return self.calls


def test_the_same_question_is_answered_once(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    work = Counted().work
    monkeypatch.setenv(FOLDER, str(tmp_path))
    assert kept(work, CASE) == kept(work, CASE) == 1
    # What a case checks does not change its motion.
    assert kept(work, replace(CASE, checks=(), title="another")) == 1
    # Another parameter, step or argument is another question.
    stiffer = replace(CASE, parameters={**CASE.parameters, "k": 1000.0000000000001})
    assert kept(work, stiffer) == 2
    assert kept(work, replace(CASE, steps=CASE.steps * 2)) == 3
    assert kept(work, CASE, 2.0) == 4
    # Outside a session nothing is kept.
    monkeypatch.delenv(FOLDER)
    assert [kept(work, CASE) for _ in range(2)] == [5, 6]


def test_failures_and_what_cannot_be_read_or_written_cost_a_computation(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv(FOLDER, str(tmp_path))
    work = Counted().work
    with pytest.raises(ValueError, match="one-step"):
        kept(work, CASE, -1.0)
    assert not list(tmp_path.iterdir())
    kept(work, CASE)
    (file,) = tmp_path.iterdir()
    file.write_bytes(file.read_bytes()[:3])
    assert kept(work, CASE) == 3
    monkeypatch.setenv(FOLDER, str(file))
    assert kept(work, CASE) == 4
