"""An FMU solved through model exchange: its instances are stepped as those of co-simulation are.

FMPy's CVode solves to the next event, or to the end of the communication step. What is set between
two steps is set in event mode, and the solver begins anew. CVode's own steps pass the end of a
communication step and the time of an event, and the states are interpolated there.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from ctypes import c_double
from types import SimpleNamespace
from typing import Any, ClassVar, Final, Literal

import fmpy
import fmpy.fmi1
import fmpy.fmi2
import fmpy.fmi3

from .description import FmuError
from .instance import Fmi2Instance, Fmi3Instance, FmuFile, FmuInstance

try:
    from fmpy.sundials import CVodeSolver
    from fmpy.sundials.cvode import CVodeSVtolerances
except OSError:  # FMPy has the libraries of few platforms
    CVodeSolver = object

RTOL: Final = 1e-10
"""Relative tolerance of the solver; the absolute one of a state is this part of its nominal value.
A smaller one would never end where derivatives are noisy by 1e-5."""
WITHIN: Final = 1e5 * RTOL
"""Part that is asked for: some hundred steps of a slip add up to a hundred tolerances, and a stick
after a shallow stop is a thousand times as sensitive, 1/lambda^2."""
HOW: Final = f"model exchange, solved by FMPy's CVode at a tolerance of {RTOL:g}"
_MOST_STEPS: Final = 100_000  # of the solver, in one communication step
_MOST_EVENTS: Final = 100  # at one time, and updates of discrete states at one of them
_DISCARD: Final = 2  # status of a call that may succeed in a shorter step
_ROUNDING: Final = 2.0**-51  # part of the time that is too short for CVode


class _Solver(CVodeSolver):  # type: ignore[misc]
    """FMPy's solver, which would not hear of refused calls and of new nominal values."""

    refusal: Exception | None = None

    def ehfun(self, line: int, function: bytes, file: bytes, text: bytes, *_: Any) -> None:
        self.refusal = self.refusal or RuntimeError(text.decode())

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
        self.refusal = None
        super().reset(time)
        CVodeSVtolerances(self.cvode_mem, self.reltol, self.abstol)


class SolvedInstance(FmuInstance):
    """One instance that is solved; ``CALLS`` of FMPy give derivatives, update discrete states."""

    CALLS: ClassVar[tuple[str, str]]

    def __init__(self, fmu: FmuFile) -> None:
        if CVodeSolver is object:
            raise FmuError(f"{fmu.path.name}: FMPy has no solver for {fmpy.platform_tuple}")
        self._sizes = fmu.sizes
        self._solver: _Solver | None = None
        self._in_events: bool | None = None  # None before the end of the initialization
        self._now, self._due = 0.0, math.inf
        super().__init__(fmu)

    def leave(self) -> None:
        """Leave initialization mode, and handle the events of the start."""
        super().leave()
        self._in_events = True
        self._do(self._update)

    def reset(self) -> None:
        """Back to the state after instantiation."""
        super().reset()
        self._solver = self._in_events = None

    def set(self, values: Mapping[str, float]) -> None:
        """Set variables by name, on the way in event mode."""
        if values and self._in_events is False:
            self._do(self._enter_events)
        super().set(values)

    def step(self, time: float, h: float) -> None:
        """Solve from `time` [s] by `h` [s], through all events."""
        self._now = self._now if self._solver else time
        try:
            self._solve(time + h)
        except FmuError:
            raise
        except Exception as error:
            refusal = self._solver and self._solver.refusal
            raise self._failure(f"solving to t = {time + h!r}", refusal or error) from None

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
            self._refuse(ends, "ends the simulation")
            if found or wanted or self._now >= self._due:
                events = 0 if self._now > begin else events + 1
                self._refuse(events == _MOST_EVENTS, "has events without an end")
                self._enter_events()
            elif self._now >= end:
                return

    def _new_solver(self) -> _Solver:
        names = ["getContinuousStates", "setContinuousStates", self.CALLS[0], "getEventIndicators"]
        names += ["getNominalsOfContinuousStates", "setTime"]
        calls = [getattr(self._slave, name) for name in names]
        how = {"relativeTolerance": RTOL, "maxNumSteps": _MOST_STEPS}
        held = SimpleNamespace(apply=lambda _: None)
        return _Solver(*self._sizes, *calls, held, self._now, **how)

    def _enter_events(self) -> None:
        self._slave.enterEventMode()
        self._in_events = True

    def _update(self) -> None:
        for _ in range(_MOST_EVENTS):
            before = self._states()
            again, ends, _, moved, told, time = getattr(self._slave, self.CALLS[1])()
            self._refuse(ends, "ends the simulation")
            silent = self._solver is not None and not moved and self._states() != before
            self._refuse(silent, "changes its continuous states and does not say so")
            if not again:
                break
        self._refuse(again, "updates its discrete states without an end")
        self._due = time if told else math.inf

    def _states(self) -> list[float]:
        values = (c_double * self._sizes[0])()
        self._slave.getContinuousStates(values, len(values))
        return list(values)

    def _refuse(self, so: bool, what: str) -> None:
        if so:
            raise FmuError(f"{self.file.path.name}: {what} at t = {self._now!r}")


class Solved2(SolvedInstance, Fmi2Instance):
    """One instance of an FMU 2.0 that is solved."""

    SLAVE, CALLS = fmpy.fmi2.FMU2Model, ("getDerivatives", "newDiscreteStates")


class Solved3(SolvedInstance, Fmi3Instance):
    """One instance of an FMU 3.0 that is solved."""

    SLAVE, CALLS = fmpy.fmi3.FMU3Model, ("getContinuousStateDerivatives", "updateDiscreteStates")


class SolvedFile(FmuFile):
    """An FMU that is driven through model exchange."""

    KIND, FACES = "ModelExchange", {"2.0": Solved2, "3.0": Solved3}


Interface = Literal["cs", "me"]
OPENED: Final[Mapping[Interface, type[FmuFile]]] = {"cs": FmuFile, "me": SolvedFile}
"""Files by the interface through which an FMU is driven: co-simulation, or model exchange."""
