"""Facts of constant friction coefficients."""

from __future__ import annotations

from collections.abc import Mapping

from tests.facts.closed import MP, Exact, Real, critical_lambda, cycle, slip
from tests.facts.fact import Fact
from tests.facts.sides import EXACT

BINARY = {"g": 8.0, "k": 1024.0, "mu_k": 0.25, "v": 0.5}
"""Binary fractions: N = 8 N, F_s = 4 N, w = 32 rad/s, load-up in 2^-7 s."""
LOOSE = {"mu_s": 0.0, "mu_k": 0.0}
STILL = {"mode": 0, "n_slips": 0, "x": 0, "x_dot": 0}
ULP = 2.0**-52


def _first(values: Mapping[str, float], cycles: float) -> float:
    p = Exact(values)
    steady = cycle(p)
    return float(
        (p.F_s - abs(p.F_ext)) / p.k / abs(p.v) + cycles * steady["T"] + steady["t_slip"] / 2
    )


def of_lambda(lambda_: float, **values: float) -> dict[str, float]:
    p = Exact({**values, "v": 1.0})
    return {**values, "v": float(p.lambda_) / lambda_}


def _cycle(statement: str, values: Mapping[str, float], edge: float = 1.0) -> Fact:
    """Return the cycle of a setting as a fact; `edge` is what a shallow stop amplifies."""
    p = Exact(values)
    L, gap = float(p.lambda_), float(p.mu_s / (p.mu_s - p.mu_k))
    return Fact(
        f"the steady cycle is the closed form: {statement}",
        values,
        [_first(values, 2)],
        lambda p: {**cycle(p), "n_slips": 2},
        factor=edge,
        integrated={
            **dict.fromkeys(("T", "f", "delta_x", "x_dot_peak"), gap),
            "t_slip": gap * (1.0 + 1.0 / L),
            **dict.fromkeys(("t_stick", "spring_drop"), gap * (1.0 + 1.0 / L**2)),
        },
        why="theory (17): the gap, a shallow stop, and beside lambda_c 1/sqrt(d)",
        sides=EXACT if L < 1e-3 or gap > 1e4 else Fact.sides,
    )


def damped(zeta: float, d: float, **values: float) -> dict[str, float]:
    base = {**BINARY, "c": 64.0 * zeta, **values}
    p = Exact(base)
    return of_lambda(float(critical_lambda(p.zeta) * (1 + d)), **base)


def _at_second_cycle(zeta: float, d: float) -> Fact:
    return _cycle(f"zeta {zeta:g}, lambda_c (1 + {d:g})", damped(zeta, d), 1.0 + d**-0.5)


CYCLES = [
    _cycle("default", {}),
    _cycle("backward", {"v": -0.02}),
    _cycle("load and push", {"load": 1.7, "F_ext": 0.3, "v": 0.005}),
    *(
        _cycle(f"lambda = {L:g}", of_lambda(L))
        for L in (1e-7, 1e-3, 1e-2, 0.1, 1.0, 10.0, 1e3, 1e6)
    ),
    _cycle("a gap of 1e-6 of mu_s", of_lambda(0.3, mu_k=0.5 * (1.0 - 1e-6))),
    *(_cycle(f"no kinetic friction, {L:g}", of_lambda(L, mu_k=0.0)) for L in (1e-3, 0.3, 30.0)),
    *(_at_second_cycle(zeta, 10.0) for zeta in (1e-3, 0.1, 0.5, 0.9)),
    *(_at_second_cycle(zeta, 1e-6) for zeta in (1e-3, 0.1, 0.9)),
    *(
        Fact(
            f"a slip does not end where lambda < lambda_c: zeta {zeta:g}, {d:g}",
            damped(zeta, d),
            [float(_first(damped(zeta, 1e-3), 0.0)) + 4.0],
            lambda p: {"n_slips": 0, "mode": 1, "t_slip": 0},
        )
        for zeta, d in ((1e-3, -1e-9), (0.1, -1e-9), (0.9, -1e-9), (0.1, -0.5))
    ),
]


