"""The whole run: the FMU and the reference on every case, and what happens when one fails."""

import subprocess
import sys
import zipfile
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from stickslip_verification import (
    CheckResult,
    FmuError,
    NameMap,
    Verdict,
    load_invariants,
    load_mutants,
    verify,
)
from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.reference import run_reference
from stickslip_verification.drive.stepping import run_case
from stickslip_verification.model.verdict import ChosenContract, Kind

from .records import named

# A few cases that try everything once: a cycle, changes, reversals, damping.
FEW = [named(name) for name in ("one-step", "tuned", "reversals", "damped-cycle", "slow-pull")]


@pytest.fixture(scope="module")
def ours(fmu_path: Path) -> Verdict:
    """Return the verdict on our FMU in a few cases."""
    return verify(fmu_path, FEW, sequences=12, jobs=1)


def wrong(verdict: Verdict) -> list[CheckResult]:
    """Return what fails a verdict."""
    return [result for result in verdict.checks if result.failed]


def test_fmu_and_reference_hold_in_every_kind_of_truth(ours: Verdict) -> None:
    """Nothing fails, nothing is left out, and each kind of truth was tried."""
    assert wrong(ours) == []
    assert ours.passed
    assert ours.summary["not_applicable"] == ours.summary["noted"] == 0
    assert set(ours.by_kind) == set(Kind)


def test_every_check_of_a_case_is_made_on_both_sides(ours: Verdict) -> None:
    """Each check of each case has one result for the FMU and one for the reference."""
    counted = Counter((r.case, r.check, r.side) for r in ours.checks)
    assert set(counted.values()) == {1}
    for case in FEW:
        for check in case.checks:
            assert (case.id, check.id, "fmu") in counted
            assert (case.id, check.id, "reference") in counted


def test_every_invariant_is_tried(ours: Verdict) -> None:
    """No invariant of the suite is silently left out, but orders, which name their own cases."""
    made = {result.check for result in ours.checks}
    invariants = load_invariants()
    tried = {invariant.id for invariant in invariants} - {order.id for order in invariants.orders}
    # A break-away beyond the threshold needs a change that lets the mass go.
    assert tried - made <= {"onset-beyond-break-away"}


def test_what_takes_a_fresh_process_can_be_left_out(fmu_path: Path) -> None:
    """Then every other probe is asked, and a fault that such a probe detects is detected still."""
    leak = load_mutants("memory-of-instances")
    verdict = verify(
        fmu_path,
        FEW[:1],
        fresh_processes=False,
        mutants=leak,
        whole_matrix=False,
        jobs=1,
    )
    probes = {probe.id for probe in load_invariants().probes}
    assert probes - {result.check for result in verdict.checks} == {
        "memory-of-steps",
        "memory-of-states",
        "memory-of-instances",
        "state-in-a-fresh-process",
        "state-in-a-fresh-process-to-the-bit",
        "environment",
        "environment-to-the-bit",
    }
    assert verdict.passed
    assert verdict.kills is not None
    assert verdict.kills.rows[0].failing == {"memory-of-instances": 1}


def test_progress_tells_each_case(fmu_path: Path) -> None:
    """Progress names every case, and never more is done than there is."""
    told: list[tuple[str, int, int]] = []
    verify(
        fmu_path, FEW[:2], lambda *progress: told.append(progress), fresh_processes=False, jobs=1
    )
    assert {what.rpartition(": ")[2] for what, _, _ in told} >= {"one-step", "tuned"}
    assert all(done <= total for _, done, total in told)


def test_one_process_or_two_give_the_same(fmu_path: Path) -> None:
    """The number of processes changes nothing in the results."""
    one, two = (verify(fmu_path, FEW[:3], fresh_processes=False, jobs=jobs) for jobs in (1, 2))
    assert one.checks == two.checks


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
            verify(path, cases, jobs=1)
        assert "\n" not in str(caught.value)


def test_an_fmu_without_the_variables_is_refused_by_their_names(foreign_fmu: Path) -> None:
    """What cannot be a stick-slip block is refused before any case, with what it lacks."""
    with pytest.raises(FmuError, match="has no variable m, mu_s, mu_k, v, x; map them"):
        verify(foreign_fmu, [named("one-step")], jobs=1)


def test_a_refusal_is_told_in_the_words_of_the_fmu(fmu_path: Path) -> None:
    """A stiffness below zero fails the case with the FMU's own message."""
    with pytest.raises(FmuError, match=r"k = -1"):
        run_case(FmuFile(fmu_path), replace(named("one-step"), parameters={"k": -1.0}))


