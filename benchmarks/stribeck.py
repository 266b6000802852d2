"""The Python block under Stribeck's law, against Coulomb's law and against SciPy's integrator."""

import math
import statistics
import time
from random import Random

from scipy.integrate import solve_ivp

from fmi.model import Spec
from stickslip_fmu.block import Block
from stickslip_fmu.laws.stribeck.law import STRIBECK
from stickslip_fmu.spec import SPEC, spec_of

SLIPS = 25
ROUNDS = 3
STEPS = 1_500
_STRIBECK = spec_of(STRIBECK)


def measure_slips() -> tuple[float, float]:
    """Return the median time of a slip in the block, and in SciPy's DOP853 at rtol = 1e-9 [s].

    Mass, stiffness, pull and Stribeck velocity are drawn over orders of magnitude; the exponent is
    2. Both start at the break-away and end at the first stop.
    """
    draw = Random(1)

    def drawn(low: float, high: float) -> float:
        return math.exp(draw.uniform(math.log(low), math.log(high)))

    ours: list[float] = []
    theirs: list[float] = []
    while len(ours) < SLIPS:
        m, k, v, v_s = drawn(0.1, 10.0), drawn(1e2, 1e5), drawn(1e-4, 0.1), drawn(1e-3, 1.0)
        rounds = [(_integrated(m, k, v, v_s), _exact(m, k, v, v_s)) for _ in range(ROUNDS)]
        theirs.append(min(each for each, _ in rounds))
        ours.append(min(each for _, each in rounds))
    return statistics.median(ours), statistics.median(theirs)


def measure_steps(*, changing: bool) -> tuple[float, float]:
    """Return the median time of a step of 1 ms in slip with outputs, Stribeck's and Coulomb's [s].

    The pull is 50 mm/s; where it is `changing`, it takes another value before every step.
    """
    ours, yardstick = (_steps(spec, changing=changing) for spec in (_STRIBECK, SPEC))
    return ours, yardstick


def _block(spec: Spec, **values: float) -> Block:
    block = spec.model(spec.values({**spec.table.start_values(), **values}))
    assert isinstance(block, Block)
    return block


def _steps(spec: Spec, *, changing: bool) -> float:
    block = _block(spec, v=0.05)
    times: list[float] = []
    number = 0
    while len(times) < STEPS:
        number += 1
        if changing:
            block.set("v", 0.05 * (1.0 + 1e-3 * (number % 7)))
        begin = time.perf_counter()
        block.advance(0.0, 1e-3)
        block.refresh()
        _ = block.W_pull, block.Q_friction
        end = time.perf_counter()
        if block.mode != 0:
            times.append(end - begin)
    return statistics.median(times)


def _exact(m: float, k: float, v: float, v_s: float) -> float:
    whole = _at_break_away(m, k, v, v_s)
    while whole.meter.n_slips == 0:
        whole.advance(0.0, 0.5 * math.sqrt(m / k))
    block = _at_break_away(m, k, v, v_s)
    begin = time.perf_counter()
    block.advance(0.0, whole.meter.t_slip * (1.0 + 1e-9))
    end = time.perf_counter()
    assert block.meter.n_slips == 1
    return end - begin


def _at_break_away(m: float, k: float, v: float, v_s: float) -> Block:
    block = _block(_STRIBECK, m=m, k=k, v=v, v_s=v_s)
    block.advance(0.0, block.state.arc.duration)
    return block


def _integrated(m: float, k: float, v: float, v_s: float) -> float:
    normal = m * 9.81

    def slope(_: float, state: tuple[float, float]) -> tuple[float, float]:
        z, speed = state
        friction = normal * (0.3 + 0.2 * math.exp(-((speed / v_s) ** 2)))
        return v - speed, (k * z - friction) / m

    def stop(_: float, state: tuple[float, float]) -> float:
        return state[1]

    stop.terminal = True  # type: ignore[attr-defined]
    stop.direction = -1.0  # type: ignore[attr-defined]
    begin = time.perf_counter()
    start = (0.5 * normal / k, 0.0)
    longest = 1e3 * math.sqrt(m / k)
    solve_ivp(slope, (0.0, longest), start, "DOP853", events=stop, rtol=1e-9, atol=1e-12)
    return time.perf_counter() - begin
