"""Settings of friction with a memory: published ones, and others that a Taylor series can follow.

The truth needs a piece for each few times that the bristles or the contacts renew: some sigma_0 / k
of them for a slip of LuGre, a mass that creeps no slower than 1e-6 m/s under rate and state.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from stickslip_ref import Change, Parameters, Trajectory, simulate
from stickslip_verification import truth
from tests.facts.sides import parted

Values = Mapping[str, float]


class Setting(NamedTuple):
    law: str
    values: Values
    steps: tuple[tuple[float, Values], ...]


CANUDAS: Values = {
    "m": 1.0,
    "g": 1.0,
    "k": 2.0,
    "c": 0.4,
    "v": 0.1,
    "mu_s": 1.5,
    "mu_k": 1.0,
    "sigma_0": 1e5,
    "sigma_1": math.sqrt(1e5),
    "v_s": 1e-3,
}
"""C. Canudas de Wit et al., IEEE Trans. Automatic Control 40 (1995) 419, IV-D."""


def _qdyn() -> Values:
    a, b, D_c, V_0, N, k, c, V = 0.01, 0.025, 1e-5, 1e-6, 5e6, 2e9, 2e10 / 6000.0, 2e-5
    mu = a * math.asinh(V / (2.0 * V_0) * math.exp((0.6 + b * math.log(V_0 * 10.0 / D_c)) / a))
    base = {"m": 1.0, "g": N, "k": k, "c": c, "v": 1e-6, "z_start": (N * mu + c * V) / k}
    return {**base, "a": a, "b": b, "D_c": D_c, "V_0": V_0, "inertia": 2.0}


QDYN = _qdyn()
"""The spring block of QDYN, Y. Luo et al., 10.5281/zenodo.322459: aging, radiation damping."""

_STIFF: Values = {"k": 1e4}
_MOVES: Values = {"v": 0.02, "x_dot_start": 0.02, "z_start": 0.0059, "theta_start": 5e-4, "b": 0.02}
_CREEPS: Values = {
    "v": 1e-3,
    "z_start": 0.0059,
    "c": 10.0,
    "theta_start": 0.01,
    "b": 0.02,
    "inertia": 2.0,
    "D_c": 1e-4,
}
SETTINGS = {
    "Canudas de Wit": Setting(
        "lugre", {**CANUDAS, "z_start": 0.749, "zeta_start": 1.498e-5}, ((0.2, {}),)
    ),
    "QDYN": Setting("rate_state", QDYN, ((581.25, {}),)),
    "bristles": Setting("lugre", _STIFF, ((0.03, {}), (0.03, {}))),
    "bristles, fast": Setting("lugre", {**_STIFF, "v": 0.1, "delta": 1.0}, ((0.06, {}),)),
    "bristles, backward": Setting(
        "lugre",
        {**_STIFF, "v": -0.05, "x_dot_start": 0.3, "sigma_1": 30.0},
        ((0.01, {}), (0.02, {"load": 4.0})),
    ),
    "bristles, falling damping": Setting("lugre", {**_STIFF, "v_d": 0.002}, ((0.05, {}),)),
    "bristles, changes": Setting(
        "lugre",
        {**_STIFF, "c": 20.0, "F_ext": -1.0},
        ((0.02, {}), (0.01, {"v": -0.02}), (0.005, {"k": 8e3, "F_ext": 2.0})),
    ),
    "contacts": Setting("rate_state", {**_MOVES, "D_c": 1e-4}, ((0.1, {}),)),
    "contacts, slip law": Setting(
        "rate_state", {**_MOVES, "D_c": 1e-4, "evolution": 2.0}, ((0.1, {}),)
    ),
    "contacts, radiation": Setting("rate_state", _CREEPS, ((0.5, {}), (0.5, {}))),
    "contacts, radiation, slip law": Setting(
        "rate_state", {**_CREEPS, "evolution": 2.0}, ((0.5, {}), (0.5, {}))
    ),
    "contacts, load": Setting(
        "rate_state", {**_CREEPS, "alpha": 0.2}, ((0.3, {}), (0.3, {"load": 1.0}))
    ),
}


def simulated(setting: Setting) -> Trajectory:
    times = [math.fsum(h for h, _ in setting.steps[:n]) for n in range(len(setting.steps) + 1)]
    base, own = parted(setting.values)
    changes = [
        Change(time, *parted(values))
        for time, (_, values) in zip(times, setting.steps, strict=False)
    ]
    return simulate(
        Parameters(**base), times[-1], times=times[1:], changes=changes, law=setting.law, own=own
    )


def exact(setting: Setting) -> truth.Run:
    steps = [truth.Step(h, values) for h, values in setting.steps]
    return truth.run(setting.values, steps, digits=20, law=setting.law)
