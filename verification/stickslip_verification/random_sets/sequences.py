"""Random tests about input sequences: splitting of steps, exactness, energy, scaling and mirror."""

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from random import Random

from stickslip_verification import truth
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.model.quantities import OUTPUT_NAMES, QUANTITIES
from stickslip_verification.model.symmetries import (
    ENERGIES,
    FORCES,
    HEAVIER,
    LENGTHS,
    MIRROR,
    QUICKER,
    SPEEDS,
    TIMES,
    Symmetry,
)
from stickslip_verification.random_sets import draws
from stickslip_verification.random_sets.draws import Interval
from stickslip_verification.random_sets.mover import Mover, State
from stickslip_verification.random_sets.tally import RandomTestResult, Tally

SEQUENCES = 5000
TUNED = 1000
SPLIT_BOUND = 1e-12
TRUTH_BOUND = 1e-10
ENERGY_BOUND = 1e-11
SMALLEST_MARGIN = 1e-9
"""Draws that pass an event by less, relative to scale, are decided by rounding: left out."""
MANY = 1_000_000

MEASURED = (*LENGTHS, *SPEEDS, *FORCES, *TIMES, *ENERGIES)
COUNTED = tuple(name for name in OUTPUT_NAMES if QUANTITIES[name].discrete)


def split_and_truth(
    fmu: Path, seed: int, fraction: float, *, tunable: bool = False
) -> Iterator[RandomTestResult | None]:
    """Prove that one step and the same split give one motion, and that it is the exact one.

    With `tunable` the parameters k, c, mu_s and mu_k change on the way as well as the inputs.
    Yields None after each draw, and the two results at last.
    """
    what = ", parameters changing too" if tunable else ""
    kind, whole_set = ("tuned ", TUNED) if tunable else ("", SEQUENCES)
    splitting = Tally(
        f"one step or many{what}",
        "fmu",
        "1e-12 of the motion's scale, steps down to 1e-13 s",
        seed,
        most_left_out=0.01,
    )
    exactness = Tally(
        f"any input sequence{what}", "fmu", "1e-10 of the motion's scale", seed, most_left_out=0.01
    )
    with Mover(fmu, OUTPUT_NAMES) as mover:
        for n in range(_share(whole_set, fraction)):
            draw = Random(f"{kind}sequence {n} of {seed}")
            motion = draws.sequence(draw, tunable=tunable)
            exact = None if _crept_out(motion) else _exact(motion.parameters, motion.intervals)
            if exact is None or exact.margin < SMALLEST_MARGIN:
                splitting.leave_out()
                exactness.leave_out()
                yield None
                continue
            samples = [{k: float(v) for k, v in sample.items()} for sample in exact.samples]
            scale = scales(motion, samples)
            pieces = [draws.split(draw, interval.h) for interval in motion.intervals]
            if n == 0 and not tunable:
                longest = max(range(len(pieces)), key=lambda i: motion.intervals[i].h)
                pieces[longest] = draws.split(
                    draw, motion.intervals[longest].h, _share(MANY, fraction)
                )
            try:
                whole = _run(mover, motion, [[interval.h] for interval in motion.intervals])
                cut = _run(mover, motion, pieces)
            except FmuError as error:
                splitting.refuse(str(error), motion)
                exactness.refuse(str(error), motion)
            else:
                splitting.judge(apart(cut, whole, scale, SPLIT_BOUND), motion)
                exactness.judge(apart(whole, samples, scale, TRUTH_BOUND), motion)
            yield None
    yield splitting.result()
    yield exactness.result()


def energy(fmu: Path, seed: int, fraction: float) -> Iterator[RandomTestResult | None]:
    """Prove that the energy account closes while inputs and tunable parameters change."""
    tally = Tally(
        "energy account", "fmu", "1e-11 of the largest of |W_pull|, Q_friction, stored", seed
    )
    with Mover(fmu, OUTPUT_NAMES) as mover:
        for n in range(_share(SEQUENCES, fraction)):
            draw = Random(f"tuned sequence {n} of {seed}")
            motion = draws.sequence(draw, tunable=True)
            pieces = [
                [interval.h / 7] * 7 if draw.random() < 0.5 else [interval.h]
                for interval in motion.intervals
            ]
            try:
                tally.judge({"balance": _imbalance(mover, motion, pieces)}, motion)
            except FmuError as error:
                tally.refuse(str(error), motion)
            yield None
    yield tally.result()


def no_hidden_scale(fmu: Path, seed: int, fraction: float) -> Iterator[RandomTestResult | None]:
    """Prove that mirror, forces times 4 and time halved give the same motion bit for bit."""
    symmetries = (MIRROR, HEAVIER, QUICKER)
    tallies = [Tally(each.name, "fmu", "equal bit for bit", seed) for each in symmetries]
    with Mover(fmu, OUTPUT_NAMES) as mover:
        for n in range(_share(SEQUENCES, fraction)):
            draw = Random(f"scaled sequence {n} of {seed}")
            motion = draws.sequence(draw, tunable=True)
            pieces = [draws.split(draw, interval.h)[:20] for interval in motion.intervals]
            for tally, symmetry in zip(tallies, symmetries, strict=True):
                try:
                    plain = _run(mover, motion, pieces)
                    changed = _run(
                        mover,
                        _scaled(motion, symmetry),
                        [[h * symmetry.pace for h in steps] for steps in pieces],
                    )
                except FmuError as error:
                    tally.refuse(str(error), motion)
                else:
                    tally.judge(_unequal(changed, plain, symmetry.outputs), motion)
            yield None
    for tally in tallies:
        yield tally.result()


