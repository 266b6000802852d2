"""Facts of static friction that grows at rest: docs/theory.md (19) to (25)."""

from __future__ import annotations

from collections.abc import Mapping

from tests.facts.closed import MP, Exact, Real, Slip, slip
from tests.facts.fact import Expected, Fact
from tests.facts.sides import EXACT

BINARY = {"g": 8.0, "k": 1024.0, "mu_k": 0.25, "v": 2.0**-6}
"""N = 8 N, F_s = 4 N, mu_k N = 2 N, load-up of 16 N/s."""

GROWTHS: dict[str, dict[str, float]] = {
    "exponential": {"tau_s": 0.1},
    "quick": {"tau_s": 1e-4},
    "quicker than any number": {"tau_s": 1e-320, "B": 0.02, "t_0": 1e-3},
    "logarithmic": {"B": 0.02, "t_0": 1e-3},
    "logarithmic, without a gap": {"mu_s": 0.3, "B": 0.05, "t_0": 0.01},
    "both, slowly": {"tau_s": 0.05, "B": 0.01, "t_0": 0.2, "v": 0.005},
    "under a load, backward": {"tau_s": 0.5, "load": 7.0, "v": -0.005},
    "damped": {"tau_s": 0.05, "c": 3.0},
}


def _magnified(p: Exact, age: Real) -> float:
    pull = p.k * abs(p.v)
    return float(pull / (pull - p.growing(age)))


def _cycles(p: Exact, count: int) -> list[tuple[Real, Real, Slip]]:
    ahead, begin, cycles = p.but(v=abs(float(p.v))), MP.zero, []
    for _ in range(count):
        stick = p.stick(begin)
        hold = p.F_k + p.growth(stick)
        done = slip(ahead, hold / p.k)
        cycles.append((stick, hold, done))
        begin = p.k * done.z
    return cycles


def _later(p: Exact) -> dict[str, Real]:
    _, (_, hold, done), (stick, *_) = _cycles(p, 3)
    sign = MP.sign(p.v)
    return {
        "t_slip": done.t,
        "delta_x": sign * done.x,
        "spring_drop": sign * (hold / p.k - done.z),
        "x_dot_peak": sign * done.peak,
        "t_stick": stick,
        "T": done.t + stick,
        "n_slips": 2,
        "F_s": p.F_k + p.growth(0),
        "mode": int(sign),
    }


def _cycle(name: str) -> Fact:
    values = GROWTHS[name]
    p = Exact(values)
    one, two, (third, _, last) = _cycles(p, 3)
    until = one[0] + one[2].t + two[0] + two[2].t + third + last.t / 2
    return Fact(
        f"a stick ends where the pull meets what has grown, and the slip begins there: {name}",
        values,
        [float(until)],
        _later,
        factor=4.0 * _magnified(p, p.stick(0)),
        integrated=10.0,
        why="where friction grows nearly as fast as the pull a stick is long; the gap: theory (17)",
    )


def _after_stick(p: Exact, length: float) -> dict[str, Real]:
    sign = MP.sign(p.v)
    ahead = p.but(v=abs(float(p.v)), F_ext=float(sign * p.F_ext))
    stick = p.stick(sign * (p.k * p.z_start + p.F_ext), p.age_start)
    z = (p.F_k + p.growth(p.age_start + stick) - ahead.F_ext) / p.k
    young = slip(ahead, z, until=length - stick)
    return {
        **dict.fromkeys(("t_stick", "t_event"), stick),
        "x": sign * young.x,
        "x_dot": sign * young.x_dot,
        "mode": int(sign),
    }


def _first(name: str, cuts: int, **values: float) -> Fact:
    p = Exact(values)
    sign = MP.sign(p.v)
    stick = p.stick(sign * (p.k * p.z_start + p.F_ext), p.age_start)
    length = (float(stick) + 0.02) / cuts
    magnified = 10.0 * _magnified(p, p.age_start + stick)
    return Fact(
        f"the first stick: {name}",
        values,
        [length] * cuts,
        lambda p: _after_stick(p, sum([MP.mpf(length)] * cuts)),
        factor={
            **dict.fromkeys(("t_stick", "t_event"), magnified),
            **dict.fromkeys(("x", "x_dot"), 100.0 * magnified),
        },
        why="where friction grows nearly as fast as the pull; the slip is young",
    )


def _held(values: Mapping[str, float], *ages: tuple[float, Mapping[str, float]]) -> list[Expected]:
    rows: list[Expected] = []
    p = Exact(values)
    for age, changes in ages:
        p = p.but(**changes)
        rows.append({"F_s": p.F_k + p.growth(MP.mpf(age)), "mode": 0})
    return rows


TUNED: list[tuple[float, dict[str, float]]] = [
    (0.0625, {}),
    (0.125, {"tau_s": 0.6}),
    (0.1875, {"B": 0.02}),
    (0.25, {"t_0": 0.01}),
    (0.3125, {"mu_s": 0.6}),
    (0.375, {"v": -0.005}),
    (0.4375, {"F_ext": 0.5}),
    (0.5, {"tau_s": 0.0}),
]


def _changed_in_slip(p: Exact) -> dict[str, Real]:
    ((_, _, done),) = _cycles(p, 1)
    new = p.but(tau_s=0.02, B=0.05, t_0=0.01)
    return {"t_slip": done.t, "t_stick": new.stick(p.k * done.z), "n_slips": 1, "mode": 1}