def _then(p: Exact, z: Real, x_dot: Real = 0, direction: int = 1, **more: Real) -> dict[str, Real]:
    done = slip(p, z, x_dot, direction)
    return {
        "t_slip": done.t,
        "delta_x": done.x,
        "spring_drop": z - done.z,
        "x_dot_peak": done.peak,
        **more,
    }


def _from_beyond(p: Exact) -> list[dict[str, Real]]:
    first = slip(p, p.z_start)
    stick = (p.F_s / p.k - first.z) / p.v
    return [
        {"mode": 1, "t_stick": 0, "T": 0, "n_slips": 0, "t_event": 3},
        {"n_slips": 1, "t_stick": stick, "T": first.t + stick, "t_slip": first.t},
    ]


def _from_motion(p: Exact) -> list[dict[str, Real]]:
    first = slip(p, p.z_start, p.x_dot_start, -1)
    slipped = _then(p, p.z_start, p.x_dot_start, -1)
    return [
        {**slipped, "n_slips": 1, "mode": 0, "T": 0, "t_stick": 0},
        {"t_stick": (p.F_s / p.k - first.z) / p.v, "mode": 1, "T": 0},
    ]


def _shot(c: float, **values: float) -> Fact:
    values = {"c": c, "v": 1e-9, "x_dot_start": 1.0, "z_start": -0.02, **LOOSE, **values}
    return Fact(
        f"a mass shot against its spring turns however it is damped: c = {c:g}",
        values,
        [1e-4],
        lambda p: {"n_slips": 1, "t_slip": _then(p, p.z_start, 1)["t_slip"]},
        factor=1e3,
        why="the time is a logarithm of what the speeds leave of 1e-9; beyond an integration",
        sides=EXACT,
    )


def _young(zeta: float, angle: float, x_dot: float) -> Fact:
    def until(p: Exact) -> dict[str, Real]:
        now = slip(p, p.z_start, p.x_dot_start, until=MP.mpf(angle / 32.0))
        return {"x": now.x, "x_dot": now.x_dot, "z": now.z, "mode": 1}

    return Fact(
        f"a slip has all its digits from its beginning: {x_dot} m/s, {zeta}, w t = {angle:g}",
        {**BINARY, "c": 64.0 * zeta, "v": 0.0, "z_start": 8.0 / 1024.0, "x_dot_start": x_dot},
        [angle / 32.0],
        until,
        factor=30.0,
        why="closed forms take over from power series; not promised by an integration",
        sides=EXACT,
    )


def _rest(beyond: float, mode: int, F_ext: float = 0.0, sign: float = 1.0) -> Fact:
    force = 4.0 - F_ext + beyond * ULP * (4.0 + abs(F_ext) + abs(4.0 - F_ext))
    values = {**BINARY, "v": 0.0, "z_start": sign * force / 1024.0, "F_ext": sign * F_ext}
    return Fact(
        f"the rest test forgives 8 ulp of the forces: {sign * beyond:g} ulp, push {F_ext:g} N",
        values,
        [1e-6],
        lambda p: {"mode": mode},
    )


STICKS = [
    Fact(
        "a relaxed spring loads up until it holds what the push leaves of F_s",
        {"load": 3.0, "F_ext": 0.5},
        [0.4],
        lambda p: {
            **dict.fromkeys(("t_stick", "t_event"), (p.F_s - p.F_ext) / p.k / p.v),
            "mode": 1,
            "n_slips": 0,
            "T": 0,
            "f": 0,
        },
    ),
    Fact(
        "equality sticks: the slip begins after the time of break-away",
        BINARY,
        [2.0**-7, 2.0**-40],
        lambda p: [
            {"mode": 0, "sticking": 1, "F": 4, "F_s": 4, "F_friction": -4, "t_stick": 0},
            {"mode": 1, "sticking": 0, "t_stick": p.F_s / p.k / p.v},
        ],
    ),
    *(_rest(beyond, int(beyond > 8)) for beyond in (0, 4, 16)),
    *(_rest(beyond, -int(beyond > 8), sign=-1.0) for beyond in (4, 16)),
    *(_rest(beyond, int(beyond > 8), F_ext=-1e3) for beyond in (4, 16)),
    Fact(
        "a pull that stops in stick leaves the mass",
        {},
        [0.2, (5.0, {"v": 0.0})],
        lambda p: {**STILL, "z": p.v * 0.2, "F_friction": -p.k * p.v * 0.2},
        factor=10.0,
    ),
    Fact(
        "less load at a force beyond the new F_s breaks away at once",
        {"load": 10.0},
        [0.2, (0.005, {"load": -5.0})],
        lambda p: {
            "mode": 1,
            "t_event": MP.mpf(0.2),
            "t_stick": MP.mpf(0.2),
            "F_s": p.mu_s * (p.N - 15),
        },
        factor=10.0,
    ),
]

