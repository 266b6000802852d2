"""Every function of the native FMU in every phase, with every NULL: a status, and no crash."""

import ctypes
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fmpy
import pytest

from tests.native.conftest import EACH, Native
from tests.native.library import DISCARD, ERROR, OK, REAL, REFERENCE, WARNING, Library
from tests.needs import needs

pytestmark = needs("cc")

Null = None
_WAYS = ("instantiated", "initialization", "stepping", "terminated", "failed")

# The functions of FMI 2.0 that a library has for model exchange alone.
_MODEL_EXCHANGE = {
    f"fmi2{name}"
    for name in (
        "EnterEventMode",
        "NewDiscreteStates",
        "EnterContinuousTimeMode",
        "CompletedIntegratorStep",
        "SetTime",
        "SetContinuousStates",
        "GetDerivatives",
        "GetEventIndicators",
        "GetContinuousStates",
        "GetNominalsOfContinuousStates",
    )
}
_WITHOUT_INSTANCE = ("GetVersion", "GetTypesPlatform", "Instantiate", "FreeInstance")
_KINDS = {
    2: "Real Integer Boolean String",
    3: "Float32 Float64 Int8 UInt8 Int16 UInt16 Int32 UInt32 Int64 UInt64 Boolean String",
}
# Calls that the FMU does not offer: refused, and nothing changes.
_UNSUPPORTED = {
    2: (
        "GetDirectionalDerivative",
        "SetRealInputDerivatives",
        "GetRealOutputDerivatives",
        "CancelStep",
    ),
    3: (
        "GetNumberOfVariableDependencies",
        "GetVariableDependencies",
        "GetDirectionalDerivative",
        "GetAdjointDerivative",
        "GetOutputDerivatives",
        "EnterConfigurationMode",
        "ExitConfigurationMode",
    ),
}
# Calls of phases that co-simulation without event mode does not have.
_ABSENT = (
    "EnterEventMode",
    "EnterStepMode",
    "EnterContinuousTimeMode",
    "EvaluateDiscreteStates",
    "UpdateDiscreteStates",
    "GetClock",
    "SetClock",
    "GetIntervalDecimal",
    "GetIntervalFraction",
    "GetShiftDecimal",
    "GetShiftFraction",
    "SetIntervalDecimal",
    "SetIntervalFraction",
    "SetShiftDecimal",
    "SetShiftFraction",
    "SetTime",
    "CompletedIntegratorStep",
    "GetContinuousStates",
    "SetContinuousStates",
    "GetContinuousStateDerivatives",
    "GetNominalsOfContinuousStates",
    "GetEventIndicators",
    "GetNumberOfContinuousStates",
    "GetNumberOfEventIndicators",
    "ActivateModelPartition",
)


@pytest.fixture(scope="module", params=EACH, ids=lambda each: f"{each[1]}-{each[0]}")
def library(
    request: pytest.FixtureRequest, native: Native, tmp_path_factory: pytest.TempPathFactory
) -> Library:
    """Give the library of each face and law."""
    return Library(native(*request.param), tmp_path_factory.mktemp("library"))


def _functions(face: int) -> set[str]:
    """Return the names of the functions that the standard's header declares."""
    header = Path(fmpy.__file__).parent / "c-code" / f"fmi{face}Functions.h"
    return set(re.findall(rf"FMI{face}_Export fmi{face}\w+TYPE\s+(\w+);", header.read_text()))


def _in(library: Library, phase: str) -> ctypes.c_void_p:
    """Return an instance in this phase, or after a failure."""
    instance = library.instantiate()
    if phase == "initialization":
        if library.face == 2:
            assert library.call("SetupExperiment", instance, 0, 0.0, 0.0, 0, 0.0) == OK
        given = () if library.face == 2 else (False, 0.0, 0.0, False, 0.0)
        assert library.call("EnterInitializationMode", instance, *given) == OK
    elif phase != "instantiated":
        assert library.start(instance) == OK
        assert library.step(instance, 0.0, 0.1) == OK
    if phase == "terminated":
        assert library.call("Terminate", instance) == OK
    if phase == "failed":
        assert library.step(instance, 0.1, -1.0) == ERROR
    library.told.clear()
    return instance


