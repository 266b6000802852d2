"""Facts about the planted faults: their descriptions, and the FMUs that are made of them."""

import ast
import importlib
import re
import sys
import textwrap
import zipfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from unittest.mock import patch

import fmpy
import pytest
from fmpy.fmi2 import FMU2Slave

from stickslip_fmu.packer import build
from stickslip_verification import load_cases
from stickslip_verification.drive.planting import plant
from stickslip_verification.suite.faults import (
    Addition,
    Mutant,
    MutantError,
    Override,
    Substitution,
    load_mutants,
)
from stickslip_verification.suite.invariants import load_invariants
from stickslip_verification.truth import COULOMB_NAME

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


def read(folder: Path, text: str) -> Mutant:
    """Write a description and load it."""
    (folder / "good.toml").write_text(text, encoding="utf-8")
    return load_mutants(folder=folder)[0]


def named(name: str) -> Mutant:
    """Return the planted fault of this id."""
    return next(mutant for mutant in MUTANTS if mutant.id == name)


def texts(fmu: Path) -> dict[str, str]:
    """Return the texts of an FMU by their names."""
    with zipfile.ZipFile(fmu) as archive:
        return {
            name: archive.read(name).decode("utf-8")
            for name in archive.namelist()
            if name.endswith((".py", ".txt", ".xml"))
        }


def touched(mutant: Mutant) -> set[str]:
    """Return the files that a fault changes or brings along."""
    changed = {substitution.file for substitution in mutant.substitutions}
    changed |= {f"{each.module.rpartition('.')[2]}.py" for each in mutant.overrides}
    changed |= {addition.file for addition in mutant.additions}
    return {Path(file).name for file in changed}


def packages(fmu: Path) -> set[str]:
    """Return every name of the packed package that stands anywhere in an FMU."""
    return {found for entry in texts(fmu).items() for found in PACKAGE.findall(" ".join(entry))}


def guid(fmu: Path) -> str:
    """Return the GUID of an FMU."""
    return str(fmpy.read_model_description(str(fmu)).guid)


