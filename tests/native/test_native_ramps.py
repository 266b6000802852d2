"""Inputs that move within a step, against the equations under SciPy and steps of held inputs."""

import ctypes as c
import math
import random
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from tests.conftest import Sized, built
from tests.driver import ERROR, Fmu, Instance, Refused, loaded
from tests.needs import needs

pytestmark = needs("cc")

INPUTS = ("v", "load", "F_ext")
MOTION = ("x", "x_dot", "z", "W_pull", "Q_friction", "n_slips", "t_slip", "delta_x", "t_stick", "T")
REST = {"v": 0.02, "load": 0.0, "F_ext": 0.0}


def moving(instance: Instance, rates: Mapping[str, float], order: int = 1) -> int:
    references = (c.c_uint32 * len(rates))(*(instance.fmu.references[name] for name in rates))
    orders, values = (c.c_int * len(rates))(*[order] * len(rates)), (c.c_double * len(rates))
    given = (c.c_size_t(len(rates)), orders, values(*rates.values()))
    return instance.status("SetRealInputDerivatives", references, *given)


def ramped(fmu: Fmu, step: float, inputs: Any, rates: Any, pieces: int = 1, **start: Any) -> Any:
    instance = fmu.instance()
    instance.start(**start, **inputs)
    for _ in range(pieces):
        assert moving(instance, rates) == 0
        instance.step(step / pieces)
    reached = instance.get(*INPUTS)
    assert reached == pytest.approx([inputs[n] + rates[n] * step for n in INPUTS], abs=1e-12)
    return instance.get(*MOTION)


def friction(p: Mapping[str, Any]) -> tuple[Callable[..., Any], Callable[[float], float]]:
    """Return the coefficients of slip at a speed, and of rest at an age."""
    mu_s, mu_k = p["mu_s"], p["mu_k"]
    if p.get("shape") == 3:
        points = [0.0, p["u_2"], p["u_3"]], [p["mu_1"], p["mu_2"], p["mu_3"]]
        return lambda u: np.interp(u, *points), lambda _: mu_s
    if p.get("shape") == 2:
        return lambda u: mu_k + (mu_s - mu_k) / (1.0 + u / p["v_s"]), lambda _: mu_s
    if p.get("shape") == 1:
        power = p["delta"]
        return lambda u: mu_k + (mu_s - mu_k) * np.exp(-((u / p["v_s"]) ** power)), lambda _: mu_s
    return lambda _: mu_k, lambda age: mu_s + p["B"] * math.log1p(age / p["t_0"])


def integrated(p: Mapping[str, Any], step: float, inputs: Any, rates: Any) -> list[float]:
    """Return the motion by SciPy, from event to event."""
    mu, mu_rest = friction(p)
    v, N, F = (np.poly1d([rates[name], inputs[name]]) for name in INPUTS)
    k, state, mode, t, begun, age = 1000.0, [0.0, 0.0, p["z_start"], 0.0, 0.0], 0, 0.0, 0.0, 0.0
    state[1], found, seen = p["x_dot_start"], dict.fromkeys(MOTION[5:], 0.0), None
    mode = int(np.sign(state[1]))

    def hold(s: float) -> float:
        return mu_rest(age + s - t) * float(9.81 + N(s))

    def force(s: float) -> float:
        return float(k * (state[2] + (v(t) + v(s)) / 2.0 * (s - t)) + F(s))

    if mode == 0 and abs(force(0.0)) > hold(0.0):
        mode, seen = int(np.sign(force(0.0))), 0.0
    at = 0.0
    while t < step:
        if mode == 0:
            grid, first = np.linspace(t, step, 2001), (step, 0)
            for sign in (1, -1):
                lacks = np.array([hold(s) - sign * force(s) for s in grid])
                for n in np.flatnonzero(lacks[1:] < -1e-13)[:1]:
                    args = (lambda s, sign=sign: hold(s) - sign * force(s)), grid[n], grid[n + 1]
                    root = brentq(*args, xtol=1e-16) if lacks[n] > 0.0 else grid[n]
                    first = min(first, (root, sign))
            z = (force(first[0]) - F(first[0])) / k
            state[3] += k * (z - state[2]) * (z + state[2]) / 2.0
            state[2], (until, mode) = z, first
            age, t = age + until - t, until
            if mode != 0:
                found["t_stick"], found["T"] = t - begun, 0.0 if seen is None else t - seen
                seen = begun = t
                at = state[0]
            continue

        def rates_of(s: float, y: Any, mode: int = mode) -> list[float]:
            against = (9.81 + N(s)) * mu(max(mode * y[1], 0.0)) * mode + p["c"] * y[1]
            spring = k * y[2]
            return [y[1], spring + F(s) - against, v(s) - y[1], spring * v(s), against * y[1]]

        stop: Any = lambda _, y, mode=mode: mode * y[1]  # noqa: E731
        stop.terminal, stop.direction = True, -1
        how: Any = {"method": "DOP853", "rtol": 3e-14, "atol": 1e-16, "max_step": 4e-3}
        run = solve_ivp(rates_of, (t, step), state, events=stop, first_step=1e-6, **how)
        state, t = list(run.y[:, -1]), run.t[-1]
        if run.status == 1:
            state[1], age = 0.0, 0.0
            found["n_slips"] += 1
            found["t_slip"], found["delta_x"], begun = t - begun, state[0] - at, t
            turns = np.sign(force(t)) == -mode and abs(force(t)) > hold(t)
            mode, at = -mode if turns else 0, state[0]
    return [*state, *found.values()]


