"""The native FMU refuses what the Python FMU refuses, and warns of what it warns of: same words."""

import math
from collections.abc import Iterable, Iterator
from typing import Any

import pytest

from fmi.table import Table, Variable
from stickslip_native.named import native_law
from tests.conftest import built
from tests.driver import Host, numbers_as_repr
from tests.native.heard import MARK, heard
from tests.needs import needs

Calls = list[list[Any]]

NOT_FINITE = (math.nan, math.inf, -math.inf)
BAD = (-1.0, -0.1, -1e-300, 0.0, 5e-324, 1e-310, 1e300, *NOT_FINITE)
WHOLE = (-(2**31), -1, 0, 1, 2, 3, 4, 5, 12, 13, 2**31 - 1)
RUNNING: Calls = [["start"], ["step", 0.01]]

TOGETHER: list[dict[str, float]] = [
    {"load": -10.0},
    {"m": 0.1, "load": -1e3},
    {"k": 1e300, "m": 1e-300},
    {"c": 1e300, "m": 1e-10},
    {"c": 1e200},
    {"k": 1e-300, "c": 1e308},
    {"mu_s": 1e308},
    {"x_start": 1.7e308, "z_start": 1e308},
    {"v": 1e300},
    # The pull passes the largest number in a stick; the motion is finite, the work infinite.
    {"mu_s": 1e300, "k": 1e-10, "v": 1e300},
    {"mu_s": 1e200, "k": 1.0, "v": 1e160},
    {"F_ext": 1e308, "z_start": 1e308},
    {"mu_k": 0.9},
    {"mu_s": 0.0, "mu_k": 5e-324},
    {"mu_s": -0.0, "mu_k": 1e22},
]
OF_A_CURVE: list[dict[str, float]] = [
    {"shape": 3, "mu_1": 0.6},
    {"shape": 3, "mu_1": 0.6, "n_points": 3, "u_3": 0.05, "load": -20.0},
    {"shape": 3, "n_points": 3, "u_3": 0.1},
    {"shape": 3, "n_points": 4, "u_3": 0.05, "u_4": 1e-300},
    {"shape": 3, "mu_k": 0.2},
    {"shape": 3, "mu_k": -0.0, "n_points": 12},
    {"shape": 3, "n_points": 3, "u_4": 0.7, "mu_4": 0.1},
    {"shape": 3, "mu_k": 0.9, "u_3": 1e22},
    {"shape": 1, "mu_1": 0.9},
    {"v_s": 2.3e-308, "mu_k": 0.0},
]
CLAMPED = [
    ((0.3, 0.5), (0.3, 0.5), (0.3, 0.6), (0.3, 0.5)),
    ((0.3, 0.5), (0.5, 0.3), (0.3, 0.5)),
    ((0.0, 0.5), (-0.0, 0.5)),
]
"""Pairs of mu_s and mu_k that follow each other: a warning is told once, until another is."""


def of_each(rows: Iterable[Variable]) -> Iterator[Calls]:
    for row in rows:
        name, start = row.name, row.start or 0
        for value in BAD if row.kind == "Real" else WHOLE:
            yield [["set", {name: value}], ["get", name], ["start"]]
            yield [*RUNNING, ["set", {name: value}], ["step", 0.01]]
        yield [*RUNNING, ["set", {name: start + 1}]]
        yield [*RUNNING, ["terminate"], ["set", {name: start}]]
        yield [["enter"], ["set", {name: start}]]


def of_several(table: Table) -> Iterator[Calls]:
    works = [["get", "x"], ["get", "W_pull", "Q_friction", "W_k"], ["get", "k"]]
    # Slips that are power series take the Python block long.
    step = ["step", 0.3 if "shape" in table.by_name else 30.0]
    for values in TOGETHER + (OF_A_CURVE if "shape" in table.by_name else []):
        yield [["start", 1.0, values], ["step", 1.0], ["set", {"mu_s": 0.01}], ["step", 0.01]]
        yield [["start", values], ["set", {"mu_s": 0.7, "mu_k": 0.1}], ["step", 0.01]]
        for name in ("x", "W_pull"):
            yield [["set", values], ["get", name]]
        tunable = {k: v for k, v in values.items() if table.by_name[k].variability != "fixed"}
        yield [*RUNNING, ["set", tunable], step, *works]
        yield [*RUNNING, ["set", tunable], ["set", tunable], step, step, *works]
    for pairs in CLAMPED:
        calls = list(RUNNING)
        for mu_s, mu_k in pairs:
            calls += [["set", {"mu_s": mu_s, "mu_k": mu_k}], ["set", {"v": mu_k}], ["step", 0.01]]
        yield calls


