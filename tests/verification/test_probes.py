"""Questions to an FMU as a whole: ours answers them all, another one is told where it differs."""

import math
import re
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from _pytest.mark import ParameterSet

from stickslip_verification import Mutant, load_invariants, load_mutants
from stickslip_verification.drive import FmuError, FmuFile, environments
from stickslip_verification.drive.calls import differences
from stickslip_verification.drive.environments import PROBES
from stickslip_verification.drive.masters import NotApplicableError
from stickslip_verification.suite.faults import Substitution, plant
from tests.conftest import built
from tests.makers import SLIDER, SLIDER_3, Foreign, altered, edited, misbehaving
from tests.needs import needs

INVARIANTS = {invariant.id: invariant for invariant in load_invariants().probes}
MEMORY = ("memory-of-steps", "memory-of-states", "memory-of-instances")
DEAR = {"environment", "environment-to-the-bit", "keeps-its-cycle", *MEMORY}


def asked(invariant: str, file: FmuFile, **others: Any) -> list[str]:
    probe = INVARIANTS[invariant]
    try:
        return PROBES[probe.probe](file, **{**probe.arguments, **others})
    except FmuError as error:
        return [str(error)]


@pytest.fixture(autouse=True)
def on_a_busy_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(environments, "_PATIENCE", 600.0)
    monkeypatch.setattr(environments, "_SLOWER", 100.0)


@cache
def ours(kind: str) -> FmuFile:
    return FmuFile(built(kind))


def tried(kind: str, invariant: str) -> ParameterSet:
    marks = [pytest.mark.gate] * (invariant in DEAR or "fresh" in invariant)
    marks += [needs("cc")] * kind.startswith("native")
    return pytest.param(kind, invariant, marks=marks)


@pytest.mark.parametrize(
    ("kind", "invariant"),
    [
        *(tried("python-2", each) for each in INVARIANTS),
        # Declarations are those of FMI 2.0's types.
        *(tried("native-3", n) for n in INVARIANTS if n not in MEMORY and "declared" not in n),
    ],
)
def test_our_fmu_gives_no_probe_a_reason_to_complain(kind: str, invariant: str) -> None:
    fewer = {"count": 60 if "instances" in invariant else 2000} if invariant in MEMORY else {}
    assert asked(invariant, ours(kind), **fewer) == []


@pytest.mark.soak
@pytest.mark.parametrize("invariant", MEMORY)
def test_no_memory_is_kept_for_long(invariant: str) -> None:
    count = 10 * INVARIANTS[invariant].arguments["count"]
    assert asked(invariant, ours("python-2"), count=count, seconds=300.0) == []


A_UNIT = (r'(name="delta_x"[^>]*>\s*<Real)[^>]* displayUnit="mm"', r"\1")
A_START = (r'(name="v"[^>]*>\s*<Real[^>]*)start="0.02"', r'\1start="0.03"')
SAME_START = (r'(name="g"[^>]*>\s*<Real[^>]*)start="9.81"', r'\1start="9.81000000000000005"')
A_TYPE = (r'(name="delta_x"[^>]*)variability="discrete"', r'\1variability="continuous"')
A_SORT = (
    r'(name="load"[^>]*)causality="input" variability="continuous"',
    r'\1causality="parameter" variability="tunable" initial="exact"',
)
A_NAME = ('name="n_slips"', 'name="slips"')
OTHER_TYPE = "delta_x is Real output continuous, not Real output discrete"
OTHER_SORT = "load is Real parameter tunable, not Real input continuous"
DOCTORED = [
    ("declared-units", A_UNIT, ["delta_x is declared in no unit, not m"]),
    ("declared-starts", A_START, ["v starts at 0.03, not 0.02"]),
    ("declared-starts", SAME_START, []),
    ("declared-types", A_TYPE, [OTHER_TYPE]),
    ("declared-types", A_SORT, [OTHER_SORT]),
    ("declared-variables", A_NAME, ["an output too many: slips", "no variable n_slips"]),
]


