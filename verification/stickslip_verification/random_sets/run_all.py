"""All random tests, in one call."""

from collections.abc import Callable, Iterator
from pathlib import Path

from stickslip_verification.random_sets import cycles, sequences
from stickslip_verification.random_sets.tally import RandomTestResult

Progress = Callable[[str, int, int], None]


def prove(
    fmu: Path, seed: int = 1, fraction: float = 1.0, progress: Progress | None = None
) -> list[RandomTestResult]:
    """Run every random set against an FMU and the reference.

    Parameters
    ----------
    fmu
        The ``.fmu`` file.
    seed
        Names the sets: the same seed draws the same numbers.
    fraction
        Share of the full sets, above 0 and at most 1; the first draws of each are taken.
    progress
        Called with the name of the set, the draws done, and their number as far as it is known
        (0 where not).

    Raises
    ------
    FmuError
        The file is not an FMU that can be driven at all.
    ValueError
        `fraction` is out of range.
    """
    if not 0.0 < fraction <= 1.0:
        raise ValueError(f"fraction = {fraction}: must be above 0 and at most 1")
    results: list[RandomTestResult] = []
    for name, count, running in _proofs(fmu, seed, fraction):
        for done, result in enumerate(running):
            if progress is not None:
                progress(name, min(done, count) if count else done, count)
            if result is not None:
                results.append(result)
    return results


def _proofs(
    fmu: Path, seed: int, fraction: float
) -> Iterator[tuple[str, int, Iterator[RandomTestResult | None]]]:
    points = round((cycles.POINTS + cycles.SHALLOW_POINTS) * fraction)
    damped = round(cycles.DAMPED_POINTS * fraction)
    motions = round(sequences.SEQUENCES * fraction)
    yield "steady cycle, FMU", points, cycles.fmu_cycle(fmu, seed, fraction)
    yield "steady cycle, reference", points, cycles.reference_cycle(seed, fraction)
    yield "steady cycle, formulas", points, cycles.reference_formulas(seed, fraction)
    yield "damped cycle", damped, cycles.damped_cycle(fmu, seed, fraction)
    yield "input sequences", motions, sequences.split_and_truth(fmu, seed, fraction)
    tuned = sequences.split_and_truth(fmu, seed, fraction, tunable=True)
    yield "parameters changing", round(sequences.TUNED * fraction), tuned
    yield "energy", motions, sequences.energy(fmu, seed, fraction)
    yield "no hidden scale", motions, sequences.no_hidden_scale(fmu, seed, fraction)
    yield "a million cycles", 0, cycles.million_cycles(fmu, seed, fraction)
