"""What a careless host calls on the native FMU: a status and a message, and no crash.

Random sequences of calls in every phase are tried on all kinds of FMU by tests/fmu/lives.
"""

import ctypes as c
import re
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

import fmpy
import pytest

from tests.conftest import built
from tests.driver import DISCARD, ERROR, OK, WARNING, Fmu, Instance, Refused, loaded
from tests.needs import needs

pytestmark = needs("cc")

NATIVE = ["native-2", "native-3"]
either = pytest.mark.parametrize("kind", NATIVE)
HEADERS = Path(fmpy.__file__).parent / "c-code"


# By their names in the headers of the standard.
_MODEL_EXCHANGE_2 = r"EnterEvent|Discrete|Continuous|CompletedIntegrator|SetTime|GetDerivat|Indicat"
_CO_SIMULATION_2 = r"DoStep|CancelStep|Status$|put\w*Derivatives$"
_NOT_OFFERED = (
    r"(Directional|Adjoint|GetRealOutput|GetOutput)Derivatives?$|Dependenc|Configuration|CancelStep"
)
_OF_OTHER_MODES = (
    r"ContinuousTimeMode|EvaluateDiscrete|[GS]etClock|Interval|Shift|[GS]etContinuous"
    r"|SetTime|CompletedIntegratorStep|Nominals|GetEventIndicators|ActivateModelPartition"
)
_TYPES = r"[GS]et(Real|Integer|Boolean|String|Float\d+|U?Int\d+|Binary)$"


def standard(version: int, solved: bool = False) -> set[str]:
    """Return the functions of the standard that a library has, bare of fmi2.

    One of FMI 2.0 has those of co-simulation, or of model exchange.
    """
    text = (HEADERS / f"fmi{version}Functions.h").read_text(encoding="utf-8")
    names = set(re.findall(rf"FMI{version}_Export fmi{version}\w+TYPE\s+fmi{version}(\w+);", text))
    absent = _CO_SIMULATION_2 if solved else _MODEL_EXCHANGE_2
    return {each for each in names if version == 3 or not re.search(absent, each)}


def called(version: int, pattern: str) -> list[str]:
    return sorted(each for each in standard(version) if re.search(pattern, each))


def stepping(kind: str) -> Instance:
    instance = loaded(built(kind)).started()
    instance.step(0.1)
    return instance


@either
def test_a_null_instance_is_refused_by_every_function(kind: str) -> None:
    fmu = loaded(built(kind))
    names = standard(fmu.version)
    assert len(names) > 30
    free = {each for each in names if each.startswith(("GetVersion", "GetTypes", "Instantiate"))}
    for name in names - free - {"FreeInstance"}:
        assert fmu.call(name, None, *[None] * 10) == ERROR, name
    fmu.library[f"fmi{fmu.version}FreeInstance"](None)


def with_null(instance: Instance) -> Iterator[tuple[Any, ...]]:
    """Yield calls with one NULL where there must be something, or with lists that do not fit."""
    version, size = instance.fmu.version, c.c_size_t
    of_state = "FMUstate" if version == 2 else "FMUState"
    read = f"DeSerialize{of_state}" if version == 2 else f"Deserialize{of_state}"
    references, numbers = (c.c_uint32 * 2)(20, 20), (c.c_int64 * 2)()
    data, state, slot = (c.c_ubyte * 2000)(), instance.save(), c.byref(c.c_void_p())
    after = () if version == 2 else (size(2),)
    yield from ((f"{verb}{of_state}", None) for verb in ("Get", "Set", "Free"))
    yield f"Serialized{of_state}Size", None, c.byref(size())
    yield f"Serialized{of_state}Size", state, None
    yield f"Serialize{of_state}", None, data, size(2000)
    yield f"Serialize{of_state}", state, None, size(2000)
    yield f"Serialize{of_state}", state, data, size(100)
    yield read, None, size(617), slot
    yield read, data, size(0), slot
    yield read, data, size(617), None
    yield "SetDebugLogging", 1, size(1), None
    yield "SetDebugLogging", 1, size(1), (c.c_char_p * 1)()
    for name in called(version, _TYPES):
        sizes = (numbers,) if name.endswith("Binary") else ()
        yield name, None, size(2), *sizes, numbers, *after
        yield name, references, size(2), *sizes, None, *after
    if version == 2:
        yield "GetRealStatus", 2, None
        yield "GetBooleanStatus", 3, None
        return
    yield "GetFloat64", references, size(2), numbers, size(1)
    shown = [c.byref(c.c_double()) for _ in range(5)]
    for n in range(6):
        yield "UpdateDiscreteStates", *shown[:n], None, *shown[n:]
    for n in range(4):
        yield "DoStep", 0.1, 0.1, True, *shown[:n], None, *shown[n:3]


@either
def test_a_null_argument_is_an_error_with_a_message_until_a_reset(kind: str) -> None:
    instance = stepping(kind)
    for call in with_null(instance):
        instance.fmu.messages.clear()
        assert instance.status(*call) == ERROR, call
        ((status, category, text),) = instance.fmu.messages
        assert (status, category) == (ERROR, "logStatusError"), call
        assert text, call
        assert instance.status("Terminate") == ERROR, call
        assert instance.fmu.messages[1] == (ERROR, "logStatusError", text)
        instance.reset()
        instance.start()
        instance.step(0.1)