@pytest.fixture(scope="module")
def originals(fmu_path: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Return the FMU without faults of each friction law that faults are for."""
    folder = tmp_path_factory.mktemp("originals")
    laws = {mutant.law for mutant in INSIDE} - {COULOMB_NAME}
    return {COULOMB_NAME: fmu_path, **{law: build(folder, law=law) for law in sorted(laws)}}


@pytest.fixture(scope="module")
def planted(
    originals: dict[str, Path], tmp_path_factory: pytest.TempPathFactory
) -> dict[str, Path]:
    """Return the FMU of every fault that changes it, by id."""
    folder = tmp_path_factory.mktemp("mutants")
    return {mutant.id: plant(originals[mutant.law], mutant, folder) for mutant in INSIDE}


def test_there_are_enough_faults(planted: dict[str, Path]) -> None:
    """At least 40 faults change the FMU, and each can be planted in it as it is built."""
    assert len(planted) >= 40
    assert all(path.name == f"{name}.fmu" for name, path in planted.items())


def test_a_fault_in_the_calls_changes_no_fmu(foreign_fmu: Path, tmp_path: Path) -> None:
    """At least 15 faults act between the suite and an FMU: they take any FMU as it is."""
    between = [mutant for mutant in MUTANTS if not mutant.changes_the_fmu]
    assert len(between) >= 15
    assert {plant(foreign_fmu, mutant, tmp_path) for mutant in between} == {foreign_fmu}
    assert all(mutant.hooks for mutant in between)


def test_every_mutant_has_its_own_name_and_guid(
    originals: dict[str, Path], planted: dict[str, Path]
) -> None:
    """No two of the original and the mutants share a package name or a GUID; the old are gone."""
    fmus = [*originals.values(), *planted.values()]
    names = [packages(fmu) for fmu in fmus]
    assert {len(each) for each in names} == {1}
    assert len(set.union(*names)) == len(fmus)
    assert len({guid(fmu) for fmu in fmus}) == len(fmus)


def test_a_mutant_differs_where_its_description_says(
    originals: dict[str, Path], planted: dict[str, Path]
) -> None:
    """But for names and GUID a mutant is the original with the described files changed."""

    def anonymous(fmu: Path) -> dict[str, str]:
        unnamed = {PACKAGE.sub("P", name): PACKAGE.sub("P", t) for name, t in texts(fmu).items()}
        xml = "modelDescription.xml"
        return unnamed | {xml: re.sub('guid="[^"]*"', "", unnamed[xml])}

    known = {law: anonymous(fmu) for law, fmu in originals.items()}
    for mutant in INSIDE:
        original = known[mutant.law]
        changed = set(dict(original.items() ^ anonymous(planted[mutant.id]).items()))
        assert {Path(name).name for name in changed} == touched(mutant), mutant.id


def test_what_is_planted_is_python_3_8(planted: dict[str, Path]) -> None:
    """Every module that a fault changes or brings along has the syntax of Python 3.8."""
    for mutant in INSIDE:
        for name, text in texts(planted[mutant.id]).items():
            if PACKAGE.search(name) and Path(name).name in touched(mutant):
                ast.parse(text, filename=f"{mutant.id}: {name}", feature_version=(3, 8))


def test_planting_is_repeatable(fmu_path: Path, tmp_path: Path) -> None:
    """The same fault in the same FMU gives the same bytes, under any file name."""
    mutant = named("constant-mu-s")
    first = plant(fmu_path, mutant, tmp_path / "new" / "first.fmu")
    second = plant(fmu_path, mutant, tmp_path)
    assert first == tmp_path / "new" / "first.fmu"
    assert second == tmp_path / "constant-mu-s.fmu"
    assert first.read_bytes() == second.read_bytes()


@contextmanager
def running(fmu: Path, folder: Path) -> Iterator[Callable[[str], float]]:
    """Run an FMU for one step of 1 s and hand out a function that reads a Real by name."""
    description = fmpy.read_model_description(str(fmu), validate=True)
    references = {each.name: each.valueReference for each in description.modelVariables}
    slave = FMU2Slave(
        guid=description.guid,
        unzipDirectory=fmpy.extract(str(fmu), unzipdir=str(folder / fmu.stem)),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName=fmu.stem,
    )
    slave.instantiate()
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    slave.doStep(0.0, 1.0)
    try:
        yield lambda name: float(slave.getReal([references[name]])[0])
    finally:
        slave.freeInstance()


def test_mutants_run_beside_the_original(
    fmu_path: Path, planted: dict[str, Path], tmp_path: Path
) -> None:
    """In one process the original and two mutants each run their own code."""
    fmus = (planted["constant-mu-s"], fmu_path, planted["meter-nanosecond-clock"])
    with ExitStack() as stack:
        reads = [stack.enter_context(running(fmu, tmp_path)) for fmu in fmus]
        high, right, other = (read("F_s") for read in reads)
        assert (high, right, other) == (1.001 * 0.5 * 9.81, 0.5 * 9.81, 0.5 * 9.81)
        assert reads[0]("x") != reads[1]("x") == reads[2]("x")


def test_every_conviction_is_by_a_check_that_exists() -> None:
    """Each check that a description names in advance is one of a case or an invariant."""
    known = {check.id for case in load_cases() for check in case.checks}
    known |= {invariant.id for invariant in load_invariants()}
    unknown = {m.id: set(m.detected_by) - known for m in MUTANTS if set(m.detected_by) - known}
    assert unknown == {}


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('"good"\n', "= 5\n", "line 1: Invalid value"),
        ('id = "good"', 'id = "no good"', "id: 'no good' does not match"),
        ('id = "good"', 'id = "better"', "id: 'better' is not the name of the file"),
        ('id = "good"', 'id = "good"\ncolour = 1', "Additional properties.*'colour'"),
        ('"It is enough to be read."', '" "', "about: ' ' does not match"),
        ('["F_s-course"]', "[]", r"detected_by: \[\] should be non-empty"),
        ('["F_s-course"]', '["F_s course"]', r"detected_by\[0\]: 'F_s course' does not match"),
        ('["F_s-course"]', '["a", "a"]', "detected_by: .* has non-unique elements"),
        (GOOD[GOOD.index("[[ov") :], "", "plants nothing: .* neither overrides nor substitutions"),
        ('"coefficients._CLAMP_GAP"', '"_CLAMP_GAP"', r"overrides\[1\].target: .* does not match"),
        ('"coefficients._CLAMP_GAP"', '"a.b.C.D.e"', r"overrides\[1\].target: .* does not match"),
        ('value = "0.1 * original"', "", r"overrides\[1\]: has neither code nor value"),
        ("value =", 'code = "_CLAMP_GAP = 1"\nvalue =', r"overrides\[1\]: has both code and value"),
        ("value =", 'find = "0"\nvalue =', "Additional properties.*'find'"),
        ('"0.1 * original"', '"0.1 *"', r"overrides\[1\].value: line 1 is not Python 3.8"),
        (
            "def friction_",
            "from __future__ import annotations\ndef friction_",
            r"overrides\[0\].code: line 2 is not Python 3.8: from __future__",
        ),
        ('"0.1 * original"', '"a = 1"', r"overrides\[1\].value: line 1 is not Python 3.8"),
        (
            "    return orig",
            "    match 1:\n        case _: pass\n    return orig",
            r"overrides\[0\].code: line 4 is not Python 3.8: Pattern",
        ),
        ("def friction_", "def other_", r"overrides\[0\].code: does not define friction_forces"),
        (
            '"coefficients.friction_forces"',
            '"master.friction_forces"',
            r"overrides\[0\].target: no such call of the .* there are get, set, step, reset",
        ),
        (
            '"coefficients._CLAMP_GAP"',
            '"master.get"',
            r"overrides\[1\].value: .* is replaced by code",
        ),
        (
            "[[overrides]]",
            SUBSTITUTION.replace(".py", ".txt"),
            r"substitutions\[0\].file: .* not match",
        ),
        (
            "[[overrides]]",
            SUBSTITUTION.replace('"b"', '"a"'),
            r"substitutions\[0\].replace: is what",
        ),
        ('text = "MORE = 1.0"\n', "", r"additions\[0\]"),
        ('text = "MORE', 'source = "m.py.txt"\ntext = "MORE', r"additions\[0\]"),
        (
            'text = "MORE = 1.0"',
            'source = "none.py.txt"',
            r"additions\[0\].source: none.py.txt: no such file",
        ),
    ],
)
def test_a_broken_description_is_refused_by_file_field_and_reason(
    tmp_path: Path, old: str, new: str, told: str
) -> None:
    """A description with a mistake is refused with its name, the place and the reason."""
    assert old in GOOD
    with pytest.raises(MutantError, match=told) as caught:
        read(tmp_path, GOOD.replace(old, new, 1))
    assert str(caught.value).startswith(str(tmp_path / "good.toml"))
    assert "\n" not in str(caught.value)


def test_faults_are_chosen_by_pattern(tmp_path: Path) -> None:
    """A shell pattern chooses faults; one that matches nothing is an error, not an empty run."""
    assert {mutant.id.partition("-")[0] for mutant in load_mutants("state-*")} == {"state"}
    with pytest.raises(MutantError, match="no planted fault matches 'nothing'"):
        load_mutants("nothing")
    with pytest.raises(MutantError, match="no such folder"):
        load_mutants(folder=tmp_path / "nowhere")
    (tmp_path / "good.toml").write_bytes(b"\xff")
    with pytest.raises(MutantError, match=r"good.toml: is not UTF-8"):
        load_mutants(folder=tmp_path)


def test_faults_may_share_a_module(tmp_path: Path) -> None:
    """A module that a fault brings along stands in its description or in a file beside it."""
    (tmp_path / "more.py.txt").write_text("MORE = 2.0\n", encoding="utf-8")
    shared = GOOD.replace('text = "MORE = 1.0"', 'source = "more.py.txt"')
    assert read(tmp_path, GOOD).additions == (Addition("more.py", "MORE = 1.0"),)
    assert read(tmp_path, shared).additions == (Addition("more.py", "MORE = 2.0\n"),)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (
            Substitution("coefficients.py", "normal", "n"),
            "matches 4 times in coefficients.py, not once",
        ),
        (
            Substitution("coefficients.py", "no such", "n"),
            "matches 0 times in coefficients.py, not once",
        ),
        (Substitution("clutch.py", "normal", "n"), "no clutch.py in the FMU"),
        (
            Substitution("coefficients.py", "return mu_s * normal", "return mu_s * *"),
            r"coefficients.py: line \d+ is not Python any more",
        ),
    ],
)
def test_a_substitution_that_does_not_fit_is_refused(
    fmu_path: Path, tmp_path: Path, change: Substitution, told: str
) -> None:
    """A fault is planted exactly once or not at all: no match and two matches are errors."""
    mutant = replace(read(tmp_path, GOOD), overrides=(), substitutions=(change,))
    with pytest.raises(MutantError, match=told) as caught:
        plant(fmu_path, mutant, tmp_path / "out")
    assert str(caught.value).startswith(str(tmp_path / "good.toml"))
    assert not (tmp_path / "out").exists()


def imported(fmu: Path, mutant: Mutant, folder: Path, module: str) -> ModuleType:
    """Plant a fault and import a module of the packed source."""
    with zipfile.ZipFile(plant(fmu, mutant, folder)) as archive:
        (package,) = packages(Path(archive.filename or ""))
        archive.extractall(folder)
    with patch.object(sys, "path", [str(folder / "resources"), *sys.path]):
        return importlib.import_module(f"{package}.stickslip_fmu.{module}")


def overriding(folder: Path, *overrides: Override) -> Mutant:
    """Describe a fault of these overrides."""
    return replace(read(folder, GOOD), overrides=overrides, additions=())


def test_an_override_replaces_and_reaches_what_it_replaces(fmu_path: Path, tmp_path: Path) -> None:
    """Code and value see the original; who imported the name before has the replacement too."""
    fault = replace(read(tmp_path, GOOD), additions=())
    friction = imported(fmu_path, fault, tmp_path, "laws.coulomb.coefficients")
    mu_s = 1.001 * 0.5
    expected = (mu_s * 10.0, 0.3 * 10.0, (mu_s - 0.3) * 10.0)
    assert friction.friction_forces(0.5, 0.3, 10.0) == expected
    assert friction.kinetic_coefficient(0.5, 0.6) == 0.5 - 0.001
    law = importlib.import_module(friction.__name__.replace("coefficients", "law"))
    assert law.friction_forces is friction.friction_forces


def test_overrides_of_one_name_are_laid_over_one_another(fmu_path: Path, tmp_path: Path) -> None:
    """The second override of a name has the first one for its original."""
    twice = (
        Override("coefficients._CLAMP_GAP", value=value) for value in ("0.5", "original + 1.0")
    )
    friction = imported(
        fmu_path, overriding(tmp_path, *twice), tmp_path, "laws.coulomb.coefficients"
    )
    assert friction._CLAMP_GAP == 1.5


def test_any_member_of_a_class_can_be_overridden(fmu_path: Path, tmp_path: Path) -> None:
    """Property, method of a class with slots, class attribute, static method, inherited name."""
    fault = overriding(
        tmp_path,
        Override(
            "meter.CycleMeter.f", "@property\ndef f(self):\n    return 2.0 + original.fget(self)"
        ),
        Override(
            "meter.CycleMeter.pass_stick",
            "def pass_stick(self, duration):\n    original(self, 3.0 * duration)",
        ),
        Override("instance.Instance._log_is_printf", value="not original"),
        Override(
            "instance.Instance._fmu_state_to_bytes",
            "@staticmethod\ndef _fmu_state_to_bytes(handle):\n    return b'*' + original(handle)",
        ),
        Override(
            "face.Slave._warn", "def _warn(self):\n    original(self)\n    self.warned = True"
        ),
    )
    meter = imported(fmu_path, fault, tmp_path, "meter")
    package = meter.__name__.partition(".")[0]
    instance, slave = (
        importlib.import_module(f"{package}.{name}") for name in ("fmukit.instance", "slave")
    )
    counting = meter.CycleMeter(0.0)
    counting.pass_stick(1.0)
    counting.break_away(1.0)
    assert (counting.t_stick, counting.f) == (3.0, 2.0)
    assert instance.Instance._log_is_printf
    assert slave.Packed(instance_name="a")._fmu_state_to_bytes(None) == b"*null"
    packed = slave.Packed(instance_name="b")
    packed._warn()
    assert packed.warned
    assert "warned" not in instance.Instance._warn.__code__.co_names


def test_an_imported_name_can_be_overridden(fmu_path: Path, tmp_path: Path) -> None:
    """Where a module took a name from another, it alone gets the replacement."""
    fault = overriding(tmp_path, Override("block.add", "from operator import sub as add"))
    block = imported(fmu_path, fault, tmp_path, "block")
    compensated = importlib.import_module(block.__name__.replace("block", "numerics.compensated"))
    assert block.add(3.0, 1.0) == 2.0
    assert compensated.add((3.0, 0.0), 1.0) == (4.0, 0.0)


@pytest.mark.parametrize(
    "target",
    [
        "clutch.engage",
        "coefficients.breakaway",
        "block.Clutch.advance",
        "block.Block.engage",
        "block.advance.engage",
        "face.Fmi2Slave.do_step",
        "face.Slave.engage",
    ],
)
def test_a_target_that_is_gone_is_named(fmu_path: Path, tmp_path: Path, target: str) -> None:
    """An override of a name that the packed source has no more is refused with this name."""
    mutant = overriding(tmp_path, Override(target, value="None"))
    told = rf"good.toml: overrides\[0\].target: no {target} in the FMU$"
    with pytest.raises(MutantError, match=told):
        plant(fmu_path, mutant, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_an_override_is_no_copy(fmu_path: Path, tmp_path: Path) -> None:
    """Code with more than five lines of what it replaces is refused with their number."""
    with zipfile.ZipFile(fmu_path) as archive:
        (name,) = (each for each in archive.namelist() if each.endswith("/meter.py"))
        text = archive.read(name).decode()
    lines = textwrap.dedent(text[text.index("    def end_slip") : text.index("    def _open_slip")])
    # A signature, a docstring and seven lines.
    copy = [line for line in lines.splitlines() if line]
    assert len(copy) == 9
    for count, refused in ((6, True), (5, False)):
        code = "\n".join([*copy[: 2 + count], "    # Else it is as it was.", "    self.T = 1.0"])
        mutant = overriding(tmp_path, Override("meter.CycleMeter.end_slip", code))
        if refused:
            told = r"overrides\[0\].code: copies 6 lines of meter.CycleMeter.end_slip; 5 at most"
            with pytest.raises(MutantError, match=told):
                plant(fmu_path, mutant, tmp_path)
        else:
            assert plant(fmu_path, mutant, tmp_path).exists()


def test_an_addition_replaces_nothing(fmu_path: Path, tmp_path: Path) -> None:
    """A module that a fault brings along cannot take the place of one that is packed."""
    mutant = replace(read(tmp_path, GOOD), additions=(Addition("stickslip_fmu/block.py", "pass"),))
    with pytest.raises(
        MutantError, match=r"additions\[0\].file: stickslip_fmu/block.py is packed already"
    ):
        plant(fmu_path, mutant, tmp_path)


def test_a_fault_is_planted_in_our_fmu_only(foreign_fmu: Path, tmp_path: Path) -> None:
    """What is no FMU, or one without the block's source, is refused with its name."""
    text = tmp_path / "text.fmu"
    text.write_text("not an FMU", encoding="utf-8")
    for fmu, told in ((foreign_fmu, "carries no packed source"), (text, "cannot be read")):
        with pytest.raises(MutantError, match=told) as caught:
            plant(fmu, INSIDE[0], tmp_path)
        assert str(caught.value).startswith(str(fmu))
