"""The FMI 3.0 co-simulation face of a model, for pythonfmu3's wrapper."""

from typing import Any, Callable, List, NamedTuple, Optional

from pythonfmu3 import Fmi3Slave

from .instance import Instance, LogMessage, entry
from .lifetime import settle
from .model import ModelError, Spec
from .readers import References
from .table import Variable

_ERROR = 3
_TYPES = ("Float64", "Int32", "Int64", "UInt64", "Boolean", "String")


def _type_of(variable: Variable) -> str:
    """Return the type whose calls read and set a variable."""
    name = variable.type.fmi3_type
    return "Int64" if name == "Enumeration" else name


class StepResult(NamedTuple):
    """The members that the wrapper reads off the result of a step."""

    status: int
    terminateSimulation: bool


_DONE = StepResult(0, False)
_REFUSED = StepResult(_ERROR, False)


def _absent(call: str) -> Callable[..., Any]:
    """Return the method behind a call that the wrapper makes although nothing declares it."""

    @entry
    def refuse(self: "Slave", *arguments: Any) -> Any:
        raise ModelError(f"{call} is not allowed here: this is co-simulation without event mode")

    return refuse


class Slave(Instance, Fmi3Slave):  # type: ignore[misc]
    """A model as a slave; a subclass names the model, ``class Packed(Slave, spec=SPEC)``."""

    # Value reference of the independent variable, the time.
    _time_reference: int

    def __init_subclass__(cls, spec: Optional[Spec] = None, **arguments: Any) -> None:
        super().__init_subclass__(**arguments)
        # The class in the slave's own file has the model from its base.
        if spec is not None:
            cls._spec = spec
            cls._references = References(spec.table, _TYPES, _type_of)
            cls._time_reference = spec.table.time_reference

    def __init__(self, **arguments: Any) -> None:
        arguments.setdefault("instance_name", "")
        super().__init__(**arguments)
        self.modelName = self._spec.name
        self._float_readers = self._references.readers["Float64"]
        self._begin()
        if self.resources is not None:
            settle(self.resources)

    def do_step(self, current_time: float, step_size: float) -> StepResult:
        """Advance the model by one communication step.

        A refusal is returned and not raised, for a raised one would be fatal to all instances.
        """
        try:
            if not self._ready:
                self._prepare_step()
                # The wrapper keeps the start time to itself.
                self._model.date_start(current_time)
            self._model.advance(current_time, step_size)
        except BaseException as error:  # whatever it is, the importing process must survive it
            text = self._remember(error)
            self.log_queue.append(LogMessage(_ERROR, "logStatusError", text))
            return _REFUSED
        self._time = current_time + step_size
        return _DONE

    def get_float64(self, vrs: List[int]) -> List[float]:
        """Return Float64 values by value reference."""
        # The call that simulators make most, so the common way is written out.
        try:
            if self._settled:
                read = self._float_readers.get(tuple(vrs))
                if read is not None:
                    return read(self._model)
            if self._time_reference in vrs:
                return self._read_with_time(vrs)
            return self._read("Float64", vrs)
        except BaseException as error:  # whatever it is, the importing process must survive it
            raise self._fail(error) from None

    @entry
    def get_int32(self, vrs: List[int]) -> List[int]:
        """Return Int32 values by value reference."""
        return self._read("Int32", vrs)

    @entry
    def get_int64(self, vrs: List[int]) -> List[int]:
        """Return Enumeration values by value reference."""
        return self._read("Int64", vrs)

    @entry
    def get_uint64(self, vrs: List[int]) -> List[Any]:
        """Refuse: a table has no UInt64."""
        return self._read("UInt64", vrs)

    @entry
    def set_float64(self, vrs: List[int], values: List[float]) -> None:
        """Set Float64 parameters and inputs."""
        if self._time_reference in vrs:
            raise ModelError("time is the independent variable: it cannot be set")
        self._set("Float64", vrs, values)

    @entry
    def set_int32(self, vrs: List[int], values: List[int]) -> None:
        """Set Int32 parameters and inputs."""
        self._set("Int32", vrs, values)

    @entry
    def set_int64(self, vrs: List[int], values: List[int]) -> None:
        """Set Enumeration parameters and inputs."""
        self._set("Int64", vrs, values)

    @entry
    def set_uint64(self, vrs: List[int], values: List[int]) -> None:
        """Refuse: a table has no UInt64."""
        self._set("UInt64", vrs, values)

    set_time = _absent("fmi3SetTime")
    update_discrete_states = _absent("fmi3UpdateDiscreteStates")
    get_continuous_states = _absent("fmi3GetContinuousStates")
    set_continuous_states = _absent("fmi3SetContinuousStates")
    get_nominals_of_continuous_states = _absent("fmi3GetNominalsOfContinuousStates")
    get_event_indicators = _absent("fmi3GetEventIndicators")

    def get_continuous_state_derivatives(self) -> List[float]:
        """Return an empty list: the wrapper would not survive a refusal here."""
        return []

    def _read_with_time(self, vrs: List[int]) -> List[float]:
        """Return Float64 values, the time among them."""
        time = self._time_reference
        others = iter(self._read("Float64", [each for each in vrs if each != time]))
        return [self._time if each == time else next(others) for each in vrs]
