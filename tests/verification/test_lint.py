"""The suite lints itself: what it ships is sound, and each kind of flaw is found."""

import re
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from stickslip_verification.judge.second_values import Accepted
from stickslip_verification.run import lint as linter
from stickslip_verification.run.lint import lint
from stickslip_verification.suite.cases import CASES_FOLDER
from stickslip_verification.suite.faults import FAULTS_FOLDER, MutantError, load_mutants
from stickslip_verification.suite.invariants import InvariantError, load_invariants

INVARIANTS = load_invariants()

CASE = "default.toml"


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> set[str]:
    """Return what is found in a folder with one sound case: what only other cases use."""
    folder = tmp_path_factory.mktemp("alone")
    shutil.copy(CASES_FOLDER / CASE, folder)
    return set(lint(folder))


def case_in(folder: Path, old: str, new: str, name: str = CASE, *, beside: bool = False) -> Path:
    """Write the case, changed, into a folder, beside itself as it is if wanted."""
    text = (CASES_FOLDER / CASE).read_text(encoding="utf-8")
    changed, count = re.subn(old, new, text, count=1)
    assert count == 1
    (folder / name).write_text(changed, encoding="utf-8")
    if beside:
        shutil.copy(CASES_FOLDER / CASE, folder)
    return folder


def test_the_suite_is_sound() -> None:
    """Nothing is to be said of the suite as it is shipped."""
    assert lint() == []


def test_one_case_alone_leaves_things_unused(alone: set[str]) -> None:
    """With one case only, what other cases, invariants and faults name is found missing."""
    kinds = {
        r"formula \w+: nothing uses it",
        r"quantity \w+: nothing uses it",
        r"planted fault [\w-]+: there is no check [\w.-]+",
        r"order-of-\w+: there is no case [\w-]+",
    }
    assert all(any(re.fullmatch(kind, found) for kind in kinds) for found in alone)
    assert "order-of-z: there is no case grazing" in alone


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        (r'id = "default"', 'id = "other"', "default.toml: its id is 'other', not the name"),
        (
            r'fmu = "[^"]*"\nreference',
            'fmu = "it is so"\nreference',
            r"default / [\w-]+: because.fmu: 'it is so' says too little",
        ),
        (
            r'reference = "[^"]+"',
            'reference = "a number that seems good enough for now"',
            "because.reference: 'seems' is no reason",
        ),
        (
            r'reference = "[^"]+"',
            'reference = "it is tuned until nothing fails any more"',
            "because.reference: 'tuned' is no reason",
        ),
        ("slips = 31", "slips = 30", r"default: motion.slips = 30; it is 31$"),
        ("slips = 31", "slips = 32", r"default: motion.slips = 32; it is 31$"),
        (
            r"slips = 31(?s:(.*))stop_time = 10.0",
            r"slips = 32\1stop_time = 9.8",
            r"default: motion.slips = 32; it is 30 or 31$",
        ),
        ("slips = 31", "slips = 31, reversals = 1", "default: motion.reversals = 1; it is 0"),
        (
            "slips = 31",
            'slips = 31, zero = ["x"]',
            "default: motion.zero: x is not zero throughout",
        ),
        (
            "fixed = 0.01 }",
            "fixed = 10.0 }",
            "default: motion.zero: x_dot is zero throughout and not named",
        ),
        (
            r"motion = \{[^}]*\}\n",
            "",
            r"default: motion is missing, .* write motion = \{ slips = 31 \}$",
        ),
        (
            "fmu = 1e-12",
            "conditioning = 5.0",
            "tolerances.conditioning: 5.0 is above that of the narrowest gap, 2.5",
        ),
        (
            r'id = "first-load-up"',
            'id = "splitting"',
            r"line 17, checks\[0\]\.id: 'splitting' is taken by an invariant",
        ),
        (r'quantity = "F_s"', 'quantity = "y"', r"checks\[1\]\.quantity: 'y' is not a known"),
        (r"\[experiment\]", "[experiment", "default.toml: line"),
    ],
)
def test_a_flaw_in_a_case_is_found(
    tmp_path: Path, alone: set[str], old: str, new: str, told: str
) -> None:
    """A flaw that the schema lets pass, or does not, is one line with the case and the check."""
    findings = set(lint(case_in(tmp_path, old, new))) - alone
    assert [found for found in findings if re.search(told, found)], findings
    assert all("\n" not in found for found in findings)


