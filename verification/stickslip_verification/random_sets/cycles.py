"""Random tests about the steady cycle: random points, damped points, and a million cycles."""

import math
import warnings
from collections.abc import Generator, Iterator, Mapping, Sequence
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
from mpmath import mp, mpf

import stickslip_ref
from stickslip_verification import truth
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.random_sets import draws
from stickslip_verification.random_sets.mover import Motion, Mover, State
from stickslip_verification.random_sets.tally import RandomTestResult, Tally, relative

CYCLE = ("t_stick", "t_slip", "T", "delta_x", "spring_drop")
POINTS = 5000
SHALLOW_POINTS = 1000
DAMPED_POINTS = 1000
FMU_BOUND = 1e-12
REFERENCE_BOUND = 1e-9
SMALLEST_REFERENCE_LAMBDA = 1e-3
"""Below it the re-stick is too shallow for any integration in double precision."""
DECIDABLE = 1e-9
"""|lambda/lambda_c - 1| below which the existence of the cycle is not tested."""
WATCHED = 3.5
"""Length of a run in periods. The second slip ends within three periods from any start."""

Values = Mapping[str, float]
Cycle = Mapping[str, Any]
Point = dict[str, float]


def undamped_points(seed: int, fraction: float) -> Iterator[tuple[Point, Random]]:
    """Draw 5,000 points over all magnitudes and 1,000 shallow ones, or that fraction of each.

    With each comes a source of numbers of its own, for what else is drawn about it.
    """
    for kind, whole in ((draws.steady_cycle, POINTS), (draws.shallow_cycle, SHALLOW_POINTS)):
        for n in range(_share(whole, fraction)):
            draw = Random(f"{kind.__name__} {n} of {seed}")
            yield kind(draw), draw


def fmu_cycle(fmu: Path, seed: int, fraction: float) -> Iterator[RandomTestResult | None]:
    """Prove that the FMU has the exact cycle at any steps from 1e-3 T to 20 T.

    Yields None after each draw, and the result at last.
    """
    tally = Tally(
        "steady cycle at any steps", "fmu", "1e-12 relative times mu_s/(mu_s - mu_k)", seed
    )
    with Mover(fmu, (*CYCLE, "n_slips")) as mover:
        for p, draw in undamped_points(seed, fraction):
            exact = _undamped(p)
            period = float(exact["T"])
            steps = draws.uneven_steps(draw, 1e-3 * period, 20.0 * period, WATCHED * period)
            bound = dict.fromkeys(CYCLE, FMU_BOUND * _conditioning(p))
            try:
                got = _moved(mover, p, steps)
            except FmuError as error:
                tally.refuse(str(error), p)
            else:
                tally.judge(_against(got, exact, bound, p, math.fsum(steps)), p)
            yield None
    yield tally.result()


def reference_cycle(seed: int, fraction: float) -> Iterator[RandomTestResult | None]:
    """Prove that the simulation misses no cycle and errs within its sensitivity, lambda >= 1e-3."""
    tally = Tally(
        "steady cycle simulated",
        "reference",
        "1e-9 mu_s/(mu_s - mu_k) times 1 for T and delta_x, 1 + 1/lambda for t_slip, "
        "1 + 1/lambda^2 for t_stick and spring_drop",
        seed,
    )
    for p, _ in undamped_points(seed, fraction):
        lambda_ = draws.w_of(p) * draws.gap_of(p) / p["v"]
        if lambda_ >= SMALLEST_REFERENCE_LAMBDA:
            exact = _undamped(p)
            basic = REFERENCE_BOUND * _conditioning(p)
            bound = {
                "T": basic,
                "delta_x": basic,
                "t_slip": basic * (1.0 + 1.0 / lambda_),
                "t_stick": basic * (1.0 + 1.0 / lambda_**2),
                "spring_drop": basic * (1.0 + 1.0 / lambda_**2),
            }
            end = WATCHED * float(exact["T"])
            try:
                got = _simulated(p, end)
            except Exception as error:
                tally.refuse(f"{type(error).__name__}: {error}", p)
            else:
                tally.judge(_against(got, exact, bound, p, end), p)
        yield None
    yield tally.result()


