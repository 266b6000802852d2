"""What a refusal and a warning say, where, and how often."""

from typing import Any

import pytest

from tests.conftest import built, kinds
from tests.driver import ERROR, Host, play
from tests.fmu.acts import flags_of_a_step, without_standard_error
from tests.needs import needs

START: list[Any] = ["start", {}]
REAL = {2: "Real", 3: "Float64"}
INTEGER = {2: "Integer", 3: "Int64"}
MODE = 20


def setting(**values: float) -> list[Any]:
    return ["set", values]


REFUSED: list[tuple[list[Any], list[Any], str]] = [
    ([START], setting(k=-1.0), "k = -1.0 N/m is out of range: it must be finite and above 0"),
    ([START], setting(v=float("nan")), "v = nan m/s is out of range: it must be a finite number"),
    ([], setting(mu_s=-0.1), "mu_s = -0.1 is out of range: it must be finite and at least 0"),
    ([START], setting(load=-10.0), "load = -10.0 N is out of range: it must be at least -m g = -"),
    ([START], setting(m=2.0), "m is fixed: it cannot change after initialization"),
    ([START], setting(x=1.0), "x is an output: it cannot be set"),
    ([START, ["terminate"]], setting(k=2e3), "k cannot be set: the simulation is terminated"),
    ([START], ["step", -1.0], "step size h = -1.0 s is out of range: above 0 and finite"),
    ([], ["step", 0.1], "doStep is not allowed here: the instance is in phase instantiated"),
    ([], ["call", "ExitInitializationMode"], "exitInitializationMode is not allowed here"),
    (
        [START],
        ["values", "Get", REAL, [4_000_000], [0]],
        "is no variable with value reference 4000",
    ),
    ([START], ["values", "Get", REAL, [MODE], [0]], f"mode is of type {INTEGER}, not {REAL}"),
]
REFUSED_BY_STRIBECK = [
    (
        setting(shape=4),
        "shape = 4 is out of range: it must be one of 1 (Stribeck), 2 (Hyperbolic), 3 (Curve)",
    ),
    (setting(n_points=13), "n_points = 13 is out of range"),
]


def refused(host: Host, kind: str, law: str, before: list[Any], call: list[Any], text: str) -> None:
    host.errors()
    *_, first, again = host.call(play, built(kind, law), [*before, call, call])
    assert text in first["messages"][-1]
    assert again == first
    written = host.errors().count(text)
    assert written == (0 if kind.startswith("native") else 1)


@pytest.mark.parametrize(("before", "call", "text"), REFUSED, ids=[row[2] for row in REFUSED])
@pytest.mark.parametrize("kind", kinds())
def test_a_refusal_names_variable_value_and_range(
    kind: str, before: list[Any], call: list[Any], text: str, host: Host
) -> None:
    version = int(kind[-1])
    for names in (REAL, INTEGER):
        call = [names[version] if each is names else each for each in call]
        text = text.replace(str(names), names[version])
    refused(host, kind, "coulomb", before, call, text)


@pytest.mark.parametrize(("call", "text"), REFUSED_BY_STRIBECK)
@pytest.mark.parametrize("kind", kinds())
def test_a_refused_whole_number_is_told_what_it_may_be(
    kind: str, call: list[Any], text: str, host: Host
) -> None:
    refused(host, kind, "stribeck", [], call, text)


@pytest.mark.parametrize("kind", kinds())
def test_a_start_time_is_finite(kind: str, host: Host) -> None:
    text = "start time = nan s is out of range: a finite number"
    refused(host, kind, "coulomb", [], ["enter", float("nan")], text)


@needs("cc")
def test_the_time_cannot_be_set(host: Host) -> None:
    text = "time is the independent variable: it cannot be set"
    refused(host, "native-3", "coulomb", [START], setting(time=1.0), text)


def test_a_clamp_is_told_once_and_only_if_it_acts(host: Host) -> None:
    passing = [setting(mu_s=0.2), setting(mu_k=0.1), ["step", 0.1]]
    acting = [setting(mu_k=0.4), *[["step", 0.1], setting(v=0.03)] * 3, ["get", "mu_k_used"]]
    host.errors()
    assert host.call(play, built("python-2"), [START, *passing])[-1] is None
    assert host.errors() == ""
    assert host.call(play, built("python-2"), [START, *passing, *acting])[-1] == [0.2 - 0.01]
    assert host.errors().count("mu_k = 0.4 is above mu_s = 0.2") == 1


def test_it_refuses_and_warns_where_standard_error_cannot_be_written(host: Host) -> None:
    shown = host.call(without_standard_error, built("python-2"))
    assert shown[::2] == [0.3 - 0.01] * 2
    assert all("step size h = -1.0 s" in text for text in shown[1::2])


@needs("cc")
def test_a_step_of_fmi_3_says_where_the_simulation_stands(host: Host) -> None:
    path = built("native-3")
    text = "step size h = -1.0 s is out of range: above 0 and finite"
    assert host.call(flags_of_a_step, path, 0.1) == [0, False, 0.2, []]
    # An error concerns this instance, a fatal one would concern all.
    refusal = [ERROR, False, 0.1, [[ERROR, "logStatusError", text]]]
    assert host.call(flags_of_a_step, path, -1.0) == refusal