def test_an_honest_foreign_fmu_passes(slider_mm: Path, slider_mm_names: NameMap) -> None:
    """A block with other names, in millimetres, passes; what it lacks is counted, not passed."""
    verdict = verify(slider_mm, FEW, names=slider_mm_names, jobs=1)
    assert wrong(verdict) == []
    assert verdict.passed
    assert verdict.contract == ChosenContract("physics", "a names file is given")
    assert verdict.summary["not_applicable"] > 0
    reasons = {r.not_applicable for r in verdict.checks if r.not_applicable is not None}
    assert "it has no variable c" in reasons
    assert "it has no output W_pull" in reasons
    assert any("cannot get and set its state" in reason for reason in reasons)


def test_an_honest_fmu_of_version_3_passes(slider_si: Path, slider_si_names: NameMap) -> None:
    """FMI 3.0 is driven as 2.0 is, its state too."""
    verdict = verify(slider_si, FEW, names=slider_si_names, jobs=1)
    assert wrong(verdict) == []
    rollbacks = [r for r in verdict.checks if r.check == "rollback" and r.side == "fmu"]
    assert "pass" in {result.verdict for result in rollbacks}


def test_a_faulty_foreign_fmu_is_convicted(slider_faulty: Path, slider_mm_names: NameMap) -> None:
    """A static friction that is 0.5 % too high holds more than it may, and the cycle is another."""
    verdict = verify(
        slider_faulty, [named("default")], names=slider_mm_names, fresh_processes=False, jobs=1
    )
    failed = {result.check for result in wrong(verdict)}
    assert {"break-away-force", "t_stick-exact", "x-course"} <= failed
    assert "slip-propagates" not in failed
    assert not verdict.passed


def test_the_contract_decides_for_a_foreign_fmu_only_if_strict(
    slider_mm: Path, slider_mm_names: NameMap
) -> None:
    """What a foreign FMU does not promise is noted; judged strictly it fails."""
    lax, strict = (
        verify(
            slider_mm,
            FEW[:1],
            names=slider_mm_names,
            strict=strict,
            fresh_processes=False,
            jobs=1,
        )
        for strict in (False, True)
    )
    noted = {r.check for r in lax.checks if r.verdict == "noted"}
    assert "declared-units" in noted
    assert noted <= {result.check for result in wrong(strict)}


def test_what_is_not_applicable_everywhere_is_no_verdict(
    slider_poor: Path, slider_poor_names: NameMap
) -> None:
    """An FMU of which nothing can be judged is not green."""
    verdict = verify(
        slider_poor,
        [named("damped-cycle")],
        names=slider_poor_names,
        fresh_processes=False,
        jobs=1,
    )
    assert wrong(verdict) == []
    on_fmu = [r for r in verdict.checks if r.side == "fmu" and r.truth == "closed_form"]
    assert {result.verdict for result in on_fmu} == {"not applicable"}
    assert not verdict.passed


@pytest.mark.parametrize(
    ("what", "told"),
    [
        ("crash", "the process crashed (SIG"),
        ("hang", "no answer within 5 s; the process was ended"),
        ("discard", "discarded"),
    ],
)
def test_a_foreign_fmu_that_fails_takes_only_its_case_with_it(
    misbehaving: Callable[[str], Path], what: str, told: str
) -> None:
    """A crash or a hang on the third step fails that case with its reason; a short one runs."""
    cases = [named("one-step"), named("heavy")]
    # Processes that hang sleep: several at once take no time from others.
    verdict = verify(misbehaving(what), cases, time_limit=5.0, fresh_processes=False, jobs=4)
    ends = {r.case: r for r in verdict.checks if r.check == "runs-to-the-end" and r.side == "fmu"}
    assert told in (ends["heavy"].failure or "")
    assert ends["one-step"].passed
    others = {r.verdict for r in verdict.checks if r.case == "heavy" and r.check == "z-course"}
    assert others == {"not applicable", "pass"}
    assert not verdict.passed


def test_the_clamp_warns_on_both_sides(fmu_path: Path) -> None:
    """A clamped mu_k is told by the FMU and by the reference, with both names."""
    clamp = named("clamp")
    for run in (run_case(FmuFile(fmu_path), clamp), run_reference(clamp)):
        (message, *_) = run.messages
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
