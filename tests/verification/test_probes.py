"""Questions to an FMU as a whole: ours answers them all, a doctored one shows where it was cut."""

import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.names import NameMap
from stickslip_verification.drive.planting import plant
from stickslip_verification.drive.probes import PROBES
from stickslip_verification.drive.probes.declarations import INTERFACE
from stickslip_verification.drive.stepping import NotApplicableError
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.suite.faults import Mutant, Substitution, load_mutants
from stickslip_verification.suite.invariants import Probe, load_invariants
from stickslip_verification.truth.parameters import START_VALUES

from .foreign import building

INVARIANTS = {invariant.id: invariant for invariant in load_invariants().probes}


@pytest.fixture(scope="module")
def ours(fmu_path: Path) -> Iterator[FmuFile]:
    """Return our FMU, opened."""
    file = FmuFile(fmu_path)
    yield file
    file.close()


def asked(invariant: str, file: FmuFile) -> list[str]:
    """Return the complaints of a probe about an FMU."""
    probe: Probe = INVARIANTS[invariant]
    return PROBES[probe.probe](file, **probe.arguments)


@pytest.mark.parametrize("invariant", INVARIANTS)
def test_there_is_nothing_to_say_of_ours(ours: FmuFile, invariant: str) -> None:
    """Our FMU gives no probe a reason to complain."""
    assert asked(invariant, ours) == []


def test_the_interface_is_that_of_the_specification() -> None:
    """Twelve values and 22 outputs, each of one kind: what is set counts as parameter or input."""
    assert set(INTERFACE) == {*START_VALUES, *OUTPUT_NAMES}
    assert {n for n, v in INTERFACE.items() if v.causality == "output"} == set(OUTPUT_NAMES)
    assert {n for n, v in INTERFACE.items() if v.causality == "input"} == {"v", "load", "F_ext"}
    assert {n for n, v in INTERFACE.items() if v.variability == "tunable"} == {
        "k",
        "c",
        "mu_s",
        "mu_k",
    }


def edited(pattern: str, to: str) -> Callable[[str], str]:
    """Change one place of a model description."""

    def edit(description: str) -> str:
        changed, count = re.subn(pattern, to, description)
        assert count == 1
        return changed

    return edit


DOCTORED = [
    (
        "declared-units",
        edited(r'(name="delta_x"[^>]*>\s*<Real)[^>]* displayUnit="mm"', r"\1"),
        ["delta_x is declared in no unit, not m"],
    ),
    (
        "declared-starts",
        edited(r'(name="v"[^>]*>\s*<Real[^>]*)start="0.02"', r'\1start="0.03"'),
        ["v starts at 0.03, not 0.02"],
    ),
    (
        "declared-starts",
        edited(r'(name="g"[^>]*>\s*<Real[^>]*)start="9.81"', r'\1start="9.81000000000000005"'),
        [],
    ),
    (
        "declared-types",
        edited(
            r'(name="load"[^>]*)causality="input" variability="continuous"',
            r'\1causality="parameter" variability="tunable" initial="exact"',
        ),
        ["load is Real parameter tunable, not Real input continuous"],
    ),
    (
        "declared-types",
        edited(r'(name="delta_x"[^>]*)variability="discrete"', r'\1variability="continuous"'),
        ["delta_x is Real output continuous, not Real output discrete"],
    ),
    (
        "declared-variables",
        edited(r'name="n_slips"', 'name="slips"'),
        ["no variable n_slips", "an output too many: slips"],
    ),
    (
        "declared-variables",
        lambda description: building.without(description, "T", "mu_k"),
        ["no variable mu_k", "no variable T"],
    ),
    (
        "declared-variables",
        edited(r"(</ModelVariables>)", '<ScalarVariable name="age" valueReference="99" '
               r'causality="output"><Real/></ScalarVariable>\1'),
        ["an output too many: age"],
    ),
]  # fmt: skip


@pytest.mark.parametrize(("invariant", "description", "told"), DOCTORED)
def test_a_doctored_description_is_told_by_the_variable(
    fmu_path: Path,
    tmp_path: Path,
    invariant: str,
    description: Callable[[str], str],
    told: list[str],
) -> None:
    """What was changed in the model description is complained of, by name, and nothing else."""
    file = FmuFile(building.altered(fmu_path, tmp_path / "Doctored.fmu", description))
    assert sorted(asked(invariant, file)) == sorted(told)
    assert all(
        asked(other, file) == []
        for other in ("declared-starts", "declared-units", "declared-types")
        if other != invariant
    )
    file.close()


def fault(file: str, find: str, put: str) -> Mutant:
    """Describe a fault of one substitution."""
    changes = (Substitution(file, find, put),)
    return Mutant("fault", "", ("declared-variables",), changes, (), Path("fault.toml"))


