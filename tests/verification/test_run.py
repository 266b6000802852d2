"""The whole run: the FMU and the reference on every case, and what happens when one fails."""

import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path

import pytest

from stickslip_verification import FmuError, load_cases, verify
from stickslip_verification.run import judge_case
from stickslip_verification.sides import FmuSide, ReferenceSide

from .standing_in import named


def test_the_fmu_and_the_reference_are_exact_on_every_case(fmu_path: Path) -> None:
    """Both sides pass every check of the suite, and progress tells each case once."""
    cases = load_cases()
    told: list[tuple[str, int, int]] = []
    verdict = verify(fmu_path, cases, lambda *progress: told.append(progress))
    failed = [result for result in verdict.checks if not result.passed]
    assert failed == []
    assert verdict.summary["passed"] == 2 * sum(len(case.checks) for case in cases)
    assert told == [
        *((case.id, n, len(cases)) for n, case in enumerate(cases)),
        ("", len(cases), len(cases)),
    ]


def test_what_is_no_fmu_is_told_in_one_line(tmp_path: Path) -> None:
    """A missing file, a text, an archive without a description: one line each, before any case."""
    cases = [named("one-step")]
    text, archive = tmp_path / "text.fmu", tmp_path / "archive.fmu"
    text.write_text("not an FMU", encoding="utf-8")
    with zipfile.ZipFile(archive, "w") as file:
        file.writestr("readme.txt", "not an FMU")
    for path, told in (
        (tmp_path / "none.fmu", "no such file"),
        (text, "not a zip archive"),
        (archive, "not an FMU"),
    ):
        with pytest.raises(FmuError, match=told) as caught:
            verify(path, cases)
        assert "\n" not in str(caught.value)


def test_a_refusal_is_told_in_the_words_of_the_fmu(fmu_path: Path) -> None:
    """A stiffness below zero fails the case with the FMU's own message; the next case runs."""
    side = FmuSide(fmu_path)
    broken = replace(named("one-step"), parameters={"k": -1.0})
    results = judge_case(broken, [side])
    assert all(result.failure for result in results)
    with pytest.raises(FmuError, match=r"k = -1"):
        side.run(broken)
    assert all(result.passed for result in judge_case(named("one-step"), [side]))


def test_a_foreign_fmu_lacks_outputs_and_does_not_crash(foreign_fmu: Path) -> None:
    """Outputs that an FMU does not have are failed checks; the others are compared."""
    results = {r.check: r for r in judge_case(named("default"), [FmuSide(foreign_fmu)])}
    assert results["T-exact"].failure == "no output T"
    assert results["z-course"].failure is None
    assert not results["z-course"].passed


def test_a_foreign_fmu_lacks_a_parameter(foreign_fmu: Path) -> None:
    """A case that sets what an FMU does not have fails with the name of it."""
    (result, *_) = judge_case(named("slow-pull"), [FmuSide(foreign_fmu)])
    assert result.failure is not None
    assert "has no variable v" in result.failure


def test_the_clamp_warns_on_both_sides(fmu_path: Path) -> None:
    """A clamped mu_k is told by the FMU and by the reference, with both names."""
    for side in (FmuSide(fmu_path), ReferenceSide()):
        (message, *_) = side.run(named("clamp")).messages
        assert "mu_k" in message
        assert "mu_s" in message


def test_importing_the_package_is_cheap() -> None:
    """The package imports none of the heavy libraries before they are needed."""
    heavy = {"matplotlib", "fmpy", "numpy", "scipy", "mpmath"}
    code = f"import sys, stickslip_verification; sys.exit(bool({heavy!r} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_running_does_not_need_matplotlib() -> None:
    """A verdict is made without the plotting library."""
    code = (
        "import sys\nfrom stickslip_verification import load_cases, verify, write_json\n"
        "sys.exit('matplotlib' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