def reference_formulas(seed: int, fraction: float) -> Iterator[RandomTestResult | None]:
    """Prove that the reference's closed forms of the undamped cycle are those of the theory."""
    tally = Tally(
        "steady cycle by formula", "reference", "1e-12 relative times mu_s/(mu_s - mu_k)", seed
    )
    for p, _ in undamped_points(seed, fraction):
        bound = FMU_BOUND * _conditioning(p)
        tally.judge(_formula_ratios(p, _undamped(p), dict.fromkeys(CYCLE, bound)), p)
        yield None
    yield tally.result()


def damped_points(seed: int, fraction: float) -> Iterator[tuple[Point, float, Random]]:
    """Draw 1,000 damped points on both sides of lambda_c, each with d = lambda/lambda_c - 1.

    From zeta = 1 on there is no cycle at any lambda: there d is -1.
    """
    for n in range(_share(DAMPED_POINTS, fraction)):
        draw = Random(f"damped_cycle {n} of {seed}")
        p, zeta = draws.damped_oscillator(draw)
        critical = _critical_lambda(zeta) if zeta < 1.0 else math.inf
        d = draws.signed_distance(draw)
        if math.isinf(critical):
            lambda_ = draws.log_uniform(draw, 1e-2, 1e6)
        else:
            lambda_ = critical * (1.0 + d)
        point = draws.with_lambda(p, lambda_)
        yield point, _distance(point), draw


def damped_cycle(fmu: Path, seed: int, fraction: float) -> Iterator[RandomTestResult | None]:
    """Prove that the FMU cycles where the damped cycle exists, nowhere else, and exactly."""
    tally = Tally(
        "damped cycle",
        "fmu",
        "existence for |d| > 1e-9; 1e-12 mu_s/(mu_s - mu_k) times 1 for T and delta_x, "
        "1 + 1/sqrt(d) for t_slip, t_stick and spring_drop",
        seed,
        most_left_out=0.01,
    )
    formulas = Tally("damped cycle by formula", "reference", tally.bound, seed, 0.01)
    with Mover(fmu, (*CYCLE, "n_slips", "mode")) as mover:
        for p, d, draw in damped_points(seed, fraction):
            if abs(d) <= DECIDABLE:
                tally.leave_out()
                formulas.leave_out()
                yield None
                continue
            exact = truth.steady_cycle(p)
            if exact is not None:
                period = float(exact["T"])
                bound = _damped_bound(p, d)
            else:
                period = 2.0 * math.pi / draws.w_of(p) + 0.5 * draws.gap_of(p) / p["v"]
                bound = {}
            steps = draws.uneven_steps(draw, 1e-3 * period, 20.0 * period, WATCHED * period)
            try:
                got = _moved(mover, p, steps)
            except FmuError as error:
                tally.refuse(str(error), p)
            else:
                if exact is not None:
                    tally.judge(_against(got, exact, bound, p, math.fsum(steps)), p)
                else:
                    cycles = got["n_slips"] > 0 or got["mode"] != 1
                    tally.judge({f"existence at d = {d:.3g}": math.inf if cycles else 0.0}, p)
            formulas.judge(_formula_ratios(p, exact, bound), p)
            yield None
    yield formulas.result()
    yield tally.result()


def million_cycles(fmu: Path, seed: int, fraction: float) -> Iterator[RandomTestResult | None]:
    """Prove that the millionth cycle of one instance is the second, bit for bit."""
    names = ("t_slip", "t_stick", "spring_drop")
    tally = Tally("a million cycles", "fmu", "equal bit for bit to the second cycle", seed)
    draw = Random(f"million cycles {seed}")
    p = draws.with_lambda({"k": 1000.0, "m": 1.0, "g": 9.81, "mu_s": 0.5, "mu_k": 0.3}, 3.0)
    period = float(_undamped(p)["T"])
    wanted = _share(1_000_000, fraction)
    with Mover(fmu, (*names, "n_slips")) as mover:
        try:
            motion = mover.begin(p)
            second = yield from _cycled(motion, draw, period, 2)
            last = yield from _cycled(motion, draw, period, wanted)
        except FmuError as error:
            tally.refuse(str(error), p)
        else:
            if second is None or last is None:
                tally.refuse("too few slips for the time", p)
            else:
                same = {name: 0.0 if last[name] == second[name] else math.inf for name in names}
                tally.judge(same, f"{last} after {second}")
    yield tally.result()