SLIPS = [
    Fact(
        "a start beyond F_s is a break-away after a stick of no length: the period counts from it",
        {"z_start": 0.006},
        [1e-3, 0.449],
        _from_beyond,
        integrated=10.0,
        why="the stick is a difference of z",
        start_time=3.0,
    ),
    Fact(
        "what is set before the first step takes back a break-away at the start",
        {"z_start": 0.006},
        [(1e-3, {"mu_s": 0.75})],
        lambda p: {**STILL, "t_stick": 0, "t_event": 0},
    ),
    Fact(
        "a start in motion is no break-away: the stick after it sets t_stick, and no period",
        {"x_dot_start": -0.1, "z_start": 0.001},
        [0.1, 0.1],
        _from_motion,
        factor=10.0,
    ),
    Fact(
        "a reversal completes a slip and is no break-away",
        {"v": 0.0, "z_start": 0.05},
        [0.15],
        lambda p: {
            **_then(p, p.z_start, n_slips=1, mode=-1, t_stick=0, T=0),
            "t_event": slip(p, p.z_start).t,
        },
    ),
    Fact(
        "a free swing loses 2 mu_k N/k each half period until it sticks",
        {**BINARY, "v": 0.0, "z_start": 79.0 / 1024.0},
        [10.0],
        lambda p: {
            "n_slips": 19,
            "mode": 0,
            "z": -3 / p.k,
            "x": 82 / p.k,
            "W_pull": 0,
            "T": 0,
            "t_slip": slip(p, 7 / p.k).t,
            "Q_friction": (p.k * p.z_start**2 - 9 / p.k) / 2,
        },
        integrated=1e3,
        why="nineteen slips of twenty times the last",
    ),
    *(_shot(c) for c in (1e6, 5e7)),
    *(
        _young(zeta, angle, x_dot)
        for zeta in (0.0, 1e-6, 0.5, 1.0 - 1e-7, 1.0, 1.0 + 1e-9, 1.0 + 1e-3, 100.0)
        for angle, x_dot in ((1e-9, 0.0), (2e-4, 0.0), (0.2, 0.0), (0.2, 0.25), (2.5, 0.0))
    ),
    Fact(
        "the account of a long creep closes",
        {"c": 150.0, **LOOSE, "v": 0.0, "x_dot_start": 1.3, "z_start": 0.1},
        [1.0, 1e3, 1e9],
        lambda p: {"Q_friction": (p.x_dot_start**2 + p.k * p.z_start**2) / 2},
        factor=100.0,
        why="the sum of all arcs; beyond an integration",
        sides=EXACT,
    ),
    Fact(
        "a critically damped mass may decay without end",
        {"m": 1.0, "k": 1.0, "c": 2.0, **LOOSE, "v": 0.0, "z_start": 1.0, "x_dot_start": 1.0},
        [0.5, 4.5],
        lambda p: {"x_dot": MP.exp(-5), "z": MP.exp(-5), "n_slips": 0},
        factor=3.0,
        why="an integration cannot tell it from a motion that turns",
        sides=EXACT,
    ),
    Fact(
        "the work of a short arc has all its digits",
        {"m": 1000.0, "x_dot_start": 3.7, "v": 1e-3, "z_start": 1e-3, "c": 10.0},
        [7e-8],
        lambda p: {"W_pull": slip(p, p.z_start, p.x_dot_start, until=MP.mpf(7e-8)).W_pull},
        factor=100.0,
        why="the work is a difference of closed forms; not promised by an integration",
        sides=EXACT,
    ),
    Fact(
        "a nudge against the pull by 1e-7 of F_s is a short slip",
        {"v": 0.2, "mu_k": 0.5, "F_ext": -4.905 * (1.0 + 1e-7)},
        [1e-3],
        lambda p: {**_then(p, 0, 0, -1), "n_slips": 1},
        factor=1e7,
        why="the excess of the force is 1e-7 of it; beyond an integration",
        sides=EXACT,
    ),
]