def drawn(law: str, seed: int) -> tuple[dict[str, Any], tuple[float, Any, Any]]:
    """Return start values, and length of a step with the inputs and their rates in it."""
    chance = random.Random(seed)
    start: dict[str, Any] = {"c": chance.choice([0.0, 0.0, 2.0, 30.0, 100.0])}
    start |= {"mu_s": chance.uniform(0.3, 0.6)}
    start |= {"mu_k": chance.uniform(0.05, 0.3), "z_start": chance.choice([0.0, 0.003, -0.002])}
    start["x_dot_start"] = chance.choice([0.0, 0.0, 0.05, -0.1])
    if law == "stribeck":
        start |= {"shape": chance.choice([1, 2, 3]), "v_s": chance.choice([0.01, 0.1])}
        start["delta"] = chance.choice([1.0, 1.5, 2.0, 3.5])
        start |= {"n_points": 3, "mu_1": 0.9 * start["mu_s"], "u_2": 0.05, "mu_2": 0.1}
        start |= {"u_3": 0.2, "mu_3": 0.2}
    else:
        start |= {"B": chance.choice([0.0, 0.02]), "t_0": 0.01}
    step, reach = chance.choice([0.01, 0.1, 0.4]), ((-0.1, 0.2), (-3.0, 5.0), (-1.0, 1.0))
    inputs, ends = ([chance.uniform(*r) for r in reach] for _ in range(2))
    move = chance.choice([(1, 1, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1)])
    rates = [m * (b - a) / step for m, a, b in zip(move, inputs, ends, strict=True)]
    given = dict(zip(INPUTS, inputs, strict=True)), dict(zip(INPUTS, rates, strict=True))
    return start, (step, *given)


@pytest.mark.parametrize("law", ["coulomb", "stribeck"])
def test_the_motion_is_that_of_the_equations(law: str, sized: Sized) -> None:
    fmu = loaded(built("native-2", law))
    for seed in range(sized(200)):
        start, given = drawn(law, seed)
        # At the kinks of a curve SciPy is off by more.
        close = 1e-11 if law == "coulomb" else 2e-9
        right = pytest.approx(integrated(start, *given), rel=close, abs=1e-3 * close)
        assert ramped(fmu, *given, **start) == right, seed
        assert ramped(fmu, *given, pieces=7, **start) == right, seed


@pytest.mark.parametrize("law", ["coulomb", "stribeck"])
@pytest.mark.parametrize("start", [{"z_start": 0.00481}, {"x_dot_start": 0.2}])
def test_a_ramp_is_what_many_held_steps_go_to(law: str, start: dict[str, Any]) -> None:
    fmu, rates = loaded(built("native-2", law)), {"v": 0.8, "load": 0.0, "F_ext": 0.0}

    def held(count: int) -> Any:
        instance = fmu.started(**start)
        for n in range(count):
            instance.set(v=0.02 + 0.008 * (n + 0.5) / count)
            instance.step(0.01 / count)
        return np.array(instance.get(*MOTION))

    few, many = held(10_000), held(20_000)
    found = ramped(fmu, 0.01, REST, rates, **start)
    assert found == pytest.approx(many + (many - few) / 3.0, rel=1e-9, abs=1e-12)