def _cycled(
    motion: Motion, draw: Random, period: float, wanted: int
) -> Generator[None, None, State | None]:
    """Run on until so many slips are completed, in steps of 0.01 to 2000 T; None if they fail."""
    longest = 0.5 if wanted <= 2 else 2000.0
    while motion.time < (wanted + 2000.0) * period:
        motion.advance([period * draws.log_uniform(draw, 0.01, longest)])
        state = motion.state()
        if state["n_slips"] >= wanted:
            return state
        yield None
    return None


def _undamped(p: Values) -> Cycle:
    cycle = truth.steady_cycle(p)
    assert cycle is not None, "without damping the cycle exists at every speed"
    return cycle


def _share(whole: int, fraction: float) -> int:
    return max(1, round(whole * fraction))


def _conditioning(p: Values) -> float:
    return p["mu_s"] / (p["mu_s"] - p["mu_k"])


def _critical_lambda(zeta: float) -> float:
    try:
        critical = float(truth.critical_lambda(zeta, digits=20))
    except OverflowError:
        return math.inf
    # Beyond, the speed would be below any that a machine has: the set is about real ones.
    return critical if critical < 1e12 else math.inf


def _distance(p: Values) -> float:
    """Lambda/lambda_c - 1 of the point as it is in doubles, in high precision."""
    with mp.workdps(50):
        k, m, c = mpf(p["k"]), mpf(p["m"]), mpf(p["c"])
        zeta = c / (2 * mp.sqrt(k * m))
        if zeta >= 1:
            return -1.0
        gap = (mpf(p["mu_s"]) - mpf(p["mu_k"])) * m * mpf(p["g"]) / k
        lambda_ = mp.sqrt(k / m) * gap / mpf(p["v"])
        return float(lambda_ / truth.critical_lambda(zeta) - 1)


def _damped_bound(p: Values, d: float) -> dict[str, float]:
    basic = FMU_BOUND * _conditioning(p)
    grazing = basic * (1.0 + 1.0 / math.sqrt(d))
    return {
        "T": basic,
        "delta_x": basic,
        "t_slip": grazing,
        "t_stick": grazing,
        "spring_drop": grazing,
    }


def _moved(mover: Mover, p: Values, steps: Sequence[float]) -> State:
    motion = mover.begin(p)
    motion.advance(steps)
    return motion.state()


def _simulated(p: Values, end: float) -> State:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        trajectory = stickslip_ref.simulate(
            stickslip_ref.Parameters(**p), end, times=np.array([0.0, end])
        )
    return {name: float(getattr(trajectory, name)[-1]) for name in (*CYCLE, "n_slips")}


def _against(
    got: State, exact: Cycle, bound: Mapping[str, float], p: Values, end: float
) -> dict[str, float]:
    ratios = {name: relative(got[name], float(exact[name])) / bound[name] for name in CYCLE}
    travelled = relative(got["delta_x"], p["v"] * got["T"])
    ratios["delta_x = v T"] = travelled / bound["T"]
    ratios["number of slips"] = _miscounted(got["n_slips"], exact, p, end)
    return ratios


def _miscounted(n_slips: float, exact: Cycle, p: Values, end: float) -> float:
    """Infinity for a missed or invented slip, unless the end is within rounding of one."""
    first = (p["mu_s"] * p["m"] * p["g"] / p["k"] - p["z_start"]) / p["v"]
    turns = (end - first - float(exact["t_slip"])) / float(exact["T"]) + 1.0
    doubtful = abs(turns - round(turns)) < 1e-6
    return 0.0 if doubtful or n_slips == math.floor(turns) else math.inf


def _formula_ratios(p: Values, exact: Cycle | None, bound: Mapping[str, float]) -> dict[str, float]:
    own = {name: value for name, value in p.items() if name != "z_start"}
    cycle = stickslip_ref.steady_cycle(stickslip_ref.Parameters(**own))
    exists = bool(cycle.exists)
    ratios = {"existence": 0.0 if exists == (exact is not None) else math.inf}
    if exists and exact is not None:
        for name in CYCLE:
            ratios[name] = relative(float(getattr(cycle, name)), float(exact[name])) / bound[name]
    return ratios
