"""Fitness: how far jump, stick, slip, period and forces are off, whatever the verdict says."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from stickslip_verification import verify
from stickslip_verification.drive.answer import Answer
from stickslip_verification.drive.moments import moments
from stickslip_verification.drive.stepping import NotApplicableError
from stickslip_verification.judge.fitness import (
    FITNESS,
    QUANTITIES,
    Fit,
    fits_of,
    tables_of,
    without_run,
)
from stickslip_verification.model.run import Run
from tests.makers import FAULTY
from tests.verification.records import believed, exact_of, named

DEFAULT = exact_of("default").record
SLIPS = DEFAULT.outputs["n_slips"]


def fits(name: str, run: Run) -> dict[str, Fit]:
    exact = exact_of(name)
    try:
        matched = Answer(moments(named(name), exact, run))
    except NotApplicableError as error:
        matched = Answer(not_applicable=str(error))
    return {fit.quantity: fit for fit in fits_of(name, exact, run, matched, 0.01)}


def errors(name: str, run: Run) -> dict[str, float]:
    return {name: fit.error for name, fit in fits(name, run).items() if fit.error is not None}


def without(run: Run, *names: str) -> Run:
    return replace(run, outputs={n: s for n, s in run.outputs.items() if n not in names})


def changed(**outputs: np.ndarray) -> Run:
    return replace(DEFAULT, outputs={**DEFAULT.outputs, **outputs})


@pytest.mark.parametrize("name", ["default", "reversals", "lifted-and-set-down", "start-beyond"])
def test_the_exact_motion_has_no_error(name: str) -> None:
    found = errors(name, exact_of(name).record)
    assert found.keys() == QUANTITIES.keys()
    # The distance of the samples from the ends of the phases.
    assert max(found.values()) < 1e-5


@pytest.mark.parametrize(
    ("case", "values", "quantity", "size", "most"),
    [
        # 2 Delta grows by 5 %.
        ("default", {"mu_s": 0.51}, "stick", 0.05, 2.0),
        ("default", {"mu_k": 0.297}, "forces", 0.009, 2.0),
        # w falls by 1 %: the slip takes 1 % longer.
        ("default", {"m": 1.02, "g": 9.81 / 1.02}, "slip", 0.01, 2.0),
        # t_stick = 2 Delta/v. Events drift by half a slip, and every level is within 0.4 %.
        ("default", {"v": 0.02006}, "stick", 0.003, 1.33),
        # Moments are not compared across a change, though the load jumps.
        ("lifted-and-set-down", {"k": 1003.0}, "stick", 0.003, 3.3),
    ],
)
def test_an_error_of_a_level_is_told_by_the_size_that_closed_forms_give(
    case: str, values: dict[str, float], quantity: str, size: float, most: float
) -> None:
    found = errors(case, believed(case, *values.items()))
    assert 0.8 * size < found[quantity] < most * size
    assert max(found.values()) < 0.06
    if "mu_s" not in values:
        assert max(found.values()) < 0.03


def test_missing_cycles_wrong_phases_and_nan_are_within_nothing() -> None:
    stuck = fits("default", believed("default", ("mu_s", 50.0)))
    assert {(fit.error, fit.why) for fit in stuck.values()} == {
        (1.0, f"0 slips, not {int(SLIPS[-1])}")
    }
    numbers = np.array(SLIPS)
    numbers[:-1] += 1000.0
    forces = fits("default", changed(n_slips=numbers))["forces"]
    assert forces.error == math.inf
    assert "points lie in no stick or slip of the exact motion" in forces.why
    broken = np.array(DEFAULT.outputs["t_slip"])
    broken[40] = math.nan  # in the second stick
    found = errors("default", changed(t_slip=broken))
    assert found["slip"] == math.inf
    assert found["jump"] < 1e-5
    # A crash is a fault of the FMU; a case that it cannot run is none.
    assert {fit.error for fit in without_run("one", Answer(failure="it crashed"))} == {math.inf}
    assert {fit.error for fit in without_run("one", Answer(not_applicable="no c"))} == {None}


def test_what_a_meter_shows_of_the_start_is_a_convention() -> None:
    unseen = np.where(SLIPS < 2, 0.0, DEFAULT.outputs["t_stick"])
    counted = np.where((SLIPS == 1) & (DEFAULT.outputs["T"] == 0.0), 0.36, DEFAULT.outputs["T"])
    assert max(errors("default", changed(t_stick=unseen, T=counted)).values()) < 1e-5
    # After two slips it is none.
    assert errors("default", changed(t_stick=np.zeros_like(SLIPS)))["stick"] > 0.7


def test_phases_are_dated_without_t_event_by_their_lengths() -> None:
    dated = errors("default", without(DEFAULT, "t_event"))
    assert dated == pytest.approx(errors("default", DEFAULT), abs=1e-6)  # as the exact motion


@pytest.mark.parametrize(
    ("lacks", "quantities", "why"),
    [
        (("n_slips",), tuple(QUANTITIES), "it has no output n_slips"),
        (("sticking", "mode"), tuple(QUANTITIES), "it has no output sticking or mode"),
        (("T",), ("period",), "it has no output T"),
        (("F", "F_friction"), ("forces",), "it has no output F"),
        (("t_slip",), ("slip",), "it has no output t_slip"),
        (("t_event", "t_slip"), ("slip", "forces"), ""),
        (("mode",), (), ""),
        (("F",), (), ""),
    ],
)
def test_what_an_fmu_lacks_does_not_apply(
    lacks: tuple[str, ...], quantities: tuple[str, ...], why: str
) -> None:
    found = fits("default", without(DEFAULT, *lacks))
    assert {quantity for quantity, fit in found.items() if fit.error is None} == set(quantities)
    assert not why or {found[quantity].why for quantity in quantities} <= {why}


def test_the_tables_answer_for_each_quantity_and_name_the_places() -> None:
    found = [
        *(Fit("one", "jump", 0.002, 0.5), Fit("two", "jump", 0.004, 0.7)),
        *(Fit("one", "stick", 0.02, 0.5), Fit("two", "stick", 0.5, 1.5)),
        Fit("two", "slip", None, why="it has no output t_slip"),
        Fit("two", "period", math.inf, why="the run did not end: it crashed"),
    ]
    answer, places = tables_of(found, 0.01)
    assert answer.title == f"{FITNESS}: within 1 %?"
    assert [list(row) for row in answer.rows] == [
        ["jump (delta_x)", "yes", "2 of 2", 0.4, "two"],
        ["stick (t_stick)", "no", "0 of 2", 50.0, "two"],
        ["slip (t_slip)", "not applicable", "0 of 0", "", "it has no output t_slip"],
        ["period (T)", "no", "0 of 1", "no value", "two"],
        ["forces (F, F_friction)", "not applicable", "0 of 0", "", "no case"],
    ]
    assert [list(row) for row in places.rows] == [
        ["two", "stick", 50.0, 1.5, ""],
        ["one", "stick", 2.0, 0.5, ""],
        ["two", "period", "no value", "", "the run did not end: it crashed"],
    ]
    assert len(tables_of(found[:2], 0.01)) == 1


def test_half_a_percent_of_static_friction_lengthens_the_stick_by_one_percent() -> None:
    cases = [named("default"), named("damped-cycle")]
    options: dict[str, Any] = {"names": FAULTY.names, "fresh_processes": False, "jobs": 1}
    verdict = verify(FAULTY.path, cases, within=0.008, **options)
    failed = {result.check for result in verdict.checks if result.failed}
    assert {"break-away-force", "t_stick-exact", "x-course"} <= failed
    assert "slip-propagates" not in failed
    answer, places, *_ = verdict.tables
    assert {str(row[0]).split(" ")[0]: row[1] for row in answer.rows} == {
        **dict.fromkeys(QUANTITIES, "yes"),
        "stick": "no",
    }
    assert {row[2] for row in answer.rows} == {"1 of 1", "0 of 1"}
    # 2 Delta/v, over the first load-up.
    assert [list(row[:3]) for row in places.rows] == [["default", "stick", 1.0]]
