"""Facts of a kinetic friction that follows a measured curve of points."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from tests.facts.closed import MP, Exact, Real, cycle, slip
from tests.facts.fact import Fact
from tests.facts.sides import BLOCK, NATIVE, QUICK, SIDES, Side
from tests.laws.stribeck import FALLS_TWICE, Points, curve

AT_ONCE = (BLOCK, NATIVE)
"""The sides that take a long motion in one arc."""


def _rest(p: Exact, points: Points) -> dict[str, Real]:
    done = slip(p, p.F_s / p.k, curve=points)
    return {
        "n_slips": 1,
        "mu_k_used": MP.mpf(points[-1][1]),
        "t_slip": done.t,
        "delta_x": done.x,
        "spring_drop": p.F_s / p.k - done.z,
        "x_dot_peak": done.peak,
        "Q_friction": done.heat(p, p.F_s / p.k),
    }


def _slip(
    name: str, points: Points, sides: Sequence[Side] = QUICK, gap: float = 1.0, **values: float
) -> Fact:
    p = Exact(values)
    end = p.F_s / p.k / abs(p.v) + slip(p, p.F_s / p.k, curve=points).t
    return Fact(
        f"the first slip over a curve is the exact one: {name}",
        {**values, **curve(points)},
        [float(end) * (1.0 + 1e-9)],
        lambda p: _rest(p, points),
        factor=100.0,
        integrated=gap,
        why="some hundred operations a piece; a small gap: theory (17)",
        sides=sides,
        law="stribeck",
    )


def _from(p: Exact, points: Points, until: float) -> dict[str, Real]:
    now = slip(p, p.z_start, p.x_dot_start, until=MP.mpf(until), curve=points)
    return {
        "x": now.x,
        "z": now.z,
        "x_dot": now.x_dot,
        "mode": 1,
        "Q_friction": now.heat(p, p.z_start, p.x_dot_start),
    }


def _motion(
    name: str, points: Points, until: float, values: Mapping[str, float], **more: Any
) -> Fact:
    return Fact(
        f"a motion along a curve is the exact one: {name}",
        {**values, **curve(points)},
        [until],
        lambda p: _from(p, points, until),
        law="stribeck",
        why="the growth of the motion amplifies roundings",
        **more,
    )


def _falling(mu: float, slope: float) -> Points:
    return [(0.0, mu), (mu / slope, 0.0)]


CRITICAL = {"g": 8.0, "k": 1024.0, "v": 2.0**-12, "x_dot_start": 2.0**-13, "z_start": 2.0**-9}
FAST = {"k": 1.0, "v": 1e-6, "x_dot_start": 1e-5}
"""A motion that grows as exp(981 t), up to the corner at the end of the fall."""

SLIPS = (
    _slip("falls twice", FALLS_TWICE, SIDES, c=2.0),
    _slip("undamped", FALLS_TWICE),
    _slip("with a gap, fast", FALLS_TWICE, gap=10.0, mu_s=0.7, v=0.1),
    _slip("without a gap, slowly", FALLS_TWICE, v=1e-3),
    _slip("steep", [(0.0, 0.5), (1e-4, 0.3), (0.01, 0.29), (0.05, 0.32)], v=0.003),
    _slip("narrow bands", [(0.0, 0.45), (0.08, 0.4), (0.081, 0.3), (0.082, 0.38)], SIDES, v=0.05),
    _slip("corner at the pull", [(0.0, 0.45), (0.02, 0.3), (0.03, 0.4)]),
    _slip("overdamped by its slope", [(0.0, 0.5), (0.02, 0.2), (0.2, 1.5)], mu_s=0.52, v=0.01),
    _slip("hardly a gap", [(0.0, 0.3), (5e-4, 0.3), (5e-3, 0.29)], gap=1e3, mu_s=0.300001, v=1e-3),
    _slip("its slope cancels the damping", _falling(0.25, 0.5), g=8.0, v=0.2, c=4.0),
)

FACTS = (
    *SLIPS,
    *(
        _motion(
            f"at a damping ratio of -1 + {distance:g}",
            _falling(0.25, 8.0 * (1.0 - distance)),
            0.03125,
            CRITICAL,
            factor=30.0,
        )
        for distance in (1e-3, 1e-10, 0.0, -1e-10, -1e-3)
    ),
    _motion(
        "rising without bound",
        _falling(0.3, 100.0),
        1e-3,
        {**FAST, "z_start": 4.9},
        factor=30.0,
        # The reference integrates what the spring gives of its 2 m: x is a millionth of that, and
        # a rounding of it 2e-10 of x and of the heat.
        integrated={"x": 100.0, "x_dot": 10.0, "Q_friction": 100.0},
    ),
    Fact(
        "a motion that falls fast ends in time",
        {**FAST, **curve(_falling(0.3, 100.0))},
        [1e-4],
        lambda p: {"n_slips": 1, "t_slip": slip(p, 0, p.x_dot_start, curve=_falling(0.3, 100.0)).t},
        factor=100.0,
        law="stribeck",
    ),
    *(
        Fact(
            f"{name} is Coulomb's law",
            own,
            [0.97],
            cycle,
            factor=factor,
            integrated=10.0,
            why="the gap: theory (17); the fall is over after (v_s/v)^(2/3) of the slip",
            sides=sides,
            law="stribeck",
        )
        for name, own, factor, sides in (
            (
                "a flat curve",
                curve([(0.0, 0.3), (0.01, 0.3), (0.02, 0.3), (0.07, 0.3)]),
                1.0,
                QUICK,
            ),
            ("a fast fall", {"v_s": 1e-12}, 1e7, AT_ONCE),
        )
    ),
    *(
        Fact(
            f"without a fall of friction the undamped mass never waits: shape {shape}",
            {"shape": shape, "mu_k": 0.5},
            [1.0],
            lambda p: {"t_stick": 0, "n_slips": 3, "t_slip": 2 * MP.pi / p.w},
            sides=QUICK,
            law="stribeck",
        )
        for shape in (1, 2)
    ),
    Fact(
        "without a normal force the mass swings without heat",
        {"load": -9.81, **curve(_falling(0.3, 0.1))},
        [0.7],
        lambda p: {"x": p.v * (0.7 - MP.sin(p.w * 0.7) / p.w), "Q_friction": 0},
        factor=30.0,
        why="the phase is 20",
        law="stribeck",
    ),
    Fact(
        "a swing about sliding that hardly grows is taken to its stop at once",
        {
            **curve(_falling(0.5, 1e-6 / 9.81)),
            "z_start": (0.5 * 9.81 - 2e-8) / 1000.0,
            "x_dot_start": 0.02 * (1.0 - 1e-4),
        },
        [math.log(1e4) / 5e-7 + 0.15],
        lambda p: {"n_slips": 1, "t_slip": MP.log(1e4) / 5e-7},
        factor=1e7,
        why="it stops within one turn, 0.2 s, of when its amplitude is v",
        sides=AT_ONCE,
        law="stribeck",
    ),
    *(
        Fact(
            f"stable sliding on a corner is kept for a million seconds at once: c = {c:g}",
            {
                **curve([(0.0, 0.3 - below * 0.02), (0.02, 0.3), (0.04, 0.7)]),
                "c": c,
                "x_dot_start": 0.02,
                "z_start": (2.943 + c * 0.02) / 1000.0,
            },
            [1e-3, 1e6],
            lambda p: {"x_dot": p.v, "n_slips": 0},
            factor=100.0,
            sides=AT_ONCE,
            law="stribeck",
        )
        for below, c in ((0.0, 0.0), (10.0, 3.0))
    ),
)