def _last(library: Library) -> str:
    return library.told[-1][3]


def test_a_null_instance_is_refused_by_every_function(library: Library) -> None:
    """Each function returns an error, and does not touch its other arguments."""
    for name in _functions(library.face) - _MODEL_EXCHANGE:
        bare = name[4:]
        if not bare.startswith(_WITHOUT_INSTANCE):
            assert library.call(bare, Null, *[Null] * 10) == ERROR, name
    getattr(library.calls, f"fmi{library.face}FreeInstance")(Null)


def _allowed(library: Library) -> dict[str, tuple[Callable[[Any], int], tuple[str, ...]]]:
    """Return calls, each with the phases in which it is taken."""
    face = library.face
    early = ("instantiated", "initialization")
    sound = _WAYS[:4]
    given = () if face == 2 else (False, 0.0, 0.0, False, 0.0)
    calls: dict[str, tuple[Callable[[Any], int], tuple[str, ...]]] = {
        "enter": (lambda i: library.call("EnterInitializationMode", i, *given), early[:1]),
        "exit": (lambda i: library.call("ExitInitializationMode", i), early[1:]),
        "step": (lambda i: library.step(i, 0.1, 0.1), ("stepping",)),
        "terminate": (lambda i: library.call("Terminate", i), sound),
        "reset": (lambda i: library.call("Reset", i), _WAYS),
        "get": (lambda i: library.get(i)[0], sound),
        "get none": (lambda i: library.get(i, [])[0], sound),
        "set input": (lambda i: library.set(i, {"v": 0.1}), sound[:3]),
        "set tunable": (lambda i: library.set(i, {"k": 900.0}), sound[:3]),
        "set fixed": (lambda i: library.set(i, {"m": 2.0}), early),
        "set fixed as it is": (lambda i: library.set(i, {"m": 1.0}), sound[:3]),
        "set none": (lambda i: library.set(i, {}), sound),
        "set start of output": (lambda i: library.set(i, {"delta_x": 0.0}), early),
        "set output": (lambda i: library.set(i, {"delta_x": 0.5}), ()),
        "set calculated": (lambda i: library.set(i, {"x": 0.0}), ()),
        "take": (lambda i: int(library.take(i)[0]), sound),
        "log": (lambda i: library.call("SetDebugLogging", i, 1, ctypes.c_size_t(0), Null), _WAYS),
    }
    if "shape" in library.table.by_name:
        calls["set whole"] = (lambda i: library.set(i, {"n_points": 3}), early)
        calls["set whole as it is"] = (lambda i: library.set(i, {"n_points": 2}), sound[:3])
        calls["set choice"] = (lambda i: library.set(i, {"shape": 3}), early)
        calls["set choice as it is"] = (lambda i: library.set(i, {"shape": 1}), sound[:3])
    if face == 2:
        setup = (0, 0.0, 3.0, 0, 0.0)
        calls["set up"] = (lambda i: library.call("SetupExperiment", i, *setup), early[:1])
    return calls


@pytest.mark.parametrize("phase", _WAYS)
def test_a_call_is_taken_in_its_phases_alone(library: Library, phase: str) -> None:
    """What is refused fails until a reset, with one message at every call."""
    for name, (call, phases) in _allowed(library).items():
        instance = _in(library, phase)
        status = call(instance)
        assert status == (OK if phase in phases else ERROR), name
        if status == OK:
            assert not library.told, name
        else:
            message = _last(library)
            assert message
            again = (library.get(instance)[0], library.call("Terminate", instance))
            assert again == (ERROR, ERROR), name
            assert [each[1:] for each in library.told] == [(ERROR, "logStatusError", message)] * 3
            assert library.call("Reset", instance) == OK
            assert library.start(instance) == OK
            assert library.step(instance, 0.0, 0.1) == OK
        getattr(library.calls, f"fmi{library.face}FreeInstance")(instance)


