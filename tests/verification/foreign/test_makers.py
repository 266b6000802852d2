"""The foreign FMUs follow the exact motion; with a fault planted they do not."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from random import Random

import pytest

from stickslip_verification import truth
from stickslip_verification.drive.fmu.archive import FmuFile, available
from stickslip_verification.drive.fmu.instance import FmuInstance
from stickslip_verification.drive.stepping import Setting, run
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.random_sets import draws
from stickslip_verification.random_sets.sequences import scales
from stickslip_verification.suite.experiment import CommunicationStep
from tests.verification.foreign import makers
from tests.verification.foreign.makers import CALLING_PATTERNS, COMBINATIONS, MAKERS

SEQUENCES = 20

# Some hundred steps a slip that leave 1e-14 each; rounding. A shallow stop amplifies both.
BOUNDS = {"runge_kutta": 1e-8, "taylor": 3e-12, "renamed": 3e-12, "exact_in_c": 3e-12}

# Sequences in which an event hangs on less are left to the rounding of each solution.
SMALLEST_MARGIN = 1e-6

# Outputs for which `renamed` has conventions of its own.
OF_CONVENTION = {"delta_x", "t_stick", "t_slip", "T", "f", "t_event"}

Values = Mapping[str, float]


@pytest.fixture(scope="module", params=MAKERS)
def maker(request: pytest.FixtureRequest) -> str:
    """Return the name of a foreign FMU."""
    return str(request.param)


@pytest.fixture(scope="module")
def opened(maker: str, tmp_path_factory: pytest.TempPathFactory) -> FmuFile:
    """Return the faultless foreign FMU."""
    path = makers.make(maker, tmp_path_factory.mktemp(maker))
    return FmuFile(path, makers.names_of(maker))


def sequences(fmu: FmuFile, seed: str) -> Iterator[tuple[Values, Sequence[CommunicationStep]]]:
    """Yield random sequences of the variables that an FMU has, split into uneven steps."""
    tunable = fmu.variables["k"].variability == "tunable"
    for n in range(SEQUENCES):
        draw = Random(f"{seed} {n}")
        motion = draws.sequence(draw, tunable=tunable)
        parameters = {name: value for name, value in motion.parameters.items() if fmu.has(name)}
        steps = []
        for interval in motion.intervals:
            first, *others = draws.split(draw, interval.h, 8)
            steps.append(CommunicationStep(first, interval.changes))
            steps += [CommunicationStep(h, {}) for h in others]
        yield parameters, steps


def deviations(
    fmu: FmuFile, parameters: Values, steps: Sequence[CommunicationStep]
) -> dict[str, float] | None:
    """Return by how much each output leaves the exact motion, over its scale.

    None where rounding may decide an event.
    """
    values = {**truth.START_VALUES, **parameters}
    intervals = tuple(draws.Interval(step.h, step.changes) for step in steps)
    exact = truth.run(values, [truth.Step(step.h, step.changes) for step in steps])
    if exact.margin < SMALLEST_MARGIN:
        return None
    samples = [{name: float(value) for name, value in each.items()} for each in exact.samples]
    got = run(fmu, Setting({name: values[name] for name in available(fmu, values)}, steps)).outputs
    names = available(fmu, OUTPUT_NAMES)
    scale = {
        # Counts and coefficients as they are; a frequency by its own size.
        **{name: max(1.0, *(abs(each[name]) for each in samples)) for name in names},
        **scales(draws.Sequence(values, intervals), samples),
    }
    return {
        name: max(abs(a - b[name]) for a, b in zip(got[name], samples, strict=True)) / scale[name]
        for name in names
    }


def test_a_foreign_fmu_follows_the_exact_motion(maker: str, opened: FmuFile) -> None:
    """Random inputs, damping, tunable parameters and steps: within the bound of its method."""
    judged = 0
    for parameters, steps in sequences(opened, maker):
        found = deviations(opened, parameters, steps)
        if found is not None:
            judged += 1
            if maker == "renamed":
                found = {name: value for name, value in found.items() if name not in OF_CONVENTION}
            assert max(found.values()) <= BOUNDS[maker], (found, parameters, steps)
    assert judged > SEQUENCES // 2


def test_without_its_conventions_the_renamed_block_is_the_exact_one(tmp_path: Path) -> None:
    """Every output, the meter and the clamp as well, follows the exact motion to rounding."""
    path = makers.make("renamed", tmp_path, conventions=False)
    fmu = FmuFile(path, makers.names_of("renamed"))
    clamped = {"mu_s": 0.3, "mu_k": 0.5}, [CommunicationStep(0.05, {})] * 20
    for parameters, steps in (clamped, *sequences(fmu, "plain")):
        found = deviations(fmu, parameters, steps)
        assert found is None or max(found.values()) <= BOUNDS["renamed"], (found, parameters)


def test_the_renamed_block_differs_by_its_conventions(tmp_path: Path) -> None:
    """Outputs of 0 at the start, -1 for what is not known yet, and another clamp."""
    fmu = FmuFile(makers.make("renamed", tmp_path), makers.names_of("renamed"))
    with fmu.instantiate() as instance:
        instance.start({**truth.START_VALUES, "z_start": 0.003, "mu_k": 0.6})
        read = instance.reader(["z", "T", "t_event", "t_stick", "mu_k_used"])
        assert read() == [0.0] * 5
        instance.step(0.0, 0.001)
        assert read() == [pytest.approx(0.00302), -1.0, -1.0, -1.0, 0.5]


SHOWS_COMBINATION = {
    "runge_kutta": ({"z_start": 0.006, "c": 3.0}, {"F_ext": 1.0}),
    "taylor": ({"z_start": -0.006, "v": -0.02}, {"load": -4.0}),
    "renamed": ({"z_start": 0.08, "v": 0.0, "c": 3.0}, {}),
    "exact_in_c": ({"z_start": 0.006}, {"load": 3.0, "F_ext": 1.0}),
}
"""Foreign FMU to parameters and a change after 30 ms in which its first fault shows."""


@pytest.mark.parametrize("fault", ["", "planted"])
def test_a_fault_of_combination_shows_where_things_meet(
    maker: str, fault: str, tmp_path: Path
) -> None:
    """In a sequence that has what the fault needs, only the twin leaves the exact motion."""
    path = makers.make(maker, tmp_path, COMBINATIONS[maker] if fault else "")
    parameters, change = SHOWS_COMBINATION[maker]
    steps = [CommunicationStep(0.004, change if n == 8 else {}) for n in range(100)]
    found = deviations(FmuFile(path, makers.names_of(maker)), parameters, steps)
    assert found is not None
    assert (found["x"] > 1e-3) == bool(fault), found


def state_between(fmu: FmuInstance) -> float:
    """Set an input, take the state, go on, go back, and go on again."""
    fmu.start(truth.START_VALUES)
    fmu.step(0.0, 0.01)
    fmu.set({"v": 0.05})
    state = fmu.get_state()
    fmu.step(0.01, 0.01)
    fmu.set_state(state)
    fmu.step(0.01, 0.01)
    fmu.free_state(state)
    return fmu.reader(["F"])()[0]


def unread(fmu: FmuInstance) -> float:
    """Take a step without reading, change an input, and take another one."""
    fmu.start({"z_start": 0.001})
    fmu.step(0.0, 0.01)
    fmu.set({"v": 0.05})
    fmu.step(0.01, 0.01)
    return fmu.reader(["F"])()[0]


def kinetic_first(fmu: FmuInstance) -> float:
    """Set mu_k above the default of mu_s, and then mu_s above it."""
    fmu.set({"mu_k": 0.8})
    fmu.set({"mu_s": 1.0})
    fmu.start({"z_start": 0.015})
    fmu.step(0.0, 0.02)
    return fmu.reader(["x"])()[0]


def after_reset(fmu: FmuInstance) -> float:
    """Run with a heavy mass, reset, and run with a light one."""
    fmu.start({**truth.START_VALUES, "m": 4.0})
    fmu.step(0.0, 0.01)
    fmu.reset()
    fmu.start({**truth.START_VALUES, "z_start": 0.008})
    fmu.step(0.0, 0.02)
    return fmu.reader(["x"])()[0]


PATTERNS: Mapping[str, tuple[Callable[[FmuInstance], float], str, Values, Sequence[truth.Step]]] = {
    "runge_kutta": (state_between, "F", {}, [truth.Step(0.01), truth.Step(0.01, {"v": 0.05})]),
    "taylor": (unread, "F", {"z_start": 0.001}, [truth.Step(0.01), truth.Step(0.01, {"v": 0.05})]),
    "renamed": (
        kinetic_first, "x", {"mu_k": 0.8, "mu_s": 1.0, "z_start": 0.015}, [truth.Step(0.02)],
    ),
    "exact_in_c": (after_reset, "x", {"z_start": 0.008}, [truth.Step(0.02)]),
}  # fmt: skip
"""Foreign FMU to a pattern of calls, what it reads at last, and the same for the truth."""


@pytest.mark.parametrize("fault", ["", "planted"])
def test_a_fault_of_calling_shows_in_its_pattern(maker: str, fault: str, tmp_path: Path) -> None:
    """In the pattern of calls that the fault is about the twin alone is wrong."""
    path = makers.make(maker, tmp_path, CALLING_PATTERNS[maker] if fault else "")
    pattern, output, parameters, steps = PATTERNS[maker]
    exact = float(truth.run(parameters, steps).samples[-1][output])
    with FmuFile(path, makers.names_of(maker)).instantiate() as instance:
        error = abs(pattern(instance) - exact) / abs(exact)
    assert (error > 1e-2) == bool(fault)
    assert fault or error <= BOUNDS[maker]