def test_the_slip_under_way_at_the_end_may_be_counted(tmp_path: Path, alone: set[str]) -> None:
    """At 9.8 s the block is in its 31st slip: it counts as 30 slips or as 31."""
    assert set(lint(case_in(tmp_path, "stop_time = 10.0", "stop_time = 9.8"))) == alone


def test_an_equation_that_theory_lacks_is_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The equation that a quantity or a formula names stands in docs/theory.md."""
    text = linter.THEORY.read_text(encoding="utf-8")
    (tmp_path / "theory.md").write_text(text.replace(r"\tag{8}", r"\tag{99}"), encoding="utf-8")
    monkeypatch.setattr(linter, "THEORY", tmp_path / "theory.md")
    assert "default / t_slip-exact: docs/theory.md has no equation (8)" in lint()


def test_a_vague_word_is_a_word(tmp_path: Path, alone: set[str]) -> None:
    """A word that only contains a vague one is none."""
    text = 'reference = "a magician detuned the unseemly fortuned string"'
    assert set(lint(case_in(tmp_path, r'reference = "[^"]+"', text))) == alone


def test_two_of_a_name_are_found(tmp_path: Path, alone: set[str]) -> None:
    """Two cases of one id or one title are told, once each."""
    findings = set(
        lint(case_in(tmp_path, r"\[experiment\]", "[experiment]", "b.toml", beside=True))
    )
    new = findings - alone
    assert {found.partition(":")[0] for found in new if "have this id" in found} == {"default"}
    assert len([found for found in new if "cases have the title" in found]) == 1
    assert "b.toml: its id is 'default', not the name of the file" in new


def test_a_broken_case_does_not_hide_the_others(tmp_path: Path, alone: set[str]) -> None:
    """A file that cannot be read is one finding beside those of the other files."""
    shutil.copy(CASES_FOLDER / CASE, tmp_path)
    (tmp_path / "broken.toml").write_text("id = =\n", encoding="utf-8")
    (finding,) = set(lint(tmp_path)) - alone
    assert finding.startswith(f"{tmp_path / 'broken.toml'}: line 1")


RESIDUALS, RUNS, PROBES = INVARIANTS.residuals, INVARIANTS.runs, INVARIANTS.probes
ORDER, AGREEMENT = INVARIANTS.orders[0], INVARIANTS.agreements[0]
MAGIC = "somehow it always was like that"

FLAWS: list[tuple[dict[str, Any], str]] = [
    ({"residuals": RESIDUALS[1:]}, f"metric {RESIDUALS[0].metric}: nothing uses it"),
    (
        {"residuals": (*RESIDUALS, replace(RESIDUALS[0], metric="stick.slides"))},
        "metric stick.slides: there is no such metric",
    ),
    ({"runs": [each for each in RUNS if each.run != "reset"]}, "run reset: nothing uses it"),
    ({"runs": (*RUNS, replace(RUNS[0], run="backward"))}, "run backward: there is no such run"),
    ({"probes": [p for p in PROBES if p.probe != "warns"]}, "probe warns: nothing uses it"),
    ({"probes": (*PROBES, replace(PROBES[0], probe="asks"))}, "probe asks: there is no such probe"),
    (
        {"agreements": (*INVARIANTS.agreements, replace(AGREEMENT, quantity="y"))},
        "quantity y: there is no such quantity",
    ),
    (
        {"orders": (replace(ORDER, cases=("default", "none")),)},
        f"{ORDER.id}: there is no case none",
    ),
    (
        {"probes": (replace(PROBES[0], means="It is bad."),)},
        f"{PROBES[0].id}: means: 'It is bad.' says too little",
    ),
    (
        {"probes": (replace(PROBES[0], source=99),)},
        f"{PROBES[0].id}: docs/theory.md has no equation (99)",
    ),
    (
        {"runs": (replace(RUNS[0], because=MAGIC),)},
        f"{RUNS[0].id}: because: 'somehow' is no reason",
    ),
    ({"residuals": RESIDUALS[:-1]}, f"there is no check {RESIDUALS[-1].id}"),
]


@pytest.mark.parametrize(("flaw", "told"), FLAWS, ids=[told for _, told in FLAWS])
def test_a_flaw_in_the_invariants_is_found(
    tmp_path: Path,
    alone: set[str],
    monkeypatch: pytest.MonkeyPatch,
    flaw: dict[str, Any],
    told: str,
) -> None:
    """What an invariant names but is missing, and what no invariant names, is one line."""
    shutil.copy(CASES_FOLDER / CASE, tmp_path)
    monkeypatch.setattr(linter, "load_invariants", lambda: replace(INVARIANTS, **flaw))
    new = set(lint(tmp_path)) - alone
    assert [found for found in new if found.endswith(told)], new


@pytest.mark.parametrize(
    ("loader", "error"),
    [
        ("load_invariants", InvariantError(Path("invariants.toml"), "pull", "no good")),
        ("load_mutants", MutantError(Path("fault.toml"), "id", "no good")),
    ],
)
def test_what_cannot_be_loaded_is_a_finding(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, loader: str, error: Exception
) -> None:
    """A broken file of invariants or faults is told as one line, and no traceback."""

    def fail() -> None:
        raise error

    monkeypatch.setattr(linter, loader, fail)
    assert lint(tmp_path) == [str(error)]


def test_a_fault_and_an_idle_check_must_name_checks(
    tmp_path: Path, alone: set[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A fault that names no check, and a reason for a check that does not exist, are told."""
    shutil.copy(CASES_FOLDER / CASE, tmp_path)
    mutants = load_mutants()
    wrong = replace(mutants[0], detected_by=("no-such-check",))
    monkeypatch.setattr(linter, "load_mutants", lambda: [*mutants, wrong])
    monkeypatch.setattr(
        linter, "reasons_to_stay", lambda: {"no-check": "short", "splitting": "magic"}
    )
    assert set(lint(tmp_path)) - alone == {
        f"planted fault {wrong.id}: there is no check no-such-check",
        "kills_nothing check no-check: there is no such check",
        "kills_nothing check no-check: 'short' says too little",
        "kills_nothing check splitting: 'magic' says too little",
        "kills_nothing check splitting: 'magic' is no reason",
    }


