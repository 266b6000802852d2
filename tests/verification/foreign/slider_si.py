"""A foreign FMU 3.0: the slider in SI, under names of its own, able to keep its state."""

from __future__ import annotations

import copy
import math
from functools import partial
from typing import Any

from pythonfmu3 import Boolean, Float64, Fmi3Causality, Fmi3Slave, Fmi3Variability, Int32, UInt64
from pythonfmu3.fmi3slave import Fmi3StepResult
from pythonfmu3.unit import Unit

from tests.verification.foreign.exact_block import ExactBlock

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
    ("mass", "kilogram", "m", 1.0),
    ("gravity", "m/s2", "g", 9.81),
    ("stiffness", "N/m", "k", 1000.0),
    ("mu_static", None, "mu_s", 0.5),
    ("mu_kinetic", None, "mu_k", 0.3),
)
OUTPUTS = (
    ("slider_position", "m", "x"),
    ("slider_speed", "m/s", "x_dot"),
    ("driven_position", "m", "x_pull"),
    ("extension", "m", "z"),
    ("spring_force", "N", "F"),
    ("friction_force", "N", "F_friction"),
    ("break_away_force", "N", "F_s"),
    ("jump", "m", "delta_x"),
    ("relief", "m", "spring_drop"),
    ("stick_time", "s", "t_stick"),
    ("slip_time", "s", "t_slip"),
    ("period", "s", "T"),
    ("top_speed", "m/s", "x_dot_peak"),
)

# A pull beyond this [m/s] makes the step say that the simulation is over.
FASTEST = 10.0


class SliderSi(Fmi3Slave):  # type: ignore[misc]
    """The undamped slider behind a face of FMI 3.0."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.given = {key: start for _, _, key, start in PARAMETERS} | {"v": 0.02}
        self.shown: dict[str, float] = {}
        self.block = ExactBlock(self.given, 0.0)
        self.time = 0.0
        self.register_variable(
            Float64(
                "time", causality=Fmi3Causality.independent, variability=Fmi3Variability.continuous
            )
        )
        self.register_units(list(UNITS))
        parameter, fixed = Fmi3Causality.parameter, Fmi3Variability.fixed
        for name, unit, key, _ in PARAMETERS:
            self._given(name, unit, key, parameter, fixed)
        self._given("pull_speed", "m/s", "v", Fmi3Causality.input, Fmi3Variability.continuous)
        for name, unit, key in OUTPUTS:
            variable = Float64(
                name,
                causality=Fmi3Causality.output,
                variability=Fmi3Variability.continuous,
                unit=unit,
                getter=partial(self._see, key),
            )
            self.register_variable(variable)
        discrete = {"causality": Fmi3Causality.output, "variability": Fmi3Variability.discrete}
        for kind, name, key in (
            (Int32, "phase", "mode"),
            (UInt64, "slips", "n_slips"),
            (Boolean, "stuck", "sticking"),
        ):
            self.register_variable(kind(name, getter=partial(self._see, key), **discrete))

    def _see(self, key: str) -> float:
        return self.shown.get(key, 0)

    def _given(self, name: str, unit: str | None, key: str, causality: Any, varies: Any) -> None:
        self.register_variable(
            Float64(
                name,
                causality=causality,
                variability=varies,
                unit=unit,
                getter=lambda: self.given[key],
                setter=lambda value: self.given.update({key: value}),
            )
        )

    def exit_initialization_mode(self) -> None:
        """Begin at rest."""
        self.block = ExactBlock(self.given, 0.0)
        self.shown = self.block.outputs()

    def do_step(self, current_time: float, step_size: float) -> Any:
        """Move."""
        pull = self.given["v"]
        if math.isfinite(pull):
            if pull != self.block.p["v"]:
                self.block.change({"v": pull})
            self.block.advance(current_time, step_size)
            self.shown = self.block.outputs()
        return Fmi3StepResult(terminateSimulation=not abs(pull) <= FASTEST)

    def _get_fmu_state(self) -> dict[str, Any]:
        kept = {"given": self.given, "shown": self.shown, "block": vars(self.block)}
        return copy.deepcopy(kept)

    def _set_fmu_state(self, state: dict[str, Any]) -> None:
        kept = copy.deepcopy(state)
        self.given, self.shown = kept["given"], kept["shown"]
        vars(self.block).update(kept["block"])
