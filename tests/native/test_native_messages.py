"""The native FMU refuses what the Python FMU refuses, in the same words."""

import json
import math
import random
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Literal

import pytest

from fmukit.table import ABOVE_ZERO, Table, Variable
from stickslip_fmu.packer import build
from stickslip_native.named import native_law
from tests.native.conftest import EACH, Native
from tests.native.library import type_of
from tests.needs import needs
from tests.python import python

Calls = list[list[Any]]

PROGRAM = Path(__file__).with_name("inside") / "refused.py"
MARK = "==="
RANDOM = 3_000
_LIMIT = 600.0
# A step of the fastest block holds a few transitions [s].
_SHORT = 1e-150

_BAD = (-1.0, -0.1, -1e-300, 0.0, 5e-324, 1e-310, 1e300, math.nan, math.inf, -math.inf)

# Types of the calls by FMI version.
_REAL = {2: "Real", 3: "Float64"}
_TYPES = {
    2: ("Real", "Integer", "Boolean", "String"),
    3: ("Float64", "Int32", "Int64", "UInt64", "Boolean", "String"),
}
_VALUES = {"Boolean": False, "String": "a", "Real": 1.5, "Float64": 1.5}


def _set(face: int, table: Table, **values: float) -> list[Any]:
    """Return the call that sets Reals."""
    numbers = [table.by_name[name].number for name in values]
    return [f"set{_REAL[face]}", numbers, list(values.values())]


def _set_each(face: int, table: Table, **values: float) -> Calls:
    """Return the calls that set values of any type, one after the other."""
    rows = [table.by_name[name] for name in values]
    return [[f"set{type_of(row, face)}", [row.number], [values[row.name]]] for row in rows]


def _reals(table: Table) -> list[Variable]:
    return [row for row in table.rows if row.kind == "Real"]


def _running() -> Calls:
    """Return the calls up to the first step."""
    return [["start", 0.0], ["exitInitializationMode"], ["doStep", 0.0, 0.01]]


def _values(face: int, table: Table) -> Iterator[Calls]:
    """Give calls that set a value out of range, or that cannot be set."""
    for row in _reals(table):
        for value in _BAD:
            yield [
                _set(face, table, **{row.name: value}),
                ["start", 0.0],
                ["exitInitializationMode"],
            ]
            yield [*_running(), _set(face, table, **{row.name: value}), ["doStep", 0.01, 0.01]]
        start = 0.0 if row.start is None else row.start
        yield [*_running(), _set(face, table, **{row.name: start + 1.0})]
        yield [*_running(), ["terminate"], _set(face, table, **{row.name: start})]
        yield [["start", 0.0], _set(face, table, **{row.name: start})]