@pytest.mark.parametrize("phase", _WAYS)
def test_a_state_is_handled_in_every_phase(library: Library, phase: str) -> None:
    """States are written, read and freed also after a failure; to be set they need a reset."""
    source = _in(library, "stepping")
    expected = library.get(source)
    content = library.packed(source)
    _, state = library.take(source)
    instance = _in(library, phase)
    status, unpacked = library.unpacked(instance, content)
    assert status == OK
    size = ctypes.c_size_t()
    name = f"SerializedFMU{'state' if library.face == 2 else 'State'}Size"
    assert library.call(name, instance, state, ctypes.byref(size)) == OK
    assert size.value == len(content)
    taken = OK if phase != "failed" else ERROR
    for each in (state, unpacked):
        assert library.put(instance, each) == taken
        assert library.free(instance, each) == OK
    if phase != "failed":
        assert library.get(instance) == expected
        assert library.step(instance, 0.1, 0.1) == OK


def _nulls(library: Library) -> dict[str, Callable[[Any], int]]:
    """Return calls with one NULL where there must be something, or with lists that do not fit."""
    face, size = library.face, ctypes.c_size_t
    state_name = "FMUstate" if face == 2 else "FMUState"
    write = f"Serialize{state_name}"
    deserialize = "DeSerializeFMUstate" if face == 2 else "DeserializeFMUState"
    references, numbers = (ctypes.c_uint32 * 2)(20, 20), (ctypes.c_int64 * 2)()
    content, state = (ctypes.c_ubyte * 2000)(), ctypes.byref(ctypes.c_void_p())
    after = () if face == 2 else (size(2),)

    def call(name: str, *arguments: Any) -> Callable[[Any], int]:
        return lambda instance: library.call(name, instance, *arguments)

    def call_with_state(name: str, *arguments: Any) -> Callable[[Any], int]:
        return lambda instance: library.call(name, instance, library.take(instance)[1], *arguments)

    nulls = {
        "get into": call(f"Get{state_name}", Null),
        "set": call(f"Set{state_name}", Null),
        "free": call(f"Free{state_name}", Null),
        "size of": call(f"Serialized{state_name}Size", Null, ctypes.byref(size())),
        "size": call_with_state(f"Serialized{state_name}Size", Null),
        "write": call(write, Null, content, size(2000)),
        "write into": call_with_state(write, Null, size(2000)),
        "write into little": call_with_state(write, content, size(100)),
        "read": call(deserialize, Null, size(617), state),
        "read nothing": call(deserialize, content, size(0), state),
        "read into": call(deserialize, content, size(617), Null),
        "log": call("SetDebugLogging", 1, size(1), Null),
        "log of": call("SetDebugLogging", 1, size(1), (ctypes.c_char_p * 1)()),
    }
    for name in (f"{verb}{kind}" for verb in ("Get", "Set") for kind in _KINDS[face].split()):
        nulls[f"{name}: references"] = call(name, Null, size(2), numbers, *after)
        nulls[f"{name}: values"] = call(name, references, size(2), Null, *after)
    if face == 2:
        nulls["last time"] = call("GetRealStatus", 2, Null)
        nulls["terminated"] = call("GetBooleanStatus", 3, Null)
        return nulls
    for missing in range(4):
        shown: list[Any] = [ctypes.byref(ctypes.c_double()) for _ in range(4)]
        shown[missing] = Null
        nulls[f"step {missing}"] = call("DoStep", 0.1, 0.1, True, *shown)
    nulls["counts"] = call("GetFloat64", references, size(2), numbers, size(1))
    nulls["binary"] = call("GetBinary", Null, size(2), Null, Null, size(2))
    nulls["set binary"] = call("SetBinary", Null, size(2), Null, Null, size(2))
    return nulls


@pytest.mark.parametrize("phase", ["instantiated", "stepping", "failed"])
def test_a_null_argument_is_refused(library: Library, phase: str) -> None:
    """Each NULL is an error with a message, and a reset recovers."""
    for name, call in _nulls(library).items():
        instance = _in(library, phase)
        assert call(instance) == ERROR, name
        assert _last(library), name
        if phase != "failed":
            assert library.get(instance)[0] == ERROR, name
        assert library.call("Reset", instance) == OK
        assert library.start(instance) == OK
        getattr(library.calls, f"fmi{library.face}FreeInstance")(instance)


