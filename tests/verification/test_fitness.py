"""Fitness: how far jump, stick, slip, period and forces are off, whatever the verdict says."""

import math
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from stickslip_verification import NameMap, load_mutants, verify
from stickslip_verification.drive.answer import Answer
from stickslip_verification.drive.moments import moments
from stickslip_verification.drive.planting import plant
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
from stickslip_verification.model.verdict import Table

from .records import believed, exact_of, named

METER = ("jump", "stick", "slip", "period")


def fits(name: str, run: Run, within: float = 0.01) -> dict[str, Fit]:
    """Return the fits of a run as the one of an FMU in a case, by quantity."""
    exact = exact_of(name)
    try:
        matched = Answer(moments(named(name), exact, run))
    except NotApplicableError as error:
        matched = Answer(not_applicable=str(error))
    return {fit.quantity: fit for fit in fits_of(name, exact, run, matched, within)}


def errors(name: str, run: Run) -> dict[str, float | None]:
    """Return the errors by quantity."""
    return {quantity: fit.error for quantity, fit in fits(name, run).items()}


def without(run: Run, *names: str) -> Run:
    """Return a run that lacks outputs."""
    return replace(run, outputs={n: s for n, s in run.outputs.items() if n not in names})


def changed(run: Run, **outputs: np.ndarray) -> Run:
    """Return a run with other samples of some outputs."""
    return replace(run, outputs={**run.outputs, **outputs})


@pytest.mark.parametrize(
    "name", ["default", "reversals", "tuned", "lifted-and-set-down", "start-beyond", "long-run"]
)
def test_the_exact_motion_has_no_error(name: str) -> None:
    """Every moment of it is found again: no error beyond the distance from the phases' ends."""
    for fit in fits(name, exact_of(name).record).values():
        assert fit.error is not None
        assert fit.error < 1e-5, fit


def test_a_shift_of_the_events_is_no_error_of_the_forces() -> None:
    """With a pull 0.3 % too fast the events drift by half a slip; every level is within 0.4 %."""
    other, exact = believed("default", ("v", 0.02006)), exact_of("default").record
    at_one_time = np.abs(other.outputs["F"] - exact.outputs["F"])
    assert np.max(at_one_time) > 0.1 * np.max(np.abs(exact.outputs["F"]))
    found = errors("default", other)
    assert all(error is not None and error < 0.004 for error in found.values()), found
    # What the pull changes is seen: t_stick = 2 Delta/v.
    assert found["stick"] == pytest.approx(0.003, rel=0.05)


def test_a_moment_is_not_compared_across_a_change() -> None:
    """A spring 0.3 % too stiff: every level is off by less than 1 %, though the load jumps."""
    found = errors("lifted-and-set-down", believed("lifted-and-set-down", ("k", 1003.0)))
    assert all(error is not None and error < 0.01 for error in found.values()), found


@pytest.mark.parametrize(
    ("values", "quantity", "size"),
    [
        # 2 Delta grows by 5 %, F_s by 2 %, and half of that is the mean of the slip.
        ({"mu_s": 0.51}, "stick", 0.05),
        ({"mu_s": 0.51}, "forces", 0.02),
        ({"mu_k": 0.297}, "forces", 0.009),
        # w falls by 1 %: the slip takes 1 % longer.
        ({"m": 1.02, "g": 9.81 / 1.02}, "slip", 0.01),
    ],
)
def test_an_error_of_a_level_is_told_by_its_size(
    values: dict[str, float], quantity: str, size: float
) -> None:
    """A coefficient or a mass that is off shows with the size that the closed forms give."""
    found = errors("default", believed("default", *values.items()))[quantity]
    assert found is not None
    assert 0.8 * size < found < 2.0 * size


def test_a_mass_that_never_slips_is_within_nothing() -> None:
    """Cycles that are missing count, although no moment of them can be compared."""
    stuck = believed("default", ("mu_s", 50.0))
    for quantity, fit in fits("default", stuck).items():
        assert fit.error == 1.0, quantity
        assert fit.why == f"0 slips, not {int(exact_of('default').record.outputs['n_slips'][-1])}"


def test_phases_that_the_exact_motion_does_not_have_are_within_nothing() -> None:
    """Samples that are numbered wrongly have no counterpart."""
    record = exact_of("default").record
    numbers = np.array(record.outputs["n_slips"])
    numbers[:-1] += 1000.0
    fit = fits("default", changed(record, n_slips=numbers))["forces"]
    assert fit.error == math.inf
    assert "points lie in no stick or slip of the exact motion" in fit.why


def test_a_value_that_is_no_number_is_no_fit() -> None:
    """NaN is within nothing."""
    record = exact_of("default").record
    broken = np.array(record.outputs["t_slip"])
    broken[40] = math.nan  # in the second stick
    found = errors("default", changed(record, t_slip=broken))
    assert found["slip"] == math.inf
    assert found["jump"] is not None
    assert found["jump"] < 1e-5


