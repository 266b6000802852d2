"""Face of a foreign FMU 2.0: variables from tables, changes taken from one step to the next."""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, Protocol
from xml.etree.ElementTree import Element, SubElement

from pythonfmu import Boolean, Fmi2Causality, Fmi2Slave, Fmi2Variability, Integer, Real

UNITS: dict[str, dict[str, str]] = {
    "kg": {"kg": "1"},
    "t": {"kg": "1", "factor": "1000"},
    "m": {"m": "1"},
    "mm": {"m": "1", "factor": "0.001"},
    "millimetre": {"m": "1", "factor": "1e-3"},
    "m/s": {"m": "1", "s": "-1"},
    "mm/s": {"m": "1", "s": "-1", "factor": "0.001"},
    "m/s2": {"m": "1", "s": "-2"},
    "mm/s2": {"m": "1", "s": "-2", "factor": "0.001"},
    "N/m": {"kg": "1", "s": "-2"},
    "N/mm": {"kg": "1", "s": "-2", "factor": "1000"},
    "N.s/m": {"kg": "1", "s": "-1"},
    "N.s/mm": {"kg": "1", "s": "-1", "factor": "1000"},
    "N": {"kg": "1", "m": "1", "s": "-2"},
    "kN": {"kg": "1", "m": "1", "s": "-2", "factor": "1000"},
    "s": {"s": "1"},
    "ms": {"s": "1", "factor": "0.001"},
    "Hz": {"s": "-1"},
    "kHz": {"s": "-1", "factor": "1000"},
    "J": {"kg": "1", "m": "2", "s": "-2"},
    "mJ": {"kg": "1", "m": "2", "s": "-2", "factor": "0.001"},
    "1": {},
}
"""Units of the foreign FMUs: what each is in the base units of FMI."""

COUNT, FLAG = "count", "flag"
"""In place of the unit of an output that is an Integer or a Boolean."""


KEPT: list[object] = []
"""Instances, classes and logs at an exception: the wrapper releases one reference too many of each,
and the second failure would crash the host."""


class Given(NamedTuple):
    """A parameter or input: its key in the block, its name and unit in the FMU, its start [SI]."""

    key: str
    name: str
    unit: str
    start: float
    sign: int = 1


class Shown(NamedTuple):
    """An output: its key in the block, its name and unit in the FMU."""

    key: str
    name: str
    unit: str
    sign: int = 1


class Block(Protocol):
    """What a face drives: values in force `p` [SI], changed between moves; outputs by key [SI]."""

    p: dict[str, float]

    def change(self, values: Mapping[str, float]) -> None:
        """Put values in force, at the present state."""

    def advance(self, now: float, h: float) -> None:
        """Move on from the time `now` by `h` [s]."""

    def outputs(self) -> dict[str, float]:
        """Return the outputs at the present state."""


