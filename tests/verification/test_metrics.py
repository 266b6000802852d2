"""Invariants on samples: the exact motion keeps them all, a fault breaks those it is about."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from stickslip_verification.drive.exact import exact_motion
from stickslip_verification.judge.checks import EXACT_CONTRACT, PHYSICS_CONTRACT
from stickslip_verification.judge.invariant_checks import judge_residual
from stickslip_verification.judge.metrics import METRICS, Course
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.model.run import Run
from stickslip_verification.suite.cases import CASES_FOLDER, Case
from stickslip_verification.suite.experiment import CommunicationStep

from .records import (
    INVARIANTS,
    Draft,
    Fault,
    at_start,
    believed,
    constant,
    copied,
    exact_of,
    invariants_of,
    judged,
    lagging,
    named,
    planted,
    scaled,
    seen,
    unsigned,
    value,
    without,
)

# A run of 6000 events whose exact motion alone takes longer than all other cases together.
CASES = sorted({file.stem for file in CASES_FOLDER.glob("*.toml")} - {"long-run"})

ROUNDED_ONCE = 2e-15
"""Nine units in the last place: what the few samples that a residual is made of are rounded to."""


@pytest.mark.parametrize("name", CASES)
def test_the_exact_motion_keeps_every_invariant(name: str) -> None:
    """Rounded to double once, the exact motion leaves nothing over but that rounding."""
    results = judged(name, exact_of(name).record)
    assert {invariant: r for invariant, r in results.items() if not r.passed} == {}
    left = {
        invariant: r.error
        for invariant, r in results.items()
        if not (r.error or 0.0) <= ROUNDED_ONCE
    }
    assert left == {}


def test_every_invariant_is_tried_somewhere() -> None:
    """There is no invariant on samples that finds no place in any case."""
    tried = {invariant.id for name in CASES for invariant in invariants_of(name)}
    assert tried == set(INVARIANTS)


def creep(draft: Draft) -> None:
    """Let the mass creep by a picometre a step while it sticks."""
    draft.outputs["x"] += 1e-12 * np.cumsum(draft.outputs["mode"] == 0.0)


def bit_of_x(draft: Draft) -> None:
    """Change the last bit of one position inside a stick."""
    (stuck, *_) = np.flatnonzero((draft.outputs["mode"] == 0.0) & (draft.outputs["n_slips"] == 3.0))
    draft.outputs["x"][stuck + 3] += np.spacing(draft.outputs["x"][stuck + 3])


def speed_in_stick(draft: Draft) -> None:
    """Keep a speed of an attometre a second in stick."""
    draft.outputs["x_dot"][draft.outputs["mode"] == 0.0] = 1e-18


def dated_at_step_ends(draft: Draft) -> None:
    """Date every transition to the end of the step it happens in."""
    times, dated = exact_of("default").record.times, draft.outputs["t_event"]
    ends = times[np.minimum(np.searchsorted(times, dated), times.size - 1)]
    draft.outputs["t_event"] = np.where(dated > 0.0, ends, 0.0)


def period_of_before(draft: Draft) -> None:
    """Show the period of the cycle before, and its reciprocal."""
    last = np.append(0.0, draft.outputs["T"][:-1])
    T = np.where(draft.outputs["T"] == last, last, draft.outputs["T"] * 1.25)
    draft.outputs["T"] = T
    draft.outputs["f"] = np.divide(1.0, T, out=np.zeros_like(T), where=T > 0.0)


def contradiction(draft: Draft) -> None:
    """Say stick and slip at once, at one point."""
    draft.outputs["sticking"][17] = 1.0 - draft.outputs["sticking"][17]


def heat_given_back(draft: Draft) -> None:
    """Take back a tenth of a picojoule in a stick."""
    (stuck, *_) = np.flatnonzero((draft.outputs["mode"] == 0.0) & (draft.outputs["n_slips"] == 3.0))
    draft.outputs["Q_friction"][stuck + 3 :] -= 1e-13


def no_viscous_part(draft: Draft) -> None:
    """Leave damping out of the friction that is shown."""
    draft.outputs["F_friction"] += named("damped-cycle").parameters["c"] * draft.outputs["x_dot"]


def half_turn(draft: Draft) -> None:
    """Show the designers' slip time pi/w."""
    t_slip = draft.outputs["t_slip"]
    draft.outputs["t_slip"] = np.where(t_slip > 0.0, math.pi / math.sqrt(1000.0), 0.0)