LIMITS = [
    *(
        Fact(
            f"from critical damping on the slip never ends: zeta {zeta}",
            {**BINARY, "c": 64.0 * zeta, "v": 2.0**-10},
            [4.0 + 30.0 * zeta],
            lambda p: {"mode": 1, "n_slips": 0, "t_slip": 0, "x_dot": p.v},
        )
        for zeta in (1.0, 1.0 + ULP, 3.0)
    ),
    Fact(
        "without a gap the undamped mass never waits",
        {"mu_k": 0.5},
        [2.0],
        lambda p: {
            "t_stick": 0,
            "n_slips": 8,
            "x_dot_peak": 2 * p.v,
            **dict.fromkeys(("t_slip", "T"), 2 * MP.pi / p.w),
        },
    ),
    Fact(
        "without a gap damping ends the cycle",
        {"mu_k": 0.5, "c": 4.0},
        [50.0],
        lambda p: {"mode": 1, "n_slips": 0, "t_slip": 0, "T": 0, "x_dot": p.v},
    ),
    Fact(
        "a swing about sliding of less than v goes on, undamped",
        {**BINARY, "v": 0.02, "x_dot_start": 0.015, "z_start": 2.0 / 1024.0},
        [20.0],
        lambda p: {
            "mode": 1,
            "n_slips": 0,
            "x_dot": p.v + MP.cos(p.w * 20) * (p.x_dot_start - p.v),
        },
        factor=1e3,
        why="the phase is 600",
    ),
    *(
        Fact(
            f"without friction the mass swings behind the pull, a slip a period: {values}",
            values,
            [1.0],
            lambda p: {
                "n_slips": 5,
                "F_s": 0,
                "Q_friction": 0,
                "t_stick": 0,
                "mode": 1 if p.v > 0 else -1,
                "x": p.v * (1 - MP.sin(p.w) / p.w),
            },
            factor=30.0,
            why="the phase is 30",
        )
        for values in (LOOSE, {"load": -9.81}, {**LOOSE, "v": -0.02})
    ),
    *(
        Fact(f"without friction and pull nothing moves: {values}", values, [5.0], lambda p: STILL)
        for values in ({**LOOSE, "v": 0.0}, {"load": -9.81, "v": 0.0})
    ),
    Fact(
        "a load of -m g, to a rounding, leaves no normal force",
        {"m": 3.7, "load": -(3.7 * 9.81)},
        [0.01],
        lambda p: {"F_s": 0},
    ),
    Fact(
        "mu_k above mu_s is clamped to 0.01 below it, or to 0, and follows mu_s",
        {"mu_k": 0.7},
        [0.1, (0.1, {"mu_s": 0.005}), (0.1, {"mu_s": 0.9})],
        lambda p: [{"mu_k_used": MP.mpf(used)} for used in (0.5 - 0.01, 0.0, 0.7)],
    ),
    Fact(
        "far from the origin and late the cycle is the same",
        {"x_start": 1e3},
        [_first({}, 2)],
        lambda p: {**cycle(p), "n_slips": 2},
        integrated=10.0,
        why="the gap: theory (17)",
        start_time=1e3,
    ),
]

FACTS = (*CYCLES, *STICKS, *SLIPS, *LIMITS)
