"""What the faces of all FMI versions share: phases, settings, outputs, states, faults, messages.

A face is called by a wrapper in the host's own language. The wrapper turns every exception into a
fatal status, and at each one gives away references that it does not own (`lifetime`). So every
method that it calls ends in a value, or in one `FmuError` that `_fail` made.
"""

import contextlib
import functools
import sys
from typing import Any, Callable, List, NamedTuple, Optional, Sequence, Tuple, TypeVar

from .handles import Handle, held
from .lifetime import give_reference
from .model import Block
from .references import References
from .settings import BlockError, Settings
from .state import State, from_bytes
from .variables import Variable, start_values

_WARNING = 1
# So often a simulator may set or write out the state that one failed call has left it without.
_CALLS_WITH_NULL = 8

_Method = TypeVar("_Method", bound=Callable[..., Any])


class FmuError(Exception):
    """A call that failed; the text is for the user of the simulator."""


class LogMessage(NamedTuple):
    """What a wrapper reads off the log queue."""

    status: int
    category: str
    msg: str
    debug: bool = False


def entry(method: _Method) -> _Method:
    """Make a method safe to be called by the wrapper: refuse after a failure, fail in one way."""

    @functools.wraps(method)
    def guarded(self: "Face", *arguments: Any) -> Any:
        try:
            if self._fault is not None:
                raise BlockError(self._fault)
            return method(self, *arguments)
        except BaseException as error:  # whatever it is, the importing process must survive it
            raise self._fail(error) from None

    return guarded  # type: ignore[return-value]


