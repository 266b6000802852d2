"""The native FMUs under a solver of the importer's."""

import ctypes as c
import random
from functools import cache
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.simulation import instantiate_fmu

from stickslip_ref import Parameters, critical_velocity
from tests.conftest import Sized, built
from tests.driver import loaded
from tests.needs import needs

pytestmark = needs("cc")

LAWS = ["coulomb", "stribeck"]
INPUTS = [(name, float) for name in ("time", "v", "load", "F_ext")]


@cache
def opened(fmu: Path) -> tuple[str, Any]:
    folder = fmpy.extract(str(fmu))
    return folder, fmpy.read_model_description(folder)


faces = pytest.mark.parametrize("kind", ["native-3", "native-2me"])


def both(one: Path, other: Path, tolerance: float, **given: Any) -> tuple[Any, Any]:
    folder, description = opened(one)
    names = [each.name for each in description.modelVariables if each.causality == "output"]
    given |= {"output": names, "model_description": description}
    stepped = fmpy.simulate_fmu(folder, fmi_type="CoSimulation", **given)
    more = {"fmi_type": "ModelExchange", "relative_tolerance": tolerance, "record_events": False}
    folder, given["model_description"] = opened(other)
    return stepped, fmpy.simulate_fmu(folder, **given, **more)


@faces
@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8, 1e-10])
def test_no_slip_of_the_cycle_is_lost(tolerance: float, kind: str) -> None:
    stepped, solved = both(
        built("native-3"), built(kind), tolerance, stop_time=10.0, output_interval=0.01
    )
    assert solved["n_slips"][-1] == stepped["n_slips"][-1] == 31
    assert np.abs(solved["x"] - stepped["x"]).max() < 100.0 * tolerance * stepped["x"].max()
    assert solved["T"][-1] == pytest.approx(stepped["T"][-1], rel=100.0 * tolerance)


@pytest.mark.parametrize("below", [1e-3, 1e-5, 1e-7, 1e-9, -1e-9, -1e-3])
def test_no_cycle_is_lost_near_the_critical_velocity(below: float) -> None:
    (cycle,) = critical_velocity(Parameters(c=4.0)).cycle
    start = {"c": 4.0, "v": cycle.high * (1.0 - below)}
    given = {"stop_time": 5.0, "output_interval": 0.1, "start_values": start}
    stepped, solved = both(built("native-3"), built("native-3"), 1e-6, **given)
    assert solved["n_slips"].tolist() == stepped["n_slips"].tolist()
    assert (stepped["n_slips"][-1] > 20) == (below > 0.0)


def test_a_mass_that_needs_no_force_to_break_away_rests_while_that_grows() -> None:
    start = {"tau_s": 0.2, "mu_k": 0.0, "mu_s": 0.3, "k": 100.0, "m": 5.0, "c": 2.0}
    given = {"stop_time": 10.0, "output_interval": 0.1, "start_values": start}
    stepped, solved = both(built("native-3"), built("native-3"), 1e-8, **given)
    assert solved["n_slips"][-1] == stepped["n_slips"][-1] == 3
    assert np.abs(solved["x"] - stepped["x"]).max() < 1e-6


def of_random_settings(one: Path, other: Path, seed: int) -> tuple[Any, Any]:
    chance = random.Random(seed)
    start = {"k": chance.choice([200.0, 1e3, 5e3]), "c": chance.choice([0.0, 0.0, 2.0, 8.0])}
    start |= {"mu_s": chance.uniform(0.3, 0.6), "mu_k": chance.uniform(0.05, 0.3)}
    start["z_start"] = chance.choice([0.0, 0.0, 0.01, -0.01, 0.03])
    start["x_dot_start"] = chance.choice([0.0, 0.0, 0.0, 0.05, -0.05])
    if any(each.name == "shape" for each in opened(one)[1].modelVariables):
        start["shape"] = chance.choice([1, 2, 3])
        if start["shape"] == 3:
            start |= {"mu_1": 0.9 * start["mu_s"], "u_2": 0.05, "mu_2": 0.1}
    else:
        start["B"] = chance.choice([0.0, 0.05])
    times = sorted(round(chance.uniform(0.2, 3.8), 2) for _ in range(chance.choice([0, 1, 3])))
    held = [(chance.choice([0.0, chance.uniform(0.005, 0.2)]), 0.0, 0.0)]
    held += [(chance.uniform(-0.05, 0.2), chance.uniform(-1, 4), 0.5) for _ in times]
    points = [(t, *held[n + i]) for n, t in enumerate(times) for i in (0, 1)]
    signals = np.array([(0.0, *held[0]), *points, (9.0, *held[-1])], INPUTS)
    given = {"stop_time": 4.0, "output_interval": 0.01, "start_values": start}
    return both(one, other, 1e-8, input=signals, **given)


