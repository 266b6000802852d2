"""Face of a foreign FMU in Python: FMI 2.0 or 3.0, any names, units and signs; faults, misdeeds."""

from __future__ import annotations

import copy
import ctypes
import importlib
import math
import os
import sys
import time
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from tests.makers.foreign_block import START, ForeignBlock
from tests.makers.step_block import StepBlock

KINDS = {
    "mode": ("Integer", "Int32"),
    "n_slips": ("Integer", "UInt64"),
    "sticking": ("Boolean",) * 2,
}
"""Types of the outputs that are no reals, in FMI 2.0 and 3.0."""

KEPT: list[object] = []
"""Instances, classes and logs at an exception: the wrapper releases one reference too many of each,
and the second failure would crash the host."""


class Face:
    """Variables and calls of FMI of a block, made as `settings` say: see `tests.makers.Foreign`."""

    settings: dict[str, Any]

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.given = dict(START)
        self.shown: dict[str, float] = {}
        self.block: ForeignBlock | StepBlock | None = None
        self.start_time, self.owed, self.steps = 0.0, 0.0, 0
        self.is_3 = self.settings["fmi"] == 3
        self.fault, self.conventions = self.settings["fault"], self.settings["conventions"]
        self.api = importlib.import_module("pythonfmu3" if self.is_3 else "pythonfmu")
        if self.is_3:
            self._declare("time", "", "independent", "continuous")
            units = self.settings["units"].items()
            self.register_units([self.api.Unit(name, **base) for name, base in units])  # type: ignore[attr-defined]
        for key, (name, unit, sign, causality, variability) in self.settings["rows"].items():
            size = sign * float(self.settings["units"].get(unit, {}).get("factor", 1.0))
            self._declare(name, unit, causality, variability, key, size)

    def _declare(
        self, name: str, unit: str, causality: str, variability: str, key: str = "", size: float = 1
    ) -> None:
        kind = KINDS.get(key, ("Real", "Float64"))[self.is_3]
        version = 3 if self.is_3 else 2
        given: dict[str, Any] = {}
        if key in KINDS:
            given["getter"] = lambda: self.see(key) * int(size)
        elif causality == "output":
            given["getter"] = lambda: self.see(key) / size
        elif key:
            given["getter"] = lambda: self.given[key] / size
            given["setter"] = lambda value: self.take(key, value * size)
        if unit and self.is_3:
            given["unit"] = unit
        variable = getattr(self.api, kind)(
            name,
            causality=getattr(self.api, f"Fmi{version}Causality")[causality],
            variability=getattr(self.api, f"Fmi{version}Variability")[variability],
            **given,
        )
        self.register_variable(variable, nested=False)  # type: ignore[attr-defined]

    def to_xml(self, *options: Any) -> Element:
        root: Element = super().to_xml(*options)  # type: ignore[misc]
        if not self.is_3:
            definitions = Element("UnitDefinitions")
            for unit, base in self.settings["units"].items():
                texts = {name: str(value) for name, value in base.items()}
                SubElement(SubElement(definitions, "Unit", name=unit), "BaseUnit", texts)
            root.insert(1, definitions)
            units = {name: unit for name, unit, *_ in self.settings["rows"].values() if unit}
            for variable in root.iter("ScalarVariable"):
                if unit := units.get(variable.get("name", "")):
                    variable[0].set("unit", unit)
        return root

    def setup_experiment(self, start_time: float, *_: Any) -> None:
        self.start_time = start_time

    def _make(self) -> Any:
        keys = ("order", "step", "fault")
        how = {key: self.settings[key] for key in keys if self.settings[key]}
        block = StepBlock if self.settings["plain"] else ForeignBlock
        return block(self.given, self.start_time, self.conventions, **how)

    def exit_initialization_mode(self) -> None:
        try:
            self.block = self._make()
            self.shown = {} if "start" in self.conventions else self.block.outputs()
        except (ArithmeticError, ValueError):
            KEPT.append((self, type(self), self.log_queue))  # type: ignore[attr-defined]
            raise

    def take(self, key: str, value: float) -> None:
        self.given[key] = value
        if self.fault == "clamp when set":
            self.given["mu_k"] = min(self.given["mu_k"], self.given["mu_s"])

    def see(self, key: str) -> float:
        if self.owed > 0.0:
            self._move(0.0, self.owed)
            self.owed = 0.0
        return self.shown.get(key, 0)

    def _move(self, now: float, h: float) -> None:
        assert self.block is not None
        self.block.advance(now, h)
        self.shown = self.block.outputs()

    def do_step(self, current_time: float, step_size: float) -> Any:
        self.steps += 1
        if self.steps == 3 and self.settings["misdeed"]:
            KEPT.append((self, type(self), self.log_queue))  # type: ignore[attr-defined]
            misbehave(self.settings["misdeed"], self)
        over = self.settings["misdeed"] == "terminate" and self.steps >= 3
        done = self._step(current_time, step_size) and not (
            self.settings["misdeed"] == "discard" and self.steps >= 3
        )
        return self.api.Fmi3StepResult(terminateSimulation=over) if self.is_3 else done

    def _step(self, now: float, h: float) -> bool:
        assert self.block is not None
        if not (h > 0.0 and all(map(math.isfinite, (h, *self.given.values())))):
            return False
        changes = {k: v for k, v in self.given.items() if not k.endswith("_start")}
        try:
            if changes != {k: self.block.p[k] for k in changes}:
                self.block.change(changes)
            if self.fault == "moves when read":
                self.owed += h
            else:
                self._move(now, h)
        except (ArithmeticError, ValueError):
            return False
        return True

    def _get_fmu_state(self) -> dict[str, Any]:
        kept = {name: getattr(self, name) for name in ("given", "shown", "start_time", "steps")}
        kept["block"] = None if self.block is None else vars(self.block)
        if self.fault == "state loses pending" and self.block is not None:
            kept["given"] = self.block.p
        return copy.deepcopy(kept)

    def _set_fmu_state(self, state: dict[str, Any]) -> None:
        kept = copy.deepcopy(state)
        block = kept.pop("block")
        vars(self).update(kept)
        self.block = None if block is None else self._make()
        vars(self.block).update(block or {})


def misbehave(what: str, face: Any) -> None:
    if what == "crash":
        ctypes.string_at(0)
    if what.startswith("daemon "):
        leave_daemon(Path(what.removeprefix("daemon ")))
    if what == "eat":
        face.eaten = bytearray(1_000_000_000)
    if what == "print":
        for stream in (sys.stdout, sys.stderr):
            stream.write("moving on\n" * 1_000_000)
    if what == "log":
        warning = importlib.import_module("pythonfmu.enums").Fmi2Status.warning
        for _ in range(10_000):
            face.log("moving on " * 1000, warning)
    while what == "hang":
        time.sleep(1.0)
    if what == "raise":
        raise ValueError("the slider has had enough")


def leave_daemon(notes: Path) -> None:
    if os.fork() == 0:
        os.setsid()
        daemon = os.fork()
        if daemon == 0:
            time.sleep(300.0)
        else:
            with notes.open("a", encoding="utf-8") as file:
                file.write(f"{daemon}\n")
        os._exit(0)
    os.wait()
