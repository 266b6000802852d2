"""The band about the exact motion: as wide as it must be, and no wider."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from stickslip_verification import CheckResult, load_cases, load_invariants
from stickslip_verification.drive import CommunicationStep
from stickslip_verification.drive.exact import exact_motion
from stickslip_verification.drive.kept import kept
from stickslip_verification.drive.nearby import OFF, nearby_motions
from stickslip_verification.judge.band import MOST_LOST, Band, numerical, of_any_sequence
from stickslip_verification.judge.checks import PHYSICS_CONTRACT, judge_in_band
from stickslip_verification.judge.invariant_checks import blank
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.model.run import Run
from stickslip_verification.model.verdict import Klass
from tests.verification.records import Draft, exact_of, named, planted, value

MANNER = load_invariants().sequences[0]
QUICK = {"default", "damped-cycle", "reversals", "overdamped", "tuned", "grazing", "moving-start"}
SHORT = [
    pytest.param(case.id, marks=[] if case.id in QUICK else pytest.mark.soak)
    for case in load_cases()
    if case.klass == Klass.PHYSICS and len(case.steps) <= 250 and case.stop_time <= 60.0
]


def band_of(name: str) -> Band:
    return numerical(exact_of(name), kept(nearby_motions, named(name)))


def judged(name: str, run: Run, band: Band | None = None) -> CheckResult:
    empty = blank(MANNER, name, PHYSICS_CONTRACT)
    return judge_in_band(empty, OUTPUT_NAMES, PHYSICS_CONTRACT, band or band_of(name), run)


@pytest.mark.parametrize("name", SHORT)
def test_the_exact_motion_is_in_its_own_band_and_decided(name: str) -> None:
    assert judged(name, exact_of(name).record).passed
    assert band_of(name).lost <= MOST_LOST


@pytest.mark.parametrize("name", ["default", "damped-cycle", "reversals", "overdamped", "tuned"])
@pytest.mark.parametrize(
    "datum", ["k", "mu_s", *(pytest.param(n, marks=pytest.mark.soak) for n in ("v", "m"))]
)
def test_a_datum_off_by_3e_8_is_a_numerical_error_and_by_1e_5_another_block(
    name: str, datum: str
) -> None:
    case = named(name)

    def off(by: float) -> Run:
        def scaled(values: Mapping[str, float]) -> dict[str, float]:
            return {n: v * (1.0 + by if n == datum else 1.0) for n, v in values.items()}

        steps = tuple(CommunicationStep(step.h, scaled(step.changes)) for step in case.steps)
        moved = replace(case, parameters=scaled(case.start), steps=steps)
        return kept(exact_motion, moved).record

    # The band is four times as wide as what a few motions off by OFF reach.
    assert judged(name, off(3.0 * OFF)).passed
    assert not judged(name, off(1e3 * OFF)).passed


def test_the_band_is_wide_behind_a_shallow_re_stick_only() -> None:
    shallow, default = band_of("grazing"), band_of("default")

    def width(band: Band, quantity: str) -> float:
        return float(np.max(band.allowed(quantity))) / band.largest(quantity)

    # Where lambda is small the stick time is known less exactly, and the position is not.
    assert width(shallow, "t_stick") > 10.0 * width(default, "t_stick")
    assert max(width(band, "x") for band in (shallow, default)) < 1e-6


@pytest.mark.parametrize(
    ("output", "by"),
    [("x", 1e-6), ("n_slips", 1.0), ("mode", 1.0), ("T", 1e-5), ("Q_friction", 1e-6), ("f", 1e-3)],
)
def test_a_wrong_value_in_any_output_is_seen_and_named(output: str, by: float) -> None:
    record = exact_of("default").record
    faulty = planted(record, value(output, record.outputs[output][-1] + by, -1))
    result = judged("default", faulty)
    assert (result.passed, result.quantity) == (False, output)
    assert result.error is not None
    assert result.error > result.tolerance


def test_a_nan_is_a_failure_where_the_output_means_something() -> None:
    record = exact_of("default").record
    first = int(np.flatnonzero(record.outputs["n_slips"] > 0)[0])

    def early(draft: Draft) -> None:
        for name in ("delta_x", "t_slip", "T", "t_stick", "t_event"):
            draft.outputs[name][: first // 4] = np.nan

    assert judged("default", planted(record, early)).passed
    broken = judged("default", planted(record, value("delta_x", np.nan, -1)))
    assert broken.failure == "delta_x is nan at t = 10 s"


def test_conventions_of_the_start_are_not_judged_in_a_case() -> None:
    record = exact_of("moving-start").record

    def uncounted(draft: Draft) -> None:
        draft.outputs["n_slips"] -= 1.0
        draft.outputs["x_pull"] += 0.1
        draft.initial.update(dict.fromkeys(draft.initial, 0.0))

    other, agreed = planted(record, uncounted), of_any_sequence(exact_of("moving-start"))
    assert judged("moving-start", other).passed
    assert not judged("moving-start", other, agreed).passed