class ForeignFace(Fmi2Slave):  # type: ignore[misc]
    """Variables of a block and the calls of FMI 2.0.

    An input or tunable parameter acts from the start of the next step. Outputs show the end of the
    last step.
    """

    fixed: Sequence[Given] = ()
    tunable: Sequence[Given] = ()
    inputs: Sequence[Given] = ()
    shows: Sequence[Shown] = ()

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.given: dict[str, float] = {}
        self.shown: dict[str, float] = {}
        self.block: Any = None
        self.start_time = 0.0
        self.units: dict[str, str] = {}
        parameter, fixed = Fmi2Causality.parameter, Fmi2Variability.fixed
        for row in self.fixed:
            self._declare_given(row, parameter, fixed)
        for row in self.tunable:
            self._declare_given(row, parameter, Fmi2Variability.tunable)
        for row in self.inputs:
            self._declare_given(row, Fmi2Causality.input, Fmi2Variability.continuous)
        for shown in self.shows:
            self._declare_shown(shown)

    def make_block(self) -> Block:
        """Return the block at its start, from what was given."""
        raise NotImplementedError

    def at_start(self) -> dict[str, float]:
        """Return what the outputs show after initialization."""
        shown: dict[str, float] = self.block.outputs()
        return shown

    def take(self, key: str, value: float) -> None:
        """Keep a value [SI] that the master sets."""
        self.given[key] = value

    def see(self, key: str) -> float:
        """Return an output [SI]."""
        return self.shown.get(key, 0.0)

    def _declare_given(self, row: Given, causality: Any, variability: Any) -> None:
        key, size = row.key, _size(row.unit, row.sign)
        self.given[key] = row.start
        self.units[row.name] = row.unit
        variable = Real(
            row.name,
            causality=causality,
            variability=variability,
            getter=lambda: self.given[key] / size,
            setter=lambda value: self.take(key, value * size),
        )
        self.register_variable(variable, nested=False)

    def _declare_shown(self, row: Shown) -> None:
        key, causality, discrete = row.key, Fmi2Causality.output, Fmi2Variability.discrete
        variable: Any
        if row.unit == FLAG:
            variable = Boolean(
                row.name,
                causality=causality,
                variability=discrete,
                getter=lambda: bool(self.see(key)),
            )
        elif row.unit == COUNT:
            variable = Integer(
                row.name,
                causality=causality,
                variability=discrete,
                getter=lambda: int(self.see(key)) * row.sign,
            )
        else:
            size = _size(row.unit, row.sign)
            self.units[row.name] = row.unit
            variable = Real(row.name, causality=causality, getter=lambda: self.see(key) / size)
        self.register_variable(variable, nested=False)

    def to_xml(self, model_options: Any = None) -> Element:
        """Add the units, which the stock description leaves out."""
        root: Element = super().to_xml(model_options or {})
        definitions = Element("UnitDefinitions")
        for name in dict.fromkeys(self.units.values()):
            SubElement(SubElement(definitions, "Unit", name=name), "BaseUnit", UNITS[name])
        root.insert(1, definitions)
        for variable in root.iter("ScalarVariable"):
            name = variable.get("name", "")
            if name in self.units:
                variable[0].set("unit", self.units[name])
        return root

    def setup_experiment(self, start_time: float, *_: Any) -> None:
        """Keep the start time."""
        self.start_time = start_time

    def exit_initialization_mode(self) -> None:
        """Begin; what makes no sense fails."""
        try:
            self.block = self.make_block()
            self.shown = self.at_start()
        except (ArithmeticError, ValueError):
            KEPT.append((self, type(self), self.log_queue))
            raise

    def pending(self) -> dict[str, float]:
        """Return what was set and is not in force yet."""
        changeable = [row.key for row in (*self.tunable, *self.inputs)]
        in_force = self.block.p
        return {key: self.given[key] for key in changeable if self.given[key] != in_force[key]}

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Put what was set in force and move; a step that makes no sense is discarded."""
        numbers = (step_size, *self.given.values())
        if not (step_size > 0.0 and all(math.isfinite(number) for number in numbers)):
            return False
        try:
            changes = self.pending()
            if changes:
                self.block.change(changes)
            self.block.advance(current_time, step_size)
            self.shown = self.block.outputs()
        except (ArithmeticError, ValueError):
            return False
        return True

    def _get_fmu_state(self) -> dict[str, Any]:
        block = None if self.block is None else copy.deepcopy(vars(self.block))
        return {
            "given": dict(self.given),
            "shown": dict(self.shown),
            "start_time": self.start_time,
            "block": block,
        }

    def _set_fmu_state(self, state: dict[str, Any]) -> None:
        self.given = dict(state["given"])
        self.shown = dict(state["shown"])
        self.start_time = state["start_time"]
        if state["block"] is None:
            self.block = None
        else:
            self.block = self.make_block()
            vars(self.block).update(copy.deepcopy(state["block"]))


def _size(unit: str, sign: int) -> float:
    """Return the SI value of the number 1 in a unit, counted with a sign."""
    return sign * float(UNITS[unit].get("factor", "1"))
