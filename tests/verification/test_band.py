"""The band about the exact motion: as wide as it must be, and no wider."""

from dataclasses import replace

import numpy as np
import pytest

from stickslip_verification.drive.exact import exact_motion
from stickslip_verification.drive.nearby import OFF, nearby_motions
from stickslip_verification.judge.band import MOST_LOST, Band, numerical, of_any_sequence
from stickslip_verification.judge.checks import PHYSICS_CONTRACT, judge_in_band
from stickslip_verification.judge.invariant_checks import blank
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.model.run import Run
from stickslip_verification.model.verdict import CheckResult, Klass
from stickslip_verification.suite.cases import load_cases
from stickslip_verification.suite.experiment import CommunicationStep
from stickslip_verification.suite.invariants import load_invariants
from stickslip_verification.truth.named import COULOMB_NAME

from .records import Fault, exact_of, named, planted

MANNER = load_invariants().sequences[0]
QUICK = {"stribeck-default", "stribeck-grazing"}
"""Those under Stribeck's law that the gate takes: each needs some ten seconds of truth."""
SHORT = [
    pytest.param(
        case.id, marks=[] if case.law == COULOMB_NAME or case.id in QUICK else pytest.mark.soak
    )
    for case in load_cases()
    if case.klass == Klass.PHYSICS and len(case.steps) <= 250 and case.stop_time <= 60.0
]


def band_of(name: str) -> Band:
    """Return the band of a case of the suite."""
    return numerical(exact_of(name), nearby_motions(named(name)))


def judged(name: str, run: Run) -> CheckResult:
    """Judge every output of a run of a case."""
    empty = blank(MANNER, name, PHYSICS_CONTRACT)
    return judge_in_band(empty, OUTPUT_NAMES, PHYSICS_CONTRACT, band_of(name), run)


@pytest.mark.parametrize("name", SHORT)
def test_the_exact_motion_is_in_its_own_band_and_decided(name: str) -> None:
    """In no case of physics does the course hang on less than a numerical solution's error."""
    assert judged(name, exact_of(name).record).passed
    assert band_of(name).lost <= MOST_LOST


@pytest.mark.parametrize("name", ["default", "damped-cycle", "reversals", "overdamped", "tuned"])
@pytest.mark.parametrize("datum", ["k", "mu_s", "v", "m"])
def test_a_datum_that_is_off_is_told_from_rounding(name: str, datum: str) -> None:
    """A datum off by 1e-9 is a numerical error; off by 1e-5 it is another block."""
    case = named(name)

    def off(by: float) -> Run:
        values = {**case.parameters, datum: case.start[datum] * (1.0 + by)}
        steps = tuple(
            CommunicationStep(
                step.h, {n: v * (1.0 + by if n == datum else 1.0) for n, v in step.changes.items()}
            )
            for step in case.steps
        )
        return exact_motion(replace(case, parameters=values, steps=steps)).record

    assert judged(name, off(0.1 * OFF)).passed
    assert not judged(name, off(1e3 * OFF)).passed


def test_the_band_is_wide_behind_a_shallow_re_stick_only() -> None:
    """Where lambda is small the stick time is known less exactly, and the position is not."""
    shallow, default = band_of("grazing"), band_of("default")

    def width(band: Band, quantity: str) -> float:
        return float(np.max(band.allowed(quantity))) / band.largest(quantity)

    assert width(shallow, "t_stick") > 10.0 * width(default, "t_stick")
    for band in (shallow, default):
        assert width(band, "x") < 1e-6


def last(name: str, by: float) -> Fault:
    """Return a fault that moves the last sample of an output."""

    def fault(draft: object) -> None:
        draft.outputs[name][-1] += by  # type: ignore[attr-defined]

    return fault


@pytest.mark.parametrize(
    ("output", "by"),
    [("x", 1e-6), ("n_slips", 1.0), ("mode", 1.0), ("T", 1e-5), ("Q_friction", 1e-6), ("f", 1e-3)],
)
def test_a_wrong_value_in_any_output_is_seen_and_named(output: str, by: float) -> None:
    """The result shows the output that is worst, with what it may be off there."""
    result = judged("default", planted(exact_of("default").record, last(output, by)))
    assert (result.passed, result.quantity) == (False, output)
    assert result.error is not None
    assert result.error > result.tolerance


def test_a_nan_is_a_failure_where_the_output_means_something() -> None:
    """A meter that is NaN until its first slip is a convention; later it is a failure."""
    record = exact_of("default").record
    first = int(np.flatnonzero(record.outputs["n_slips"] > 0)[0])

    def early(draft: object) -> None:
        for name in ("delta_x", "t_slip", "T", "t_stick", "t_event"):
            draft.outputs[name][: first // 4] = np.nan  # type: ignore[attr-defined]

    assert judged("default", planted(record, early)).passed
    broken = judged("default", planted(record, last("delta_x", np.nan)))
    assert broken.failure == "delta_x is nan at t = 10 s"


def test_conventions_of_the_start_are_not_judged() -> None:
    """A slip of the start need not count, the first stick need not be timed."""
    record = exact_of("moving-start").record

    def uncounted(draft: object) -> None:
        draft.outputs["n_slips"] -= 1.0  # type: ignore[attr-defined]
        draft.outputs["x_pull"] += 0.1  # type: ignore[attr-defined]
        draft.initial.update(dict.fromkeys(draft.initial, 0.0))  # type: ignore[attr-defined]

    assert judged("moving-start", planted(record, uncounted)).passed
    agreed = of_any_sequence(exact_of("moving-start"))
    empty = blank(MANNER, "moving-start", PHYSICS_CONTRACT)
    strictly = judge_in_band(
        empty, OUTPUT_NAMES, PHYSICS_CONTRACT, agreed, planted(record, uncounted)
    )
    assert not strictly.passed


def test_a_run_with_other_points_is_a_failure() -> None:
    """A run that ends early or has points of its own cannot be compared."""
    record = exact_of("one-step").record
    other = replace(record, times=record.times + 0.1)
    result = judged("one-step", other)
    assert (result.passed, result.failure) == (
        False,
        "1 samples at other points than the case has",
    )