@either
def test_what_is_not_offered_is_refused_and_changes_nothing(kind: str) -> None:
    for instance in (stepping(kind), loaded(built(kind)).instance()):
        for name in called(instance.fmu.version, _NOT_OFFERED):
            before = instance.everything()
            assert instance.status(name, *[None] * 8) == ERROR
            full_name = f"fmi{instance.fmu.version}{name}"
            assert instance.fmu.messages[-1][2] == f"FMI function not supported: {full_name}"
            assert instance.everything() == before


@pytest.mark.parametrize("name", called(3, _OF_OTHER_MODES))
def test_a_call_of_another_mode_fails_until_a_reset(name: str) -> None:
    instance = stepping("native-3")
    words = f"fmi3{name} is not allowed here: this is co-simulation without clocks"
    for call in (name, "Terminate"):
        assert instance.status(call, *[None] * 8) == ERROR
        assert instance.fmu.messages[-1][2] == words


def test_clocks_and_updates_of_what_is_no_input_are_not_instantiated() -> None:
    fmu = loaded(built("native-3"))
    no = c.c_bool(False)
    function = fmu.library.fmi3InstantiateScheduledExecution
    function.restype = c.c_void_p
    for logger in (fmu.logger, None):
        assert function(b"a", fmu.token, None, no, no, None, logger) is None
    assert "scheduled execution is not offered" in fmu.messages[-1][2]
    fmu.instance().free()
    make = fmu.library.fmi3InstantiateCoSimulation
    for logger in (fmu.logger, None):
        for wanted in (None, c.byref(c.c_uint32(fmu.references["k"]))):
            flags = (no, no, no, no, wanted, c.c_size_t(1), None)
            assert make(b"a", fmu.token, None, *flags, logger, fmu.logger) is None
    assert "intermediate update is for v, load and F_ext" in fmu.messages[-1][2]


def test_fmi_2_tells_the_last_successful_time_and_that_no_step_ends_the_simulation() -> None:
    new, stepped, failed = loaded(built("native-2")).instance(), *map(stepping, ["native-2"] * 2)
    assert failed.status("DoStep", 0.1, -1.0, 1) == ERROR
    for instance, expected in ((new, 0.0), (stepped, 0.1), (failed, 0.1)):
        time, ended = c.c_double(9.0), c.c_int(9)
        assert instance.status("GetRealStatus", 2, c.byref(time)) == OK
        assert instance.status("GetBooleanStatus", 3, c.byref(ended)) == OK
        assert (time.value, ended.value) == (expected, 0)
        own = {("Real", 2), ("Boolean", 3)}
        for call in {*product(("", "Integer", "String", "Real", "Boolean"), range(-1, 5))} - own:
            assert instance.status(f"Get{call[0]}Status", call[1], None) == DISCARD


def refused(fmu: Fmu, **more: Any) -> str:
    fmu.messages.clear()
    assert fmu.instantiate(**more) is None
    ((_, _, text),) = fmu.messages
    return text


@either
def test_an_instance_of_another_fmu_or_kind_is_refused_with_a_message(kind: str) -> None:
    fmu = loaded(built(kind))
    assert "is {another}, and that of this FMU is {" in refused(fmu, token=b"{another}")
    # The logger of FMI 2.0 reads a text as a printf format.
    percent = "%%" if fmu.version == 2 else "%"
    assert "%s%n%d".replace("%", percent) in refused(fmu, token=b"%s%n%d")
    assert len(refused(fmu, token=b"x" * 100_000)) < 500
    if fmu.version == 2:
        for other in (0, 7):
            assert "model exchange is in an FMU of its own" in refused(fmu, kind=other)


@pytest.mark.parametrize("name", [None, b"\xff\xfe"])
@pytest.mark.parametrize("with_callbacks", [True, False])
def test_fmi_2_needs_a_name_and_nothing_else_of_the_host(
    name: bytes | None, with_callbacks: bool
) -> None:
    fmu = Fmu(built("native-2"))
    no_callbacks = (c.c_void_p * 5)()
    callbacks = c.byref(no_callbacks) if with_callbacks else None
    make = fmu.library.fmi2Instantiate
    make.restype = c.c_void_p
    address = make(name, 1, fmu.token, None, callbacks, 0, 1)
    assert (address is None) == (name is None)
    if address is not None:
        instance = fmu.instance()
        instance.address = c.c_void_p(address)
        instance.start(mu_k=0.9)
        instance.step(1.0)
        assert instance.status("DoStep", 1.0, -1.0, 1) == ERROR
        instance.free()


W, E = (WARNING, "logStatusWarning"), (ERROR, "logStatusError")


@either
@pytest.mark.parametrize(
    ("on", "categories", "heard"),
    [
        (True, [], [W, E]),
        (True, [b"logAll"], [W, E]),
        (True, [b"logStatusWarning"], [W]),
        (True, [b"another", b"logStatusError"], [E]),
        (False, [b"logStatusError"], []),
    ],
)
def test_categories_choose_what_is_logged(
    kind: str, on: bool, categories: list[bytes], heard: list[tuple[int, str]]
) -> None:
    instance = loaded(built(kind)).instance()
    instance.fmu.messages.clear()
    listed = (c.c_char_p * len(categories))(*categories)
    instance.call("SetDebugLogging", on, c.c_size_t(len(categories)), listed)
    instance.start(mu_k=0.9)
    with pytest.raises(Refused):
        instance.step(-1.0)
    assert [each[:2] for each in instance.fmu.messages] == heard
