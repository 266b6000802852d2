"""Facts about results that are kept for one session."""

import json
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from stickslip_verification.drive import kept as module
from stickslip_verification.drive.exact import exact_motion
from stickslip_verification.drive.kept import FOLDER, kept
from stickslip_verification.drive.reference import run_reference
from stickslip_verification.model.run import Run
from stickslip_verification.suite.cases import Case
from tests.python import python

from .records import named


def refused(case: Case) -> float:
    """Stand for work that fails."""
    raise ValueError(case.id)


class Counted:
    """Stands for long work; counts how often it is done."""

    def __init__(self) -> None:
        self.calls = 0

    def work(self, case: Case, tolerance: float = 1.0) -> tuple[str, float, int]:
        """Return what was asked for, and the number of the call."""
        self.calls += 1
        return case.id, tolerance, self.calls


def test_without_a_folder_nothing_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """Outside a session every result is computed."""
    monkeypatch.delenv(FOLDER, raising=False)
    counted = Counted()
    assert kept(counted.work, named("one-step")) == ("one-step", 1.0, 1)
    assert kept(counted.work, named("one-step")) == ("one-step", 1.0, 2)


def test_the_same_question_is_answered_once(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Another parameter, step or argument, and other source, is another question."""
    monkeypatch.setenv(FOLDER, str(tmp_path / "kept"))
    counted, case = Counted(), named("one-step")
    assert kept(counted.work, case) == kept(counted.work, case) == ("one-step", 1.0, 1)
    # What a case checks does not change its motion.
    assert kept(counted.work, replace(case, checks=(), title="another")) == ("one-step", 1.0, 1)
    stiffer = replace(case, parameters={**case.parameters, "k": 1000.0000000000001})
    assert kept(counted.work, stiffer)[2] == 2
    assert kept(counted.work, replace(case, steps=case.steps * 2))[2] == 3
    assert kept(counted.work, case, 2.0)[2] == 4
    monkeypatch.setattr(module, "_made_from", lambda: "other source")
    assert kept(counted.work, case)[2] == 5


def test_a_failure_is_not_kept(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Work that fails leaves no file, so it is tried again."""
    monkeypatch.setenv(FOLDER, str(tmp_path))
    with pytest.raises(ValueError, match="one-step"):
        kept(refused, named("one-step"))
    assert not list(tmp_path.iterdir())


def test_a_file_that_cannot_be_read_costs_a_computation(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A truncated file is computed again, and a folder that is none keeps nothing."""
    monkeypatch.setenv(FOLDER, str(tmp_path))
    counted, case = Counted(), named("one-step")
    kept(counted.work, case)
    (file,) = tmp_path.iterdir()
    file.write_bytes(file.read_bytes()[:5])
    assert kept(counted.work, case)[2] == 2
    monkeypatch.setenv(FOLDER, str(file))
    assert kept(counted.work, case)[2] == 3


def test_what_is_kept_is_what_was_computed_to_the_bit(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Exact motion and reference come back from the folder with every bit."""
    case = named("damped-fades")

    def bits(record: Run) -> dict[str, bytes]:
        return {name: np.asarray(each).tobytes() for name, each in record.outputs.items()}

    computed = [bits(exact_motion(case).record), bits(run_reference(case))]
    monkeypatch.setenv(FOLDER, str(tmp_path))
    for _ in range(2):
        exact, reference = kept(exact_motion, case), kept(run_reference, case)
        assert [bits(exact.record), bits(reference)] == computed
    assert len(list(tmp_path.iterdir())) == 2


def test_a_verdict_from_kept_results_is_the_same(fmu_path: Path, tmp_path: Path) -> None:
    """The command gives the same checks with a folder as without one."""
    reports = []
    for number, environment in enumerate([{}, {FOLDER: "kept"}]):
        target = tmp_path / f"{number}.json"
        arguments = ["verify", "--fmu", str(fmu_path), "--cases", "one-step", "-o", str(target)]
        code = "import sys; from stickslip.cli import main; main()"
        python("-c", code, *arguments, cwd=tmp_path, env={**_environment(), **environment})
        reports.append(json.loads(target.read_text(encoding="utf-8"))["checks"])
    assert reports[0] == reports[1]
    assert len(list((tmp_path / "kept").iterdir())) == 2


def _environment() -> dict[str, str]:
    return {name: value for name, value in os.environ.items() if name != FOLDER}