def test_the_error_of_a_wave_is_of_second_order_in_the_step() -> None:
    # FMPy 0.3.32 has the option for it, and room for nine inputs only.
    def wave(time: float) -> float:
        return 0.03 + 0.02 * math.sin(3.0 * time)

    def last(step: float) -> float:
        instance = loaded(built("native-2")).started()
        for n in range(round(2.0 / step)):
            now, then = wave(n * step), wave((n + 1) * step)
            instance.set(v=now)
            assert moving(instance, {"v": (then - now) / step}) == 0
            instance.step(step)
        return float(instance.get("x")[0])

    coarse, fine, finest = (last(step) for step in (0.02, 0.01, 0.0025))
    assert (coarse - finest) / (fine - finest) == pytest.approx(4.0, abs=0.7)


def test_fmi_3_asks_for_the_inputs_at_the_end_of_a_step() -> None:
    fmu, asked = loaded(built("native-3")), []
    wanted = (c.c_uint32 * 1)(fmu.references["v"])
    pointer, yes = c.c_void_p, c.c_bool
    called = c.CFUNCTYPE(None, pointer, c.c_double, yes, yes, yes, yes, pointer, pointer)

    @called  # type: ignore[untyped-decorator]
    def update(_: Any, time: float, *flags: Any) -> None:
        asked.append((time, flags[:4]))
        instance.set(v=0.02 + 0.05 * time)

    make = fmu.library.fmi3InstantiateCoSimulation
    make.restype = pointer
    no = yes(False)
    flags = (no, no, no, no, wanted, c.c_size_t(1), None)
    instance = fmu.instance()
    instance.address = pointer(make(b"a", fmu.token, None, *flags, fmu.logger, update))
    instance.start()
    instance.step(0.5)
    instance.step(0.5)
    assert asked == [(0.5, (True, False, False, False)), (1.0, (True, False, False, False))]
    one = ramped(loaded(built("native-2")), 1.0, REST, {"v": 0.05, "load": 0.0, "F_ext": 0.0}, 2)
    assert instance.get("v") == [pytest.approx(0.07)]
    assert instance.get(*MOTION) == pytest.approx(one, rel=1e-13)


def test_what_is_set_of_a_moving_input_is_restored_and_forgotten_after_the_step() -> None:
    instance = loaded(built("native-2")).started()
    assert moving(instance, {"v": 0.1}) == 0
    data = instance.pack()
    instance.step(0.1)
    first = instance.everything()
    assert first["v"] == pytest.approx(0.03)
    instance.step(0.1)
    assert instance.get("v") == [first["v"]]
    instance.restore(instance.unpack(data))
    instance.step(0.1)
    assert instance.everything() == first


@pytest.mark.parametrize(
    ("rates", "order"), [({"k": 1.0}, 1), ({"v": 1.0}, 2), ({"v": math.inf}, 1)]
)
def test_another_derivative_is_refused(rates: dict[str, float], order: int) -> None:
    instance = loaded(built("native-2")).started()
    assert moving(instance, rates, order) == ERROR
    assert "v, load and F_ext have a derivative, of order 1" in instance.fmu.messages[-1][2]


def test_a_load_may_lift_the_mass_to_no_weight_and_no_further() -> None:
    fmu = loaded(built("native-2"))
    found = ramped(fmu, 0.1, REST, {"v": 0.0, "load": -98.1, "F_ext": 0.0})
    # The force falls to nothing, and the spring pulls it along before.
    assert found[0] > 0.0
    assert found[5] == 0
    # The rate of a load that ends in rounding below the weight.
    rate = {"v": 0.0, "load": (-9.81 - 3.7) / 0.3, "F_ext": 0.0}
    assert ramped(fmu, 0.3, {**REST, "load": 3.7}, rate)[5] == 0
    with pytest.raises(Refused, match="lifts off"):
        ramped(fmu, 0.1, REST, {"v": 0.0, "load": -98.2, "F_ext": 0.0})


def test_a_force_that_reaches_break_away_and_turns_back_moves_nothing() -> None:
    # k z = 1000 v (t - t^2) is at its highest after half a second: 4 N, as much as mu_s N, or more.
    fmu = loaded(built("native-2"))
    for v, slips in ((0.016, 0), (0.016001, 1)):
        given = {**REST, "v": v}, {"v": -2.0 * v, "load": 0.0, "F_ext": 0.0}
        found = ramped(fmu, 1.0, *given, mu_s=0.4, mu_k=0.2, g=10.0)
        assert found[5] >= slips
        assert (found[0] == 0.0) == (slips == 0)
