"""The judge: the exact motion passes everything; a fault breaks what is about it and no more."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from _pytest.mark import ParameterSet

from stickslip_verification.drive.answer import Answer
from stickslip_verification.drive.exact import exact_motion
from stickslip_verification.judge.checks import (
    EXACT_CONTRACT,
    PHYSICS_CONTRACT,
    STRICT_CONTRACT,
    Contract,
)
from stickslip_verification.judge.invariant_checks import agreeing, judge_agreement
from stickslip_verification.judge.metrics import METRICS, Course
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.model.run import Run
from stickslip_verification.model.verdict import CheckResult
from stickslip_verification.suite.cases import CASES_FOLDER, Case
from stickslip_verification.suite.experiment import CommunicationStep
from stickslip_verification.suite.invariants import load_invariants

from .records import (
    INVARIANTS,
    Draft,
    Fault,
    at_start,
    believed,
    checked,
    exact_of,
    failures,
    judged,
    lagging,
    named,
    planted,
    scaled,
    seen,
    shown,
    value,
    without,
)

DEFAULT = exact_of("default").record
AGREE = {invariant.quantity: invariant for invariant in load_invariants().agreements}

ROUNDED_ONCE = 2e-15
"""Nine units in the last place: what the few samples that a residual is made of are rounded to."""

W = math.sqrt(1000.0)


FEW = {"stribeck-exponential", "curve-between-ranges", "hyperbolic-leine"}


def cases() -> list[ParameterSet]:
    """Return the cases; the truth of `long-run`, and where friction depends on speed, is costly."""
    files = sorted(CASES_FOLDER.glob("*.toml"))
    costly = {file.stem for file in files if "\nlaw = " in file.read_text(encoding="utf-8")} - FEW
    costly.add("long-run")
    soak = dict.fromkeys(costly, pytest.mark.soak)
    return [pytest.param(file.stem, marks=soak.get(file.stem, ())) for file in files]


@pytest.mark.parametrize("name", cases())
def test_the_exact_motion_passes_every_check_and_invariant(name: str) -> None:
    record = exact_of(name).record
    assert failures(name, record) == {}
    assert seen(name, record) == set()
    left = {id_: r.error for id_, r in judged(name, record).items() if r.error}
    assert {id_: error for id_, error in left.items() if error > ROUNDED_ONCE} == {}


def in_stick(draft: Draft) -> int:
    """Return the place of the fourth sample of the stick after slip 3."""
    stuck = (draft.outputs["mode"] == 0.0) & (draft.outputs["n_slips"] == 3.0)
    return int(np.flatnonzero(stuck)[0]) + 3


def bit_of_x(draft: Draft) -> None:
    at = in_stick(draft)
    draft.outputs["x"][at] = np.nextafter(draft.outputs["x"][at], math.inf)


def heat_given_back(draft: Draft) -> None:
    draft.outputs["Q_friction"][in_stick(draft) :] -= 1e-13


def creep(step: float) -> Fault:
    return shown("x", lambda o: o["x"] + step * np.cumsum(o["mode"] == 0.0))


def dated_at_step_ends(draft: Draft) -> None:
    dated = draft.outputs["t_event"]
    at = np.minimum(np.searchsorted(DEFAULT.times, dated), DEFAULT.times.size - 1)
    draft.outputs["t_event"] = np.where(dated > 0.0, DEFAULT.times[at], 0.0)


def period_of_before(draft: Draft) -> None:
    T = draft.outputs["T"]
    last = np.append(0.0, T[:-1])
    T = np.where(last == T, last, 1.25 * T)
    draft.outputs["T"] = T
    draft.outputs["f"] = np.divide(1.0, T, out=np.zeros_like(T), where=T > 0.0)


designers = shown("t_slip", lambda o: np.where(o["t_slip"] > 0.0, math.pi / W, 0.0))
no_viscous_part = shown(
    "F_friction", lambda o: o["F_friction"] + named("damped-cycle").parameters["c"] * o["x_dot"]
)
half_normal_force = shown("F_s", lambda o: np.full_like(o["F_s"], 0.5 * 9.81))
relief_for_jump = shown("delta_x", lambda o: o["spring_drop"].copy())
unsigned_jump = shown("delta_x", lambda o: np.abs(o["delta_x"]))
slip_for_stick = shown("sticking", lambda o: 1.0 - o["sticking"])
speed_in_stick = shown("x_dot", lambda o: np.where(o["mode"] == 0.0, 1e-18, o["x_dot"]))

HEAT = "heat-of-dry-friction"
STICK_HOLDS = "stick-holds-x stick-holds-x-to-the-bit extension-is-the-gap-of-the-ends"
FRICTION = "stick-friction-balances slip-friction slip-friction-against-motion"
DATES = "onset-at-break-away restick-at-rest phases-join"
CYCLE = "period-is-stick-and-slip jump-is-v-T"

# The case, a fault in its record, the invariants that it breaks, and a check that it fails.
FAULTS: list[tuple[str, Fault, str, str | None]] = [
    ("default", creep(1e-12), STICK_HOLDS, "x-course"),
    ("default", bit_of_x, "stick-holds-x-to-the-bit", None),
    ("default", speed_in_stick, "stick-has-no-speed", None),
    ("default", scaled("F_friction", -1.0), FRICTION, "F_friction-course"),
    ("damped-cycle", no_viscous_part, "slip-friction", None),
    ("default", dated_at_step_ends, DATES, "t_event-course"),
    ("default", lagging("n_slips"), "restick-at-rest", "n_slips-course"),
    ("default", lagging("F"), "force-is-k-z", "F-course"),
    ("default", scaled("F", 1.0 + 1e-13), "force-is-k-z", None),
    ("load-pulses", half_normal_force, "break-away-force-is-mu_s-N", "F_s-course"),
    ("tuned", scaled("W_k", 0.0), "energy-balance", "W_k-course"),
    ("damped-cycle", scaled("Q_friction", 1.01), "energy-balance", None),
    ("default", scaled("Q_friction", 1.01), f"energy-balance {HEAT}", "Q_friction-course"),
    ("default", scaled("W_pull", 1.01), "energy-balance work-of-the-pull", "W_pull-course"),
    ("default", heat_given_back, f"heat-never-falls {HEAT}", None),
    ("reversals", lagging("T"), f"{CYCLE} frequency-is-1-over-T", "T-course"),
    ("default", period_of_before, CYCLE, None),
    ("default", designers, "period-is-stick-and-slip", "t_slip-exact"),
    ("default", scaled("f", 2.0 * math.pi), "frequency-is-1-over-T", "f-exact"),
    ("default", relief_for_jump, "jump-is-v-T", "simplified-jump-leaves-out"),
    ("reversed-pull", unsigned_jump, "jump-is-v-T", "delta_x-exact"),
    ("default", slip_for_stick, "mode-and-sticking-agree", "sticking-course"),
    ("default", scaled("t_stick", 1 + 1e-11), "period-is-stick-and-slip", "t_stick-exact"),
    ("default", scaled("x_dot_peak", 1 + 1e-11), "", "x_dot_peak-exact"),
    ("default", scaled("spring_drop", 1e3), "", "spring_drop-exact"),
    ("clamp", scaled("mu_k_used", 0.6 / 0.49), "mu_k-clamped start-values", "mu_k_used-course"),
    ("default", at_start("t_stick", 1e-9), "start-values", None),
    ("default", value("F", math.nan, 7), "finite force-is-k-z", "F-course"),
    ("default", value("t_slip", math.inf, 403), "finite period-is-stick-and-slip", None),
    ("default", value("x_dot_peak", math.nan, 400), "finite", None),
    ("default", without("f"), "columns frequency-is-1-over-T", "f-exact"),
]


@pytest.mark.parametrize(("name", "fault", "invariants", "check"), FAULTS)
def test_a_fault_breaks_what_is_about_it(
    name: str, fault: Fault, invariants: str, check: str | None
) -> None:
    record = planted(exact_of(name).record, fault)
    assert seen(name, record) == set(invariants.split())
    failed = failures(name, record)
    assert check is None or check in failed
    assert all(r.failure or r.error > r.tolerance for r in failed.values() if r.error is not None)


MOTION = "slip-propagates slip-propagates-velocity work-of-the-pull restick-at-rest phases-join"
"""What an equation of slip with another constant in it always breaks."""

BREAK_AWAY = "onset-at-break-away break-away-force-is-mu_s-N"
BEYOND = f"{BREAK_AWAY} stick-within-break-away"
DRY = f"{MOTION} slip-friction {HEAT}"

# The case, another constant in the world of the record, invariants broken and kept, a failed check.
WORLDS: list[tuple[str, tuple[str, float], str, str, str]] = [
    ("default", ("mu_s", 0.5005), BREAK_AWAY, f"{DRY} energy-balance", "first-load-up"),
    ("default", ("mu_s", 0.55), BEYOND, f"{DRY} stick-friction-balances", "break-away-force"),
    ("reversed-pull", ("mu_s", 0.5025), BREAK_AWAY, f"{MOTION} {CYCLE}", "t_stick-exact"),
    ("default", ("mu_k", 0.3003), f"{DRY} mu_k-clamped", BREAK_AWAY, "spring_drop-exact"),
    ("default", ("c", 1e-6), DRY, f"{BREAK_AWAY} energy-balance", "x_dot-course"),
    ("default", ("k", 1001.0), f"{MOTION} force-is-k-z energy-balance", HEAT, "t_slip-exact"),
    ("default", ("g", 9.80665), f"{DRY} {BREAK_AWAY}", "force-is-k-z", "break-away-force"),
    ("default", ("v", 0.02002), f"{MOTION} pull-moves-at-v", HEAT, "x_pull-course"),
    ("default", ("F_ext", 0.01), f"{MOTION} energy-balance", f"slip-friction {HEAT}", "x-course"),
    ("reversed-pull", ("v", 0.02), "pull-moves-at-v", "slip-friction", "x_dot_peak-exact"),
]


@pytest.mark.parametrize(("name", "other", "broken", "kept", "check"), WORLDS)
def test_the_motion_of_another_world_breaks_what_has_its_constant_in_it(
    name: str, other: tuple[str, float], broken: str, kept: str, check: str
) -> None:
    record = believed(name, other)
    found = seen(name, record)
    assert set(broken.split()) <= found
    assert not set(kept.split()) & found
    assert check in failures(name, record)


def test_every_invariant_on_samples_is_broken_by_some_fault() -> None:
    rows = [*(row[2] for row in FAULTS), *(row[2] for row in WORLDS)]
    # These have a test of their own, here or with the runs.
    own = "onset-beyond-break-away onset-follows-the-force slip-follows-mode runs-to-the-end"
    assert set(INVARIANTS) == set(f"{own} slip-stops-where-it-rests {' '.join(rows)}".split())


def test_a_spring_that_jumps_at_the_stop_breaks_the_join_of_the_phases() -> None:
    def late(draft: Draft) -> None:
        rests = (draft.outputs["mode"] == 0.0) & (draft.outputs["n_slips"] > 0.0)
        for name in ("z", "x_pull"):
            draft.outputs[name] += 1e-10 * rests

    found = seen("default", planted(DEFAULT, late))
    assert {"phases-join", "pull-moves-at-v", "energy-balance"} <= found
    assert not {"slip-propagates", "stick-holds-x", "extension-is-the-gap-of-the-ends"} & found


def test_a_slip_backward_that_is_called_forward_goes_against_mode() -> None:
    fault = shown("mode", lambda o: np.abs(o["mode"]))
    found = seen("reversed-pull", planted(exact_of("reversed-pull").record, fault))
    assert {"slip-follows-mode", "onset-follows-the-force", "slip-friction"} <= found
    assert not {"stick-holds-x", "force-is-k-z", "mode-and-sticking-agree"} & found


def test_a_mass_that_lets_go_although_friction_could_hold_is_seen() -> None:
    case = named("load-pulses")
    steps = tuple(
        replace(step, changes={**step.changes, "load": 0.5 * step.changes["load"] - 4.0})
        if "load" in step.changes
        else step
        for step in case.steps
    )
    found = seen("load-pulses", exact_motion(replace(case, steps=steps)).record)
    assert "onset-beyond-break-away" in found
    assert not {"force-is-k-z", "pull-moves-at-v", "mode-and-sticking-agree"} & found


def test_no_number_at_the_start_is_seen_in_every_output() -> None:
    exact = exact_of("crumbs").record
    faults = {name: at_start(name, math.nan) for name in OUTPUT_NAMES}
    assert [n for n, fault in faults.items() if not seen("crumbs", planted(exact, fault))] == []


@pytest.mark.parametrize(
    ("fault", "check", "reason"),
    [
        (without("f"), "f-exact", "no output f"),
        (shown("T", lambda o: o["T"][:-1]), "T-exact", "999 samples of T at 1000 points"),
        (value("x", math.nan, 7), "x-course", "x is nan at t = 0.08 s"),
        (value("x", math.inf, 7), "x-course", "x is inf at t = 0.08 s"),
    ],
)
def test_what_cannot_be_compared_fails_with_its_reason(
    fault: Fault, check: str, reason: str
) -> None:
    result = failures("default", planted(DEFAULT, fault))[check]
    assert (result.failure, result.got, result.error) == (reason, None, None)
    assert result.expected is not None


@pytest.mark.parametrize("name", ["T", "z", "mode", "t_event"])
def test_a_lost_sample_is_a_failure_and_no_crash(name: str) -> None:
    results = judged("default", planted(DEFAULT, shown(name, lambda o: o[name][:-1])))
    assert {"columns", "finite"} <= {id_ for id_, r in results.items() if not r.passed}
    assert all(r.passed or r.failure or r.error for r in results.values())


def test_a_record_that_stops_early_fails_every_check() -> None:
    early = Run(DEFAULT.times[:10], {n: s[:10] for n, s in DEFAULT.outputs.items()}, {})
    assert set(failures("default", early)) == {check.id for check in named("default").checks}


LACKING = ["fail", "not applicable", "not applicable"]
CONTRACTS = (EXACT_CONTRACT, STRICT_CONTRACT, PHYSICS_CONTRACT)


@pytest.mark.parametrize(
    ("name", "fault", "check", "verdicts"),
    [
        ("default", without("n_slips"), "restick-at-rest", LACKING),
        # An error of 1e-10 is one of a good numerical solution, and not of the exact block.
        ("default", scaled("F", 1.0 + 1e-10), "F-course", ["fail", "fail", "pass"]),
        # A foreign FMU need not have every output.
        ("default", without("f"), "f-exact", LACKING),
        # How mu_k is clamped is a convention.
        ("clamp", scaled("mu_k_used", 0.9), "mu_k_used-course", ["fail", "fail", "noted"]),
    ],
)
def test_a_contract_decides_what_is_a_failure(
    name: str, fault: Fault, check: str, verdicts: list[str]
) -> None:
    record = planted(exact_of(name).record, fault)
    results = [{**checked(name, record, c), **judged(name, record, c)}[check] for c in CONTRACTS]
    assert [result.verdict for result in results] == verdicts
    assert verdicts != LACKING or results[-1].not_applicable == f"it has {results[0].failure}"


def test_who_never_slips_does_not_keep_the_invariants_of_slip() -> None:
    result = judged("default", planted(DEFAULT, scaled("mode", 0.0)))["slip-propagates"]
    assert result.failure == "the run has no such place; the exact motion has"


def test_a_result_shows_the_worst_place_in_its_unit() -> None:
    off = 0.25 - float(DEFAULT.outputs["x_pull"][700])
    result = judged("default", planted(DEFAULT, value("x_pull", 0.25, 700)))["pull-moves-at-v"]
    assert (result.unit, result.expected) == ("m", 0.0)
    # Both neighbours are off by as much, but for rounding of the largest length, 0.2 m.
    assert abs(result.got or 0.0) == pytest.approx(abs(off), abs=1e-15)
    assert result.error == pytest.approx(abs(off) / 0.2, rel=1e-13)


def passed_unseen(turns: float, depth: float, phase: float = 0.4) -> float:
    """Return the dip that the invariant finds in an undamped slip of two steps, over its depth.

    The velocity goes `depth` v below zero inside steps of so many `turns`, and mode never changes.
    """
    v, level, h = 0.02, 0.3 * 9.81 / 1000.0, turns * 2.0 * math.pi / W
    swing = v * (1.0 + depth)

    def moved(t: float) -> dict[str, float]:
        z = level - swing / W * math.sin(W * t + phase)
        x_dot = v + swing * math.cos(W * t + phase)
        still = {"mode": 1.0, "sticking": 0.0, "t_event": 0.0, "n_slips": 0.0}
        return {"x_dot": x_dot, "z": z, "x": v * t - z, "x_pull": v * t, **still}

    first = moved(0.0)
    start = {f"{name}_start": first[name] for name in ("x_dot", "z", "x")}
    case = Case("dips", "", "", start, (CommunicationStep(h, {}),) * 2, (), Path("dips.toml"))
    rows = [moved(t) for t in case.times]
    columns = {name: np.array([row[name] for row in rows]) for name in first}
    record = Run(np.array(case.times), columns, first)
    residual = METRICS["slip.never_past_rest"](Course(case, record, record, np.array([])))
    return float(np.max(residual.values)) / (v * depth)


@pytest.mark.parametrize("turns", [0.9, 1.0, 4.0, 7.7, 16.0])
@pytest.mark.parametrize("depth", [1e-3, 1e-9])
def test_a_dip_below_rest_inside_a_step_is_found_with_its_depth(turns: float, depth: float) -> None:
    # The samples are rounded to 2e-16 of the swing and of the turns; the depth is a small part.
    for phase in (0.4, 2.0, 3.6, 5.2):
        found = passed_unseen(turns, depth, phase)
        assert found == pytest.approx(1.0, abs=max(1e-15, 1e-16 * turns) / depth)


def test_a_velocity_that_stays_above_zero_is_no_stop() -> None:
    assert passed_unseen(1.0, -1e-9) == 0.0


def agreed(quantity: str, fault: Fault, contract: Contract) -> CheckResult:
    """Hold a record of `default` with a fault against the exact one in the reference's place."""
    case, exact = named("default"), exact_of("default")
    check = agreeing(AGREE[quantity], case)
    assert check is not None
    answers = {"fmu": Answer(planted(DEFAULT, fault)), "reference": Answer(DEFAULT)}
    return judge_agreement(AGREE[quantity], case, check, contract, Answer(exact), answers)


