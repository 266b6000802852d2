"""A foreign FMU 2.0 of the stock wrapper: in millimetres, the spring counted in compression."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from pythonfmu import Boolean, Fmi2Causality, Fmi2Slave, Fmi2Variability, Integer, Real

from tests.verification.foreign.spring_and_slider import SpringAndSlider

FAULT = 1.0

UNITS: dict[str, dict[str, str]] = {
    "kg": {"kg": "1"},
    "millimetre": {"m": "1", "factor": "1e-3"},
    "mm/s": {"m": "1", "s": "-1", "factor": "0.001"},
    "mm/s2": {"m": "1", "s": "-2", "factor": "0.001"},
    "N/mm": {"kg": "1", "s": "-2", "factor": "1000"},
    "N": {"kg": "1", "m": "1", "s": "-2"},
    "kN": {"kg": "1", "m": "1", "s": "-2", "factor": "1000.0"},
    "ms": {"s": "1", "factor": "0.001"},
    "one": {},
}

# Name, unit, attribute of the block, its size in SI.
PARAMETERS = (
    ("slider.mass", "kg", "mass", 1.0),
    ("world.g", "mm/s2", "gravity", 1e-3),
    ("spring.rate", "N/mm", "stiffness", 1e3),
    ("friction.static", "one", "mu_static", 1.0),
    ("friction.kinetic", "one", "mu_kinetic", 1.0),
)
OUTPUTS = (
    ("slider.s", "millimetre", "position", 1e-3),
    ("slider.v", "mm/s", "speed", 1e-3),
    ("drive.s", "millimetre", "driven", 1e-3),
    ("spring.compression", "millimetre", "extension", -1e-3),
    ("spring.force", "kN", "force", 1e3),
    ("friction.force", "N", "friction", 1.0),
    ("friction.limit", "N", "threshold", 1.0),
    ("cycle.jump", "millimetre", "jump", 1e-3),
    ("cycle.relief", "millimetre", "relief", 1e-3),
    ("cycle.stick", "ms", "stick_time", 1e-3),
    ("cycle.slip", "ms", "slip_time", 1e-3),
    ("cycle.period", "ms", "period", 1e-3),
    ("cycle.top", "mm/s", "top_speed", 1e-3),
)


class SliderMm(Fmi2Slave):  # type: ignore[misc]
    """The slider behind a face in millimetres."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.block = SpringAndSlider()
        self.units: dict[str, str] = {}
        for name, unit, attribute, size in PARAMETERS:
            self._real(name, unit, attribute, size, Fmi2Causality.parameter)
        self._real("drive.speed", "mm/s", "pull", 1e-3, Fmi2Causality.input)
        for name, unit, attribute, size in OUTPUTS:
            self._real(name, unit, attribute, size, Fmi2Causality.output)
        self._count(Integer("phase", **self._discrete(lambda: self.block.phase)))
        self._count(Integer("cycle.count", **self._discrete(lambda: self.block.count)))
        self._count(Boolean("stuck", **self._discrete(lambda: self.block.phase == 0)))

    def _real(self, name: str, unit: str, attribute: str, size: float, causality: Any) -> None:
        def get() -> float:
            return float(getattr(self.block, attribute) / size)

        def put(value: float) -> None:
            setattr(self.block, attribute, value * size)

        variability = (
            Fmi2Variability.fixed
            if causality is Fmi2Causality.parameter
            else Fmi2Variability.continuous
        )
        self.units[name] = unit
        self.register_variable(
            Real(name, causality=causality, variability=variability, getter=get, setter=put),
            nested=False,
        )

    def _discrete(self, getter: Callable[[], float]) -> dict[str, Any]:
        return {
            "causality": Fmi2Causality.output,
            "variability": Fmi2Variability.discrete,
            "getter": getter,
        }

    def _count(self, variable: Any) -> None:
        self.register_variable(variable, nested=False)

    def to_xml(self, model_options: Any = None) -> Element:
        """Add the units, which the stock description leaves out."""
        root: Element = super().to_xml(model_options or {})
        definitions = Element("UnitDefinitions")
        for name, base in UNITS.items():
            SubElement(SubElement(definitions, "Unit", name=name), "BaseUnit", base)
        root.insert(1, definitions)
        for variable in root.iter("ScalarVariable"):
            name = variable.get("name", "")
            if name in self.units:
                variable[0].set("unit", self.units[name])
        return root

    def exit_initialization_mode(self) -> None:
        """Begin at rest."""
        self.block.mu_static *= FAULT
        self.block.start()

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Move, if the pull is a number."""
        if not math.isfinite(self.block.pull):
            return False
        self.block.move(step_size)
        return True
