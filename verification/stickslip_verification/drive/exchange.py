"""An FMU solved through model exchange: its instances are stepped as those of co-simulation are.

FMPy's CVode solves to the next event, or to the end of the communication step. What is set between
two steps is set in event mode, and the solver begins anew. CVode's own steps pass the end of a
communication step and the time of an event, and the states are interpolated there.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar, Final

import fmpy.fmi1
import fmpy.fmi2
import fmpy.fmi3
from fmpy.sundials import CVodeSolver
from fmpy.sundials.cvode import CVodeSVtolerances

from .description import FmuError
from .instance import Fmi2Instance, Fmi3Instance, FmuFile, FmuInstance

RTOL: Final = 1e-10
"""Relative tolerance of the solver; the absolute one of a state is this part of its nominal value.

An FMU is asked to be within 1e-6: a slip of some hundred steps adds up to a hundred tolerances, and
a stick after a shallow stop has another hundred."""
HOW: Final = f"model exchange, solved by FMPy's CVode at a tolerance of {RTOL:g}"
_MOST_STEPS: Final = 100_000  # of the solver, in one communication step
_MOST_EVENTS: Final = 100  # at one time, and updates of discrete states at one of them
_DISCARD: Final = 2  # status of a call that may succeed in a shorter step
_ROUNDING: Final = 2.0**-51  # part of the time that is too short for CVode


class _Solver(CVodeSolver):  # type: ignore[misc]
    """FMPy's solver, but for refused calls, of which it does not hear, and new nominal values."""

    refusal: Exception | None = None

    def f(self, *arguments: Any) -> int:
        return self._tried(super().f, *arguments)

    def g(self, *arguments: Any) -> int:
        return self._tried(super().g, *arguments)

    def _tried(self, function: Callable[..., int], *arguments: Any) -> int:
        try:
            return function(*arguments)
        except fmpy.fmi1.FMICallException as error:
            self.refusal = error
            return 1 if error.status == _DISCARD else -1

    def reset(self, time: float) -> None:
        super().reset(time)
        CVodeSVtolerances(self.cvode_mem, self.reltol, self.abstol)

    def apply(self, _: float) -> None:
        """Set no inputs: they are held from event to event."""


class SolvedInstance(FmuInstance):
    """One instance that is solved; FMPy calls its functions ``RATES`` and ``UPDATE`` otherwise."""

    RATES: ClassVar[str]
    UPDATE: ClassVar[str]

    def __init__(self, fmu: FmuFile) -> None:
        self._sizes = fmu.sizes
        self._solver: _Solver | None = None
        self._initialized = self._in_events = False
        self._now, self._due = 0.0, math.inf
        super().__init__(fmu)

    def enter(self, start_time: float) -> None:
        """Enter initialization mode, time beginning at `start_time` [s]."""
        self._now = start_time
        super().enter(start_time)

    def leave(self) -> None:
        """Leave initialization mode, and handle the events of the start."""
        super().leave()
        self._initialized = self._in_events = True
        self._do(self._update)

    def reset(self) -> None:
        """Back to the state after instantiation."""
        super().reset()
        self._solver, self._initialized, self._in_events = None, False, False

    def writer(self, names: Sequence[str]) -> Callable[[Sequence[float]], None]:
        """Return a function that sets these variables at once, in event mode once initialized."""
        write = super().writer(names)

        def written(values: Sequence[float]) -> None:
            if names and self._initialized and not self._in_events:
                self._do(self._enter_events)
            write(values)

        return written

    def step(self, time: float, h: float) -> None:
        """Solve from `time` [s] by `h` [s], through all events."""
        try:
            self._solve(time + h)
        except FmuError:
            raise
        except Exception as error:
            refusal = self._solver and self._solver.refusal
            call = f"the solver, at t = {self._now!r} on the way to {time + h!r},"
            raise self._failure(call, refusal or error) from None

    def _solve(self, end: float) -> None:
        events = 0
        while True:
            if self._in_events:
                self._update()
                self._slave.enterContinuousTimeMode()
                self._in_events = False
                self._solver = self._solver or self._new_solver()
                self._solver.reset(self._now)
            assert self._solver is not None
            begin, found = self._now, False
            self._now = max(begin, min(end, self._due))
            if self._now - begin > _ROUNDING * max(abs(begin), abs(self._now)):
                found, _, self._now = self._solver.step(begin, self._now)
            self._slave.setTime(self._now)
            wanted, ends = self._slave.completedIntegratorStep()
            if found or wanted or ends or self._now >= self._due:
                events = 0 if self._now > begin else events + 1
                self._go_on(not ends and events < _MOST_EVENTS)
                self._enter_events()
            elif self._now >= end:
                return

    def _new_solver(self) -> _Solver:
        fmu, (states, indicators) = self._slave, self._sizes
        solver = _Solver(
            nx=states,
            nz=indicators,
            get_x=fmu.getContinuousStates,
            set_x=fmu.setContinuousStates,
            get_dx=getattr(fmu, self.RATES),
            get_z=fmu.getEventIndicators,
            get_nominals=fmu.getNominalsOfContinuousStates,
            set_time=fmu.setTime,
            input=None,
            startTime=self._now,
            relativeTolerance=RTOL,
            maxNumSteps=_MOST_STEPS,
        )
        solver.input = solver
        return solver

    def _enter_events(self) -> None:
        self._slave.enterEventMode()
        self._in_events = True

    def _update(self) -> None:
        for count in range(_MOST_EVENTS + 1):
            again, ends, _, _, told, time = getattr(self._slave, self.UPDATE)()
            self._go_on(not ends and count < _MOST_EVENTS)
            if not again:
                break
        self._due = time if told else math.inf

    def _go_on(self, may: bool) -> None:
        if not may:
            why = "it ends the simulation, or its events have no end"
            raise FmuError(f"{self.file.path.name}: at t = {self._now!r} {why}")


class Solved2(SolvedInstance, Fmi2Instance):
    """One instance of an FMU 2.0 that is solved."""

    SLAVE, RATES, UPDATE = fmpy.fmi2.FMU2Model, "getDerivatives", "newDiscreteStates"


class Solved3(SolvedInstance, Fmi3Instance):
    """One instance of an FMU 3.0 that is solved."""

    SLAVE = fmpy.fmi3.FMU3Model
    RATES, UPDATE = "getContinuousStateDerivatives", "updateDiscreteStates"


class SolvedFile(FmuFile):
    """An FMU that is driven through model exchange."""

    INTERFACE = "ModelExchange"
    FACES: ClassVar[Mapping[str, type[FmuInstance]]] = {"2.0": Solved2, "3.0": Solved3}