@pytest.mark.parametrize(("invariant", "change", "told"), DOCTORED)
def test_a_doctored_description_is_told_by_the_variable_and_by_no_other_probe(
    fmu_path: Path, tmp_path: Path, invariant: str, change: tuple[str, str], told: list[str]
) -> None:
    file = FmuFile(altered(fmu_path, tmp_path / "Doctored.fmu", edited(change)))
    for each in ("declared-starts", "declared-units", "declared-types", "declared-variables"):
        if each == invariant or each != "declared-variables":
            assert sorted(asked(each, file)) == (told if each == invariant else []), each


PLANTED = {
    "refusal-negative-stiffness": ("refuses-k-negative", "k = -1.0 was taken"),
    "refusal-nan": ("refuses-nan", "v = nan was taken"),
    "refusal-lifted": ("refuses-load-that-lifts", "load = -10.0 was taken"),
    "refusal-step-zero": ("refuses-step-zero", "a step of 0.0 s was taken"),
    "clamp-silent": ("warns-of-clamp", "the log does not say 0.375: it is empty"),
    "failure-forgotten": ("fails-until-reset", "after a refusal it can still step"),
    "reset-keeps-meter": ("fails-until-reset", "after reset n_slips is not that of a fresh"),
    "unit-declared-mm": ("declared-units", "delta_x is declared in mm, not m"),
    "clamp-when-set": ("parameters-in-any-order", r"x is .* after step \d+"),
    "clamp-kept-in-slip": ("mu_s-raised-after-clamp-in-slip", "mu_k_used is 0.24, not 0.3"),
    "event-at-the-end-of-a-step-lost": ("slips-after-break-away", "mode is 0.0, not 1.0"),
    "restick-after-the-end-of-a-step": ("rests-at-restick", "mode is 1.0, not 0.0"),
    "durations-from-event-times": ("late-start-to-the-bit", "x is .* and not"),
    "start-time-of-day": ("starts-at-a-million-seconds", r"dated \d+\.\d+, not 1000000.24525"),
    "state-without-parameters": ("state-in-a-fresh-process", "x is .* and not"),
    "environment-time-zone": ("environment", "^the time zone: t_event is"),
    "environment-working-folder": ("environment", "^in another working folder: .* failed"),
    "memory-of-steps": ("memory-of-steps", r"^each step keeps \d+ bytes; \d+ at most$"),
    "memory-of-bytes": ("memory-of-states", r"^each state keeps \d+ bytes; \d+ at most$"),
    "memory-of-instances": ("memory-of-instances", r"^each instance keeps \d+ bytes; \d+ at most$"),
}


@pytest.mark.parametrize(
    "mutant",
    [
        pytest.param(each, marks=pytest.mark.gate if invariant in DEAR else ())
        for each, (invariant, _) in PLANTED.items()
    ],
)
def test_a_planted_fault_is_told_with_the_value_that_shows_it(
    fmu_path: Path, tmp_path: Path, mutant: str
) -> None:
    (fault,) = load_mutants(mutant)
    invariant, told = PLANTED[mutant]
    file = FmuFile(plant(fmu_path, fault, tmp_path), hooks=fault.hooks)
    complaints = " ".join(asked(invariant, file))
    file.close()
    assert re.search(told, complaints), complaints


def test_a_refusal_must_name_the_variable(fmu_path: Path, tmp_path: Path) -> None:
    nameless = Substitution(
        "instance.py", "raise ModelError(objection)", 'raise ModelError("bad input")'
    )
    fault = Mutant(
        id="fault", about="-", detected_by=("declared-variables",), substitutions=(nameless,)
    )
    file = FmuFile(plant(fmu_path, fault, tmp_path))
    for each, invariant in INVARIANTS.items():
        if invariant.probe == "refuses" and "lifts" not in each and "step" not in each:
            (complaint,) = asked(each, file)
            assert "was refused without its name" in complaint
    file.close()