@pytest.mark.parametrize("phase", _WAYS)
def test_what_is_not_offered_is_refused_and_changes_nothing(library: Library, phase: str) -> None:
    """Derivatives, dependencies, configuration: an error, after which the run goes on."""
    for name in _UNSUPPORTED[library.face]:
        instance = _in(library, phase)
        before = library.get(instance)
        library.told.clear()
        assert library.call(name, instance, *[Null] * 8) == ERROR
        assert _last(library) == f"FMI function not supported: fmi{library.face}{name}"
        assert library.get(instance) == before


def test_event_mode_clocks_and_model_exchange_are_refused(native: Native, tmp_path: Path) -> None:
    """FMI 3.0: a call of a phase that is not there fails until a reset, and says so."""
    library = Library(native(3), tmp_path)
    for name in _ABSENT:
        instance = _in(library, "stepping")
        assert library.call(name, instance, *[Null] * 8) == ERROR
        said = f"fmi3{name} is not allowed here: this is co-simulation without event mode"
        assert _last(library) == said
        assert library.step(instance, 0.1, 0.1) == ERROR
        assert _last(library) == said
    for kind in ("ModelExchange", "ScheduledExecution"):
        function = getattr(library.calls, f"fmi3Instantiate{kind}")
        function.restype = ctypes.c_void_p
        assert function(b"a", library.identity, Null, 0, 1, Null, library.logger) is None
        assert "is not offered" in _last(library)
        assert function(b"a", library.identity, Null, 0, 1, Null, Null) is None
    make = library.instantiate_
    for event_mode, count in ((True, 0), (False, 1)):
        flags = [ctypes.c_bool(each) for each in (False, False, event_mode, False)]
        more = (Null, ctypes.c_size_t(count), Null, library.logger, Null)
        assert make(b"a", library.identity, Null, *flags, *more) is None
        assert "event mode and intermediate update are not offered" in _last(library)


def test_the_status_of_the_last_step_is_told(native: Native, tmp_path: Path) -> None:
    """FMI 2.0: the last successful time, and that no step ends the simulation."""
    library = Library(native(2), tmp_path)
    for phase, expected in (("instantiated", 0.0), ("stepping", 0.1), ("failed", 0.1)):
        instance = _in(library, phase)
        time, ended = ctypes.c_double(9.0), ctypes.c_int(9)
        assert library.call("GetRealStatus", instance, 2, ctypes.byref(time)) == OK
        assert time.value == expected
        assert library.call("GetBooleanStatus", instance, 3, ctypes.byref(ended)) == OK
        assert ended.value == 0
        for kind in (0, 1, 2, 3, 99, -1):
            for of in ("", "Integer", "String"):
                assert library.call(f"Get{of}Status", instance, kind, Null) == DISCARD
            for of, own in (("Real", 2), ("Boolean", 3)):
                if kind != own:
                    assert library.call(f"Get{of}Status", instance, kind, Null) == DISCARD


def test_an_instance_is_refused_with_a_message(library: Library) -> None:
    """A wrong name or identity, and an instance of another kind."""
    refused: list[tuple[dict[str, Any], str]] = [
        ({"identity": b"{another}"}, "is {another}, and that of this FMU is {"),
        ({"identity": b"%s%n%d"}, "%s%n%d"),
        ({"identity": b"x" * 100_000}, "xxx"),
        ({"name": None}, "the instance name is NULL"),
    ]
    if library.face == 2:
        refused.append(({"kind": 0}, "model exchange is not offered"))
        refused.append(({"kind": 7}, "model exchange is not offered"))
    for given, said in refused:
        library.told.clear()
        assert library.instantiate(**given).value is None
        assert library.instantiate(**given, logger=None).value is None
        # The logger of FMI 2.0 reads a text as a printf format.
        assert said.replace("%", "%%" if library.face == 2 else "%") in _last(library)
        assert len(library.told) == 1
    for name in (b"", b"x" * 1_000_000, b"%s%n", "Stück".encode(), b"\xff\xfe"):
        instance = library.instantiate(name=name)
        assert instance.value is not None
        assert library.start(instance) == OK