class Face:
    """One instance, but for what its FMI version calls things."""

    # The variables under this version's types, and whether its log reads texts as formats.
    _references: References
    _log_is_printf = False

    def _begin(self) -> None:
        """Stand where every instance begins."""
        self.log_queue: List[LogMessage] = []
        self._settings = Settings(start_values())
        self._time = 0.0
        self._fault: Optional[str] = None
        self._phase = "instantiated"
        self._warned: Optional[Tuple[float, float]] = None
        # Whether a step may go straight to the block.
        self._ready = False
        self._block = Block(self._settings)
        # Whether the block shows what is set, and no call has failed.
        self._settled = True

    @entry
    def setup_experiment(
        self,
        start_time: float,
        stop_time: Optional[float] = None,
        tolerance: Optional[float] = None,
    ) -> None:
        """Take the start time, which dates the events; the others mean nothing here."""
        if not abs(start_time) < float("inf"):
            raise BlockError(f"start time = {start_time!r} s is out of range: a finite number")
        self._require("instantiated", "setupExperiment")
        self._time = start_time
        self._settled = False

    @entry
    def enter_initialization_mode(self) -> None:
        """Let the outputs follow what is set."""
        self._require("instantiated", "enterInitializationMode")
        self._phase = "initialization"

    @entry
    def exit_initialization_mode(self) -> None:
        """Start the block from what was set; refuse values that do not go together."""
        self._require("initialization", "exitInitializationMode")
        self._block = Block(self._settings, self._time)
        self._settled = True
        self._phase = "stepping"
        self._warn_of_clamp()

    @entry
    def terminate(self) -> None:
        """End the simulation; the outputs stay readable."""
        self._ready = False
        self._phase = "terminated"

    @entry
    def get_boolean(self, vrs: List[int]) -> List[bool]:
        """Return Boolean values by value reference."""
        return self._read("Boolean", vrs)

    @entry
    def get_string(self, vrs: List[int]) -> List[str]:
        """Refuse: there are no strings."""
        return self._read("String", vrs)

    @entry
    def set_boolean(self, vrs: List[int], values: List[bool]) -> None:
        """Take nothing: no Boolean is an input."""
        self._refuse_to_set("Boolean", vrs, values)

    @entry
    def set_string(self, vrs: List[int], values: List[str]) -> None:
        """Refuse: there are no strings."""
        self._refuse_texts(vrs)

    def _get_fmu_state(self) -> Handle:
        try:
            if self._fault is not None:
                raise BlockError(self._fault)
            return Handle(
                State(self._block.freeze(), self._settings, self._time, self._phase, self._settled)
            )
        except BaseException as error:  # whatever it is, the importing process must survive it
            # The simulator is left with no state. Where it sets that or writes it out all the
            # same, the wrapper fails before it calls anybody here.
            for _ in range(_CALLS_WITH_NULL):
                self._give_references()
            # What is not taken of these keeps the instance for good, so let it be a small one.
            self.__dict__.pop("_block", None)
            raise self._fail(error) from None

    @entry
    def _set_fmu_state(self, handle: Any) -> None:
        state = held(handle)
        if state is None:
            raise BlockError("the state to set is none that this FMU handed out")
        self._block.thaw(state.block)
        self._settings = state.settings
        self._time = state.time
        self._phase = state.phase
        self._settled = state.settled
        self._ready = False

    # The wrapper calls the next two without an instance and could not survive an exception.

    @staticmethod
    def _fmu_state_to_bytes(handle: Any) -> bytes:
        try:
            state = held(handle)
            return b"null" if state is None else state.to_bytes()
        except Exception:
            return b"null"

    @staticmethod
    def _fmu_state_from_bytes(content: bytes) -> Handle:
        try:
            return Handle(from_bytes(content))
        except Exception:
            return Handle(None)

    def _read(self, kind: str, vrs: Sequence[int]) -> List[Any]:
        """Return values by value reference."""
        if self._fault is not None:
            raise BlockError(self._fault)
        if not self._settled:
            self._block = Block(self._settings, self._time)
            self._settled = True
        block = self._block
        if block.stale:
            block.refresh()
        return list(self._references.reader(kind, tuple(vrs))(block))

    def _set(self, kind: str, vrs: Sequence[int], values: Sequence[Any]) -> None:
        """Set parameters and inputs; in a running simulation they act from the next step on."""
        _pair(vrs, values)
        stepping = self._phase == "stepping"
        for reference, value in zip(vrs, values):
            variable = self._settable(kind, reference, value)
            if variable.settable:
                if stepping:
                    self._block.set(variable.name, value)
                    self._settings = self._block.wanted
                else:
                    self._settings = self._settings.changed(variable.name, value)
        if stepping:
            self._settings.normal_force()
            # Only a step shows whether mu_s and mu_k stay as they are now.
            self._ready = False
        elif vrs:
            self._settled = False

    def _refuse_to_set(self, kind: str, vrs: Sequence[int], values: Sequence[Any]) -> None:
        """Take nothing but start values before the start: none of these is an input."""
        _pair(vrs, values)
        for reference, value in zip(vrs, values):
            self._settable(kind, reference, value)

    def _refuse_texts(self, vrs: Sequence[int]) -> None:
        """Refuse, for there are no texts; where one is unreadable the list of values has a hole."""
        for reference in vrs:
            self._references.variable("String", reference)

    def _settable(self, kind: str, reference: int, value: float) -> Variable:
        """Return the variable that is to take `value`; raises BlockError where it cannot."""
        variable = self._references.variable(kind, reference)
        objection = None
        if self._phase == "terminated":
            objection = f"{variable.name} cannot be set: the simulation is terminated"
        elif not variable.settable:
            # Before the start an importer may write back the start values that it read.
            if self._phase == "stepping" or variable.start is None or value != variable.start:
                objection = f"{variable.name} is an output: it cannot be set"
        elif self._phase == "stepping" and variable.variability == "fixed":
            if value != getattr(self._settings, variable.name):
                objection = f"{variable.name} is fixed: it cannot change after initialization"
        else:
            objection = variable.objection(value)
        if objection is not None:
            raise BlockError(objection)
        return variable

    def _prepare_step(self) -> None:
        """Do before a step what need not be done before each: refuse it, or warn."""
        if self._fault is not None:
            raise BlockError(self._fault)
        self._require("stepping", "doStep")
        self._warn_of_clamp()
        self._ready = True

    def _require(self, phase: str, call: str) -> None:
        if self._phase != phase:
            raise BlockError(f"{call} is not allowed here: the instance is in phase {self._phase}")

    def _warn_of_clamp(self) -> None:
        mu_s, mu_k = self._settings.mu_s, self._settings.mu_k
        if mu_k <= mu_s:
            self._warned = None
        elif self._warned != (mu_s, mu_k):
            self._warned = (mu_s, mu_k)
            text = (
                f"mu_k = {mu_k!r} is above mu_s = {mu_s!r}: "
                "mu_k is clamped to max(mu_s - 0.01, 0), see mu_k_used"
            )
            self.log_queue.append(LogMessage(_WARNING, "logStatusWarning", text))
            _tell(text)

    def _fail(self, error: BaseException) -> FmuError:
        """Return the exception that ends this call and, until a reset, every later one."""
        # Before anything else can go wrong.
        self._give_references()
        # The wrapper would hand over what waits there with the exception still on its way, which
        # a log written in Python does not survive. Standard error has it.
        self.log_queue.clear()
        text = self._remember(error)
        # The wrapper hands it to the log.
        return FmuError(text.replace("%", "%%") if self._log_is_printf else text)

    def _give_references(self) -> None:
        """Make up for what the wrapper loses at one failure."""
        for lost in (self, type(self), self.log_queue):
            give_reference(lost)

    def _remember(self, error: BaseException) -> str:
        """Take note of a failure, tell of it once, and return why every call fails from now on."""
        if self._fault is None:
            known = isinstance(error, BlockError)
            self._fault = str(error) if known else f"internal error: {error!r}"
            _tell(self._fault)
        self._ready = self._settled = False
        return self._fault


def _pair(vrs: Sequence[int], values: Sequence[Any]) -> None:
    """Refuse what does not go together one by one."""
    if len(vrs) != len(values):
        raise BlockError(f"{len(vrs)} value references came with {len(values)} values")


def _tell(text: str) -> None:
    """Write to standard error, where that can be done: many importers drop the log."""
    # A message that cannot be shown must not become a failure of its own.
    with contextlib.suppress(Exception):
        print(f"StickSlip: {text}", file=sys.stderr)