def scales(motion: draws.Sequence, samples: Sequence[State]) -> dict[str, float]:
    """Return the scale of each output: the largest magnitude of its kind over the motion."""

    def largest(names: Sequence[str]) -> float:
        return max(abs(sample[name]) for sample in samples for name in names)

    speeds = [abs(motion.parameters["v"])]
    speeds += [abs(i.changes["v"]) for i in motion.intervals if "v" in i.changes]
    elapsed = math.fsum(interval.h for interval in motion.intervals)
    groups = (
        (LENGTHS, largest(LENGTHS)),
        (SPEEDS, max(largest(SPEEDS), *speeds)),
        (FORCES, largest(FORCES)),
        (TIMES, elapsed),
        (ENERGIES, largest(ENERGIES)),
    )
    return {name: size for names, size in groups for name in names}


def apart(
    got: Sequence[State], expected: Sequence[State], scale: Mapping[str, float], bound: float
) -> dict[str, float]:
    """Return the distance of two motions over the bound, by output; inf where counts differ."""
    ratios = dict.fromkeys((*MEASURED, *COUNTED), 0.0)
    for one, other in zip(got, expected, strict=True):
        for name in MEASURED:
            distance = abs(one[name] - other[name])
            ratio = distance / (bound * scale[name]) if distance else 0.0
            ratios[name] = max(ratios[name], math.inf if math.isnan(ratio) else ratio)
        for name in COUNTED:
            if one[name] != other[name]:
                ratios[name] = math.inf
    return ratios


def _share(whole: int, fraction: float) -> int:
    return max(1, round(whole * fraction))


def _exact(parameters: Mapping[str, float], intervals: Sequence[Interval]) -> truth.Run:
    return truth.run(parameters, [truth.Step(i.h, dict(i.changes)) for i in intervals])


def _crept_out(motion: draws.Sequence) -> bool:
    """Whether a change meets a mass that creeps slower than `SMALLEST_MARGIN` of the speeds.

    Over-damped and with the pull at rest it slows down without end and never stops: once what is
    left of its speed is lost in rounding, only rounding decides whether the next change finds it
    moving or at rest.
    """
    values = dict(motion.parameters)
    fastest = abs(values["v"])
    for n, interval in enumerate(motion.intervals[:-1]):
        values |= interval.changes
        fastest = max(fastest, abs(values["v"]))
        overdamped = values.get("c", 0.0) ** 2 >= 4.0 * values["k"] * values["m"]
        if values["v"] == 0.0 and overdamped:
            so_far = _exact(motion.parameters, motion.intervals[: n + 1])
            left = abs(so_far.samples[-1]["x_dot"])
            if 0.0 < left < SMALLEST_MARGIN * fastest:
                return True
    return False


def _run(mover: Mover, motion: draws.Sequence, pieces: Sequence[Sequence[float]]) -> list[State]:
    run = mover.begin(motion.parameters)
    states = []
    for interval, steps in zip(motion.intervals, pieces, strict=True):
        run.advance(steps, interval.changes)
        states.append(run.state())
    return states


def _scaled(motion: draws.Sequence, symmetry: Symmetry) -> draws.Sequence:
    return draws.Sequence(
        symmetry.scaled(motion.parameters),
        tuple(Interval(i.h * symmetry.pace, symmetry.scaled(i.changes)) for i in motion.intervals),
    )


def _unequal(
    changed: Sequence[State], plain: Sequence[State], factors: Mapping[str, float]
) -> dict[str, float]:
    ratios = dict.fromkeys(OUTPUT_NAMES, 0.0)
    for one, other in zip(changed, plain, strict=True):
        for name in OUTPUT_NAMES:
            if one[name] != other[name] * factors.get(name, 1.0):
                ratios[name] = math.inf
    return ratios


def _imbalance(mover: Mover, motion: draws.Sequence, pieces: Sequence[Sequence[float]]) -> float:
    """Largest gap in the energy account over its bound; every sum is compensated."""
    values = dict(motion.parameters)
    run = mover.begin(motion.parameters)
    before = run.state()
    stored_at_start = _stored(values, before)
    pushed: list[float] = []
    largest = max(stored_at_start)
    worst = 0.0
    for interval, steps in zip(motion.intervals, pieces, strict=True):
        values |= interval.changes
        changes = interval.changes
        for h in steps:
            run.advance([h], changes)
            changes = {}
            after = run.state()
            push = values.get("F_ext", 0.0)
            pushed += [push * after["x"], -push * before["x"]]
            stored = _stored(values, after)
            gap = math.fsum(
                [after["W_pull"], after["W_k"], -after["Q_friction"], *pushed]
                + [-energy for energy in stored]
                + list(stored_at_start)
            )
            largest = max(largest, abs(after["W_pull"]), after["Q_friction"], *stored)
            if gap:
                worst = max(worst, abs(gap) / (ENERGY_BOUND * largest) if largest else math.inf)
            if math.isnan(gap):
                return math.inf
            before = after
    return worst


def _stored(values: Mapping[str, float], state: State) -> tuple[float, float]:
    return 0.5 * values["k"] * state["z"] ** 2, 0.5 * values["m"] * state["x_dot"] ** 2
