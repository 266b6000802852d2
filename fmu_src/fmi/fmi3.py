"""The FMI 3.0 co-simulation face of a model, for pythonfmu3's wrapper."""

from typing import Any, Callable, List, NamedTuple, Sequence

from pythonfmu3 import Fmi3Slave

from .instance import Instance, LogMessage, entry, getter, setter
from .lifetime import settle
from .model import ModelError
from .table import Variable

_ERROR = 3


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
    """A model as a slave."""

    _types = ("Float64", "Int32", "Int64", "UInt64", "Boolean", "String")

    @staticmethod
    def _type_of(variable: Variable) -> str:
        name = variable.type.fmi3_type
        return "Int64" if name == "Enumeration" else name

    def __init__(self, **arguments: Any) -> None:
        super().__init__(**arguments)
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

    get_float64, set_float64 = Instance.get_reals, setter("Float64")
    get_int32, set_int32 = getter("Int32"), setter("Int32")
    get_int64, set_int64 = getter("Int64"), setter("Int64")
    get_uint64, set_uint64 = getter("UInt64"), setter("UInt64")

    set_time = _absent("fmi3SetTime")
    update_discrete_states = _absent("fmi3UpdateDiscreteStates")
    get_continuous_states = _absent("fmi3GetContinuousStates")
    set_continuous_states = _absent("fmi3SetContinuousStates")
    get_nominals_of_continuous_states = _absent("fmi3GetNominalsOfContinuousStates")
    get_event_indicators = _absent("fmi3GetEventIndicators")

    def get_continuous_state_derivatives(self) -> List[float]:
        """Return an empty list: the wrapper would not survive a refusal here."""
        return []

    def _read(self, kind: str, vrs: Sequence[int]) -> List[Any]:
        """Return values by value reference, the time among them."""
        time = self._spec.table.time_reference
        if kind != "Float64" or time not in vrs:
            return super()._read(kind, vrs)
        others = iter(super()._read(kind, [number for number in vrs if number != time]))
        return [self._time if number == time else next(others) for number in vrs]

    def _set(self, kind: str, vrs: Sequence[int], values: Sequence[Any]) -> None:
        if kind == "Float64" and self._spec.table.time_reference in vrs:
            raise ModelError("time is the independent variable: it cannot be set")
        super()._set(kind, vrs, values)
