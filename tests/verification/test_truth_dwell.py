"""Static friction that grows at rest, in the truth: docs/theory.md (19) to (24).

The time to break-away has a closed form for either growth alone, in Lambert's W.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest

from stickslip_verification import truth
from stickslip_verification.truth import Step
from stickslip_verification.truth.parameters import high_precision

MP = high_precision(50)

BINARY = {"g": 8.0, "k": 1024.0, "mu_k": 0.25, "v": 2.0**-6}
"""Binary fractions: N = 8 N, F_s = 4 N, mu_k N = 2 N, load-up of 16 N/s."""

F_S, F_K, RATE = MP.mpf(4), MP.mpf(2), MP.mpf(16)


def exponential(tau_s: float, start: Any = 0) -> Any:
    """Return when ``RATE t + start`` N meets ``F_s - (F_s - F_k) exp(-t/tau_s)`` last [s]."""
    tau, a = MP.mpf(tau_s), (F_S - start) / RATE
    b = (F_S - F_K) / RATE
    return a + tau * MP.re(MP.lambertw(-b / tau * MP.exp(-a / tau)))


def logarithmic(B: float, t_0: float) -> Any:
    """Return when ``RATE t`` meets ``F_s + B N ln(1 + t/t_0)`` [s]."""
    growth = MP.mpf(B) * 8
    kappa = RATE * MP.mpf(t_0) / growth
    y = -MP.re(MP.lambertw(-kappa * MP.exp(-F_S / growth - kappa), -1)) / kappa
    return MP.mpf(t_0) * (y - 1)


def first(values: Mapping[str, float], h: float = 1.0, n: int = 1) -> Any:
    """Return the first event of a run of n steps."""
    return truth.run({**BINARY, **values}, [Step(h)] * n).events[0]


@pytest.mark.parametrize("n", [1, 7])
@pytest.mark.parametrize("tau_s", [2.0**-12, 2.0**-4, 4.0])
def test_an_exponential_growth_breaks_away_where_lambert_says(tau_s: float, n: int) -> None:
    """45 digits, however many steps cut the stick; the extension is that of F_s at this age."""
    event, t = first({"tau_s": tau_s}, 0.5, n), exponential(tau_s)
    assert event.kind == "break-away"
    assert abs(event.time / t - 1) < 1e-45
    assert abs(event.z * 1024 / (F_S - (F_S - F_K) * MP.exp(-t / MP.mpf(tau_s))) - 1) < 1e-45


@pytest.mark.parametrize(("B", "t_0"), [(2.0**-6, 2.0**-10), (0.25, 1.0), (2.0**-9, 2.0**-30)])
def test_a_logarithmic_growth_breaks_away_where_lambert_says(B: float, t_0: float) -> None:
    """45 digits, over a decade of growth or many."""
    event, t = first({"B": B, "t_0": t_0}, 0.5, 3), logarithmic(B, t_0)
    assert abs(event.time / t - 1) < 1e-45
    assert abs(event.z - t * MP.mpf(2) ** -6) < 1e-45


def test_a_growth_that_is_over_at_once_is_no_growth() -> None:
    """tau_s = 0 and B = 0 give the motion of constant coefficients, bit for bit."""
    steps = [Step(0.1), Step(0.3, {"F_ext": 0.5}), Step(1.0, {"v": -0.02})]
    plain = truth.run(BINARY, steps)
    for own in ({"tau_s": 0.0, "t_0": 3.0}, {"age_start": 5.0}):
        assert truth.run({**BINARY, **own}, steps).samples == plain.samples
    no_gap = truth.run({**BINARY, "mu_s": 0.25, "tau_s": 1.0}, steps)
    assert no_gap.samples == truth.run({**BINARY, "mu_s": 0.25}, steps).samples


def test_the_age_of_the_first_stick_enters_it_alone() -> None:
    """An old first stick holds F_s at once; t_stick does not contain its age; the next is fresh."""
    values = {**BINARY, "tau_s": 0.0625, "age_start": 64.0}
    run = truth.run(values, [Step(0.25), Step(2.0)])
    assert abs(run.initial["F_s"] - F_S) < 1e-45
    assert abs(run.events[0].time - 0.25) < 1e-45
    assert abs(run.events[0].z * 1024 - F_S) < 1e-45
    assert truth.run({**values, "age_start": 0.0}, [Step(2.0)]).initial["F_s"] == F_K
    stop = run.events[1]
    fresh = truth.run({**values, "age_start": 0.0, "z_start": 0.0}, [Step(2.0)])
    assert stop.kind == fresh.events[1].kind == "re-stick"
    wait = run.events[2].time - stop.time
    assert abs(wait - exponential(0.0625, stop.z * 1024)) < 1e-45
    assert run.samples[1]["t_stick"] != run.events[0].time
    # Moving at the start: its first stick is one after a stop.
    moving = {**values, "x_dot_start": 0.01}
    still = truth.run({**moving, "age_start": 0.0}, [Step(1.0)])
    assert truth.run(moving, [Step(1.0)]).samples == still.samples


def test_a_change_of_input_leaves_the_age() -> None:
    """A stick whose input changes for nothing, or there and back, ends when it would have ended."""
    tau_s = 0.25
    t = exponential(tau_s)
    for changes in ({"load": 1.0}, {"F_ext": -0.5}, {"mu_s": 0.75}, {"tau_s": 8.0}):
        back = {name: {"mu_s": 0.5, "tau_s": tau_s}.get(name, 0.0) for name in changes}
        steps = [Step(2.0**-5), Step(2.0**-6, changes), Step(1.0, back)]
        run = truth.run({**BINARY, "tau_s": tau_s}, steps)
        assert abs(run.events[0].time / t - 1) < 1e-45
        assert abs(run.samples[-1]["t_stick"]) > 0
    stopped = [Step(2.0**-5), Step(0.75, {"v": 0.0}), Step(1.0, {"v": 2.0**-6})]
    event = truth.run({**BINARY, "tau_s": tau_s}, stopped).events[0]
    held = F_S - (F_S - F_K) * MP.exp(-event.time / MP.mpf(tau_s))
    assert abs(RATE * (event.time - 0.75) / held - 1) < 1e-45


def test_a_rest_test_after_a_change_takes_the_present_age() -> None:
    """3 N hold at an age that has grown beyond them, and not before."""
    values = {**BINARY, "v": 0.0, "tau_s": 1.0, "z_start": 1.0 / 1024.0}
    # Of 4 - 2 exp(-t) N, 3 N are there after ln 2 = 0.693 s.
    for wait, kinds in ((0.69, ["break-away"]), (0.7, [])):
        run = truth.run(values, [Step(wait), Step(0.01, {"F_ext": 2.0})])
        assert [event.kind for event in run.events] == kinds
    # A fresh stop is tried at age 0: swinging out from 4 N it holds 2 N, at whatever age.
    swing = {**BINARY, "v": 0.0, "tau_s": 1.0, "z_start": 7.0 / 1024.0}
    run = truth.run(swing, [Step(4.0)])
    assert [event.kind for event in run.events] == ["break-away", "reversal", "re-stick"]
    assert [round(float(each.z) * 1024, 12) for each in run.events] == [7, -3, -1]


def test_a_force_that_is_met_at_the_start_holds_where_friction_grows_faster() -> None:
    """|A| = F_s(0) breaks away at the later root; where the load is faster, at once."""
    values = {**BINARY, "tau_s": 2.0**-6, "z_start": 2.0 / 1024.0}
    event, t = first(values), exponential(2.0**-6, 2)
    # Growth of 128 N/s against a load of 16 N/s.
    assert t > 0.1
    assert abs(event.time / t - 1) < 1e-45
    assert first({**values, "tau_s": 0.25}).time == 0
    both = truth.run({**values, "v": -(2.0**-6)}, [Step(2.0)])
    assert both.events[0].time > 0.25


def test_a_break_away_at_the_start_that_no_time_follows_leaves_the_first_stick_old() -> None:
    """Inputs set before the first step find the stick at its age, not at age 0."""
    values = {**BINARY, "tau_s": 1.0, "age_start": 1e3, "F_ext": 5.0}
    run = truth.run(values, [Step(2.0**-5, {"F_ext": 3.0})])
    assert run.initial["mode"] == 1
    assert run.events == ()
    assert abs(run.samples[0]["F_s"] - F_S) < 1e-45


def test_no_gap_at_age_0_is_exactly_none() -> None:
    """With mu_k that no double is, a fresh stop still has exactly mu_k N, and no rounding slips."""
    run = truth.run({"tau_s": 0.1, "mu_s": 0.7, "mu_k": 0.1, "v": 0.5}, [Step(0.01)] * 300)
    assert run.margin > 1e-6
    numbers = run.initial
    assert numbers["F_s"] == truth.run({"mu_s": 0.1, "mu_k": 0.1}, [Step(1.0)]).initial["F_s"]


def test_a_slip_from_grown_friction_is_the_mirror_image_of_its_start() -> None:
    """Without damping the next stick lasts until g has made up both: v t = g_before + g(t)."""
    tau_s = 0.0625
    run = truth.run({**BINARY, "tau_s": tau_s}, [Step(4.0)])
    sticks = [(run.events[0].time, run.events[0].time)]
    sticks += [
        (b.time - a.time, b.time) for a, b in zip(run.events[1::2], run.events[2::2], strict=False)
    ]
    grown = [(F_S - F_K) * (1 - MP.exp(-t / MP.mpf(tau_s))) for t, _ in sticks]
    for before, after, (t, _) in zip(grown, grown[1:], sticks[1:], strict=False):
        assert abs(RATE * t - before - after) < 1e-45


@pytest.mark.parametrize("quantity", ["t_stick", "T", "F_s"])
def test_growth_tends_to_constant_coefficients_with_its_rate(quantity: str) -> None:
    """Twice the exponent exp(-t_stick/tau_s) is twice the digits, with the factors of (24)."""
    steady = truth.steady_cycle(BINARY)
    assert steady is not None
    t, w, L = steady["t_stick"], MP.mpf(32), steady["lambda_"]
    for digits in (4, 8):
        tau_s = float(t / (digits * MP.log(10)))
        epsilon = MP.exp(-t / MP.mpf(tau_s))
        run = truth.run({**BINARY, "tau_s": tau_s}, [Step(8 * float(steady["T"]))])
        last, before, *_ = reversed([e for e in run.events if e.kind == "break-away"])
        stop = next(e for e in run.events if before.time < e.time < last.time)
        got, expected = {
            "t_stick": ((last.time - stop.time) / t - 1, -epsilon),
            "T": (last.time - before.time - steady["T"], -2 / w * L**3 / (1 + L**2) * epsilon),
            "F_s": (last.z * 1024 / F_S - 1, -epsilon * (F_S - F_K) / F_S),
        }[quantity]
        assert abs(got / expected - 1) < 50 * digits * epsilon


@pytest.mark.parametrize(
    ("own", "message"),
    [
        ({"tau_s": -1.0}, "tau_s = -1.0 is outside tau_s >= 0"),
        ({"B": -0.5}, "B = -0.5 is outside B >= 0"),
        ({"t_0": 0.0}, "t_0 = 0.0 is outside t_0 > 0"),
        ({"age_start": -1e-9}, "age_start = -1e-09 is outside age_start >= 0"),
        ({"tau_s": float("nan")}, "tau_s = nan is not a finite number"),
    ],
)
def test_a_value_out_of_range_is_refused(own: Mapping[str, float], message: str) -> None:
    """Name, value and range; t_0 may not be 0, for nothing is logarithmic from there."""
    with pytest.raises(ValueError, match=message):
        truth.run(own, [Step(1.0)])
    if "age_start" not in own:
        with pytest.raises(ValueError, match=message):
            truth.run({}, [Step(1.0), Step(1.0, own)])


def test_the_age_of_the_first_stick_does_not_change_in_a_run() -> None:
    """It is fixed, and the message names what may change."""
    with pytest.raises(ValueError, match=r"age_start cannot change in a run; .*'tau_s'"):
        truth.run({}, [Step(1.0), Step(1.0, {"age_start": 1.0})])