@pytest.mark.parametrize("fmu", [SLIDER, SLIDER_3], ids=lambda fmu: fmu.name)
def test_physics_finds_nothing_in_an_honest_slider_and_names_what_it_lacks(fmu: Foreign) -> None:
    file, lacking = fmu.opened(), {}
    for each, invariant in INVARIANTS.items():
        if invariant.klass == "physics" and each not in DEAR:
            try:
                assert asked(each, file) == [], each
            except NotApplicableError as error:
                lacking[each] = str(error)
    assert lacking["load-before-mass"] == "it has no variable load"
    assert lacking["coefficients-in-any-order"] == "it cannot change mu_k on the way"


def test_a_foreign_fmu_that_takes_everything_is_told_in_our_names_and_units() -> None:
    file = SLIDER.opened()
    assert asked("refuses-k-negative", file) == ["k = -1.0 was taken"]
    assert asked("refuses-g-zero", file) == ["g = 0.0 was taken"]
    assert "x is declared in millimetre, not m" in asked("declared-units", file)
    assert "no variable c" in asked("declared-variables", file)


@pytest.mark.parametrize(
    ("what", "told"),
    [
        ("crash", r"^the process ended with exit code -?\d+$"),
        ("hang", r"^no answer within 3 s$"),
        ("raise", r"the slider has had enough"),
    ],
)
def test_what_goes_wrong_in_a_fresh_process_is_told_and_leaves_no_file(
    fmu_path: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, what: str, told: str
) -> None:
    file, monkeypatched = FmuFile(fmu_path), monkeypatch.setattr
    monkeypatched(file, "path", misbehaving(what).path)
    monkeypatched("tempfile.tempdir", str(tmp_path))
    monkeypatched(environments, "LIMIT", 3.0 if what == "hang" else 60.0)
    complaints = PROBES["elsewhere"](
        file, environments={}, calls=[{"start": 0.0}], then=[{"step": 0.01, "times": 3}]
    )
    assert re.search(told, complaints[0].removeprefix("in a fresh process: "))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("other", "part", "names", "told"),
    [
        ({"z": 2.05e-3}, 1e-6, (), []),
        ({"z": 2.05e-3}, 1e-7, (), ["z is 0.00205 and not 0.002 after step 1"]),
        ({"z": 2.05e-3}, None, (), ["z is 0.00205 and not 0.002 after step 1"]),
        ({"z": 2.05e-3}, None, ("z",), []),
        # What is discrete must be the same, and nan is no value.
        ({"mode": -1.0}, 1.0, (), ["mode is -1.0 and not 1.0 after step 1"]),
        ({"z": math.nan}, 1.0, (), ["z is nan and not 0.002 after step 1"]),
    ],
)
def test_motions_differ_by_a_part_of_the_largest_value_in_the_unit(
    other: dict[str, float], part: float | None, names: tuple[str, ...], told: list[str]
) -> None:
    row = {"x": 100.0, "z": 2e-3, "mode": 1.0}
    assert differences([{**row, **other}], [row], part, names) == told


WARM_UP = (10_000, 3_000_000)
STEADY = [WARM_UP, *[(10_000, 327_680)] * 9]


@pytest.mark.parametrize(
    ("parts", "told"),
    [
        (STEADY, ["each step keeps 33 bytes; 4 at most"]),
        ([*STEADY[:7], *[(10_000, -900_000)] * 3], ["each step keeps 33 bytes; 4 at most"]),
        # Memory that is taken in few parts, or a page now and then, is no loss.
        ([WARM_UP, *[(10_000, 0)] * 5, *[(10_000, 4_000_000)] * 4], []),
        # A measurement that was cut short still shows a loss.
        ([(12, 700_000), *[(5, 500_000)] * 4], ["each step keeps 100000 bytes; 4 at most"]),
    ],
)
def test_a_growth_in_most_parts_is_a_loss(parts: list[tuple[int, int]], told: list[str]) -> None:
    assert environments.judged(parts, "step", 4.0, 5.0) == told


def test_too_few_parts_show_no_loss() -> None:
    assert environments.judged([WARM_UP, *[(30, 40_960)] * 9], "instance", 1024.0, 5.0) == []
    with pytest.raises(NotApplicableError, match="22 times in 5 s are too few to see a loss"):
        environments.judged([(12, 700_000), *[(5, 500_000)] * 2], "step", 4.0, 5.0)