@pytest.mark.parametrize("law", LAWS)
def test_a_solver_finds_the_motion_of_random_settings(law: str, sized: Sized) -> None:
    for seed in range(sized(100)):
        kind = "native-3" if seed % 3 else "native-2me"
        stepped, solved = of_random_settings(built("native-3", law), built(kind, law), seed)
        assert solved["n_slips"].tolist() == stepped["n_slips"].tolist(), seed
        scale = np.abs(stepped["x"]).max() + np.abs(stepped["z"]).max()
        assert np.abs(solved["x"] - stepped["x"]).max() <= 2e-6 * scale, seed


def initialized(fmu: Path, **values: float) -> tuple[Any, dict[str, int]]:
    folder, description = opened(fmu)
    number = {each.name: each.valueReference for each in description.modelVariables}
    instance = instantiate_fmu(folder, description, fmi_type="ModelExchange")
    instance.setFloat64([number[name] for name in values], list(values.values()))
    instance.enterInitializationMode()
    instance.exitInitializationMode()
    return instance, number


def retuned(fmu: Path, *stiffnesses: float) -> list[tuple[Any, ...]]:
    """Return mode, n_slips, F and W_k after k took each of these values in event mode, at rest."""
    instance, number = initialized(fmu, z_start=0.0045)
    shown = []
    for k in stiffnesses:
        instance.setFloat64([number["k"]], [k])
        instance.updateDiscreteStates()
        instance.enterContinuousTimeMode()
        values = instance.getFloat64([number["F"], number["W_k"]])
        mode = instance.getInt64([number["mode"]])
        shown.append((*mode, *instance.getInt32([number["n_slips"]]), *values))
        instance.enterEventMode()
    instance.terminate()
    instance.freeInstance()
    return shown


def test_a_spring_that_is_made_stiffer_and_softer_in_event_mode_stores_what_it_was_given() -> None:
    one, two, three = retuned(built("native-3"), 1000.0, 2000.0, 1000.0)
    work = 0.5 * 1000.0 * 0.0045**2
    assert one == (0, 0, pytest.approx(4.5), 0.0)
    assert two == (1, 0, pytest.approx(9.0), pytest.approx(work))
    # A slip of no length has not begun.
    assert three == (0, 0, pytest.approx(4.5), pytest.approx(0.0, abs=1e-18))


@pytest.mark.parametrize("x_dot", [0.0, 0.1, -0.1])
def test_what_moves_with_a_state_or_input_names_it_as_a_dependency(x_dot: float) -> None:
    _, description = opened(built("native-3"))
    unknowns = [*description.outputs, *description.derivatives, *description.eventIndicators]
    reals = {each.variable.name: each for each in unknowns if each.variable.type == "Float64"}
    instance, number = initialized(built("native-3"), z_start=0.001, x_dot_start=x_dot)
    instance.updateDiscreteStates()
    instance.enterContinuousTimeMode()
    states = (c.c_double * 5)()
    for n, known in enumerate(("x", "x_dot", "z", "W_pull", "Q_friction", "v", "load", "F_ext")):
        before = instance.getFloat64([number[name] for name in reals])
        instance.getContinuousStates(states, 5)
        if n < 5:
            states[n] += 0.01
            instance.setContinuousStates(states, 5)
        else:
            instance.setFloat64([number[known]], [0.5])
        after = instance.getFloat64([number[name] for name in reals])
        moved = {name for name, *pair in zip(reals, before, after, strict=True) if len({*pair}) > 1}
        named = {name for name, of in reals.items() if known in {d.name for d in of.dependencies}}
        assert moved <= named, known
    instance.freeInstance()


@pytest.mark.parametrize("law", LAWS)
def test_the_acceleration_is_that_of_the_forces(law: str) -> None:
    instance = loaded(built("native-3", law)).started(v=0.3, c=1.5, m=2.0, F_ext=0.4)
    for _ in range(50):
        instance.step(0.02)
        rate, z_dot, x_dot, *forces = instance.get("x_ddot", "z_dot", "x_dot", "F", "F_friction")
        assert rate == pytest.approx((sum(forces) + 0.4) / 2.0, abs=1e-11)
        assert z_dot == 0.3 - x_dot