def test_what_a_meter_shows_of_the_start_is_a_convention() -> None:
    """A first load-up that is not shown, or a first period from the start, is no error."""
    record = exact_of("default").record
    outputs, slips = record.outputs, record.outputs["n_slips"]
    unseen = np.where(slips < 2, 0.0, outputs["t_stick"])
    counted = np.where((slips == 1) & (outputs["T"] == 0.0), 0.36, outputs["T"])
    found = errors("default", changed(record, t_stick=unseen, T=counted))
    assert all(error is not None and error < 1e-5 for error in found.values()), found
    # After two slips it is no convention.
    silent = errors("default", changed(record, t_stick=np.zeros_like(slips)))["stick"]
    assert silent is not None
    assert silent > 0.7


def test_phases_are_dated_without_t_event() -> None:
    """The lengths of the phases add up to the times of the events."""
    record = exact_of("default").record
    assert errors("default", without(record, "t_event")) == pytest.approx(
        errors("default", record), abs=1e-6
    )
    # A meter that does not show the first load-up dates nothing, and tells no false force.
    unseen = np.where(record.outputs["n_slips"] == 0, 0.0, record.outputs["t_stick"])
    fit = fits("default", changed(without(record, "t_event"), t_stick=unseen))["forces"]
    assert (fit.error, fit.why) == (None, "it has no output t_event")


@pytest.mark.parametrize(
    ("lacks", "quantities", "why"),
    [
        (("n_slips",), tuple(QUANTITIES), "it has no output n_slips"),
        (("sticking", "mode"), tuple(QUANTITIES), "it has no output sticking or mode"),
        (("T",), ("period",), "it has no output T"),
        (("F", "F_friction"), ("forces",), "it has no output F"),
        (("t_slip",), ("slip",), "it has no output t_slip"),
        (("mode",), (), ""),
        (("F",), (), ""),
    ],
)
def test_what_an_fmu_lacks_does_not_apply(
    lacks: tuple[str, ...], quantities: Iterable[str], why: str
) -> None:
    """The reason is told; the other quantities are compared."""
    found = fits("default", without(exact_of("default").record, *lacks))
    assert {quantity for quantity, fit in found.items() if fit.error is None} == set(quantities)
    assert {found[quantity].why for quantity in quantities} <= {why}


def test_without_dates_the_forces_do_not_apply() -> None:
    """Neither t_event nor the lengths of the phases: the moment of a force is not known."""
    found = fits("default", without(exact_of("default").record, "t_event", "t_slip"))
    assert (found["forces"].error, found["forces"].why) == (None, "it has no output t_event")
    assert found["jump"].error is not None


def test_where_nothing_slips_there_is_no_jump() -> None:
    """No pull, no slip: the forces alone are compared."""
    found = fits("no-pull", exact_of("no-pull").record)
    assert [name for name, fit in found.items() if fit.error is not None] == ["forces"]
    assert found["jump"].why == "there is none in the exact motion"


def test_the_tables_answer_for_each_quantity_and_name_the_places() -> None:
    """Yes where every case is within; else the cases by their size; what does not apply is told."""
    found = [
        Fit("one", "jump", 0.002, 0.5),
        Fit("two", "jump", 0.004, 0.7),
        Fit("one", "stick", 0.02, 0.5),
        Fit("two", "stick", 0.5, 1.5),
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


def test_a_run_that_did_not_end_is_within_nothing() -> None:
    """A crash is a fault of the FMU; a case that it cannot run is none."""
    assert {fit.error for fit in without_run("one", Answer(failure="it crashed"))} == {math.inf}
    assert {fit.error for fit in without_run("one", Answer(not_applicable="no c"))} == {None}


def answered(table: Table) -> dict[str, str]:
    """Return the answer of each quantity."""
    return {str(row[0]).split(" ")[0]: str(row[1]) for row in table.rows}


def test_an_fmu_that_integrates_by_steps_fails_the_verdict_and_is_good_to_two_percent(
    fmu_path: Path, tmp_path: Path
) -> None:
    """A solver with steps of 1 ms misses events by up to one; fitness says how far off that is."""
    (fault,) = load_mutants("fixed-step-1ms")
    verdict = verify(
        plant(fmu_path, fault, tmp_path),
        [named("default"), named("clamp")],
        within=0.02,
        fresh_processes=False,
        jobs=1,
    )
    assert not verdict.passed
    (table,) = verdict.tables
    assert answered(table) == dict.fromkeys(QUANTITIES, "yes")
    # The case of a convention is left out.
    assert {row[2] for row in table.rows} == {"1 of 1"}


def test_a_foreign_fmu_without_t_event_is_answered(
    slider_faulty: Path, slider_mm_names: NameMap
) -> None:
    """Static friction 0.5 % too high: each stick is 2 Delta/v longer by 1 % of the first one."""
    cases = [named("default"), named("damped-cycle")]
    verdict = verify(
        slider_faulty,
        cases,
        names=slider_mm_names,
        within=0.008,
        fresh_processes=False,
        jobs=1,
    )
    answer, places, *_ = verdict.tables
    assert answered(answer) == {
        "jump": "yes", "stick": "no", "slip": "yes", "period": "yes", "forces": "yes",
    }  # fmt: skip
    assert {row[2] for row in answer.rows} == {"1 of 1", "0 of 1"}
    assert [list(row[:3]) for row in places.rows] == [["default", "stick", 1.0]]
