"""The suite lints itself: each kind of flaw in its data files is one finding."""

import json
import re
import shutil
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from stickslip_verification import InvariantError, lint, load_invariants, load_mutants
from stickslip_verification import __main__ as linter
from stickslip_verification.suite.cases import CASES_FOLDER

CASE = CASES_FOLDER / "default.toml"


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> set[str]:
    folder = tmp_path_factory.mktemp("alone")
    shutil.copy(CASE, folder)
    return set(lint(folder))


def findings(folder: Path, old: str = "^", new: str = "", name: str = CASE.name) -> set[str]:
    text, count = re.subn(old, new, CASE.read_text(encoding="utf-8"), count=1)
    assert count == 1
    (folder / name).write_text(text, encoding="utf-8")
    return set(lint(folder))


REFERENCE = r'reference = "[^"]+"'
LAST = r"slips = 31(?s:(.*))stop_time = 10.0"


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("^", 'id = "other"\n', "default.toml: its id is 'other', not the name"),
        (REFERENCE, 'reference = "so"', r"default / [\w-]+: because.reference: 'so' says too"),
        (REFERENCE, 'reference = "Tuned until it passes"', "because.reference: 'tuned' is no"),
        ("slips = 31", "slips = 30", "default: motion.slips = 30; it is 31$"),
        # At 9.8 s the 31st slip is under way: it counts or does not.
        ("stop_time = 10.0", "stop_time = 9.8", ""),
        (LAST, r"slips = 32\1stop_time = 9.8", "default: motion.slips = 32; it is 30 or 31$"),
        ("slips = 31", 'slips = 31, zero = ["x"]', "motion.zero: x is not zero throughout"),
        ("fixed = 0.01 }", "fixed = 10.0 }", "motion.zero: x_dot is zero throughout and not named"),
        (r"motion = \{[^}]*\}\n", "", r"motion is missing, .* write motion = \{ slips = 31 \}$"),
        (r"\[experiment\]", "[experiment", "default.toml: line"),
    ],
)
def test_a_flaw_in_a_case_is_found_in_one_line(
    tmp_path: Path, alone: set[str], old: str, new: str, words: str
) -> None:
    found = findings(tmp_path, old, new)
    assert any(re.search(words, each) for each in found - alone) if words else found == alone
    assert all("\n" not in each for each in found)


INVARIANTS = load_invariants()
OTHERS = INVARIANTS.residuals[1:]
FAULT, *_ = FAULTS = load_mutants()
BROKEN = InvariantError(Path("a.toml"), "pull", "no good")
NOWHERE = replace(FAULT, detected_by=("no-check",))


def one(part: str, **values: Any) -> dict[str, Any]:
    family = getattr(INVARIANTS, part)
    return {part: (*family, replace(family[0], **values))}


# What is loaded instead, or of the invariants, and the end of a finding.
FLAWS: list[tuple[str, Any, str]] = [
    ("load_invariants", {"residuals": OTHERS}, "metric energy.balance: nothing uses it"),
    ("load_invariants", one("residuals", metric="a.b"), "metric a.b: there is no such metric"),
    ("load_invariants", one("agreements", quantity="y"), "y: there is no such quantity"),
    ("load_invariants", one("orders", cases=("none",)), "there is no case none"),
    ("load_invariants", one("probes", means="Bad."), ": means: 'Bad.' says too little"),
    ("load_invariants", one("probes", source=99), "docs/theory.md has no equation (99)"),
    ("load_invariants", one("runs", because="somehow it was so"), "'somehow' is no reason"),
    ("load_invariants", BROKEN, "a.toml: pull: no good"),
    ("load_mutants", [*FAULTS, NOWHERE], f"fault {FAULT.id}: there is no check no-check"),
    ("load_invariants", one("runs", stays="Because."), ": stays: 'Because.' says too little"),
]


@pytest.mark.parametrize("flaw", FLAWS)
def test_a_flaw_in_invariants_and_faults_is_found(
    tmp_path: Path, alone: set[str], monkeypatch: pytest.MonkeyPatch, flaw: tuple[str, Any, str]
) -> None:
    loader, instead, words = flaw

    def load() -> Any:
        if isinstance(instead, Exception):
            raise instead
        return replace(INVARIANTS, **instead) if loader == "load_invariants" else instead

    monkeypatch.setattr(linter, loader, load)
    new = findings(tmp_path) - alone
    assert any(each.endswith(words) for each in new), new


def test_two_of_a_name_and_a_broken_file_do_not_hide_each_other(tmp_path: Path) -> None:
    (tmp_path / "broken.toml").write_text("id = =\n", encoding="utf-8")
    findings(tmp_path)
    found = findings(tmp_path, "^", 'id = "default"\n', name="b.toml")
    assert "default: 2 cases have this id" in found
    assert any(each.startswith(f"{tmp_path / 'broken.toml'}: line 1") for each in found)


def test_the_schema_for_editors_has_the_keys_of_a_case(capsys: pytest.CaptureFixture[str]) -> None:
    assert linter.main(["schema", "case"]) == 0
    keys = tomllib.loads((CASES_FOLDER / "damped-cycle.toml").read_text("utf-8"))
    assert {"about", *keys} <= set(json.loads(capsys.readouterr().out)["properties"])
