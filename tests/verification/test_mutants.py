"""Planted faults: their descriptions, and the FMUs that are made of them."""

import ast
import re
import zipfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from stickslip_verification import Mutant, MutantError, load_cases, load_invariants, load_mutants
from stickslip_verification.drive.planting import plant
from stickslip_verification.suite.faults import Addition, Override, Substitution
from tests.conftest import built
from tests.driver import Fmu, Instance

MUTANTS = load_mutants()
INSIDE = [mutant for mutant in MUTANTS if mutant.changes_the_fmu]
PACKAGE = re.compile(r"stickslip_fmu_[0-9a-f]{16}")

GOOD = '''\
id = "good"
about = "It is enough to be read."
detected_by = ["F_s-course"]

[[additions]]
file = "more.py"
text = "MORE = 1.0"

[[overrides]]
target = "coefficients.friction_forces"
code = """
def friction_forces(mu_s, mu_k_used, normal):
    return original(1.001 * mu_s, mu_k_used, normal)
"""

[[overrides]]
target = "coefficients._CLAMP_GAP"
value = "0.1 * original"
'''
SUBSTITUTION = """
[[substitutions]]
file = "coefficients.py"
find = "a"
replace = "b"

[[overrides]]
"""
FUTURE = "from __future__ import annotations\ndef friction_"
MATCH = "    match 1:\n        case _: pass\n    return orig"


def read(folder: Path, text: str) -> Mutant:
    (folder / "good.toml").write_text(text, encoding="utf-8")
    return load_mutants(folder=folder)[0]


class Start:
    """Starts FMUs with overrides planted in them."""

    def __init__(self, fmu: Path, fault: Mutant, folder: Path) -> None:
        self.fmu, self.fault, self.folder = fmu, fault, folder
        self.instances: list[Instance] = []

    def __call__(self, *overrides: Override, **values: float) -> Instance:
        mutant = replace(self.fault, overrides=overrides, additions=())
        file = self.folder / f"{len(self.instances)}.fmu"
        fmu = plant(self.fmu, mutant, file) if overrides else self.fmu
        self.instances.append(Fmu(fmu).started(**values))
        return self.instances[-1]


@pytest.fixture
def started(fmu_path: Path, tmp_path: Path) -> Iterator[Start]:
    """Give what starts FMUs, freed at the end of the test."""
    start = Start(fmu_path, read(tmp_path, GOOD), tmp_path)
    yield start
    for instance in start.instances:
        instance.free()


def opened(fmu: Path) -> tuple[dict[str, str], str, str]:
    """Return the texts of an FMU without its GUID and the name of its package, and these two."""
    with zipfile.ZipFile(fmu) as archive:
        names = [name for name in archive.namelist() if name.endswith((".py", ".txt", ".xml"))]
        texts = {name: archive.read(name).decode() for name in names}
    (package,) = set(PACKAGE.findall(" ".join((*texts, *texts.values()))))
    (guid,) = re.findall(r'guid="([^"]+)"', texts["modelDescription.xml"])
    plain = {n: text.replace(package, "P").replace(guid, "G") for n, text in texts.items()}
    return {name.replace(package, "P"): text for name, text in plain.items()}, guid, package


@pytest.mark.gate
def test_a_fault_of_the_suite_changes_the_described_files_and_the_names_of_the_fmu(
    tmp_path: Path,
) -> None:
    originals = {law: built("python-2", law) for law in {mutant.law for mutant in INSIDE}}
    known = {law: opened(fmu) for law, fmu in originals.items()}
    names: list[tuple[str, ...]] = [each[1:] for each in known.values()]
    for mutant in INSIDE:
        texts, *own = opened(plant(originals[mutant.law], mutant, tmp_path))
        changed = dict(texts.items() - known[mutant.law][0].items())
        described = {change.file for change in mutant.substitutions}
        described |= {addition.file for addition in mutant.additions}
        described |= {f"{each.module.rpartition('.')[2]}.py" for each in mutant.overrides}
        assert {Path(name).name for name in changed} == {Path(each).name for each in described}
        for name, text in changed.items():
            if name.endswith(".py"):
                ast.parse(text, filename=f"{mutant.id}: {name}", feature_version=(3, 8))
        names.append(tuple(own))
    # So all of them load in one process.
    assert [len(set(column)) for column in zip(*names, strict=True)] == [len(names)] * 2