def _together(face: int, table: Table) -> Iterator[Calls]:
    """Give calls that set values which do not go together."""
    together: tuple[dict[str, float], ...] = (
        {"load": -10.0},
        {"load": -1e3, "m": 0.1},
        {"load": -9.81},
        {"load": -9.810000000000002},
        {"k": 1e300, "m": 1e-300},
        {"k": 1e-300, "m": 1e300},
        {"c": 1e300, "m": 1e-10},
        {"c": 1e200},
        {"k": 1e-300, "c": 1e308},
        {"mu_s": 1e308},
        {"mu_s": 1e308, "mu_k": 1e308},
        {"m": 1e300, "g": 1e300},
        {"x_start": 1.7e308, "z_start": 1e308},
        {"k": 1e200, "z_start": 1e200},
        {"v": 1e300},
        {"F_ext": 1e308, "z_start": 1e308},
        {"mu_k": 0.9},
        {"mu_k": 0.5000000000000001},
        {"mu_s": 0.0, "mu_k": 5e-324},
        {"mu_s": -0.0, "mu_k": 1e22},
    )
    for values in together:
        setting = _set(face, table, **values)
        yield [setting, ["start", 1.0], ["exitInitializationMode"], ["doStep", 1.0, 1.0]]
        yield [setting, [f"get{_REAL[face]}", [table.by_name["W_pull"].number, 999]]]
        yield [setting, [f"get{_REAL[face]}", [table.by_name["x"].number]]]
        tunable = {k: v for k, v in values.items() if table.by_name[k].variability != "fixed"}
        if tunable:
            setting = _set(face, table, **tunable)
            read = [
                f"get{_REAL[face]}",
                [table.by_name["W_pull"].number, table.by_name["Q_friction"].number],
            ]
            # Slips that are power series take the Python block long.
            step = ["doStep", 0.01, 1.0 if "shape" in table.by_name else 1e3]
            yield [*_running(), setting, step, read]
            # A parameter is not shown either where the motion cannot be.
            yield [*_running(), setting, step, [*read[:1], [0]]]
            yield [*_running(), setting, setting, step, step, read, [*read[:1], [0, 999]]]
    # The text of a warning is told once, until another is told or none is due.
    for pairs in (
        ((0.3, 0.5), (0.3, 0.5), (0.3, 0.6), (0.3, 0.5)),
        ((0.3, 0.5), (0.5, 0.3), (0.3, 0.5)),
        ((0.0, 0.5), (-0.0, 0.5)),
    ):
        calls = _running()
        for mu_s, mu_k in pairs:
            calls += [
                _set(face, table, mu_s=mu_s, mu_k=mu_k),
                _set(face, table, v=mu_k),
                ["doStep", 0.0, 0.01],
            ]
        yield calls


def _steps(face: int, table: Table) -> Iterator[Calls]:
    """Give steps that are refused."""
    for step in (0.0, -0.0, -1.0, -5e-324, *_BAD[-3:], 1e17, 1e300, 12345678.9e9):
        yield [*_running(), ["doStep", 0.01, step]]
        yield [*_running(), _set(face, table, c=1.0, v=-0.3), ["doStep", 0.01, step]]
    for time in (math.nan, math.inf, -math.inf):
        yield [*_running(), ["doStep", time, 0.01]]
        yield [*_running(), ["doStep", time, -1.0]]
        yield [*_running(), _set(face, table, load=-10.0), ["doStep", time, 1.0]]


def _phases(face: int, table: Table) -> Iterator[Calls]:
    """Give calls in a wrong phase."""
    ways: tuple[Calls, ...] = (
        [],
        [["start", 0.0]],
        _running()[:2],
        _running(),
        [["terminate"]],
        [*_running(), ["terminate"]],
    )
    for way in ways:
        yield [*way, ["enterInitializationMode"]]
        yield [*way, ["exitInitializationMode"]]
        yield [*way, ["doStep", 0.0, 0.1]]
        yield [*way, ["doStep", math.nan, -0.1]]
        yield [*way, ["terminate"], ["terminate"]]
        yield [*way, [f"get{_REAL[face]}", [table.by_name["x"].number]]]
        if face == 2:
            yield [*way, ["setupExperiment", None, 3.0]]
            yield from ([*way, ["setupExperiment", None, time]] for time in _BAD[-3:])
        else:
            yield [*way, ["setFloat64", [len(table.rows)], [1.0]]]
            yield [*way, ["setFloat64", [999, len(table.rows)], [1.0, 2.0]]]
            yield [*way, ["getFloat64", [999, len(table.rows)]]]
            yield [*way, ["getInt64", [len(table.rows)]]]
            yield [*way, ["raw", "fmi3SetTime", 0.0]]
            for states in ("GetContinuousStates", "SetContinuousStates", "GetEventIndicators"):
                yield [*way, ["raw", f"fmi3{states}", "&", 1]]
            yield [*way, ["raw", "fmi3GetNominalsOfContinuousStates", "&", 1]]
            yield [*way, ["raw", "fmi3UpdateDiscreteStates", None, None, None, None, None, None]]