def of_phases(version: int) -> Iterator[Calls]:
    # 3e3 s hold 9,000 slips.
    for h in (3e3, 0.0, -0.0, -1.0, -5e-324, *NOT_FINITE, 1e17, 1e300, 12345678.9e9):
        yield [*RUNNING, ["step", h]]
        yield [*RUNNING, ["set", {"c": 1.0, "v": -0.3}], ["step", h]]
    shown = [1] if version == 2 else [True, *[None] * 4]
    for time in NOT_FINITE if version == 2 else ():
        for step in (0.01, -1.0):
            yield [*RUNNING, ["call", "DoStep", time, step, *shown]]
        yield [*RUNNING, ["set", {"load": -10.0}], ["call", "DoStep", time, 1.0, *shown]]
    ways: tuple[Calls, ...] = ([], [["enter"]], RUNNING[:1], RUNNING, [["terminate"]],
                               [*RUNNING, ["terminate"]])  # fmt: skip
    for way in ways:
        calls: Calls = [["call", "EnterInitializationMode"], ["call", "ExitInitializationMode"],
                        ["step", 0.1], ["step", -0.1], ["terminate"], ["get", "x"]]  # fmt: skip
        if version == 2:
            starts = (3.0, *NOT_FINITE)
            calls += [["call", "SetupExperiment", 0, 0.0, start, 0, 0.0] for start in starts]
        else:
            calls[0] = ["enter"]
            calls += [["call", "UpdateDiscreteStates", *[None] * 6], ["call", "SetTime", 0.0]]
        yield from ([*way, call] for call in calls)


def of_types(version: int, table: Table) -> Iterator[Calls]:
    kinds: dict[str, Any] = {"Real": 1.5, "Integer": 1} if version == 2 else {}
    kinds |= {"Float64": 1.5, "Int32": 1, "Int64": 1, "UInt64": 1} if version == 3 else {}
    count = len(table.rows)
    for kind, value in (kinds | {"Boolean": False, "String": None}).items():
        # The wrapper of FMI 2.0 takes larger references for negative ones.
        known = range(count + (version == 3 and kind != "Float64"))
        for reference in (*known, 2**31 - 1):
            yield [["enter"], ["values", "Get", kind, [reference], [0 if value else value]]]
            if value is not None:
                yield [["enter"], ["values", "Set", kind, [reference], [value]]]
                yield [*RUNNING, ["values", "Set", kind, [reference], [value]]]
        yield [*RUNNING, *(["values", verb, kind, [], []] for verb in ("Get", "Set"))]
    if version == 3:
        for references in ([count], [999, count]):
            yield [["values", "Set", "Float64", references, [1.0] * len(references)]]


def told(host: Host, kind: str, law: str, lists: list[Calls]) -> list[tuple[int, list[str]]]:
    found = host.call(heard, built(kind, law), lists, timeout=600.0)
    errors = host.errors().split(f"{MARK}\n")[1:]
    assert len(found) == len(errors) == len(lists)
    if kind.startswith("python"):
        return [(taken, text.splitlines()) for (taken, _), text in zip(found, errors, strict=True)]
    assert not any(errors)
    name = native_law(law).spec.name
    return [(taken, [f"{name}: {each}" for each in texts]) for taken, texts in found]


def alike(said: tuple[Any, list[str]]) -> tuple[Any, list[str]]:
    return said[0], [numbers_as_repr(text) for text in said[1]]


@needs("cc")
@pytest.mark.parametrize("law", ["coulomb", "stribeck"])
@pytest.mark.parametrize("version", [2, 3])
def test_a_refusal_and_a_warning_have_the_words_of_the_python_fmu(
    version: int, law: str, host: Host
) -> None:
    table = native_law(law).spec.table
    lists = list(of_several(table))
    own: list[Calls] = []
    if law == "coulomb":
        lists += of_each(table.rows)
        own = [*of_phases(version), *of_types(version, table)]
    else:
        lists += of_each(row for row in table.rows if row.settable and row.kind == "Integer")
    # The Python FMU is one of FMI 2.0.
    lists, own = (lists + own, []) if version == 2 else (lists, own)
    python, native = (told(host, kind, law, lists) for kind in ("python-2", f"native-{version}"))
    pairs = zip(lists, map(alike, python), map(alike, native), strict=True)
    differ = [each for each in pairs if each[1] != each[2]]
    assert not differ, (len(differ), *differ[:3])
    native += told(host, f"native-{version}", law, own)
    heard_ = "\n".join(line for _, texts in native for line in texts)
    due = EVERY[law] + OF_VERSION[version] * (law == "coulomb")
    assert not [words for words in due if words not in heard_]
    assert "internal error" not in heard_


# Else the lists are tame: words that each law's messages must have.
EVERY = {
    "coulomb": (
        "must be finite and above 0", ", at least 2.23e-308", "or the mass lifts off",
        "leave the range of double-precision numbers", "their rates leave the range",
        "it holds more than 16777216 transitions", "is in phase terminated",
        "the simulation is terminated", "is fixed: it cannot", "mu_k is clamped to",
    ),
    "stribeck": (
        "shape = 4 is out of range", "n_points is fixed", "it must be at most mu_s = 0.5",
        "it must be above u_2 = 0.1 m/s", "is ignored: shape is 3", "is ignored: n_points = 3",
        "v_s = 2.3e-308 m/s is out of range: its rate",
    ),
}  # fmt: skip
OF_VERSION = {
    2: (
        "communication point t = nan s is",
        "start time = inf s is",
        "is of type Integer, not Real",
    ),
    3: ("time is the independent variable", "is of type Int64, not Float64", "without clocks"),
}