FAULTS: list[tuple[str, Fault, str]] = [
    ("default", creep, "stick-holds-x stick-holds-x-to-the-bit extension-is-the-gap-of-the-ends"),
    ("default", bit_of_x, "stick-holds-x-to-the-bit"),
    ("default", speed_in_stick, "stick-has-no-speed"),
    (
        "default",
        scaled("F_friction", -1.0),
        "stick-friction-balances slip-friction slip-friction-against-motion",
    ),
    ("damped-cycle", no_viscous_part, "slip-friction"),
    ("default", dated_at_step_ends, "onset-at-break-away restick-at-rest phases-join"),
    ("default", lagging("n_slips"), "restick-at-rest"),
    ("default", lagging("F"), "force-is-k-z"),
    ("default", scaled("F", 1.0 + 1e-13), "force-is-k-z"),
    ("load-pulses", constant("F_s", 0.5 * 9.81), "break-away-force-is-mu_s-N"),
    ("tuned", scaled("W_k", 0.0), "energy-balance"),
    ("damped-cycle", scaled("Q_friction", 1.01), "energy-balance"),
    ("default", scaled("Q_friction", 1.01), "energy-balance heat-of-dry-friction"),
    ("default", scaled("W_pull", 1.01), "energy-balance work-of-the-pull"),
    ("default", heat_given_back, "heat-never-falls heat-of-dry-friction"),
    ("reversals", lagging("T"), "period-is-stick-and-slip jump-is-v-T frequency-is-1-over-T"),
    ("default", period_of_before, "period-is-stick-and-slip jump-is-v-T"),
    ("default", half_turn, "period-is-stick-and-slip"),
    ("default", scaled("f", 2.0 * math.pi), "frequency-is-1-over-T"),
    ("default", copied("delta_x", "spring_drop"), "jump-is-v-T"),
    ("reversed-pull", unsigned("delta_x"), "jump-is-v-T"),
    ("default", contradiction, "mode-and-sticking-agree"),
    ("clamp", scaled("mu_k_used", 0.6 / 0.49), "mu_k-clamped start-values"),
    ("default", at_start("F_s", 5.0), "start-values"),
    ("default", at_start("t_stick", 1e-9), "start-values"),
    ("default", value("F", math.nan, 7), "finite force-is-k-z"),
    ("default", value("t_slip", math.inf, 403), "finite period-is-stick-and-slip"),
    ("default", value("x_dot_peak", math.nan, 400), "finite"),
    ("default", without("f"), "columns frequency-is-1-over-T"),
]


@pytest.mark.parametrize(
    ("name", "fault", "invariants"),
    FAULTS,
    ids=[f"{n}-{invariants}" for n, _, invariants in FAULTS],
)
def test_a_fault_breaks_the_invariants_it_is_about_and_no_other(
    name: str, fault: Fault, invariants: str
) -> None:
    """The invariants that fail, and those that hold, tell what is wrong with the samples."""
    assert seen(name, planted(exact_of(name).record, fault)) == set(invariants.split())


def test_what_is_no_number_at_the_start_is_seen() -> None:
    """NaN after initialization, in whatever output, breaks the invariant on start values."""
    exact = exact_of("crumbs").record
    blind = [
        name
        for name in OUTPUT_NAMES
        if not seen("crumbs", planted(exact, at_start(name, math.nan)))
    ]
    assert blind == []