def test_the_suite_has_faults_inside_the_fmu_and_in_its_calls(foreign_fmu: Path) -> None:
    between = [mutant for mutant in MUTANTS if not mutant.changes_the_fmu]
    assert len(INSIDE) >= 40
    assert len(between) >= 15
    assert {plant(foreign_fmu, mutant, foreign_fmu.parent) for mutant in between} == {foreign_fmu}
    known = {check.id for case in load_cases() for check in case.checks}
    known |= {invariant.id for invariant in load_invariants()}
    assert {m.id: set(m.detected_by) - known for m in MUTANTS if set(m.detected_by) - known} == {}


def test_the_same_fault_gives_the_same_bytes_under_any_name(fmu_path: Path, tmp_path: Path) -> None:
    (mutant,) = load_mutants("constant-mu-s")
    files = [plant(fmu_path, mutant, tmp_path / name) for name in ("new/first.fmu", "")]
    assert files == [tmp_path / "new" / "first.fmu", tmp_path / "constant-mu-s.fmu"]
    assert files[0].read_bytes() == files[1].read_bytes()


# What stands in GOOD, what stands there instead, and the words of the refusal.
REFUSED = [
    ('"good"\n', "= 5\n", "line 1"),
    ('id = "good"', 'id = "no good"', "id: 'no good' does not match"),
    ('id = "good"', 'id = "better"', "id: 'better' is not the name of the file"),
    ('"It is enough to be read."', '" "', "about: ' ' does not match"),
    ('["F_s-course"]', "[]", r"detected_by: \[\] should be non-empty"),
    (GOOD[GOOD.index("[[ov") :], "", "plants nothing"),
    ('"coefficients._CLAMP_GAP"', '"_CLAMP_GAP"', r"overrides\[1\].target"),
    ('value = "0.1 * original"', "", r"overrides\[1\]: has neither code nor value"),
    ("value =", 'code = "_CLAMP_GAP = 1"\nvalue =', r"overrides\[1\]: has both code and value"),
    ("value =", 'find = "0"\nvalue =', "'find'"),
    ('"0.1 * original"', '"0.1 *"', r"overrides\[1\].value: line 1 is not Python 3.8"),
    ("def friction_", FUTURE, r"overrides\[0\].code: line 2 is not Python 3.8: from __future__"),
    ("    return orig", MATCH, r"overrides\[0\].code: line 4 is not Python 3.8: Pattern"),
    ("def friction_", "def other_", r"overrides\[0\].code: does not define friction_forces"),
    ('"coefficients.fr', '"master.fr', r"overrides\[0\].target: .*get, set, step, reset"),
    ('"coefficients._CLAMP_GAP"', '"master.get"', r"overrides\[1\].value: .*replaced by code"),
    ("[[overrides]]", SUBSTITUTION.replace(".py", ".txt"), r"substitutions\[0\].file"),
    ("[[overrides]]", SUBSTITUTION.replace('"b"', '"a"'), r"substitutions\[0\].replace"),
    ('text = "MORE = 1.0"\n', "", r"additions\[0\]"),
    ('text = "MORE = 1.0"', 'source = "a.py.txt"', r"additions\[0\].source: a.py.txt: no such"),
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


def test_faults_are_chosen_by_pattern(tmp_path: Path) -> None:
    assert {mutant.id.partition("-")[0] for mutant in load_mutants("state-*")} == {"state"}
    with pytest.raises(MutantError, match="no planted fault matches 'nothing'"):
        load_mutants("nothing")
    (tmp_path / "text.fmu").write_text("not an FMU", encoding="utf-8")
    with pytest.raises(MutantError, match=r"text\.fmu: cannot be read"):
        plant(tmp_path / "text.fmu", INSIDE[0], tmp_path)


def changed(find: str, new: str = "n", file: str = "coefficients.py") -> dict[str, object]:
    return {"substitutions": (Substitution(file, find, new),)}


def overriding(target: str) -> dict[str, object]:
    return {"overrides": (Override(target, value="None"),)}


LOST = [
    *("clutch.engage", "coefficients.breakaway", "block.Clutch.advance", "block.Block.engage"),
    *("block.advance.engage", "face.Fmi2Slave.do_step", "face.Slave.engage"),
]


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        (changed("normal"), "matches 4 times in coefficients.py, not once"),
        (changed("no such"), "matches 0 times in coefficients.py, not once"),
        (changed("normal", file="clutch.py"), "no clutch.py in the FMU"),
        (changed("return mu_s * normal", "return mu_s * *"), "is not Python any more"),
        ({"additions": (Addition("stickslip_fmu/block.py", "pass"),)}, "is packed already"),
        (overriding("law.friction_forces"), "may be in stickslip_fmu/laws/coulomb/law.py, "),
        *((overriding(target), f"target: no {target} in the FMU$") for target in LOST),
    ],
)
def test_a_fault_that_does_not_fit_the_fmu_is_refused_and_nothing_is_written(
    fmu_path: Path, tmp_path: Path, fault: dict[str, object], words: str
) -> None:
    parts = {"overrides": (), "substitutions": (), "additions": (), **fault}
    mutant = replace(read(tmp_path, GOOD), **parts)  # type: ignore[arg-type]
    with pytest.raises(MutantError, match=words) as refused:
        plant(fmu_path, mutant, tmp_path / "out")
    assert str(refused.value).startswith(str(tmp_path / "good.toml"))
    assert not (tmp_path / "out").exists()