PLANTED = {
    "refusal-zero-stiffness": ("refuses-k-zero", "k = 0.0 was taken"),
    "refusal-negative-stiffness": ("refuses-k-negative", "k = -1.0 was taken"),
    "refusal-zero-mass": ("refuses-m-zero", "m = 0.0 was taken"),
    "refusal-negative-damping": ("refuses-c-negative", "c = -1.0 was taken"),
    "refusal-nan": ("refuses-nan", "v = nan was taken"),
    "refusal-infinity": ("refuses-infinity", "F_ext = inf was taken"),
    "refusal-lifted": ("refuses-load-that-lifts", "load = -10.0 was taken"),
    "refusal-mass-in-motion": ("refuses-change-of-mass", "m = 2.0 was taken"),
    "refusal-step-zero": ("refuses-step-zero", "a step of 0.0 s was taken"),
    "refusal-step-back": ("refuses-step-negative", "a step of -0.001 s was taken"),
    "clamp-silent": ("warns-of-clamp", "the log does not say 0.375: it is empty"),
    "meter-ignores-start-time": ("starts-at-start-time", "t_event begins with 0.0, not 5.0"),
    "failure-forgotten": ("fails-until-reset", "after a refusal it can still step"),
    "unit-declared-mm": ("declared-units", "delta_x is declared in mm, not m"),
}


@pytest.mark.parametrize("mutant", PLANTED)
def test_what_is_no_longer_refused_or_said_is_told(
    fmu_path: Path, tmp_path: Path, mutant: str
) -> None:
    """An FMU that takes what it must refuse, or keeps silent, is complained of with the value."""
    (described,) = load_mutants(mutant)
    file = FmuFile(plant(fmu_path, described, tmp_path), hooks=described.hooks)
    invariant, told = PLANTED[mutant]
    assert told in asked(invariant, file)
    file.close()


@pytest.mark.parametrize(
    "invariant",
    [
        invariant
        for invariant in INVARIANTS
        if invariant.startswith("refuses")
        and INVARIANTS[invariant].probe == "refuses"
        and "lifts" not in invariant
    ],
)
def test_a_refusal_must_name_the_variable(fmu_path: Path, tmp_path: Path, invariant: str) -> None:
    """A value that is refused without the name of its variable helps nobody, whatever its name."""
    nameless = fault("instance.py", "raise ModelError(objection)", 'raise ModelError("bad input")')
    file = FmuFile(plant(fmu_path, nameless, tmp_path))
    (complaint,) = asked(invariant, file)
    assert "was refused without its name" in complaint
    file.close()


def test_a_reset_that_does_not_recover_is_told(fmu_path: Path, tmp_path: Path) -> None:
    """An output that is not a fresh instance's after a reset is complained of by its name."""
    kept = fault(
        "instance.py",
        "self._model = self._spec.model(self._values, self._time)",
        "self._model = KEPT.setdefault(self.instance_name, "
        "self._spec.model(self._values, self._time))",
    )
    kept = replace(
        kept,
        substitutions=(
            *kept.substitutions,
            Substitution("instance.py", "_Method = TypeVar", "KEPT = {}\n\n_Method = TypeVar"),
        ),
    )
    file = FmuFile(plant(fmu_path, kept, tmp_path))
    complaints = asked("fails-until-reset", file)
    assert complaints
    assert all(
        re.fullmatch(r"after reset \w+ is not that of a fresh instance", each)
        for each in complaints
    )
    file.close()


def test_what_a_foreign_fmu_lacks_is_not_asked_for(
    slider_mm: Path, slider_mm_names: NameMap
) -> None:
    """A probe that needs a variable that is not there does not apply, and names it."""
    file = FmuFile(slider_mm, slider_mm_names)
    for invariant, lacking in (
        ("refuses-c-negative", "c"),
        ("refuses-load-that-lifts", "load"),
        ("starts-at-start-time", "t_event"),
    ):
        with pytest.raises(NotApplicableError, match=rf"^it has no variable {lacking}$"):
            asked(invariant, file)


def test_a_foreign_fmu_that_takes_everything_is_told(
    slider_mm: Path, slider_mm_names: NameMap
) -> None:
    """Probes speak of a foreign FMU in our names and units."""
    file = FmuFile(slider_mm, slider_mm_names)
    assert asked("refuses-k-negative", file) == ["k = -1.0 was taken"]
    assert asked("refuses-g-zero", file) == ["g = 0.0 was taken"]
    assert "x is declared in millimetre, not m" in asked("declared-units", file)
    assert "no variable c" in asked("declared-variables", file)