@pytest.mark.parametrize("name", ["T", "z", "mode", "t_event"])
def test_a_lost_sample_is_a_failure_and_no_crash(name: str) -> None:
    """A column that is one sample short fails the invariants that need it, with a reason."""

    def fault(draft: Draft) -> None:
        draft.outputs[name] = draft.outputs[name][:-1]

    results = judged("default", planted(exact_of("default").record, fault))
    assert {"columns", "finite"} <= {invariant for invariant, r in results.items() if not r.passed}
    assert all(r.passed or r.failure or r.error for r in results.values())


MOTION = "slip-propagates slip-propagates-velocity work-of-the-pull restick-at-rest phases-join"
"""What an equation of slip with another constant in it always breaks."""

WORLDS: list[tuple[str, tuple[str, float], str, str]] = [
    (
        "default",
        ("mu_s", 0.5005),
        "onset-at-break-away break-away-force-is-mu_s-N",
        f"{MOTION} slip-friction energy-balance heat-of-dry-friction force-is-k-z stick-holds-x",
    ),
    (
        "default",
        ("mu_s", 0.55),
        "onset-at-break-away break-away-force-is-mu_s-N stick-within-break-away",
        f"{MOTION} slip-friction energy-balance heat-of-dry-friction stick-friction-balances",
    ),
    (
        "reversed-pull",
        ("mu_s", 0.5025),
        "onset-at-break-away break-away-force-is-mu_s-N",
        f"{MOTION} slip-friction energy-balance period-is-stick-and-slip jump-is-v-T",
    ),
    (
        "default",
        ("mu_k", 0.3003),
        f"{MOTION} slip-friction heat-of-dry-friction mu_k-clamped",
        "onset-at-break-away energy-balance force-is-k-z stick-friction-balances jump-is-v-T",
    ),
    (
        "default",
        ("c", 1e-6),
        f"{MOTION} slip-friction heat-of-dry-friction",
        "onset-at-break-away energy-balance force-is-k-z mu_k-clamped start-values",
    ),
    (
        "default",
        ("k", 1001.0),
        f"{MOTION} force-is-k-z onset-at-break-away energy-balance",
        "slip-friction break-away-force-is-mu_s-N heat-of-dry-friction pull-moves-at-v",
    ),
    (
        "default",
        ("g", 9.80665),
        f"{MOTION} break-away-force-is-mu_s-N onset-at-break-away slip-friction",
        "force-is-k-z energy-balance pull-moves-at-v stick-friction-balances mu_k-clamped",
    ),
    (
        "default",
        ("v", 0.02002),
        f"{MOTION} pull-moves-at-v jump-is-v-T",
        "slip-friction force-is-k-z energy-balance heat-of-dry-friction start-values",
    ),
    (
        "default",
        ("F_ext", 0.01),
        f"{MOTION} onset-at-break-away stick-friction-balances energy-balance",
        "slip-friction force-is-k-z pull-moves-at-v heat-of-dry-friction mode-and-sticking-agree",
    ),
]


@pytest.mark.parametrize(
    ("name", "other", "broken", "kept"), WORLDS, ids=[f"{n}={x}" for _, (n, x), _, _ in WORLDS]
)
def test_the_motion_of_another_world_breaks_the_invariants_that_tell_it(
    name: str, other: tuple[str, float], broken: str, kept: str
) -> None:
    """A motion that is right but for a constant breaks the invariants with it in, and no others."""
    found = seen(name, believed(name, other))
    assert set(broken.split()) <= found
    assert not set(kept.split()) & found


def test_a_spring_that_jumps_at_the_stop_is_seen() -> None:
    """Where the spring at rest is not that of the slip's end, the phases do not join."""

    def fault(draft: Draft) -> None:
        late = 1e-10 * ((draft.outputs["mode"] == 0.0) & (draft.outputs["n_slips"] > 0.0))
        for name in ("z", "x_pull"):
            draft.outputs[name] += late

    found = seen("default", planted(exact_of("default").record, fault))
    assert {"phases-join", "pull-moves-at-v", "energy-balance"} <= found
    assert not {"slip-propagates", "stick-holds-x", "extension-is-the-gap-of-the-ends"} & found