def test_nothing_of_the_host_is_needed(native: Native, tmp_path: Path) -> None:
    """FMI 2.0: no callbacks, no logger, no folder of resources."""
    library = Library(native(2), tmp_path)
    for instance in (
        ctypes.c_void_p(library.instantiate_(b"a", 1, library.identity, Null, Null, 0, 1)),
        library.instantiate(logger=None),
    ):
        assert library.start(instance, mu_k=0.9) == OK
        assert library.step(instance, 0.0, 1.0) == OK
        assert library.step(instance, 1.0, -1.0) == ERROR
        library.calls.fmi2FreeInstance(instance)
    assert not library.told


def test_warnings_and_errors_have_categories(library: Library) -> None:
    """Both reach the log from the start; categories choose among them, and off is silence."""

    def heard(*categories: bytes, on: bool = True, ask: bool = True) -> list[tuple[int, str]]:
        library.told.clear()
        instance = library.instantiate(name=b"%s of mine")
        if ask:
            listed = (ctypes.c_char_p * len(categories))(*categories)
            count = ctypes.c_size_t(len(categories))
            assert library.call("SetDebugLogging", instance, on, count, listed) == OK
        assert library.start(instance, mu_k=0.9) == OK
        assert library.step(instance, 0.0, -1.0) == ERROR
        assert {each[0] for each in library.told} <= {"%s of mine" if library.face == 2 else ""}
        return [each[1:3] for each in library.told]

    warning, error = (WARNING, "logStatusWarning"), (ERROR, "logStatusError")
    assert heard(ask=False) == [warning, error]
    assert heard() == [warning, error]
    assert heard(b"logAll") == [warning, error]
    assert heard(b"logStatusWarning") == [warning]
    assert heard(b"another", b"logStatusError") == [error]
    assert heard(b"another") == []
    assert heard(on=False) == []
    assert heard(b"logStatusError", on=False) == []


def test_outputs_follow_what_is_set_before_the_start(library: Library) -> None:
    """Each read after a set shows the block that would start; t_event shows the start time."""
    instance = library.instantiate()
    for z_start in (0.001, 0.003):
        assert library.set(instance, {"z_start": z_start}) == OK
        assert library.get(instance, [REFERENCE["F"]]) == (OK, [1000.0 * z_start])
    assert library.set(instance, {"load": -20.0}) == OK
    assert library.get(instance)[0] == ERROR
    assert "or the mass lifts off" in _last(library)
    assert library.call("Reset", instance) == OK
    assert library.start(instance, 5.0) == OK
    assert library.get(instance, [REFERENCE["t_event"]]) == (OK, [5.0])


def test_the_time_of_fmi3_is_the_end_of_the_last_step(native: Native, tmp_path: Path) -> None:
    """It begins at the start time, is read among other values, and comes back with a state."""
    library = Library(native(3), tmp_path)
    instance = library.instantiate()
    time = len(library.table.rows)
    assert library.start(instance, 5.0) == OK
    assert library.get(instance, [time]) == (OK, [5.0])
    assert library.step(instance, 5.0, 0.25) == OK
    _, state = library.take(instance)
    assert library.step(instance, 5.25, 0.25) == OK
    status, values = library.get(instance, [REFERENCE["m"], time, REFERENCE["k"]])
    assert (status, values) == (OK, [1.0, 5.5, 1000.0])
    reached = ctypes.c_double()
    flags = [ctypes.byref(ctypes.c_bool()) for _ in range(3)]
    refused = library.instantiate()
    assert library.start(refused, 5.0) == OK
    assert library.call("DoStep", refused, 5.0, -1.0, True, *flags, ctypes.byref(reached)) == ERROR
    assert reached.value == 5.0
    assert library.put(instance, state) == OK
    assert library.get(instance, [time]) == (OK, [5.25])
    kind = REAL[library.face]
    assert library.lists("Set", kind, instance, [time], [5.25])[0] == ERROR
    assert _last(library) == "time is the independent variable: it cannot be set"
