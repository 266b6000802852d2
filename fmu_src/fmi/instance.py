"""The FMI 2.0 co-simulation face of a model, for pythonfmu's wrapper.

The wrapper is in the host's own language. It turns every exception into a
fatal status and releases references that it does not own (`lifetime`). So each method that the
wrapper calls returns a value or raises an error that `_fail` made.
"""

import contextlib
import functools
import sys
from typing import Any, Callable, List, NamedTuple, Optional, Sequence, TypeVar

from pythonfmu import Fmi2Slave

from .lifetime import give_reference
from .model import ModelError, Spec
from .readers import References
from .states import Handle, State, from_bytes
from .table import Variable

_WARNING = 1
# Calls with the state that a failed call did not give which the process survives.
_CALLS_WITH_NULL = 8

_Method = TypeVar("_Method", bound=Callable[..., Any])


class FmuError(Exception):
    """A call that failed; the text is for the user of the simulator."""


class LogMessage(NamedTuple):
    """A message in the form that the wrapper reads off the log queue."""

    status: int
    category: str
    msg: str
    debug: bool = False


def entry(method: _Method) -> _Method:
    """Make a method safe to be called by the wrapper: refuse after a failure, fail in one way."""

    @functools.wraps(method)
    def guarded(self: "Instance", *arguments: Any) -> Any:
        try:
            if self._fault is not None:
                raise ModelError(self._fault)
            return method(self, *arguments)
        except BaseException as error:  # whatever it is, the importing process must survive it
            raise self._fail(error) from None

    return guarded  # type: ignore[return-value]


def _logged(text: str) -> str:
    """Return a text as the simulator's log takes it, which reads it as a format of printf."""
    return text.replace("%", "%%")


def getter(kind: str) -> Callable[..., Any]:
    """Return the method that reads values of a type by value reference."""

    @entry
    def get(self: "Instance", vrs: List[int]) -> List[Any]:
        return self._read(kind, vrs)

    return get


def setter(kind: str) -> Callable[..., Any]:
    """Return the method that sets parameters and inputs of a type."""

    @entry
    def set_values(self: "Instance", vrs: List[int], values: List[Any]) -> None:
        self._set(kind, vrs, values)

    return set_values