def test_a_direction_without_its_sign_is_seen() -> None:
    """A slip backward that is called forward goes against mode, and broke away against force."""
    found = seen("reversed-pull", planted(exact_of("reversed-pull").record, unsigned("mode")))
    assert {"slip-follows-mode", "onset-follows-the-force", "slip-friction"} <= found
    assert not {"stick-holds-x", "force-is-k-z", "mode-and-sticking-agree"} & found


def test_letting_go_below_break_away_is_seen() -> None:
    """A mass that a change lets go although friction could hold breaks one invariant of events."""
    case = named("load-pulses")
    steps = tuple(
        replace(step, changes={**step.changes, "load": 0.5 * step.changes["load"] - 4.0})
        if "load" in step.changes
        else step
        for step in case.steps
    )
    light = exact_motion(replace(case, steps=steps)).record
    found = seen("load-pulses", light)
    assert "onset-beyond-break-away" in found
    assert not {"force-is-k-z", "pull-moves-at-v", "mode-and-sticking-agree"} & found


def sinusoid(turns: float, depth: float, phase: float) -> tuple[Case, Run]:
    """Return an undamped slip in two steps of so many turns whose speed goes `depth` below zero.

    depth in parts of v. The friction keeps its direction, as it would if nobody looked.
    """
    v, w, level = 0.02, math.sqrt(1000.0), 0.3 * 9.81 / 1000.0
    h = turns * 2.0 * math.pi / w
    swing = v * (1.0 + depth)

    def moved(t: float) -> dict[str, float]:
        angle = w * t + phase
        z = level - swing / w * math.sin(angle)
        x_dot = v + swing * math.cos(angle)
        gone = v * t - z
        return {"x_dot": x_dot, "z": z, "x": gone, "x_pull": v * t, "mode": 1.0, "sticking": 0.0}

    begin = moved(0.0)
    start = {"x_dot_start": begin["x_dot"], "z_start": begin["z"], "x_start": begin["x"]}
    case = Case("passes", "", "", start, (CommunicationStep(h, {}),) * 2, (), Path("passes.toml"))
    rows = [begin, *map(moved, case.times)]
    meter = {"t_event": 0.0, "n_slips": 0.0}
    columns = {name: np.array([{**row, **meter}[name] for row in rows]) for name in begin | meter}
    record = Run(
        np.array(case.times),
        {name: samples[1:] for name, samples in columns.items()},
        {name: float(samples[0]) for name, samples in columns.items()},
    )
    return case, record


def passed_unseen(turns: float, depth: float, phase: float = 0.4) -> float:
    """Return how far below zero the invariant sees the velocity go, in parts of how far it goes."""
    case, record = sinusoid(turns, depth, phase)
    residual = METRICS["slip.never_past_rest"](Course(case, record, record, np.array([])))
    return float(np.max(residual.values) / (0.02 * depth))


@pytest.mark.parametrize("turns", [0.9, 1.0, 2.5, 4.0])
@pytest.mark.parametrize("depth", [1e-3, 1e-9])
def test_a_slip_that_passes_zero_inside_a_step_is_seen(turns: float, depth: float) -> None:
    """However shallow the velocity dips between two samples, the dip is found, and its depth."""
    # The samples are rounded to 2e-16 of the swing, which the depth is a small part of.
    assert passed_unseen(turns, depth) == pytest.approx(1.0, abs=1e-15 / depth)


@pytest.mark.parametrize("turns", [7.7, 8.0, 16.0])
def test_a_stop_is_found_in_a_step_of_many_turns(turns: float) -> None:
    """A step as long as a whole number of turns hides no stop either."""
    found = [passed_unseen(turns, 1e-3, phase) for phase in (0.4, 1.2, 2.0, 2.8, 3.6, 4.4, 5.2)]
    assert found == pytest.approx([1.0] * len(found), abs=1e-9)


def test_a_dip_that_does_not_reach_zero_is_no_stop() -> None:
    """The invariant takes nothing for a stop but a velocity below zero."""
    assert passed_unseen(1.0, -1e-9) == 0.0