def test_mutants_run_beside_the_original_in_one_process(started: Start) -> None:
    code = "def friction_forces(mu_s, *more):\n    return original(1.001 * mu_s, *more)"
    # Where it is defined, and where a module took it from there.
    targets = (f"{module}.friction_forces" for module in ("coefficients", "coulomb.law"))
    for instance in [started(), *(started(Override(target, code)) for target in targets)]:
        instance.step(1.0)
    found = [each.get("F_s") for each in started.instances]
    assert found == [[mu_s * 9.81] for mu_s in (0.5, 1.001 * 0.5, 1.001 * 0.5)]


def test_an_override_reaches_what_it_replaces_in_any_member_of_a_class(started: Start) -> None:
    doubled = "@property\ndef f(self):\n    return 2.0 + original.fget(self)"
    longer = "def pass_stick(self, duration):\n    original(self, 3.0 * duration)"
    static = "@staticmethod\ndef _fmu_state_to_bytes(handle):\n    return b'*' + original(handle)"
    inherited = "def _warn(self):\n    original(self)\n    self.log(self._log_is_printf)"
    instance = started(
        Override("meter.CycleMeter.f", doubled),
        Override("meter.CycleMeter.pass_stick", longer),
        Override("instance.Instance._fmu_state_to_bytes", static),
        Override("face.Slave._log_is_printf", value="'anew'"),
        Override("face.Slave._warn", inherited),
        # Overrides of one name lie over one another.
        Override("coefficients._CLAMP_GAP", value="0.25"),
        Override("coefficients._CLAMP_GAP", value="original + 0.125"),
        mu_k=0.6,
    )
    assert instance.get("f", "mu_k_used") == [2.0, 0.5 - 0.375]
    instance.step(0.3)
    # Break-away is at mu_s m g/(k v).
    assert instance.get("t_stick") == pytest.approx([3.0 * 0.5 * 9.81 / 20.0], rel=1e-12)
    assert instance.pack().startswith(b"*")
    assert "anew" in [text for *_, text in instance.fmu.messages]
