"""What is said of records that the model does not explain, and of a twin of a real one."""

import numpy as np
import pytest

from stickslip_design.identify.study import identify
from stickslip_design.one_thread import one_thread
from tests.design.identified.others import TRUTH, made, others, recorded, twin

pytestmark = pytest.mark.gate


@one_thread
def test_no_number_of_a_record_of_others_is_wrong_and_called_known() -> None:
    wrong, records = [], list(others())
    for name, kind, record in records:
        try:
            result = identify(record, None)
        except ValueError:
            continue
        if result.explained:
            # Twice its interval, 4 standard deviations: of 40 records no number is there by chance.
            wrong += [
                (kind, name, q.name, q.low, TRUTH[q.name], q.high) for q in result.numbers
                if q.identified
                and q.name in TRUTH and abs(TRUTH[q.name] - q.value) > q.high - q.low
            ]  # fmt: skip
    assert len(records) == 40
    assert not wrong


@one_thread
@pytest.mark.parametrize("name", ["tanh", "LuGre", "Stribeck"])
def test_steady_runs_tell_viscous_friction_beside_friction_that_falls(name: str) -> None:
    result = identify(recorded(made("steady runs", name, np.random.default_rng(1))), None)
    assert result.friction is not None
    assert "falls" in result.friction.name
    for number in map(result.number, ("axis.c", "friction.F_k")):
        assert number.low <= TRUTH[number.name] <= number.high
        assert number.identified


@one_thread
def test_friction_that_falls_near_rest_is_said_and_moves_no_number_of_an_excitation() -> None:
    result = identify(recorded(made("excitation", "LuGre", np.random.default_rng(2))), None)
    assert "friction is bent near rest" in result.faults
    for number in map(result.number, ("axis.mass", "axis.c", "friction.F_k")):
        assert number.low <= TRUTH[number.name] <= number.high


@one_thread
def test_a_twin_of_a_real_record_tells_its_numbers_and_that_its_directions_differ() -> None:
    result = identify(twin(), None)
    assert result.kind == "excitation"
    truth = {"axis.mass": 95.1, "friction.F_k": 20.4, "c forward": 167.0, "c backward": 241.0}
    for name, value in truth.items():
        assert result.number(name).low <= value <= result.number(name).high, name
        assert result.number(name).identified
    assert result.number("c forward").high < result.number("c backward").low
    assert result.number("axis.force_along").low <= 0.2 <= result.number("axis.force_along").high
    assert any("direction" in note for note in result.notes)
    assert any("the residual is not white" in note for note in result.notes)
    assert "friction.F_s" in dict(result.missing)