def _types(face: int, table: Table) -> Iterator[Calls]:
    """Give calls that name a variable of another type, or none."""
    for kind in _TYPES[face]:
        value = _VALUES.get(kind, 1)
        # The wrapper of FMI 2.0 takes larger references for negative ones.
        for reference in (*range(len(table.rows)), len(table.rows), 2**31 - 1):
            if kind == "Float64" and reference == len(table.rows):
                continue  # the time, which has a start time only in the native FMU
            yield [["start", 0.0], [f"get{kind}", [reference]]]
            yield [["start", 0.0], [f"set{kind}", [reference], [value]]]
            yield [*_running(), [f"set{kind}", [reference], [value]]]
        yield [*_running(), [f"get{kind}", []], [f"set{kind}", [], []]]
    whole = "Integer" if face == 2 else "Int32"
    for value in (0, 1, -1, 2**31 - 1):
        yield [[f"set{whole}", [table.by_name["n_slips"].number], [value]]]
        yield [*_running(), [f"set{whole}", [table.by_name["n_slips"].number], [value]]]


def _whole(face: int, table: Table) -> Iterator[Calls]:
    """Give calls that set whole numbers, and what goes with them or does not."""
    rows = [row for row in table.rows if row.settable and row.kind == "Integer"]
    for row in rows:
        for value in (-(2**31), -1, 0, 1, 2, 3, 4, 5, 12, 13, 2**31 - 1):
            setting = _set_each(face, table, **{row.name: value})
            yield [*setting, ["start", 0.0], ["exitInitializationMode"]]
            yield [*_running(), *setting, ["doStep", 0.01, 0.01]]
            yield [*setting, [f"get{type_of(row, face)}", [row.number]]]
    if not rows:
        return
    together: tuple[dict[str, float], ...] = (
        {"shape": 3, "mu_1": 0.6},
        {"shape": 3, "mu_1": 0.5000000000000001},
        {"shape": 3, "mu_1": 0.6, "n_points": 3, "u_3": 0.05, "load": -20.0},
        {"shape": 3, "n_points": 3, "u_3": 0.1},
        {"shape": 3, "n_points": 4, "u_3": 0.05, "u_4": 1e-300},
        {"shape": 3, "n_points": 12, "u_12": 1.0},
        {"shape": 3, "mu_k": 0.2},
        {"shape": 3, "mu_k": -0.0, "n_points": 12},
        {"shape": 3, "n_points": 3, "u_4": 0.7, "mu_4": 0.1},
        {"shape": 3, "n_points": 3, "mu_12": 0.31},
        {"shape": 3, "mu_k": 0.9, "u_3": 1e22},
        {"shape": 2, "mu_k": 0.9, "u_3": 1e22, "n_points": 5},
        {"shape": 1, "mu_1": 0.9},
    )
    for values in together:
        setting = _set_each(face, table, **values)
        start: Calls = [["start", 0.0], ["exitInitializationMode"], ["doStep", 0.0, 0.01]]
        # A tunable parameter no longer goes with the fixed ones; then it does so again.
        lower = [_set(face, table, mu_s=0.01), ["doStep", 0.01, 0.01]]
        yield [*setting, *start, *lower]
        yield [*setting, *start, _set(face, table, mu_s=0.7, mu_k=0.1), ["doStep", 0.01, 0.01]]
        yield [*setting, [f"get{_REAL[face]}", [table.by_name["x"].number]]]


def _random(face: int, table: Table, count: int) -> Iterator[Calls]:
    """Give lives with values of any size, most of which end by a refusal."""
    random_ = random.Random(face)
    settable = [row for row in _reals(table) if row.settable]
    whole = [row for row in table.rows if row.settable and row.kind == "Integer"]

    def value(name: str) -> float:
        low = table.by_name[name].minimum
        number = math.exp(random_.uniform(-80.0, 80.0) * random_.choice((0.1, 1.0, 8.0)))
        if random_.random() < 0.1:
            number = random_.choice((0.0, -0.0, 5e-324, 1e-310, ABOVE_ZERO, 1.7e308))
        return number if low is not None and random_.random() < 0.97 else -number

    for _ in range(count):
        names = random_.sample(settable, random_.randint(1, 4))
        # Integers first: they choose what the others mean.
        chosen = {row.name: random_.randint(1, 4) for row in whole if random_.random() < 0.7}
        calls = _set_each(face, table, **chosen)
        calls += [_set(face, table, **{row.name: value(row.name) for row in names})]
        calls += [["start", value("x_start")], ["exitInitializationMode"]]
        for _ in range(random_.randint(1, 3)):
            row = random_.choice([each for each in settable if each.variability != "fixed"])
            calls += [["doStep", value("v"), random_.uniform(0.0, _SHORT)]]
            calls += [_set(face, table, **{row.name: value(row.name)})]
        calls += [
            ["doStep", 0.0, _SHORT],
            [f"get{_REAL[face]}", [row.number for row in _reals(table)]],
        ]
        yield calls