class Instance(Fmi2Slave):  # type: ignore[misc]
    """One instance of a model, which a subclass names: ``class Packed(Instance, spec=SPEC)``."""

    # The model, and its variables.
    _spec: Spec
    _references: References

    def __init_subclass__(cls, spec: Optional[Spec] = None, **arguments: Any) -> None:
        super().__init_subclass__(**arguments)
        # The class in the slave's own file may have the model from its base.
        if spec is not None:
            cls._spec = spec
            cls._references = References(spec.table)
        # For a text that it cannot read the wrapper looks this up with an exception pending, and
        # then Python gives up at the first class that lacks it.
        cls.set_string = Instance.set_string  # type: ignore[method-assign]

    def __init__(self, **arguments: Any) -> None:
        arguments.setdefault("instance_name", "")
        super().__init__(**arguments)
        self.modelName = self._spec.name
        self._real_readers = self._references.readers["Real"]
        self._begin()

    def _begin(self) -> None:
        """Start in the phase after the instantiation."""
        self.log_queue: List[LogMessage] = []
        self._values = self._spec.values.at_start()
        self._time = 0.0
        self._fault: Optional[str] = None
        self._phase = "instantiated"
        self._warned: Optional[str] = None
        # Whether a step may go straight to the model.
        self._ready = False
        self._model = self._spec.model(self._values)
        # Whether the outputs follow the values that are set, and no call has failed.
        self._settled = True

    @entry
    def setup_experiment(
        self,
        start_time: float,
        stop_time: Optional[float] = None,
        tolerance: Optional[float] = None,
    ) -> None:
        """Take the start time; stop time and tolerance have no effect."""
        if not abs(start_time) < float("inf"):
            raise ModelError(f"start time = {start_time!r} s is out of range: a finite number")
        self._require("instantiated", "setupExperiment")
        self._time = start_time
        self._settled = False

    @entry
    def enter_initialization_mode(self) -> None:
        """Let the outputs follow the values that are set."""
        self._require("instantiated", "enterInitializationMode")
        self._phase = "initialization"

    @entry
    def exit_initialization_mode(self) -> None:
        """Start the model with the values set; refuse values that do not go together."""
        self._require("initialization", "exitInitializationMode")
        self._make_model()
        self._phase = "stepping"
        self._warn()

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Advance the model by one communication step."""
        try:
            if not self._ready:
                self._prepare_step()
            self._model.advance(current_time, step_size)
        except BaseException as error:  # whatever it is, the importing process must survive it
            raise self._fail(error) from None
        return True

    @entry
    def terminate(self) -> None:
        """End the simulation; the outputs stay readable."""
        self._ready = False
        self._phase = "terminated"

    set_real = setter("Real")
    get_integer, set_integer = getter("Integer"), setter("Integer")
    get_boolean, set_boolean = getter("Boolean"), setter("Boolean")
    get_string = getter("String")

    def get_real(self, vrs: List[int]) -> List[float]:
        """Return Reals by value reference."""
        # The call that simulators make most, so the common way is written out.
        try:
            if self._settled:
                read = self._real_readers.get(tuple(vrs))
                if read is not None:
                    return read(self._model)
            return self._read("Real", vrs)
        except BaseException as error:  # whatever it is, the importing process must survive it
            raise self._fail(error) from None

    @entry
    def set_string(self, vrs: List[int], values: List[str]) -> None:
        """Refuse: a table has no strings; an unreadable text leaves a gap in `values`."""
        for reference in vrs:
            self._references.variable("String", reference)

    def _get_fmu_state(self) -> Handle:
        try:
            if self._fault is not None:
                raise ModelError(self._fault)
            return Handle(
                State(
                    self._spec.model,
                    self._model.freeze(),
                    self._values,
                    self._time,
                    self._phase,
                    self._settled,
                )
            )
        except BaseException as error:  # whatever it is, the importing process must survive it
            # The simulator is left with no state. Where it sets that or writes it out all the
            # same, the wrapper fails before it calls any method here.
            for _ in range(_CALLS_WITH_NULL):
                self._give_references()
            # References that are not released keep the instance for good, so it is made small.
            self.__dict__.pop("_model", None)
            raise self._fail(error) from None

    def _set_fmu_state(self, handle: Any) -> None:
        """Take up a state, after a failure too."""
        try:
            state = handle.state if type(handle) is Handle else None
            if state is None:
                raise ModelError("the state to set is none that this FMU handed out")
            if not hasattr(self, "_model"):
                self._model = self._spec.model(state.values)
            self._model.thaw(state.model)
        except BaseException as error:  # whatever it is, the importing process must survive it
            raise self._fail(error) from None
        self._fault = None
        self._values = state.values
        self._time = state.time
        self._phase = state.phase
        self._settled = state.settled
        self._ready = False

    # The wrapper calls the next two without an instance and could not survive an exception.

    @staticmethod
    def _fmu_state_to_bytes(handle: Any) -> bytes:
        try:
            return Handle.to_bytes(handle)
        except Exception:
            return b"null"

    @classmethod
    def _fmu_state_from_bytes(cls, content: bytes) -> Handle:
        try:
            return Handle(from_bytes(cls._spec, content))
        except Exception:
            return Handle(None)

    def _make_model(self) -> None:
        """Make a new model with the values set."""
        self._model = self._spec.model(self._values, self._time)
        self._settled = True

    def _read(self, kind: str, vrs: Sequence[int]) -> List[Any]:
        """Return values by value reference."""
        if self._fault is not None:
            raise ModelError(self._fault)
        if not self._settled:
            self._make_model()
        return self._references.reader(kind, tuple(vrs))(self._model)

    def _set(self, kind: str, vrs: Sequence[int], values: Sequence[Any]) -> None:
        """Set parameters and inputs; in a running simulation they act from the next step on."""
        if len(vrs) != len(values):
            raise ModelError(f"{len(vrs)} value references came with {len(values)} values")
        stepping = self._phase == "stepping"
        for reference, value in zip(vrs, values):
            variable = self._settable(kind, reference, value)
            if variable.settable:
                if stepping:
                    self._model.set(variable.name, value)
                    self._values = self._model.wanted
                else:
                    self._values = self._values.changed(variable.name, value)
                    self._settled = False
        if stepping:
            self._model.check()
            # Whether there is something to warn of shows when all values for a step are set.
            self._ready = False

    def _settable(self, kind: str, reference: int, value: float) -> Variable:
        """Return the variable that is to take `value`; raises ModelError where it cannot."""
        variable = self._references.variable(kind, reference)
        objection = None
        if self._phase == "terminated":
            objection = f"{variable.name} cannot be set: the simulation is terminated"
        elif not variable.settable:
            # Before the start an importer may write back the start values that it read.
            if self._phase == "stepping" or variable.start is None or value != variable.start:
                objection = f"{variable.name} is an output: it cannot be set"
        elif self._phase == "stepping" and variable.variability == "fixed":
            if value != getattr(self._values, variable.name):
                objection = f"{variable.name} is fixed: it cannot change after initialization"
        else:
            objection = variable.objection(value)
        if objection is not None:
            raise ModelError(objection)
        return variable

    def _prepare_step(self) -> None:
        """Check the phase and warn; no call but another one between two steps can change either."""
        if self._fault is not None:
            raise ModelError(self._fault)
        self._require("stepping", "doStep")
        self._warn()
        self._ready = True

    def _require(self, phase: str, call: str) -> None:
        if self._phase != phase:
            raise ModelError(f"{call} is not allowed here: the instance is in phase {self._phase}")

    def _warn(self) -> None:
        """Tell the model's warning, unless it was the last one told."""
        text = self._model.warning()
        if text is not None and text != self._warned:
            self.log_queue.append(LogMessage(_WARNING, "logStatusWarning", _logged(text)))
            self._tell(text)
        self._warned = text

    def _fail(self, error: BaseException) -> FmuError:
        """Return the exception that ends this call and, until a reset or a state, later ones."""
        # Before anything else can go wrong.
        self._give_references()
        # The wrapper would hand over waiting messages with the exception still on its way, which
        # a log written in Python does not survive. Standard error has them.
        self.log_queue.clear()
        # The wrapper hands the text to the log.
        return FmuError(_logged(self._remember(error)))

    def _give_references(self) -> None:
        """Give the references that the wrapper releases at one failure."""
        for lost in (self, type(self), self.log_queue):
            give_reference(lost)

    def _remember(self, error: BaseException) -> str:
        """Keep a failure, write it to standard error once, and return its text."""
        if self._fault is None:
            known = isinstance(error, ModelError)
            self._fault = str(error) if known else f"internal error: {error!r}"
            self._tell(self._fault)
        self._ready = self._settled = False
        return self._fault

    def _tell(self, text: str) -> None:
        """Write to standard error, if it can be written: many importers drop the log."""
        # A message that cannot be shown must not become a failure of its own.
        with contextlib.suppress(Exception):
            print(f"{self._spec.name}: {text}", file=sys.stderr)