@pytest.mark.parametrize("contract", [EXACT_CONTRACT, PHYSICS_CONTRACT])
def test_fmu_and_reference_may_differ_by_the_sum_of_their_tolerances(contract: Contract) -> None:
    (check,) = (each for each in named("default").checks if each.id == "t_event-course")
    allowed = check.tolerance[contract.column] + check.tolerance["reference"]
    for off, passes in ((0.0, True), (0.9 * allowed, True), (1.1 * allowed, False)):
        result = agreed("t_event", scaled("t_event", 1.0 + off), contract)
        assert (result.passed, result.tolerance) == (passes, allowed)
        assert (result.side, result.truth) == ("both", "cross_code")


def test_what_does_not_agree_says_why() -> None:
    lost, nan = without("t_event"), value("x", math.nan, 5)
    assert agreed("t_event", lost, EXACT_CONTRACT).failure == "no output t_event"
    foreign = agreed("t_event", lost, PHYSICS_CONTRACT)
    assert foreign.not_applicable == "it has no output t_event"
    assert agreed("x", nan, PHYSICS_CONTRACT).failure == "x is no finite number on one side"
    more = agreed("n_slips", shown("n_slips", lambda o: o["n_slips"] + 1.0), PHYSICS_CONTRACT)
    assert (more.passed, more.error) == (False, 1.0)
    assert agreeing(AGREE["x_dot"], named("fast-pull")) is None


@pytest.mark.parametrize("name", ["reversals", "tuned", "damped-cycle", "one-step", "crumbs"])
def test_what_is_not_reported_is_taken_from_the_exact_motion(name: str) -> None:
    for lacking in ("t_event", "n_slips", "mode"):
        record = planted(exact_of(name).record, without(lacking))
        assert seen(name, record, PHYSICS_CONTRACT) <= {"columns"}, lacking
        assert judged(name, record, PHYSICS_CONTRACT)["energy-balance"].passed
