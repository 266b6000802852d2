"""The FMI 3.0 co-simulation face of the block, for pythonfmu3's wrapper."""

from typing import Any, Callable, Dict, List, NamedTuple, Optional

from pythonfmu3 import Fmi3Slave

from .description3 import TIME, type_name
from .face import Face, LogMessage, entry
from .lifetime import settle
from .references import References
from .settings import BlockError
from .variables import Variable

_ERROR = 3


def _type_of(variable: Variable) -> str:
    """Return the type whose calls read and set a variable."""
    name = type_name(variable.type)
    return "Int64" if name == "Enumeration" else name


_REFERENCES = References(("Float64", "Int32", "Int64", "UInt64", "Boolean", "String"), _type_of)
_FLOAT_READERS = _REFERENCES.readers["Float64"]


class StepResult(NamedTuple):
    """What the wrapper reads off the result of a step."""

    status: int
    terminateSimulation: bool


_DONE = StepResult(0, False)
_REFUSED = StepResult(_ERROR, False)


def _absent(call: str) -> Callable[..., Any]:
    """Return the method behind a call that the wrapper makes although nothing declares it."""

    @entry
    def refuse(self: "StickSlip", *arguments: Any) -> Any:
        raise BlockError(f"{call} is not allowed here: this is co-simulation without event mode")

    return refuse


class StickSlip(Face, Fmi3Slave):  # type: ignore[misc]
    """The stick-slip block as a slave."""

    _references = _REFERENCES

    def __init__(self, **arguments: Any) -> None:
        arguments.setdefault("instance_name", "")
        super().__init__(**arguments)
        self.modelName = "StickSlip"
        self._begin()
        if self.resources is not None:
            settle(self.resources)

    def do_step(self, current_time: float, step_size: float) -> StepResult:
        """Advance the block by one communication step.

        A refusal is returned and not raised, for a raised one would be fatal to all instances.
        """
        try:
            if not self._ready:
                self._prepare_step()
                # The wrapper keeps the start time to itself.
                self._block.date_start(current_time)
            self._block.advance(current_time, step_size)
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
                block = self._block
                if block.stale:
                    block.refresh()
                read = _FLOAT_READERS.get(tuple(vrs))
                if read is not None:
                    return list(read(block))
            if TIME in vrs:
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
        """Refuse: there are none."""
        return self._read("UInt64", vrs)

    @entry
    def set_float64(self, vrs: List[int], values: List[float]) -> None:
        """Set parameters and inputs; in a running simulation they act from the next step on."""
        if TIME in vrs:
            raise BlockError("time is the independent variable: it cannot be set")
        self._set("Float64", vrs, values)

    @entry
    def set_int32(self, vrs: List[int], values: List[int]) -> None:
        """Take nothing but start values before the start: no Int32 is an input."""
        self._refuse_to_set("Int32", vrs, values)

    @entry
    def set_int64(self, vrs: List[int], values: List[int]) -> None:
        """Refuse: no Enumeration is an input."""
        self._refuse_to_set("Int64", vrs, values)

    @entry
    def set_uint64(self, vrs: List[int], values: List[int]) -> None:
        """Refuse: there are none."""
        self._refuse_to_set("UInt64", vrs, values)

    set_time = _absent("fmi3SetTime")
    update_discrete_states = _absent("fmi3UpdateDiscreteStates")
    get_continuous_states = _absent("fmi3GetContinuousStates")
    set_continuous_states = _absent("fmi3SetContinuousStates")
    get_nominals_of_continuous_states = _absent("fmi3GetNominalsOfContinuousStates")
    get_event_indicators = _absent("fmi3GetEventIndicators")

    def get_continuous_state_derivatives(self) -> List[float]:
        """Return none; here the wrapper would not survive a refusal."""
        return []

    def to_xml(self, model_options: Optional[Dict[str, str]] = None) -> Any:
        """Return the model description, which the builder writes; the options are fixed."""
        import pythonfmu3

        from .description import identity
        from .description3 import model_description

        package = __name__.partition(".")[0]
        return model_description(identity(package), f"pythonfmu3 {pythonfmu3.__version__}")

    def _read_with_time(self, vrs: List[int]) -> List[float]:
        """Return Float64 values, the time among them."""
        others = iter(self._read("Float64", [each for each in vrs if each != TIME]))
        return [self._time if each == TIME else next(others) for each in vrs]