def _reversed(p: Exact) -> dict[str, Real]:
    ((stick, _, forth),) = _cycles(p, 1)
    back = slip(p, forth.z, direction=-1)
    return {
        "n_slips": 2,
        "mode": 1,
        "t_stick": stick,
        "T": 0,
        "t_slip": back.t,
        "spring_drop": forth.z - back.z,
        "delta_x": back.x,
    }


FACTS = (
    *(_cycle(name) for name in GROWTHS),
    _first("old", 1, tau_s=0.1, age_start=0.3),
    _first("of both kinds, cut into steps", 8, tau_s=0.1, B=0.02, t_0=0.05),
    _first("against a push, backward", 1, tau_s=0.2, F_ext=1.0, v=-0.02, B=0.01, t_0=1e-4),
    _first("from a loaded spring", 1, B=0.03, t_0=1e2, z_start=0.002, tau_s=0.01),
    _first("older than the growth", 1, tau_s=0.0625, age_start=64.0),
    _first(
        "so old that it holds what a fresh one does not", 1, tau_s=0.1, z_start=0.004, age_start=1e3
    ),
    Fact(
        "F_s is that of the age, and what is tuned acts on the whole of its growth",
        {"tau_s": 0.3, "v": 0.005},
        [(0.0625, changes) for _, changes in TUNED],
        lambda p: _held({"tau_s": 0.3}, *TUNED),
        factor=10.0,
    ),
    Fact(
        "a stick that never ends grows by the logarithm for ever",
        {"tau_s": 1.0, "B": 0.1, "v": 0.0, "z_start": 0.002},
        [1e9],
        lambda p: {"mode": 0, "n_slips": 0, "F_s": p.F_k + p.growth(MP.mpf(1e9))},
    ),
    Fact(
        "growth that changes in a slip acts from the stop on",
        {"tau_s": 0.1},
        [0.25, (0.4, {"tau_s": 0.02, "B": 0.05, "t_0": 0.01})],
        _changed_in_slip,
        factor=10.0,
        integrated=10.0,
        why="the gap: theory (17)",
    ),
    Fact(
        "at the start the age holds until the first step, whatever is set",
        {"tau_s": 0.1, "z_start": 0.6 * 9.81 / 1000.0, "age_start": 1e3, "v": 0.0},
        [(0.1, {"load": 3.0})],
        lambda p: {"mode": 0, "F_s": p.mu_s * (p.N + 3), "n_slips": 0},
    ),
    Fact(
        "a start at what a fresh stop holds sticks where friction grows faster than the load",
        {**BINARY, "tau_s": 2.0**-6, "z_start": 2.0 / 1024.0},
        [0.2],
        lambda p: {"t_stick": p.stick(p.F_k), "mode": 1},
        factor=10.0,
    ),
    Fact(
        "a start at what a fresh stop holds goes where the load grows faster than friction",
        {**BINARY, "tau_s": 0.25, "z_start": 2.0 / 1024.0},
        [0.125],
        lambda p: {"t_stick": 0, "t_event": 0},
    ),
    Fact(
        "a fresh stop beyond what it holds turns round",
        {"mu_k": 0.08, "tau_s": 0.1},
        [0.43],
        _reversed,
        factor=30.0,
        integrated=10.0,
        why="the way back is a third of the way; the gap: theory (17)",
    ),
    Fact(
        "a mass that moves at the start stops fresh, whatever age is given",
        {"x_dot_start": 0.01, "tau_s": 0.0625, "age_start": 64.0, "v": 0.0},
        [1.0],
        lambda p: {"mode": 0, "F_s": p.F_k + p.growth(1 - slip(p, 0, p.x_dot_start).t)},
        factor=10.0,
    ),
    Fact(
        "growth begins at the clamped coefficient",
        {"mu_s": 0.3, "mu_k": 0.5, "tau_s": 0.1, "v": 0.0},
        [0.1],
        lambda p: _held({"mu_s": 0.3, "mu_k": 0.3 - 0.01, "tau_s": 0.1}, (0.1, {})),
        factor=10.0,
        why="the gap is a thirtieth",
    ),
    *(
        Fact(
            f"without growth the stick is that of constant coefficients: {values}",
            values,
            [0.5 if "v" in values else 0.3],
            lambda p: {"t_stick": p.F_s / p.k / p.v, "F_s": p.F_s},
        )
        for values in ({"t_0": 1e-3, "age_start": 1e9, "v": 0.01}, {"tau_s": 0.1, "mu_k": 0.5})
    ),
    *(
        Fact(
            f"no value is too small or too large: {values}",
            values,
            [1e-3, 0.1],
            lambda p: {"mode": 0, "n_slips": 0, "z": p.v * (MP.mpf(1e-3) + 0.1)},
            why="beyond an integration",
            sides=EXACT,
        )
        for values in (
            {"tau_s": 5e-324, "B": 0.01, "t_0": 2.3e-308, "age_start": 1.7e308, "v": 1e-300},
            {"tau_s": 1.7e308, "B": 0.01, "t_0": 1.7e308, "age_start": 1.7e308, "v": 0.02},
            {"tau_s": 1e-310, "B": 0.01, "t_0": 1e200, "age_start": 5e-324, "v": 0.01},
        )
    ),
)
