"""Event mode and early return of the native FMU in FMI 3.0."""

import fmpy
import numpy as np
import pytest

from stickslip_ref import Parameters, simulate
from tests.conftest import Sized, built
from tests.driver import Refused, loaded
from tests.native.eventful import BEGIN, course, differences
from tests.needs import needs

pytestmark = needs("cc")

DEFAULT = {"v": 0.2}


@pytest.mark.parametrize("law", ["coulomb", "stribeck"])
def test_runs_with_and_without_events_agree_to_the_last_bit(law: str, sized: Sized) -> None:
    for seed in range(sized(400)):
        assert not differences(str(built("native-3", law)), seed)


def test_a_step_stops_at_the_times_of_the_reference() -> None:
    run = simulate(Parameters(**DEFAULT), 1.5)
    times = [event.time for event in run.events]
    _, stops = course(loaded(built("native-3")), True, True, DEFAULT, {})
    assert len(times) > 6
    assert np.subtract(stops, BEGIN)[: len(times)] == pytest.approx(times, rel=1e-12)


@pytest.mark.parametrize(
    ("start", "step", "z_start", "stop"),
    [
        (0.0, 0.1, 0.004905, 0.0),
        (-0.24525, 1.0, 0.0, 0.0),
        (0.0, 1e9, 0.0, 0.24525),
        (0.0, 1e15, 0.0, 0.24525),
    ],
)
def test_a_step_finds_its_event_however_small_or_large_times_are(
    start: float, step: float, z_start: float, stop: float
) -> None:
    instance = loaded(built("native-3")).instance(early=True)
    instance.start(start, z_start=z_start)
    assert instance.step_to_event(step) == (False, True)
    assert instance.time == pytest.approx(stop, rel=1e-15, abs=1e-16)
    assert instance.get("mode") == [1]


def test_fmpy_records_both_limits_of_an_event() -> None:
    outputs = ["mode", "F_friction", "F_s", "x_dot"]
    modes = {"use_event_mode": True, "early_return_allowed": True}
    given = {"start_values": DEFAULT, "output": outputs, "stop_time": 2.0, "output_interval": 0.1}
    found = fmpy.simulate_fmu(str(built("native-3")), **given, **modes)
    first = int(np.flatnonzero(found["mode"])[0])
    assert found["time"][first - 1] == found["time"][first]
    assert found["mode"][first - 1 : first + 1].tolist() == [0, 1]
    assert found["F_friction"][first - 1 : first + 1] == pytest.approx([-4.905, -2.943])
    assert np.abs(found["x_dot"][first - 1 : first + 1]).max() < 1e-14


def test_a_tunable_parameter_changes_in_event_mode_alone_and_an_event_must_be_handled() -> None:
    fmu = loaded(built("native-3"))
    instance = fmu.instance(events=True, early=True)
    instance.start(**DEFAULT)
    assert instance.handle(enter=False) == pytest.approx(0.024525, rel=1e-15)
    instance.set(k=1000.0)
    with pytest.raises(Refused, match="k is tunable: it can change in event mode"):
        instance.set(k=2000.0)
    instance.reset()
    instance.start(**DEFAULT)
    instance.handle(enter=False)
    # A load that the mass cannot rest under is an event at once.
    instance.set(F_ext=6.0)
    assert instance.step_to_event(0.1) == (True, True)
    assert (instance.time, *instance.get("mode")) == (0.0, 0)
    with pytest.raises(Refused, match="stepping, with an event to handle"):
        instance.step(0.1)


def test_a_state_goes_where_event_mode_is_as_it_was() -> None:
    fmu = loaded(built("native-3"))
    one, other, plain = (fmu.instance(events=events) for events in (True, True, False))
    one.start(**DEFAULT)
    data = one.pack()
    other.resume(data)
    assert other.pack() == data
    other.update()
    with pytest.raises(Refused, match="with event mode or for model exchange"):
        plain.resume(data)
    with pytest.raises(Refused, match="was made without event mode"):
        fmu.started().call("EnterEventMode")
