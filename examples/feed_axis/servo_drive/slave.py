"""The FMI 2.0 face of the drive, for pythonfmu's wrapper.

The wrapper releases references that it does not own at every exception that escapes to it
(`lifetime`). So each method that it calls ends in a value, or in an error that `_fail` made.
"""

from __future__ import annotations

import functools
import math
import sys
from collections.abc import Callable, Sequence
from typing import Any

from pythonfmu import Fmi2Slave

from .controller import Controller, Gains
from .drive import Drive, inertia_at_slide, objection
from .lifetime import give_reference
from .setpoint import SetPoint
from .variables import VARIABLES, Variable

_NO_STATES = "states cannot be taken, set or written out: canGetAndSetFMUstate is false"
# So often a simulator may set or write out the state that a refused call has left it without.
_CALLS_WITH_NULL = 8


class DriveError(Exception):
    """A call that failed; the text is for the user of the simulator."""


def _entry(method: Callable[..., Any]) -> Callable[..., Any]:
    """Make a method safe to be called by the wrapper."""

    @functools.wraps(method)
    def guarded(self: ServoDrive, *arguments: Any) -> Any:
        try:
            if self._fault is not None:
                raise DriveError(self._fault)
            return method(self, *arguments)
        except BaseException as error:  # whatever it is, the importing process must survive it
            raise self._fail(error) from None

    return guarded


class ServoDrive(Fmi2Slave):  # type: ignore[misc]
    """The servo drive as a slave."""

    def __init__(self, **arguments: Any) -> None:
        super().__init__(**arguments)
        self.modelName = "ServoDrive"
        self._values: dict[str, float] = {each.name: each.start for each in VARIABLES}
        self._drive: Drive | None = None
        self._controller: Controller | None = None
        self._set_point = SetPoint(0.0, 1.0, 0.0)
        self._time = 0.0
        self._fault: str | None = None

    @_entry
    def exit_initialization_mode(self) -> None:
        """Start the drive at rest from what was set."""
        values = self._values
        self._set_point = SetPoint(values["feed"], values["acceleration"], values["distance"])
        gains = Gains(**{name: values[name] for name in Gains._fields})  # type: ignore[arg-type]
        self._controller = Controller(gains, self._set_point)
        m_d = inertia_at_slide(values["J"], values["pitch"])
        d, k, T_s = values["d"], values["k"], values["T_s"]
        refused = objection(m_d, d, k, T_s)
        if refused is not None:
            raise DriveError(refused)
        self._drive = Drive(m_d, d, k, T_s, self._controller)
        self._time = 0.0

    @_entry
    def do_step(self, current_time: float, step_size: float) -> bool:
        """Advance the drive by one communication step."""
        drive, controller, values = self._drive, self._controller, self._values
        if drive is None or controller is None:
            raise DriveError("doStep is not allowed before the initialization")
        if not 0.0 < step_size < math.inf:
            raise DriveError(f"step = {step_size!r} s is out of range: it must be above 0")
        drive.advance(step_size, values["F"], values["x"])
        self._time += step_size
        values["v"] = drive.output
        values["x_motor"] = drive.x
        values["x_command"] = self._set_point.at(self._time)[0]
        values["following_error"] = controller.error
        values["F_motor"] = drive.F_motor
        values["F_integral"] = controller.integral
        return True

    @_entry
    def get_real(self, vrs: list[int]) -> list[float]:
        """Return Real values by value reference."""
        return [float(self._value("Real", each)) for each in vrs]

    @_entry
    def get_integer(self, vrs: list[int]) -> list[int]:
        """Return Integer values by value reference."""
        return [int(self._value("Integer", each)) for each in vrs]

    @_entry
    def get_boolean(self, vrs: list[int]) -> list[bool]:
        """Refuse: there are no Booleans."""
        return [bool(self._value("Boolean", each)) for each in vrs]

    @_entry
    def get_string(self, vrs: list[int]) -> list[str]:
        """Refuse: there are no strings."""
        return [str(self._value("String", each)) for each in vrs]

    @_entry
    def set_real(self, vrs: list[int], values: list[float]) -> None:
        """Set inputs at any time, parameters before the start."""
        self._set("Real", vrs, values)

    @_entry
    def set_integer(self, vrs: list[int], values: list[int]) -> None:
        """Set parameters before the start."""
        self._set("Integer", vrs, values)

    @_entry
    def set_boolean(self, vrs: list[int], values: list[bool]) -> None:
        """Refuse: there are no Booleans."""
        self._set("Boolean", vrs, values)

    @_entry
    def set_string(self, vrs: list[int], values: list[str]) -> None:
        """Refuse: there are no strings; where one is unreadable the list of values has a hole."""
        for reference in vrs:
            _variable("String", reference)

    # The description says that there are no states. Where a simulator asks all the same, a refusal
    # is what it must get: pythonfmu's own calls would restore nothing and say that they had.

    def _get_fmu_state(self) -> Any:
        # The simulator is left with no state. Where it sets that or writes it out all the same, the
        # wrapper fails before it calls anybody here.
        for _ in range(_CALLS_WITH_NULL):
            self._give_references()
        raise self._fail(DriveError(_NO_STATES))

    @_entry
    def _set_fmu_state(self, state: Any) -> None:
        raise DriveError(_NO_STATES)

    # The wrapper calls the next two without an instance and could not survive an exception.

    @staticmethod
    def _fmu_state_to_bytes(state: Any) -> bytes:
        return b"null"

    @staticmethod
    def _fmu_state_from_bytes(content: bytes) -> list[Any]:
        return []

    def to_xml(self, model_options: dict[str, str] | None = None) -> Any:
        """Return the model description, which the builder writes; the options are fixed."""
        import pythonfmu  # only a build asks, and an import of the whole builder is slow

        from .description import model_description

        digest = __name__.split(".")[0].rpartition("_")[2]
        return model_description(digest, f"pythonfmu {pythonfmu.__version__}")

    def _value(self, kind: str, reference: int) -> float:
        return self._values[_variable(kind, reference).name]

    def _set(self, kind: str, vrs: Sequence[int], values: Sequence[float]) -> None:
        for position, reference in enumerate(vrs):
            value = values[position]
            variable = _variable(kind, reference)
            objection = variable.objection(value)
            if variable.causality == "output":
                objection = f"{variable.name} is an output: it cannot be set"
            elif variable.causality == "parameter" and self._drive is not None:
                objection = f"{variable.name} is fixed: it cannot change after initialization"
            if objection is not None:
                raise DriveError(objection)
            self._values[variable.name] = value

    def _fail(self, error: BaseException) -> DriveError:
        """Return the exception that ends this and every later call; say it once."""
        self._give_references()
        if self._fault is None:
            known = isinstance(error, DriveError)
            self._fault = str(error) if known else f"internal error: {error!r}"
            if sys.stderr is not None:
                sys.stderr.write(f"ServoDrive: {self._fault}\n")
        # The wrapper hands it to the log, which is read as a printf format.
        return DriveError(self._fault.replace("%", "%%"))

    def _give_references(self) -> None:
        """Make up for what the wrapper loses at one failure."""
        for lost in (self, type(self), self.log_queue):
            give_reference(lost)


def _variable(kind: str, reference: int) -> Variable:
    """Return the variable behind a value reference; raises DriveError where there is none."""
    if not 0 <= reference < len(VARIABLES):
        raise DriveError(f"there is no variable with value reference {reference}")
    variable = VARIABLES[reference]
    if variable.kind != kind:
        raise DriveError(f"{variable.name} is of type {variable.kind}, not {kind}")
    return variable
