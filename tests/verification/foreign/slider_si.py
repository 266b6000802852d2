"""A foreign FMU 3.0: the slider in SI, under names of its own, able to keep its state."""

from __future__ import annotations

import math
from typing import Any

from pythonfmu3 import Boolean, Float64, Fmi3Causality, Fmi3Slave, Fmi3Variability, Int32, UInt64
from pythonfmu3.fmi3slave import Fmi3StepResult
from pythonfmu3.unit import Unit

from tests.verification.foreign.spring_and_slider import SpringAndSlider

UNITS = (
    Unit("kilogram", kg=1),
    Unit("m", m=1),
    Unit("m/s", m=1, s=-1),
    Unit("m/s2", m=1, s=-2),
    Unit("N/m", kg=1, s=-2),
    Unit("N", kg=1, m=1, s=-2),
    Unit("s", s=1),
)

PARAMETERS = (
    ("mass", "kilogram", "mass"),
    ("gravity", "m/s2", "gravity"),
    ("stiffness", "N/m", "stiffness"),
    ("mu_static", None, "mu_static"),
    ("mu_kinetic", None, "mu_kinetic"),
)
OUTPUTS = (
    ("slider_position", "m", "position"),
    ("slider_speed", "m/s", "speed"),
    ("driven_position", "m", "driven"),
    ("extension", "m", "extension"),
    ("spring_force", "N", "force"),
    ("friction_force", "N", "friction"),
    ("break_away_force", "N", "threshold"),
    ("jump", "m", "jump"),
    ("relief", "m", "relief"),
    ("stick_time", "s", "stick_time"),
    ("slip_time", "s", "slip_time"),
    ("period", "s", "period"),
    ("top_speed", "m/s", "top_speed"),
)

# A pull beyond this [m/s] makes the step say that the simulation is over.
FASTEST = 10.0


class SliderSi(Fmi3Slave):  # type: ignore[misc]
    """The slider behind a face of FMI 3.0."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.block = SpringAndSlider()
        self.time = 0.0
        self.register_variable(
            Float64(
                "time", causality=Fmi3Causality.independent, variability=Fmi3Variability.continuous
            )
        )
        self.register_units(list(UNITS))
        for name, unit, attribute in PARAMETERS:
            self._real(name, unit, attribute, Fmi3Causality.parameter)
        self._real("pull_speed", "m/s", "pull", Fmi3Causality.input)
        for name, unit, attribute in OUTPUTS:
            self._real(name, unit, attribute, Fmi3Causality.output)
        discrete = {"causality": Fmi3Causality.output, "variability": Fmi3Variability.discrete}
        block = self.block
        self.register_variable(Int32("phase", getter=lambda: block.phase, **discrete))
        self.register_variable(UInt64("slips", getter=lambda: block.count, **discrete))
        self.register_variable(Boolean("stuck", getter=lambda: block.phase == 0, **discrete))

    def _real(self, name: str, unit: str | None, attribute: str, causality: Any) -> None:
        variability = (
            Fmi3Variability.fixed
            if causality is Fmi3Causality.parameter
            else Fmi3Variability.continuous
        )
        self.register_variable(
            Float64(
                name,
                causality=causality,
                variability=variability,
                unit=unit,
                getter=lambda: getattr(self.block, attribute),
                setter=lambda value: setattr(self.block, attribute, value),
            )
        )

    def exit_initialization_mode(self) -> None:
        """Begin at rest."""
        self.block.start()

    def do_step(self, current_time: float, step_size: float) -> Any:
        """Move."""
        if math.isfinite(self.block.pull):
            self.block.move(step_size)
        return Fmi3StepResult(terminateSimulation=not abs(self.block.pull) <= FASTEST)

    def _get_fmu_state(self) -> dict[str, Any]:
        block = self.block
        return {**vars(block), "arc": dict(block.arc), "slip_from": list(block.slip_from)}

    def _set_fmu_state(self, state: dict[str, Any]) -> None:
        kept = {**state, "arc": dict(state["arc"]), "slip_from": list(state["slip_from"])}
        vars(self.block).update(kept)
