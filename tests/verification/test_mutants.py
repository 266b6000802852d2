"""Planted faults: their descriptions, and the FMUs that are made of them."""

from dataclasses import replace
from pathlib import Path

import pytest

from stickslip_verification import Mutant, MutantError, load_mutants
from stickslip_verification.suite.faults import Override, Substitution, plant
from tests.driver import Fmu

GOOD = '''\
[good]
about = "It is enough to be read."
detected_by = ["F_s-course"]
additions."more.py" = "more.py.txt"
overrides."coefficients.friction_forces" = """
def friction_forces(mu_s, mu_k_used, normal):
    return original(1.001 * mu_s, mu_k_used, normal)
"""
overrides."coefficients._CLAMP_GAP" = "_CLAMP_GAP = 0.1 * original"
'''
FUTURE = "from __future__ import annotations\ndef friction_"
MATCH = "    match 1:\n        case _: pass\n    return orig"


def read(folder: Path, text: str) -> Mutant:
    (folder / "good.toml").write_text(text, encoding="utf-8")
    (folder / "more.py.txt").write_text("MORE = 1.0", encoding="utf-8")
    return load_mutants(files=folder)[0]


# What stands in GOOD, what stands there instead, and the words of the refusal.
REFUSED = [
    ("[good]", "[good", "line 1"),
    ("[good]", "['no good']", "line 1, no good.id: 'no good' should match pattern"),
    ('["F_s-course"]', "[]", r"line 3, good.detected_by: should have at least 1 item"),
    (GOOD[GOOD.index("overrides") :], "", "line 1, good: needs overrides or substitutions"),
    ("0.1 * original", "0.1 *", r"line 9, good.overrides.coeff.*: line 1 is not Python 3.8"),
    (
        "def friction_",
        FUTURE,
        r"line 5, good.overrides.coeff.*: line 2 is not Python 3.8: from",
    ),
    ("    return orig", MATCH, r"overrides.*: line 4 is not Python 3.8: Pattern"),
    ("def friction_", "def other_", r"overrides.*: does not define friction_forces"),
    ('"coefficients.fr', '"master.fr', r"overrides.*: .*get, set, step, reset"),
    ("more.py.txt", "a.py.txt", r"line 4, good.additions.more.py: a.py.txt: no such"),
]


@pytest.mark.parametrize(("old", "new", "words"), REFUSED)
def test_a_broken_description_is_refused_by_file_field_and_reason_in_one_line(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    assert old in GOOD
    with pytest.raises(MutantError, match=words) as refused:
        read(tmp_path, GOOD.replace(old, new, 1))
    assert str(refused.value).startswith(str(tmp_path / "good.toml"))
    assert "\n" not in str(refused.value)


def find(text: str, new: str = "n", file: str = "coefficients.py") -> dict[str, object]:
    return {"substitutions": (Substitution(file, text, new),)}


def target(name: str) -> dict[str, object]:
    return {"overrides": (Override(name, f"{name.rpartition('.')[2]} = None"),)}


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        (find("normal"), "matches 4 times in coefficients.py, not once"),
        (find("normal", file="clutch.py"), "no clutch.py in the FMU"),
        (find("return mu_s * normal", "return mu_s * *"), "is not Python any more"),
        ({"additions": {"stickslip_fmu/block.py": "more.py.txt"}}, "is packed already"),
        (target("law.friction_forces"), "may be in stickslip_fmu/laws/coulomb/law.py, "),
        (target("clutch.engage"), "overrides: no clutch.engage in the FMU$"),
    ],
)
def test_a_fault_that_does_not_fit_the_fmu_is_refused_and_nothing_is_written(
    fmu_path: Path, tmp_path: Path, fault: dict[str, object], words: str
) -> None:
    parts = {"overrides": (), "substitutions": (), "additions": {}, **fault}
    mutant = replace(read(tmp_path, GOOD), **parts)  # type: ignore[arg-type]
    with pytest.raises(MutantError, match=words) as refused:
        plant(fmu_path, mutant, tmp_path / "out")
    assert str(refused.value).startswith(str(tmp_path / "good.toml"))
    assert not (tmp_path / "out").exists()
    with pytest.raises(MutantError, match="no planted fault matches 'nothing'"):
        load_mutants("nothing")


def test_a_mutant_runs_beside_the_original_in_one_process_and_changes_what_it_names(
    fmu_path: Path, tmp_path: Path
) -> None:
    heavier = "def friction_forces(mu_s, *more):\n    return original(1.001 * mu_s, *more)"
    doubled = "@property\ndef f(self):\n    return 2.0 + original.fget(self)"
    longer = "def pass_stick(self, duration):\n    original(self, 3.0 * duration)"
    static = "@staticmethod\ndef _fmu_state_to_bytes(handle):\n    return b'*' + original(handle)"
    inherited = "def _warn(self):\n    original(self)\n    self.log('anew')"
    overrides = (
        # A module took it from where it is defined.
        Override("coulomb.law.friction_forces", heavier),
        Override("meter.CycleMeter.f", doubled),
        Override("meter.CycleMeter.pass_stick", longer),
        Override("instance.Instance._fmu_state_to_bytes", static),
        Override("slave.Packed._warn", inherited),
        # Overrides of one name lie over one another.
        Override("coefficients._CLAMP_GAP", "_CLAMP_GAP = 0.25"),
        Override("coefficients._CLAMP_GAP", "_CLAMP_GAP = original + 0.125"),
    )
    mutant = replace(read(tmp_path, GOOD), overrides=overrides, additions={})
    original = Fmu(fmu_path).started()
    instance = Fmu(plant(fmu_path, mutant, tmp_path / "mutant.fmu")).started(mu_k=0.6)
    for each in (original, instance):
        each.step(0.3)
    assert original.get("F_s", "f", "mu_k_used") == [0.5 * 9.81, 0.0, 0.3]
    assert instance.get("F_s", "f", "mu_k_used") == [1.001 * 0.5 * 9.81, 2.0, 0.5 - 0.375]
    # Break-away is at mu_s m g/(k v).
    expected = 3.0 * 1.001 * 0.5 * 9.81 / 20.0
    assert instance.get("t_stick") == pytest.approx([expected], rel=1e-12)
    assert instance.pack().startswith(b"*")
    assert "anew" in [text for *_, text in instance.fmu.messages]
    original.free()
    instance.free()