def _played(fmu: Path, calls: list[Calls]) -> list[tuple[list[bool], list[str]]]:
    """Return which calls of each list were taken, and the messages."""
    done = python(PROGRAM, fmu, input=json.dumps(calls), timeout=_LIMIT)
    _, *told = done.stderr.split(f"{MARK}\n")
    taken = json.loads(done.stdout.splitlines()[-1])
    assert len(told) == len(taken) == len(calls)
    return [(each, text.splitlines()) for each, text in zip(taken, told, strict=True)]


@needs("cc")
@pytest.mark.parametrize(("face", "law"), EACH)
def test_a_refusal_has_the_words_of_the_python_fmu(
    face: Literal[2, 3], law: str, native: Native, tmp_path: Path, sized: Callable[[int], int]
) -> None:
    """Each call is taken or refused by both, with the same messages to the letter.

    What no law changes is tried under Coulomb's.
    """
    table = native_law(law).spec.table
    alike = (_values, _steps, _phases, _types) if law == "coulomb" else ()
    calls = [each for of in (*alike, _together, _whole) for each in of(face, table)]
    calls += _random(face, table, sized(RANDOM if law == "coulomb" else RANDOM // 5))
    of_python = _played(build(tmp_path, face=face, law=law), calls)
    of_native = _played(native(face, law), calls)
    differ = [each for each in zip(calls, of_python, of_native, strict=True) if each[1] != each[2]]
    assert not differ, (len(differ), *differ[:3])
    # The lists meet every message of the model that the Python FMU has.
    heard = "\n".join(line for _, lines in of_python for line in lines)
    due = MESSAGES[face] if law == "coulomb" else MESSAGES_OF_STRIBECK
    missed = [each for each in due if each not in heard]
    assert not missed, missed
    assert "internal error" not in heard


MESSAGES = {
    2: (
        "is out of range: it must be finite and above 0",
        ", at least 2.23e-308",
        "or the mass lifts off",
        "leave the range of double-precision numbers",
        "their rates leave the range",
        "step size h = -1.0 s is out of range: above 0 and finite",
        "communication point t = nan s is out of range",
        "it holds more than 16777216 transitions",
        "start time = inf s is out of range",
        "setupExperiment is not allowed here: the instance is in phase stepping",
        "doStep is not allowed here: the instance is in phase terminated",
        "cannot be set: the simulation is terminated",
        "is an output: it cannot be set",
        "is fixed: it cannot change after initialization",
        "there is no variable with value reference 2147483647",
        "mode is of type Integer, not Real",
        "mu_k is clamped to",
    ),
    3: (
        "time is the independent variable: it cannot be set",
        "mode is of type Int64, not Float64",
        "fmi3UpdateDiscreteStates is not allowed here: this is co-simulation without event mode",
    ),
}
MESSAGES_OF_STRIBECK = (
    "shape = 4 is out of range: it must be one of 1 (Stribeck), 2 (Hyperbolic), 3 (Curve)",
    "n_points = 13 is out of range",
    "n_points is fixed: it cannot change after initialization",
    "mu_1 = 0.6 is out of range: it must be at most mu_s = 0.5",
    "u_3 = 0.1 m/s is out of range: it must be above u_2 = 0.1 m/s",
    "is ignored: shape is 3 (Curve), whose friction is mu_1 to mu_2",
    "u_4 = 0.7 is ignored: n_points = 3",
    "; u_3 = 1e+22 is ignored",
)
