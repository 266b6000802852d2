"""The judge: the exact motion passes everything; a fault breaks what is about it and no more."""

import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from _pytest.mark import ParameterSet

from stickslip_verification.drive.exact import exact_motion
from stickslip_verification.drive.processes import Answer
from stickslip_verification.judge.checks import (
    EXACT_CONTRACT,
    PHYSICS_CONTRACT,
    STRICT_CONTRACT,
    Contract,
    agreeing,
    judge_agreement,
)
from stickslip_verification.judge.course import Course
from stickslip_verification.judge.metrics import METRICS
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.model.verdict import CommunicationStep, Run
from stickslip_verification.suite.cases import CASES_FOLDER, Case
from stickslip_verification.suite.invariants import load_invariants

from .records import (
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


W = math.sqrt(1000.0)

LAWS = {"stribeck-exponential", "curve-between-ranges", "hyperbolic-leine"}
"""Cases of friction that depends on speed whose truth is not costly."""


def cases() -> list[ParameterSet]:
    files = sorted(CASES_FOLDER.glob("*.toml"))
    costly = {file.stem for file in files if "\nlaw = " in file.read_text(encoding="utf-8")} - LAWS
    soak = dict.fromkeys({*costly, "long-run"}, pytest.mark.soak)
    return [pytest.param(file.stem, marks=soak.get(file.stem, ())) for file in files]


@pytest.mark.parametrize("name", cases())
def test_the_exact_motion_passes_every_check_and_invariant(name: str) -> None:
    record = exact_of(name).record
    assert failures(name, record) == {}
    assert seen(name, record) == set()
    # Nine units in the last place: what the few samples that a residual is made of are rounded to.
    assert max(result.error or 0.0 for result in judged(name, record).values()) < 2e-15


def bit_of_x(draft: Draft) -> None:
    stuck = (draft.outputs["mode"] == 0.0) & (draft.outputs["n_slips"] == 3.0)
    at = int(np.flatnonzero(stuck)[3])
    draft.outputs["x"][at] = np.nextafter(draft.outputs["x"][at], math.inf)


def creep(step: float) -> Fault:
    return shown("x", lambda o: o["x"] + step * np.cumsum(o["mode"] == 0.0))


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
CYCLE = "period-is-stick-and-slip jump-is-v-T frequency-is-1-over-T"
FRICTION = "stick-friction-balances slip-friction slip-friction-against-motion"

# The case, a fault in its record, the invariants that it breaks, and a check that it fails.
FAULTS: list[tuple[str, Fault, str, str | None]] = [
    ("default", creep(1e-12), STICK_HOLDS, "x-course"),
    ("default", bit_of_x, "stick-holds-x-to-the-bit", None),
    ("default", speed_in_stick, "stick-has-no-speed", None),
    ("default", scaled("F_friction", -1.0), FRICTION, "F_friction-course"),
    ("damped-cycle", no_viscous_part, "slip-friction", None),
    ("default", lagging("n_slips"), "restick-at-rest", "n_slips-course"),
    ("default", scaled("F", 1.0 + 1e-13), "force-is-k-z", None),
    ("load-pulses", half_normal_force, "break-away-force-is-mu_s-N", "F_s-course"),
    ("tuned", scaled("W_k", 0.0), "energy-balance", "W_k-course"),
    ("default", scaled("Q_friction", 1.01), f"energy-balance {HEAT}", "Q_friction-course"),
    ("default", scaled("W_pull", 1.01), "energy-balance work-of-the-pull", "W_pull-course"),
    ("reversals", lagging("T"), CYCLE, "T-course"),
    ("default", scaled("f", 2.0 * math.pi), "frequency-is-1-over-T", "f-exact"),
    ("default", relief_for_jump, "jump-is-v-T", "simplified-jump-leaves-out"),
    ("reversed-pull", unsigned_jump, "jump-is-v-T", "delta_x-exact"),
    ("default", slip_for_stick, "mode-and-sticking-agree", "sticking-course"),
    ("default", scaled("t_stick", 1 + 1e-11), "period-is-stick-and-slip", "t_stick-exact"),
    ("default", scaled("x_dot_peak", 1 + 1e-11), "", "x_dot_peak-exact"),
    ("default", scaled("spring_drop", 1e3), "", "spring_drop-exact"),
    ("clamp", scaled("mu_k_used", 0.6 / 0.49), "mu_k-clamped start-values", "mu_k_used-course"),
    ("default", value("F", math.nan, 7), "finite force-is-k-z", "F-course"),
    ("default", value("t_slip", math.inf, 403), "finite period-is-stick-and-slip", None),
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


def world(name: str, value: float) -> Callable[[str], Run]:
    return lambda case: believed(case, (name, value))


def moved_in_stick(draft: Draft) -> None:
    rests = (draft.outputs["mode"] == 0.0) & (draft.outputs["n_slips"] > 0.0)
    for name in ("z", "x_pull"):
        draft.outputs[name] += 1e-10 * rests


def with_forward_slips(case: str) -> Run:
    return planted(exact_of(case).record, shown("mode", lambda o: np.abs(o["mode"])))


def with_half_the_load(case: str) -> Run:
    def halved(changes: Mapping[str, float]) -> Mapping[str, float]:
        return {n: 0.5 * x - 4.0 if n == "load" else x for n, x in changes.items()}

    steps = tuple(replace(step, changes=halved(step.changes)) for step in named(case).steps)
    return exact_motion(replace(named(case), steps=steps)).record


MOTION = "slip-propagates slip-propagates-velocity work-of-the-pull restick-at-rest phases-join"
"""What an equation of slip with another constant in it always breaks."""

BREAK_AWAY = "onset-at-break-away break-away-force-is-mu_s-N"
DRY = f"{MOTION} slip-friction {HEAT}"
LATE = "phases-join pull-moves-at-v energy-balance"
FORWARD = "slip-follows-mode onset-follows-the-force slip-friction"

# The case, its record, invariants broken and kept.
WORLDS: list[tuple[str, Callable[[str], Run], str, str]] = [
    ("default", world("mu_s", 0.5005), BREAK_AWAY, f"{DRY} energy-balance"),
    ("default", world("mu_s", 0.55), f"{BREAK_AWAY} stick-within-break-away", DRY),
    ("default", world("mu_k", 0.3003), f"{DRY} mu_k-clamped", BREAK_AWAY),
    ("default", world("c", 1e-6), DRY, f"{BREAK_AWAY} energy-balance"),
    ("default", world("k", 1001.0), f"{MOTION} force-is-k-z energy-balance", HEAT),
    ("default", world("g", 9.80665), f"{DRY} {BREAK_AWAY}", "force-is-k-z"),
    ("default", world("F_ext", 0.01), f"{MOTION} energy-balance", f"slip-friction {HEAT}"),
    ("reversed-pull", world("v", 0.02), "pull-moves-at-v", "slip-friction"),
    ("default", lambda _: planted(DEFAULT, moved_in_stick), LATE, "slip-propagates stick-holds-x"),
    ("reversed-pull", with_forward_slips, FORWARD, "stick-holds-x mode-and-sticking-agree"),
    ("load-pulses", with_half_the_load, "onset-beyond-break-away", "force-is-k-z pull-moves-at-v"),
]


@pytest.mark.parametrize(("name", "record", "broken", "kept"), WORLDS)
def test_the_motion_of_another_world_breaks_what_has_its_constant_in_it(
    name: str, record: Callable[[str], Run], broken: str, kept: str
) -> None:
    found = seen(name, record(name))
    assert set(broken.split()) <= found
    assert not set(kept.split()) & found


def test_no_number_at_the_start_is_seen_in_every_output() -> None:
    exact = exact_of("crumbs").record
    faults = {name: at_start(name, math.nan) for name in OUTPUT_NAMES}
    assert [n for n, fault in faults.items() if not seen("crumbs", planted(exact, fault))] == []


@pytest.mark.parametrize(
    ("fault", "check", "reason"),
    [
        (without("f"), "f-exact", "no output f"),
        (shown("T", lambda o: o["T"][:-1]), "T-exact", "999 samples of T at 1000 points"),
        (value("x", math.inf, 7), "x-course", "x is inf at t = 0.08 s"),
    ],
)
def test_what_cannot_be_compared_fails_with_its_reason(
    fault: Fault, check: str, reason: str
) -> None:
    record = planted(DEFAULT, fault)
    result = failures("default", record)[check]
    assert (result.failure, result.got, result.error) == (reason, None, None)
    assert {"columns", "finite"} & seen("default", record)
    early = Run(DEFAULT.times[:10], {n: s[:10] for n, s in DEFAULT.outputs.items()}, {})
    assert set(failures("default", early)) == {check.id for check in named("default").checks}


LACKING = ["fail", "not applicable", "not applicable"]
CONTRACTS = (EXACT_CONTRACT, STRICT_CONTRACT, PHYSICS_CONTRACT)


@pytest.mark.parametrize(
    ("name", "fault", "check", "verdicts"),
    [
        # A foreign FMU need not have every output.
        ("default", without("n_slips"), "restick-at-rest", LACKING),
        # An error of 1e-10 is one of a good numerical solution, and not of the exact block.
        ("default", scaled("F", 1.0 + 1e-10), "F-course", ["fail", "fail", "pass"]),
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


def passed_unseen(turns: float, depth: float, phase: float) -> float:
    """Return the dip that the invariant finds in an undamped slip of two steps, over its depth.

    The velocity goes `depth` v below zero inside steps of so many `turns`, and mode never changes.
    """
    v, level, h = 0.02, 0.3 * 9.81 / 1000.0, turns * 2.0 * math.pi / W
    swing = v * (1.0 + depth)

    def moved(t: float) -> dict[str, float]:
        z = level - swing / W * math.sin(W * t + phase)
        x_dot = v + swing * math.cos(W * t + phase)
        still = ("sticking", "t_event", "n_slips", "F_s", "W_pull", "W_k", "Q_friction")
        moving = {"x_dot": x_dot, "z": z, "x": v * t - z, "x_pull": v * t, "mode": 1.0}
        return moving | dict.fromkeys(still, 0.0)

    first = moved(0.0)
    start = {f"{name}_start": first[name] for name in ("x_dot", "z", "x")}
    case = Case("dips", "", "", start, (CommunicationStep(h, {}),) * 2, (), Path("dips.toml"))
    rows = [moved(t) for t in case.times]
    columns = {name: np.array([row[name] for row in rows]) for name in first}
    record = Run(np.array(case.times), columns, first)
    residual = METRICS["slip.never_past_rest"](Course(case, record, record, np.array([])))
    return float(np.max(residual.values)) / (v * depth)


@pytest.mark.parametrize("turns", [0.9, 1.0, 4.0, 7.7, 16.0])
def test_a_dip_below_rest_inside_a_step_is_found_with_its_depth(turns: float) -> None:
    for depth, phase in itertools.product((1e-3, 1e-9), (0.4, 2.0, 3.6, 5.2)):
        # The samples are rounded to 2e-16 of the swing and of the turns, the depth a part of it.
        rounding = max(1e-15, 1e-16 * turns) / depth
        assert passed_unseen(turns, depth, phase) == pytest.approx(1.0, abs=rounding)
        assert passed_unseen(turns, -depth, phase) == 0.0


@pytest.mark.parametrize("contract", [EXACT_CONTRACT, PHYSICS_CONTRACT])
@pytest.mark.parametrize(
    ("quantity", "fault", "why"),
    [
        # In parts of the sum of both tolerances.
        ("t_event", 0.9, None),
        ("t_event", 1.1, None),
        ("t_event", without("t_event"), "no output t_event"),
        ("x", value("x", math.nan, 5), "x is no finite number on one side"),
    ],
)
def test_fmu_and_reference_may_differ_by_the_sum_of_their_tolerances(
    contract: Contract, quantity: str, fault: Fault | float, why: str | None
) -> None:
    case, exact = named("default"), exact_of("default")
    (agree,) = (each for each in load_invariants().agreements if each.quantity == quantity)
    (check,) = (each for each in case.checks if each.id == f"{quantity}-course")
    allowed = check.tolerance[contract.column] + check.tolerance["reference"]
    planting = scaled(quantity, 1.0 + fault * allowed) if isinstance(fault, float) else fault
    answers = Answer(planted(DEFAULT, planting)), Answer(DEFAULT)
    held = agreeing(agree, case)
    assert held is not None
    result = judge_agreement(agree, case, held, contract, Answer(exact), *answers)
    assert (result.side, result.truth, result.passed) == ("both", "cross_code", fault == 0.9)
    lacks = f"it has {why}" if contract is PHYSICS_CONTRACT and quantity == "t_event" else None
    assert result.not_applicable == (lacks if why else None)
    assert lacks or result.failure == why


@pytest.mark.parametrize("name", ["reversals", "tuned", "damped-cycle", "one-step", "crumbs"])
def test_what_is_not_reported_is_taken_from_the_exact_motion(name: str) -> None:
    for lacking in ("t_event", "n_slips", "mode"):
        record = planted(exact_of(name).record, without(lacking))
        assert seen(name, record, PHYSICS_CONTRACT) <= {"columns"}, lacking
        assert judged(name, record, PHYSICS_CONTRACT)["energy-balance"].passed