@pytest.mark.parametrize("name", ["default", "reversals", "tuned", "one-step", "crumbs"])
@pytest.mark.parametrize("lacking", ["t_event", "n_slips", "t_event n_slips"])
def test_what_is_not_reported_is_taken_from_the_exact_motion(name: str, lacking: str) -> None:
    """Steps without a transition are the same by own reports, by one of them, or by the truth.

    The truth alone also leaves out a step that begins with a transition.
    """
    exact = exact_of(name)
    poor = planted(exact.record, without(*lacking.split()))
    events = np.array(exact.event_times)
    own, told = (Course(named(name), r, exact.record, events) for r in (exact.record, poor))
    fewer = own.eventless != told.eventless
    assert not np.any(fewer & told.eventless)
    assert set(own.begins[fewer]) <= set(events)
    assert seen(name, poor, PHYSICS_CONTRACT) <= {"columns"}


def test_a_side_is_judged_by_its_own_reports() -> None:
    """A mass that breaks away at another time still keeps the invariants of stick and slip."""
    exact, other = exact_of("default"), believed("default", ("mu_s", 0.55))
    events = np.array(exact.event_times)
    ours, theirs = (
        Course(named("default"), r, exact.record, events) for r in (exact.record, other)
    )
    assert not np.array_equal(ours.stick, theirs.stick)
    invariants = {"stick-holds-x", "stick-has-no-speed", "slip-propagates", "slip-follows-mode"}
    assert not invariants & seen("default", other)


@pytest.mark.parametrize("name", ["reversals", "damped-cycle"])
def test_without_mode_its_direction_is_that_of_the_velocity(name: str) -> None:
    """A side that tells only whether it sticks is held to the same invariants of slip."""
    poor = planted(exact_of(name).record, without("mode"))
    results = judged(name, poor, PHYSICS_CONTRACT)
    lacking = {invariant for invariant, r in results.items() if r.not_applicable}
    assert lacking == {"mode-and-sticking-agree"}
    assert results["slip-propagates"].passed
    assert results["slip-friction"].passed


def test_what_a_foreign_side_lacks_makes_an_invariant_not_applicable() -> None:
    """A missing output fails ours, and takes a foreign side out of the invariants that need it."""
    poor = planted(exact_of("default").record, without("n_slips"))
    ours, foreign = (
        judged("default", poor, contract)["restick-at-rest"]
        for contract in (EXACT_CONTRACT, PHYSICS_CONTRACT)
    )
    assert (ours.verdict, ours.failure) == ("fail", "no output n_slips")
    assert (foreign.verdict, foreign.not_applicable) == (
        "not applicable",
        "it has no output n_slips",
    )


def test_a_run_without_the_place_of_an_invariant_fails_it() -> None:
    """Who never slips cannot keep the invariants of slip by that, where the exact motion slips."""

    def stuck(draft: Draft) -> None:
        draft.outputs["mode"] *= 0.0

    result = judged("default", planted(exact_of("default").record, stuck))["slip-propagates"]
    assert not result.passed
    assert result.failure == "the run has no such place; the exact motion has"


def test_a_result_shows_the_worst_place_in_its_unit() -> None:
    """Got is the largest residual of the invariant; the error is that over its scale."""
    fault = value("x_pull", 0.25, 700)
    result = judged("default", planted(exact_of("default").record, fault))["pull-moves-at-v"]
    case, exact = named("default"), exact_of("default")
    left = 0.25 - float(exact.record.outputs["x_pull"][700])
    assert result.unit == "m"
    assert result.expected == 0.0
    # Both neighbours are off by as much, but for rounding of the largest length.
    assert abs(result.got or 0.0) == pytest.approx(abs(left), abs=1e-15)
    assert result.error == pytest.approx(abs(left) / 0.2, rel=1e-13)
    assert result.tolerance == INVARIANTS["pull-moves-at-v"].tolerance["fmu"]
    again = judge_residual(
        INVARIANTS["pull-moves-at-v"], case, PHYSICS_CONTRACT, exact, exact.record
    )
    assert again.tolerance == INVARIANTS["pull-moves-at-v"].tolerance["reference"]