@pytest.mark.parametrize(("count", "found"), [(30, False), (31, True)])
def test_few_faults_substitute_text(
    tmp_path: Path, alone: set[str], monkeypatch: pytest.MonkeyPatch, count: int, found: bool
) -> None:
    """More than thirty faults that substitute text are told with their number."""
    shutil.copy(CASES_FOLDER / CASE, tmp_path)
    (mutant,) = load_mutants("output-renamed")
    monkeypatch.setattr(linter, "load_mutants", lambda: [mutant] * count)
    told = "faults: substitutions: 31 faults substitute text, 30 at most; let them override names"
    assert (told in set(lint(tmp_path)) - alone) == found


def test_a_broken_override_is_a_finding(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The form of an override is told with file, field and reason."""
    text = (FAULTS_FOLDER / "constant-g.toml").read_text(encoding="utf-8")
    file = tmp_path / "constant-g.toml"
    monkeypatch.setattr(linter, "load_mutants", lambda: load_mutants(folder=tmp_path))
    for old, new, told in (
        ("settings.Settings.", "Settings ", "line 8, overrides[0].target: 'Settings normal_force'"),
        ("normal_force(self)", "other(self)", "overrides[0].code: does not define normal_force"),
        ("return", "return if", "overrides[0].code: line 2 is not Python 3.8: invalid syntax"),
        ("code", "value = '1'\ncode", "overrides[0]: has both code and value"),
    ):
        file.write_text(text.replace(old, new, 1), encoding="utf-8")
        (finding,) = lint()
        assert finding.startswith(f"{file}: {told}")


def test_accepted_values_and_checks_belong_together(monkeypatch: pytest.MonkeyPatch) -> None:
    """A check without an accepted value is told with what to do, and a value of no check too."""
    values = {
        ("default", "x-course", "fmu"): 1.0,
        ("default", "stick-holds-x", "fmu"): 0.0,
        ("fast-pull", "order-of-x_dot", "reference"): 0.0,
        ("default", "gone", "fmu"): 1.0,
        ("forgotten", "x-course", "fmu"): 1.0,
        ("", "declared-units", "fmu"): 0.0,
    }
    monkeypatch.setattr(linter, "load_accepted", lambda: Accepted(values))
    findings = lint()
    run = "run stickslip verify --accept"
    stale = {found for found in findings if "of no check" in found}
    assert stale == {
        "default / gone (fmu): an accepted value of no check; run stickslip verify --accept",
        "forgotten / x-course (fmu): an accepted value of no check; run stickslip verify --accept",
    }
    for lost in (
        "default / x-course (reference)",
        "default / energy-balance (fmu)",
        "default / mirror (fmu)",
        "default / agree-on-x (both)",
        "fast-pull / order-of-z-asymptotic (reference)",
        " / declared-types (fmu)",
    ):
        assert f"{lost}: no accepted value; {run}" in findings
    for held in ("default / x-course (fmu)", " / declared-units (fmu)"):
        assert f"{held}: no accepted value; {run}" not in findings
